/* SPDX-License-Identifier: MIT */
/* Tables of labels, worked by hand: each format, names that have to be made to fit, and what is
 * written. */
#include "show/label_table.h"
#include "session/setting.h"

#include "session/map.h"
#include "tests/check_main.h"
#include "tests/scarce_memory.h"

static struct fault fault;
static struct state state;
static struct label_table table;
static struct label_tally tally;

static bool has_codes;

static enum err read_text(const char *text)
{
    fault = (struct fault){.text = ""};
    return label_table_read(&table, text, strlen(text), has_codes, &fault);
}

/* Reads a table and gives its names and colours to a fresh state. */
static enum err take(const char *text, const char *regions, const char *labels)
{
    OWNED(regions_release) struct regions chosen = {0};
    state = state_default();
    enum err err = read_text(text);
    if (!err)
        err = regions_read(&chosen, regions, labels, &fault);
    if (!err)
        err = label_table_apply(&state.kept, &tally, &table, &chosen, &fault);
    label_table_release(&table);
    return err;
}

/* "left hemi ff0000" */
static const char *told(unsigned label)
{
    static char text[80];
    const uint8_t *rgb = state.kept.palette.rgb[label];
    snprintf(text, sizeof text, "%s %02x%02x%02x", state.kept.label_name[label], rgb[0], rgb[1],
             rgb[2]);
    return text;
}

STORY(each_format_gives_its_names_and_colours)
{
    static const char *const text[] = {
        "# ITK-SnAP Label Description File\n    0     0    0    0        0  0  0    \"Clear\"\n"
        "    7   255    0   16        1  1  1    \"left hemi\"\n",
        "#No. Label Name:   R   G   B   A\n\n0 Unknown 0 0 0 0\n7\tleft hemi  255 0 16 0\n",
        "7 left hemi 255 0 16",
        "\xef\xbb\xbf  7 left hemi 255 0 16 255\r\n",
        "index\tname\tabbreviation\tcolor\tmapping\r\n7\tleft hemi\tlh\t#FF0010\t3\r\n",
        "color\tindex\tname\n\t8\tn/a\n#ff0010\t7\tleft hemi\n"};
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) {
        CHECK_INT(take(text[i], NULL, NULL), OK);
        CHECK_TEXT(told(7), "left hemi ff0010");
        CHECK(tally.names == 1 && tally.colours == 1 && tally.changed == 0 && tally.beyond == 0);
        CHECK_TEXT(state.kept.label_name[0], "");
    }
    CHECK_INT(take("7 Precentral_L 2001\n8 Precentral_R\n", NULL, NULL), OK);
    CHECK_TEXT(state.kept.label_name[7], "Precentral_L");
    CHECK_TEXT(state.kept.label_name[8], "Precentral_R");
    CHECK(tally.names == 2 && tally.colours == 0);
}

STORY(a_lut_gives_every_label_a_colour)
{
    uint8_t bytes[768];
    OWNED(regions_release) struct regions all = {0};
    for (unsigned i = 0; i < 256; i++) {
        bytes[i] = (uint8_t)i;
        bytes[256 + i] = 7;
        bytes[512 + i] = (uint8_t)(255 - i);
    }
    state = state_default();
    strcpy(state.kept.label_name[9], "spleen");
    CHECK(regions_read(&all, NULL, NULL, NULL) == OK);
    CHECK_INT(label_table_read_lut(&table, bytes, 768, &fault), OK);
    CHECK_INT(label_table_apply(&state.kept, &tally, &table, &all, &fault), OK);
    CHECK_TEXT(told(9), "spleen 0907f6");
    CHECK(tally.names == 0 && tally.colours == 255);
    label_table_release(&table);
    CHECK_INT(label_table_read_lut(&table, bytes, 767, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "767 bytes; expected the 768 of a .lut");
}

STORY(names_are_made_to_fit)
{
    static const char *const row[][2] = {
        {"1 17 2 3 4 0", "label-17"},
        {"1 a=b\\c", "a_b_c"},
        {"1 \"1 2\" 2 3 4 0", "label-1 2"},
        {"1 #3", "label-#3"},
        {"1 Superior_fronto-occipital_fasciculus_(could_be)_R", "Superior_fronto-o~_(could_be)_R"},
        {"1 \xff\x1b[31m", "__[31m"},
        {"1 \xc3\xa4pfel", "\xc3\xa4pfel"},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        CHECK_INT(take(row[i][0], NULL, NULL), OK);
        CHECK_TEXT(state.kept.label_name[1], row[i][1]);
        CHECK(tally.changed == (i != 6) && tally.first_changed == (i != 6));
    }
    CHECK_INT(take("1 Unknown\n2 Unknown\n3 An_unknown_part_of_the_left_hem\n"
                   "4 An_unknown_part_of_the_left_hem\n",
                   NULL, NULL),
              OK);
    CHECK_TEXT(state.kept.label_name[1], "Unknown");
    CHECK_TEXT(state.kept.label_name[2], "Unknown (2)");
    CHECK_TEXT(state.kept.label_name[4], "An_unknown_part_of_the_left (4)");
    CHECK_INT(tally.changed, 2);
}

/* The code of the only label, and whether the file has more. */
static const char *code_of(const char *text)
{
    CHECK_INT(read_text(text), OK);
    static char code[LABEL_CODE_BYTES + 8];
    snprintf(code, sizeof code, "%s%s", table.entry->code, table.entry->is_partial ? " +" : "");
    label_table_release(&table);
    return code;
}

STORY(codes_are_those_of_our_own_tables)
{
    has_codes = true;
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"liver\tSCT:10200004:Liver\""), "SCT:10200004:Liver");
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"Liver\tSCT:10200004:Liver\""), "SCT:10200004");
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"a=b\tSCT:1:a_b\""), "SCT:1"); /* the name that is kept */
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"a=b\tSCT:1:a=b\""), "SCT:1:a=b");
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"a\tSCT:85756007:Tissue\""), "");
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"a\tSCT:857560071\""), "SCT:857560071");
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"a\t1\""), " +");
    has_codes = false;
    CHECK_TEXT(code_of("1 1 2 3 1 1 1 \"a\tSCT:1\""), "");
    CHECK_INT(take("1 1 2 3 1 1 1 \"a\tb\"", NULL, NULL), OK);
    CHECK_TEXT(told(1), "a_b 010203");
}

