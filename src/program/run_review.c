/* SPDX-License-Identifier: MIT */
/*
 * `iftty verify --review`: the pictures that differ, one by one, at the terminal.
 *
 *     study.iftty, record 7: golden first
 *     golden image first: 12 of 1200 pixels differ, ...; colours alone differ, ...
 *     +----------+----------+----------+
 *     | expected | actual   | differs  |     as the terminal can show it, or in blocks
 *     +----------+----------+----------+
 *     a accept   r reject   s skip   q quit
 *
 * What is accepted is written when the last question is answered; Ctrl-C leaves all as it was.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "program/begin.h"
#include "program/console.h"
#include "program/programs.h"
#include "tui/keys.h"
#include "tui/prompt/repl.h"
#include "tui/term.h"
#include "verify/reseal.h"

enum { GAP = 8, GAP_GREY = 96, LINE_MOST = 2000 };

struct review {
    const struct options *options;
    const char *journal;
    bool has_quit; /* all that follows is skipped */
};

/* ---- the picture ---- */

/* Side by side; NULL where there is no room, or nothing to be drawn. */
struct triptych {
    uint32_t width, height;
    uint8_t *rgba;
};

static void paste(struct triptych *to, uint32_t column, const uint8_t *rgba, uint32_t width,
                  uint32_t height)
{
    for (uint32_t y = 0; y < height; y++)
        memcpy(to->rgba + 4 * ((size_t)y * to->width + column), rgba + 4 * (size_t)y * width,
               4 * (size_t)width);
}

static bool draw_triptych(struct triptych *t, const struct golden_finding *finding)
{
    const struct picture *actual = finding->actual, *expected = finding->expected;
    const struct golden_difference *difference = finding->difference;
    const bool differs = difference && difference->image;
    const uint32_t first = expected ? expected->width + GAP : 0;
    const uint32_t width = first + actual->width + (differs ? GAP + difference->width : 0);
    const uint32_t height =
        expected && expected->height > actual->height ? expected->height : actual->height;
    size_t pixels, bytes;
    *t = (struct triptych){width, height, NULL};
    if (!size_multiply(width, height, &pixels) || !size_multiply(pixels, 4, &bytes) ||
        !(t->rgba = mem_array(bytes, 1)))
        return false;
    for (size_t i = 0; i < bytes; i++)
        t->rgba[i] = i % 4 == 3 ? 255 : GAP_GREY;
    if (expected)
        paste(t, 0, picture_colours(expected), expected->width, expected->height);
    paste(t, first, picture_colours(actual), actual->width, actual->height);
    if (differs)
        paste(t, first + actual->width + GAP, difference->image, difference->width,
              difference->height);
    return true;
}

/* What stands where, and the picture. */
static void show(const struct review *review, const struct golden_finding *finding)
{
    struct triptych t;
    const bool differs = finding->difference && finding->difference->image;
    printf("%s%s%s\n", finding->expected ? "expected | " : "there is no golden image | ", "actual",
           differs ? " | what differs, in red" : "");
    fflush(stdout);
    if (draw_triptych(&t, finding)) {
        const struct image_view view = {
            .width = t.width, .height = t.height, .rgba = t.rgba, .smooth = true};
        if (!show_picture_once(review->options->graphics, &view))
            puts("(this terminal shows no pictures; --out of iftty verify leaves them in files)");
    }
    free(t.rgba);
}

/* ---- keys ---- */

/* The next key that is one of `keys`; 0 for Ctrl-C, or where the terminal has gone. */
static char wait_for(const char *keys)
{
    struct keys decoder = {0};
    struct key_event event;
    struct buf bytes = {0};
    char found = '\0';
    bool is_over = false;
    while (!found && !is_over) {
        buf_clear(&bytes);
        const enum term_input input = term_read(&bytes, -1, -1);
        is_over = input == TERM_CLOSED || bytes.failed;
        for (size_t i = 0; i < bytes.length && !found && !is_over; i++) {
            if (!keys_feed(&decoder, (uint8_t)bytes.data[i], &event) || event.key != KEY_CHARACTER)
                continue;
            is_over = event.modifiers == KEY_CONTROL && (event.point == 'c' || event.point == 'd');
            if (!event.modifiers && event.point < 128 && event.point &&
                strchr(keys, (int)event.point))
                found = (char)event.point;
        }
    }
    buf_release(&bytes);
    return found;
}

