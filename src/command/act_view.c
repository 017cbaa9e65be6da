/* Commands that change the view. */
#include "command/act.h"

#include <string.h>

static int32_t whole_turn(int64_t angle)
{
    int64_t turned = angle % VIEW_TURN;
    return (int32_t)(turned < 0 ? turned + VIEW_TURN : turned);
}

ACT(view)
{
    struct view view = desk->session.settings.view;
    (void)reply;
    if (value[0].text) {
        if (value[1].given || value[2].given)
            return fault_set(fault, ERR_USAGE, "a named view takes no angles");
        view_by_name(value[0].text, view.angle);
    } else {
        for (int i = 0; i < 3; i++)
            view.angle[i] = whole_turn(value[i].given ? value[i].number : 0);
    }
    return session_set_view(&desk->session, &view, fault);
}

ACT(turn)
{
    struct view view = desk->session.settings.view;
    (void)reply;
    for (int i = 0; i < 3; i++)
        if (value[i].given)
            view.angle[i] = whole_turn(view.angle[i] + value[i].number);
    return session_set_view(&desk->session, &view, fault);
}

ACT(zoom)
{
    struct session *session = &desk->session;
    struct view view = session->settings.view;
    (void)reply;
    view.zoom = (uint32_t)value[0].number;
    if (value[0].text) {
        view.zoom = view_fitting_zoom(session->scene, view.width, view.height);
        memset(view.focus, 0, sizeof view.focus);
    }
    return session_set_view(session, &view, fault);
}

ACT(pan)
{
    struct session *session = &desk->session;
    struct view view = session->settings.view;
    (void)reply;
    view_pan(&view, &session->camera, value[0].number, value[1].number);
    return session_set_view(session, &view, fault);
}

ACT(focus)
{
    struct session *session = &desk->session;
    struct view view = session->settings.view;
    (void)reply;
    memset(view.focus, 0, sizeof view.focus);
    if (!value[0].text)
        view_focus_on(&view, session->scene, value[0].place);
    return session_set_view(session, &view, fault);
}

ACT(size)
{
    struct view view = desk->session.settings.view;
    (void)reply;
    view.width = (uint32_t)value[0].number;
    view.height = (uint32_t)value[1].number;
    return session_set_view(&desk->session, &view, fault);
}

ACT(hide)
{
    (void)reply, (void)fault;
    session_set_visible(&desk->session, (uint8_t)value[0].number, false);
    return OK;
}

ACT(show)
{
    (void)reply, (void)fault;
    session_set_visible(&desk->session, (uint8_t)value[0].number, true);
    return OK;
}
