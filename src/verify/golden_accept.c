#include "image/helper.h"
#include "command/files.h"
#include "verify/golden_accept.h"

#include <string.h>
#include <unistd.h>

#include "base/file_draft.h"
#include "journal/golden.h"

/* The next pair of a draft and its place; false at the end. */
static bool next_draft(const struct golden_accept *accept, const char **at, const char **draft,
                       const char **place)
{
    *at = *at ? *place + strlen(*place) + 1 : buf_text(&accept->drafts);
    if (*at >= buf_text(&accept->drafts) + accept->drafts.length)
        return false;
    *draft = *at;
    *place = *draft + strlen(*draft) + 1;
    return true;
}

/* The file to be compared: the draft for that place, if there is one, or what is there. */
static const char *source(void *context, const char *path)
{
    const char *at = NULL, *draft, *place;
    while (next_draft(context, &at, &draft, &place))
        if (strcmp(place, path) == 0)
            return draft;
    return path;
}

/* One file, whole, under a name of its own. */
static enum err write_draft(struct golden_accept *accept, struct interpreter *interp,
                            const char *path, const struct picture *picture, struct fault *fault)
{
    struct buf draft = {0};
    enum err err = file_draft(&draft, path, FILE_REPLACE, fault);
    if (!err) {
        err = image_write(interp->helper, buf_text(&draft), FILE_KEEP, picture, fault);
        buf_add(&accept->drafts, buf_text(&draft), draft.length + 1);
        buf_add(&accept->drafts, path, strlen(path) + 1);
        if (!err && accept->drafts.failed) {
            file_discard(buf_text(&draft));
            err = fault_memory(fault, "the names of files");
        }
    }
    buf_release(&draft);
    return err;
}

static enum err note_origin(const struct golden_accept *accept, const struct interpreter *interp,
                            struct picture *picture, struct fault *fault)
{
    const char *journal = file_name(buf_text(&interp->home));
    enum err err = session_is_private(interp->session)
                       ? OK
                       : picture_note(picture, "iftty:journal", journal, fault);
    return err ? err : picture_note(picture, "iftty:chain", accept->chain.hex, fault);
}

/* The folder for golden images, which goes again where it was made in vain. */
static enum err make_folder(struct golden_accept *accept, const struct buf *folder,
                            struct fault *fault)
{
    if (!file_is_folder(buf_text(folder))) {
        buf_clear(&accept->folder);
        buf_add_text(&accept->folder, buf_text(folder));
    }
    return file_make_folder(buf_text(folder), fault);
}

/* The image, and the PNG beside it. */
static enum err write_drafts(struct golden_accept *accept, struct interpreter *interp,
                             const struct golden_finding *finding, struct fault *fault)
{
    struct buf folder = {0};
    enum err err = golden_folder(&folder, buf_text(&interp->home), fault);
    if (!err)
        err = make_folder(accept, &folder, fault);
    if (!err)
        err = note_origin(accept, interp, finding->actual, fault);
    if (!err)
        err = write_draft(accept, interp, finding->path, finding->actual, fault);
    buf_printf(&folder, "/%s.png", finding->name);
    if (!err)
        err = folder.failed
                  ? fault_memory(fault, "a path")
                  : write_draft(accept, interp, buf_text(&folder), finding->actual, fault);
    buf_release(&folder);
    return err;
}

enum err golden_accept_ask(struct golden_accept *accept, const struct golden_finding *finding,
                           const char *wrong, struct fault *fault)
{
    const struct review_question question = {accept->record->number, accept->record->command, wrong,
                                             finding};
    const struct reviewer *reviewer = accept->reviewer;
    enum review_answer answer = REVIEW_ACCEPT;
    const enum err err =
        reviewer ? reviewer->ask(reviewer->context, &question, &accept->why, &answer, fault) : OK;
    if (!err)
        accept->answers[answer]++;
    accept->is_left = answer != REVIEW_ACCEPT;
    return err;
}

static enum err differs(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault)
{
    struct golden_accept *accept = context;
    if (source(accept, finding->path) != finding->path)
        return fault_set(fault, ERR_CHECK,
                         "golden image %s is given twice, and the pictures are not the same",
                         finding->name);
    buf_clear(&accept->note);
    buf_add_text(&accept->note, fault->text);
    enum err err = golden_accept_ask(accept, finding, buf_text(&accept->note), fault);
    if (!err && !accept->is_left)
        err = write_drafts(accept, interp, finding, fault);
    if (err)
        return err;
    if (accept->is_left)
        buf_clear(&accept->note);
    accept->images += !accept->is_left;
    fault->text[0] = '\0';
    return OK;
}

struct golden_judge golden_accept_judge(struct golden_accept *accept)
{
    return (struct golden_judge){.context = accept, .source = source, .differs = differs};
}

enum err golden_accept_publish(struct golden_accept *accept, struct interpreter *interp,
                               struct fault *fault)
{
    const char *at = NULL, *draft, *place;
    enum err err = OK;
    while (!err && next_draft(accept, &at, &draft, &place)) {
        err = interpreter_will_write(interp, place, FILE_REPLACE, fault);
        if (!err)
            err = file_publish(draft, place, FILE_REPLACE, fault);
    }
    return err;
}

void golden_accept_release(struct golden_accept *accept)
{
    const char *at = NULL, *draft, *place;
    while (next_draft(accept, &at, &draft, &place))
        file_discard(draft); /* it is gone already where it was published */
    if (accept->folder.length)
        rmdir(buf_text(&accept->folder)); /* stays where it holds anything */
    buf_release(&accept->folder);
    buf_release(&accept->drafts);
    buf_release(&accept->note);
    buf_release(&accept->why);
}
