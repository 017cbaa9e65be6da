/*
 * Whether this is a run without a person: by the environment variable CI, which the services that
 * carry out tests set. Then verification is strict, and what is a person's decision is refused.
 */
#ifndef VERIFY_CI_H
#define VERIFY_CI_H

#include <stdbool.h>

/* It is set, to anything but "". */
bool ci_is_set(void);

#endif
