#include "register/registration.h"

enum err registration_find(struct registration *out, const struct placed_scene *subject,
                           const struct placed_scene *procedure, struct watch *watch,
                           struct fault *fault)
{
    (void)out, (void)subject, (void)procedure, (void)watch;
    return fault_set(fault, ERR_IO, "scenes are not registered yet");
}
