/* SPDX-License-Identifier: MIT */
/* Settings: commands that only set something. */
#include "base/choice.h"
#include "render/decoration.h"
#include "tests/folder_main.h"
#include "tests/interpreting.h"

/* A member that is neither is found. */
STORY(each_member_that_is_kept_is_a_setting_or_has_a_row)
{
    static struct kept plain, other;
    for (size_t i = 0; i < sizeof plain; i++) {
        memcpy(&other, &plain, sizeof other);
        ((char *)&other)[i] = 1;
        CHECK_WITH(!kept_equals(&plain, &other), "byte %zu of a state makes no difference", i);
    }
}

/* The members of a view that other commands set: `view`, `zoom`, `cross`, `window` and so on. */
static const struct {
    size_t at, bytes;
} other_members[] = {
#define MEMBER(name)                                                                               \
    {                                                                                              \
        offsetof(struct outlook, name), sizeof(((struct outlook *)NULL)->name)                     \
    }
    MEMBER(view.angle),        MEMBER(view.zoom),      MEMBER(view.focus),
    MEMBER(slices.cross),      MEMBER(slices.zoom),    MEMBER(slices.times),
    MEMBER(slices.has_middle), MEMBER(slices.middle),  MEMBER(slices.window_of),
    MEMBER(slices.window),     MEMBER(slices.channel),
};

/* No byte is padding, and none belongs to two members. */
STORY(each_member_of_an_outlook_is_a_setting_or_is_listed_here)
{
    enum { BYTES = offsetof(struct outlook, shows_finished) + sizeof(uint32_t) };
    unsigned members[sizeof(struct outlook)] = {0};
    for (const struct command *setting = setting_table; setting->name; setting++)
        for (const struct parameter *p = setting->parameter; p->type; p++)
            for (size_t i = 0; i < p->sets.bytes && p->sets.at >= sizeof(struct kept); i++)
                members[p->sets.at - offsetof(struct state, outlook) + i]++;
    for (size_t m = 0; m < sizeof other_members / sizeof *other_members; m++)
        for (size_t i = 0; i < other_members[m].bytes; i++)
            members[other_members[m].at + i]++;
    for (size_t i = 0; i < BYTES; i++)
        CHECK_WITH(members[i] == 1, "byte %zu of an outlook belongs to %u members", i, members[i]);
}

static uint64_t seed = 1;

static void add_value(struct buf *out, const struct parameter *p)
{
    const uint64_t random = check_random(&seed);
    unsigned choices = p->choices != NULL;
    for (const char *at = p->choices; at && *at; at++)
        choices += *at == '|';
    if (p->keyed)
        buf_printf(out, " %s=", p->name);
    else
        buf_add_char(out, ' ');
    if (p->choices) {
        const struct choice choice = choice_at(p->choices, (unsigned)(random % choices));
        buf_add(out, choice.word, choice.length);
    } else {
        const int64_t number = p->least + (int64_t)(random % (uint64_t)(p->most - p->least + 1));
        buf_printf(out, "%g", (double)number / (p->type == VALUE_DECIMAL ? 1000 : 1));
    }
}

/* Typing a setting as it is written restores it and nothing else, and undo is exact. */
BEGUN_STORY(a_setting_is_told_as_it_is_typed, begin_interpreter)
{
    OWNED(buf_release) struct buf line = {0}, told = {0}, again = {0};
    must(interp, "open synth:geom:20x20x20");
    for (unsigned i = 0; i < 400; i++) {
        const struct command *setting = setting_table;
        for (unsigned n = i; n > 0; n--)
            setting = setting[1].name ? setting + 1 : setting_table;
        const struct state before = interp->session->now;
        buf_clear(&line);
        buf_clear(&told);
        buf_clear(&again);
        buf_add_text(&line, setting->name);
        for (const struct parameter *p = setting->parameter; p->type; p++)
            add_value(&line, p);
        must(interp, buf_text(&line));
        setting_write(&told, setting, &interp->session->now);
        const struct state now = interp->session->now;
        setting_put(&interp->session->now, &setting->parameter->sets,
                    setting_get(&before, &setting->parameter->sets));
        must(interp, buf_text(&told));
        setting_write(&again, setting, &interp->session->now);
        CHECK_TEXT(buf_text(&again), buf_text(&told));
        CHECK(kept_equals(&now.kept, &interp->session->now.kept));
        CHECK(outlook_equals(&now.outlook, &interp->session->now.outlook));
    }
}

