/*
 * iftty: segment 3-D scenes by seeds, in a terminal.
 *
 * Options, and the one place that prints and decides an exit status: 0 fine, 1 a check failed, 2
 * bad usage, 3 bad input or I/O.
 */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/clock.h"
#include "sandbox/confine.h"
#include "base/file.h"
#include "base/folder.h"
#include "base/scan.h"
#include "program/about.h"
#include "program/anonymise.h"
#include "program/bench.h"
#include "verify/bisect.h"
#include "verify/diff.h"
#include "verify/replay_file.h"
#include "journal/graph.h"
#include "sandbox/limits.h"
#include "program/provenance.h"
#include "verify/reseal.h"
#include "sandbox/trust.h"
#include "verify/verify.h"
#include "program/bench_terminal.h"
#include "program/pilot_host.h"
#include "journal/log.h"
#include "session/export.h"
#include "tui/crop.h"
#include "tui/picture/graphics.h"
#include "tui/prompt/line_history.h"
#include "tui/progress.h"
#include "tui/prompt/repl.h"

static const char usage[] =
    "iftty: segment 3-D scenes by seeds, in a terminal\n"
    "\n"
    "    iftty [SCENE|JOURNAL]          the prompt, on a new scene or a journal to go on with\n"
    "    iftty run FILE|-               carry out the commands of a script or journal\n"
    "    iftty -c 'COMMAND; COMMAND'    carry out these commands\n"
    "    iftty replay JOURNAL           carry a journal out again, compare every result\n"
    "    iftty verify JOURNAL...        the same quietly, and compare golden images; TAP\n"
    "    iftty diff A B                 where two journals part, and how far their labels differ:\n"
    "                                   Dice, voxels, a picture; --json, --until\n"
    "    iftty log JOURNAL              print a journal; --script its commands, --check its chain\n"
    "                                   --export FILE as W3C PROV-JSON; --anonymise leaves out\n"
    "                                   comments and the names of files\n"
    "    iftty log --graph JOURNAL      draw the alternatives in it, and which one is the present\n"
    "    iftty log --repair JOURNAL     keep what is sound of it, and the rest beside it\n"
    "    iftty show PICTURE             show a picture file inline, if the terminal can\n"
    "    iftty info [FILE]              what a picture, a scene, a journal or the program says of\n"
    "                                   itself; --json\n"
    "    iftty bench [brain]            measure the whole way; --json for programs\n"
    "    iftty bench paper [SCENE...]   the paper's five experiments: text, --json or --csv\n"
    "    iftty bench growth             one edit, in scenes of 4 to 300 million voxels\n"
    "    iftty bench render             frames and incremental images; VTK beside them\n"
    "    iftty bench journal [JOURNAL]  what recording, reading and verifying cost\n"
    "    iftty bench terminal           pictures for terminals; from a key to the picture; chafa\n"
    "    iftty help [COMMAND]           the commands of prompt, script and journal\n"
    "\n"
    "    --journal FILE    record there (run, -c, prompt); an existing journal is resumed\n"
    "    --read-only       resume it for looking: it is not written to, nor locked\n"
    "    --scene FILE      open this scene, whatever name `open` gives\n"
    "    --out DIR         write files into this folder (replay: else a new temporary one); "
    "verify\n"
    "                      leaves there what a golden image differs by, in N/ for the Nth\n"
    "                      journal where several have one name\n"
    "    -j N              verify N journals at once (1..64; 1)\n"
    "    --from N, --until N  compare these records only (verify); carry out no more (diff)\n"
    "    --junit FILE, --html FILE  what verify found: for other programs, and as a page with the\n"
    "                      pictures of each failure; written anew\n"
    "    --bisect          find the first record that differs in two journals, or, with\n"
    "                      --with PROGRAM, in what another build gives (verify)\n"
    "    --picture FILE.png  both renditions, and where they differ, side by side (diff)\n"
    "    --accept WHY      draw up anew the golden images of a journal that differ (verify), and\n"
    "                      note in it why; refused where CI is set\n"
    "    --reseal          give a journal that was edited its results anew (log)\n"
    "    --limit-memory 2G, --limit-time 20m, --limit-output 500M\n"
    "                      the most that a replay or verify may take (3/4 of what is free, 1h, "
    "4G)\n"
    "    --keep-going      do not stop at the first error (run, -c)\n"
    "    --graphics auto|kitty|iterm|sixel|blocks|none\n"
    "    --smooth          pictures at the terminal in 24 bits, where it can, for four times the "
    "bytes\n"
    "    --rounds N        time each experiment N times (bench paper; 3), take the median\n"
    "    --quick           only the first two steps (bench paper) or scenes (bench growth); no "
    "slow\n"
    "                      line (bench terminal)\n"
    "    --plots DIR       charts as SVG, into this folder (bench paper)\n"
    "    --version\n"
    "\n"
    "    Ctrl-C takes the command at hand back; run, -c and replay end with it.\n"
    "    Exit status: 0 fine, 1 a check failed, 2 bad usage, 3 bad input or I/O, 130 Ctrl-C.\n";

