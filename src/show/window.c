/* SPDX-License-Identifier: MIT */
#include "show/window.h"

#include <math.h>
#include <stdio.h>

#include "engine/scene.h"
#include "image/geometry.h"
#include "session/state.h"

/* A real value as an intensity. */
static int32_t intensity_of(const struct geometry *geometry, const struct decimal *real)
{
    static const double most = 1 << 30;
    const double slope = geometry->slope != 0 ? geometry->slope : 1;
    const double value = (decimal_value(real) - geometry->intercept) / slope;
    const double whole = floor(value + 0.5);
    return (int32_t)(whole < -most ? -most : whole > most ? most : whole);
}

void window_of(int32_t window[2], struct session *session)
{
    const struct slice_settings *s = &session_outlook(session)->slices;
    const struct geometry *geometry = session_geometry(session);
    const bool falls = geometry->slope < 0;
    int32_t found[2];
    if (!s->has_window)
        session_find_window(session, found);
    for (int i = 0; i < 2; i++)
        window[i] =
            s->has_window ? intensity_of(geometry, &s->window[i]) : found[falls ? 1 - i : i];
    if (window[0] == window[1])
        window[1] += falls ? -1 : 1;
}

void window_values(double value[2], struct session *session)
{
    const struct slice_settings *s = &session_outlook(session)->slices;
    int32_t window[2];
    window_of(window, session);
    for (int i = 0; i < 2; i++)
        value[i] = s->has_window ? decimal_value(&s->window[i])
                                 : geometry_value(session_geometry(session), window[i]);
}

/* "12.5", or four digits of a value too small for thousandths. */
static void write_value(char out[WINDOW_WORDS_BYTES], double value)
{
    const double thousandths = value * 1000;
    if (value == 0 || fabs(value) >= 1)
        snprintf(out, WINDOW_WORDS_BYTES, "%.10g", floor(thousandths + 0.5) / 1000);
    else
        snprintf(out, WINDOW_WORDS_BYTES, "%.4g", value);
}

void window_words(char least[WINDOW_WORDS_BYTES], char most[WINDOW_WORDS_BYTES],
                  struct session *session)
{
    double value[2];
    window_values(value, session);
    write_value(least, value[0]);
    write_value(most, value[1]);
}
