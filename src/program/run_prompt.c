/* SPDX-License-Identifier: MIT */
/* `iftty` at a terminal or in a pipe: the prompt, and the pilot. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/choice.h"
#include "base/mem.h"
#include "command/command.h"
#include "command/execute.h"
#include "image/picture_writer.h"
#include "journal/journal.h"
#include "program/programs.h"
#include "session/setting.h"
#include "tui/pilot/pilot.h"
#include "tui/pilot/pilot_keys.h"
#include "tui/prompt/repl.h"

/*
 * Completion by a part of a word: commands and choices, each with the key of the pilot that does
 * the same, and keys without a command.
 *
 * A command is found by a part of its name, as `file` finds seed-file, of a choice, as `cont` finds
 * `overlay contour`, of a key, or of its summary.
 */

enum { COMMANDS_FOUND_MOST = 8 };

/* Places of the part, the best first. */
enum { OF_NAME, OF_CHOICE, OF_KEY, OF_SUMMARY, WITHIN_NAME, RANKS };

/* True if a word of the text, from the byte `from` on, begins with the part. */
static bool has_word(const char *text, const char *piece, size_t from)
{
    for (const char *at = text; (at = strcasestr(at, piece)); at++)
        if (at >= text + from && (at == text || strchr(" -(`/", at[-1])))
            return true;
    return false;
}

static void add_candidate(struct buf *out, const char *name, const struct choice *choice,
                          const char *key, const char *note, size_t length)
{
    buf_add_text(out, name);
    if (choice) {
        buf_add_char(out, ' ');
        buf_add(out, choice->word, choice->length);
    }
    buf_add_char(out, '\t');
    buf_printf(out, "%s%s", key, *key ? "=: " : "");
    buf_add(out, note, length);
    buf_add_char(out, '\n');
}

/* Choices of the first parameter; short words such as on and none are not specific. */
static void find_choices(struct buf *out, const struct command *command, const char *piece,
                         unsigned *count)
{
    const struct parameter *p = command->parameter;
    const char *choices = p->type && !p->keyed && p->choices ? p->choices : "";
    struct choice choice;
    while (choice_next(&choice, &choices)) {
        const struct choice found = command_note(command, choice.word, choice.length);
        const char *note = found.length ? found.word : command->summary;
        if (choice.length < strlen(piece) || choice.length < 4 ||
            strncasecmp(choice.word, piece, strlen(piece)) != 0 || *count == COMMANDS_FOUND_MOST)
            continue;
        add_candidate(out, command->name, &choice, "", note,
                      found.length ? found.length : strlen(note));
        ++*count;
    }
}

static bool is_of_key(const struct command *command, const char *piece, const char **key)
{
    for (const struct parameter *p = command->parameter; p->type; p++)
        if (p->keyed && strncasecmp(p->name, piece, strlen(piece)) == 0) {
            *key = p->name;
            return true;
        }
    return false;
}

static unsigned rank_of(const struct command *command, const char *piece, const char **key)
{
    *key = "";
    return has_word(command->name, piece, 1)      ? OF_NAME
           : is_of_key(command, piece, key)       ? OF_KEY
           : has_word(command->summary, piece, 0) ? OF_SUMMARY
           : strcasestr(command->name, piece)     ? WITHIN_NAME
                                                  : RANKS;
}

/* Add commands, the best first, in the form of command_complete: the text to type, a tab, its
 * meaning, and a line feed. Not commands whose names begin with the part; with `are_some` only
 * those found by name or choice. */
static void command_find_by_piece(struct buf *out, const char *piece, bool are_some)
{
    unsigned count = 0;
    for (unsigned rank = OF_NAME; rank < (are_some ? OF_KEY : RANKS); rank++)
        for (unsigned i = 0; i < command_count() && count < COMMANDS_FOUND_MOST; i++) {
            const struct command *command = command_at(i);
            const char *key;
            if (rank == OF_CHOICE)
                find_choices(out, command, piece, &count);
            else if (strncasecmp(command->name, piece, strlen(piece)) != 0 &&
                     rank_of(command, piece, &key) == rank) {
                const struct choice note =
                    *key ? command_note(command, key, strlen(key)) : (struct choice){0};
                const char *words = note.length ? note.word : command->summary;
                add_candidate(out, command->name, NULL, key, words,
                              note.length ? note.length : strlen(words));
                count++;
            }
        }
}

