#include "session/kept_settings.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    KEPT_PIECE = 64,
    PIECES = (sizeof(struct kept) + KEPT_PIECE - 1) / KEPT_PIECE,
    PIECES_MOST = 16, /* beyond, a ground of its own */
};

struct ground {
    size_t holders;
    struct kept kept;
};

struct piece {
    uint16_t number;
    uint8_t bytes[KEPT_PIECE];
};

struct kept_settings {
    size_t holders;
    struct ground *ground;
    unsigned pieces;
    struct piece piece[];
};

_Static_assert(PIECES <= UINT16_MAX, "the number of a piece");

/* Bytes of a piece; the last one is shorter. */
static size_t extent(unsigned number)
{
    const size_t left = sizeof(struct kept) - (size_t)number * KEPT_PIECE;
    return left < KEPT_PIECE ? left : KEPT_PIECE;
}

/* The pieces in which two differ, up to PIECES_MOST of them: how many, or more. */
static unsigned find_pieces(uint16_t number[PIECES_MOST], const struct kept *a,
                            const struct kept *b)
{
    unsigned found = 0;
    for (unsigned n = 0; n < PIECES && found <= PIECES_MOST; n++) {
        const size_t at = (size_t)n * KEPT_PIECE;
        if (memcmp((const char *)a + at, (const char *)b + at, extent(n)) == 0)
            continue;
        if (found < PIECES_MOST)
            number[found] = (uint16_t)n;
        found++;
    }
    return found;
}

static struct ground *ground_new(const struct kept *kept)
{
    struct ground *ground = mem_new(sizeof *ground);
    if (ground)
        memcpy(&ground->kept, kept, sizeof *kept);
    return ground;
}

struct kept_settings *kept_settings_new(const struct kept_settings *like, const struct kept *kept)
{
    uint16_t number[PIECES_MOST];
    struct ground *ground = like ? like->ground : NULL;
    unsigned pieces = ground ? find_pieces(number, &ground->kept, kept) : PIECES_MOST + 1;
    const bool is_own = pieces > PIECES_MOST;
    if (is_own) {
        ground = ground_new(kept);
        pieces = 0;
    }
    struct kept_settings *settings =
        ground ? mem_new(sizeof *settings + pieces * sizeof *settings->piece) : NULL;
    if (!settings) {
        if (is_own)
            free(ground);
        return NULL;
    }
    settings->holders = 1;
    settings->ground = ground;
    settings->pieces = pieces;
    for (unsigned i = 0; i < pieces; i++) {
        settings->piece[i].number = number[i];
        memcpy(settings->piece[i].bytes, (const char *)kept + (size_t)number[i] * KEPT_PIECE,
               extent(number[i]));
    }
    ground->holders++;
    kept_hold(kept);
    return settings;
}

struct kept_settings *kept_settings_hold(struct kept_settings *settings)
{
    settings->holders++;
    return settings;
}

void kept_settings_drop(struct kept_settings *settings)
{
    if (!settings || --settings->holders > 0)
        return;
    struct kept kept = kept_settings_get(settings);
    kept_release(&kept);
    if (--settings->ground->holders == 0)
        free(settings->ground);
    free(settings);
}

struct kept kept_settings_get(const struct kept_settings *settings)
{
    struct kept kept;
    memcpy(&kept, &settings->ground->kept, sizeof kept);
    for (unsigned i = 0; i < settings->pieces; i++) {
        const struct piece *piece = settings->piece + i;
        memcpy((char *)&kept + (size_t)piece->number * KEPT_PIECE, piece->bytes,
               extent(piece->number));
    }
    return kept;
}

size_t kept_settings_memory(const struct kept_settings *settings)
{
    const size_t own = sizeof *settings + settings->pieces * sizeof *settings->piece;
    return own / settings->holders + sizeof *settings->ground / settings->ground->holders;
}
