/* SPDX-License-Identifier: MIT */
/*
 * The consensus of several raters, and how far each is from it: cases worked by hand, random ones
 * beside a plain slow vote, and what holds whoever comes first.
 */
#include "report/agreement.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/geometry.h"
#include "tests/check.h"

enum { VOXELS = 4000, RATERS = 5 };

static uint64_t random_state = 1;
static const char *label_name[256];
static struct geometry geometry;
static struct fault fault;

static void begin(void)
{
    for (int l = 0; l < 256; l++)
        label_name[l] = "";
    label_name[1] = "liver";
    geometry = (struct geometry){.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    geometry_place_spaced(&geometry);
}

static uint64_t vote(uint8_t *consensus, const uint8_t *const *label, unsigned raters,
                     size_t voxels)
{
    uint64_t ties = UINT64_MAX;
    CHECK(agreement_majority(consensus, &ties, label, raters, voxels, NULL, &fault) == OK);
    return ties;
}

STORY(most_raters_decide_and_what_is_tied_has_no_label)
{
    /* tied:                   -  -  -  -  -  t  t  -  */
    static const uint8_t a[] = {0, 1, 1, 1, 2, 1, 0, 7}, b[] = {0, 1, 1, 0, 2, 2, 1, 8},
                         c[] = {0, 1, 0, 0, 1, 3, 2, 8};
    static const uint8_t expected[] = {0, 1, 1, 0, 2, 0, 0, 8};
    const uint8_t *const label[] = {a, b, c};
    uint8_t consensus[8];
    CHECK_INT(vote(consensus, label, 3, 8), 2);
    CHECK(memcmp(consensus, expected, 8) == 0);
    /* Of four, two and two are tied, though nobody else says a third thing. */
    const uint8_t *const four[] = {a, b, a, b};
    CHECK_INT(vote(consensus, four, 4, 8), 4);
    CHECK(memcmp(consensus, (const uint8_t[]){0, 1, 1, 0, 2, 0, 0, 0}, 8) == 0);
    CHECK_INT(vote(consensus, label, 2, 8), 4);
}

static void fill(uint8_t *label, unsigned labels)
{
    for (size_t i = 0; i < VOXELS; i++)
        label[i] = (uint8_t)(check_below(&random_state, labels) * 51);
}

/* How many give each label, counted for each voxel from nothing. */
static uint8_t vote_slowly(const uint8_t *const *label, unsigned raters, size_t voxel, bool *tied)
{
    unsigned votes[256] = {0}, most = 0, winners = 0;
    uint8_t winner = 0;
    for (unsigned r = 0; r < raters; r++)
        votes[label[r][voxel]]++;
    for (unsigned l = 0; l < 256; l++)
        most = votes[l] > most ? votes[l] : most;
    for (unsigned l = 0; l < 256; l++)
        if (votes[l] == most) {
            winners++;
            winner = (uint8_t)l;
        }
    *tied = winners > 1;
    return *tied ? 0 : winner;
}

STORY(a_vote_is_what_a_slow_one_is_in_whatever_order_the_raters_come)
{
    static uint8_t room[RATERS][VOXELS], consensus[VOXELS], again[VOXELS];
    for (unsigned raters = 2; raters <= RATERS; raters++) {
        const uint8_t *label[RATERS], *turned[RATERS];
        for (unsigned r = 0; r < raters; r++)
            fill(room[r], 2 + raters % 5);
        for (unsigned r = 0; r < raters; r++) {
            label[r] = room[r];
            turned[r] = room[(r * (raters - 1) + 1) % raters];
        }
        const uint64_t ties = vote(consensus, label, raters, VOXELS);
        CHECK_INT(vote(again, turned, raters, VOXELS), ties);
        CHECK(memcmp(consensus, again, VOXELS) == 0);
        uint64_t tied = 0;
        for (size_t i = 0; i < VOXELS; i++) {
            bool is_tied;
            if (!CHECK(consensus[i] == vote_slowly(label, raters, i, &is_tied)))
                return;
            tied += is_tied;
        }
        CHECK_INT(tied, ties);
    }
}

/* ---- figures ---- */

static struct agreement agreement_of(const uint8_t *const *label, unsigned raters, size_t voxels,
                                     const uint8_t *consensus)
{
    static const char *const name[] = {"a.nii", "b.nii", "c.nii", "d.nii", "e.nii"};
    struct agreement g = {.raters = raters,
                          .consensus = consensus,
                          .voxels = voxels,
                          .by = "majority",
                          .label_name = label_name,
                          .geometry = &geometry};
    for (unsigned r = 0; r < raters; r++) {
        g.name[r] = name[r];
        g.label[r] = label[r];
    }
    CHECK(agreement_count(&g, NULL, &fault) == OK);
    return g;
}

STORY(figures_are_worked_by_hand)
{
    /* Of ten voxels the consensus has four of label 1. The first rater has three of them and one
     * besides: Dice 2 x 3 / (4 + 4), sensitivity 3/4, specificity 5/6. */
    static const uint8_t consensus[] = {1, 1, 1, 1, 0, 0, 0, 0, 0, 0};
    static const uint8_t a[] = {1, 1, 1, 0, 1, 0, 0, 0, 0, 0};
    static const uint8_t b[] = {1, 1, 1, 1, 0, 0, 0, 0, 0, 2};
    const uint8_t *const label[] = {a, b};
    struct agreement g = agreement_of(label, 2, 10, consensus);
    struct buf out = {0};
    agreement_write_csv(&out, &g);
    CHECK_TEXT(buf_text(&out), "rater,label,name,voxels,voxels_consensus,voxels_both,volume_mm3,"
                               "volume_consensus_mm3,dice,sensitivity,specificity\n"
                               "\"a.nii\",1,\"liver\",4,4,3,4,4,0.75,0.75,0.833333333333\n"
                               "\"a.nii\",2,\"\",0,0,0,0,0,,,1\n"
                               "\"a.nii\",all,\"\",4,4,3,4,4,0.75,,\n"
                               "\"b.nii\",1,\"liver\",4,4,4,4,4,1,1,1\n"
                               "\"b.nii\",2,\"\",1,0,0,1,0,0,,0.9\n"
                               "\"b.nii\",all,\"\",5,4,4,5,4,0.888888888889,,\n");
    buf_clear(&out);
    g.has_ties = true;
    g.ties = 1;
    agreement_write_text(&out, &g);
    CHECK_HAS(buf_text(&out),
              "1 liver           0.7500      0.7500      0.8333     4 mm3  a.nii\n");
    CHECK_HAS(buf_text(&out), "0.6667  a.nii, b.nii\n"); /* 2 x 3 / (4 + 5) */
    CHECK_HAS(buf_text(&out), "1 voxel is tied between two labels or more, and has no label");
    buf_release(&out);
    agreement_release(&g);
}

STORY(identical_raters_agree_wholly_and_one_of_noise_does_not)
{
    static uint8_t truth[VOXELS], noise[VOXELS], consensus[VOXELS];
    fill(truth, 3);
    fill(noise, 3);
    const uint8_t *const label[] = {truth, truth, truth, noise};
    CHECK_INT(vote(consensus, label, 4, VOXELS), 0);
    CHECK(memcmp(consensus, truth, VOXELS) == 0);
    struct agreement g = agreement_of(label, 4, VOXELS, consensus);
    for (unsigned r = 0; r < 3; r++)
        CHECK_INT(g.rater[r].differing, 0);
    const struct overlap *o = &g.rater[3];
    CHECK(3 * o->both[51] < 2 * o->b[51]); /* a third is right by chance */
    CHECK(o->differing > VOXELS / 2);
    CHECK_INT(g.pair[0].differing, 0);            /* 1 and 2, */
    CHECK_INT(g.pair[3].differing, 0);            /* 2 and 3, */
    CHECK_INT(g.pair[2].differing, o->differing); /* 1 and 4 */
    agreement_release(&g);
}

STORY(estimates_stand_in_place_of_counts)
{
    static const uint8_t a[] = {1, 0}, consensus[] = {1, 1};
    const uint8_t *const label[] = {a, consensus};
    double sensitivity[256], specificity[256];
    for (int l = 0; l < 256; l++)
        sensitivity[l] = specificity[l] = NAN;
    sensitivity[1] = 0.5625;
    struct agreement g = agreement_of(label, 2, 2, consensus);
    struct buf out = {0};
    g.estimate[0] = (struct rater_estimate){sensitivity, specificity};
    agreement_write_csv(&out, &g);
    CHECK_HAS(buf_text(&out), "\"a.nii\",1,\"liver\",1,2,1,1,2,0.666666666667,0.5625,\n");
    CHECK_HAS(buf_text(&out), "\"b.nii\",1,\"liver\",2,2,2,2,2,1,1,\n"); /* nothing is outside */
    buf_release(&out);
    agreement_release(&g);
}

int main(void)
{
    begin();
    return RUN_STORIES(TELL(most_raters_decide_and_what_is_tied_has_no_label),
                       TELL(a_vote_is_what_a_slow_one_is_in_whatever_order_the_raters_come),
                       TELL(figures_are_worked_by_hand),
                       TELL(identical_raters_agree_wholly_and_one_of_noise_does_not),
                       TELL(estimates_stand_in_place_of_counts));
}