enum { KEYS_MOST = 6 };

/* The row with the same action as a command: by its line, or by its name. NULL: none. */
static const struct pilot_row *row_of(const char *words, size_t length)
{
    const size_t name = strcspn(words, " \t\n");
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++)
        if (row->command && strncmp(row->command, words, length) == 0 &&
            row->command[length] == '\n')
            return row;
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++)
        if (row->name && strncmp(row->name, words, name) == 0 && row->name[name] == '\0')
            return row;
    return NULL;
}

/* Add keys without a command as notes, which cannot be selected; keys in the list are left out. */
static void add_keys(struct buf *out, const char *piece, const struct pilot_setup *setup,
                     const bool *is_there)
{
    unsigned count = 0;
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        const char *help = row->help && *row->help ? row->help : row->hint ? row->hint : "";
        if (!row->name || is_there[row - pilot_table] ||
            !(strcasestr(row->name, piece) || strcasestr(help, piece)) || count++ == KEYS_MOST)
            continue;
        buf_add_char(out, '\t');
        setup_add_keys(out, setup, row, 1);
        buf_printf(out, "\tin the pilot, %s%s%s\n", row->name, *help ? ": " : "", help);
    }
}

/* Add candidates of the line editor to the words that begin with the part, and add keys to all of
 * them. */
static void finding_add(struct buf *words, const char *piece, const struct pilot_setup *setup)
{
    const bool are_some = words->length > 0;
    bool is_there[SETUP_ROWS_MOST] = {false};
    struct buf all = {0};
    command_find_by_piece(words, piece, are_some);
    for (const char *at = buf_text(words); *at;) {
        const size_t line = strcspn(at, "\n"), word = strcspn(at, "\t\n");
        const struct pilot_row *row = row_of(at, word);
        buf_add(&all, at, word);
        buf_add_char(&all, '\t');
        if (row) {
            is_there[row - pilot_table] = true;
            setup_add_keys(&all, setup, row, 1);
            buf_add_text(&all, word < line ? " in the pilot: " : "");
        }
        buf_add(&all, at + word + (word < line), line - word - (word < line));
        buf_add_char(&all, '\n');
        at += line + (at[line] == '\n');
    }
    if (!are_some)
        add_keys(&all, piece, setup, is_there);
    all.failed |= words->failed;
    buf_release(words);
    *words = all;
}

struct prompt {
    struct pilot_interpreter pilot; /* first member: the context of the pilot's host */
    struct pilot_host host;
    struct pilot_state state; /* the pilot's, kept between its uses */
    struct config config;
    bool has_started; /* the commands of config.start are done, or not wanted */
    bool is_empty;    /* no command so far: `auto on` comes before the first one */
    struct interpreter interp;
    struct reply reply;
    char name[24];     /* before the "> " */
    const char *first; /* opened after the prompt is shown, */
    char *const *channel;
    int channels; /* and its channels */
    bool resumes;
    struct lesson *lesson;  /* or NULL */
    enum proposal proposed; /* by the last answer */
};

/* ---- the host of prompt and pilot ---- */

static void prompt_text(void *context, struct buf *out)
{
    const struct prompt *prompt = context;
    buf_add_safe_text(out, prompt->name);
    buf_add_text(out, "> ");
}

static enum err execute_line(struct prompt *prompt, const char *line, struct buf *output,
                             struct fault *fault)
{
    console_forget_interrupt();
    enum err err = interpreter_execute(&prompt->interp, line, &prompt->reply, fault);
    console_erase_progress();
    buf_add_text(output, buf_text(err ? &prompt->reply.list : &prompt->reply.text));
    return err;
}

/* Carry out the start commands once there is a scene, and name one that fails. The default ones
 * have no line number; only the answer of the last of them is shown. */
