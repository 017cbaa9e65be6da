/* Commands that change the view. */
#include "command/act.h"

#include <string.h>

#include "render/fit.h"
#include "session/semantics.h"

static int32_t whole_turn(int64_t angle)
{
    int64_t turned = angle % VIEW_TURN;
    return (int32_t)(turned < 0 ? turned + VIEW_TURN : turned);
}

enum err act_view(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    if (act->value[0].text) {
        if (act->value[1].given || act->value[2].given)
            return fault_set(act->fault, ERR_USAGE, "a named view takes no angles");
        view_by_name(act->value[0].text, view->angle);
    } else {
        for (int i = 0; i < 3; i++)
            view->angle[i] = whole_turn(act->value[i].given ? act->value[i].number : 0);
    }
    return act_go(act);
}

enum err act_turn(const struct act *act)
{
    int32_t *angle = act->next->outlook.view.angle;
    for (int i = 0; i < 3; i++)
        if (act->value[i].given)
            angle[i] = whole_turn(angle[i] + act->value[i].number);
    return act_go(act);
}

/* What is shown, at the present angles; recorded as the zoom and place that it comes to: no replay
 * has to know what was shown. */
static enum err fit_shown(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    struct fit fit;
    uint32_t place[3];
    enum err err = fit_init(&fit, session_border(act->session), act->fault);
    if (err)
        return err;
    fit_place(&fit, view, place);
    view->zoom = fit_zoom(&fit, view, place, act->next->outlook.look.samples);
    view_focus_on(view, session_scene(act->session), place);
    if (fit.is_scene)
        buf_add_text(&act->reply->text, "no object is shown: the scene fits\n");
    act_write_waiting(act);
    fit_release(&fit);
    buf_clear(&act->reply->canonical);
    buf_printf(&act->reply->canonical, "zoom %g at=%u,%u,%u", view->zoom / 1000.0, place[0],
               place[1], place[2]);
    return OK;
}

enum err act_zoom(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    const struct value *zoom = &act->value[0], *at = &act->value[1];
    enum err err = OK;
    if (zoom->text && at->given)
        return fault_set(act->fault, ERR_USAGE, "fit finds the place in the centre: without at=");
    if (!zoom->text) {
        view->zoom = (uint32_t)zoom->number;
    } else if (semantics_has(session_semantics(act->session), MEANING_LOOK)) {
        err = fit_shown(act);
    } else {
        view->zoom = view_fitting_zoom(session_scene(act->session), view->width, view->height,
                                       act->next->outlook.look.samples);
        memset(view->focus, 0, sizeof view->focus);
    }
    if (at->given)
        view_focus_on(view, session_scene(act->session), at->place);
    return err ? err : act_go(act);
}

enum err act_pan(const struct act *act)
{
    struct camera camera;
    const enum err err =
        session_aim(act->session, session_outlook(act->session), &camera, act->fault);
    if (err)
        return err;
    view_pan(&act->next->outlook.view, &camera, act->value[0].number, act->value[1].number);
    return act_go(act);
}

enum err act_focus(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    memset(view->focus, 0, sizeof view->focus);
    if (!act->value[0].text)
        view_focus_on(view, session_scene(act->session), act->value[0].place);
    return act_go(act);
}

/* The patient's sides that a direction of the picture leads to, "front and left", or of an unknown
 * orientation the axes, "+y and -x": those within some 67 degrees of it. */
static void write_sides(struct buf *out, const int32_t direction[3], bool sides_unknown)
{
    static const struct {
        int axis;
        const char *side[2]; /* where the direction is above 0 along the axis, and below */
    } row[2][3] = {{{1, {"front", "back"}}, {0, {"right", "left"}}, {2, {"head", "feet"}}},
                   {{1, {"+y", "-y"}}, {0, {"+x", "-x"}}, {2, {"+z", "-z"}}}};
    const int32_t least = view_sine(22500);
    const char *between = "";
    for (int i = 0; i < 3; i++) {
        const int32_t along = direction[row[sides_unknown][i].axis];
        if (along > -least && along < least)
            continue;
        buf_printf(out, "%s%s", between, row[sides_unknown][i].side[along < 0]);
        between = " and ";
    }
}

void act_write_view(struct buf *out, const struct session *session)
{
    const struct view *view = &session_outlook(session)->view;
    const bool unknown = session_scene(session)->sides_unknown;
    const char *name = unknown ? NULL : view_name(view->angle);
    int32_t right[3], up[3], ahead[3], towards[3];
    double middle[3];
    view_look(view, right, up, ahead);
    for (int i = 0; i < 3; i++) {
        towards[i] = -ahead[i];
        middle[i] = (session_scene(session)->grid.size[i] - 1) / 2.0 +
                    (double)view->focus[i] / (1 << VIEW_FOCUS_BITS);
    }
    buf_printf(out,
               "view      %g %g %g degrees%s%s, zoom %g, %ux%u pixels, %.5g,%.5g,%.5g in the "
               "middle\n",
               view->angle[0] / 1000.0, view->angle[1] / 1000.0, view->angle[2] / 1000.0,
               name ? ", " : "", name ? name : "", view->zoom / 1000.0, view->width, view->height,
               middle[0], middle[1], middle[2]);
    const char *his = unknown ? "" : "his ";
    buf_add_text(out, unknown ? "          " : "          the patient's ");
    write_sides(out, towards, unknown);
    buf_printf(out, " towards you, %s", his);
    write_sides(out, right, unknown);
    buf_printf(out, " on the right, %s", his);
    write_sides(out, up, unknown);
    buf_add_text(out, unknown ? " up; orientation unknown\n" : " up\n");
}

/* One label, or where a word is given, all of them. */
static enum err set_visible(const struct act *act, bool is_visible)
{
    const struct value *label = &act->value[0];
    const int first = label->text ? 1 : (int)label->number;
    for (int i = first; i <= (label->text ? 255 : first); i++)
        act->next->kept.visible[i] = is_visible;
    return act_go(act);
}

enum err act_hide(const struct act *act)
{
    return set_visible(act, false);
}

enum err act_opacity(const struct act *act)
{
    uint8_t *opacity = act->next->kept.opacity;
    const struct value *label = &act->value[0];
    if (label->text)
        memset(opacity, (int)act->value[1].number, sizeof act->next->kept.opacity);
    else
        opacity[label->number] = (uint8_t)act->value[1].number;
    return act_go(act);
}

enum err act_show(const struct act *act)
{
    return set_visible(act, true);
}
