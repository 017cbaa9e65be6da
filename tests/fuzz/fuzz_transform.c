/* SPDX-License-Identifier: MIT */
/* Transforms of ITK, as text and as MATLAB's: what is read has a name, and a refusal has words and
 * leaves the map alone. */
#include "tests/fuzz/fuzz.h"

#include "helper/itk_transform.h"

static void check(enum err err, const struct affine *out, const struct buf *kind,
                  const struct fault *fault)
{
    if (err)
        HOLDS(*fault->text && out->m[0][0] >= 42 && out->m[0][0] <= 42);
    else
        HOLDS(kind->length > 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct buf text = {0}, kind = {0};
    struct affine out = {{{42}}};
    struct fault fault = {.text = ""};
    buf_add(&text, bytes, length);
    const char *at = buf_text(&text);
    check(itk_transform_scan(&out, &kind, at, &fault), &out, &kind, &fault);
    buf_clear(&kind);
    out = (struct affine){{{42}}};
    if (itk_transform_is_text(at, length))
        HOLDS(!itk_transform_is_matlab(at, length));
    check(itk_transform_decode(&out, &kind, at, length, &fault), &out, &kind, &fault);
    buf_release(&text);
    buf_release(&kind);
    return 0;
}