static void carry_out_start(struct prompt *prompt, struct buf *output)
{
    const size_t before = output->length;
    struct fault fault;
    if (prompt->has_started || !prompt->interp.session->has_scene)
        return;
    prompt->has_started = true;
    for (const char *at = buf_text(&prompt->config.start); *at;) {
        OWNED(buf_release) struct buf line = {0};
        char *command;
        const size_t n = strcspn(at, "\n");
        buf_add(&line, at, n);
        const unsigned long number = strtoul(buf_text(&line), &command, 10);
        if (!number)
            output->length = before;
        const bool fails = execute_line(prompt, command, output, &fault);
        if (fails && number) {
            buf_add_safe_text(output, buf_text(&prompt->config.path));
            buf_printf(output, ":%lu: ", number);
        }
        if (fails)
            buf_printf(output, "%s\n", fault.text);
        at += n + (at[n] == '\n');
    }
}

static enum err prompt_execute(void *context, const char *line, struct buf *output,
                               struct fault *fault)
{
    struct prompt *prompt = context;
    enum err err = OK;
    if (prompt->is_empty && !interpreter_is_comment(line)) { /* without a command no journal */
        const size_t before = output->length;
        err = execute_line(prompt, "auto on", output, fault);
        output->length = before;
        prompt->is_empty = false;
    }
    if (!err)
        err = execute_line(prompt, line, output, fault);
    if (!err)
        carry_out_start(prompt, output);
    return err;
}

static const char *journal_name(const struct prompt *prompt)
{
    const struct journal *journal = prompt->interp.journal;
    return journal ? journal_path(journal) : prompt->interp.new_journal;
}

/* The colour of keys in the lesson. */
static const char *key_colour(const struct prompt *prompt)
{
    const struct terminal_facts *facts = prompt->interp.terminal;
    return facts && facts->colours != COLOURS_NONE
               ? theme_for(prompt->config.setup.theme, facts->is_light)->key
               : "";
}

/* Add the current step of the lesson below an answer. */
static void add_lesson(void *context, struct buf *output)
{
    struct prompt *prompt = context;
    if (!prompt->lesson || !prompt->interp.session->has_scene)
        return;
    lesson_look(prompt->lesson, prompt->interp.session, true);
    console_erase_progress();
    buf_add_char(output, '\n');
    lesson_add_page(output, prompt->lesson, journal_name(prompt), key_colour(prompt));
}

/* Propose the next step of a new session below the answer that leads to it. */
static void add_proposal(struct prompt *prompt, struct buf *output)
{
    const struct session *session = prompt->interp.session;
    const struct markers *markers = &session->markers;
    const enum proposal proposal =
        session->has_scene ? session_find_proposal(session) : PROPOSE_NOTHING;
    if (proposal == PROPOSE_SPHERE && proposal != prompt->proposed) {
        const struct marker *last = markers->marker + markers->count - 1;
        const struct place middle =
            grid_place(&session->scene->grid, markers->cover[last->first + last->voxels / 2].cell);
        buf_printf(output,
                   "next: enclose the object by a sphere of background through a voxel beyond its "
                   "edge,\n`seed %u,%u,%u 0 shell=yes through=X,Y,Z`; it labels all of the scene "
                   "so far\n",
                   middle.x, middle.y, middle.z);
    } else if (proposal == PROPOSE_OUTLINE && proposal != prompt->proposed) {
        buf_add_text(output, "next: `outline` the object in a slice where it is wrong (`hints "
                             "slice` lists slices), or correct it by balls\n");
    }
    prompt->proposed = proposal;
}

/* Return true for a key of the pilot, alone or after a count: "3L", "s0". */
static bool is_pilot_key(const struct pilot_setup *setup, const char *word)
{
    word += strspn(word, "0123456789");
    const size_t length = strlen(word);
    const struct pilot_state state = {.setup = setup,
                                      .leader = length == 2 ? (unsigned char)*word : 0};
    const struct key_event event = {.key = KEY_CHARACTER,
                                    .point = (unsigned char)word[length == 2]};
    return (length == 1 || length == 2) && pilot_row_of(&state, &event);
}

