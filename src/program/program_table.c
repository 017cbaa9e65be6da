/* SPDX-License-Identifier: MIT */
/* The table of programs, and that of their options. */
#include "program/programs.h"

#include <string.h>

#include "apply/apply.h"
#include "session/map.h"
#include "verify/verify.h"

/* ---- options ---- */

enum { RECORDS_MOST = 999999999 };

/* Rows of the table below, by the programs that take them. */
enum { JOURNAL = 1, READ_ONLY, SCENE, OUT, REPLAY_OUT, EVIDENCE_OUT, WHOLE, KEEP_GOING };
enum { GRAPHICS = KEEP_GOING + 1, SMOOTH };
enum { PROCESSES = SMOOTH + 1, FROM, UNTIL, DIFF_UNTIL, STRICT, NO_STRICT, EXPECT };
enum { SHARD = EXPECT + 1, FAIL_FAST, TIMINGS, REMOVE_ORPHANS, JUNIT, HTML };
enum { JSON = HTML + 1, CSV, REGIONS, AS, BINARY, RESAMPLE, HISTOGRAM, VOLUME };
enum { PICTURE = VOLUME + 1, SLICES, SURFACE, SLICES_SCENE };
enum { FROM_STEP = SLICES_SCENE + 1, UNTIL_STEP, BY, PLANT_AS, FIT, LANDMARKS_OF, ORIENT };
enum { APPLY_OUT = ORIENT + 1, PROCEDURE_SCENE };
enum { LIMIT_MEMORY = PROCEDURE_SCENE + 1, LIMIT_TIME, LIMIT_OUTPUT, UNCONFINED };
enum { COMMANDS = UNCONFINED + 1, VERSION, BISECT, ACCEPT, ONLY, SCRIPT, CHECK };
enum { ANONYMISE = CHECK + 1, REPAIR, RESEAL, PROCEDURE };

static enum err read_graphics(const struct option *option, const char *text, void *out,
                              struct fault *fault)
{
    struct options *o = out;
    if (graphics_from_name(text, &o->graphics))
        return OK;
    struct buf names = {0};
    option->add_choices(&names, ", ", " or ");
    fault_set(fault, ERR_USAGE, "%s: expected %s, not %s", option->name, buf_text(&names), text);
    buf_release(&names);
    return ERR_USAGE;
}

#define FLAG(member) option_read_flag, offsetof(struct options, member), 0, 0, NULL
#define TEXT(member) option_read_text, offsetof(struct options, member), 0, 0, NULL
#define NUMBER(member, least, most)                                                                \
    option_read_number, offsetof(struct options, member), least, most, NULL
#define LIST(member, least, most)                                                                  \
    option_read_list, offsetof(struct options, member), least, most, NULL
#define FORM NULL, "", FLAG(is_form)

