/* The settings: all commands that do no more than set something (session/setting.h). */
#include "command/act.h"

#include <stdlib.h>

#include "render/background.h"

/* Black in look 1 is what it has always been. */
static int64_t background_of(const struct value *value, const struct outlook *outlook)
{
    static const uint32_t named[] = {BACKGROUND_PLAIN, BACKGROUND_WHITE, BACKGROUND_GRADIENT,
                                     BACKGROUND_CLEAR};
    const uint32_t background =
        value->text ? named[value->number] : BACKGROUND_PLAIN | (uint32_t)value->number;
    const bool is_fade = background == BACKGROUND_PLAIN && outlook->look.number == LOOK_FIRST;
    return is_fade ? BACKGROUND_FADE : background;
}

/* A value as the member holds it. */
static int64_t held(const struct setting_member *member, const struct value *value,
                    const struct outlook *outlook)
{
    switch (member->as) {
    case HELD_AS_SWITCH:
        return value->number == 0;
    case HELD_AS_COUNT:
        return strtol(value->text, NULL, 10);
    case HELD_AS_BACKGROUND:
        return background_of(value, outlook);
    default:
        return value->number;
    }
}

/* What one may not expect of a member that was set. */
static void say(const struct act *act, size_t member)
{
    struct buf *out = &act->reply->text;
    const struct outlook *outlook = session_outlook(act->session);
    const size_t waits = session_pendings(act->session);
    if (member == offsetof(struct state, outlook.runs_by_itself)) {
        if (outlook->runs_by_itself && waits)
            buf_printf(out, "%zu edit%s waiting for `run` or the next edit\n", waits,
                       plural(waits));
        return;
    }
    if (member != offsetof(struct state, outlook.shows_finished))
        return;
    if (!outlook->shows_finished)
        buf_add_text(out, "pictures show the labels of the forest\n");
    else if (!session_kept(act->session)->finish.count)
        buf_add_text(out, "the finish has no step yet; `finish relax` adds one, and pictures show "
                          "it\n");
    else
        act_write_finish(out, act->session);
}

enum err act_set(const struct act *act)
{
    const struct parameter *parameter = act->command->parameter;
    unsigned given = 0, made = 0;
    for (int i = 0; parameter[i].type; i++) {
        const struct setting_member *member = &parameter[i].sets;
        const struct value *value = &act->value[i];
        given += value->given;
        made |= member->made;
        if (value->given)
            setting_put(act->next, member, held(member, value, &act->next->outlook));
        else if (!member->stays)
            setting_put(act->next, member, member->usual);
    }
    if (!given)
        return fault_set(act->fault, ERR_USAGE, "expected what to change, as in `%s`",
                         act->command->example);
    const enum err err = act_go(act);
    if (!err && made & MADE_WEIGHTS)
        act_add_weights(act);
    if (!err && act->command->group == GROUP_SLICES)
        act_write_slices(&act->reply->text, act->session);
    if (!err)
        say(act, parameter->sets.at);
    return err;
}
