/* Files of the source tree that a benchmark lies in, for what it measures on. */
#ifndef PROGRAM_BENCH_TREE_H
#define PROGRAM_BENCH_TREE_H

#include "command/interpreter.h"

/* path = the file `name` of the folder that this program lies in, or of one above; false where it
 * was installed without it. */
bool bench_find_in_tree(struct buf *path, const char *name);

/* path = examples/brain.iftty, or examples/geom.iftty where the scene of that is not here. ERR_IO
 * where the program was installed without it. */
enum err bench_find_example(struct buf *path, const struct interpreter *interp,
                            struct fault *fault);

#endif