struct options {
    const char *journal, *scene, *out, *commands;
    const char *rounds, *plots;
    const char *processes, *from, *until, *junit, *html, *accept, *with, *export, *picture;
    const char *limit_memory, *limit_time, *limit_output;
    bool keep_going, smooth, read_only, script, check, repair, reseal, anonymise, bisect, json, csv,
        quick, graph;
    struct graphics_wish graphics;
    char **word; /* what is left: program and files */
    int words;
};

/* ---- Ctrl-C, and how far things are ---- */

/* Ctrl-C while a command runs takes the command back. While nothing is being done it ends the
 * program as it ends any other: whatever was acknowledged is on the disk. */
static volatile sig_atomic_t interrupted, idle;

static void interrupt(int number)
{
    interrupted = 1;
    if (idle) {
        signal(number, SIG_DFL);
        raise(number); /* once the handler has returned */
    }
}

/* Not where whoever started us wants it ignored. */
static void handle_interrupts(void)
{
    if (signal(SIGINT, interrupt) == SIG_IGN)
        signal(SIGINT, SIG_IGN);
}

static void wait_idly(void *context, bool waits)
{
    (void)context;
    idle = waits;
}

static struct progress progress;

static bool poll_watch(void *context, const char *what, uint64_t done, uint64_t total)
{
    static bool taking_back;
    const bool stop = interrupted;
    char words[40];
    (void)context;
    if (stop && !taking_back)
        progress.drawn_ns = 0;
    taking_back = stop;
    if (stop)
        snprintf(words, sizeof words, "taking it back%s%s", what ? ": " : "", what ? what : "");
    if (stop || what)
        progress_show(&progress, stop ? words : what, done, total, clock_ns());
    return stop || limits_stop();
}

static void announce(void *context, const char *line)
{
    (void)context;
    progress_erase(&progress);
    fprintf(stderr, "%siftty: %s\n", progress.shows ? "\r" : "", line);
}

static struct watch watch = {.poll = poll_watch, .announce = announce};

/* ---- printing ---- */

static void say(void *context, const char *text)
{
    (void)context;
    progress_erase(&progress);
    fputs(text, stdout);
    fflush(stdout);
}

static void complain(void *context, const char *text)
{
    (void)context;
    progress_erase(&progress);
    fputs(text, stderr);
}

static struct image_view view_of(struct interpreter *interp, bool smooth)
{
    static uint32_t hue[256];
    const struct canvas *shown = &interp->shown;
    const struct rendition *r = session_frame(&interp->session);
    struct image_view view = {.width = r->width, .height = r->height, .rgba = r->rgba};
    if (shown->rgba)
        view = (struct image_view){
            .width = shown->width, .height = shown->height, .rgba = shown->rgba};
    if (interp->session.has_scene && session_count_labels(&interp->session, NULL) == OK) {
        view.hue = hue;
        view.hues = pilot_hues(hue, &interp->session);
    }
    view.smooth = smooth;
    return view;
}

static void show_picture(void *context, struct interpreter *interp)
{
    const struct options *options = context;
    struct image_view view = view_of(interp, options->smooth);
    fflush(stdout);
    if (isatty(STDOUT_FILENO))
        show_picture_once(options->graphics, &view);
}

static int finish(enum err err, const struct fault *fault)
{
    progress_erase(&progress);
    if (err && fault->text[0])
        fprintf(stderr, "iftty: %s\n", fault->text);
    if ((fflush(stdout) != 0 || ferror(stdout)) && !err) {
        fputs("iftty: cannot write to standard output\n", stderr);
        return err_exit_status(ERR_IO);
    }
    return err_exit_status(err);
}

/* ---- options ---- */

