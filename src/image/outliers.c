#include "image/outliers.h"

#include "image/voxels.h"

enum { PIECE = 1 << 16, DIGIT = 16 /* bits */ };
_Static_assert(OUTLIERS_ROOM == 1 << DIGIT, "a count of each digit");

/* The first test; that of each further one, and of how many voxels it may be at most. */
enum { ASIDE_LEAST = 8, ASIDE_SHARE = 20, MORE = 8, MOST_SHARE = 128 };
enum { THINS_OUT = 2, FALLS_OFF = 32, TAKES_LEVELS = 16 };

/* How often the ends of the range occur. */
static void count_extremes(size_t out[2], const struct numbers *n, struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    struct task task = task_begin(watch, "outliers", n->count);
    out[0] = out[1] = 0;
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end)
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint64_t order = order_at(n->at + width * i, n->type);
            out[0] += order == n->least;
            out[1] += order == n->greatest;
        }
}

static void count_digits(uint64_t *room, const struct numbers *n, unsigned shift, uint64_t above,
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
static uint64_t order_of_rank(const struct numbers *n, size_t rank, uint64_t *room,
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
 * lie within the lowest 16th of the range, and as many within the highest two fifths. */
static bool is_spread(const struct numbers *n, size_t aside, struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    const uint64_t ends[2] = {n->least, n->greatest};
    const double least = order_number(n->least, n->type) / 2, range = half_width(n, ends);
    const double greatest = order_number(n->greatest, n->type) / 2;
    const double low = least + range / 16, high = greatest - range * 2 / 5;
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

/* Puts an order into a list that ascends, in place of the last one; of falling orders where
 * `flip` has all bits. */
static void insert(uint64_t *list, size_t last, uint64_t order, uint64_t flip)
{
    size_t i = last;
    for (; i > 0 && (list[i - 1] ^ flip) > (order ^ flip); i--)
        list[i] = list[i - 1];
    list[i] = order;
}

/* What T(k) is the range of, for the first, small k; false where nothing is left of it. */
static bool put_first_aside(uint64_t core[2], const struct numbers *n, size_t k, uint64_t *room,
                            struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    uint64_t *lowest = room, *highest = room + k + 1;
    struct task task = task_begin(watch, "outliers", n->count);
    size_t between = 0;
    for (size_t i = 0; i <= k; i++) {
        lowest[i] = n->greatest;
        highest[i] = n->least;
    }
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end)
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint64_t order = order_at(n->at + width * i, n->type);
            if (order <= n->least || order >= n->greatest)
                continue;
            between++;
            if (order < lowest[k])
                insert(lowest, k, order, 0);
            if (order > highest[k])
                insert(highest, k, order, UINT64_MAX);
        }
    core[0] = lowest[k];
    core[1] = highest[k];
    return between > 2 * k && core[0] < core[1];
}

/* The same for any k, by ranks. */
static bool put_aside(uint64_t core[2], const struct numbers *n, const size_t extreme[2], size_t k,
                      uint64_t *room, struct watch *watch)
{
    const size_t count = n->count - n->odd;
    if (extreme[0] + k >= count || extreme[1] + k >= count - extreme[0] - k)
        return false;
    core[0] = order_of_rank(n, extreme[0] + k, room, watch);
    core[1] = order_of_rank(n, count - 1 - extreme[1] - k, room, watch);
    return core[0] < core[1];
}

bool outliers_find(uint64_t core[2], const struct numbers *n, uint64_t *room, struct watch *watch)
{
    const size_t count = n->count - n->odd, most = count / MOST_SHARE;
    const size_t share = count >> ASIDE_SHARE;
    const uint64_t ends[2] = {n->least, n->greatest};
    uint64_t next[2];
    size_t extreme[2];
    size_t k = share > ASIDE_LEAST ? share : most < ASIDE_LEAST ? most : ASIDE_LEAST;
    if (n->least == n->greatest || is_spread(n, k, watch) ||
        !put_first_aside(core, n, k, room, watch))
        return false;
    double width = half_width(n, core);
    const double all = half_width(n, ends);
    if (width > all / THINS_OUT)
        return false;
    count_extremes(extreme, n, watch);
    for (k *= MORE; k > 0 && k <= most; k *= MORE) {
        if (!put_aside(next, n, extreme, k, room, watch))
            break;
        const double less = half_width(n, next);
        if (less > width / THINS_OUT || less < width / FALLS_OFF)
            break;
        memcpy(core, next, sizeof next);
        width = less;
    }
    return width < all / TAKES_LEVELS;
}
