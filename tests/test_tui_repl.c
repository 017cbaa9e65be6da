/* SPDX-License-Identifier: MIT */
/* The prompt in a real pseudo-terminal: a fake terminal answers questions or does not, keys are
 * typed, and a small shell stops and continues the program as job control does. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/check.h"
#include "tests/folder.h"
#include "tui/prompt/repl.h"
#include "tui/term.h"

/* ---- the host: a handful of commands ---- */

static uint8_t rendition[64 * 40 * 4];
static int news_pipe[2]; /* a byte for each line of news, which the story writes */

struct host {
    bool finished, has_picture;
};

static void host_prompt(void *context, struct buf *out)
{
    (void)context;
    buf_add_text(out, "ch2> ");
}

static enum err host_execute(void *context, const char *text, struct buf *output,
                             struct fault *fault)
{
    struct host *host = context;
    if (strncmp(text, "echo ", 5) == 0) {
        buf_printf(output, "[%s]\n", text + 5);
    } else if (strcmp(text, "picture") == 0) {
        host->has_picture = true;
    } else if (strcmp(text, "quit") == 0) {
        host->finished = true;
    } else if (strcmp(text, "wait") == 0) {
        if (write(STDOUT_FILENO, "waiting\n", 8) == 8)
            pause();
        buf_add_text(output, "[waited]");
    } else if (strcmp(text, "crash") == 0) {
        raise(SIGSEGV);
    } else if (strcmp(text, "abort") == 0) {
        abort();
    } else if (strcmp(text, "exit") == 0) {
        exit(7);
    } else {
        return fault_set(fault, ERR_USAGE, "there is no command %s", text);
    }
    return OK;
}

static void host_complete(void *context, const char *text, size_t cursor, struct buf *candidates,
                          size_t *word_start)
{
    static const char *const word[] = {"echo", "picture", "pick", "quit"};
    (void)context;
    *word_start = 0;
    for (size_t i = 0; i < 4; i++)
        if (strncmp(word[i], text, cursor) == 0)
            buf_printf(candidates, "%s\n", word[i]);
}

static bool host_picture(void *context, struct image_view *out)
{
    struct host *host = context;
    bool had = host->has_picture;
    *out = (struct image_view){.width = 64, .height = 40, .rgba = rendition};
    host->has_picture = false;
    return had;
}

static void host_news(void *context, struct buf *output)
{
    char c;
    (void)context;
    if (read(news_pipe[0], &c, 1) == 1)
        buf_add_text(output, "[news]\n");
}

static bool host_finished(void *context)
{
    const struct host *host = context;
    return host->finished;
}

static int run_host(const struct repl_options *options, bool once)
{
    struct host state = {0};
    struct repl_host host = {.context = &state,
                             .prompt = host_prompt,
                             .execute = host_execute,
                             .complete = host_complete,
                             .picture = host_picture,
                             .news = host_news,
                             .finished = host_finished};
    struct fault fault;
    host.news_descriptor = news_pipe[0];
    for (size_t i = 0; i < sizeof rendition; i++)
        rendition[i] = (uint8_t)(i % 4 == 3 ? 255 : 40 * (i / 600));
    if (once)
        return show_picture_once(
            options->graphics, &(struct image_view){.width = 64, .height = 40, .rgba = rendition});
    return (int)repl_run(&host, options, &fault);
}

/* ---- the terminal ---- */

struct terminal {
    int master, slave, report, order;
    pid_t shell, job;
    struct termios found;
    const char *da1, *name; /* answers; NULL for none */
    bool kitty;
    unsigned delay_ms; /* of the line: answers wait in `late` until `late_ns` */
    struct buf late;
    uint64_t late_ns;
    size_t answered; /* bytes of `seen` looked at for questions */
    size_t mark;     /* what was expected ended here */
    struct buf seen;
};

struct setting {
    const char *term, *da1, *name, *no_color;
    bool kitty, once;
    unsigned delay_ms;
    struct repl_options options;
};

/* The shell's life: starts the job in the foreground, reports when it stops or ends, and goes on
 * when ordered. Stays until the end, since the terminal hangs up with it. */