/* Options may stand anywhere; "--" ends them. */
static enum err read_options(struct options *o, int count, char **word, struct fault *fault)
{
    const char *graphics = "auto";
    const struct {
        const char *name;
        const char **value;
    } valued[] = {{"--journal", &o->journal},
                  {"--scene", &o->scene},
                  {"--out", &o->out},
                  {"-c", &o->commands},
                  {"--rounds", &o->rounds},
                  {"--plots", &o->plots},
                  {"-j", &o->processes},
                  {"--from", &o->from},
                  {"--until", &o->until},
                  {"--accept", &o->accept},
                  {"--with", &o->with},
                  {"--junit", &o->junit},
                  {"--html", &o->html},
                  {"--export", &o->export},
                  {"--picture", &o->picture},
                  {"--limit-memory", &o->limit_memory},
                  {"--limit-time", &o->limit_time},
                  {"--limit-output", &o->limit_output},
                  {"--graphics", &graphics}};
    const struct {
        const char *name;
        bool *flag;
    } plain[] = {{"--keep-going", &o->keep_going},
                 {"--smooth", &o->smooth},
                 {"--read-only", &o->read_only},
                 {"--repair", &o->repair},
                 {"--script", &o->script},
                 {"--check", &o->check},
                 {"--reseal", &o->reseal},
                 {"--bisect", &o->bisect},
                 {"--graph", &o->graph},
                 {"--anonymise", &o->anonymise},
                 {"--json", &o->json},
                 {"--csv", &o->csv},
                 {"--quick", &o->quick}};
    enum { VALUED = sizeof valued / sizeof valued[0], PLAIN = sizeof plain / sizeof plain[0] };
    bool over = false;
    *o = (struct options){.word = word};
    for (int i = 1; i < count; i++) {
        int v = 0, p = 0;
        if (over || word[i][0] != '-' || word[i][1] == '\0') {
            word[o->words++] = word[i];
            continue;
        }
        over = strcmp(word[i], "--") == 0;
        while (v < VALUED && strcmp(word[i], valued[v].name) != 0)
            v++;
        while (p < PLAIN && strcmp(word[i], plain[p].name) != 0)
            p++;
        if (v < VALUED && i + 1 == count)
            return fault_set(fault, ERR_USAGE, "%s needs a value; see iftty --help", word[i]);
        if (v < VALUED)
            *valued[v].value = word[++i];
        else if (p < PLAIN)
            *plain[p].flag = true;
        else if (!over)
            return fault_set(fault, ERR_USAGE, "unknown option %s; see iftty --help", word[i]);
    }
    if (graphics_from_name(graphics, &o->graphics))
        return OK;
    struct buf names = {0};
    graphics_add_names(&names, ", ", " or ");
    fault_set(fault, ERR_USAGE, "--graphics: expected %s, not %s", buf_text(&names), graphics);
    buf_release(&names);
    return ERR_USAGE;
}

static enum err need_files(const struct options *o, int least, int most, struct fault *fault)
{
    int files = o->words - 1;
    if (files >= least && files <= most)
        return OK;
    return fault_set(fault, ERR_USAGE, "%s: expected %s, not %d; see iftty --help", o->word[0],
                     most > least ? "files" : "one file", files);
}

/* ---- programs ---- */

static enum err begin_interpreter(struct interpreter *interp, const struct options *o,
                                  struct fault *fault)
{
    struct buf told = {0};
    enum err err = interpreter_init(interp, fault);
    interp->session.watch = &watch;
    interp->scene_path = o->scene;
    interp->out_folder = o->out;
    interp->looks = o->read_only;
    if (!err && o->out)
        err = file_make_folder(o->out, fault);
    if (!err && o->journal && file_exists(o->journal))
        err = interpreter_resume_journal(interp, o->journal, &told, fault);
    else if (!err && o->journal && o->read_only)
        err = fault_set(fault, ERR_IO, "--read-only: there is no journal %s", o->journal);
    else if (!err && o->journal)
        err = interpreter_create_journal(interp, o->journal, fault);
    progress_erase(&progress);
    if (told.length)
        fprintf(stderr, "iftty: %s", buf_text(&told));
    buf_release(&told);
    return err;
}

/* What waits to be synced when a session ends; `err` is what it ends with. */
static enum err sync_journal(struct interpreter *interp, enum err err, struct fault *fault)
{
    struct fault words;
    enum err synced = interp->journal ? journal_sync(interp->journal, &words) : OK;
    if (synced && !err)
        *fault = words;
    return err ? err : synced;
}

static enum err run_lines(const struct options *o, FILE *input, const char *name,
                          struct fault *fault)
{
    struct interpreter interp;
    const struct teller teller = {(void *)(uintptr_t)o, say, complain, show_picture, wait_idly};
    handle_interrupts();
    enum err err = begin_interpreter(&interp, o, fault);
    if (!err) {
        err = script_run(&interp, input, name, o->keep_going, &teller, fault);
        fault->text[0] = '\0'; /* told with its line */
    }
    err = sync_journal(&interp, err, fault);
    interpreter_release(&interp);
    return err;
}

static enum err program_run(const struct options *o, struct fault *fault)
{
    enum err err = need_files(o, 1, 1, fault);
    if (err)
        return err;
    if (strcmp(o->word[1], "-") == 0)
        return run_lines(o, stdin, "standard input", fault);
    FILE *input = fopen(o->word[1], "re");
    if (!input)
        return fault_errno(fault, "open", o->word[1]);
    err = run_lines(o, input, o->word[1], fault);
    fclose(input);
    return err;
}

/* A line for each command: semicolons part them, but not in quotes, nor in a comment, which goes on
 * to the end of its line. */
static void split_commands(struct buf *lines, const char *at)
{
    bool quoted = false, blank = true, comment = false;
    for (; *at; at++) {
        comment = *at != '\n' && (comment || (blank && *at == '#'));
        if (!comment && *at == '"')
            quoted = !quoted;
        if (quoted && *at == '\\' && at[1])
            buf_add_char(lines, *at++);
        bool parts = *at == '\n' || (*at == ';' && !quoted && !comment);
        buf_add_char(lines, parts ? '\n' : *at);
        quoted = quoted && !parts;
        blank = parts || (blank && *at == ' ');
    }
    buf_add_char(lines, '\n');
}

