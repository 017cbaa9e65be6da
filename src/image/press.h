/*
 * The press: writes pictures beside the session, so that nobody waits while one is compressed.
 *
 * A thread of its own takes one order after the other and has an image helper of its own. What
 * came of each is kept as a line until somebody asks for the news; a descriptor tells that there
 * are some.
 *
 * Invariants
 *   P1 orders are carried out one at a time, in the order in which they were given;
 *   P2 each has one outcome, told once, in that order, and a file is there, whole, before it is
 *      said to be;
 *   P3 at most PRESS_WAITING_MOST orders wait: press_give waits for room, so memory is bounded;
 *   P4 whatever was given is done when press_free returns, unless press_wait gave it up.
 *
 * Apart from the thread inside, a press belongs to one thread.
 */
#ifndef IMAGE_PRESS_H
#define IMAGE_PRESS_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"
#include "base/watch.h"
#include "image/picture.h"

enum { PRESS_WAITING_MOST = 4 };

struct press;

/* One picture to be written; made by press_order, and the press's once it is given. */
struct order;

/* `program` is the image helper's; it is started with the first order that needs it. */
enum err press_new(struct press **press, const char *program, struct fault *fault);

/* Waits for everything that was given. NULL is fine. */
void press_free(struct press *press);

/* Whether the press takes a file of this name: its extension says that it can be written. What is
 * not known that well is better written by whoever waits for the outcome. */
bool press_takes(const char *path);

/* Checks what can be checked now (that the folder is there, and the file not, under FILE_KEEP), and
 * makes an order, into which the picture goes. On error the picture stays the caller's. */
enum err press_order(struct order **order, const char *path, enum file_mode mode,
                     struct picture *picture, struct fault *fault);
void order_free(struct order *order); /* one that is not given; NULL is fine */

/* Gives an order, which cannot fail; waits while PRESS_WAITING_MOST are before it. */
void press_give(struct press *press, struct order *order);

/* Whether an order for this path is not done yet. */
bool press_holds(struct press *press, const char *path);

/* Waits until all is done. Where the watch (or NULL) stops it, what has not been begun is given up,
 * which its outcome says, and ERR_CANCELLED. */
enum err press_wait(struct press *press, struct watch *watch, struct fault *fault);

/* Adds a line for every outcome that was not told yet: "wrote a.png", or "error: " and the words.
 */
void press_news(struct press *press, struct buf *out);

/* Becomes readable when there are news, until they are told. */
int press_descriptor(const struct press *press);

#endif