static enum err repl_execute(void *context, const char *line, struct buf *output,
                             struct fault *fault)
{
    struct prompt *prompt = context;
    const enum err err = prompt_execute(context, line, output, fault);
    if (err == ERR_USAGE && strstr(fault->text, "; `help all` lists them") &&
        is_pilot_key(&prompt->config.setup, line)) {
        const size_t at = fault->at;
        fault_set(fault, err, "%s is a key of the pilot (Ctrl-O)", line);
        fault->at = at;
    }
    if (!err) { /* a recorded command does not fail by it */
        interpreter_write_losses(&prompt->interp, console_watch(), output, NULL);
        console_erase_progress();
    }
    if (!err && prompt->interp.wish == WISH_NONE && prompt->lesson)
        add_lesson(context, output);
    else if (!err)
        add_proposal(prompt, output);
    return err;
}

static void pilot_caption(void *context, struct buf *lines)
{
    struct prompt *prompt = context;
    if (!prompt->pilot.onlooker) /* otherwise labels are about to change */
        lesson_look(prompt->lesson, prompt->interp.session, false);
    lesson_add_captions(lines, prompt->lesson, journal_name(prompt), key_colour(prompt));
}

static enum err prompt_sketch(void *context, const char *line, struct fault *fault)
{
    struct prompt *prompt = context;
    console_forget_interrupt();
    const enum err err = interpreter_sketch(&prompt->interp, line, fault);
    console_erase_progress();
    return err;
}

static enum err prompt_drop(void *context, struct fault *fault)
{
    struct prompt *prompt = context;
    return interpreter_drop_sketch(&prompt->interp, fault);
}

/* Open the scene or journal of the command line, and begin a new session. */
static enum err begin_session(void *context, struct buf *output, struct fault *fault)
{
    struct prompt *prompt = context;
    OWNED(buf_release) struct buf line = {0};
    buf_add_text(output, buf_text(&prompt->config.words));
    if (prompt->resumes) {
        const enum err err =
            interpreter_resume_journal(&prompt->interp, prompt->first, output, fault);
        console_erase_progress();
        if (!err)
            buf_printf(output, "%zu record%s resumed\n", journal_count(prompt->interp.journal),
                       plural(journal_count(prompt->interp.journal)));
        if (err == ERR_CANCELLED)
            fault_set(fault, err, "cannot resume %s: cancelled; it is as it was", prompt->first);
        return err;
    }
    prompt->is_empty = !prompt->first;
    prompt->interp.has_channels = prompt->channels > 0;
    if (prompt->first) {
        for (int i = 0; i <= prompt->channels; i++) {
            begin_opening(&line, i ? prompt->channel[i - 1] : prompt->first, i > 0);
            TRY(execute_line(prompt, buf_text(&line), output, fault));
        }
        TRY(execute_line(prompt, "auto on", output, fault));
    }
    carry_out_start(prompt, output);
    if (prompt->interp.has_pilot)
        buf_add_text(output, "Ctrl-O: the pilot, to segment by keys; `help`: how to segment\n");
    return OK;
}

static enum err prompt_begin(void *context, struct buf *output, struct fault *fault)
{
    struct prompt *prompt = context;
    TRY(begin_session(context, output, fault));
    if (prompt->lesson)
        TRY(lesson_begin(prompt->lesson, &prompt->interp, fault));
    if (prompt->lesson) {
        buf_clear(output);
        buf_add_text(output, buf_text(&prompt->config.words));
        lesson_add_beginning(output);
        add_lesson(prompt, output);
    }
    return OK;
}

static void prompt_find(void *context, const char *piece, struct buf *candidates)
{
    const struct prompt *prompt = context;
    finding_add(candidates, piece, &prompt->config.setup);
}

static void prompt_hint(void *context, const char *line, size_t length, struct buf *out)
{
    (void)context;
    command_hint(out, line, length);
}

static bool prompt_knows(void *context, const char *line)
{
    const struct prompt *prompt = context;
    OWNED(call_release) struct call call = {0};
    struct fault why;
    return command_parse(&call, line, prompt->interp.session, &why) == OK;
}