static enum err program_commands(const struct options *o, struct fault *fault)
{
    struct buf lines = {0};
    split_commands(&lines, o->commands);
    FILE *input = lines.failed ? NULL : fmemopen(lines.data, lines.length, "r");
    enum err err = input ? run_lines(o, input, "-c", fault) : fault_memory(fault, "commands");
    if (input)
        fclose(input);
    buf_release(&lines);
    return err;
}

/* Before anything that a journal says is carried out: its limits, and the walls around it.
 * `written` are folders that may be written, `run` programs that may be run or NULL, both with NULL
 * at their end. */
static enum err be_wary(const struct options *o, char *const *journal, const char *const *written,
                        const char *const *run, struct fault *fault)
{
    struct buf helper = {0};
    struct limits limits;
    enum err err = limits_read(&limits, o->limit_memory, o->limit_time, o->limit_output, fault);
    if (!err)
        err = image_helper_default_program(&helper, fault);
    const struct trust_places places = {.journal = journal,
                                        .journals = 1,
                                        .scene = o->scene,
                                        .scenes = interpreter_scenes(),
                                        .helper = buf_text(&helper),
                                        .written = written,
                                        .run = run};
    if (!err) {
        trust_confine(&places);
        limits_begin(&limits);
    }
    buf_release(&helper);
    return err;
}

static enum err replay_into(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    const struct teller teller = {(void *)(uintptr_t)o, say, complain, NULL, NULL};
    enum err err = begin_interpreter(&interp, o, fault);
    if (!err)
        err = replay_aloud(&interp, o->word[1], &teller, fault);
    interpreter_release(&interp);
    return err;
}

static enum err program_replay(const struct options *o, struct fault *fault)
{
    struct buf fresh = {0};
    struct options here = *o;
    enum err err = need_files(o, 1, 1, fault);
    if (!err)
        err = o->out ? file_make_folder(o->out, fault) : folder_fresh(&fresh, NULL, fault);
    if (err)
        goto done;
    handle_interrupts();
    here.journal = NULL;
    here.out = o->out ? o->out : buf_text(&fresh);
    err = be_wary(o, o->word + 1, (const char *const[]){here.out, NULL}, NULL, fault);
    if (!err)
        err = replay_into(&here, fault);
    if (!o->out && trust_keep_folder(here.out)) {
        struct buf text = {0};
        buf_add_safe(&text, here.out, strlen(here.out));
        progress_erase(&progress);
        fprintf(stderr, "# files are in %s\n", buf_text(&text));
        buf_release(&text);
    }
done:
    buf_release(&fresh);
    return err;
}

/* The number that an option gives, `given` NULL standing for `otherwise`. */
static enum err read_number(const char *option, const char *given, int64_t most, size_t otherwise,
                            size_t *out, struct fault *fault)
{
    const char *at = given;
    int64_t number = (int64_t)otherwise;
    if (given && (!scan_integer(&at, 1, most, &number) || *at))
        return fault_set(fault, ERR_USAGE, "%s: expected a number 1..%lld, not %s", option,
                         (long long)most, given);
    *out = (size_t)number;
    return OK;
}

/* A journal that is sealed anew, with a reason where golden images are accepted. */
static enum err seal_anew(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    const struct teller teller = {NULL, say, complain, NULL, NULL};
    struct options without = *o;
    enum err err = need_files(o, 1, 1, fault);
    if (err)
        return err;
    without.journal = without.out = NULL;
    handle_interrupts();
    err = begin_interpreter(&interp, &without, fault);
    if (!err)
        err = o->accept ? reseal_accept(&interp, o->word[1], o->accept, &teller, fault)
                        : reseal_edited(&interp, o->word[1], &teller, fault);
    interpreter_release(&interp);
    return err;
}

/* The two builds stand behind the walls that a replay stands behind. */
static enum err begin_builds(void *context, const char *folder, const char *const *program,
                             struct fault *fault)
{
    const struct options *o = context;
    return be_wary(o, o->word + 1, (const char *const[]){folder, NULL}, program, fault);
}

static enum err find_first(const struct options *o, struct fault *fault)
{
    const struct teller teller = {NULL, say, complain, NULL, NULL};
    const struct bisect_builds how = {.journal = o->words > 1 ? o->word[1] : NULL,
                                      .other = o->with,
                                      .scene_path = o->scene,
                                      .word = "run",
                                      .watch = &watch,
                                      .begin = begin_builds,
                                      .context = (void *)(uintptr_t)o};
    if (o->words != (o->with ? 2 : 3))
        return fault_set(fault, ERR_USAGE, "--bisect: expected %s; see iftty --help",
                         o->with ? "one journal" : "two journals, or one and --with PROGRAM");
    handle_interrupts();
    return o->with ? bisect_builds(&how, &teller, fault)
                   : bisect_journals(o->word[1], o->word[2], &teller, fault);
}

