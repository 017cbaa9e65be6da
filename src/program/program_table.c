/* SPDX-License-Identifier: MIT */
/* Table of programs, and table of their options. */
#include "program/programs.h"

#include <string.h>

#include "apply/apply.h"
#include "base/mem.h"
#include "session/map.h"
#include "verify/verify.h"

/* ---- options ---- */

enum { RECORDS_MOST = 999999999 };

/* Rows of the table below, grouped by the programs that have them. */
enum {
    JOURNAL = 1,
    READ_ONLY,
    WHO,
    TIMES,
    SCENE,
    CHANNEL,
    OUT,
    REPLAY_OUT,
    EVIDENCE_OUT,
    WHOLE,
    KEEP_GOING
};
enum { GRAPHICS = KEEP_GOING + 1, SMOOTH };
enum { PROCESSES = SMOOTH + 1, FROM, UNTIL, DIFF_UNTIL, STRICT, NO_STRICT, EXPECT };
enum { SHARD = EXPECT + 1, FAIL_FAST, TIMINGS, REMOVE_ORPHANS, JUNIT, HTML };
enum { JSON = HTML + 1, CSV, REGIONS, AS, BINARY, RESAMPLE, HISTOGRAM, VOLUME };
enum { VOLUMES = VOLUME + 1, PICTURE, SLICES, SURFACE, SLICES_SCENE };
enum { FROM_STEP = SLICES_SCENE + 1, UNTIL_STEP, BY, PLANT_AS, FIT, LANDMARKS_OF, ORIENT };
enum { APPLY_OUT = ORIENT + 1, PROCEDURE_SCENE };
enum { LIMIT_MEMORY = PROCEDURE_SCENE + 1, LIMIT_TIME, LIMIT_OUTPUT, UNCONFINED };
enum { COMMANDS = UNCONFINED + 1, VERSION, BISECT, ACCEPT, ONLY, SCRIPT, CHECK };
enum { ANONYMISE = CHECK + 1, PAGE, COMPARE_WITH, STEPS, LOG_TIMES, REPAIR, RESEAL, PROCEDURE };