static bool prompt_picture(void *context, struct image_view *out)
{
    struct prompt *prompt = context;
    const bool shows = prompt->interp.shows_picture;
    prompt->interp.shows_picture = false;
    if (shows)
        *out = shown_picture(&prompt->interp, prompt->pilot.smooth);
    return shows;
}

static bool prompt_wants_screen(void *context)
{
    struct prompt *prompt = context;
    const bool wants = prompt->interp.wish == WISH_PILOT;
    if (wants)
        prompt->interp.wish = WISH_NONE;
    return wants;
}

static enum err prompt_screen(void *context, struct terminal_facts *facts,
                              struct line_editor *editor, bool *ended, struct fault *fault)
{
    struct prompt *prompt = context;
    if (prompt->interp.session->has_scene) {
        const uint32_t *n = prompt->interp.session->scene->grid.size;
        const uint32_t least = n[0] < n[1] ? n[0] : n[1];
        pilot_fit_brush(&prompt->state, least < n[2] ? least : n[2]);
    }
    const enum err err = pilot_run(&prompt->host, &prompt->state, facts, editor, ended, fault);
    prompt_wants_screen(prompt); /* `:pilot` within the pilot has no effect */
    return err;
}

static void add_terminal(const void *terminal, struct buf *out)
{
    graphics_describe(terminal, out);
}

static void prompt_terminal(void *context, const struct terminal_facts *facts)
{
    struct prompt *prompt = context;
    prompt->interp.terminal = facts;
    prompt->interp.add_terminal = add_terminal;
}

static void prompt_news(void *context, struct buf *output)
{
    struct prompt *prompt = context;
    picture_writer_news(prompt->interp.writer, output);
}

static enum err run_repl(struct prompt *prompt, const struct options *o, struct fault *fault)
{
    struct picture_writer *writer = prompt->interp.writer;
    const struct repl_host host = {.context = prompt,
                                   .wants_screen = prompt_wants_screen,
                                   .screen = prompt_screen,
                                   .screen_line = "pilot",
                                   .after_screen = add_lesson,
                                   .begin = prompt_begin,
                                   .terminal = prompt_terminal,
                                   .prompt = prompt_text,
                                   .execute = repl_execute,
                                   .complete = pilot_host_complete,
                                   .find = prompt_find,
                                   .hint = prompt_hint,
                                   .knows = prompt_knows,
                                   .picture = prompt_picture,
                                   .news = writer ? prompt_news : NULL,
                                   .news_descriptor =
                                       writer ? picture_writer_descriptor(writer) : -1,
                                   .finished = prompt->host.finished};
    OWNED(buf_release) struct buf history = {0};
    const bool has_history = !prompt->lesson && line_history_path(&history);
    const struct repl_options how = {.graphics =
                                         o->graphics.count ? o->graphics : prompt->config.graphics,
                                     .history_path = has_history ? buf_text(&history) : NULL,
                                     .pages = !prompt->config.plain_answers,
                                     .pager = getenv("PAGER"),
                                     .theme = prompt->config.setup.theme};
    const enum err err = repl_run(&host, &how, fault);
    prompt->interp.add_terminal = NULL;
    return err;
}

/* ---- beginning and end ---- */

/* A failure is reported by the next edit. */
static void before_suspending(void *context)
{
    struct prompt *prompt = context;
    if (prompt->interp.journal)
        journal_catch_up(prompt->interp.journal, NULL);
}

/* Wait until pictures are written; Ctrl-C drops pictures that are not begun. */
static void finish_pictures(struct prompt *prompt)
{
    OWNED(buf_release) struct buf text = {0};
    console_forget_interrupt();
    watch_begin(console_watch());
    picture_writer_wait(prompt->interp.writer, console_watch());
    console_erase_progress();
    picture_writer_news(prompt->interp.writer, &text);
    fputs(buf_text(&text), stdout);
}