/* In the process of one journal, before it is carried out. */
static enum err begin_verifying(void *context, const char *journal, struct fault *fault)
{
    const struct options *o = context;
    char *path = (char *)(uintptr_t)journal;
    return be_wary(o, &path, (const char *const[]){o->out, NULL}, NULL, fault);
}

enum { RECORDS_MOST = 999999999 };

static enum err program_verify(const struct options *o, struct fault *fault)
{
    const struct teller teller = {NULL, say, complain, NULL, NULL};
    struct verify_options how = {.path = o->word + 1,
                                 .scene_path = o->scene,
                                 .evidence_folder = o->out,
                                 .junit = o->junit,
                                 .html = o->html,
                                 .begin = begin_verifying,
                                 .context = (void *)(uintptr_t)o,
                                 .watch = &watch};
    size_t processes = 1;
    if (o->accept)
        return seal_anew(o, fault);
    if (o->bisect || o->with)
        return find_first(o, fault);
    enum err err = need_files(o, 1, 1 << 20, fault);
    if (!err)
        err = read_number("-j", o->processes, PROCESSES_MOST, 1, &processes, fault);
    if (!err)
        err = read_number("--from", o->from, RECORDS_MOST, 0, &how.first, fault);
    if (!err)
        err = read_number("--until", o->until, RECORDS_MOST, 0, &how.last, fault);
    if (!err && how.last && how.first > how.last)
        err = fault_set(fault, ERR_USAGE, "--from %zu --until %zu: nothing lies between", how.first,
                        how.last);
    if (!err && o->out)
        err = file_make_folder(o->out, fault);
    if (err)
        return err;
    how.count = (size_t)o->words - 1;
    how.processes = (unsigned)processes;
    handle_interrupts();
    return verify_files(&how, &teller, fault);
}

static enum err program_diff(const struct options *o, struct fault *fault)
{
    const struct teller teller = {NULL, say, complain, NULL, NULL};
    struct diff_options how = {.scene_path = o->scene,
                               .picture = o->picture,
                               .json = o->json,
                               .begin = begin_verifying,
                               .context = (void *)(uintptr_t)o,
                               .watch = &watch};
    if (o->words != 3)
        return fault_set(fault, ERR_USAGE, "%s: expected two journals or scripts; see iftty --help",
                         o->word[0]);
    enum err err = read_number("--until", o->until, RECORDS_MOST, 0, &how.last, fault);
    if (err)
        return err;
    how.path[0] = o->word[1];
    how.path[1] = o->word[2];
    handle_interrupts();
    return diff_journals(&how, &teller, fault);
}

static enum err repair(const char *path, struct fault *fault)
{
    struct buf told = {0};
    enum err err = journal_repair(path, SEMANTICS, &told, fault);
    if (!err)
        puts(buf_text(&told));
    buf_release(&told);
    return err;
}

/* `log --export FILE`, or - for standard output. */
static enum err export_log(const struct options *o, const struct buf *bytes, struct fault *fault)
{
    struct buf text = {0};
    enum err err = provenance_write(&text, file_name(o->word[1]), buf_text(bytes), bytes->length,
                                    o->anonymise, fault);
    if (!err && strcmp(o->export, "-") == 0)
        fputs(buf_text(&text), stdout);
    else if (!err)
        err = file_write(o->export, text.data, text.length, FILE_KEEP, fault);
    buf_release(&text);
    return err;
}

/* `log --graph`: at a terminal no wider than it is, with lines where the locale has them. */
static enum err print_graph(const struct buf *bytes, struct fault *fault)
{
    const bool is_terminal = isatty(STDOUT_FILENO);
    struct buf drawn = {0}, text = {0};
    enum err err = graph_draw(&drawn, buf_text(bytes), bytes->length,
                              is_terminal && crop_locale_is_utf8(), fault);
    if (!err)
        crop_lines(&text, buf_text(&drawn), is_terminal ? crop_columns(STDOUT_FILENO) : 0);
    if (!err && text.failed)
        err = fault_memory(fault, "the graph of a journal");
    if (!err)
        fputs(buf_text(&text), stdout);
    buf_release(&text);
    buf_release(&drawn);
    return err;
}

