/*
 * What is kept of the settings at each point of a history, in little room.
 *
 * struct kept has some 11 kB, of which a command changes a few bytes. So points share a *ground*, a
 * whole struct kept, and each has the pieces of it, of 64 bytes, in which it differs; where those
 * become many, a ground of its own.
 *
 * Immutable and counted: each holder drops it once. Maps that are as large as the scene are held
 * along (kept_hold).
 */
#ifndef SESSION_KEPT_SETTINGS_H
#define SESSION_KEPT_SETTINGS_H

#include "session/state.h"

struct kept_settings;

/* Those of `kept`, with one holder. `like` is what they differ little from, or NULL. NULL where
 * there is no memory. */
struct kept_settings *kept_settings_new(const struct kept_settings *like, const struct kept *kept);

struct kept_settings *kept_settings_hold(struct kept_settings *settings); /* one holder more */
void kept_settings_drop(struct kept_settings *settings);                  /* NULL is fine */

/* A copy that borrows. */
struct kept kept_settings_get(const struct kept_settings *settings);

/* The share of one holder, without the maps. */
size_t kept_settings_memory(const struct kept_settings *settings);

#endif
