/* Commands that change how what is seen is coloured. */
#include "command/act.h"

ACT(shade)
{
    struct look look = interp->session.settings.look;
    (void)reply;
    look.mode = (enum shade_mode)value[0].number;
    return session_set_look(&interp->session, &look, fault);
}

ACT(light)
{
    struct look look = interp->session.settings.look;
    (void)reply;
    for (int i = 0; i < 2; i++)
        look.light[i] = (int32_t)value[i].number;
    return session_set_look(&interp->session, &look, fault);
}

ACT(cue)
{
    struct look look = interp->session.settings.look;
    (void)reply;
    look.cue_percent = (uint32_t)value[0].number;
    return session_set_look(&interp->session, &look, fault);
}

ACT(edges)
{
    struct look look = interp->session.settings.look;
    (void)reply;
    look.edges = value[0].number == 0;
    return session_set_look(&interp->session, &look, fault);
}

ACT(samples)
{
    struct look look = interp->session.settings.look;
    (void)reply;
    look.samples = 1u << value[0].number;
    return session_set_look(&interp->session, &look, fault);
}
