#include "image/outliers.h"

#include "image/voxels.h"

enum { PIECE = 1 << 16, DIGIT = 16 /* bits */ };
_Static_assert(OUTLIERS_ROOM == 1 << DIGIT, "a count of each digit");

/* The first test; that of each further one, and of how many voxels it may be at most. */
enum { ASIDE_LEAST = 8, ASIDE_SHARE = 20, MORE = 8, MOST_SHARE = 128 };
enum { LEVELS_LEFT = 16, THINS_OUT = 4 };

/* How often an order occurs. */
static size_t count_equal(const struct numbers *n, uint64_t order, struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    struct task task = task_begin(watch, "outliers", n->count);
    size_t count = 0;
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end)
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++)
            count += order_at(n->at + width * i, n->type) == order;
    return count;
}

static void count_digits(size_t *room, const struct numbers *n, unsigned shift, uint64_t above,
                         struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    const uint64_t range = n->greatest - n->least;
    struct task task = task_begin(watch, "outliers", n->count);
    memset(room, 0, OUTLIERS_ROOM * sizeof *room);
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end)
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint64_t key = order_at(n->at + width * i, n->type) - n->least;
            if (key <= range && key >> shift >> DIGIT == above)
                room[key >> shift & (OUTLIERS_ROOM - 1)]++;
        }
}

/* The order that so many voxels precede, digit by digit. */
static uint64_t order_of_rank(const struct numbers *n, size_t rank, size_t *room,
                              struct watch *watch)
{
    uint64_t above = 0;
    unsigned shift = 0;
    while ((n->greatest - n->least) >> shift >> DIGIT)
        shift += DIGIT;
    for (;; shift -= DIGIT) {
        uint64_t digit = 0;
        count_digits(room, n, shift, above, watch);
        for (; digit + 1 < OUTLIERS_ROOM && rank >= room[digit]; digit++)
            rank -= room[digit];
        above = above << DIGIT | digit;
        if (shift == 0)
            return n->least + above;
    }
}

/* Half of a difference, which no double is too wide for. */
static double half_width(const struct numbers *n, const uint64_t order[2])
{
    if (!order_is_real(n->type))
        return (double)(order[1] - order[0]) / 2;
    return order_number(order[1], n->type) / 2 - order_number(order[0], n->type) / 2;
}

/* Enough for most scenes, and found before all of it was looked at: more voxels than are put aside
 * lie within the lowest quarter of the range, and as many more than a 16th of it above that. */
static bool is_spread(const struct numbers *n, size_t aside, struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    const uint64_t ends[2] = {n->least, n->greatest};
    const double least = order_number(n->least, n->type) / 2;
    const double greatest = order_number(n->greatest, n->type) / 2;
    const double low = least + half_width(n, ends) / 4, high = least + half_width(n, ends) / 3;
    struct task task = task_begin(watch, "outliers", n->count);
    size_t below = 0, above = 0;
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end) {
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint8_t *at = n->at + width * i;
            const double half = order_is_real(n->type)
                                    ? real_at(at, n->type == VOXEL_FLOAT64) / 2
                                    : order_number(order_at(at, n->type), n->type) / 2;
            below += half > least && half <= low;
            above += half >= high && half < greatest;
        }
        if (below > aside && above > aside)
            return true;
    }
    return false;
}

/* What T(k) is the range of; false where nothing is left of it. */
static bool put_aside(uint64_t core[2], const struct numbers *n, const size_t extreme[2], size_t k,
                      size_t *room, struct watch *watch)
{
    const size_t count = n->count - n->odd;
    if (extreme[0] + k >= count || extreme[1] + k >= count - extreme[0] - k)
        return false;
    core[0] = order_of_rank(n, extreme[0] + k, room, watch);
    core[1] = order_of_rank(n, count - 1 - extreme[1] - k, room, watch);
    return core[0] < core[1];
}

bool outliers_find(uint64_t core[2], const struct numbers *n, size_t *room, struct watch *watch)
{
    const size_t count = n->count - n->odd, most = count / MOST_SHARE;
    const size_t share = count >> ASIDE_SHARE;
    const uint64_t ends[2] = {n->least, n->greatest};
    uint64_t next[2];
    size_t k = share > ASIDE_LEAST ? share : most < ASIDE_LEAST ? most : ASIDE_LEAST;
    if (n->least == n->greatest || is_spread(n, k, watch))
        return false;
    const size_t extreme[2] = {count_equal(n, n->least, watch), count_equal(n, n->greatest, watch)};
    if (!put_aside(core, n, extreme, k, room, watch) ||
        half_width(n, core) >= half_width(n, ends) / LEVELS_LEFT)
        return false;
    for (k *= MORE; k > 0 && k <= most; k *= MORE) {
        if (!put_aside(next, n, extreme, k, room, watch) ||
            half_width(n, next) > half_width(n, core) / THINS_OUT)
            break;
        memcpy(core, next, sizeof next);
    }
    return true;
}