static const struct option option[] = {
    {0},
    [JOURNAL] = {"--journal", "FILE", "record there; an existing journal is resumed",
                 TEXT(journal)},
    [READ_ONLY] = {"--read-only", NULL,
                   "resume the journal for looking: it is neither written to nor locked",
                   FLAG(read_only)},
    [SCENE] = {"--scene", "FILE", "open this scene, whatever name `open` gives", TEXT(scene)},
    [OUT] = {"--out", "DIR", "write files into this folder", TEXT(out)},
    [REPLAY_OUT] = {"--out", "DIR", "write files into this folder, else into a new temporary one",
                    TEXT(out)},
    [EVIDENCE_OUT] = {"--out", "DIR",
                      "leave there what a golden image differs by, in N/ for the Nth journal where "
                      "several have one name",
                      TEXT(out)},
    [WHOLE] = {"--whole", NULL,
               "the journal appears when all is done: until then it is FILE.part, which the run "
               "goes on with when it is repeated",
               FLAG(whole)},
    [KEEP_GOING] = {"--keep-going", NULL, "do not stop at the first error", FLAG(keep_going)},
    [GRAPHICS] = {"--graphics", "HOW",
                  "how pictures are shown, whatever the terminal says of itself", read_graphics, 0,
                  0, 0, graphics_add_names},
    [SMOOTH] = {"--smooth", NULL,
                "pictures at the terminal in 24 bits, where it can, for four times the bytes",
                FLAG(smooth)},
    [PROCESSES] = {"-j", "N", "verify N journals at once (1..64; 1)",
                   NUMBER(processes, 1, PROCESSES_MOST)},
    [FROM] = {"--from", "N", "compare no record before this one", NUMBER(from, 1, RECORDS_MOST)},
    [UNTIL] = {"--until", "N", "compare no record after this one", NUMBER(until, 1, RECORDS_MOST)},
    [DIFF_UNTIL] = {"--until", "N", "carry out no record after this one",
                    NUMBER(until, 1, RECORDS_MOST)},
    [STRICT] = {"--strict", NULL,
                "fail on incomplete evidence: a torn tail, a record without its digest, no golden "
                "image, a file next to golden images that no record names; the default where CI "
                "is set",
                FLAG(strict)},
    [NO_STRICT] = {"--no-strict", NULL, "such journals pass, also where CI is set",
                   FLAG(no_strict)},
    [EXPECT] = {"--expect", "CHAIN", "fail unless the journal's last chain is this, 32 digits",
                TEXT(expect)},
    [SHARD] = {"--shard", "K/N",
               "verify the Kth of N parts; a journal stays in its part when others are added",
               TEXT(shard)},
    [FAIL_FAST] = {"--fail-fast", NULL, "stop at the first journal that fails", FLAG(fail_fast)},
    [TIMINGS] = {"--timings", NULL, "print the ten slowest records of each journal", FLAG(timings)},
    [REMOVE_ORPHANS] = {"--remove-orphans", NULL,
                        "delete golden images that their journal does not name, where its records "
                        "can have made them; refused where CI is set",
                        FLAG(remove_orphans)},
    [JUNIT] = {"--junit", "FILE", "a report for other programs, written anew", TEXT(junit)},
    [HTML] = {"--html", "FILE",
              "a report as a page with the pictures of each failure, written anew", TEXT(html)},
    [JSON] = {"--json", NULL, "print JSON", FLAG(json)},
    [HISTOGRAM] = {"--histogram", NULL, "of a scene, whose voxels are read too", FLAG(histogram)},
    [VOLUME] = {"--volume", "N[,N]",
                "of files that hold several volumes take this one, counted from 0; of several "
                "files one number each, the last for all that follow",
                LIST(volume, 0, 65535)},
    [PICTURE] = {"--picture", "FILE.png",
                 "draw both renditions, and where they differ, side by side", TEXT(picture)},
    [CSV] = {"--csv", NULL, "print CSV, a line for each label", FLAG(csv)},
    [SLICES] = {"--picture", "FILE.png",
                "draw slices through where they are farthest apart, with what differs",
                TEXT(picture)},
    [SLICES_SCENE] = {"--scene", "FILE", "the scene of those slices, which else show A",
                      TEXT(scene)},
    [SURFACE] =
        {"--surface", "FILE.png",
         "draw A's surface, red where it lies outside B, blue where inside, by the distance",
         TEXT(surface)},
    [REGIONS] = {"--regions", "LIST",
                 "compare these values of both maps alone, as 1-90,2001 (all above 0)",
                 LIST(regions, 0, REGION_MOST)},
    [AS] = {"--as", "LIST", "the labels, of 255 at most, that those become: 1-90,91",
            LIST(as, 0, 255)},
    [BINARY] = {"--binary", NULL, "take all of them for one object, label 1", FLAG(binary)},
    [RESAMPLE] = {"--resample", NULL, "take the nearest voxels of a B that lies elsewhere",
                  FLAG(resample)},
    [FROM_STEP] = {"--from", "N", "begin at this step", NUMBER(from, 1, RECORDS_MOST)},
    [UNTIL_STEP] = {"--until", "N", "end after this step", NUMBER(until, 1, RECORDS_MOST)},
    [BY] =
        {"--by", "WAY",
         "world (same millimetres), landmarks, affine (by the intensities of both; the default), "
         "or a FILE with a transform of ITK, or fsl:FILE",
         TEXT(by)},
    [PLANT_AS] = {"--as", "WHAT",
                  "labels (what it came to, eroded; the default) or seeds (its gestures)",
                  TEXT(as)},
    [FIT] = {"--fit", "KIND", "of landmarks: " CARRY_FITS "; the most that they say, unless given",
             TEXT(fit)},
    [LANDMARKS_OF] = {"--landmarks", "FILE",
                      "of the subject: lines NAME X,Y,Z in mm, or a journal of its scene",
                      TEXT(landmarks)},
    [ORIENT] = {"--orient", "HOW",
                "what `orient` is to say of scenes whose files do not say it, as RAS",
                TEXT(orient)},
    [APPLY_OUT] = {"--out", "DIR", "the journals go into this folder, else into the present one",
                   TEXT(out)},
    [PROCEDURE_SCENE] = {"--scene", "FILE", "the procedure's scene, whatever name `open` gives",
                         TEXT(scene)},
    [LIMIT_MEMORY] = {"--limit-memory", "SIZE",
                      "the most memory that a journal may take, as 2G (3/4 of what is free)",
                      TEXT(limit_memory)},
    [LIMIT_TIME] = {"--limit-time", "TIME", "the most time, as 90s, 20m or 1.5h (1h)",
                    TEXT(limit_time)},
    [LIMIT_OUTPUT] = {"--limit-output", "SIZE", "the most bytes of files written, as 500M (4G)",
                      TEXT(limit_output)},
    [UNCONFINED] = {"--unconfined", NULL,
                    "have libraries read the journal's files though this kernel has no Landlock, "
                    "which would keep them to those files",
                    FLAG(unconfined)},
    [COMMANDS] = {"-c", "'COMMAND; COMMAND'", "", TEXT(commands)},
    [VERSION] = {"--version", FORM},
    [BISECT] = {"--bisect", FORM},
    [ACCEPT] = {"--accept", "WHY", "", TEXT(accept)},
    [ONLY] = {"--only", "NAME,...", "accept these golden images alone; others stay as they are",
              TEXT(only)},
    [SCRIPT] = {"--script", FORM},
    [CHECK] = {"--check", FORM},
    [ANONYMISE] = {"--anonymise", FORM},
    [REPAIR] = {"--repair", FORM},
    [RESEAL] = {"--reseal", FORM},
    [PROCEDURE] = {"--procedure", "FILE", "", TEXT(procedure)},
};

