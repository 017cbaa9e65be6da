/* SPDX-License-Identifier: MIT */
/* The prompt in a real pseudo-terminal: a fake terminal answers questions or does not, keys are
 * typed, and a small shell stops and continues the program as job control does. */
#include "tests/job.h"
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
    struct job job;
    const char *da1, *name; /* answers; NULL for none */
    bool kitty;
    unsigned delay_ms; /* delay of the line: answers wait in `late` until `late_ns` */
    struct buf late;
    uint64_t late_ns;
    size_t answered; /* bytes of `seen` looked at for questions */
};
static struct terminal t;

struct setting {
    const char *term, *da1, *name, *no_color;
    bool kitty, once;
    unsigned delay_ms;
    struct repl_options options;
};

static void play(const void *context)
{
    const struct setting *setting = context;
    setenv("TERM", setting->term, 1);
    unsetenv("COLORTERM");
    unsetenv("NO_COLOR");
    if (setting->no_color)
        setenv("NO_COLOR", setting->no_color, 1);
    exit(run_host(&setting->options, setting->once));
}

static void type_bytes(const char *bytes, size_t length)
{
    CHECK(write(t.job.master, bytes, length) == (ssize_t)length);
}

static void type(const char *text)
{
    type_bytes(text, strlen(text));
}

static bool is_question(const char *at, const char *question)
{
    return strncmp(at, question, strlen(question)) == 0;
}

static void reply(const char *text)
{
    if (t.delay_ms == 0) {
        type(text);
        return;
    }
    if (t.late.length == 0)
        t.late_ns = clock_ns() + t.delay_ms * UINT64_C(1000000);
    buf_add_text(&t.late, text);
}

/* Answer the questions in the new output, as a terminal with these abilities does. */
static void answer(struct job *job)
{
    for (; t.answered < job->seen.length; t.answered++) {
        const char *at = job->seen.data + t.answered;
        if (is_question(at, "\033[c") && t.da1)
            reply(t.da1);
        else if (is_question(at, "\033[>q") && t.name)
            reply(t.name);
        else if (is_question(at, "\033_Gi=31,s=1,v=1,a=q") && t.kitty)
            reply("\033_Gi=31;OK\033\\");
        else if (*at == '\033' && job->seen.length - t.answered < 24 && !strchr(at, 'c'))
            break; /* perhaps cut short: look again when more is there */
    }
    if (t.late.length && clock_ns() >= t.late_ns) {
        type_bytes(t.late.data, t.late.length);
        buf_clear(&t.late);
    }
    job->is_late = t.late.length > 0;
}

static void start(const struct setting *setting)
{
    t = (struct terminal){.da1 = setting->da1,
                          .name = setting->name,
                          .kitty = setting->kitty,
                          .delay_ms = setting->delay_ms};
    job_start(&t.job, play, setting);
    t.job.answer = answer;
}

static void print_seen(size_t from)
{
    printf("#   saw \"");
    for (size_t i = from; i < t.job.seen.length && i < from + 600; i++) {
        unsigned char c = (unsigned char)t.job.seen.data[i];
        if (c < 32 || c > 126)
            printf("\\x%02x", c);
        else
            putchar(c);
    }
    printf("\"\n");
}

/* These texts come, one after the other. */
static void see_all(const char *const *text, int line)
{
    for (; *text; text++) {
        const size_t from = t.job.mark;
        if (!check_report(job_see(&t.job, *text, 60000), __FILE__, line, *text))
            print_seen(from);
    }
}

#define SEE(...)             see_all((const char *const[]){__VA_ARGS__, NULL}, __LINE__)
#define SEE_AFTER(keys, ...) (type(keys), SEE(__VA_ARGS__))

static void start_at_prompt(const struct setting *setting)
{
    start(setting);
    SEE("ch2> ");
}

static void end(void)
{
    job_end(&t.job);
    buf_release(&t.late);
}
#define JOB_STORY(told) STORY_WITHIN(told, (void)0, end())

static void quit(void)
{
    type("quit\r");
    CHECK_INT(job_report(&t.job), 0);
    end();
}
/* Define a story that leaves the program, or one that ends the job. */
#define QUIT_STORY(told) STORY_WITHIN(told, (void)0, quit())

