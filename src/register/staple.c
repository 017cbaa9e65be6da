/* SPDX-License-Identifier: MIT */
#include "register/staple.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "register/register_helper.h"

enum {
    PIECE = 1 << 20,
    STEPS_PER_MS = 50000 /* of a voxel, a rater and a label; a tenth of what was measured */
};

/* ITK itself; and of each map a copy as bytes and one of two bytes a voxel. */
static const uint64_t HELD_MOST = UINT64_C(1) << 28;

/* Labels that any map has, in their order: the helper knows them by their place in it. */
struct label_set {
    uint8_t label[STAPLE_LABELS], place[STAPLE_LABELS];
    unsigned count;
};

static void take_labels(struct label_set *out, unsigned raters, const uint8_t *const maps[],
                        size_t voxels)
{
    bool has[STAPLE_LABELS] = {true};
    *out = (struct label_set){.count = 0};
    for (unsigned r = 0; r < raters; r++)
        for (size_t i = 0; i < voxels; i++)
            has[maps[r][i]] = true;
    for (unsigned label = 0; label < STAPLE_LABELS; label++)
        if (has[label]) {
            out->place[label] = (uint8_t)out->count;
            out->label[out->count++] = (uint8_t)label;
        }
}

static bool send_map(struct coprocess *process, const uint8_t *map, size_t voxels,
                     const struct label_set *set)
{
    uint8_t piece[4096];
    for (size_t done = 0; done < voxels;) {
        const size_t left = voxels - done, n = left < sizeof piece ? left : sizeof piece;
        for (size_t i = 0; i < n; i++)
            piece[i] = set->place[map[done + i]];
        if (!coprocess_transmit(process, piece, n))
            return false;
        done += n;
    }
    return true;
}

static bool receive_map(uint8_t *map, struct coprocess *process, size_t voxels,
                        const struct label_set *set)
{
    for (size_t done = 0; done < voxels;) {
        const size_t left = voxels - done, n = left < PIECE ? left : PIECE;
        if (!coprocess_receive(process, map + done, n))
            return false;
        for (size_t i = done; i < done + n; i++) {
            if (map[i] >= set->count)
                return coprocess_odd(process);
            map[i] = set->label[map[i]];
        }
        done += n;
    }
    return true;
}

static bool receive_rater(struct staple_rater *out, struct coprocess *process,
                          const struct label_set *set)
{
    for (unsigned label = 0; label < STAPLE_LABELS; label++)
        out->sensitivity[label] = out->specificity[label] = NAN;
    for (unsigned i = 0; i < set->count; i++) {
        double rate[2];
        if (!coprocess_receive(process, rate, sizeof rate))
            return false;
        if (!(rate[0] >= 0 && rate[0] <= 1 && rate[1] >= 0 && rate[1] <= 1))
            return coprocess_odd(process);
        out->sensitivity[set->label[i]] = rate[0];
        out->specificity[set->label[i]] = rate[1];
    }
    return true;
}

static enum err find(uint8_t *consensus, struct staple_rater rater[], unsigned raters,
                     const uint8_t *const maps[], size_t voxels, const struct label_set *set,
                     struct coprocess *process, struct fault *fault)
{
    char line[COPROCESS_LINE];
    const int length =
        snprintf(line, sizeof line, "staple %u %u %zu\n", raters, set->count, voxels);
    bool goes = coprocess_transmit(process, line, (size_t)length);
    for (unsigned r = 0; goes && r < raters; r++)
        goes = send_map(process, maps[r], voxels, set);
    if (!goes)
        return coprocess_fault(process, NULL, NULL, fault);
    const enum err err = register_helper_await(process, "consensus", fault);
    if (err)
        return err;
    goes = receive_map(consensus, process, voxels, set);
    for (unsigned r = 0; goes && r < raters; r++)
        goes = receive_rater(&rater[r], process, set);
    return goes ? OK : coprocess_fault(process, NULL, NULL, fault);
}

enum err staple_find(uint8_t *consensus, struct staple_rater rater[], unsigned raters,
                     const uint8_t *const maps[], const uint32_t size[3], struct watch *watch,
                     struct fault *fault)
{
    struct coprocess process;
    struct label_set set;
    size_t voxels, bytes;
    if (raters < 2 || raters > STAPLE_RATERS_MOST)
        return fault_set(fault, ERR_INPUT, "%u map%s; STAPLE takes 2 to %d", raters,
                         raters == 1 ? "" : "s", STAPLE_RATERS_MOST);
    if (!size_multiply(size[0], size[1], &voxels) || !size_multiply(voxels, size[2], &voxels) ||
        !size_multiply(voxels, 3 * (size_t)raters + 8, &bytes) || voxels == 0)
        return fault_set(fault, ERR_LIMIT, "maps that do not fit the memory of any machine");
    take_labels(&set, raters, maps, voxels);
    const double step_ms = (double)voxels * raters * set.count / STEPS_PER_MS;
    enum err err = register_helper_start(&process, "STAPLE", HELD_MOST + bytes,
                                         5000 + (int)fmin(step_ms, INT32_MAX / 2), watch, fault);
    if (!err)
        err = find(consensus, rater, raters, maps, voxels, &set, &process, fault);
    coprocess_release(&process);
    return err;
}
