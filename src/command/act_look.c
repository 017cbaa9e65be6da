/* Commands that change how surfaces are coloured. */
#include "command/act.h"

#include "render/decoration.h"

enum err act_shade(const struct act *act)
{
    act->next->outlook.look.mode = (enum shade_mode)act->value[0].number;
    act->next->outlook.look.ao_percent = (uint32_t)act->value[1].number;
    act->next->outlook.look.creases = act_is_yes(&act->value[2]);
    return act_go(act);
}

enum err act_light(const struct act *act)
{
    for (int i = 0; i < 2; i++)
        act->next->outlook.look.light[i] = (int32_t)act->value[i].number;
    return act_go(act);
}

enum err act_cue(const struct act *act)
{
    act->next->outlook.look.cue_percent = (uint32_t)act->value[0].number;
    return act_go(act);
}

enum err act_edges(const struct act *act)
{
    act->next->outlook.look.edges = act->value[0].number == 0;
    return act_go(act);
}

enum err act_samples(const struct act *act)
{
    act->next->outlook.look.samples = 1u << act->value[0].number;
    return act_go(act);
}

enum err act_context(const struct act *act)
{
    act->next->outlook.context = (uint32_t)act->value[0].number;
    return act_go(act);
}

/* Black in look 1 is what it has always been. */
enum err act_background(const struct act *act)
{
    struct outlook *outlook = &act->next->outlook;
    static const uint32_t named[] = {BACKGROUND_PLAIN, BACKGROUND_WHITE, BACKGROUND_GRADIENT,
                                     BACKGROUND_CLEAR};
    const struct value *value = &act->value[0];
    outlook->background =
        value->text ? named[value->number] : BACKGROUND_PLAIN | (uint32_t)value->number;
    if (outlook->background == BACKGROUND_PLAIN && outlook->look.number == LOOK_FIRST)
        outlook->background = BACKGROUND_FADE;
    return act_go(act);
}

/* The parts that are named, after which stand `all` and `none`. */
enum err act_decorate(const struct act *act)
{
    enum { PARTS = 5, ALL = PARTS, NONE };
    uint32_t parts = 0, named = 0;
    bool is_none = false;
    for (int i = 0; i < PARTS; i++) {
        const struct value *value = &act->value[i];
        named += value->given;
        is_none |= value->given && value->number == NONE;
        if (value->given && value->number != NONE)
            parts |= value->number == ALL ? (uint32_t)DECORATE_ALL : 1u << value->number;
    }
    if (is_none && named > 1)
        return fault_set(act->fault, ERR_USAGE,
                         "expected `decorate none` alone; nothing has changed");
    act->next->outlook.decorations = parts;
    return act_go(act);
}