/* The bytes that a shell would find typed, once every answer has come. */
static size_t left_to_read(void)
{
    job_see(&t.job, NULL, (int)t.delay_ms + 50);
    return job_left_to_read(&t.job);
}

static const struct setting xterm = {.term = "xterm", .da1 = "\033[?64;1;2;6;9c"};
static const struct setting vt340 = {
    .term = "xterm", .da1 = "\033[?63;1;2;4;6;9c", .name = "\033P>|XTerm(379)\033\\"};
static const struct setting kitty = {
    .term = "xterm-kitty", .da1 = "\033[?62c", .name = "\033P>|kitty(0.26.5)\033\\", .kitty = true};
static const struct setting silent = {.term = "xterm"};

/* ---- stories ---- */

JOB_STORY(a_line_is_edited_and_run_and_ctrl_d_restores_everything)
{
    uint64_t begin = clock_ns();
    start(&xterm);
    SEE("\033[?2004h", "ch2> ");
    printf("# start to prompt %.1f ms\n", (double)(clock_ns() - begin) / 1e6);
    CHECK(!job_has_modes_as_found(&t.job));
    SEE_AFTER("exho hell", "exho hell");
    SEE_AFTER("o\001\006\033[3~h\010c\005 \303\244\r",
              "hello \303\244\r\n"); /* exho -> echo, and an umlaut */
    SEE("[hello \303\244]\r\n", "ch2> ");
    type("\004");
    CHECK_INT(job_report(&t.job), 0);
    CHECK(job_has_modes_as_found(&t.job));
    SEE("\033[?2004l");
}

STORY(a_sixel_terminal_gets_sixels_and_each_is_waited_for)
{
    uint64_t took_least = UINT64_MAX;
    for (int i = 0; i < 5 && took_least > UINT64_C(1500000000); i++) { /* others may be busy */
        start_at_prompt(&vt340);
        SEE_AFTER("picture\r", "\r\n\n\033[2A\0337\033P0;1q\"1;1;64;40",
                  "\033\\\0338\033[2B\r\033[c", "ch2> ");
        const uint64_t begin = clock_ns();
        SEE_AFTER("picture\rquit\r", "\033P0;1q", "\033\\\0338\033[2B\r\033[c");
        CHECK_INT(job_report(&t.job), 0);
        CHECK(job_has_modes_as_found(&t.job));
        const uint64_t took = clock_ns() - begin;
        took_least = took < took_least ? took : took_least;
        const char *asked = strstr(t.job.seen.data + t.job.mark, "\033[c"); /* on leaving */
        CHECK(!asked || !strstr(asked + 1, "\033[c")); /* no question is asked twice */
        end();
    }
    CHECK(took_least < UINT64_C(1500000000)); /* no answer is waited for twice */
}

QUIT_STORY(kitty_gets_its_own_graphics_and_a_picture_that_nobody_confirms_is_recovered_from)
{
    start(&kitty);
    SEE("a=q", "\r\033[K", "ch2> ");
    t.da1 = NULL; /* the line has cut it */
    SEE_AFTER("picture\r", "\033_Ga=T,C=1,f=100,q=2,m=0;iVBOR", "ch2> ");
    SEE_AFTER("picture\r", "\033_Gm=0,q=2;\033\\\033_Gm=0,q=2;\033\\", "\033_Ga=T", "ch2> ");
}

JOB_STORY(a_terminal_without_graphics_gets_blocks)
{
    start_at_prompt(&xterm);
    SEE_AFTER("picture\rquit\r", "\033[48;5;");
    CHECK_INT(job_report(&t.job), 0);
    CHECK(!strstr(t.job.seen.data, "\033P") && !strstr(t.job.seen.data, "\033_G"));
}

JOB_STORY(without_colours_one_question_is_asked_and_nothing_coloured)
{
    struct setting setting = vt340;
    setting.no_color = "1";
    start_at_prompt(&setting);
    SEE_AFTER("nonsense\rpicture\rquit\r", "error: there is no command nonsense\r\n");
    CHECK_INT(job_report(&t.job), 0);
    CHECK(strstr(t.job.seen.data, "\033[>") == NULL &&
          strstr(t.job.seen.data, "\033[31m") == NULL &&
          strstr(t.job.seen.data, "\033[48") == NULL);
    CHECK_HAS(t.job.seen.data, "%%%");
}

