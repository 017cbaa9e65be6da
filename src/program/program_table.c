/* SPDX-License-Identifier: MIT */
/* Table of programs, and table of their options. */
#include "program/programs.h"

#include <string.h>

#include "apply/apply.h"
#include "session/map.h"
#include "verify/verify.h"

/* ---- options ---- */

enum { RECORDS_MOST = 999999999 };

/* Rows of the table below, grouped by the programs that have them. */
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
    [JOURNAL] = {"--journal", "FILE", "record in this journal; resume it if it exists",
                 TEXT(journal)},
    [READ_ONLY] = {"--read-only", NULL, "resume the journal without writing to it or locking it",
                   FLAG(read_only)},
    [SCENE] = {"--scene", "FILE", "open this scene instead of the one that `open` names",
               TEXT(scene)},
    [OUT] = {"--out", "DIR", "write files into this folder", TEXT(out)},
    [REPLAY_OUT] = {"--out", "DIR", "write files into this folder (a new temporary one)",
                    TEXT(out)},
    [EVIDENCE_OUT] =
        {"--out", "DIR",
         "write the difference of each golden image into this folder, in N/ for the Nth journal if "
         "several have one name",
         TEXT(out)},
    [WHOLE] =
        {"--whole", NULL,
         "write FILE.part, which a repeated run resumes, and rename it to the journal when all is "
         "done",
         FLAG(whole)},
    [KEEP_GOING] = {"--keep-going", NULL, "do not stop at the first error", FLAG(keep_going)},
    [GRAPHICS] = {"--graphics", "HOW",
                  "protocol for pictures, instead of the terminal's own answer", read_graphics, 0,
                  0, 0, graphics_add_names},
    [SMOOTH] = {"--smooth", NULL,
                "show pictures in 24 bits, if the terminal can, at four times the bytes",
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
    [NO_STRICT] = {"--no-strict", NULL, "accept incomplete evidence, also where CI is set",
                   FLAG(no_strict)},
    [EXPECT] = {"--expect", "CHAIN", "fail unless this is the journal's last chain, 32 digits",
                TEXT(expect)},
    [SHARD] = {"--shard", "K/N",
               "verify part K of N; a journal stays in its part when others are added",
               TEXT(shard)},
    [FAIL_FAST] = {"--fail-fast", NULL, "stop at the first journal that fails", FLAG(fail_fast)},
    [TIMINGS] = {"--timings", NULL, "print the ten slowest records of each journal", FLAG(timings)},
    [REMOVE_ORPHANS] =
        {"--remove-orphans", NULL,
         "delete golden images that the journal does not name, if its records can have made them; "
         "refused where CI is set",
         FLAG(remove_orphans)},
    [JUNIT] = {"--junit", "FILE", "write a JUnit report for other programs, over an existing one",
               TEXT(junit)},
    [HTML] = {"--html", "FILE",
              "write a report as a page with the pictures of each failure, over an existing one",
              TEXT(html)},
    [JSON] = {"--json", NULL, "print JSON", FLAG(json)},
    [HISTOGRAM] = {"--histogram", NULL,
                   "print a histogram of a scene, whose voxels are then read too", FLAG(histogram)},
    [VOLUME] =
        {"--volume", "N[,N]",
         "select a volume of files that hold several, counted from 0; for several files one number "
         "each, the last one for all further files",
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
                 "draw A's surface, red outside B and blue inside, by the distance", TEXT(surface)},
    [REGIONS] = {"--regions", "LIST",
                 "compare only these values of both maps, as 1-90,2001 (all above 0)",
                 LIST(regions, 0, REGION_MOST)},
    [AS] = {"--as", "LIST", "the labels of those values, 255 at most: 1-90,91", LIST(as, 0, 255)},
    [BINARY] = {"--binary", NULL, "merge all of them into one object, label 1", FLAG(binary)},
    [RESAMPLE] = {"--resample", NULL, "resample B to A's grid, nearest neighbour", FLAG(resample)},
    [FROM_STEP] = {"--from", "N", "begin at this step", NUMBER(from, 1, RECORDS_MOST)},
    [UNTIL_STEP] = {"--until", "N", "end after this step", NUMBER(until, 1, RECORDS_MOST)},
    [BY] =
        {"--by", "WAY",
         "world (same millimetres), landmarks, affine (by the intensities of both; the default), "
         "or a FILE with a transform of ITK, or fsl:FILE",
         TEXT(by)},
    [PLANT_AS] = {"--as", "WHAT",
                  "labels (final labels, eroded; the default) or seeds (its gestures)", TEXT(as)},
    [FIT] = {"--fit", "KIND",
             "transform of landmarks: " CARRY_FITS " (the most that they determine)", TEXT(fit)},
    [LANDMARKS_OF] = {"--landmarks", "FILE",
                      "the subject's: lines NAME X,Y,Z in mm, or a journal of its scene",
                      TEXT(landmarks)},
    [ORIENT] = {"--orient", "HOW", "orientation of scenes whose files have none, as RAS (`orient`)",
                TEXT(orient)},
    [APPLY_OUT] = {"--out", "DIR", "write the journals into this folder (the current one)",
                   TEXT(out)},
    [PROCEDURE_SCENE] = {"--scene", "FILE",
                         "the procedure's scene, instead of the one that `open` names",
                         TEXT(scene)},
    [LIMIT_MEMORY] = {"--limit-memory", "SIZE",
                      "the most memory for a journal, as 2G (3/4 of the free memory)",
                      TEXT(limit_memory)},
    [LIMIT_TIME] = {"--limit-time", "TIME", "the most time, as 90s, 20m or 1.5h (1h)",
                    TEXT(limit_time)},
    [LIMIT_OUTPUT] = {"--limit-output", "SIZE", "the most bytes of files written, as 500M (4G)",
                      TEXT(limit_output)},
    [UNCONFINED] =
        {"--unconfined", NULL,
         "let libraries read the files of the journal although this kernel has no Landlock to "
         "confine them to those files",
         FLAG(unconfined)},
    [COMMANDS] = {"-c", "'COMMAND; COMMAND'", "", TEXT(commands)},
    [VERSION] = {"--version", FORM},
    [BISECT] = {"--bisect", FORM},
    [ACCEPT] = {"--accept", "WHY", "", TEXT(accept)},
    [ONLY] = {"--only", "NAME,...", "accept only these golden images; others stay as they are",
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

/* Name, form, operands, and their least and largest number. */
static const struct program program[] = {
    {NULL, NULL, "[SCENE|JOURNAL]", 0, 1, .option = {SESSION_OPTIONS},
     .summary = "open the prompt on a new scene or a journal", .run = run_prompt},
    {NULL, "-c", "", 0, 0, .option = {COMMANDS, SESSION_OPTIONS, WHOLE, KEEP_GOING},
     .summary = "carry out these commands", .run = run_commands},
    {"run", NULL, "FILE|-", 1, 1, .option = {SESSION_OPTIONS, WHOLE, KEEP_GOING, JSON},
     .summary = "carry out the commands of a script or journal",
     .detail = "Each command is acknowledged, once its record is on the disk, by a line that "
               "begins with `ok N`, where N is the number of the record, or `ok -` for a command "
               "without a record, and repeats the command. The first error ends the run. An "
               "interrupted run continues after its last record when it is repeated with the same "
               "--journal; if script and journal differ, nothing is added.\n"
               "For a batch: --whole, and --json for one object instead of those lines. No "
               "terminal is needed. Exit status: 0 all commands are carried out; 1 a golden image "
               "differs; 2 bad usage, also of a command; 3 bad input or I/O, a full disk too; 130 "
               "Ctrl-C.",
     .run = run_script},
    {"serve", NULL, "[SCENE|JOURNAL]", 0, 1, .option = {JOURNAL, READ_ONLY, SCENE, OUT},
     .summary = "run a session for a script: lines of JSON",
     .detail =
         "Requests on standard input and answers on standard output, one a line: {\"id\": 1, "
         "\"do\": \"seed 90,108,90 1\"} is a command as at the prompt, {\"id\": 2, \"array\": "
         "\"labels\"} writes voxels into a file, {\"cancel\": 1} stops a command. The first line "
         "of the answers has the number of the protocol and describes the scene and the "
         "journal. Without --journal a new journal is begun, as by the prompt. "
         "src/program/README.md describes the protocol, and examples/python has a client.",
     .run = run_serve},
    {"replay", NULL, "JOURNAL", 1, 1, .option = {SCENE, REPLAY_OUT, LIMIT_OPTIONS},
     .summary = "carry out a journal again, compare results",
     .detail = "The journal may be a stranger's: it reads the scene that it names, writes below "
               "one folder, and is bounded by the limits.",
     .run = run_replay},
    {"verify", NULL, "JOURNAL...", 1, FILES_MOST,
     .option = {PROCESSES, FROM, UNTIL, STRICT, NO_STRICT, EXPECT, SHARD, FAIL_FAST, TIMINGS,
                REMOVE_ORPHANS, JSON, JUNIT, HTML, EVIDENCE_OUT, SCENE, LIMIT_OPTIONS},
     .summary = "replay quietly, compare golden images; TAP",
     .detail = "A folder means all journals *.iftty in it and below. Each journal is carried out "
               "in a process of its own, by the rules of `replay`. Nothing is written but the "
               "files of these options.",
     .run = run_verify},
    {"verify", "--bisect", "A B", 2, 2, .option = {BISECT},
     .summary = "find the first different record of journals", .run = run_verify_bisect},
    {"verify", "--accept", "JOURNAL", 1, 1, .option = {ACCEPT, ONLY, SCENE},
     .summary = "redraw golden images, and record why",
     .detail = "Redraws golden images that differ or are missing. Refused where CI is set: this is "
               "a person's decision. The former journal is kept next to the new one.",
     .run = run_accept},
    {"tutorial", NULL, "[JOURNAL]", 0, 1, .option = {GRAPHICS, SMOOTH},
     .summary = "segment a first organ in ten minutes",
     .detail = "A session at prompt and pilot on the head ch2 of Debian's mricron-data, with "
               "instructions. A step is complete when its result is there, whatever you did: "
               "seeds, and Dice's coefficient with mricron's own extraction of the brain. JOURNAL "
               "resumes an earlier lesson. Nothing but the journal is left behind.",
     .run = run_tutorial},
    {"watch", NULL, "JOURNAL", 1, 1,
     .option = {FROM_STEP, UNTIL_STEP, SCENE, GRAPHICS, SMOOTH, LIMIT_OPTIONS},
     .summary = "watch how a journal was made, step by step",
     .detail = "Replays the journal by the rules of `replay`, and shows its steps in the pilot: "
               "Space shows the next one, Backspace the one before, 20G step 20, c the comments of "
               "a step, ? all keys. A gesture is drawn before it is carried out, and changed "
               "voxels are hatched. Nothing is written. At the end it reports whether the journal "
               "is verified.",
     .run = run_watch},
    {"diff", NULL, "A B", 2, 2, .option = {DIFF_UNTIL, JSON, PICTURE, SCENE, LIMIT_OPTIONS},
     .summary = "compare the commands and labels of journals",
     .detail = "Prints the first command that differs and, for each label, the voxels in both and "
               "Dice's coefficient. A and B may be scripts as well.",
     .run = run_diff},
    {"apply", NULL, "PROCEDURE SCENE...", 2, FILES_MOST,
     .option = {BY, PLANT_AS, VOLUME, APPLY_OUT, LANDMARKS_OF, FIT, ORIENT, PROCEDURE_SCENE, JSON,
                LIMIT_OPTIONS},
     .summary = "carry a procedure to other scenes",
     .detail = "PROCEDURE is a journal, which is carried out by the rules of `replay`, or the "
               "output of `iftty log --procedure`. For each SCENE it writes a journal SCENE.iftty, "
               "atomically, which can be corrected and verified as any other. An existing "
               "identical journal is skipped. Seeds whose intensity does not occur in the object "
               "are dropped, and counted. Status 1: a scene was refused.",
     .run = run_apply},
    {"compare", NULL, "A B", 2, 2,
     .option = {VOLUME, REGIONS, AS, BINARY, RESAMPLE, JSON, CSV, SLICES, SLICES_SCENE, SURFACE},
     .summary = "compare two label maps",
     .detail = "For each label, and all together: overlap (Dice, Jaccard), volumes, and distances "
               "between the two objects and their surfaces, as the command `compare` prints them. "
               "Both maps must have one grid, unless B is resampled to that of A.",
     .run = run_compare},
    {"log", NULL, "JOURNAL", 1, 1, .summary = "print a journal", .run = run_log},
    {"log", "--script", "JOURNAL", 1, 1, .option = {SCRIPT}, .summary = "print its commands alone",
     .run = run_log_script},
    {"log", "--anonymise", "JOURNAL", 1, 1, .option = {ANONYMISE, SCRIPT},
     .summary = "print them without file names and free text", .run = run_log_anonymise},
    {"log", "--check", "JOURNAL", 1, 1, .option = {CHECK},
     .summary = "check if it is intact, torn or edited",
     .detail = "By the chain of its records alone: nothing is carried out.", .run = run_log_check},
    {"log", "--procedure", "JOURNAL", 1, 1, .option = {PROCEDURE, SCENE, LIMIT_OPTIONS},
     .summary = "write the input of `apply`, without images",
     .detail = "Labels and their grid, percentiles of intensities, gestures, landmarks, weights "
               "and finish, as text into FILE, or to standard output if FILE is -. No image, no "
               "comment, and no name of a file; labels keep their names. No file is overwritten.",
     .run = run_log_procedure},
    {"log", "--repair", "JOURNAL", 1, 1, .option = {REPAIR},
     .summary = "keep the valid records, copy the rest aside", .run = run_log_repair},
    {"log", "--reseal", "JOURNAL", 1, 1, .option = {RESEAL, ACCEPT, SCENE},
     .summary = "recompute the results of an edited journal",
     .detail = "With --accept WHY golden images are redrawn in the same step, as by `verify "
               "--accept`; without it they stay, and the journal is refused if they differ. The "
               "former journal is kept next to the new one.",
     .run = run_reseal},
    {"show", NULL, "PICTURE", 1, 1, .option = {GRAPHICS, SMOOTH},
     .summary = "show a picture inline, if the terminal can",
     .detail = "Prints nothing if standard output is not a terminal.", .run = run_show},
    {"info", NULL, "[FILE]", 0, 1, .option = {JSON, HISTOGRAM, VOLUME},
     .summary = "describe a picture, scene, journal or iftty",
     .detail = "Without FILE: the version, and how the kernel confines `replay` and `verify`.",
     .run = run_info},
    {"help", NULL, "[COMMAND|PROGRAM]", 0, 1,
     .summary = "explain commands of prompt, script, journal",
     .detail = "`iftty help keys` lists the keys of the prompt.", .run = run_help},
    {NULL, "--version", "", 0, 0, .option = {VERSION},
     .summary = "print versions of program and libraries", .run = run_version},
};

const struct program_table program_table = {
    .called = "iftty",
    .about = "iftty: segment 3-D scenes by seeds, in a terminal",
    .closing = "`iftty PROGRAM --help` lists the options of a program. `--option=VALUE` is\n"
               "`--option VALUE`; -V is --version, -h is --help.\n"
               "Ctrl-C cancels the current command; run, -c and replay end with it.\n"
               "Exit status: 0 fine, 1 a check failed, 2 bad usage, 3 bad input or I/O,\n"
               "130 Ctrl-C.\n",
    .row = program,
    .rows = sizeof program / sizeof program[0],
    .option = {option, sizeof option / sizeof option[0]},
};
