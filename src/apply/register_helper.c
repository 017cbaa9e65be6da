/* SPDX-License-Identifier: MIT */
#include "apply/register_helper.h"

#include <string.h>

#include "base/mem.h"
#include "base/scan.h"

const char *register_helper_program;
int register_helper_patience_ms = 60000;

enum err register_helper_start(struct coprocess *out, const char *task, uint64_t bytes, int work_ms,
                               struct watch *watch, struct fault *fault)
{
    const uint64_t available = mem_available();
    const enum err err = coprocess_init(out, REGISTER_HELPER, register_helper_program, fault);
    out->kind = "the register helper";
    out->made_of = COPROCESS_OF_ITK;
    out->package = "iftty-volume";
    out->work_ms = work_ms;
    out->patience_ms =
        register_helper_patience_ms > work_ms ? register_helper_patience_ms : work_ms;
    out->memory = bytes < available ? bytes : available;
    out->watch = watch;
    out->doing = task;
    return err ? err : coprocess_start(out, fault);
}

enum err register_helper_await(struct coprocess *process, const char *word, struct fault *fault)
{
    enum { STEPS_MOST = 1000000 };
    int64_t before = -1;
    for (;;) {
        static const int64_t most[2] = {STEPS_MOST, STEPS_MOST};
        int64_t number[2];
        char line[COPROCESS_LINE];
        const char *at = line;
        const enum err err = coprocess_answer(process, line, NULL, NULL, fault);
        if (err || strcmp(line, word) == 0)
            return err;
        if (!scan_text(&at, "progress ") || !coprocess_numbers(at, 2, most, number) ||
            number[0] < before || number[0] > number[1]) {
            coprocess_odd(process);
            return coprocess_fault(process, NULL, NULL, fault);
        }
        before = number[0];
        if (watch_poll(process->watch, process->doing, (uint64_t)number[0], (uint64_t)number[1]))
            return watch_fault(process->watch, fault);
    }
}