JOB_STORY(a_silent_terminal_costs_two_seconds_and_no_key)
{
    start(&silent);
    SEE("\033[c");
    uint64_t begin = clock_ns();
    type("echo ea");
    SEE_AFTER("rly\r", "[early]");
    uint64_t took = (clock_ns() - begin) / 1000000;
    CHECK(took > 1500 && took < 20000); /* twice two seconds, more on a busy machine */
    type("\004");
    CHECK_INT(job_report(&t.job), 0);
}

STORY(answers_that_take_their_time_are_not_left_to_the_shell)
{
    static const char *const typed[] = {"picture\rquit\r", "picture\r\032"};
    for (int stops = 0; stops < 2; stops++) {
        struct setting setting = vt340;
        setting.delay_ms = 300;
        start_at_prompt(&setting);
        SEE_AFTER(typed[stops], "\033P0;1q");
        const int status = job_report(&t.job);
        CHECK((stops ? WIFSTOPPED(status) : status == 0) && job_has_modes_as_found(&t.job));
        CHECK_INT(left_to_read(), 0);
        end();
    }
}

JOB_STORY(an_answer_that_comes_after_two_seconds_is_neither_text_nor_harm)
{
    struct setting setting = vt340;
    setting.delay_ms = 2300;
    start_at_prompt(&setting);
    type("echo on");
    job_see(&t.job, NULL, 500);
    SEE_AFTER("ly\r", "[only]");
    type("quit\r");
    CHECK_INT(job_report(&t.job), 0);
    CHECK_INT(left_to_read(), 0);
}

JOB_STORY(a_late_answer_upgrades_the_session)
{
    struct setting setting = vt340;
    setting.delay_ms = 2300;
    start_at_prompt(&setting);
    SEE_AFTER("info", "\033[?2;4;0S", "info"); /* the next questions; the line is drawn again */
    t.delay_ms = 0;
    SEE_AFTER("\025picture\rquit\r", "\033P0;1q");
    CHECK_INT(job_report(&t.job), 0);
    CHECK_INT(left_to_read(), 0);
}

JOB_STORY(ctrl_l_asks_a_silent_terminal_again)
{
    start_at_prompt(&silent);
    t.da1 = vt340.da1;
    t.name = vt340.name;
    SEE_AFTER("\014", "\033[>q", "\033[c", "\033[H\033[2J", "ch2> ");
    SEE_AFTER("picture\rquit\r", "\033P0;1q");
    CHECK_INT(job_report(&t.job), 0);
    CHECK_INT(left_to_read(), 0);
}

QUIT_STORY(a_large_paste_is_one_redraw_and_its_lines_are_run)
{
    OWNED(buf_release) struct buf paste = {0};
    start_at_prompt(&xterm);
    buf_add_text(&paste, "\033[200~echo ");
    for (int i = 0; i < 3000; i++)
        buf_add_char(&paste, 'x');
    size_t before = t.job.seen.length;
    for (size_t at = 0; at < paste.length; at += 100) { /* in pieces, as a network would */
        type_bytes(paste.data + at, paste.length - at < 100 ? paste.length - at : 100);
        job_see(&t.job, NULL, 1);
    }
    SEE_AFTER("\033[201~", "xxx");
    job_see(&t.job, NULL, 300);
    CHECK(t.job.seen.length - before < 2400); /* a screenful, once */
    SEE_AFTER("\003\033[200~echo one\r\necho two\necho thr\033[201~ee\r", "[one]", "[two]",
              "[three]");
}

/* Return true if b after a lone Escape is read as b; not if the program had no time to read between
 * the two. */
static bool is_lone_escape(void)
{
    type("echo one two\033b");
    job_see(&t.job, NULL, 100);
    type("X\033");
    job_see(&t.job, NULL, 300); /* longer than the time-out */
    SEE_AFTER("b\r", "two]\r\n");
    const bool is_letter = strstr(buf_text(&t.job.seen), "[one Xbtwo]") != NULL;
    CHECK(is_letter || strstr(buf_text(&t.job.seen), "[one Xtwo]") != NULL);
    SEE("ch2> ");
    return is_letter;
}

