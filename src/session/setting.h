/* SPDX-License-Identifier: MIT */
/*
 * Settings: commands that do no more than set members of the state, one row each.
 *
 * From the table come the commands themselves, with their parameters and help (command/command.h),
 * what sets them (act_set), what a session begins with, whether two states are equal and
 * what follows where they are not, and the words of `info` and of notes on pictures. So one setting
 * more is a member, its row, and the code that heeds it; one of the look is `is_late`, since golden
 * images that are there already say nothing of it.
 */
#ifndef SESSION_SETTING_H
#define SESSION_SETTING_H

#include "base/buf.h"
#include "session/parameter.h"
#include "session/state.h"

/* In the order of help; the last one has no name. */
extern const struct command setting_table[];

/* A member of the state, as it is held. */
int64_t setting_get(const struct state *state, const struct setting_member *member);
void setting_put(struct state *state, const struct setting_member *member, int64_t number);

/* As a session begins. */
struct state state_default(void);

/* Two are the same where every member is: each is a setting (session/setting.h), or a row of
 * setting.c. Maps are, where they are one and the same. */
bool kept_equals(const struct kept *a, const struct kept *b);
bool outlook_equals(const struct outlook *a, const struct outlook *b);

/* Bytes of both that these look at: all of them, with none between, up to the last member. */
size_t state_bytes_compared(void);

/* MADE_... of what follows from the members in which two differ. */
unsigned state_difference(const struct state *a, const struct state *b);

/* A setting as it would be typed to be what it is now: "shade surface ao=30". What may be left out
 * is, where it is as usual. */
void setting_write(struct buf *out, const struct command *setting, const struct state *state);

/* The words of these bits of VALUE_PARTS. */
void setting_write_parts(struct buf *out, const char *choices, int64_t bits);

/* The same of all of a group, with commas between, but for late ones that are as usual. */
void settings_write(struct buf *out, enum command_group group, const struct state *state);

#endif