static enum err read_graphics(const struct option *option, const char *text, void *out,
                              struct fault *fault)
{
    struct options *o = out;
    return graphics_read(text, option->name, &o->graphics, fault);
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
    [JOURNAL] = {"--journal", "FILE", "record in this journal; resume it if it exists",
                 TEXT(journal)},
    [READ_ONLY] = {"--read-only", NULL, "resume the journal without writing to it or locking it",
                   FLAG(read_only)},
    [WHO] = {"--who", "NAME", "sign each new record with this name; makes the chain differ",
             TEXT(who)},
    [TIMES] = {"--times", NULL, "sign each new record with its UTC time", FLAG(times)},
    [SCENE] = {"--scene", "FILE", "open this scene instead of the one that `open` names",
               TEXT(scene)},
    [CHANNEL] = {"--channel", "FILE",
                 "read this file for the next `channel FILE` of a journal; may be repeated",
                 option_read_next, offsetof(struct options, channel), 0, CHANNELS_MOST, NULL},
    [OUT] = {"--out", "DIR", "write files into this folder", TEXT(out)},
    [REPLAY_OUT] = {"--out", "DIR", "write files into this folder (default: a new temporary one)",
                    TEXT(out)},
    [EVIDENCE_OUT] =
        {"--out", "DIR",
         "write the difference of each golden image into this folder; if several journals have the "
         "same name, into its subfolder N for the Nth journal",
         TEXT(out)},
    [WHOLE] = {"--whole", NULL,
               "write the journal as FILE.part, and rename it at the end of the run; repeating an "
               "interrupted run resumes it",
               FLAG(whole)},
    [KEEP_GOING] = {"--keep-going", NULL, "do not stop at the first error", FLAG(keep_going)},
    [GRAPHICS] = {"--graphics", "HOW", "use this picture protocol instead of the detected one",
                  read_graphics, 0, 0, 0, graphics_add_names},
    [SMOOTH] = {"--smooth", NULL,
                "show 24-bit pictures if the terminal supports it; about four times the bytes",
                FLAG(smooth)},
    [PROCESSES] = {"-j", "N", "verify N journals in parallel, 1..64 (default: 1)",
                   NUMBER(verify.processes, 1, PROCESSES_MOST)},
    [FROM] = {"--from", "N", "compare records from this one on",
              NUMBER(verify.first, 1, RECORDS_MOST)},
    [UNTIL] = {"--until", "N", "compare records up to this one",
               NUMBER(verify.last, 1, RECORDS_MOST)},
    [DIFF_UNTIL] = {"--until", "N", "stop after this record", NUMBER(until, 1, RECORDS_MOST)},
    [STRICT] = {"--strict", NULL,
                "fail on incomplete evidence: a torn last record, a record without a digest, a "
                "missing golden image, or one that no record names; the default if CI is set",
                FLAG(verify.strict)},
    [NO_STRICT] = {"--no-strict", NULL, "accept incomplete evidence, even if CI is set",
                   FLAG(no_strict)},
    [EXPECT] = {"--expect", "CHAIN", "fail unless this is the journal's last chain, 32 digits",
                TEXT(verify.expect)},
    [SHARD] = {"--shard", "K/N",
               "verify part K of N; a journal stays in its part when others are added",
               TEXT(shard)},
    [FAIL_FAST] = {"--fail-fast", NULL, "stop at the first journal that fails",
                   FLAG(verify.fail_fast)},
    [TIMINGS] = {"--timings", NULL, "print the ten slowest records of each journal",
                 FLAG(verify.timings)},
    [REMOVE_ORPHANS] =
        {"--remove-orphans", NULL,
         "delete golden images that no record names, if records of this journal could have made "
         "them; rejected if CI is set",
         FLAG(verify.removes_orphans)},
    [JUNIT] = {"--junit", "FILE", "write a JUnit report; replaces an existing file",
               TEXT(verify.junit)},
    [HTML] = {"--html", "FILE",
              "write a web page with the pictures of each failure; replaces an existing file",
              TEXT(verify.html)},
    [JSON] = {"--json", NULL, "print JSON", FLAG(json)},
    [HISTOGRAM] = {"--histogram", NULL, "also print a histogram of the voxels of a scene",
                   FLAG(histogram)},
    [VOLUME] = {"--volume", "N", "select a volume of a 4-D file, from 0", LIST(volume, 0, 65535)},
    [VOLUMES] =
        {"--volume", "N[,N]",
         "select a volume of each 4-D file, from 0: one number for all files, or a list with a "
         "number for each file, the last one for all further files",
         LIST(volume, 0, 65535)},
    [PICTURE] = {"--picture", "FILE.png",
                 "draw both renditions and their differences, side by side", TEXT(picture)},
    [CSV] = {"--csv", NULL, "print CSV, a line for each label", FLAG(csv)},
    [SLICES] = {"--picture", "FILE.png",
                "draw slices with all differences, through the place of the largest distance",
                TEXT(picture)},
    [SLICES_SCENE] = {"--scene", "FILE", "draw these slices in this scene instead of A",
                      TEXT(scene)},
    [SURFACE] = {"--surface", "FILE.png",
                 "draw A's surface, coloured by its distance to B: red outside, blue inside",
                 TEXT(surface)},
    [REGIONS] = {"--regions", "LIST",
                 "compare only these values of both maps, as in 1-90,2001 (default: all above 0)",
                 LIST(regions, 0, UINT32_MAX)},
    [AS] = {"--as", "LIST", "labels of these values, 255 at most, as in 1-90,91",
            LIST(as, 0, UINT32_MAX)},
    [BINARY] = {"--binary", NULL, "merge all labels into one object, label 1", FLAG(binary)},
    [RESAMPLE] = {"--resample", NULL, "resample B to A's grid, nearest neighbour", FLAG(resample)},
    [FROM_STEP] = {"--from", "N", "begin at this step", NUMBER(from, 1, RECORDS_MOST)},
    [UNTIL_STEP] = {"--until", "N", "end after this step", NUMBER(until, 1, RECORDS_MOST)},
    [BY] =
        {"--by", "WAY",
         "set the transform between the scenes: world (the same millimetres), landmarks, affine "
         "(registration of intensities; the default), a FILE with a transform of ITK, or fsl:FILE",
         TEXT(by)},
    [PLANT_AS] = {"--as", "WHAT",
                  "plant labels (final labels, eroded; the default) or seeds (of the commands)",
                  TEXT(as)},
    [FIT] = {"--fit", "KIND",
             "fit landmarks by " CARRY_FITS " (default: affine; rigid for 3 landmarks)", TEXT(fit)},
    [LANDMARKS_OF] = {"--landmarks", "FILE",
                      "read the landmarks of the one SCENE: lines NAME X,Y,Z in mm to the right, "
                      "front and head, or a journal of SCENE",
                      TEXT(landmarks)},
    [ORIENT] = {"--orient", "HOW", "set the orientation of scenes without one, as in RAS",
                TEXT(orient)},
    [APPLY_OUT] = {"--out", "DIR", "write journals into this folder (default: the current one)",
                   TEXT(out)},
    [PROCEDURE_SCENE] = {"--scene", "FILE",
                         "open this scene of the procedure instead of the one that `open` names",
                         TEXT(scene)},
    [LIMIT_MEMORY] = {"--limit-memory", "SIZE",
                      "limit the memory for a journal, as in 2G (default: 3/4 of the free memory)",
                      TEXT(limit_memory)},
    [LIMIT_TIME] = {"--limit-time", "TIME", "limit the time, as in 90s, 20m or 1.5h (default: 1h)",
                    TEXT(limit_time)},
    [LIMIT_OUTPUT] = {"--limit-output", "SIZE", "limit the written bytes, as in 500M (default: 4G)",
                      TEXT(limit_output)},
    [UNCONFINED] =
        {"--unconfined", NULL,
         "run even if the kernel has no Landlock to confine libraries to the files of the journal",
         FLAG(unconfined)},
    [COMMANDS] = {"-c", "'COMMAND; COMMAND'", "", TEXT(commands)},
    [VERSION] = {"--version", FORM},
    [BISECT] = {"--bisect", FORM},
    [ACCEPT] = {"--accept", "WHY", "", TEXT(accept)},
    [ONLY] = {"--only", "NAME,...", "accept only these golden images; do not change others",
              TEXT(only)},
    [SCRIPT] = {"--script", FORM},
    [CHECK] = {"--check", FORM},
    [ANONYMISE] = {"--anonymise", FORM},
    [PAGE] = {"-o", "FILE.html", "write the page to this file, which must not exist", TEXT(page)},
    [COMPARE_WITH] = {"--compare", "MAP",
                      "compare the final labels with this label map, below the journal's folder",
                      TEXT(compare)},
    [STEPS] = {"--steps", NULL, "add a picture of each step, with its comments", FLAG(steps)},
    [LOG_TIMES] = {"--times", FORM},
    [REPAIR] = {"--repair", FORM},
    [RESEAL] = {"--reseal", FORM},
    [PROCEDURE] = {"--procedure", "FILE", "", TEXT(procedure)},
};

