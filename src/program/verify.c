/* `iftty verify` and its forms; `iftty log --reseal`, which is like accepting; `iftty diff`. */
#include "base/file.h"
#include "journal/record.h"
#include "verify/verify.h"

#include <string.h>

#include "program/begin.h"
#include "program/console.h"
#include "program/programs.h"
#include "verify/bisect.h"
#include "verify/ci.h"
#include "verify/diff.h"
#include "verify/reseal.h"
#include "verify/shard.h"
#include "verify/signature.h"

/* ---- verify ---- */

static bool is_chain(const char *text)
{
    return strspn(text, "0123456789abcdef") == RECORD_CHAIN_DIGITS && !text[RECORD_CHAIN_DIGITS];
}

static enum err check_lock_options(const struct options *o, struct fault *fault)
{
    if (o->update_lock && !o->lock)
        return fault_set(fault, ERR_USAGE, "--update-lock: --lock FILE says which file");
    if (o->update_lock && ci_is_set())
        return fault_set(fault, ERR_USAGE,
                         "--update-lock is a person's decision, and refused where CI is set");
    if (o->update_lock && (o->from || o->until || o->shard || o->fail_fast))
        return fault_set(fault, ERR_USAGE,
                         "--update-lock: all journals are verified, without --from, --until, "
                         "--shard and --fail-fast");
    return OK;
}

/* What options say together. */
static enum err check_options(const struct options *o, struct fault *fault)
{
    if (!o->words && !o->lock)
        return fault_set(fault, ERR_USAGE, "name a journal, or a lock by --lock FILE");
    if (o->until && o->from > o->until)
        return fault_set(fault, ERR_USAGE, "--from %zu --until %zu: nothing lies between", o->from,
                         o->until);
    if (o->strict && o->no_strict)
        return fault_set(fault, ERR_USAGE, "--strict and --no-strict: give one of them");
    if (o->expect && (o->words != 1 || !is_chain(o->expect)))
        return fault_set(fault, ERR_USAGE,
                         "--expect: expected one journal, and the 32 digits of its last chain");
    if ((o->revoked || o->signed_at) && !o->allowed_signers)
        return fault_set(fault, ERR_USAGE,
                         "--revoked and --signed-at: --allowed-signers FILE asks for signatures");
    if (o->signed_at && !signature_is_time(o->signed_at))
        return fault_set(fault, ERR_USAGE,
                         "--signed-at: expected YYYYMMDD, or YYYYMMDDHHMMSS, and Z for UTC, not %s",
                         o->signed_at);
    if (o->remove_orphans && ci_is_set())
        return fault_set(fault, ERR_USAGE,
                         "--remove-orphans is a person's decision, and refused where CI is set");
    return check_lock_options(o, fault);
}

/* Those that are this machine's. */
static enum err choose(const struct options *o, struct lock_plan *plan, size_t *count,
                       struct fault *fault)
{
    struct shard shard;
    *count = plan ? plan->name.count : (size_t)o->words;
    if (!o->shard)
        return OK;
    if (!shard_read(&shard, o->shard))
        return fault_set(fault, ERR_USAGE, "--shard: expected K/N, as 1/4 to 4/4, not %s",
                         o->shard);
    *count =
        shard_choose(&shard, plan ? plan->journal : o->word, plan ? plan->name.name : NULL, *count);
    return OK;
}

static enum err verify_journals(const struct options *o, struct lock_plan *plan,
                                struct fault *fault)
{
    size_t count;
    enum err err = choose(o, plan, &count, fault);
    const struct verify_options how = {.path = plan ? plan->journal : o->word,
                                       .count = count,
                                       .scene_path = o->scene,
                                       .evidence_folder = o->out,
                                       .junit = o->junit,
                                       .html = o->html,
                                       .json = o->json,
                                       .strict = o->strict || (ci_is_set() && !o->no_strict),
                                       .fail_fast = o->fail_fast,
                                       .timings = o->timings,
                                       .removes_orphans = o->remove_orphans,
                                       .expect = o->expect,
                                       .allowed_signers = o->allowed_signers,
                                       .revoked = o->revoked,
                                       .signed_at = o->signed_at,
                                       .plan = plan,
                                       .first = o->from,
                                       .last = o->until,
                                       .processes = o->processes ? (unsigned)o->processes : 1,
                                       .begin = begin_one,
                                       .context = (void *)(uintptr_t)o,
                                       .watch = console_watch()};
    if (!err && o->out)
        err = file_make_folder(o->out, fault);
    if (err)
        return err;
    console_handle_interrupts();
    return verify_files(&how, &console_printer, fault);
}

enum err run_verify(const struct options *o, struct fault *fault)
{
    struct lock_plan plan;
    enum err err = check_options(o, fault);
    if (err || !o->lock)
        return err ? err : verify_journals(o, NULL, fault);
    err = lock_plan_make(&plan, o->lock, o->update_lock, o->word, (size_t)o->words, fault);
    if (!err)
        err = verify_journals(o, &plan, fault);
    lock_plan_release(&plan);
    return err;
}

/* ---- the first record that differs ---- */

enum err run_verify_bisect(const struct options *o, struct fault *fault)
{
    console_handle_interrupts();
    return bisect_journals(o->word[0], o->word[1], &console_printer, fault);
}

/* Both builds are confined as a replay is. */
static enum err begin_builds(void *context, const char *folder, const char *const *program,
                             struct fault *fault)
{
    const struct options *o = context;
    return begin_confined(o, o->word[0], folder, program, fault);
}

enum err run_verify_builds(const struct options *o, struct fault *fault)
{
    const struct bisect_builds how = {.journal = o->word[0],
                                      .other = o->with,
                                      .scene_path = o->scene,
                                      .word = "run",
                                      .watch = console_watch(),
                                      .begin = begin_builds,
                                      .context = (void *)(uintptr_t)o};
    console_handle_interrupts();
    return bisect_builds(&how, &console_printer, fault);
}

enum err run_diff(const struct options *o, struct fault *fault)
{
    const struct diff_options how = {.path = {o->word[0], o->word[1]},
                                     .scene_path = o->scene,
                                     .picture = o->picture,
                                     .json = o->json,
                                     .last = o->until,
                                     .begin = begin_one,
                                     .context = (void *)(uintptr_t)o,
                                     .watch = console_watch()};
    console_handle_interrupts();
    return diff_journals(&how, &console_printer, fault);
}

/* ---- sealing anew ---- */

/* With a reason, golden images are accepted; else an edited journal gets its results. */
enum err run_reseal(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    console_handle_interrupts();
    enum err err = begin_interpreter(&interp, o, fault);
    if (!err)
        err = o->accept ? reseal_accept(&interp, o->word[0], o->accept, &console_printer, fault)
                        : reseal_edited(&interp, o->word[0], &console_printer, fault);
    interpreter_release(&interp);
    return err;
}