QUIT_STORY(escape_alone_is_not_the_alt_key)
{
    bool is_letter = false;
    start_at_prompt(&xterm);
    for (int tries = 0; tries < 20 && check_failures == 0 && !is_letter; tries++)
        is_letter = is_lone_escape();
    CHECK(is_letter);
}

QUIT_STORY(news_stand_above_the_line_that_is_typed_however_long)
{
    struct winsize size = {.ws_row = 24, .ws_col = 20};
    start_at_prompt(&xterm);
    ioctl(t.job.slave, TIOCSWINSZ, &size);
    SEE_AFTER("echo 012345678901234567890123456789012345678z", "8z"); /* rows 0 to 2 */
    CHECK(write(news_pipe[1], "n", 1) == 1);
    SEE("\033[2A\r\033[J[news]\r\n"); /* on its own: nothing was typed */
    SEE("ch2> ");
    SEE_AFTER("y\r", "8zy]");
}

JOB_STORY(ctrl_z_gives_the_terminal_back_and_fg_draws_again)
{
    start_at_prompt(&xterm);
    SEE_AFTER("echo half", "echo half");
    type("\032");
    int status = job_report(&t.job);
    CHECK(WIFSTOPPED(status) && job_has_modes_as_found(&t.job));
    SEE("\033[?2004l");
    job_order(&t.job, 0);
    SEE("\033[?2004h", "ch2> echo half");
    CHECK(!job_has_modes_as_found(&t.job));
    SEE_AFTER(" and half\r", "[half and half]");
    SEE_AFTER("wait\r", "waiting");
    type("\032"); /* while a command runs it is a signal */
    status = job_report(&t.job);
    CHECK(WIFSTOPPED(status) && job_has_modes_as_found(&t.job));
    job_order(&t.job, 0);
    job_see(&t.job, "\033[?2004h", 1000);
    kill(t.job.process, SIGTERM);
    job_report(&t.job);
    CHECK(job_has_modes_as_found(&t.job));
}

/* Types `command`, sends `number` (0: none), and expects the job to end by itself, the terminal to
 * be restored and the farewell to begin with ESC \. */
static void check_end(const char *command, int number, bool by_signal)
{
    start_at_prompt(&vt340);
    type(command);
    if (strcmp(command, "wait\r") == 0)
        SEE("waiting");
    else if (number)
        SEE(command);
    if (number)
        kill(t.job.process, number);
    int status = job_report(&t.job);
    CHECK(status > 0);
    if (by_signal && number)
        CHECK(WIFSIGNALED(status) && WTERMSIG(status) == number);
    CHECK(job_has_modes_as_found(&t.job));
    const bool asks =
        number == SIGTERM || number == SIGINT; /* a line that is gone answers nothing */
    SEE(asks ? "\033\\\033[c\033[?2004l\033[m\033[?25h\r" : "\033\\\033[?2004l\033[m\033[?25h\r");
    end();
}

STORY(signals_crashes_and_exits_restore_the_terminal)
{
    check_end("half a li", SIGTERM, true);
    check_end("half a li", SIGHUP, true);
    check_end("wait\r", SIGTERM, true);
    check_end("wait\r", SIGINT, true);
    check_end("crash\r", 0, false);
    check_end("abort\r", 0, false);
    check_end("exit\r", 0, false);
}

JOB_STORY(one_picture_is_shown_without_a_prompt)
{
    struct setting setting = vt340;
    setting.once = true;
    start(&setting);
    SEE("\r\n\n\033[2A\0337\033P0;1q\"1;1;64;40", "\0338\033[2B\r\033[c");
    int status = job_report(&t.job);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == true && job_has_modes_as_found(&t.job));
    CHECK(strstr(t.job.seen.data, "2004") == NULL);
    end();
    setting.term = "dumb";
    start(&setting);
    CHECK_INT(job_report(&t.job), 0);
    CHECK_INT(t.job.seen.length, 0);
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