/* One line, as the terminal itself edits it. Enter alone is the reason that was given last. */
static enum err ask_why(struct buf *why, struct fault *fault)
{
    char line[LINE_MOST];
    struct fault words;
    for (;;) {
        printf("Why is it right? %s%s%s", why->length ? "[" : "", buf_text(why),
               why->length ? "] " : "");
        fflush(stdout);
        if (!fgets(line, sizeof line, stdin))
            return fault_set(fault, ERR_CANCELLED, "cancelled; nothing has changed");
        line[strcspn(line, "\n")] = '\0';
        if (!*line && why->length)
            return OK;
        if (!reseal_check_reason(line, &words))
            break;
        puts("A reason is one line of text, without control characters.");
    }
    buf_clear(why);
    buf_add_text(why, line);
    return why->failed ? fault_memory(fault, "a reason") : OK;
}

static enum err ask(void *context, const struct review_question *question, struct buf *why,
                    enum review_answer *answer, struct fault *fault)
{
    struct review *review = context;
    const char *given = review->options->accept;
    char key = 'q';
    enum err err = OK;
    if (!review->has_quit) {
        struct buf text = {0};
        buf_add_char(&text, '\n');
        buf_add_safe_text(&text, review->journal);
        buf_printf(&text, ", record %zu: ", question->record);
        buf_add_safe_text(&text, question->command);
        buf_add_char(&text, '\n');
        buf_add_safe_text(&text, question->wrong);
        buf_add_char(&text, '\n');
        console_print(NULL, buf_text(&text));
        buf_release(&text);
        if (question->finding)
            show(review, question->finding);
        puts("a accept   r reject   s skip   q quit");
        fflush(stdout);
        err = term_open(STDIN_FILENO, STDOUT_FILENO, fault);
        if (!err) {
            term_set_sequences("", "");
            err = term_set_mode(TERM_RAW, fault);
        }
        if (!err)
            key = wait_for("arsq");
        term_close();
        if (!err && !key)
            err = fault_set(fault, ERR_CANCELLED, "cancelled; nothing has changed");
    }
    review->has_quit = key == 'q';
    *answer = key == 'a' ? REVIEW_ACCEPT : key == 'r' ? REVIEW_REJECT : REVIEW_SKIP;
    if (err || key != 'a')
        return err;
    if (!given)
        return ask_why(why, fault);
    buf_clear(why);
    buf_add_text(why, given);
    return OK;
}

/* ---- the program ---- */

enum err run_review(const struct options *o, struct fault *fault)
{
    struct review review = {.options = o};
    const struct reviewer reviewer = {&review, ask};
    enum err worst = OK, err = OK;
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO))
        return fault_set(fault, ERR_USAGE,
                         "--review asks a person at a terminal; --accept WHY takes in all pictures "
                         "of a journal");
    if (o->accept && reseal_check_reason(o->accept, fault))
        return fault_prefix(fault, ERR_USAGE, "--accept");
    console_handle_interrupts();
    for (int i = 0; i < o->words && (!err || err == ERR_CHECK); i++) {
        struct fault words = {0};
        struct interpreter interp;
        review.journal = o->word[i];
        err = begin_interpreter(&interp, o, &words);
        if (!err)
            err = reseal_review(&interp, review.journal, &reviewer, &console_printer, &words);
        interpreter_release(&interp);
        if (!err)
            continue;
        worst = err;
        *fault = words;
        if (i + 1 < o->words)
            fprintf(stderr, "iftty: %s\n", words.text);
    }
    return worst;
}
