/* What each command does. The table (command/table.c) names them; nobody else calls them. */
#ifndef COMMAND_ACT_H
#define COMMAND_ACT_H

#include "command/desk.h"

#define ACT(name)                                                                                  \
    enum err act_##name(struct desk *desk, const struct value *value, struct reply *reply,         \
                        struct fault *fault)

/* act_scene.c */
ACT(open);
ACT(weight);
ACT(adjacency);
ACT(label);
ACT(seed);
ACT(remove);
ACT(run);
ACT(auto);

/* act_seed_file.c */
ACT(seed_file);

/* act_view.c */
ACT(view);
ACT(turn);
ACT(zoom);
ACT(size);
ACT(hide);
ACT(show);
ACT(render);
ACT(golden);
ACT(save);

/* act_ask.c */
ACT(pick);
ACT(why);
ACT(info);
ACT(stats);
ACT(help);
ACT(quit);

/* "2 cerebellum", or "2" where the label has no name. */
void act_write_label(struct buf *out, const struct session *session, unsigned label);

#endif
