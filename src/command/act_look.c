/* Commands that change how what is seen is coloured. */
#include "command/act.h"

enum err act_shade(const struct act *act)
{
    struct look look = act->session->now.outlook.look;
    look.mode = (enum shade_mode)act->value[0].number;
    return session_set_look(act->session, &look, act->fault);
}

enum err act_light(const struct act *act)
{
    struct look look = act->session->now.outlook.look;
    for (int i = 0; i < 2; i++)
        look.light[i] = (int32_t)act->value[i].number;
    return session_set_look(act->session, &look, act->fault);
}

enum err act_cue(const struct act *act)
{
    struct look look = act->session->now.outlook.look;
    look.cue_percent = (uint32_t)act->value[0].number;
    return session_set_look(act->session, &look, act->fault);
}

enum err act_edges(const struct act *act)
{
    struct look look = act->session->now.outlook.look;
    look.edges = act->value[0].number == 0;
    return session_set_look(act->session, &look, act->fault);
}

enum err act_samples(const struct act *act)
{
    struct look look = act->session->now.outlook.look;
    look.samples = 1u << act->value[0].number;
    return session_set_look(act->session, &look, act->fault);
}
