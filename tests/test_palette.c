/*
 * Colours of labels: distinct, and well apart, also for eyes that lack one kind of cone.
 *
 * Distances are those of OKLab (Ottosson 2020), in 10 000ths, rounded to whole ones; 200 is about
 * what can just be told apart side by side. What protanopia and deuteranopia leave of a colour is
 * that of Machado, Oliveira and Fernandes (2009).
 */
#include "check.h"

#include <math.h>

#include "render/palette.h"
#include "render/look.h"

enum { EYES = 3 }; /* all cones; without long ones, protanopia; without middle ones, deuteranopia */

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
                                            {-0.011820, 0.042940, 0.968881}}};
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

/* The square of a distance. Eyes with all cones distinguish more: for them it is to be twice as
 * large. */
static int64_t apart(const struct seen *a, const struct seen *b)
{
    int64_t least = apart_for(0, a, b) / 4;
    for (int eye = 1; eye < EYES; eye++) {
        const int64_t squared = apart_for(eye, a, b);
        least = squared < least ? squared : least;
    }
    return least;
}

/* ---- the rule ---- */

enum { LEVEL_STEP = 15, CANDIDATES = 18 * 18 * 18, NEIGHBOURS = 12 };

static struct candidate {
    uint8_t rgb[3];
    struct seen seen;
    int64_t apart; /* from the nearest label so far */
} candidate[CANDIDATES];
static int candidates;

/* Neither black nor white nor grey, nor too bright to be shaded. */
static void list_candidates(void)
{
    for (int i = 0; i < CANDIDATES; i++) {
        struct candidate *c = &candidate[candidates];
        const int level[3] = {i / 324, i / 18 % 18, i % 18};
        for (int k = 0; k < 3; k++)
            c->rgb[k] = (uint8_t)(LEVEL_STEP * level[k]);
        c->seen = see(c->rgb);
        c->apart = INT64_MAX / 16;
        const int64_t *lab = c->seen.lab[0];
        const int64_t chroma = lab[1] * lab[1] + lab[2] * lab[2];
        candidates +=
            lab[0] >= 4500 && lab[0] <= 9200 && chroma >= 500 * 500 && chroma <= 2000 * 2000;
    }
}

/* The squared distance to the nearest of the twelve labels before it, or, if that is less, some
 * times that to the nearest of all: of few labels all are as far apart as can be, of many those
 * with near numbers. */
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

/* The first eight are given. */
static void follow_rule(struct palette *palette)
{
    struct seen label[256];
    list_candidates();
    for (int number = 1; number < 256; number++) {
        int64_t most = -1;
        const struct candidate *best = candidate;
        for (int i = 0; i < candidates && number > 8; i++) {
            const int64_t s = score(&candidate[i], label, number);
            best = s > most ? &candidate[i] : best;
            most = s > most ? s : most;
        }
        if (number > 8)
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
    for (int label = 9; label < 256; label++)
        printf("%s0x%02x%02x%02x,%s", (label - 9) % 9 ? " " : "#     ", palette->rgb[label][0],
               palette->rgb[label][1], palette->rgb[label][2],
               (label - 9) % 9 == 8 || label == 255 ? "\n" : "");
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

/* The least distances of all labels, of those with near numbers, and of the first 24. */
static void find_least(int eye, const struct seen *label, double least[3])
{
    for (int i = 1; i < 256; i++)
        for (int j = 1; j < i; j++) {
            const double d = sqrt((double)apart_for(eye, &label[i], &label[j]));
            const bool counts[3] = {true, i > 8 && i - j <= NEIGHBOURS, i <= 24};
            for (int k = 0; k < 3; k++)
                least[k] = counts[k] && d < least[k] ? d : least[k];
        }
}

STORY(labels_are_well_apart_for_every_eye)
{
    static const double promised[EYES][3] = {{250, 1050, 550}, {125, 520, 430}, {125, 520, 430}};
    struct palette palette;
    struct seen label[256];
    palette_default(&palette);
    for (int i = 1; i < 256; i++)
        label[i] = see(palette.rgb[i]);
    for (int eye = 0; eye < EYES; eye++) {
        double least[3] = {10000, 10000, 10000};
        find_least(eye, label, least);
        printf("# eye %d: least distances %.0f of all, %.0f of near numbers, %.0f of the first\n",
               eye, least[0], least[1], least[2]);
        for (int k = 0; k < 3; k++)
            CHECK(least[k] >= promised[eye][k]);
    }
}

int main(void)
{
    return RUN_STORIES(TELL(the_table_is_what_its_rule_makes),
                       TELL(labels_are_well_apart_for_every_eye));
}