/* ---- programs ---- */

enum { FILES_MOST = 1 << 20 };

#define SESSION_OPTIONS JOURNAL, READ_ONLY, WHO, TIMES, SCENE, CHANNEL, OUT, GRAPHICS, SMOOTH
#define LIMIT_OPTIONS   LIMIT_MEMORY, LIMIT_TIME, LIMIT_OUTPUT, UNCONFINED

/* Name, form, operands, and their least and largest number. */
static const struct program program[] = {
    {NULL, NULL, "[SCENE...|JOURNAL]", 0, CHANNELS_MOST + 1, .option = {SESSION_OPTIONS},
     .summary = "open the prompt on a scene or a journal",
     .detail =
         "Further files of SCENE, such as case_0001.nii.gz after case_0000.nii.gz, become its "
         "channels (`help channel`).",
     .run = run_prompt},
    {NULL, "-c", "", 0, 0, .option = {COMMANDS, SESSION_OPTIONS, WHOLE, KEEP_GOING},
     .summary = "run these commands", .run = run_commands},
    {"run", NULL, "FILE|-", 1, 1, .option = {SESSION_OPTIONS, WHOLE, KEEP_GOING, JSON},
     .summary = "run the commands of a script or a journal",
     .detail = "When the record of a command is on the disk, prints `ok N`, with the number of the "
               "record, and the command; `ok -` is for a command without a record. The first error "
               "ends the run. If an interrupted run is repeated with the same --journal, it "
               "continues after its last record, but adds nothing if script and journal differ.\n"
               "For batches use --whole and --json; the latter prints one object instead of these "
               "lines. Needs no terminal. Exit status: 0 all commands succeeded; 1 a golden image "
               "differs; 2 bad usage, including that of a command; 3 bad input or I/O, including a "
               "full disk; 130 Ctrl-C.",
     .run = run_script},
    {"serve", NULL, "[SCENE...|JOURNAL]", 0, CHANNELS_MOST + 1,
     .option = {JOURNAL, READ_ONLY, WHO, TIMES, SCENE, CHANNEL, OUT},
     .summary = "run a session for a program, in lines of JSON",
     .detail =
         "Reads requests from standard input and writes answers to standard output, one per line. "
         "{\"id\": 1, \"do\": \"seed 90,108,90 1\"} runs a command, {\"id\": 2, \"array\": "
         "\"labels\"} writes voxels into a file, {\"cancel\": 1} cancels request 1. The first line "
         "of the output has the version of the protocol and describes the scene and the journal. "
         "Without --journal, creates a journal in the current folder, as the prompt does. Further "
         "files of SCENE become its channels. "
         "src/program/README.md describes the protocol, and examples/python has a client.",
     .run = run_serve},
    {"replay", NULL, "JOURNAL", 1, 1, .option = {SCENE, CHANNEL, REPLAY_OUT, LIMIT_OPTIONS},
     .summary = "run a journal again and compare its results",
     .detail = "An untrusted journal is safe to replay. It can read files below its own folder and "
               "below the folders in $IFTTY_SCENES (default: those of Debian's mricron-data); "
               "elsewhere, only a scene or channel whose digest it has. It can write into one "
               "folder only, "
               "and is stopped when it reaches a limit.",
     .run = run_replay},
    {"verify", NULL, "JOURNAL...", 1, FILES_MOST,
     .option = {PROCESSES, FROM, UNTIL, STRICT, NO_STRICT, EXPECT, SHARD, FAIL_FAST, TIMINGS,
                REMOVE_ORPHANS, JSON, JUNIT, HTML, EVIDENCE_OUT, SCENE, CHANNEL, LIMIT_OPTIONS},
     .summary = "compare results and golden images, print TAP",
     .detail = "If JOURNAL is a folder, verifies all journals *.iftty in it and its subfolders. "
               "Replays each journal in its own process, under the restrictions of `replay`. "
               "Writes only the files that options name.",
     .run = run_verify},
    {"verify", "--bisect", "A B", 2, 2, .option = {BISECT},
     .summary = "find the first record that differs", .run = run_verify_bisect},
    {"verify", "--accept", "JOURNAL", 1, 1, .option = {ACCEPT, ONLY, SCENE, CHANNEL},
     .summary = "redraw golden images and record the reason",
     .detail = "Redraws golden images that differ or are missing. Rejected if CI is set, since a "
               "person must decide this. Keeps the former journal as JOURNAL.before-N.",
     .run = run_reseal},
    {"tutorial", NULL, "[JOURNAL]", 0, 1, .option = {GRAPHICS, SMOOTH},
     .summary = "segment a first organ in ten minutes",
     .detail = "Opens the head ch2 of Debian's mricron-data, with instructions for prompt and "
               "pilot. A step is complete when its seeds are planted, by any keys or commands, and "
               "the brain has the required Dice coefficient with mricron's extraction. Leaves no "
               "file except the journal; `iftty tutorial JOURNAL` resumes it.",
     .run = run_tutorial},
    {"watch", NULL, "JOURNAL", 1, 1,
     .option = {FROM_STEP, UNTIL_STEP, SCENE, CHANNEL, GRAPHICS, SMOOTH, LIMIT_OPTIONS},
     .summary = "watch the steps that made a journal",
     .detail = "Replays the journal under the restrictions of `replay`, and shows its steps in the "
               "pilot: Space shows the next step, Backspace the previous one, 20G step 20, c the "
               "comments of a step, ? all keys. Draws seeds and strokes before their command runs, "
               "and hatches the changed voxels. Writes no file. At the end, prints whether the "
               "journal is verified.",
     .run = run_watch},
    {"diff", NULL, "A B", 2, 2,
     .option = {DIFF_UNTIL, JSON, PICTURE, SCENE, CHANNEL, LIMIT_OPTIONS},
     .summary = "compare the commands and labels of journals",
     .detail = "Prints the first command that differs and, for each label, the Dice coefficient "
               "and the numbers of voxels in A, in B and in both. A and B may also be scripts.",
     .run = run_diff},
    {"apply", NULL, "PROCEDURE SCENE...", 2, FILES_MOST,
     .option = {BY, PLANT_AS, VOLUMES, APPLY_OUT, LANDMARKS_OF, FIT, ORIENT, PROCEDURE_SCENE, JSON,
                LIMIT_OPTIONS},
     .summary = "apply a procedure to other scenes",
     .detail = "PROCEDURE is a journal, replayed under the restrictions of `replay`, or the output "
               "of `iftty log --procedure`. For each SCENE, writes SCENE.iftty atomically, a "
               "journal that can be corrected and verified like any other. Skips a SCENE that has "
               "an identical journal. Drops and counts seeds whose intensity does not occur in the "
               "procedure's object. For each label, prints its volume, also as a share of the "
               "expected one, and the part of it that is far from the transferred label: more than "
               "5 mm and more than r/3, where r is the radius of a ball of the label's volume. "
               "Marks labels with less than 2/3 or more than 3/2 of the expected volume, or with "
               "more than 1/50 of their volume far away. Exit status 1: a scene was rejected.",
     .run = run_apply},
    {"compare", NULL, "A B", 2, 2,
     .option = {VOLUMES, REGIONS, AS, BINARY, RESAMPLE, JSON, CSV, SLICES, SLICES_SCENE, SURFACE},
     .summary = "compare two label maps",
     .detail = "For each label, and for all labels together, prints overlap (Dice, Jaccard), "
               "volumes, and distances between the two objects and their surfaces (`help "
               "compare`). Both maps must have the same grid, unless B is resampled to that of A.",
     .run = run_compare},
    {"log", NULL, "JOURNAL", 1, 1, .summary = "print a journal", .run = run_log},
    {"log", "--script", "JOURNAL", 1, 1, .option = {SCRIPT},
     .summary = "print its commands and comments", .run = run_log_script},
    {"log", "--anonymise", "JOURNAL", 1, 1, .option = {ANONYMISE, SCRIPT},
     .summary = "print commands; omit file names and free text", .run = run_log_anonymise},
    {"log", "--times", "JOURNAL", 1, 1, .option = {LOG_TIMES},
     .summary = "list records with time, name and session", .run = run_log_times},
    {"log", "--check", "JOURNAL", 1, 1, .option = {CHECK},
     .summary = "check for torn, edited or damaged records",
     .detail = "Checks the chain of the records; runs no command.", .run = run_log_check},
    {"log", "--procedure", "JOURNAL", 1, 1, .option = {PROCEDURE, SCENE, LIMIT_OPTIONS},
     .summary = "write the input of `apply`, without images",
     .detail = "Writes labels and their grid, percentiles of intensities, seeds, landmarks, "
               "weights and finish as text to FILE, or to standard output for -. The text has the "
               "names of labels, but no image, comment or file name. Does not overwrite a file.",
     .run = run_log_procedure},
    {"log", "--repair", "JOURNAL", 1, 1, .option = {REPAIR},
     .summary = "move invalid records to JOURNAL.torn-N", .run = run_log_repair},
    {"log", "--reseal", "JOURNAL", 1, 1, .option = {RESEAL, ACCEPT, SCENE, CHANNEL},
     .summary = "recompute the results of an edited journal",
     .detail = "With --accept WHY, also redraws golden images, as `verify --accept` does; "
               "otherwise fails if one differs. Keeps the former journal as JOURNAL.before-N.",
     .run = run_reseal},
    {"report", NULL, "JOURNAL", 1, 1,
     .option = {PAGE, STEPS, COMPARE_WITH, SCENE, CHANNEL, LIMIT_OPTIONS},
     .summary = "write a page about a journal",
     .detail = "Replays the journal under the restrictions of `replay`, and writes one HTML file "
               "that needs no other: whether the journal is verified, its last chain, volumes of "
               "labels, slices through each of them, golden images. Equal journals have equal "
               "pages. Exit status 1: the journal is not verified, and the page says why.",
     .run = run_report},
    {"show", NULL, "PICTURE", 1, 1, .option = {GRAPHICS, SMOOTH},
     .summary = "show a picture inline, if the terminal can",
     .detail = "Prints nothing if standard output is not a terminal.", .run = run_show},
    {"info", NULL, "[FILE]", 0, 1, .option = {JSON, HISTOGRAM, VOLUME},
     .summary = "describe a picture, scene, journal or iftty",
     .detail = "Without FILE, prints the version and how `replay` and `verify` are confined.",
     .run = run_info},
    {"help", NULL, "[COMMAND|PROGRAM]", 0, 1, .summary = "describe a command or a program",
     .detail = "`iftty help all` lists the commands, `iftty help keys` the keys of the prompt; "
               "`iftty help correct` shows how to correct a segmentation of another program.",
     .run = run_help},
    {NULL, "--version", "", 0, 0, .option = {VERSION},
     .summary = "print the versions of iftty and its libraries", .run = run_version},
};

const struct program_table program_table = {
    .called = "iftty",
    .about = "iftty: segment 3-D scenes by seeds, in a terminal",
    .closing = "`iftty PROGRAM --help` lists the options of a program; `-c` has those of `run`,\n"
               "except for --json. `--option=VALUE` means `--option VALUE`, -V means --version,\n"
               "and -h means --help. The prompt records a new session on NAME.nii.gz in\n"
               "./NAME-1.iftty, or the next free number, unless --journal names another file.\n"
               "Ctrl-C cancels the current command, and ends `run`, `-c` and `replay`.\n"
               "Exit status: 0 success, 1 a check failed or `apply` rejected a scene, 2 bad\n"
               "usage, 3 bad input or I/O, 130 Ctrl-C.\n",
    .row = program,
    .rows = sizeof program / sizeof program[0],
    .option = {option, sizeof option / sizeof option[0]},
};