STORY(names_are_kept_as_they_are_written)
{
    static const char *const row[][2] = {
        {"1 3rd-Ventricle 255 0 16 0", "3rd-Ventricle ff0010"},
        {"1\t3rd-Ventricle\t255 0 16 0", "3rd-Ventricle ff0010"},
        {"1 4th ventricle 2 255 0 16 0", "4th ventricle 2 ff0010"},
        {"1 \"left hemi\" 255 0 16 0", "left hemi ff0010"},
        {"1 the \"left\" one 255 0 16 0", "the \"left\" one ff0010"},
        {"1 255 0 16 1 1 1 \"3rd vent, \\\"left\\\"\"", "3rd vent, \"left\" ff0010"},
        {"1 255 0 16 1 1 1 \"3rd vent, \"left\"\"", "3rd vent, \"left\" ff0010"},
        {"1 255 0 16 1 1 1 \"'a' (b) <c> & d\"", "'a' (b) <c> & d ff0010"},
        {"1 255 0 16 1 1 1 \"\xc3\xbcn\xc3\xaf\"", "\xc3\xbcn\xc3\xaf ff0010"},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        CHECK_INT(take(row[i][0], NULL, NULL), OK);
        CHECK_TEXT(told(1), row[i][1]);
        CHECK(tally.names == 1 && tally.colours == 1 && tally.changed == 0);
    }
    CHECK_INT(take("1 255 0 16 1 1 1 \" \"\n2 1 2 3 1 1 1 \"\"\n", NULL, NULL), OK);
    CHECK_TEXT(told(1), " ff0010");
    CHECK(tally.names == 0 && tally.colours == 2 && tally.changed == 0);
}

STORY(names_that_a_format_cannot_hold_are_counted)
{
    static const bool used[256] = {false};
    static const struct {
        enum label_table_format format;
        unsigned changed, first;
        const char *written;
    } row[] = {
        {TABLE_ITKSNAP, 1, 2, "3rd vent, 'left'"}, /* which ends a name there */
        {TABLE_SLICER, 2, 1, "left_hemi"},
        {TABLE_FREESURFER, 2, 1, "left_hemi"},
        {TABLE_MRICRON, 2, 1, "left_hemi"},
        {TABLE_LUT, 3, 1, ""},
        {TABLE_BIDS, 0, 0, ""},
    };
    OWNED(buf_release) struct buf text = {0};
    CHECK_INT(
        take("1 left hemi 1 2 3 0\n2 3rd vent, \"left\" 1 2 3 0\n3 4th 1 2 3 0\n", NULL, NULL), OK);
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        struct label_writing writing = {0};
        buf_clear(&text);
        label_table_write(&text, &writing, row[i].format, &state.kept, used);
        CHECK_INT(writing.changed, row[i].changed);
        CHECK_INT(writing.first_changed, row[i].first);
        CHECK_TEXT(writing.first_written, row[i].written);
        CHECK(strstr(buf_text(&text), row[i].written));
    }
}

