/*
 * Older lines come into the line being edited: one after another, by search, by their last words,
 * or as a suggestion of how it may go on. Pure.
 *
 * The lines looked through with LINE_OLDER and LINE_NEWER begin with what stood before the cursor
 * when that began. One that is the same as what is shown is passed over. An older line that has
 * been changed is the line of today.
 */
#ifndef TUI_PROMPT_LINE_RECALL_H
#define TUI_PROMPT_LINE_RECALL_H

#include "tui/prompt/line.h"

/* LINE_OLDER and what follows it; `before` is what was done before it. */
void line_recall(struct line *l, enum line_action action, enum line_last before);

/* Incremental search backwards through the history. The entry found is shown as the text. */
void line_search_begin(struct line *l);
void line_search_add(struct line *l, const char *bytes, size_t length);
void line_search_erase(struct line *l);
void line_search_again(struct line *l);          /* an older match */
void line_search_end(struct line *l, bool keep); /* the entry stays, or the old line comes back */

/* Whether a line of the history would do now what it did: a name that it needs may be gone. */
typedef bool line_knows_function(void *context, const char *text);

/* What is suggested: the rest of the newest line that begins with the text, is longer, and is
 * known. "" where there is none, for an empty line, or where the cursor is not at the end; it may
 * hold what is not safe to print. It lives as long as the history does not change. */
const char *line_suggestion(const struct line *l, line_knows_function *knows, void *context);

/* Takes a suggestion, or the next word of it, as LINE_RIGHT, LINE_END or LINE_WORD_RIGHT at the end
 * of the line do; false for another action, or for "". */
bool line_take_suggestion(struct line *l, const char *rest, enum line_action action);

#endif
