#include "report/figures.h"

#include <assert.h>
#include <math.h>

enum { DIGITS = 12 };

void figures_add(struct figures *figures, const char *name, double value)
{
    assert(figures->count < FIGURES_MOST);
    figures->of[figures->count].name = name;
    figures->of[figures->count++].value = value;
}

void figures_write_json(struct json *json, const struct figures *figures)
{
    for (int i = 0; i < figures->count; i++)
        json_real(json, figures->of[i].name, figures->of[i].value, DIGITS);
}

void figures_write_csv_names(struct buf *out, const struct figures *figures)
{
    buf_add_text(out, "label,name");
    for (int i = 0; i < figures->count; i++)
        buf_printf(out, ",%s", figures->of[i].name);
    buf_add_char(out, '\n');
}

void figures_write_csv(struct buf *out, const char *label_name, const struct figures *figures)
{
    buf_add_char(out, ',');
    buf_add_csv(out, label_name);
    for (int i = 0; i < figures->count; i++) {
        buf_add_char(out, ',');
        if (!isnan(figures->of[i].value))
            buf_printf(out, "%.*g", DIGITS, figures->of[i].value);
    }
    buf_add_char(out, '\n');
}