STORY(a_table_of_bids_is_read_by_its_columns_and_written)
{
    static const bool used[256] = {[9] = true};
    OWNED(buf_release) struct buf text = {0};
    struct label_writing writing;
    CHECK_INT(take("index\tname\tcolor\n7\t3rd vent, \"left\"\t#0aff01\n", NULL, NULL), OK);
    label_table_write(&text, &writing, TABLE_BIDS, &state.kept, used);
    CHECK_HAS(buf_text(&text), "index\tname\tcolor\n7\t3rd vent, \"left\"\t#0aff01\n9\tLabel 9\t#");
    CHECK_INT(take("index\tname\n4294967295\tlast\n7\tone\n", NULL, NULL), OK);
    CHECK_TEXT(state.kept.label_name[7], "one");
    CHECK_INT(take("index\tname\n-1\tone\n", NULL, NULL), ERR_INPUT);
    CHECK_HAS(fault.text, "line 2: expected a cell for each column, and a number in `index`");
    CHECK_INT(take("index\tname\n\n1 2\tone\n", NULL, NULL), ERR_INPUT);
    CHECK_HAS(fault.text, "line 3: ");
    CHECK_INT(take("index\tname\tcolor\n1\tone\t#12345g\n", NULL, NULL), OK);
    CHECK(tally.names == 1 && tally.colours == 0);
}

STORY(regions_choose_entries_and_their_labels)
{
    static const char atlas[] = "2001 Pre_L 1 2 3 0\n2002 Pre_R 1 2 3 0\n2101 Sup_L 4 5 6 0\n";
    CHECK_INT(take(atlas, "2101,2001-2002", "9,1-2"), OK);
    CHECK_TEXT(told(9), "Sup_L 040506");
    CHECK_TEXT(state.kept.label_name[1], "Pre_L");
    CHECK_TEXT(state.kept.label_name[2], "Pre_R");
    CHECK_INT(take(atlas, "2002", "5"), OK);
    CHECK_TEXT(state.kept.label_name[5], "Pre_R");
    CHECK_INT(tally.beyond, 2);
    CHECK_INT(take(atlas, NULL, NULL), ERR_INPUT);
    CHECK_HAS(fault.text, "none of its entries is for a label; choose with regions=");
    CHECK_INT(take(atlas, "2001,2002", "3,3"), ERR_INPUT);
    CHECK_HAS(fault.text, "two of its entries, 2001 and 2002, are for label 3");
}

STORY(a_map_names_only_labels_without_a_name_and_colours_those_that_have_the_usual_colour)
{
    static const char text[] = "1 one 1 2 3 0\n2 two 4 5 6 0\n3 one 7 8 9 0\n";
    state = state_default();
    strcpy(state.kept.label_name[1], "mine");
    state.kept.palette.rgb[2][0] ^= 1;
    CHECK_INT(read_text(text), OK);
    label_table_fill(&state.kept, &tally, &table);
    CHECK(tally.names == 2 && tally.colours == 2);
    CHECK_TEXT(told(1), "mine 010203");
    CHECK_TEXT(state.kept.label_name[2], "two");
    CHECK(state.kept.palette.rgb[2][1] != 5);
    CHECK_TEXT(told(3), "one 070809");
    label_table_fill(&state.kept, &tally, &table);
    CHECK(tally.names == 0 && tally.colours == 0);
    label_table_release(&table);
}

/* The number of a region's label, or -1. */
static int64_t number_for(const struct regions *regions, uint32_t region)
{
    uint32_t number;
    return regions_choose(regions, region, &number) ? (int64_t)number : -1;
}

STORY(lists_of_regions_and_labels_are_of_one_length)
{
    static const char *const row[][3] = {
        {"1-3", "1,2", "a label for each of `regions`; labels are missing from region 3 on"},
        {"1,2", "1-3", "label 3 and those after it have no region"},
        {"1-3,2", NULL, "2 is listed twice"},
        {NULL, "1", "needs `regions`"},
    };
    struct regions regions;
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        CHECK_INT(regions_read(&regions, row[i][0], row[i][1], &fault), ERR_USAGE);
        CHECK(regions.range == NULL && regions.count == 0);
        CHECK_HAS(fault.text, row[i][2]);
    }
    CHECK_INT(regions_read(&regions, NULL, NULL, &fault), OK);
    CHECK(number_for(&regions, 0) == -1 && number_for(&regions, 1) == 1);
    CHECK(number_for(&regions, REGION_MOST) == REGION_MOST);
    CHECK(number_for(&regions, UINT32_MAX) == UINT32_MAX);
    regions_release(&regions);
    CHECK_INT(regions_read(&regions, "0,65533", NULL, &fault), OK);
    CHECK(number_for(&regions, 0) == 0 && number_for(&regions, 1) == -1);
    CHECK(number_for(&regions, REGION_MOST) == REGION_MOST);
    regions_release(&regions);
    CHECK_INT(regions_read(&regions, "2001-2003,17,4000000001", "5,300-302,1", &fault), OK);
    CHECK(number_for(&regions, 2001) == 5 && number_for(&regions, 2002) == 300);
    CHECK(number_for(&regions, 2003) == 301 && number_for(&regions, 17) == 302);
    CHECK(number_for(&regions, 4000000001) == 1 && number_for(&regions, 2004) == -1);
    regions_release(&regions);
}

