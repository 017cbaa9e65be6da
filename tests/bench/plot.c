/* SPDX-License-Identifier: MIT */
#include "tests/bench/plot.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum {
    LEFT = 76,
    RIGHT = 24,
    TOP = 104,
    HIGH = 300,
    BOTTOM = 64,
    TICKS = 6,
    BAR = 16,    /* a bar, and between groups twice that */
    WIDE = 720,  /* the least width between the axes */
    LEGEND = 16, /* side of a colour's square */
    MARKS = 5,
    LETTER = 7, /* about the width of one at 13 px */
};

static const char *const colour[PLOT_SERIES_MOST] = {"#0072b2", "#e69f00", "#009e73",
                                                     "#cc79a7", "#56b4e9", "#d55e00"};

/* Where things lie: x grows to the right, y down. */
struct frame {
    const struct plot *plot;
    double width, most; /* between the axes; the value at its top */
    double tick;
};

static double y_of(const struct frame *frame, double value)
{
    return TOP + HIGH - value / frame->most * HIGH;
}

double plot_tick(double value, unsigned most)
{
    double tick = pow(10, floor(log10(value > 0 ? value / most : 1)));
    while (tick * most < value * (1 - 1e-9))
        tick *= tick * 2 * most >= value * (1 - 1e-9)   ? 2
                : tick * 5 * most >= value * (1 - 1e-9) ? 5
                                                        : 10;
    return tick;
}

static void add_words(struct buf *svg, const char *text)
{
    for (; *text; text++)
        if (*text == '<' || *text == '&')
            buf_add_text(svg, *text == '<' ? "&lt;" : "&amp;");
        else
            buf_add_char(svg, *text);
}

static void add_text(struct buf *svg, double x, double y, const char *how, const char *text)
{
    buf_printf(svg, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, how);
    add_words(svg, text);
    buf_add_text(svg, "</text>\n");
}

static void add_scale(struct buf *svg, const struct frame *frame)
{
    char number[32];
    for (int i = 0; i * frame->tick <= frame->most * (1 + 1e-9); i++) {
        const double y = y_of(frame, i * frame->tick);
        buf_printf(svg, "<line x1=\"%d\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"%s\"/>\n",
                   LEFT, LEFT + frame->width, y, y, i ? "#e4e4e4" : "#444444");
        snprintf(number, sizeof number, "%g", i * frame->tick);
        add_text(svg, LEFT - 8, y + 4, "text-anchor=\"end\" fill=\"#444444\" font-size=\"12\"",
                 number);
    }
    buf_printf(svg, "<g transform=\"translate(20 %d) rotate(-90)\">\n", TOP + HIGH / 2);
    add_text(svg, 0, 0, "text-anchor=\"middle\" fill=\"#444444\" font-size=\"13\"",
             frame->plot->unit);
    buf_add_text(svg, "</g>\n");
}

/* Circle, square, diamond, triangles, in turn. */
static void add_mark(struct buf *svg, const struct plot_series *series, double x, double y)
{
    static const char *const path[MARKS] = {"M-4,0 a4,4 0 1,0 8,0 a4,4 0 1,0 -8,0",
                                            "M-4,-4h8v8h-8z", "M0,-5 L5,0 L0,5 L-5,0z",
                                            "M0,-5 L5,4 L-5,4z", "M0,5 L5,-4 L-5,-4z"};
    buf_printf(svg,
               "<path transform=\"translate(%.1f %.1f)\" d=\"%s\" fill=\"%s\" "
               "stroke=\"#ffffff\"/>\n",
               x, y, path[series->colour % MARKS], colour[series->colour]);
}

/* Beside each name what it looks like: a square, or a piece of its line. */
static void add_legend(struct buf *svg, const struct plot *plot, bool lines)
{
    double x = LEFT;
    for (size_t s = 0; s < plot->count; s++) {
        const struct plot_series *series = &plot->series[s];
        if (lines) {
            buf_printf(svg,
                       "<line x1=\"%.1f\" x2=\"%.1f\" y1=\"73\" y2=\"73\" stroke=\"%s\" "
                       "stroke-width=\"2\"/>\n",
                       x - 2, x + LEGEND + 2, colour[series->colour]);
            add_mark(svg, series, x + LEGEND / 2, 73);
        } else {
            buf_printf(svg,
                       "<rect x=\"%.1f\" y=\"66\" width=\"%d\" height=\"%d\" rx=\"2\" "
                       "fill=\"%s\"/>\n",
                       x, LEGEND - 2, LEGEND - 2, colour[series->colour]);
        }
        add_text(svg, x + LEGEND + 6, 78, "fill=\"#222222\" font-size=\"13\"", series->name);
        x += LEGEND + 22 + (double)(LETTER * strlen(series->name));
    }
}