static enum err program_log(const struct options *o, struct fault *fault)
{
    struct buf bytes = {0}, text = {0};
    struct journal_condition condition;
    if (o->reseal)
        return seal_anew(o, fault);
    enum err err = need_files(o, 1, 1, fault);
    if (!err && o->repair)
        return repair(o->word[1], fault);
    if (!err)
        err = file_read(&bytes, o->word[1], JOURNAL_BYTES_MAX, fault);
    if (!err && o->check) {
        err = journal_check(&condition, buf_text(&bytes), bytes.length, fault);
        if (!err)
            puts(condition.text);
    } else if (!err && o->graph) {
        err = print_graph(&bytes, fault);
    } else if (!err && o->export) {
        err = export_log(o, &bytes, fault);
    } else if (!err && o->anonymise) {
        err = anonymise_script(&text, buf_text(&bytes), bytes.length, fault);
    } else if (!err && o->script) {
        err = journal_script(&text, buf_text(&bytes), bytes.length, fault);
    } else if (!err) {
        buf_add(&text, buf_text(&bytes), bytes.length);
    }
    for (const char *at = buf_text(&text), *end = at + text.length; at < end;) {
        struct buf line = {0};
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        size_t n = feed ? (size_t)(feed - at) : (size_t)(end - at);
        buf_add_safe(&line, at, n);
        puts(buf_text(&line));
        buf_release(&line);
        at += n + 1;
    }
    buf_release(&text);
    buf_release(&bytes);
    return err;
}

/* What this program is here, where no file is named: its version, and the kernel's walls. */
static enum err tell_program(const struct options *o)
{
    const int landlock = confine_version();
    if (o->json) {
        printf("{\"version\": \"" PROGRAM_VERSION "\", \"semantics\": %d, \"landlock\": %d}\n",
               SEMANTICS, landlock);
        return OK;
    }
    puts("version   " PROGRAM_VERSION);
    printf("semantics %d\n", SEMANTICS);
    if (landlock)
        printf("landlock  version %d: replay and verify reach only the files they may\n", landlock);
    else
        puts("landlock  none in this kernel: replay and verify check names alone");
    return OK;
}

/* What a picture, a scene or a journal says of itself. */
static enum err program_info(const struct options *o, struct fault *fault)
{
    if (o->words == 1)
        return tell_program(o);
    struct buf program = {0}, text = {0};
    struct image_helper *helper = NULL;
    enum err err = need_files(o, 1, 1, fault);
    if (!err)
        err = image_helper_default_program(&program, fault);
    if (!err)
        err = image_helper_new(&helper, buf_text(&program), fault);
    if (!err)
        err = about_file(&text, o->word[1], o->json, helper, fault);
    fputs(buf_text(&text), stdout);
    image_helper_free(helper);
    buf_release(&text);
    buf_release(&program);
    return err;
}

/* Fine, and silent, where standard output is no terminal. */
static enum err program_show(const struct options *o, struct fault *fault)
{
    struct buf program = {0};
    struct image_helper *helper = NULL;
    struct picture picture = {0};
    enum err err = need_files(o, 1, 1, fault);
    if (!err)
        err = image_helper_default_program(&program, fault);
    if (!err)
        err = image_helper_new(&helper, buf_text(&program), fault);
    if (!err)
        err = image_helper_read(helper, o->word[1], &picture, fault);
    if (!err) {
        struct image_view view = {
            .width = picture.width, .height = picture.height, .rgba = picture.rgba};
        show_picture_once(o->graphics, &view);
    }
    picture_release(&picture);
    image_helper_free(helper);
    buf_release(&program);
    return err;
}

static enum err bench_paper_by(const struct options *o, struct fault *fault)
{
    struct bench_paper_options how = {
        .scene = o->word + 2,
        .scenes = o->words - 2,
        .rounds = 3,
        .quick = o->quick,
        .form = o->json  ? BENCH_JSON
                : o->csv ? BENCH_CSV
                         : BENCH_TEXT,
        .plots = o->plots,
        .watch = &watch,
        .say = say,
    };
    const char *at = o->rounds;
    int64_t rounds;
    if (at && (!scan_integer(&at, 1, 99, &rounds) || *at))
        return fault_set(fault, ERR_USAGE, "--rounds: expected a number 1..99, not %s", o->rounds);
    how.rounds = o->rounds ? (unsigned)rounds : how.rounds;
    if (o->json && o->csv)
        return fault_set(fault, ERR_USAGE, "--json or --csv, not both");
    handle_interrupts();
    return bench_paper(&how, fault);
}

enum bench { BENCH_BRAIN, BENCH_PAPER, BENCH_GROWTH, BENCH_RENDER, BENCH_JOURNAL, BENCH_TERMINAL };

static enum err program_bench(const struct options *o, struct fault *fault)
{
    static const char names[] = "brain|paper|growth|render|journal|terminal";
    const int bench = o->words > 1 ? choice_find(names, o->word[1]) : BENCH_BRAIN;
    switch (bench) {
    case BENCH_BRAIN:
        return bench_brain(o->scene, o->json, stdout, fault);
    case BENCH_PAPER:
        return bench_paper_by(o, fault);
    case BENCH_GROWTH:
        handle_interrupts();
        return bench_growth(o->json, o->quick, stdout, &watch, fault);
    case BENCH_RENDER:
        handle_interrupts();
        return bench_render(o->json, stdout, &watch, fault);
    case BENCH_JOURNAL:
        return bench_journal(o->words > 2 ? o->word[2] : NULL, o->json, stdout, fault);
    case BENCH_TERMINAL:
        return bench_terminal(o->json, o->quick, stdout, fault);
    }
    return fault_set(fault, ERR_USAGE,
                     "bench: expected brain, paper, growth, render, journal or terminal, not %s",
                     o->word[1]);
}

