/* SPDX-License-Identifier: MIT */
/* The program's prompt and its pilot in a pseudo-terminal, and the screen that they draw: the test
 * sends keys and compares cells. The terminal answers late, in pieces, or with nonsense. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>

#include "base/buf.h"
#include "base/clock.h"
#include "base/file.h"
#include "tests/check.h"
#include "tests/folder.h"
#include "tests/screen.h"

static char folder[FOLDER_LENGTH];
static char program[PATH_MAX];
static char bare[PATH_MAX];
static const char *config = bare; /* configuration of the next program */

struct terminal {
    int master, slave;
    pid_t job;
    unsigned answered;
    bool is_mute;       /* it answers later, so that no answer splits the bytes that it sends */
    struct buf written; /* by the program: all of it */
    struct screen screen;
};
static struct terminal terminals[2], *t = terminals; /* the one in use */

struct setting {
    const char *term, *no_color, *scene;
    unsigned columns, rows;
};

static const struct setting plain = {"xterm-256color", NULL, "synth:geom:40x40x30", 80, 24};

static void become_program(int slave, const struct setting *setting)
{
    setsid();
    ioctl(slave, TIOCSCTTY, 0);
    for (int fd = 0; fd < 3; fd++)
        dup2(slave, fd);
    setenv("TERM", setting->term, 1);
    unsetenv("COLORTERM");
    unsetenv("TMUX");
    unsetenv("NO_COLOR");
    setenv("LC_ALL", "C", 1);
    setenv("IFTTY_HISTORY", "history", 1);
    setenv("IFTTY_CONFIG", config, 1);
    if (setting->no_color)
        setenv("NO_COLOR", setting->no_color, 1);
    execl(program, "iftty", setting->scene, (char *)NULL);
    _exit(127);
}

static void set_size(unsigned columns, unsigned rows)
{
    struct winsize size = {.ws_row = (unsigned short)rows, .ws_col = (unsigned short)columns};
    screen_resize(&t->screen, columns, rows);
    ioctl(t->slave, TIOCSWINSZ, &size);
}

static void type_bytes(const char *bytes, size_t length)
{
    CHECK(write(t->master, bytes, length) == (ssize_t)length);
}

static void type(const char *text)
{
    type_bytes(text, strlen(text));
}

/* Read what arrives within `ms`; return false at the end of the program. */
static bool take(int ms)
{
    char piece[4096];
    struct pollfd ready = {.fd = t->master, .events = POLLIN};
    if (poll(&ready, 1, ms) <= 0)
        return true;
    const ssize_t n = read(t->master, piece, sizeof piece);
    if (n <= 0)
        return n < 0 && errno == EINTR;
    buf_add(&t->written, piece, (size_t)n);
    screen_write(&t->screen, piece, (size_t)n);
    for (; !t->is_mute && t->answered < t->screen.questions; t->answered++)
        type("\033[?64;1;2;6;9c");
    return true;
}

static bool shows_row(const char *row)
{
    for (unsigned y = 0; y < t->screen.rows; y++)
        if (strcmp(screen_row(&t->screen, y), row) == 0)
            return true;
    return false;
}

static bool begins(const char *text)
{
    for (unsigned y = 0; y < t->screen.rows; y++)
        if (strncmp(screen_row(&t->screen, y), text, strlen(text)) == 0)
            return true;
    return false;
}

static bool is_cursor_row(const char *row)
{
    return strcmp(screen_row(&t->screen, t->screen.row), row) == 0;
}

static bool is_at_column(const char *column)
{
    return t->screen.column == (unsigned)strtoul(column, NULL, 10);
}

/* The program reads keys as they are typed; before that the system would act on Ctrl-C. */
static bool reads_keys(const char *text)
{
    struct termios modes;
    (void)text;
    return tcgetattr(t->slave, &modes) == 0 && !(modes.c_lflag & (ICANON | ISIG));
}

/* A minute: a machine that is busy with other things is no reason to fail. */
static bool await(bool (*holds)(const char *), const char *text)
{
    const uint64_t end = clock_ns() + UINT64_C(60000000000);
    while (!holds(text) && clock_ns() < end)
        if (!take(20))
            break;
    return holds(text);
}

static void print_screen(void)
{
    for (unsigned y = 0; y < t->screen.rows; y++)
        if (*screen_row(&t->screen, y))
            printf("#   |%s\n", screen_row(&t->screen, y));
}

static void check_awaited(bool (*holds)(const char *), const char *text, int line)
{
    if (!check_report(await(holds, text), __FILE__, line, text))
        print_screen();
}

/* A row is this; begins so; is this where the cursor is. */
#define SEE(row)        check_awaited(shows_row, row, __LINE__)
#define SEE_BEGIN(text) check_awaited(begins, text, __LINE__)
#define SEE_LINE(row)   check_awaited(is_cursor_row, row, __LINE__)

/* The same after these keys. */
#define ROW_AFTER(keys, row)    (type(keys), SEE(row))
#define BEGIN_AFTER(keys, text) (type(keys), SEE_BEGIN(text))
#define LINE_AFTER(keys, row)   (type(keys), SEE_LINE(row))

/* Read what arrives within `ms` after the program has read its keys, for which it has 4 s. Nothing
 * may depend on what it does in that time: this is for output that must not come, and for keys that
 * the program must read separately. */
static void settle(unsigned ms)
{
    const uint64_t begin = clock_ns();
    int unread;
    for (uint64_t end = begin; clock_ns() < end + ms * UINT64_C(1000000) && take(20);)
        if (ioctl(t->slave, FIONREAD, &unread) == 0 && unread > 0 && end < begin + 4000000000U)
            end = clock_ns();
}

static void start(const struct setting *setting)
{
    memset(t, 0, sizeof *t);
    t->master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    CHECK(t->master >= 0 && grantpt(t->master) == 0 && unlockpt(t->master) == 0);
    t->slave = open(ptsname(t->master), O_RDWR | O_NOCTTY | O_CLOEXEC);
    set_size(setting->columns, setting->rows);
    fflush(stdout);
    t->job = fork();
    if (t->job == 0)
        become_program(t->slave, setting);
}

static void start_at_prompt(void)
{
    start(&plain);
    SEE_BEGIN("40x40x30 voxels of 1x1x1 mm, ");
    SEE_LINE("synth>");
    check_awaited(reads_keys, "the program reads keys", __LINE__);
}