/* ---- programs ---- */

enum { FILES_MOST = 1 << 20 };

#define SESSION_OPTIONS JOURNAL, READ_ONLY, SCENE, OUT, GRAPHICS, SMOOTH
#define LIMIT_OPTIONS   LIMIT_MEMORY, LIMIT_TIME, LIMIT_OUTPUT, UNCONFINED

/* Name, form, operands, the least and the most of them. */
static const struct program program[] = {
    {NULL, NULL, "[SCENE|JOURNAL]", 0, 1, .option = {SESSION_OPTIONS},
     .summary = "the prompt, on a new scene or a journal", .run = run_prompt},
    {NULL, "-c", "", 0, 0, .option = {COMMANDS, SESSION_OPTIONS, WHOLE, KEEP_GOING},
     .summary = "carry out these commands", .run = run_commands},
    {"run", NULL, "FILE|-", 1, 1, .option = {SESSION_OPTIONS, WHOLE, KEEP_GOING, JSON},
     .summary = "carry out the commands of a script or journal",
     .detail = "Each command is acknowledged, once its record is on the disk, by a line that "
               "begins `ok N`, where N is the number of the record, or `ok -` for a command that "
               "changes nothing and has none, and repeats the command. The first error ends the "
               "run. One that was interrupted goes on after its last record when it is repeated "
               "with the same --journal; where script and journal differ, nothing is added.\n"
               "For a batch: --whole, and --json for one object in place of those lines. No "
               "terminal is needed. Exit status: 0 all was carried out, or was there; 1 a golden "
               "image differs; 2 bad usage, also of a command; 3 bad input or I/O, a full disk "
               "too; 130 Ctrl-C.",
     .run = run_script},
    {"serve", NULL, "[SCENE|JOURNAL]", 0, 1, .option = {JOURNAL, READ_ONLY, SCENE, OUT},
     .summary = "a session for a script: lines of JSON",
     .detail = "Requests on standard input and answers on standard output, one a line: "
               "{\"id\": 1, \"do\": \"seed 90,108,90 1\"} is a command as at the prompt, "
               "{\"id\": 2, \"array\": \"labels\"} gives voxels in a file, {\"cancel\": 1} "
               "stops a command. The first line of the answers says the number of the protocol and "
               "what is open. A journal is begun as by the prompt. src/program/README.md has all "
               "of it, and examples/python a client.",
     .run = run_serve},
    {"replay", NULL, "JOURNAL", 1, 1, .option = {SCENE, REPLAY_OUT, LIMIT_OPTIONS},
     .summary = "carry a journal out again, compare results",
     .detail = "The journal may be a stranger's: it reads the scene that it names, writes below "
               "one folder, and takes no more than the limits allow.",
     .run = run_replay},
    {"verify", NULL, "JOURNAL...", 1, FILES_MOST,
     .option = {PROCESSES, FROM, UNTIL, STRICT, NO_STRICT, EXPECT, SHARD, FAIL_FAST, TIMINGS,
                REMOVE_ORPHANS, JSON, JUNIT, HTML, EVIDENCE_OUT, SCENE, LIMIT_OPTIONS},
     .summary = "the same quietly, with golden images; TAP",
     .detail = "A folder stands for all journals *.iftty in it and below. Each journal is carried "
               "out in a process of its own, by the rules of `replay`. Nothing is written but what "
               "these options name.",
     .run = run_verify},
    {"verify", "--bisect", "A B", 2, 2, .option = {BISECT},
     .summary = "the first record that differs in two journals", .run = run_verify_bisect},
    {"verify", "--accept", "JOURNAL", 1, 1, .option = {ACCEPT, ONLY, SCENE},
     .summary = "make golden images anew, and record why",
     .detail = "Those that differ or are missing. Refused where CI is set: this is a person's "
               "decision. The former journal is kept "
               "beside the new one.",
     .run = run_accept},
    {"tutorial", NULL, "[JOURNAL]", 0, 1, .option = {GRAPHICS, SMOOTH},
     .summary = "a first organ in ten minutes, step by step",
     .detail = "A session at prompt and pilot on the head ch2 of Debian's mricron-data, which says "
               "what to do next. A step has come when what it is about is there, however that was "
               "done: seeds, and Dice's coefficient with mricron's own extraction of the brain. "
               "JOURNAL is one that was left midway. Nothing but the journal stays behind.",
     .run = run_tutorial},
    {"watch", NULL, "JOURNAL", 1, 1,
     .option = {FROM_STEP, UNTIL_STEP, SCENE, GRAPHICS, SMOOTH, LIMIT_OPTIONS},
     .summary = "watch how a journal was made, step by step",
     .detail = "Replays the journal by the rules of `replay`, and shows its steps in the pilot: "
               "Space goes on, Backspace back, 20G to step 20, c shows the comments of a step, ? "
               "all keys. A gesture is drawn before it is carried out, and what it changed is "
               "hatched. Nothing is written. At the end it says whether the journal is verified.",
     .run = run_watch},
    {"diff", NULL, "A B", 2, 2, .option = {DIFF_UNTIL, JSON, PICTURE, SCENE, LIMIT_OPTIONS},
     .summary = "where two journals part; how labels differ",
     .detail = "The first command that differs and, for each label, the voxels in both and "
               "Dice's coefficient. A and B may be scripts as well.",
     .run = run_diff},
    {"apply", NULL, "PROCEDURE SCENE...", 2, FILES_MOST,
     .option = {BY, PLANT_AS, VOLUME, APPLY_OUT, LANDMARKS_OF, FIT, ORIENT, PROCEDURE_SCENE, JSON,
                LIMIT_OPTIONS},
     .summary = "carry a procedure to other scenes",
     .detail =
         "PROCEDURE is a journal, which is carried out by the rules of `replay`, or what "
         "`iftty log --procedure` writes. Each SCENE comes to a journal SCENE.iftty, whole or "
         "not at all, that can be corrected and verified as any other. One that is there is "
         "skipped where it is what would be made. Seeds whose intensities are none of the "
         "object are dropped, and counted. Status 1: a scene was refused.",
     .run = run_apply},
    {"compare", NULL, "A B", 2, 2,
     .option = {VOLUME, REGIONS, AS, BINARY, RESAMPLE, JSON, CSV, SLICES, SLICES_SCENE, SURFACE},
     .summary = "how far two label maps agree",
     .detail = "For each label, and all together: overlap (Dice, Jaccard), volumes, and distances "
               "between the two objects and their surfaces, as the command `compare` prints them. "
               "Both maps lie on one grid, or B is resampled to that of A.",
     .run = run_compare},
    {"log", NULL, "JOURNAL", 1, 1, .summary = "print a journal", .run = run_log},
    {"log", "--script", "JOURNAL", 1, 1, .option = {SCRIPT}, .summary = "its commands alone",
     .run = run_log_script},
    {"log", "--anonymise", "JOURNAL", 1, 1, .option = {ANONYMISE, SCRIPT},
     .summary = "the same without names of files and free text", .run = run_log_anonymise},
    {"log", "--check", "JOURNAL", 1, 1, .option = {CHECK},
     .summary = "whether it is intact, torn or edited",
     .detail = "By the chain of its records alone: nothing is carried out.", .run = run_log_check},
    {"log", "--procedure", "JOURNAL", 1, 1, .option = {PROCEDURE, SCENE, LIMIT_OPTIONS},
     .summary = "what `apply` needs of it, and no image",
     .detail =
         "Labels and their grid, percentiles of intensities, gestures, landmarks, weights and "
         "finish, as text into FILE; where that is -, it is printed. No image, no comment, and "
         "no name of a file; labels keep theirs. Nothing is overwritten.",
     .run = run_log_procedure},
    {"log", "--repair", "JOURNAL", 1, 1, .option = {REPAIR},
     .summary = "keep what is sound, and the rest beside it", .run = run_log_repair},
    {"log", "--reseal", "JOURNAL", 1, 1, .option = {RESEAL, ACCEPT, SCENE},
     .summary = "give an edited journal its results anew",
     .detail = "With --accept "
               "WHY golden images are made anew in the same step, as by `verify --accept`; without "
               "it they are left alone, and such a journal is refused where they are others. The "
               "former journal is kept beside the new one.",
     .run = run_reseal},
    {"show", NULL, "PICTURE", 1, 1, .option = {GRAPHICS, SMOOTH},
     .summary = "show a picture inline, if the terminal can",
     .detail = "Prints nothing where standard output is no terminal.", .run = run_show},
    {"info", NULL, "[FILE]", 0, 1, .option = {JSON, HISTOGRAM, VOLUME},
     .summary = "what a picture, scene, journal or iftty is",
     .detail = "Without FILE: the version, and how the kernel confines `replay` and `verify`.",
     .run = run_info},
    {"help", NULL, "[COMMAND|PROGRAM]", 0, 1,
     .summary = "the commands of prompt, script and journal",
     .detail = "`iftty help keys` lists the keys of the prompt.", .run = run_help},
    {NULL, "--version", "", 0, 0, .option = {VERSION},
     .summary = "versions of program, semantics, libraries", .run = run_version},
};

const struct program_table program_table = {
    .called = "iftty",
    .about = "iftty: segment 3-D scenes by seeds, in a terminal",
    .closing = "`iftty PROGRAM --help` has the options of a program. `--option=VALUE` is\n"
               "`--option VALUE`; -V is --version, -h is --help.\n"
               "Ctrl-C cancels the command at hand; run, -c and replay end with it.\n"
               "Exit status: 0 fine, 1 a check failed, 2 bad usage, 3 bad input or I/O,\n"
               "130 Ctrl-C.\n",
    .row = program,
    .rows = sizeof program / sizeof program[0],
    .option = {option, sizeof option / sizeof option[0]},
};