static enum err program_help(const struct options *o, struct fault *fault)
{
    struct buf text = {0};
    const struct command *command = o->words > 1 ? command_find(o->word[1]) : NULL;
    if (o->words > 1 && !command)
        return command_unknown(fault, "there is no command", "`iftty help`", o->word[1]);
    command_help(&text, command);
    fputs(buf_text(&text), stdout);
    buf_release(&text);
    return OK;
}

/* ---- the prompt ---- */

struct prompt {
    struct pilot_interpreter pilot; /* first: the pilot's host has this whole as its context */
    struct pilot_host host;
    struct interpreter interp;
    struct reply reply;
    char name[24];     /* before the "> " */
    const char *first; /* opened once the prompt is there, so that the prompt is there at once */
    bool resumes;
};

static void prompt_text(void *context, struct buf *out)
{
    const struct prompt *prompt = context;
    buf_add_safe(out, prompt->name, strlen(prompt->name));
    buf_add_text(out, "> ");
}

static enum err prompt_execute(void *context, const char *line, struct buf *output,
                               struct fault *fault)
{
    struct prompt *prompt = context;
    interrupted = 0;
    enum err err = interpreter_execute(&prompt->interp, line, &prompt->reply, fault);
    progress_erase(&progress);
    if (!err)
        buf_add_text(output, buf_text(&prompt->reply.text));
    return err;
}

/* The scene or journal named on the command line, and what a new session begins with. */
static enum err prompt_begin(void *context, struct buf *output, struct fault *fault)
{
    struct prompt *prompt = context;
    struct buf line = {0};
    enum err err = OK;
    if (prompt->resumes) {
        err = interpreter_resume_journal(&prompt->interp, prompt->first, output, fault);
        progress_erase(&progress);
        if (!err)
            buf_printf(output, "%zu records, resumed as they left it\n",
                       journal_count(prompt->interp.journal));
        if (err == ERR_CANCELLED)
            fault_set(fault, err, "cannot resume %s: cancelled; it is as it was", prompt->first);
        return err;
    }
    if (prompt->first) {
        buf_add_text(&line, "open ");
        command_write_word(&line, prompt->first);
        err = prompt_execute(prompt, buf_text(&line), output, fault);
    }
    if (!err)
        err = prompt_execute(prompt, "auto on", output, fault);
    buf_release(&line);
    return err;
}

static void prompt_complete(void *context, const char *line, size_t cursor, struct buf *candidates,
                            size_t *word_start)
{
    const struct prompt *prompt = context;
    command_complete(candidates, word_start, line, cursor, &prompt->interp);
}

static void prompt_hint(void *context, const char *line, size_t length, struct buf *out)
{
    (void)context;
    command_hint(out, line, length);
}

static bool prompt_picture(void *context, struct image_view *out)
{
    struct prompt *prompt = context;
    struct interpreter *interp = &prompt->interp;
    bool shows = interp->shows_picture;
    interp->shows_picture = false;
    *out = view_of(interp, prompt->pilot.smooth);
    return shows;
}

static bool prompt_finished(void *context)
{
    const struct prompt *prompt = context;
    return prompt->interp.finished;
}

static bool prompt_wants_screen(void *context)
{
    struct prompt *prompt = context;
    const bool flies = prompt->interp.flies;
    prompt->interp.flies = false;
    return flies;
}

static enum err prompt_screen(void *context, struct terminal_facts *facts,
                              struct line_editor *editor, bool *ended, struct fault *fault)
{
    const struct prompt *prompt = context;
    return pilot_run(&prompt->host, facts, editor, ended, fault);
}

static void prompt_news(void *context, struct buf *output)
{
    struct prompt *prompt = context;
    picture_writer_news(prompt->interp.writer, output);
}

/* The session is over when what it wrote is on the disk; Ctrl-C gives up what is not begun. */
static void finish_pictures(struct prompt *prompt)
{
    struct buf text = {0};
    interrupted = 0;
    watch_begin(&watch);
    picture_writer_wait(prompt->interp.writer, &watch, NULL);
    progress_erase(&progress);
    picture_writer_news(prompt->interp.writer, &text);
    fputs(buf_text(&text), stdout);
    buf_release(&text);
}

/* "ch2" for /data/ch2.nii.gz; NAME-N.iftty for the first N that is free here. */
static void name_session(struct prompt *prompt, struct buf *journal)
{
    const char *name = prompt->first ? file_name(prompt->first) : "session";
    size_t n = strcspn(name, ".:");
    n = n ? n : strlen(name);
    snprintf(prompt->name, sizeof prompt->name, "%.*s", (int)(n < 20 ? n : 20), name);
    for (unsigned i = 1; i < 100000; i++) {
        buf_clear(journal);
        buf_add(journal, name, n);
        buf_printf(journal, "-%u.iftty", i);
        if (!file_exists(buf_text(journal)))
            break;
    }
}

