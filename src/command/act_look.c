/* Commands that change how surfaces are coloured. */
#include "command/act.h"

enum err act_shade(const struct act *act)
{
    act->next->outlook.look.mode = (enum shade_mode)act->value[0].number;
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