/* Print the path of the journal. */
static void print_journal(const struct journal *journal)
{
    OWNED(buf_release) struct buf text = {0};
    buf_add_safe_text(&text, journal_path(journal));
    printf("journal: %s (%zu record%s%s)\n", buf_text(&text), journal_count(journal),
           plural(journal_count(journal)), journal_only_looks(journal) ? ", not written to" : "");
}

/* Set up the lesson, independent of the user's configuration. */
static void take_lesson(struct prompt *prompt, struct lesson *lesson)
{
    prompt->lesson = lesson;
    prompt->config.setup.brush = pilot_setup_default.brush;
    buf_clear(&prompt->config.start);
    buf_add_text(&prompt->config.start, CONFIG_USUAL_START);
    prompt->host.caption = pilot_caption;
    prompt->host.keeps_status = true;
}

enum err prompt_run(const struct options *o, struct lesson *lesson, struct fault *fault)
{
    static struct prompt prompt; /* too large for the stack */
    OWNED(buf_release) struct buf journal = {0};
    const bool is_terminal = isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
    TRY(begin_check(o, &prompt.first, &prompt.resumes, fault));
    prompt.channel = o->word + 1;
    prompt.channels = o->words > 1 ? o->words - 1 : 0;
    if (lesson && prompt.first && !prompt.resumes)
        return fault_set(fault, ERR_USAGE,
                         "%s is not a journal of a lesson; `iftty tutorial` begins one",
                         prompt.first);
    if (lesson && !prompt.resumes)
        prompt.first = LESSON_SCENE;
    /* "ch2" for /data/ch2.nii.gz */
    const char *name = prompt.first ? file_name(prompt.first) : "session";
    const size_t n = strcspn(name, ".:");
    snprintf(prompt.name, sizeof prompt.name, "%.20s", name);
    if (n && n < 20)
        prompt.name[n] = '\0';
    begin_journal_name(&journal, lesson ? "tutorial" : prompt.first);
    if (isatty(STDIN_FILENO)) /* otherwise Ctrl-C ends the program */
        console_handle_interrupts();
    prompt.config.setup = pilot_setup_default;
    if (is_terminal)
        config_read(&prompt.config);
    struct options own = *o;
    if (!o->who && prompt.config.who.length) {
        own.who = buf_text(&prompt.config.who);
        own.times |= prompt.config.times;
    }
    enum err err = begin_by_options(&prompt.interp, &own, fault);
    begin_to_wait(&prompt.interp);
    if (!o->journal && !prompt.resumes)
        prompt.interp.new_journal = buf_text(&journal);
    /* On error pictures are written before the next prompt. */
    if (!err && is_terminal)
        picture_writer_new(&prompt.interp.writer, NULL);
    prompt.host = (struct pilot_host){.context = &prompt,
                                      .execute = prompt_execute,
                                      .sketch = prompt_sketch,
                                      .drop = prompt_drop};
    pilot_host_fill(&prompt.host);
    if (lesson)
        take_lesson(&prompt, lesson);
    if (!theme_for(prompt.config.setup.theme, false)->has_colours)
        setenv("NO_COLOR", "1", 1); /* for this program and its helpers */
    prompt.has_started = prompt.resumes;
    pilot_state_init(&prompt.state, &prompt.config.setup);
    prompt.pilot.interp = &prompt.interp;
    prompt.pilot.smooth = o->smooth;
    prompt.interp.has_pilot = is_terminal;
    prompt.interp.add_keys = line_keys_page;
    term_on_suspend(before_suspending, &prompt);
    if (!err)
        err = run_repl(&prompt, o, fault);
    if (prompt.interp.writer)
        finish_pictures(&prompt);
    err = end_journal(&prompt.interp, err, fault);
    if (prompt.interp.journal && isatty(STDOUT_FILENO))
        print_journal(prompt.interp.journal);
    reply_release(&prompt.reply);
    config_release(&prompt.config);
    panes_release(&prompt.pilot.panes);
    pilot_state_release(&prompt.state);
    interpreter_release(&prompt.interp);
    return err;
}

enum err run_prompt(const struct options *o, struct fault *fault)
{
    return prompt_run(o, NULL, fault);
}