STORY(a_line_of_numbers_alone_ends_where_it_ends)
{
    CHECK_INT(read_text("1 1 12 3 \n2 3 \"x\"\n"), OK);
    CHECK_INT((int)table.count, 2);
    CHECK(!table.entry[0].has_colour);
    label_table_release(&table);
}

STORY(a_bad_line_is_named_and_nothing_is_taken)
{
    static const char *const row[][2] = {
        {"1 a\nx b\n", "line 2: expected NUMBER NAME [R G B A]"},
        {"-1 a", "line 1: expected NUMBER NAME"},
        {"1", "line 1: expected NUMBER NAME"},
        {"1 ", "line 1: expected NUMBER NAME"},
        {"1 a 256 0 0", "not 1 a 256 0 0"},
        {"1 255 0 0 1 1 1 \"x\" y", "line 1: expected NUMBER NAME"},
        {"99999999999 a", "line 1: expected NUMBER NAME"},
        {"# nothing\n", "there is no label in it"},
        {"", "there is no label in it"},
        {"1 a\n2 b\x1b]0;c\a 1 2 999 0\n", "\\x1b]0;c\\x07"},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        CHECK_INT(read_text(row[i][0]), ERR_INPUT);
        CHECK(!table.entry && table.count == 0);
        CHECK_HAS(fault.text, row[i][1]);
    }
}

STORY(a_table_has_no_more_labels_than_a_map_has_regions)
{
    OWNED(buf_release) struct buf text = {0};
    for (int i = 0; i <= REGION_MOST; i++)
        buf_add_text(&text, "1 a\n");
    CHECK_INT(read_text(buf_text(&text)), OK);
    CHECK_INT(table.count, REGION_MOST + 1);
    label_table_release(&table);
    buf_add_text(&text, "1 a\n");
    CHECK_INT(read_text(buf_text(&text)), ERR_LIMIT);
    CHECK_HAS(fault.text, "line 65535: more than 65534 labels");
    CHECK(!table.entry);
}

/* Write the table for a file of this name, whose ending has this format. */
static const char *written_for(const char *path, struct buf *text, enum label_table_format expected)
{
    static const bool used[256] = {[3] = true};
    struct label_writing writing = {0};
    enum label_table_format format;
    buf_clear(text);
    CHECK(label_table_ending(path, &format) && format == expected);
    label_table_write(text, &writing, format, &state.kept, used);
    return buf_text(text);
}

STORY(what_is_written_is_read_again)
{
    OWNED(buf_release) struct buf text = {0};
    enum label_table_format format;
    CHECK_INT(take("1 1 2 3 1 1 1 \"left hemi\"\n2 4 5 6 1 1 1 \"spleen\"\n", NULL, NULL), OK);
    CHECK_HAS(written_for("a/b.txt", &text, TABLE_ITKSNAP),
              "\n    1      1    2    3        1  1  1    \"left hemi\"\n");
    CHECK_HAS(buf_text(&text), "\"Label 3\"\n");
    CHECK_INT(take(buf_text(&text), NULL, NULL), OK);
    CHECK_TEXT(told(2), "spleen 040506");
    CHECK_INT(tally.names, 3);
    CHECK_HAS(written_for("b.CTBL", &text, TABLE_SLICER),
              "\n1 left_hemi 1 2 3 255\n2 spleen 4 5 6 255\n"); /* opaque */
    CHECK_HAS(written_for("b.ctab", &text, TABLE_FREESURFER),
              "\n1 left_hemi 1 2 3 0\n2 spleen 4 5 6 0\n"); /* as opaque */
    CHECK_TEXT(written_for("b.nii.txt", &text, TABLE_MRICRON),
               "1 left_hemi\n2 spleen\n3 Label_3\n");
    written_for("b.lut", &text, TABLE_LUT);
    CHECK(text.length == 768 && text.data[256 + 2] == 5 && !label_table_ending("b.nii", &format));
}

STORY(memory_that_runs_out_is_an_error)
{
    enum err err = ERR_MEMORY;
    for (size_t n = 0; n < 20 && err; n++) {
        allow_allocations(n);
        err = read_text("1 a 1 2 3 0\n2 b\n");
        mem_allows = NULL;
        CHECK(err == OK || (err == ERR_MEMORY && !table.entry));
    }
    CHECK_INT(err, OK);
    label_table_release(&table);
}