static void begin(struct buf *svg, struct frame *frame, const struct plot *plot, double width,
                  bool lines)
{
    double highest = 0;
    for (size_t s = 0; s < plot->count; s++)
        for (size_t g = 0; g < plot->groups; g++)
            highest = fmax(highest, plot->series[s].value[g]);
    *frame = (struct frame){.plot = plot, .width = width};
    frame->tick = plot_tick(highest, TICKS);
    frame->most = fmax(frame->tick, ceil(highest / frame->tick - 1e-9) * frame->tick);
    const double wide = LEFT + width + RIGHT;
    const int high = TOP + HIGH + BOTTOM;
    buf_printf(svg,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%d\" "
               "viewBox=\"0 0 %.0f %d\" font-family=\"DejaVu Sans, Helvetica, Arial, "
               "sans-serif\" stroke=\"none\">\n"
               "<rect width=\"%.0f\" height=\"%d\" fill=\"#ffffff\"/>\n",
               wide, high, wide, high, wide, high);
    add_text(svg, LEFT, 28, "fill=\"#111111\" font-size=\"17\" font-weight=\"bold\"", plot->title);
    add_text(svg, LEFT, 49, "fill=\"#555555\" font-size=\"12\"", plot->caption);
    add_legend(svg, plot, lines);
    add_scale(svg, frame);
    if (plot->groups_are)
        add_text(svg, LEFT + width / 2, TOP + HIGH + 46,
                 "text-anchor=\"middle\" fill=\"#444444\" font-size=\"13\"", plot->groups_are);
}

static void add_group_name(struct buf *svg, const struct frame *frame, size_t g, double x)
{
    add_text(svg, x, TOP + HIGH + 20, "text-anchor=\"middle\" fill=\"#222222\" font-size=\"12\"",
             frame->plot->group[g]);
}

/* With few bars each has its number over it. */
static void add_bar(struct buf *svg, const struct frame *frame, size_t s, size_t g, double x,
                    double wide)
{
    const double value = frame->plot->series[s].value[g], y = y_of(frame, value);
    char number[32];
    buf_printf(svg, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>\n",
               x + 1, y, wide - 2, TOP + HIGH - y, colour[frame->plot->series[s].colour]);
    if (wide < 2 * BAR)
        return;
    snprintf(number, sizeof number, value < 10 ? "%.1f" : "%.0f", value);
    add_text(svg, x + wide / 2, y - 4, "text-anchor=\"middle\" fill=\"#222222\" font-size=\"11\"",
             number);
}

void plot_bars(struct buf *svg, const struct plot *plot)
{
    struct frame frame;
    const double least = (double)(plot->groups * (plot->count + 2) * BAR);
    const double width = fmax(WIDE, least);
    const double group = width / (double)plot->groups;
    const double bar = fmin(group / (double)(plot->count + 1), 4 * BAR);
    begin(svg, &frame, plot, width, false);
    for (size_t g = 0; g < plot->groups; g++) {
        const double middle = LEFT + ((double)g + 0.5) * group;
        for (size_t s = 0; s < plot->count; s++)
            add_bar(svg, &frame, s, g, middle + ((double)s - (double)plot->count / 2) * bar, bar);
        add_group_name(svg, &frame, g, middle);
    }
    buf_add_text(svg, "</svg>\n");
}

void plot_lines(struct buf *svg, const struct plot *plot)
{
    struct frame frame;
    const double step = WIDE / (double)plot->groups;
    begin(svg, &frame, plot, WIDE, true);
    for (size_t g = 0; g < plot->groups; g++)
        add_group_name(svg, &frame, g, LEFT + ((double)g + 0.5) * step);
    for (size_t s = 0; s < plot->count; s++) {
        const double *value = plot->series[s].value;
        buf_printf(svg, "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" points=\"",
                   colour[plot->series[s].colour]);
        for (size_t g = 0; g < plot->groups; g++)
            buf_printf(svg, "%s%.1f,%.1f", g ? " " : "", LEFT + ((double)g + 0.5) * step,
                       y_of(&frame, value[g]));
        buf_add_text(svg, "\"/>\n");
        for (size_t g = 0; g < plot->groups; g++)
            add_mark(svg, &plot->series[s], LEFT + ((double)g + 0.5) * step,
                     y_of(&frame, value[g]));
    }
    buf_add_text(svg, "</svg>\n");
}