/* Its exit status, or -1 where it does not end. */
static int end(void)
{
    int status = -1;
    for (int i = 0; i < 3000; i++) {
        const pid_t ended = waitpid(t->job, &status, WNOHANG);
        if (ended == t->job)
            break;
        take(20);
        status = -1;
    }
    kill(t->job, SIGKILL);
    waitpid(t->job, NULL, WNOHANG);
    while (take(50) && clock_ns() % 1000 == 0)
        ;
    close(t->slave);
    close(t->master);
    buf_release(&t->written);
    return status < 0 ? -1 : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* The journal that was written last is the Nth. */
static const char *journal(unsigned n)
{
    static struct buf bytes;
    char name[32];
    snprintf(name, sizeof name, "synth-%u.iftty", n);
    CHECK(file_read(&bytes, name, 1 << 24, NULL) == OK);
    return buf_text(&bytes);
}

static void forget_journals(void)
{
    char name[32];
    for (unsigned n = 1; n < 20; n++) {
        snprintf(name, sizeof name, "synth-%u.iftty", n);
        unlink(name);
    }
}

/* Leave the program; returns its journal, whose file has gone then, as the history has. */
static const char *quit(void)
{
    type("\025quit\r");
    CHECK_INT(end(), 0);
    const char *text = file_exists("synth-1.iftty") ? journal(1) : "";
    forget_journals();
    unlink("history");
    return text;
}
/* Define a story that leaves the program. */
#define QUIT_STORY(told) STORY_WITHIN(told, (void)0, quit())
/* Define a story at the prompt. */
#define PROMPT_STORY(told) STORY_WITHIN(told, start_at_prompt(), quit())

/* ---- stories ---- */

/* Return true if a row reports changed voxels, in an object of this name and size. */
static bool names_object(const char *text)
{
    for (unsigned y = 0; y < t->screen.rows; y++) {
        const char *row = screen_row(&t->screen, y);
        if (strstr(row, " voxels changed, ") && strstr(row, text))
            return true;
    }
    return false;
}

STORY(a_line_is_typed_mended_and_carried_out)
{
    start_at_prompt();
    LINE_AFTER("sed 20,20,15 1", "synth> sed 20,20,15 1");
    type("\001\033[C\033[Ce"); /* start, two to the right, the letter */
    SEE_LINE("synth> seed 20,20,15 1");
    CHECK_INT(t->screen.column, 7 + 3);
    BEGIN_AFTER("\r", "48000 voxels changed, label 1: 48 ml, ");
    SEE_LINE("synth>");
    LINE_AFTER("label 1 \346\234\254x",
               "synth> label 1 \346\234\254x [#rrggbb] [number=N] [code=none|SCHEME:VALUE]");
    CHECK_INT(t->screen.column, 7 + 8 + 3);
    ROW_AFTER("\177\177kidney\r", "synth> label 1 kidney");
    type("seed 2,2,2 2\r");
    check_awaited(names_object, "label 1 kidney: ", __LINE__);
    SEE_LINE("synth>");
    const char *text = quit();
    CHECK_HAS(text, "\nlabel 1 kidney\n");
    CHECK_HAS(text, "\nseed 20,20,15 1\n");
}

PROMPT_STORY(a_hint_is_grey_moves_on_and_never_gets_into_the_line)
{
    LINE_AFTER("polarity ", "synth> polarity LABEL PERCENT");
    const struct screen_cell *cell = t->screen.cell[t->screen.row];
    CHECK(!cell[7].grey && cell[16].grey && strcmp(cell[16].text, "L") == 0);
    CHECK_INT(t->screen.column, 16);
    LINE_AFTER("1", "synth> polarity 1 PERCENT");
    LINE_AFTER("\001", "synth> polarity 1"); /* the cursor is not at the end: no hint */
    LINE_AFTER("\005 50", "synth> polarity 1 50");
    ROW_AFTER("\177\177\177\r", "synth> polarity 1"); /* gone with Enter */
    SEE("                  ^");
    SEE("error: missing: PERCENT; usage: polarity LABEL PERCENT");
    BEGIN_AFTER("weight ", "synth> weight morph|sobel");
    set_size(30, 24);
    SEE_LINE("synth> weight morph|sobel|gau"); /* cut before the last column */
}

QUIT_STORY(tab_completes_and_lists_and_tells_how_many_more)
{
    CHECK(file_make_folder("scans", NULL) == OK && file_make_folder("scans/my masks", NULL) == OK);
    for (int i = 0; i < 150; i++) {
        char name[32];
        snprintf(name, sizeof name, "scans/volume-%d.nii", i);
        CHECK(file_write(name, "", 0, FILE_REPLACE, NULL) == OK);
    }
    CHECK(file_write("scans/my masks/one.nii", "", 0, FILE_REPLACE, NULL) == OK);
    start_at_prompt();
    LINE_AFTER("mask sc\t",
               "synth> mask scans/ [regions=A-B] [resample=yes|no] [volume=0..65535] [data=NAME");
    LINE_AFTER("my\t", "synth> mask \"scans/my masks/");
    type("\t");
    SEE_LINE("synth> mask \"scans/my masks/one.nii\" [regions=A-B] [resample=yes|no] [volume=0.");
    CHECK_INT(t->screen.column, 37);
    type("\027\027"); /* kills back to the name of the command */
    SEE_LINE("synth> mask none|FILE [regions=A-B] [resample=yes|no] [volume=0..65535] [data=N");
    LINE_AFTER("scans/v\t\t",
               "synth> mask scans/volume- [regions=A-B] [resample=yes|no] [volume=0..65535] [da");
    SEE_BEGIN("volume-0.nii    volume-20.nii");
    SEE("and 50 more");
    LINE_AFTER("\025zzz\t", "synth> zzz");
    CHECK(t->screen.bells > 0);
}

PROMPT_STORY(a_caret_stands_under_what_is_wrong)
{
    ROW_AFTER("seed 20,20,15 livver\r", "                     ^");
    SEE_BEGIN("error: LABEL: expected a label 0..255 or the name of one, not livver");
    ROW_AFTER("label 1 \346\234\254 clour\r", "                  ^");
    set_size(30, 24);
    ROW_AFTER("seed 20,20,15 1 radius=999 to=1,1,1\r", "...eed 20,20,15 1 radius=9...");
    SEE("                  ^");
    SEE_LINE("synth>");
}

STORY(a_hundred_pasted_lines_are_a_hundred_commands)
{
    OWNED(buf_release) struct buf paste = {0};
    char line[64];
    start_at_prompt();
    buf_add_text(&paste, "\033[200~");
    for (int i = 1; i <= 100; i++)
        buf_printf(&paste, "label %d part-%d%s", i, i, i < 100 ? "\r" : "");
    buf_add_text(&paste, "\033[201~");
    for (size_t at = 0; at < paste.length; at += 300) {
        type_bytes(paste.data + at, paste.length - at < 300 ? paste.length - at : 300);
        take(5);
    }
    SEE("synth> label 99 part-99");
    SEE_LINE("synth> label 100 part-100 [#rrggbb] [number=N] [code=none|SCHEME:VALUE]");
    SEE("Enter runs the pasted lines, Ctrl-C drops them");
    CHECK(strstr(journal(1), "part-") == NULL);
    LINE_AFTER("\r", "synth>");
    const char *text = quit();
    for (int i = 1; i <= 100; i++) {
        snprintf(line, sizeof line, "\nlabel %d part-%d\n", i, i);
        CHECK_HAS(text, line);
    }
}

/* With CR LF, empty lines and a line feed at the end. */
STORY(pasted_lines_wait_for_enter_and_ctrl_c_drops_them)
{
    static const char paste[] = "\033[200~label 1 one\r\n\r\nlabel 2 two\r\n\033[201~";
    start_at_prompt();
    type(paste);
    SEE("synth> label 1 one");
    SEE("synth> label 2 two");
    ROW_AFTER("\003", "synth> ^C");
    LINE_AFTER("label 3 three\r", "synth>");
    type(paste);
    LINE_AFTER("label 4 four", "synth> label 4 four [#rrggbb] [number=N] [code=none|SCHEME:VALUE]");
    LINE_AFTER("\r", "synth>");
    const char *text = quit();
    CHECK(strstr(text, "label 3 three") && strstr(text, "label 4 four"));
    CHECK(strstr(text, "label 3 three") < strstr(text, "label 1 one"));
    CHECK(strstr(text, "label 1 one") < strstr(text, "label 2 two"));
    CHECK(strstr(text, "label 2 two") < strstr(text, "label 4 four"));
}

QUIT_STORY(history_outlives_a_session_that_is_killed)
{
    struct stat status;
    start_at_prompt();
    t++;
    start(&plain);
    SEE_LINE("synth>");
    t--;
    ROW_AFTER("label 7 first\r", "synth> label 7 first");
    SEE_LINE("synth>");
    t++;
    ROW_AFTER("label 7 second\r", "synth> label 7 second");
    SEE_LINE("synth>");
    t--;
    kill(t->job, SIGKILL);
    CHECK_INT(end(), 128 + SIGKILL);
    t++;
    type("quit\r");
    CHECK_INT(end(), 0);
    t--;
    CHECK(stat("history", &status) == 0 && (status.st_mode & 0777) == 0600);
    start_at_prompt();
    type("\020\020"); /* up, past `quit` */
    SEE_LINE("synth> label 7 second [#rrggbb] [number=N] [code=none|SCHEME:VALUE]");
    LINE_AFTER("\022fir", "(search 'fir') label 7 first");
    LINE_AFTER("\007", "synth>");
}

QUIT_STORY(hostile_lines_of_a_history_are_not_obeyed)
{
    static const char lines[] = "info\n\033]0;title\a\033[2J\033[31m\n\xff\xfe\x9b"
                                "31m\n";
    CHECK(file_write("history", lines, sizeof lines - 1, FILE_REPLACE, NULL) == OK);
    start_at_prompt();
    LINE_AFTER("\020", "synth> \\xff\\xfe\\x9b31m");
    LINE_AFTER("\020", "synth> info");
    CHECK(strstr(buf_text(&t->written), "title") == NULL);
}

static void store_history(const char *lines)
{
    CHECK(file_write("history", lines, strlen(lines), FILE_REPLACE, NULL) == OK);
}

QUIT_STORY(what_was_entered_before_is_suggested_and_taken)
{
    store_history("zoom 2\nlabel 7 liver\nseed 1,1,1 liver\nseed 9,9,99 7\nsede 1\n");
    start_at_prompt();
    type("se"); /* neither a voxel beyond the scene, nor a label without a name, nor a mistake */
    SEE_LINE("synth> se");
    LINE_AFTER("\025label 7 ",
               "synth> label 7 liver [#rrggbb] [number=N] [code=none|SCHEME:VALUE]");
    const struct screen_cell *cell = t->screen.cell[t->screen.row];
    CHECK(cell[15].grey && cell[21].grey && !cell[8].grey && t->screen.column == 15);
    LINE_AFTER("\033[C", "synth> label 7 liver [#rrggbb] [number=N] [code=none|SCHEME:VALUE]");
    check_awaited(is_at_column, "20", __LINE__);
    LINE_AFTER("\r", "synth>");
    BEGIN_AFTER("se", "synth> seed 1,1,1 liver [radius=");
    type("\033f\033f");
    check_awaited(is_at_column, "13", __LINE__);
    LINE_AFTER("\001", "synth> seed 1"); /* not at the end: nothing */
    type("\005\005");
    check_awaited(is_at_column, "23", __LINE__);
    type("\037\037"); /* undo the suggestion, and a word of it */
    check_awaited(is_at_column, "11", __LINE__);
    LINE_AFTER("\025la\033[A",
               "synth> label 7 liver [#rrggbb] [number=N] [code=none|SCHEME:VALUE]");
    type("\033[B");
    check_awaited(is_at_column, "9", __LINE__);
    LINE_AFTER("\025goto \033.\033.", "synth> goto 1");
    LINE_AFTER("\025zoom\001\033u", "synth> ZOOM");
}

static const char editor_script[] = "ls -ld \"${1%/*}\" >seen; stty -a >modes; cat \"$1\" >before\n"
                                    "printf 'seed 20,20,15\\n\\0331\\n\\n' >\"$1\"\n";

static void edit_elsewhere(void)
{
    BEGIN_AFTER("seed 2", "synth> seed 2");
    type("\030\005");
}

STORY(a_line_is_edited_in_another_editor_and_waits_for_enter)
{
    OWNED(buf_release) struct buf seen = {0};
    CHECK(file_write("edit.sh", editor_script, sizeof editor_script - 1, FILE_REPLACE, NULL) == OK);
    setenv("VISUAL", "sh ./edit.sh", 1);
    start_at_prompt();
    unsetenv("VISUAL");
    edit_elsewhere();
    SEE_BEGIN("synth> seed 20,20,15 1 [radius=");
    CHECK(reads_keys(""));
    BEGIN_AFTER("\037", "synth> seed 2 LABEL [radius=");
    CHECK(file_read(&seen, "seen", 1 << 12, NULL) == OK);
    CHECK(strncmp(buf_text(&seen), "drwx------", 10) == 0);
    CHECK(!file_exists(strchr(buf_text(&seen), '/')));
    CHECK(file_read(&seen, "modes", 1 << 14, NULL) == OK);
    CHECK(strstr(buf_text(&seen), " icanon") && !strstr(buf_text(&seen), "-icanon"));
    CHECK(file_read(&seen, "before", 1 << 12, NULL) == OK);
    CHECK_TEXT(buf_text(&seen), "seed 2\n");
    const char *text = quit();
    CHECK(strstr(text, "\nopen ") && strstr(text, "seed") == NULL);
}

STORY(without_an_editor_it_is_said_in_words)
{
    static const char *const cases[][2] = {
        {NULL, "error: neither VISUAL nor EDITOR names an editor; "},
        {"no-such-editor", "error: there is no editor no-such-editor; "},
        {"false", "error: false ended with status 1; the line is unchanged"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        unsetenv("EDITOR");
        if (cases[i][0])
            setenv("EDITOR", cases[i][0], 1);
        start_at_prompt();
        edit_elsewhere();
        SEE_BEGIN(cases[i][1]);
        SEE_BEGIN("synth> seed 2");
        quit();
    }
    unsetenv("EDITOR");
}

/* The cursor is after this, at the beginning of its row. */
static bool is_foot(const char *text)
{
    return strcmp(screen_row(&t->screen, t->screen.row), text) == 0 &&
           t->screen.column == strlen(text);
}
#define SEE_FOOT(text)         check_awaited(is_foot, text, __LINE__)
#define FOOT_AFTER(keys, text) (type(keys), SEE_FOOT(text))
#define MORE                   "-- more --"

/* After more than this many bytes, a page has ended: there is more, or the prompt. */
static bool is_page_end(const char *bytes)
{
    return t->written.length > strtoul(bytes, NULL, 10) &&
           (is_foot(MORE) || is_cursor_row("synth>"));
}

QUIT_STORY(a_long_answer_is_printed_by_pages)
{
    unsigned pages = 1;
    start_at_prompt();
    FOOT_AFTER("help all\r", MORE);
    CHECK_TEXT(screen_row(&t->screen, 0), "The scene");
    LINE_AFTER("q", "synth>"); /* in its place */
    CHECK(!begins(MORE));
    FOOT_AFTER("help all\r", MORE);
    LINE_AFTER("  q", "synth>"); /* keys that arrive together are a page each */
    FOOT_AFTER("help all\r", MORE);
    set_size(80, 12);
    FOOT_AFTER(" ", MORE);
    set_size(80, 24);
    for (; pages < 40 && !begins("quit "); pages++) {
        char before[24];
        snprintf(before, sizeof before, "%zu", t->written.length);
        type("\r");
        check_awaited(is_page_end, before, __LINE__);
    }
    CHECK(pages > 5 && pages < 40);
    SEE_LINE("synth>");
    BEGIN_AFTER("info\r", "memory "); /* this fits */
    SEE_LINE("synth>");
    CHECK(strstr(buf_text(&t->written), "1049h") == NULL);
}

STORY(what_is_typed_or_pasted_on_is_for_the_prompt)
{
    start_at_prompt();
    type("help all\rlabel 3 one\r"); /* a user who types on: there are no pages */
    SEE("synth> label 3 one");
    SEE_LINE("synth>");
    FOOT_AFTER("help all\r", MORE);
    type("\033[200~label 4 two\rquit it"); /* a paste leaves, and is the prompt's */
    SEE("synth> label 4 two");
    LINE_AFTER("\033[201~", "synth> quit it");
    FOOT_AFTER("\025help all\r", MORE);
    LINE_AFTER("\033[?64;1;2;6;9c\003", "synth>"); /* an answer of the terminal is no key */
    const char *text = quit();
    CHECK_HAS(text, "\nlabel 3 one\n");
    CHECK_HAS(text, "\nlabel 4 two\n");
}

/* A session with this in $PAGER. */
static void start_with_pager(const char *pager)
{
    setenv("PAGER", pager, 1);
    start_at_prompt();
    unsetenv("PAGER");
    unlink("paged");
    BEGIN_AFTER("help all", "synth> help all");
    type("\r");
}

static void end_with_pager(void)
{
    SEE_LINE("synth>");
    CHECK(reads_keys(""));
    LINE_AFTER("label 5 more\r", "synth>");
    CHECK_HAS(quit(), "\nlabel 5 more\n");
}

STORY(the_pager_of_the_user_has_the_answer_and_the_terminal)
{
    OWNED(buf_release) struct buf seen = {0};
    start_with_pager("stty -a <&2 >modes; echo \"$LESSSECURE\" >secure; cat >paged; read x <&2;"
                     " true");
    for (int i = 0; i < 600 && (file_read(&seen, "paged", 1 << 20, NULL) || !seen.length); i++)
        settle(20);
    settle(50);
    CHECK(file_read(&seen, "paged", 1 << 20, NULL) == OK);
    CHECK(strncmp(buf_text(&seen), "The scene\n", 10) == 0);
    CHECK_HAS(buf_text(&seen), "\nquit "); /* to its end */
    CHECK(file_read(&seen, "modes", 1 << 14, NULL) == OK);
    CHECK(strstr(buf_text(&seen), " icanon") && !strstr(buf_text(&seen), "-icanon"));
    CHECK(file_read(&seen, "secure", 100, NULL) == OK);
    CHECK_TEXT(buf_text(&seen), "1\n");
    type("\r"); /* it waits for that */
    end_with_pager();
    unlink("secure");
    unlink("modes");
}

STORY(a_pager_that_reads_little_or_is_none_does_no_harm)
{
    start_with_pager("head -n 2 >paged; kill -INT $$");
    end_with_pager();
    CHECK(file_exists("paged"));
    start_with_pager("no-such-pager --here");
    SEE_FOOT(MORE);
    type("q");
    end_with_pager();
    start_with_pager("");
    SEE_FOOT(MORE);
    type("q");
    end_with_pager();
    unlink("paged");
}

/* Neither Ctrl-D, Ctrl-O nor Ctrl-Z, after which another program has the keys. */
static const char *const any_key[] = {
    "se",           "label 7 ",   " ",      "\t",     "\033[C",      "\033f",
    "\033[A",       "\033[B",     "\033.",  "\022",   "\007",        "\037",
    "\030\005",     "\033u",      "\033c",  "\006",   "\005",        "\001",
    "\027",         "\031",       "\024",   "\025",   "\f",          "\346",
    "\377",         "\033",       "\033P",  "\033[",  "\033[200~",   "\r",
    "\033[201~",    "help all\r", "info\r", "q",      "/",           "b",
    "\346\234\254", "\033[6~",    "\177",   "\033\\", "\033[?64;1c", "\033[<0;1;1M",
    "e\314\201",    "n"};

/* If a command runs, Ctrl-C ends it, and text typed meanwhile is in the line: press it again. */
static void clear_line(void)
{
    type("\003\003");
    for (int i = 0, calm = 0; i < 600 && calm < 2; i++) {
        type("\003");
        settle(20);
        calm = is_cursor_row("synth>") && reads_keys("") ? calm + 1 : 0;
    }
}

STORY(whatever_is_pressed_the_prompt_is_sane_again)
{
    enum { KEYS = sizeof any_key / sizeof any_key[0] };
    uint64_t random = 11;
    unsetenv("VISUAL");
    unsetenv("EDITOR");
    start_at_prompt();
    for (int round = 0; round < 60 && check_failures == 0; round++) {
        char mark[32], row[64];
        set_size(20 + check_below(&random, 80), 5 + check_below(&random, 30));
        for (int i = 0; i < 30; i++) {
            type(any_key[check_below(&random, KEYS)]);
            if (check_below(&random, 4) == 0)
                take(2);
        }
        snprintf(mark, sizeof mark, "# round %d", round);
        snprintf(row, sizeof row, "synth> # round %d", round);
        clear_line();
        LINE_AFTER(mark, row);
        CHECK(!t->screen.is_other && reads_keys(""));
        type("\003");
    }
    set_size(80, 24);
    ROW_AFTER("label 9 sound\r", "synth> label 9 sound");
    const char *text = quit();
    CHECK_HAS(text, "\nlabel 9 sound\n");
}

STORY(pages_can_be_done_without)
{
    static const char off[] = "pager off\n";
    CHECK(file_write("config", off, sizeof off - 1, FILE_REPLACE, NULL) == OK);
    config = "config";
    start_with_pager("cat >paged");
    config = bare;
    SEE_LINE("synth>");
    SEE_BEGIN("quit ");
    CHECK(strstr(buf_text(&t->written), MORE) == NULL && !file_exists("paged"));
    quit();
    unlink("config");
}

/* Return true if a line of `text` after the prompt takes its rows, with the cursor at its end. */
static bool has_rows(const char *text)
{
    char whole[256];
    const unsigned columns = t->screen.columns;
    snprintf(whole, sizeof whole, "synth> %s", text);
    const unsigned length = (unsigned)strlen(whole), rows = length / columns + 1;
    const unsigned last = t->screen.row;
    if (t->screen.column != length % columns || last + 1 < rows)
        return false;
    for (unsigned i = 0; i < rows; i++) {
        const unsigned n = i + 1 < rows ? columns : length % columns;
        char part[256];
        snprintf(part, sizeof part, "%.*s", (int)n, whole + i * columns);
        if (strcmp(screen_row(&t->screen, last - rows + 1 + i), part) != 0)
            return false;
    }
    return true;
}

QUIT_STORY(a_long_line_is_drawn_anew_at_every_width)
{
    static const char text[] = "abcdefghijklmnopqrstuvwxyz0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ-"
                               "abcdefghijklmnopqrstuvwxyz0123456789";
    static const unsigned width[] = {60, 40, 106, 26, 80, 53, 120, 20, 107, 80};
    start_at_prompt();
    BEGIN_AFTER("info\r", "memory ");
    type(text);
    check_awaited(has_rows, text, __LINE__);
    for (size_t i = 0; i < sizeof width / sizeof *width; i++) {
        set_size(width[i], 24);
        check_awaited(has_rows, text, __LINE__);
        if (!CHECK(begins("memory "))) /* older output is unchanged */
            print_screen();
    }
    LINE_AFTER("\003", "synth>");
}

QUIT_STORY(whatever_a_terminal_says_the_line_stays_what_was_typed)
{
    static const char *const reply[] = {
        "\033[?64;1;2;6;9c",                   /* DA1 */
        "\033[>41;379;0c",                     /* DA2 */
        "\033P>|XTerm(379)\033\\",             /* XTVERSION */
        "\033P!|00000000\033\\",               /* DA3 */
        "\033P1+r544e=787465726d\033\\",       /* XTGETTCAP */
        "\033P0$r0m\033\\",                    /* DECRQSS */
        "\033[6;18;9t\033[4;432;720t",         /* sizes */
        "\033[?2;0;1000;1000S",                /* XTSMGRAPHICS */
        "\033[?2026;2$y",                      /* DECRPM */
        "\033[24;80R\033[?24;80R",             /* cursor */
        "\033[0n",                             /* status */
        "\033]11;rgb:0000/0000/0000\033\\",    /* colours */
        "\033]4;1;rgb:ffff/0000/0000\a",       /* ended by BEL */
        "\033_Gi=31;OK\033\\",                 /* kitty */
        "\033_Gi=31;EINVAL:\302\233c\033\\",   /* with bytes of its own */
        "\033[I\033[O",                        /* focus */
        "\033[?1u",                            /* kitty's keyboard */
        "\033[?997;1n",                        /* dark or light */
        "\033[201~",                           /* the end of no paste */
        "\033^private\033\\\033Xstring\033\\", /* PM, SOS */
        "\033[?1;2;3;4;5;6;7;8;9;10;11;12;13;14;15;16;17;18;19;20;21;22;23;24;25;26;27;28;29c",
    };
    OWNED(buf_release) struct buf text = {0}, row = {0}, lengthy = {0};
    start_at_prompt();
    buf_add_text(&text, "#");
    type("#");
    for (size_t i = 0; i < sizeof reply / sizeof *reply; i++) {
        const char letter[] = {(char)('a' + i), '\0'};
        type(reply[i]);
        type(letter);
        buf_add_text(&text, letter);
    }
    buf_add_text(&lengthy, "\033P");
    for (int i = 0; i < 20000; i++) /* more than is stored */
        buf_add_char(&lengthy, (char)('0' + i % 70));
    buf_add_text(&lengthy, "\033\\.");
    for (size_t at = 0; at < lengthy.length; at += 1000) {
        const size_t n = lengthy.length - at < 1000 ? lengthy.length - at : 1000;
        type_bytes(lengthy.data + at, n);
        take(1);
    }
    buf_printf(&row, "synth> %s.", buf_text(&text));
    SEE_LINE(buf_text(&row));
    LINE_AFTER("\033P never ends\003\003", "synth>"); /* one Ctrl-C gets the keyboard back */
}

/* Send the first piece, and then so many bytes at a time. */
static void answer_slowly(const char *reply, size_t first, size_t more)
{
    const size_t length = strlen(reply);
    for (size_t at = 0, piece = first; at < length; at += piece, piece = more) {
        type_bytes(reply + at, length - at < piece ? length - at : piece);
        const uint64_t until = clock_ns() + UINT64_C(250000000);
        while (clock_ns() < until)
            take(20);
    }
}

QUIT_STORY(a_reply_may_take_two_seconds)
{
    const uint64_t begin = clock_ns();
    start_at_prompt();
    type("in");
    answer_slowly("\033[?64;1;2;6;9c", 3, 4);
    answer_slowly("\033P>|XTerm(379)\033\\", 4, 6);
    answer_slowly("\033[?64;1;2;6;9c", 1, 7); /* ESC alone is a key, unless this follows */
    LINE_AFTER("fo", "synth> info");
    CHECK(clock_ns() - begin > UINT64_C(2000000000));
    type("\033"); /* and so is one that nothing follows */
    settle(1000);
    LINE_AFTER("\177\177formation", "synth> information");
    type("\025info");
}

static void start_without_scene(void)
{
    const struct setting empty = {"xterm-256color", NULL, NULL, 80, 24};
    start(&empty);
    SEE_LINE("session>");
    check_awaited(reads_keys, "the program reads keys", __LINE__);
}

/* Return true if the bar is shown, or the scene is already open. */
static bool opens(const char *bar)
{
    return begins(bar) || begins("420x420x340 voxels");
}
static bool is_cancelled(const char *words)
{
    return shows_row(words) || begins("420x420x340 voxels");
}

/* Return false if the key came after the end of the command, which depends on the machine. */
static bool cancel_opening(void)
{
    static const char bar[] = "synthetic scene       [",
                      said[] = "error: cancelled; nothing has changed";
    type("open synth:geom:420x420x340\r");
    check_awaited(opens, bar, __LINE__);
    type("\003");
    check_awaited(is_cancelled, said, __LINE__);
    if (!shows_row(said))
        return false;
    SEE_LINE("session>");
    CHECK(!begins(bar)); /* it is gone */
    return true;
}

STORY(ctrl_c_takes_back_a_line_or_a_command)
{
    OWNED(buf_release) struct buf journal_text = {0};
    start_without_scene();
    BEGIN_AFTER("seed 1,1,1", "session> seed 1,1,1");
    ROW_AFTER("\003", "session> seed 1,1,1^C");
    SEE_LINE("session>");
    for (unsigned tries = 0; tries < 20 && check_failures == 0 && !cancel_opening(); tries++) {
        kill(t->job, SIGKILL);
        CHECK_INT(end(), 128 + SIGKILL);
        unlink("session-1.iftty");
        start_without_scene();
    }
    ROW_AFTER("info\r", "no scene is open");
    quit();
    CHECK(file_read(&journal_text, "session-1.iftty", 1 << 20, NULL) == OK);
    CHECK(!strstr(buf_text(&journal_text), "\nopen "));
    unlink("session-1.iftty");
}

QUIT_STORY(without_colours_there_is_none_and_no_hint)
{
    struct setting setting = plain;
    setting.no_color = "1";
    start(&setting);
    SEE_LINE("synth>");
    LINE_AFTER("seed ", "synth> seed");
    settle(150);
    SEE_LINE("synth> seed");
    ROW_AFTER("1,1 1\r", "            ^");
    SEE_BEGIN("error: PLACE: expected X,Y,Z");
    CHECK_INT(t->screen.colours, 0);
}

STORY(a_dumb_terminal_gets_no_escape_at_all)
{
    struct setting setting = plain;
    setting.term = "dumb";
    start(&setting);
    SEE_LINE("synth>");
    BEGIN_AFTER("seed 20,20,15 1\r", "48000 voxels changed, label 1: 48 ml, ");
    SEE_BEGIN("`seed 20,20,15 0 shell=yes through=X,Y,Z`; it labels all");
    SEE_LINE("synth>"); /* the terminal echoes by itself: not before the prompt */
    ROW_AFTER("sede\r", "error: unknown command sede; did you mean seed?");
    SEE_LINE("synth>");
    BEGIN_AFTER("render\r", "512x512 pixels, ");
    SEE_LINE("synth>");
    ROW_AFTER("pilot\r", "error: `pilot` needs a terminal with a screen, and TERM=dumb has none");
    SEE_LINE("synth>");
    BEGIN_AFTER("quit\r", "journal: synth-1.iftty");
    CHECK(strchr(buf_text(&t->written), '\033') == NULL);
    CHECK_INT(end(), 0);
    forget_journals();
}

/* ---- the pilot ---- */

static bool is_in_pilot(const char *text)
{
    const char *row = screen_row(&t->screen, t->screen.rows - 2);
    (void)text;
    return strncmp(row, "axial", 5) == 0 || strncmp(row, "coronal", 7) == 0 ||
           strncmp(row, "sagittal", 8) == 0 || strncmp(row, "PEN DOWN", 8) == 0;
}

static void enter_pilot(void)
{
    start_at_prompt();
    type("\017");
    check_awaited(is_in_pilot, "the pilot", __LINE__);
}

/* Compare the commands recorded after the scene was opened. */
static void check_recorded(const char *commands)
{
    static const char opened[] = "open synth:geom:40x40x30 weight=morph\nauto on\n";
    OWNED(buf_release) struct buf all = {0};
    for (const char *at = quit(); *at; at += strcspn(at, "\n") + 1)
        if (*at != '#' && *at != '=')
            buf_add(&all, at, strcspn(at, "\n") + 1);
    CHECK(strncmp(buf_text(&all), opened, strlen(opened)) == 0);
    CHECK_TEXT(buf_text(&all) + strlen(opened), commands);
}

STORY(an_answer_that_is_cut_after_its_escape_is_no_key_of_the_pilot)
{
    enter_pilot();
    settle(200);
    for (int i = 0; i < 3; i++) {
        t->is_mute = true;
        type("\033");
        settle(200);
        type(i == 1 ? "[<0;4;4m" : "[?64;1;2;6;9c"); /* c cuts, 1 and 2 begin a count */
        t->is_mute = false;
        settle(200);
    }
    type("\033");
    settle(200);
    type("["); /* a key, even after Escape: the next byte is another key */
    settle(200);
    type("j"); /* one voxel */
    settle(200);
    LINE_AFTER("q", "synth>");
    check_recorded("cross 20,19,15\n");
}

static bool is_asked(const char *text)
{
    (void)text;
    return t->screen.questions > 0;
}

/* In a terminal with these answers to the first questions. */
static void enter_answering(const struct setting *setting, const char *answers)
{
    start(setting);
    t->is_mute = true;
    check_awaited(is_asked, "the first question", __LINE__);
    type(answers);
    t->answered = 1;
    t->is_mute = false;
    SEE_LINE("synth>");
    type("\017");
    check_awaited(is_in_pilot, "the pilot", __LINE__);
}

/* Kitty 0.26 may lose a sequence that a frame begins with. */
QUIT_STORY(no_frame_of_the_pilot_begins_with_a_sequence)
{
    static const char begin[] = "\033[?2026h";
    struct setting setting = plain;
    unsigned frames = 0;
    setting.term = "foot";
    enter_answering(&setting, "\033[?2026;2$y\033[?64;1;2;6;9c");
    LINE_AFTER("3lq", "synth>");
    const char *at = buf_text(&t->written);
    while ((at = strstr(at, begin))) {
        at += strlen(begin);
        CHECK(*at != '\033');
        frames++;
    }
    CHECK(frames > 0);
}

/* Kitty by its answers, with cells of 8x16 pixels. */
#define KITTY "\033P>|kitty(0.26.5)\033\\\033[6;16;8t\033_Gi=31;OK\033\\"

static bool has_recorded(const char *command)
{
    return strstr(journal(1), command);
}

/* By its answer to ESC]11;? */
QUIT_STORY(on_a_light_background_hints_are_darker)
{
    enter_answering(&plain, "\033]11;rgb:ffff/ffff/dddd\033\\\033[?64;1;2;6;9c");
    LINE_AFTER("q", "synth>");
    buf_clear(&t->written); /* the picture has greys too */
    BEGIN_AFTER("zoom", "synth> zoom fit|FACTOR");
    CHECK(strstr(buf_text(&t->written), "\033[38;5;242m") != NULL);
    CHECK(strstr(buf_text(&t->written), "\033[38;5;244m") == NULL);
}

#define PIXELS  "\033[?1016;2$y"
#define NO_MORE "\033[?1016;0$y"
#define DA1     "\033[?62;c"

/* An outline in two cells by two; a voxel has some five pixels. */
STORY(a_pen_that_the_mouse_moves_by_pixels_draws_finer_than_cells)
{
    enter_answering(&plain, KITTY PIXELS DA1);
    CHECK(strstr(buf_text(&t->written), "\033[?1002h\033[?1006h\033[?1016h") != NULL);
    type("@\033[<0;80;80M\033[<32;89;82M\033[<32;92;85M\033[<32;95;90M\033[<32;92;100M"
         "\033[<32;84;100M\033[<32;80;90M\033[<0;80;90m");
    check_awaited(has_recorded, "\noutline ", __LINE__);
    type("@"); /* nothing is drawn: that lifts the pen */
    LINE_AFTER("q", "synth>");
    CHECK(strstr(buf_text(&t->written), "\033[?1016l\033[?1006l\033[?1002l") != NULL);
    check_recorded("cross 36,20,12\ncross 34,20,12\ncross 34,20,11\ncross 33,20,10\n"
                   "cross 34,20,8\ncross 35,20,8\ncross 36,20,10\n"
                   "outline 36,20,12 1 to=34,20,12 to=33,20,10 to=34,20,8 to=35,20,8 "
                   "to=36,20,10\n");
}

STORY(pixels_lead_to_the_voxels_that_the_middles_of_their_cells_do)
{
    static const char crossed[] = "cross 35,20,11\ncross 20,20,1\ncross 34,13,15\n";
    enter_answering(&plain, KITTY NO_MORE DA1);
    CHECK(!strstr(buf_text(&t->written), "1016h"));
    type("\033[<0;11;6M\033[<0;11;6m\033[<0;60;9M\033[<0;60;9m\033[<0;12;18M\033[<0;12;18m"
         "\033[<0;81;3M");
    LINE_AFTER("q", "synth>");
    check_recorded(crossed);
    enter_answering(&plain, KITTY PIXELS DA1);
    type("\033[<0;84;88M\033[<32;88;84M\033[<32;80;92M\033[<0;81;89m" /* a hand that shakes */
         "\033[<0;476;136M\033[<0;476;136m\033[<0;92;280M\033[<0;92;280m\033[<0;640;40M"
         "\033[<0;-1;40m");
    LINE_AFTER("q", "synth>");
    check_recorded(crossed);
}

STORY(a_paste_is_no_key_of_the_pilot_however_it_is_cut)
{
    static const char paste[] = "\033[200~i2s1vll\rq\nseed 1,1,1 2\tu\033[201~";
    for (size_t cut = 6; cut < sizeof paste - 1; cut += cut < 26 ? 7 : 1) {
        enter_pilot();
        t->is_mute = true;
        type_bytes(paste, cut);
        settle(cut % 2 ? 5 : 120); /* longer than what makes a key of an ESC */
        type(paste + cut);
        t->is_mute = false;
        SEE_LINE(":i2s1vll q seed 1,1,1 2 u");
        BEGIN_AFTER("\033", "nothing to show yet: ");
        BEGIN_AFTER("?", "  h j k l arrows ");
        type("\033[200~iii"); /* into a page; and it does not end */
        settle(100);
        type("\003");
        settle(100);
        BEGIN_AFTER(" ", "nothing to show yet: ");
        LINE_AFTER("q", "synth>");
        check_recorded("");
    }
}

/* Whole keys, replies and lines; nothing that leaves the pilot or stops it. */
static const char *const whole[] = {
    "\033[A", "\033[B",   "\033[1;5C", "\033[1;2D", "\033[1;3A", "\033[?64;1;2c",
    "\033OA", "\033[5~",  "\033[6~",   "\033[Z",    "\033",      "\033[6;18;9t",
    "\033h",  "\r",       "\t",        "\022",      "\014",      "\033_Gi=31;OK\033\\",
    "\003",   "\033P>|x", "\033\\",    "\033[200~", "\033[201~", "\033[?2026;2$y",
    "ma'a",   "s1",       "s0",        "xx",        "gg",        ":label 3 n\r",
    "99",     "V",        "p",         "v",         ":info\r",   ":seed 1,1,1 1\033"};

/* Something that a keyboard, a mouse, a paste or a terminal sends, or any bytes; nothing that
 * leaves the pilot or stops it. */
static void add_random(struct buf *out, uint64_t *seed)
{
    const uint64_t kind = check_below(seed, 12);
    if (kind < 5)
        buf_add_text(out, whole[check_below(seed, sizeof whole / sizeof whole[0])]);
    else if (kind == 5)
        buf_printf(out, "\033[<%u;%u;%u%c", (unsigned)check_below(seed, 100),
                   (unsigned)check_below(seed, 90), (unsigned)check_below(seed, 30),
                   check_below(seed, 2) ? 'M' : 'm');
    else if (kind == 6)
        buf_add_text(out, "\033[200~seed 2,2,2 9\rseed 2,2,2 9\ri\033[201~");
    else if (kind == 7)
        buf_add_char(out, (char)(0x80 + check_below(seed, 0x80)));
    else {
        const char key = (char)(' ' + check_below(seed, 95));
        buf_add_char(out, key == 'q' ? 'i' : key);
    }
}

/* Return to moving the cross-hair from any state: a paste, a page, a line, a mode, corners; and
 * remove the last message, which is shown until the next key. */
static void come_back(void)
{
    type("\033\\\033[201~");
    for (int i = 0; i < 6; i++) {
        settle(120);
        type("\033");
    }
    check_awaited(is_in_pilot, "the pilot", __LINE__);
}

/* The rows of the screen, each ended by a line feed. An upper half in one colour on another is a
 * lower half in that one on the first. */
static void take_screen(struct buf *out)
{
    buf_clear(out);
    for (unsigned y = 0; y < t->screen.rows; y++) {
        for (const char *at = screen_row(&t->screen, y); *at;) {
            const bool is_half = !strncmp(at, "\u2580", 3) || !strncmp(at, "\u2584", 3);
            buf_add_char(out, is_half ? '#' : *at);
            at += is_half ? 3 : 1;
        }
        buf_add_char(out, '\n');
    }
}

/* The screen once nothing has come for longer than a barrier is waited for. */
static void take_last_screen(struct buf *out)
{
    for (size_t before = t->written.length + 1; before != t->written.length;) {
        before = t->written.length;
        settle(2500);
    }
    take_screen(out);
}

/* Check that a redraw changes nothing. */
static void check_screen(void)
{
    OWNED(buf_release) struct buf before = {0}, after = {0};
    take_last_screen(&before);
    type("\014");
    take_last_screen(&after);
    CHECK_TEXT(buf_text(&before), buf_text(&after));
}

static void verify_journal(void)
{
    int status = -1;
    const pid_t job = fork();
    if (job == 0) {
        if (!freopen("/dev/null", "w", stdout))
            _exit(126);
        execl(program, "iftty", "verify", "--no-strict", "synth-1.iftty", (char *)NULL);
        _exit(127);
    }
    waitpid(job, &status, 0);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

QUIT_STORY(the_picture_stays_where_the_line_below_it_is_drawn_anew)
{
    enter_pilot();
    LINE_AFTER(":info", ":info");
    check_screen();
    BEGIN_AFTER("\033", "nothing to show yet: ");
    LINE_AFTER("q", "synth>");
}

/* PILOT_ROUNDS=N, 3 unless given. */
static unsigned long pilot_rounds(void)
{
    const char *given = getenv("PILOT_ROUNDS");
    return given ? strtoul(given, NULL, 10) : 3;
}

STORY(any_bytes_leave_the_pilot_a_sane_screen_and_an_exact_journal)
{
    for (uint64_t round = 0, seed = 11; round < pilot_rounds(); round++) {
        OWNED(buf_release) struct buf bytes = {0};
        const unsigned columns = 20 + (unsigned)check_below(&seed, 80);
        enter_pilot();
        set_size(columns, 10 + (unsigned)check_below(&seed, 30));
        for (int burst = 0; burst < 25; burst++) {
            buf_clear(&bytes);
            for (uint64_t n = 1 + check_below(&seed, 12); n > 0; n--)
                add_random(&bytes, &seed);
            type_bytes(bytes.data, bytes.length);
            settle(check_below(&seed, 3) ? 5 : 90);
            if (check_below(&seed, 2)) /* out of lines, pages and modes */
                type(check_below(&seed, 4) ? "\033[201~\033" : "\033[201~\r");
        }
        come_back();
        check_screen();
        LINE_AFTER("q", "synth>");
        type("\025quit\r");
        CHECK_INT(end(), 0);
        verify_journal();
        printf("# round %d: %zu bytes of journal\n", (int)round, strlen(journal(1)));
        forget_journals();
    }
}

int main(void)
{
    unsetenv("PAGER");
    alarm(900 + 60 * (unsigned)pilot_rounds());
    ssize_t n = readlink("/proc/self/exe", program, sizeof program - 32);
    program[n > 0 ? n : 0] = '\0';
    for (int up = 0; up < 2 && strrchr(program, '/'); up++)
        *strrchr(program, '/') = '\0';
    strcat(program, "/iftty");
    if (!realpath("tests/bare.config", bare))
        return 1;
    if (!make_folder(folder, "pty") || chdir(folder) != 0)
        return 1;
    const int status = check_run();
    return remove_folder(folder) | status;
}
