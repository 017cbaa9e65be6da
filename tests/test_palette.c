/* SPDX-License-Identifier: MIT */
/* Colours of labels: distinct, far apart, and different from grey and from the marks drawn over
 * slices, also for people without one kind of cone. render/palette.h defines the measure of
 * distances. */
#include "tests/check_main.h"

#include <math.h>

#include "render/look.h"
#include "render/notes.h"
#include "render/palette.h"

/* All cones; without long ones, protanopia; middle ones, deuteranopia; short ones, tritanopia. */
enum { EYES = 4 };

struct seen {
    int64_t lab[EYES][3];
};

static double linear(uint8_t level)
{
    const double v = level / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double row_times(const double row[3], const double v[3])
{
    return row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
}

static void to_lab(int64_t lab[3], const double rgb[3])
{
    static const double cone[3][3] = {{0.4122214708, 0.5363325363, 0.0514459929},
                                      {0.2119034982, 0.6806995451, 0.1073969566},
                                      {0.0883024619, 0.2817188376, 0.6299787005}};
    static const double of_cones[3][3] = {{0.2104542553, 0.7936177850, -0.0040720468},
                                          {1.9779984951, -2.4285922050, 0.4505937099},
                                          {0.0259040371, 0.7827717662, -0.8086757660}};
    double root[3];
    for (int k = 0; k < 3; k++)
        root[k] = cbrt(row_times(cone[k], rgb));
    for (int k = 0; k < 3; k++)
        lab[k] = llround(10000 * row_times(of_cones[k], root));
}

static struct seen see(const uint8_t rgb[3])
{
    static const double eye[EYES][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                           {{0.152286, 1.052583, -0.204868},
                                            {0.114503, 0.786281, 0.099216},
                                            {-0.003882, -0.048116, 1.051998}},
                                           {{0.367322, 0.860646, -0.227968},
                                            {0.280085, 0.672501, 0.047413},
                                            {-0.011820, 0.042940, 0.968881}},
                                           {{1.255528, -0.076749, -0.178779},
                                            {-0.078411, 0.930809, 0.147602},
                                            {0.004733, 0.691367, 0.303900}}};
    const double in[3] = {linear(rgb[0]), linear(rgb[1]), linear(rgb[2])};
    struct seen seen;
    for (int e = 0; e < EYES; e++) {
        double left[3];
        for (int k = 0; k < 3; k++)
            left[k] = fmin(1, fmax(0, row_times(eye[e][k], in)));
        to_lab(seen.lab[e], left);
    }
    return seen;
}

static int64_t apart_for(int eye, const struct seen *a, const struct seen *b)
{
    int64_t squared = 0;
    for (int k = 0; k < 3; k++) {
        const int64_t d = a->lab[eye][k] - b->lab[eye][k];
        squared += d * d;
    }
    return squared;
}

/* Return the squared distance from the nearest grey of any lightness. */
static int64_t off_grey(int eye, const struct seen *a)
{
    return a->lab[eye][1] * a->lab[eye][1] + a->lab[eye][2] * a->lab[eye][2];
}

/* Return that from the yellows of the cross-hair in files, and of marks in front of a slice
 * (src/program/panes.c). */
static int64_t off_marks(int eye, const struct seen *a)
{
    static const uint8_t frame[3] = {230, 200, 90};
    const struct seen mark[] = {see(notes_yellow), see(frame)};
    const int64_t d[] = {apart_for(eye, a, &mark[0]), apart_for(eye, a, &mark[1])};
    return d[0] < d[1] ? d[0] : d[1];
}

/* Return the squared distance for all eyes. Eyes with all cones distinguish more: for them it must
 * be twice as large. */
static int64_t apart(const struct seen *a, const struct seen *b)
{
    int64_t least = apart_for(0, a, b) / 4;
    for (int eye = 1; eye < EYES; eye++) {
        const int64_t squared = apart_for(eye, a, b);
        least = squared < least ? squared : least;
    }
    return least;
}

/* ---- what is promised ---- */

enum { PALETTE_CHOSEN = 16 }; /* labels whose colours were optimised together */

/* Lower limits of distances. */
enum least {
    APART_4,
    APART_8,
    APART_16,
    NEAR,
    ALL,
    OFF_GREY,
    OFF_GREY_ALL,
    OFF_MARKS,
    OFF_MARKS_ALL,
    LEASTS
};
static const int64_t promised[LEASTS][2] = {
    /* for eyes with all cones, and for each of the others */
    [APART_4] = {2890, 1220},     /* between labels 1 to 4 */
    [APART_8] = {1740, 870},      /* between labels 1 to 8 */
    [APART_16] = {1090, 610},     /* between labels 1 to 16 */
    [NEAR] = {850, 440},          /* from 17 on, from the twelve labels before */
    [ALL] = {220, 100},           /* between any two labels */
    [OFF_GREY] = {1220, 530},     /* of labels 1 to 16 from the nearest grey */
    [OFF_GREY_ALL] = {700, 200},  /* of any label from grey */
    [OFF_MARKS] = {1150, 670},    /* of labels 1 to 16 from those yellows */
    [OFF_MARKS_ALL] = {500, 250}, /* of any label from them */
};

/* ---- the rule ---- */

enum { LEVEL_STEP = 15, CANDIDATES = 18 * 18 * 18, NEIGHBOURS = 12 };

static struct candidate {
    uint8_t rgb[3];
    struct seen seen;
    int64_t apart; /* from the nearest label so far */
} candidate[CANDIDATES];
static int candidates;

/* Different from grey and marks, and neither too dark nor too bright for shading. */
static bool is_fit(const struct seen *seen)
{
    const int64_t *grey = promised[OFF_GREY_ALL], *marks = promised[OFF_MARKS_ALL];
    bool fit = seen->lab[0][0] >= 4500 && seen->lab[0][0] <= 9200;
    for (int eye = 0; eye < EYES && fit; eye++)
        fit = off_grey(eye, seen) >= grey[eye > 0] * grey[eye > 0] &&
              off_marks(eye, seen) >= marks[eye > 0] * marks[eye > 0];
    return fit && off_grey(0, seen) <= 2000 * 2000;
}

/* Return the squared distance to the nearest of the twelve labels before it, or, if that is less, a
 * multiple of that to the nearest of all: few labels are as far apart as possible, of many labels
 * those with near numbers. */
static int64_t score(const struct candidate *c, const struct seen *label, int number)
{
    const int64_t times = number < 72 ? 1 + number / 24 : 4;
    int64_t least = times * times * c->apart;
    for (int before = number - 1; before >= 1 && before >= number - NEIGHBOURS; before--) {
        const int64_t d = apart(&c->seen, &label[before]);
        least = d < least ? d : least;
    }
    return least;
}

/* Recompute all labels but the first 16. */
static void follow_rule(struct palette *palette)
{
    struct seen label[256];
    for (int i = 0; i < CANDIDATES; i++) {
        struct candidate *c = &candidate[candidates];
        const int level[3] = {i / 324, i / 18 % 18, i % 18};
        for (int k = 0; k < 3; k++)
            c->rgb[k] = (uint8_t)(LEVEL_STEP * level[k]);
        c->seen = see(c->rgb);
        c->apart = INT64_MAX / 16;
        candidates += is_fit(&c->seen);
    }
    for (int number = 1; number < 256; number++) {
        int64_t most = -1;
        const struct candidate *best = candidate;
        for (int i = 0; i < candidates && number > PALETTE_CHOSEN; i++) {
            const int64_t s = score(&candidate[i], label, number);
            best = s > most ? &candidate[i] : best;
            most = s > most ? s : most;
        }
        if (number > PALETTE_CHOSEN)
            memcpy(palette->rgb[number], best->rgb, 3);
        label[number] = see(palette->rgb[number]);
        for (int i = 0; i < candidates; i++) {
            const int64_t d = apart(&candidate[i].seen, &label[number]);
            candidate[i].apart = d < candidate[i].apart ? d : candidate[i].apart;
        }
    }
}

static void print_table(const struct palette *palette)
{
    for (int label = 1; label < 256; label++)
        printf("%s0x%02x%02x%02x,%s", (label - 1) % 9 ? " " : "#     ", palette->rgb[label][0],
               palette->rgb[label][1], palette->rgb[label][2],
               (label - 1) % 9 == 8 || label == 255 ? "\n" : "");
}

STORY(the_table_is_what_its_rule_makes)
{
    struct palette palette, made;
    palette_default(&palette);
    made = palette;
    follow_rule(&made);
    if (!CHECK(memcmp(&made, &palette, sizeof made) == 0))
        print_table(&made);
}

/* ---- what it gives ---- */

static void take_least(int64_t *least, int64_t squared)
{
    const int64_t distance = (int64_t)sqrt((double)squared);
    *least = distance < *least ? distance : *least;
}

static void find_least(int eye, const struct seen *label, int64_t least[LEASTS])
{
    for (int i = 1; i < 256; i++) {
        for (int j = 1; j < i; j++) {
            const int64_t squared = apart_for(eye, &label[i], &label[j]);
            const bool counts[] = {i <= 4, i <= 8, i <= PALETTE_CHOSEN,
                                   i > PALETTE_CHOSEN && i - j <= NEIGHBOURS, true};
            for (int k = APART_4; k <= ALL; k++)
                if (counts[k])
                    take_least(&least[k], squared);
        }
        if (i <= PALETTE_CHOSEN) {
            take_least(&least[OFF_GREY], off_grey(eye, &label[i]));
            take_least(&least[OFF_MARKS], off_marks(eye, &label[i]));
        }
        take_least(&least[OFF_GREY_ALL], off_grey(eye, &label[i]));
        take_least(&least[OFF_MARKS_ALL], off_marks(eye, &label[i]));
    }
}

/* The lightness of a colour, all that is left without colours. */
static int64_t lightness(const uint8_t rgb[3])
{
    return llround(
        10000 * cbrt(0.2126 * linear(rgb[0]) + 0.7152 * linear(rgb[1]) + 0.0722 * linear(rgb[2])));
}

/* The pilot draws all of these as thin lines. */
STORY(cross_hair_and_frame_differ_from_labels_1_to_8_for_every_eye_and_in_grey)
{
    static const uint8_t frame[3] = {255, 255, 255};
    const uint8_t *mark[2] = {notes_lime, frame};
    struct palette palette;
    palette_default(&palette);
    for (int m = 0; m < 2; m++)
        for (int label = 1 - m; label <= 8; label++) { /* 0: the cross-hair, of the frame */
            const uint8_t *other = label ? palette.rgb[label] : notes_lime;
            const struct seen a = see(mark[m]), b = see(other);
            for (int eye = 0; eye < EYES; eye++)
                CHECK(apart_for(eye, &a, &b) >= 650 * 650);
            CHECK(llabs(lightness(mark[m]) - lightness(other)) >= 500);
        }
}

/* On a grey print or screen, and for eyes without cones. The darkest label differs from the darkest
 * background, and the lightest from white. */
STORY(labels_1_to_8_differ_in_grey)
{
    struct palette palette;
    palette_default(&palette);
    for (int i = 1; i <= 8; i++) {
        const int64_t own = lightness(palette.rgb[i]);
        CHECK(own >= 4490 && own <= 8820);
        for (int j = 1; j < i; j++)
            CHECK_WITH(llabs(own - lightness(palette.rgb[j])) >= 425, "%d and %d", i, j);
    }
}

STORY(labels_stand_off_each_other_off_grey_and_off_marks_for_every_eye)
{
    struct palette palette;
    struct seen label[256];
    palette_default(&palette);
    for (int i = 1; i < 256; i++)
        label[i] = see(palette.rgb[i]);
    for (int eye = 0; eye < EYES; eye++) {
        int64_t least[LEASTS];
        for (int k = 0; k < LEASTS; k++)
            least[k] = 10000;
        find_least(eye, label, least);
        printf("# eye %d:", eye);
        for (int k = 0; k < LEASTS; k++)
            printf(" %lld", (long long)least[k]);
        printf("\n");
        for (int k = 0; k < LEASTS; k++)
            CHECK(least[k] >= promised[k][eye > 0]);
    }
}