static enum err program_prompt(const struct options *o, struct fault *fault)
{
    static struct prompt prompt; /* large */
    struct buf journal = {0};
    if (o->words > 1)
        return fault_set(fault, ERR_USAGE, "one scene or journal at a time; see iftty --help");
    if (o->read_only && !o->journal && !(o->words && interpreter_is_journal(o->word[0])))
        return fault_set(fault, ERR_USAGE, "--read-only: name the journal to look at");
    prompt.first = o->words ? o->word[0] : NULL;
    prompt.resumes = prompt.first && interpreter_is_journal(prompt.first);
    if (prompt.resumes && o->journal)
        return fault_set(fault, ERR_USAGE, "%s is a journal itself and goes on in its own file",
                         prompt.first);
    name_session(&prompt, &journal);
    if (isatty(STDIN_FILENO)) /* else nobody is there to go on */
        handle_interrupts();
    enum err err = begin_interpreter(&prompt.interp, o, fault);
    if (!o->journal && !prompt.resumes)
        prompt.interp.new_journal = buf_text(&journal);
    /* Without it, which is no reason to stop, pictures are waited for. */
    if (!err && isatty(STDIN_FILENO) && isatty(STDOUT_FILENO))
        interpreter_write_beside(&prompt.interp, NULL);
    struct picture_writer *writer = prompt.interp.writer;
    prompt.host = (struct pilot_host){
        .context = &prompt, .execute = prompt_execute, .finished = prompt_finished};
    pilot_host_fill(&prompt.host);
    prompt.pilot.interp = &prompt.interp;
    prompt.pilot.smooth = o->smooth;
    prompt.interp.has_cockpit = isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
    const struct repl_host host = {.context = &prompt,
                                   .wants_screen = prompt_wants_screen,
                                   .screen = prompt_screen,
                                   .screen_line = "pilot",
                                   .begin = prompt_begin,
                                   .prompt = prompt_text,
                                   .execute = prompt_execute,
                                   .complete = prompt_complete,
                                   .hint = prompt_hint,
                                   .picture = prompt_picture,
                                   .news = writer ? prompt_news : NULL,
                                   .news_descriptor =
                                       writer ? picture_writer_descriptor(writer) : -1,
                                   .finished = prompt_finished};
    struct buf history = {0};
    const bool keeps = line_history_path(&history);
    const struct repl_options how = {o->graphics, keeps ? buf_text(&history) : NULL};
    if (!err)
        err = repl_run(&host, &how, fault);
    buf_release(&history);
    if (writer)
        finish_pictures(&prompt);
    err = sync_journal(&prompt.interp, err, fault);
    if (prompt.interp.journal && isatty(STDOUT_FILENO)) {
        struct buf text = {0};
        const char *path = journal_path(prompt.interp.journal);
        buf_add_safe(&text, path, strlen(path));
        printf("journal: %s (%zu records%s)\n", buf_text(&text),
               journal_count(prompt.interp.journal),
               journal_only_looks(prompt.interp.journal) ? ", not written to" : "");
        buf_release(&text);
    }
    reply_release(&prompt.reply);
    pilot_interpreter_release(&prompt.pilot);
    interpreter_release(&prompt.interp);
    buf_release(&journal);
    return err;
}

int main(int count, char **word)
{
    static const struct {
        const char *name;
        enum err (*run)(const struct options *o, struct fault *fault);
    } program[] = {{"run", program_run},     {"replay", program_replay}, {"verify", program_verify},
                   {"log", program_log},     {"show", program_show},     {"info", program_info},
                   {"bench", program_bench}, {"help", program_help},     {"diff", program_diff}};
    struct options options;
    struct fault fault = {0};
    signal(SIGPIPE, SIG_IGN); /* a closed pipe is an error that a write returns */
    progress_init(&progress, STDERR_FILENO);
    for (int i = 1; i < count; i++) {
        if (strcmp(word[i], "--help") == 0 || strcmp(word[i], "-h") == 0) {
            fputs(usage, stdout);
            return 0;
        }
        if (strcmp(word[i], "--version") == 0) {
            puts("iftty " PROGRAM_VERSION);
            return 0;
        }
    }
    enum err err = read_options(&options, count, word, &fault);
    if (err)
        return finish(err, &fault);
    if (options.commands)
        return finish(program_commands(&options, &fault), &fault);
    for (size_t i = 0; options.words && i < sizeof program / sizeof program[0]; i++)
        if (strcmp(options.word[0], program[i].name) == 0)
            return finish(program[i].run(&options, &fault), &fault);
    return finish(program_prompt(&options, &fault), &fault);
}