static void run_shell(int slave, int report, int order, const struct setting *setting)
{
    int status;
    char c;
    setsid();
    ioctl(slave, TIOCSCTTY, 0);
    signal(SIGTTOU, SIG_IGN);
    signal(SIGINT, SIG_DFL); /* ignored where the test itself runs in the background or by nohup */
    signal(SIGQUIT, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    for (int fd = 0; fd < 3; fd++)
        dup2(slave, fd);
    pid_t job = fork();
    if (job == 0) {
        setpgid(0, 0);
        tcsetpgrp(0, getpid());
        signal(SIGTTOU, SIG_DFL);
        close(slave);
        close(report);
        close(order);
        setenv("TERM", setting->term, 1);
        unsetenv("COLORTERM");
        unsetenv("NO_COLOR");
        if (setting->no_color)
            setenv("NO_COLOR", setting->no_color, 1);
        exit(run_host(&setting->options, setting->once));
    }
    setpgid(job, job);
    bool alive = write(report, &job, sizeof job) == sizeof job;
    while (alive && waitpid(job, &status, WUNTRACED) == job) {
        if (write(report, &status, sizeof status) < 0 || read(order, &c, 1) < 1)
            break;
        alive = WIFSTOPPED(status);
        tcsetpgrp(0, job);
        kill(-job, SIGCONT);
    }
    _exit(0);
}

static void start(struct terminal *t, const struct setting *setting)
{
    int report[2], order[2];
    struct winsize size = {.ws_row = 24, .ws_col = 80, .ws_xpixel = 800, .ws_ypixel = 480};
    *t = (struct terminal){.da1 = setting->da1,
                           .name = setting->name,
                           .kitty = setting->kitty,
                           .delay_ms = setting->delay_ms};
    t->master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    grantpt(t->master);
    unlockpt(t->master);
    t->slave = open(ptsname(t->master), O_RDWR | O_NOCTTY);
    ioctl(t->slave, TIOCSWINSZ, &size);
    tcgetattr(t->slave, &t->found);
    if (pipe(report) != 0 || pipe(order) != 0)
        exit(1);
    fflush(stdout);
    t->shell = fork();
    if (t->shell == 0) {
        close(report[0]);
        close(order[1]);
        run_shell(t->slave, report[1], order[0], setting);
    }
    close(report[1]);
    close(order[0]);
    t->report = report[0];
    t->order = order[1];
    CHECK(read(t->report, &t->job, sizeof t->job) == sizeof t->job);
}

static void type_bytes(struct terminal *t, const char *bytes, size_t length)
{
    CHECK(write(t->master, bytes, length) == (ssize_t)length);
}

static void type(struct terminal *t, const char *text)
{
    type_bytes(t, text, strlen(text));
}

static bool is_question(const char *at, const char *question)
{
    return strncmp(at, question, strlen(question)) == 0;
}

static void reply(struct terminal *t, const char *text)
{
    if (t->delay_ms == 0) {
        type(t, text);
        return;
    }
    if (t->late.length == 0)
        t->late_ns = clock_ns() + t->delay_ms * UINT64_C(1000000);
    buf_add_text(&t->late, text);
}

static void reply_late(struct terminal *t)
{
    if (t->late.length == 0 || clock_ns() < t->late_ns)
        return;
    type_bytes(t, t->late.data, t->late.length);
    buf_clear(&t->late);
}

/* Answers the questions in what came since, as a terminal with these abilities does. */
static void answer(struct terminal *t)
{
    for (; t->answered < t->seen.length; t->answered++) {
        const char *at = t->seen.data + t->answered;
        if (is_question(at, "\033[c") && t->da1)
            reply(t, t->da1);
        else if (is_question(at, "\033[>q") && t->name)
            reply(t, t->name);
        else if (is_question(at, "\033_Gi=31,s=1,v=1,a=q") && t->kitty)
            reply(t, "\033_Gi=31;OK\033\\");
        else if (*at == '\033' && t->seen.length - t->answered < 24 && !strchr(at, 'c'))
            break; /* perhaps cut short: look again when more is there */
    }
}

/* Takes in what the program writes for up to `ms`, or until `text` comes after the mark. */
static bool see(struct terminal *t, const char *text, int ms)
{
    uint64_t end = clock_ns() + (uint64_t)ms * 1000000;
    for (;;) {
        char piece[4096];
        const char *found = text ? strstr(buf_text(&t->seen) + t->mark, text) : NULL;
        if (found) {
            t->mark = (size_t)(found - t->seen.data) + strlen(text);
            return true;
        }
        uint64_t now = clock_ns();
        struct pollfd ready = {.fd = t->master, .events = POLLIN};
        reply_late(t);
        if (now >= end)
            return false;
        if (poll(&ready, 1, t->late.length ? 2 : (int)((end - now) / 1000000) + 1) == 0)
            continue;
        ssize_t n = read(t->master, piece, sizeof piece);
        if (n > 0) {
            buf_add(&t->seen, piece, (size_t)n);
            answer(t);
        } else if (n == 0 || errno != EINTR) {
            return false;
        }
    }
}

#define SEE(t, text)                                                                               \
    do {                                                                                           \
        size_t see_from = (t)->mark;                                                               \
        if (!check_report(see(t, text, 60000), __FILE__, __LINE__, "sees " #text))                 \
            print_seen(t, see_from);                                                               \
    } while (0)

static void print_seen(const struct terminal *t, size_t from)
{
    printf("#   saw \"");
    for (size_t i = from; i < t->seen.length && i < from + 600; i++) {
        unsigned char c = (unsigned char)t->seen.data[i];
        if (c < 32 || c > 126)
            printf("\\x%02x", c);
        else
            putchar(c);
    }
    printf("\"\n");
}

static bool modes_are_as_found(const struct terminal *t)
{
    struct termios now;
    return tcgetattr(t->slave, &now) == 0 && now.c_iflag == t->found.c_iflag &&
           now.c_oflag == t->found.c_oflag && now.c_cflag == t->found.c_cflag &&
           now.c_lflag == t->found.c_lflag && memcmp(now.c_cc, t->found.c_cc, sizeof now.c_cc) == 0;
}

/* Waits until the job stops or ends; its wait status, or -1 when nothing happens. */
static int report_of(struct terminal *t)
{
    int status = -1;
    for (int i = 0; i < 6000; i++) {
        struct pollfd ready = {.fd = t->report, .events = POLLIN};
        see(t, NULL, 10); /* so that it does not wait for us to read */
        if (poll(&ready, 1, 0) > 0)
            return read(t->report, &status, sizeof status) == sizeof status ? status : -1;
    }
    return -1;
}

static void end(struct terminal *t)
{
    close(t->order);
    see(t, NULL, 5);
    kill(t->shell, SIGKILL);
    kill(t->job, SIGKILL);
    waitpid(t->shell, NULL, 0);
    close(t->report);
    close(t->master);
    close(t->slave);
    buf_release(&t->seen);
    buf_release(&t->late);
}

/* What a shell would find typed, once every answer has come. */
static size_t left_to_read(struct terminal *t)
{
    char bytes[256];
    struct termios raw = t->found;
    see(t, NULL, (int)t->delay_ms + 50);
    raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    raw.c_cc[VMIN] = raw.c_cc[VTIME] = 0;
    tcsetattr(t->slave, TCSANOW, &raw);
    ssize_t n = read(t->slave, bytes, sizeof bytes);
    return n > 0 ? (size_t)n : 0;
}

static const struct setting xterm = {.term = "xterm", .da1 = "\033[?64;1;2;6;9c"};
static const struct setting vt340 = {
    .term = "xterm", .da1 = "\033[?63;1;2;4;6;9c", .name = "\033P>|XTerm(379)\033\\"};
static const struct setting kitty = {
    .term = "xterm-kitty", .da1 = "\033[?62c", .name = "\033P>|kitty(0.26.5)\033\\", .kitty = true};
static const struct setting silent = {.term = "xterm"};

/* ---- stories ---- */

STORY(a_line_is_edited_and_run_and_ctrl_d_restores_everything)
{
    struct terminal t;
    uint64_t begin = clock_ns();
    start(&t, &xterm);
    SEE(&t, "\033[?2004h");
    SEE(&t, "ch2> ");
    printf("# start to prompt %.1f ms\n", (double)(clock_ns() - begin) / 1e6);
    CHECK(!modes_are_as_found(&t));
    type(&t, "exho hell");
    SEE(&t, "exho hell");
    type(&t, "o\001\006\033[3~h\010c\005 \303\244\r"); /* exho -> echo, and an umlaut */
    SEE(&t, "hello \303\244\r\n");
    SEE(&t, "[hello \303\244]\r\n");
    SEE(&t, "ch2> ");
    type(&t, "\004");
    CHECK_INT(report_of(&t), 0);
    CHECK(modes_are_as_found(&t));
    SEE(&t, "\033[?2004l");
    end(&t);
}

STORY(replies_that_come_late_never_reach_the_line)
{
    struct terminal t;
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    type(&t, "echo a\033[?62;4c\033P>|late\033\\b\033_Gi=31;OK\033\\\033[6;18;9tc\r");
    SEE(&t, "[abc]");
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(a_sixel_terminal_gets_sixels_and_each_is_waited_for)
{
    uint64_t took_least = UINT64_MAX;
    for (int i = 0; i < 5 && took_least > UINT64_C(1500000000); i++) { /* others may be busy */
        struct terminal t;
        start(&t, &vt340);
        SEE(&t, "ch2> ");
        type(&t, "picture\r");
        SEE(&t, "\r\n\n\033[2A\0337\033P0;1q\"1;1;64;40");
        SEE(&t, "\033\\\0338\033[2B\r\033[c");
        SEE(&t, "ch2> ");
        const uint64_t begin = clock_ns();
        type(&t, "picture\rquit\r");
        SEE(&t, "\033P0;1q");
        CHECK_INT(report_of(&t), 0);
        CHECK(modes_are_as_found(&t));
        const uint64_t took = clock_ns() - begin;
        took_least = took < took_least ? took : took_least;
        end(&t);
    }
    CHECK(took_least < UINT64_C(1500000000)); /* no answer is waited for twice */
}

STORY(kitty_is_asked_and_gets_its_own_graphics)
{
    struct terminal t;
    start(&t, &kitty);
    SEE(&t, "a=q");
    SEE(&t, "\r\033[K");
    SEE(&t, "ch2> ");
    type(&t, "picture\r");
    SEE(&t, "\033_Ga=T,C=1,f=100,q=2,m=0;iVBOR");
    SEE(&t, "ch2> ");
    type(&t, "\004");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(a_picture_that_nobody_confirms_is_recovered_from_before_the_next)
{
    struct terminal t;
    start(&t, &kitty);
    SEE(&t, "ch2> ");
    t.da1 = NULL; /* the line has cut it */
    type(&t, "picture\r");
    SEE(&t, "\033_Ga=T");
    SEE(&t, "ch2> ");
    type(&t, "picture\r");
    SEE(&t, "\033_Gm=0,q=2;\033\\\033_Gm=0,q=2;\033\\");
    SEE(&t, "\033_Ga=T");
    SEE(&t, "ch2> ");
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(a_terminal_without_graphics_gets_blocks)
{
    struct terminal t;
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    type(&t, "picture\rquit\r");
    SEE(&t, "\033[48;5;");
    CHECK_INT(report_of(&t), 0);
    CHECK(strstr(t.seen.data, "\033P") == NULL && strstr(t.seen.data, "\033_G") == NULL);
    end(&t);
}

STORY(without_colours_one_question_is_asked_and_nothing_coloured)
{
    struct terminal t;
    struct setting setting = vt340;
    setting.no_color = "1";
    start(&t, &setting);
    SEE(&t, "ch2> ");
    type(&t, "nonsense\rpicture\rquit\r");
    SEE(&t, "error: there is no command nonsense\r\n");
    CHECK_INT(report_of(&t), 0);
    CHECK(strstr(t.seen.data, "\033[>") == NULL && strstr(t.seen.data, "\033[31m") == NULL &&
          strstr(t.seen.data, "\033[48") == NULL);
    CHECK_HAS(t.seen.data, "%%%");
    end(&t);
}

STORY(a_silent_terminal_costs_two_seconds_and_no_key)
{
    struct terminal t;
    start(&t, &silent);
    SEE(&t, "\033[c");
    uint64_t begin = clock_ns();
    type(&t, "echo ea");
    type(&t, "rly\r");
    SEE(&t, "[early]");
    uint64_t took = (clock_ns() - begin) / 1000000;
    CHECK(took > 1500 && took < 20000); /* twice two seconds, if nobody else is busy */
    type(&t, "\004");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(answers_that_take_their_time_are_not_left_to_the_shell)
{
    struct setting setting = vt340;
    struct terminal t;
    setting.delay_ms = 300;
    start(&t, &setting);
    SEE(&t, "ch2> ");
    type(&t, "picture\rquit\r");
    SEE(&t, "\033P0;1q");
    CHECK_INT(report_of(&t), 0);
    CHECK(modes_are_as_found(&t));
    CHECK_INT(left_to_read(&t), 0);
    end(&t);
}

STORY(ctrl_z_waits_for_the_answer_that_is_due)
{
    struct setting setting = vt340;
    struct terminal t;
    setting.delay_ms = 300;
    start(&t, &setting);
    SEE(&t, "ch2> ");
    type(&t, "picture\r\032");
    CHECK(WIFSTOPPED(report_of(&t)));
    CHECK(modes_are_as_found(&t));
    CHECK_INT(left_to_read(&t), 0);
    end(&t);
}

STORY(an_answer_that_comes_after_two_seconds_is_neither_text_nor_harm)
{
    struct setting setting = vt340;
    struct terminal t;
    setting.delay_ms = 2300;
    start(&t, &setting);
    SEE(&t, "ch2> ");
    type(&t, "echo on");
    see(&t, NULL, 500);
    type(&t, "ly\r");
    SEE(&t, "[only]");
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    CHECK_INT(left_to_read(&t), 0);
    end(&t);
}

STORY(ctrl_c_empties_the_line_and_keeps_the_session)
{
    struct terminal t;
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    type(&t, "echo lost");
    SEE(&t, "echo lost");
    type(&t, "\003echo kept\r");
    SEE(&t, "^C\r\n");
    SEE(&t, "[kept]");
    CHECK(strstr(t.seen.data, "[lost") == NULL);
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(tab_completes_and_lists)
{
    struct terminal t;
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    type(&t, "ec\tdone\r");
    SEE(&t, "[done]");
    type(&t, "p\t");
    SEE(&t, "ch2> pic");
    type(&t, "\t");
    SEE(&t, "picture  pick\r\n");
    SEE(&t, "ch2> pic");
    type(&t, "\003quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(a_large_paste_is_one_redraw_and_its_lines_are_run)
{
    struct terminal t;
    struct buf paste = {0};
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    buf_add_text(&paste, "\033[200~echo ");
    for (int i = 0; i < 3000; i++)
        buf_add_char(&paste, 'x');
    size_t before = t.seen.length;
    for (size_t at = 0; at < paste.length; at += 100) { /* in pieces, as a network would */
        type_bytes(&t, paste.data + at, paste.length - at < 100 ? paste.length - at : 100);
        see(&t, NULL, 1);
    }
    type(&t, "\033[201~");
    SEE(&t, "xxx");
    see(&t, NULL, 300);
    CHECK(t.seen.length - before < 2400); /* a screenful, once */
    type(&t, "\003\033[200~echo one\r\necho two\necho thr\033[201~ee\r");
    SEE(&t, "[one]");
    SEE(&t, "[two]");
    SEE(&t, "[three]");
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    buf_release(&paste);
    end(&t);
}

STORY(history_is_searched_and_kept_in_a_file)
{
    struct terminal t;
    char folder[FOLDER_LENGTH], path[FILE_LENGTH];
    struct setting setting = xterm;
    struct stat status;
    CHECK(make_folder(folder, "repl"));
    snprintf(path, sizeof path, "%s/history", folder);
    setting.options.history_path = path;
    start(&t, &setting);
    SEE(&t, "ch2> ");
    type(&t, "echo first\recho second\r");
    SEE(&t, "[second]");
    type(&t, "\022fir");
    SEE(&t, "(search 'fir') echo first");
    type(&t, "\r");
    SEE(&t, "[first]");
    type(&t, "\004");
    CHECK_INT(report_of(&t), 0);
    end(&t);
    CHECK(stat(path, &status) == 0 && (status.st_mode & 0777) == 0600);
    start(&t, &setting);
    SEE(&t, "ch2> ");
    type(&t, "\033[A\033OA\r"); /* two up, in two dialects */
    SEE(&t, "[second]");
    type(&t, "\004");
    CHECK_INT(report_of(&t), 0);
    end(&t);
    unlink(path);
    rmdir(folder);
}

/* Whether the b that follows an escape alone is a b; not where the program had no time to look
 * between the two. */
static bool is_lone_escape(struct terminal *t)
{
    type(t, "echo one two\033b");
    see(t, NULL, 100);
    type(t, "X\033");
    see(t, NULL, 300); /* longer than the time-out */
    type(t, "b\r");
    SEE(t, "two]\r\n");
    const bool is_letter = strstr(buf_text(&t->seen), "[one Xbtwo]") != NULL;
    CHECK(is_letter || strstr(buf_text(&t->seen), "[one Xtwo]") != NULL);
    SEE(t, "ch2> ");
    return is_letter;
}

STORY(escape_alone_is_not_the_alt_key)
{
    struct terminal t;
    bool is_letter = false;
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    for (int tries = 0; tries < 20 && check_failures == 0 && !is_letter; tries++)
        is_letter = is_lone_escape(&t);
    CHECK(is_letter);
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(a_new_width_is_used_at_once)
{
    struct terminal t;
    struct winsize size = {.ws_row = 24, .ws_col = 20};
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    type(&t, "echo 0123456789");
    SEE(&t, "echo 0123456789");
    ioctl(t.slave, TIOCSWINSZ, &size);
    SEE(&t, "echo 0123456789\r\n"); /* exactly full now */
    type(&t, "a\r");
    SEE(&t, "[0123456789a]");
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

static void give_news(void)
{
    CHECK(write(news_pipe[1], "n", 1) == 1);
}

STORY(news_stand_above_the_line_that_is_typed)
{
    struct terminal t;
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    type(&t, "echo ha");
    SEE(&t, "echo ha");
    give_news();
    SEE(&t, "\r\033[J[news]\r\n"); /* on its own: nothing was typed */
    SEE(&t, "ch2> echo ha");
    type(&t, "lf\r");
    SEE(&t, "[half]");
    type(&t, "quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(news_clear_every_row_of_a_long_line)
{
    struct terminal t;
    struct winsize size = {.ws_row = 24, .ws_col = 20};
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    ioctl(t.slave, TIOCSWINSZ, &size);
    type(&t, "echo 012345678901234567890123456789012345678z"); /* rows 0 to 2 */
    SEE(&t, "8z");
    give_news();
    SEE(&t, "\033[2A\r\033[J[news]\r\n");
    SEE(&t, "ch2> ");
    type(&t, "\003quit\r");
    CHECK_INT(report_of(&t), 0);
    end(&t);
}

STORY(ctrl_z_gives_the_terminal_back_and_fg_draws_again)
{
    struct terminal t;
    start(&t, &xterm);
    SEE(&t, "ch2> ");
    type(&t, "echo half");
    SEE(&t, "echo half");
    type(&t, "\032");
    int status = report_of(&t);
    CHECK(WIFSTOPPED(status));
    CHECK(modes_are_as_found(&t));
    SEE(&t, "\033[?2004l");
    CHECK(write(t.order, "f", 1) == 1);
    SEE(&t, "\033[?2004h");
    SEE(&t, "ch2> echo half");
    CHECK(!modes_are_as_found(&t));
    type(&t, " and half\r");
    SEE(&t, "[half and half]");
    type(&t, "wait\r");
    SEE(&t, "waiting");
    type(&t, "\032"); /* while a command runs it is a signal */
    status = report_of(&t);
    CHECK(WIFSTOPPED(status));
    CHECK(modes_are_as_found(&t));
    CHECK(write(t.order, "f", 1) == 1);
    see(&t, "\033[?2004h", 1000);
    kill(t.job, SIGTERM);
    report_of(&t);
    CHECK(modes_are_as_found(&t));
    end(&t);
}

/* Types `command`, sends `number` (0: none), and expects the job to end by itself, the terminal to
 * be restored and the farewell to begin with ESC \. */
static void check_end(const char *command, int number, bool by_signal)
{
    struct terminal t;
    start(&t, &vt340);
    SEE(&t, "ch2> ");
    type(&t, command);
    if (strcmp(command, "wait\r") == 0)
        SEE(&t, "waiting");
    else if (number)
        SEE(&t, command);
    if (number)
        kill(t.job, number);
    int status = report_of(&t);
    CHECK(status > 0);
    if (by_signal && number)
        CHECK(WIFSIGNALED(status) && WTERMSIG(status) == number);
    CHECK(modes_are_as_found(&t));
    const bool asks =
        number == SIGTERM || number == SIGINT; /* a line that is gone answers nothing */
    SEE(&t,
        asks ? "\033\\\033[c\033[?2004l\033[m\033[?25h\r" : "\033\\\033[?2004l\033[m\033[?25h\r");
    end(&t);
}

STORY(sigterm_and_sighup_at_the_prompt_restore_the_terminal)
{
    check_end("half a li", SIGTERM, true);
    check_end("half a li", SIGHUP, true);
}

STORY(signals_while_a_command_runs_restore_the_terminal)
{
    check_end("wait\r", SIGTERM, true);
    check_end("wait\r", SIGINT, true);
}

STORY(crashes_restore_the_terminal)
{
    check_end("crash\r", 0, false);
    check_end("abort\r", 0, false);
}

STORY(exit_inside_a_command_restores_the_terminal)
{
    check_end("exit\r", 0, false);
}

STORY(one_picture_is_shown_without_a_prompt)
{
    struct terminal t;
    struct setting setting = vt340;
    setting.once = true;
    start(&t, &setting);
    SEE(&t, "\r\n\n\033[2A\0337\033P0;1q\"1;1;64;40");
    SEE(&t, "\0338\033[2B\r\033[c");
    int status = report_of(&t);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == true);
    CHECK(modes_are_as_found(&t));
    CHECK(strstr(t.seen.data, "2004") == NULL);
    end(&t);
    setting.term = "dumb";
    start(&t, &setting);
    CHECK_INT(report_of(&t), 0);
    CHECK_INT(t.seen.length, 0);
    end(&t);
}

STORY(a_dumb_terminal_gets_a_prompt_and_no_escapes)
{
    struct terminal t;
    struct setting setting = {.term = "dumb"};
    start(&t, &setting);
    SEE(&t, "ch2> ");
    type(&t, "echo plain\npicture\nquit\n");
    SEE(&t, "[plain]");
    CHECK_INT(report_of(&t), 0);
    CHECK(strchr(t.seen.data, '\033') == NULL);
    end(&t);
}

STORY(plain_input_is_read_line_by_line_without_escapes)
{
    int in[2], out[2];
    char seen[512] = "";
    size_t used = 0;
    if (pipe(in) != 0 || pipe(out) != 0)
        exit(1);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        struct repl_options options = {0};
        dup2(in[0], 0);
        dup2(out[1], 1);
        dup2(out[1], 2);
        close(in[1]);
        close(out[0]);
        exit(run_host(&options, false));
    }
    close(in[0]);
    close(out[1]);
    static const char text[] = "echo one\r\n\n  \nnonsense\npicture\necho two";
    CHECK(write(in[1], text, sizeof text - 1) == sizeof text - 1);
    close(in[1]);
    for (ssize_t n; (n = read(out[0], seen + used, sizeof seen - 1 - used)) > 0;)
        used += (size_t)n;
    int status;
    waitpid(child, &status, 0);
    CHECK(WIFEXITED(status));
    CHECK_INT(WEXITSTATUS(status), ERR_USAGE);
    CHECK_TEXT(seen, "[one]\nerror: there is no command nonsense\n[two]\n");
    close(out[0]);
}

int main(void)
{
    alarm(900);
    if (pipe2(news_pipe, O_NONBLOCK | O_CLOEXEC) != 0)
        return 1;
    return check_run();
}
