/* SPDX-License-Identifier: MIT */
/* What a user has written down: whatever it is, the setup can be used, and what is printed and
 * carried out of it is text. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/safe.h"
#include "program/programs.h"
#include "tui/pilot/pilot_keys.h"

static void check_lines(const struct buf *text)
{
    HOLDS(!text->failed);
    for (const char *at = buf_text(text); *at; at += *at == '\n') {
        const size_t n = strcspn(at, "\n");
        for (size_t i = 0, step; i < n; i += step) {
            step = safe_character(at + i, n - i);
            HOLDS(step > 0);
        }
        at += n;
    }
    HOLDS(strlen(buf_text(text)) == text->length);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct config config;
    struct pilot_state state;
    const struct pilot_facts facts = {.zoom = 1000};
    struct buf page = {0};
    config_init(&config);
    buf_add_text(&config.path, "config");
    config_take(&config, (const char *)bytes, length);
    check_lines(&config.words);
    check_lines(&config.start);
    const struct pilot_setup *setup = &config.setup;
    HOLDS(setup->theme && setup->brush.label < 256 && setup->brush.radius <= 64);
    HOLDS(setup->windows <= SETUP_WINDOWS_MOST);
    for (size_t i = 0; i < setup->windows; i++)
        HOLDS(setup->window[i].width > 0 && memchr(setup->window[i].name, '\0', SETUP_NAME_BYTES));
    pilot_state_init(&state, setup);
    pilot_keys_page(&page, &(struct pilot_keys_wish){setup, false, 80, false, NULL});
    for (enum pilot_mode mode = PILOT_MOVING; mode <= PILOT_WINDOWING; mode++) {
        state.mode = mode;
        pilot_keys_hint(&state, &facts, &page);
    }
    check_lines(&page);
    buf_release(&page);
    config_release(&config);
    return 0;
}