/* Set each setting in a journal: changes of the segmentation are undone and redone, and a replay
 * gives the same state. */
STORY(every_setting_is_undone_done_again_and_replayed)
{
    OWNED(interpreter_release) struct interpreter interp = {0}, again = {0};
    OWNED(replay_report_release) struct replay_report report = {0};
    OWNED(buf_release) struct buf line = {0};
    begin_interpreter(&interp);
    CHECK(interpreter_create_journal(&interp, file_in(folder, "j.iftty"), NULL) == OK);
    must(&interp, "open synth:geom:20x20x20");
    for (const struct command *setting = setting_table; setting->name; setting++) {
        bool has_changed = false;
        for (unsigned round = 0; round < 40 && !has_changed; round++) {
            const struct state before = interp.session->now;
            buf_clear(&line);
            buf_add_text(&line, setting->name);
            for (const struct parameter *p = setting->parameter; p->type; p++)
                add_value(&line, p);
            must(&interp, buf_text(&line));
            const struct state after = interp.session->now;
            has_changed = !kept_equals(&before.kept, &after.kept) ||
                          !outlook_equals(&before.outlook, &after.outlook);
            if (!has_changed || !(setting->flags & COMMAND_EDITS))
                continue;
            must(&interp, "undo");
            CHECK(kept_equals(&before.kept, &interp.session->now.kept));
            must(&interp, "redo");
            CHECK(kept_equals(&after.kept, &interp.session->now.kept));
        }
        CHECK_WITH(has_changed, "%s sets nothing that a state is compared by", setting->name);
    }
    const struct state now = interp.session->now;
    begin_interpreter(&again);
    CHECK(replay_file(&again, file_in(folder, "j.iftty"), 0, 0, NULL, NULL, &report, &fault) == OK);
    CHECK(kept_equals(&now.kept, &again.session->now.kept));
    CHECK(outlook_equals(&now.outlook, &again.session->now.outlook));
}

/* A session begins with the usual values, so that no optional part is written. */
BEGUN_STORY(a_session_begins_with_what_is_usual, begin_interpreter)
{
    OWNED(buf_release) struct buf told = {0};
    must(interp, "open synth:geom:20x20x20");
    for (const struct command *setting = setting_table; setting->name; setting++)
        for (const struct parameter *p = setting->parameter; p->type; p++) {
            CHECK_INT(setting_get(&interp->session->now, &p->sets), p->sets.usual);
            CHECK(p->sets.bytes == 1 || p->sets.bytes == 4);
            CHECK(p->choices || (p->sets.usual >= p->least && p->sets.usual <= p->most));
        }
    settings_write(&told, GROUP_LOOK, &interp->session->now);
    CHECK_TEXT(buf_text(&told), "shade surface, light -25 30, cue 30, edges off, samples 1, "
                                "background gradient, decorate none, context none");
}

BEGUN_STORY(parts_are_named_one_by_one_or_all_or_none, begin_interpreter)
{
    must(interp, "open synth:geom:20x20x20; decorate cross letters");
    CHECK_TEXT(buf_text(&reply.canonical), "decorate letters cross");
    must(interp, "decorate all");
    CHECK_INT(interp->session->now.outlook.decorations, DECORATE_ALL);
    CHECK_INT(execute(interp, "decorate none letters"), ERR_USAGE);
    CHECK_INT(execute(interp, "decorate letters none"), ERR_USAGE);
    MUST_FAIL(interp, "decorate leters", ERR_USAGE, "did you mean letters?");
    CHECK_INT(interp->session->now.outlook.decorations, DECORATE_ALL);
    must(interp, "decorate none");
    CHECK_INT(interp->session->now.outlook.decorations, 0);
}
