#include "verify/ci.h"

#include <stdlib.h>

bool ci_is_set(void)
{
    const char *ci = getenv("CI");
    return ci && *ci;
}
