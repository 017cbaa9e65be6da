/* SPDX-License-Identifier: MIT */
/* The table of commands. */
#include "command/table.h"

#include "base/file_log.h"
#include "command/command.h"
#include "engine/brush.h"
#include "engine/finish.h"
#include "engine/hints.h"
#include "engine/weight.h"
#include "image/image_helper.h"
#include "render/view.h"
#include "show/export_map.h"
#include "session/setting.h"
#include "session/seed_file.h"
#include "show/slicing.h"

/* Help texts from rows of other tables. */
#define VOLUME_NOTE(format, note)                              note
#define WEIGHT_NOTE(kind, name, argument, usual, help)         help
#define WEIGHT_NOTES                                           WEIGHT_LIST(WEIGHT_NOTE, WEIGHT_NOTE)
#define FINISH_NOTE(kind, name, by, takes, usual, heeds, help) help
#define FINISH_NOTES                                           FINISH_LIST(FINISH_NOTE, FINISH_NOTE)
#define WEIGHT_DETAIL                                                                              \
    "An edge of height h has the weight h under each gradient. Lengths are in voxels, whatever "   \
    "the "                                                                                         \
    "spacing.\n" WEIGHT_NOTES "FILE: a map on the scene's grid with the weight of each voxel, "    \
    "integers 0..65535." MAP_NOTE
#define OPENING_NOTE                                                                               \
    "series: of a folder of DICOM: its number, from 1, or a part of its description, as in "       \
    "series=t1_mprage; without it, the series are listed. The record has the number.\n"            \
    "data: the name of the data set in an HDF5 file.\n"                                            \
    "missing: blank inserts a blank slice for a missing one of a DICOM series.\n"                  \
    "skip: files of a folder to leave out, as in skip=IM0004,IM0007.\n"                            \
    "size, type, endian, offset: of raw:FILE, in voxels, x fastest, and bytes before voxels.\n"    \
    "spacing: X,Y,Z in mm, if the file does not contain it.\n"                                     \
    "private: yes leaves the names of the scene's file and of the journal out of pictures. "       \
    "Names of folders are never in pictures.\n"                                                    \
    "straighten: yes shifts the sheared slices of a tilted gantry in their planes, so that axes "  \
    "are perpendicular; after crop and reduce.\n"                                                  \
    "weight: the initial arc weights, morph unless given, as in weight=gauss:1.5 (`help "          \
    "weight`). New records contain it, so their meaning does not depend on the default."
#define VOLUME_SERIES_NOTE "volume: one of a series in a 4-D file, counted from 0.\n"
#define PART_NOTE                                                                                  \
    "crop: only this box of voxels, the first and last along x, y and z, as in 0-99,40-159,0-79; " \
    "memory is allocated only for the box, and positions count from its first voxel.\n"            \
    "reduce: replace blocks of this many voxels along each axis by their mean, after crop. In "    \
    "maps on the grid of the whole file, a block is replaced by its middle voxel.\n"               \
    "huge: yes accepts a small file whose header declares gigabytes."
#define SYNTHETIC_NOTE                                                                             \
    "synth:geom is a synthetic scene of 200x200x100 voxels. XYZ are three digits; a 2 "            \
    "interpolates its axis to 2n-1 voxels, as in synth:geom:221. SIZE draws the same solids in a " \
    "scene of that size, as in synth:geom:1024x1024x1024. For a large scene, the required memory " \
    "is reported before loading; without enough free memory, the scene is rejected."

enum { PLANE_OFFSET_MOST = 1000000 }; /* thousandths of a millimetre */
enum { VOLUMES_MOST = 65535 };

/* First members of a row, on one line. */
#define COMMAND(NAME, ACT, GROUP, FLAGS)        NAME, NULL, NULL, ACT, GROUP, FLAGS
#define CALLED(NAME, ALSO, ACT, GROUP, FLAGS)   NAME, ALSO, NULL, ACT, GROUP, FLAGS
#define COMES_TO(WHAT, NAME, ACT, GROUP, FLAGS) NAME, NULL, WHAT, ACT, GROUP, FLAGS

/* Parameters: name, type, and .choices, .least and .most as the type requires. */
#define NEED(...)                                                                                  \
    {                                                                                              \
        __VA_ARGS__, .optional = false                                                             \
    }
#define MAY(...)                                                                                   \
    {                                                                                              \
        __VA_ARGS__, .optional = true                                                              \
    }
#define KEYED(...)                                                                                 \
    {                                                                                              \
        __VA_ARGS__, .optional = true, .keyed = true                                               \
    }
#define PAIRED(...)                                                                                \
    {                                                                                              \
        __VA_ARGS__, .optional = true, .paired = true                                              \
    }

#define YES_NO(name) KEYED(name, VALUE_CHOICE, .choices = "yes|no")

/* Parameters shared by all commands that plant. */
#define BRUSH       KEYED("radius", VALUE_RADIUS, .most = 32)
#define WITHIN      KEYED("range", VALUE_INTERVAL)
#define WITHIN_NOTE "\nrange: only voxels with intensities LOW to HIGH, as printed by `why`."

/* Parameters of exact gestures. */
#define OVER  KEYED("over", VALUE_LABELS), KEYED("keep", VALUE_LABELS)
#define EXACT KEYED("within", VALUE_NUMBER, .most = 0, .form = "0"), OVER
#define EXACT_NOTE                                                                                 \
    "\nwithin=0: exact: these voxels get the label, and nothing grows from them."                  \
    "\nover, keep: with within=0, only voxels whose label now is in the list, or is not: "         \
    "numbers, "                                                                                    \
    "ranges or names, as in 0,3-7,spleen, before `finish`. A marker keeps these voxels when an "   \
    "earlier one is removed."

/* Parameters of shells. */
#define HOLLOW                                                                                     \
    KEYED("shell", VALUE_CHOICE, .choices = "yes"), KEYED("around", VALUE_LABEL, .most = 255)

/* Parameters for finished labels. */
#define FINISHED      YES_NO("finished")
#define LEFT_NOTE     "\nfinished=yes: use the labels after `finish`"
#define SHOWN_NOTE    LEFT_NOTE "; by default, the setting `finished` decides."
#define FINISHED_NOTE LEFT_NOTE "; the default is no, at a prompt the setting `finished`."

/* Parameters shared by all commands that read a map. */
#define OF_MAP                                                                                     \
    YES_NO("resample"), KEYED("volume", VALUE_NUMBER, .most = VOLUMES_MOST),                       \
        KEYED("data", VALUE_WORD, .form = "NAME")
#define MAP_NOTE                                                                                   \
    "\nresample: yes resamples a map on another grid, by nearest voxels; otherwise, a map that "   \
    "is more than half a voxel off is rejected.\n"                                                 \
    "volume, data: select one of several in a file, as in `open`."

/* Parameters of weights. */
#define MAY_WEIGH(name, type, low, high)   MAY(name, VALUE_##type, .least = low, .most = high)
#define KEYED_WEIGH(name, type, low, high) KEYED(name, VALUE_##type, .least = low, .most = high)

enum {
    R = COMMAND_RECORDED,
    S = COMMAND_NEEDS_SCENE,
    E = COMMAND_EDITS,
    K = COMMAND_SKETCHED,
    P = COMMAND_PLANTS,
    A = COMMAND_ANSWERS,
    C = COMMAND_CARRIED,
    TURNS = 10 * VIEW_TURN, /* angles beyond one turn are reduced */
    PANS = 1000 * VIEW_SIDE_MOST,
    RING_MOST = 16, /* a wider ring would be a stroke of the background */
};

const char *const command_group_name[GROUPS] = {
    [GROUP_SCENE] = "The scene",
    [GROUP_WEIGHT] = "Arc weights and the region of interest",
    [GROUP_SEEDS] = "Objects and their seeds",
    [GROUP_VIEW] = "The view",
    [GROUP_LOOK] = "Shading",
    [GROUP_CUTS] = "Cuts",
    [GROUP_RENDITION] = "Renditions",
    [GROUP_SLICES] = "Slices",
    [GROUP_KEPT] = "Golden images, maps and the journal",
    [GROUP_QUESTIONS] = "Questions, help, leaving",
};

static const struct command command_table[] = {
    {CALLED("open", "load|read|import", act_open, GROUP_SCENE, R),
     {NEED("FILE", VALUE_FILE, .is_read = true, .is_scene = true),
      KEYED("volume", VALUE_NUMBER, .most = VOLUMES_MOST),
      KEYED("crop", VALUE_LIST, .most = 65533, .form = "A-B,C-D,E-F"),
      KEYED("reduce", VALUE_NUMBER, .least = 2, .most = REDUCE_MOST),
      KEYED("series", VALUE_WORD, .form = "N|TEXT"), KEYED("data", VALUE_WORD, .form = "NAME"),
      KEYED("missing", VALUE_CHOICE, .choices = "blank"),
      KEYED("skip", VALUE_WORD, .form = "NAME,NAME"),
      KEYED("size", VALUE_LIST, .least = 1, .most = 65534, .form = "X,Y,Z"),
      KEYED("type", VALUE_CHOICE, .choices = OPEN_TYPES),
      KEYED("endian", VALUE_CHOICE, .choices = "little|big"),
      KEYED("offset", VALUE_NUMBER, .most = INT64_C(1) << 40, .form = "BYTES"),
      KEYED("spacing", VALUE_WORD, .is_kept = true, .form = "X,Y,Z"), YES_NO("huge"),
      YES_NO("private"), YES_NO("straighten"),
      KEYED("weight", VALUE_WORD, .is_kept = true, .form = "NAME[:NUMBER]", .added = true)},
     "load a scene, or synth:geom[:XYZ|:SIZE]",
     VOLUME_FORMATS(VOLUME_NOTE) SYNTHETIC_NOTE "\n" VOLUME_SERIES_NOTE PART_NOTE "\n" OPENING_NOTE,
     "open synth:geom"},
    {COMMAND("interpolate", act_interpolate, GROUP_SCENE, R | S),
     {NEED("X", VALUE_NUMBER, .least = 1, .most = 2),
      NEED("Y", VALUE_NUMBER, .least = 1, .most = 2),
      NEED("Z", VALUE_NUMBER, .least = 1, .most = 2)},
     "interpolate each axis with a 2 to 2n-1 voxels",
     "Allowed after `open` and before the first seed. A new voxel is the mean of its two "
     "neighbours, with halves rounded up. The spacing is halved, and voxel 0,0,0 keeps its place "
     "in the world.",
     "interpolate 2 2 1"},
    {COMMAND("orient", act_orient, GROUP_SCENE, R | S),
     {NEED("HOW", VALUE_WORD, .is_kept = true, .choices = "file|sform|qform")},
     "set the orientation of the axes",
     "Three letters, as in LPI, name the sides that x, y and z run towards: R or L, A or P, S or "
     "I. Use them for files without orientation, or with a contradictory one; pictures then "
     "contain a note that the user has set it. sform and qform select one of the two orientations "
     "of a NIfTI file. file restores the orientation of the file.\n"
     "A wrong orientation can swap left and right in every picture and report. Saved maps have "
     "the header geometry of the scene's file in any case.",
     "orient RAS"},
    {COMMAND("landmark", act_landmark, GROUP_SCENE, R | S),
     {NEED("NAME", VALUE_WORD, .is_kept = true), NEED("PLACE", VALUE_POSITION, .choices = "none")},
     "name a place that exists in all subjects",
     "For example the anterior commissure, AC. `iftty apply --by landmarks` transfers a procedure "
     "between two scenes by the landmarks that both have. PLACE is stored as a voxel; `none` "
     "removes the landmark. A scene has up to 64; `info` lists them.",
     "landmark AC 90,128,72"},
    {COMMAND("origin", act_origin, GROUP_SCENE, R | S),
     {NEED("PROCEDURE", VALUE_WORD, .is_kept = true), KEYED("digest", VALUE_WORD, .is_kept = true),
      KEYED("by", VALUE_CHOICE, .choices = ORIGIN_WAYS),
      KEYED("as", VALUE_CHOICE, .choices = ORIGIN_PLANTS),
      KEYED("pull", VALUE_WORD, .is_kept = true, .form = "12 NUMBERS"),
      KEYED("scene", VALUE_WORD, .is_kept = true, .form = "SHA256"),
      KEYED("from", VALUE_WORD, .is_kept = true, .form = "SHA256"),
      KEYED("rms", VALUE_REAL, .form = "MM"), KEYED("gate", VALUE_DECIMAL, .most = 1000000),
      KEYED("depth", VALUE_DECIMAL, .most = 1000000, .form = "MM"),
      KEYED("volumes", VALUE_WORD, .is_kept = true, .form = "LABEL:MM3,.."),
      KEYED("dropped", VALUE_WORD, .is_kept = true, .form = "LABEL:N/OF,..")},
     "record the procedure that made this journal",
     "`iftty apply` records this command; it changes no voxel. PROCEDURE is the last chain digest "
     "of the procedure's journal, or `none`; `info` shows it.\n"
     "digest: of the procedure, as `iftty log --procedure` writes it.\n"
     "by, as: the kind of transfer, and the kind of seeds.\n"
     "pull: twelve numbers, the rows of a 3x4 matrix that maps world coordinates of this scene, "
     "in millimetres to the right, front and head, to those of the procedure's scene.\n"
     "scene, from: the digests of this scene and of the procedure's.\n"
     "rms: the mean error of landmarks, in mm.\n"
     "gate: the allowed deviation of intensities, in percent of the range between percentiles 10 "
     "and 90 of the procedure's object.\n"
     "depth: the largest erosion of labels, in mm.\n"
     "volumes: of each label in the procedure, in mm3 of this scene; `hints` begins with the "
     "label whose volume differs most.\n"
     "dropped: for each label, the seeds that were not planted because of their intensities, and "
     "all its seeds.",
     "origin 74120d6c3f0cc54e2237dc0bced98ab5 by=world as=labels"},
    {COMMAND("weight", act_weight, GROUP_WEIGHT, R | S | E | C),
     {NEED("FILE", VALUE_FILE, .is_read = true, .choices = WEIGHT_KINDS),
      WEIGHT_ARGUMENTS(MAY_WEIGH, KEYED_WEIGH), OF_MAP},
     "set arc weights: the cost of a step",
     WEIGHT_DETAIL,
     "weight gauss 1.5"},
    {COMMAND("polarity", act_polarity, GROUP_WEIGHT, R | S | E | C),
     {NEED("LABEL", VALUE_LABEL, .most = 255),
      NEED("PERCENT", VALUE_NUMBER, .least = -POLARITY_MOST, .most = POLARITY_MOST)},
     "prefer edges to darker or to brighter voxels",
     "Under `weight polarity`, paths from the seeds of the label pay PERCENT more for a step to a "
     "darker voxel and PERCENT less for one to a brighter voxel. Use values above 0 for an object "
     "brighter than its surroundings, below 0 for a darker one. The default is 0.",
     "polarity 1 50"},
    {CALLED("mask", "roi", act_mask, GROUP_WEIGHT, R | S | E),
     {NEED("FILE", VALUE_FILE, .is_read = true, .choices = "none"),
      KEYED("regions", VALUE_RANGE, .most = REGION_MOST), OF_MAP},
     "restrict trees to the voxels of a map",
     "FILE is a volume on the scene's grid. Trees grow only where its value is in `regions`, 1 and "
     "above unless given. With a `range`, both apply. It changes no weights." MAP_NOTE,
     "mask brain.nii.gz regions=1-90"},
    {COMMAND("range", act_range, GROUP_WEIGHT, R | S | E),
     {NEED("LOW", VALUE_REAL, .choices = "none"), PAIRED("HIGH", VALUE_REAL)},
     "restrict trees to a range of intensities",
     "No tree grows where the intensity, as printed by `why`, is below LOW or above HIGH: numbers "
     "of up to 19 digits, as in 1.5e-3. They are compared with the values of the file; if the "
     "16-bit scene cannot distinguish these, the answer has the number of doubtful voxels. With a "
     "`mask`, both apply.",
     "range 40 1200.5"},
    {CALLED("label", "name|colour|color", act_label, GROUP_SEEDS, R),
     {NEED("LABEL", VALUE_LABEL, .most = 255, .makes = true),
      NEED("NAME", VALUE_WORD, .is_kept = true), MAY("COLOUR", VALUE_COLOUR),
      KEYED("number", VALUE_NUMBER, .least = 1, .most = UINT32_MAX, .form = "N")},
     "set the name and colour of a label",
     "Label 0 is the background. Quote a name of several words, as in \"left hemi\".\n"
     "LABEL may be a new number up to 4294967295; at most 255 labels exist at a time. After the "
     "first number above 255, here or in a file of `labels`, a number exists only if it is "
     "planted, has a name, or came with a file; other commands reject further ones.\n"
     "number: give the label another number.",
     "label 2 cerebellum #40c060"},
    {COMMAND("label-file", act_label_file, GROUP_SEEDS, R),
     {NEED("FILE", VALUE_FILE, .is_read = true), KEYED("regions", VALUE_LIST, .most = UINT32_MAX),
      KEYED("as", VALUE_LIST, .least = 1, .most = UINT32_MAX)},
     "read names and colours of labels from a table",
     "A label description of ITK-SNAP, a colour table of FreeSurfer or 3D Slicer, a dseg.tsv of "
     "BIDS, or the .nii.txt or .lut next to an atlas of mricron. The number of an entry is its "
     "label; label 0 does not "
     "change. `save names` writes such tables.\n"
     "regions: read only the entries with these numbers, the values of an atlas.\n"
     "as: their labels, one for each of `regions`.",
     "label-file aal.nii.txt regions=1-90"},
    {CALLED("seed", "plant|paint|foreground", act_seed, GROUP_SEEDS, R | S | E | P | K | C),
     {NEED("PLACE", VALUE_POSITION), NEED("LABEL", VALUE_LABEL, .most = 255),
      KEYED("radius", VALUE_RADIUS, .most = BRUSH_HOLLOW_REACH_MOST), WITHIN,
      KEYED("to", VALUE_LINE), KEYED("joined", VALUE_CHOICE, .choices = "yes"), HOLLOW,
      KEYED("through", VALUE_POSITION), KEYED("within", VALUE_RADIUS, .most = REACH_MOST), OVER},
     "plant a seed, a ball of seeds, or a stroke",
     "A voxel that has a seed gets the new label.\n"
     "radius: in voxels, or in millimetres as in 2.5mm, for a ball in the world independent of the "
     "spacing." WITHIN_NOTE "\n"
     "to: the next corner of the stroke, once for each, with a ball of the radius at each step.\n"
     "joined=yes: one marker and one undo step together with the previous command, which planted "
     "seeds of the same label: for a stroke too long for one line of the journal.\n"
     "shell=yes: only the voxels of the ball that have a neighbour outside, to enclose an object. "
     "Voxels of objects other than the enclosed ones are left out. These are `around`, and each "
     "object whose seeds are all inside: a sphere around touching objects is the same after their "
     "balls as before.\n"
     "around: the label of an enclosed object; by default that of its middle.\n"
     "through: of a shell, a voxel on it, in place of its radius.\n"
     "within: of a ball, the reach of its trees from PLACE, in the units of radius: a correction "
     "changes nothing beyond. About three times the depth of the error is a good choice; a voxel "
     "out of reach of all trees around it has label 0, and `info` counts these." EXACT_NOTE,
     "seed 100,100,50 1 radius=2"},
    {COMMAND("box", act_box, GROUP_SEEDS, R | S | E | P),
     {NEED("CORNER", VALUE_POSITION), NEED("OPPOSITE", VALUE_POSITION),
      NEED("LABEL", VALUE_LABEL, .most = 255), WITHIN, HOLLOW, EXACT},
     "plant a box, or a rectangle in a slice",
     "Between two corners, both included." WITHIN_NOTE "\n"
     "shell=yes: only its six faces, as in `seed`.\n"
     "around: the label of an enclosed object; by default that of its middle." EXACT_NOTE,
     "box 80,90,50 120,110,50 2"},
    {COMMAND("fill", act_fill, GROUP_SEEDS, R | S | E | P),
     {NEED("PLACE", VALUE_POSITION), NEED("LABEL", VALUE_LABEL, .most = 255), WITHIN,
      NEED("to", VALUE_LINE, .keyed = true), EXACT},
     "plant the inside of a polygon in a slice",
     "The voxels that the outline from PLACE over the other corners and back winds around, and the "
     "voxels whose centre it passes through. All corners are in one slice of any plane." WITHIN_NOTE
     "\nto: the other corners, at least two." EXACT_NOTE,
     "fill 80,90,50 2 to=120,90,50 to=100,110,50"},
    {COMMAND("outline", act_outline, GROUP_SEEDS, R | S | E | P),
     {NEED("PLACE", VALUE_POSITION), NEED("LABEL", VALUE_LABEL, .most = 255), WITHIN,
      NEED("to", VALUE_LINE, .keyed = true), KEYED("ring", VALUE_NUMBER, .most = RING_MOST),
      KEYED("instead", VALUE_NUMBER, .least = 1, .most = UINT32_MAX, .form = "N"), EXACT},
     "outline an object in a slice, with background",
     "`fill`, and a ring of background around it in the same slice: one marker for both sides of "
     "the border. Voxels of other objects are left out of the ring." WITHIN_NOTE
     " The ring is of all intensities.\n"
     "to: the other corners, at least two. A line of the journal has room for 3000.\n"
     "ring: its width in voxels, from centre to centre; 3 unless given, 0 for no ring, as for a "
     "polygon of background and with within=0.\n"
     "instead: the number of a marker, `marker=` of its record, to remove in the same undo step: "
     "an outline that was dragged." EXACT_NOTE,
     "outline 80,90,50 2 to=120,90,50 to=100,110,50"},
    {COMMAND("between", act_between, GROUP_SEEDS, R | S | E | P),
     {NEED("LABEL", VALUE_LABEL, .least = 1, .most = 255),
      KEYED("plane", VALUE_CHOICE, .choices = SLICE_WORDS),
      KEYED("over", VALUE_LABELS, .added = true), KEYED("keep", VALUE_LABELS)},
     "fill an object in the slices between outlines",
     "Outlines are exact gestures of the label in slices of one plane: `outline` and `fill` with "
     "within=0, or `seed-file` with within=0 of a map that has some slices only. In every slice "
     "between two outlined ones, however far apart, the border is interpolated by its distances; "
     "sections that overlap by less than half are moved towards each other first. Nothing is "
     "planted before the first and after the last outline. The voxels are one exact marker: "
     "`remove` it before `between` is repeated with other outlines. Voxels of an outline that a "
     "later marker covers do not count, and neither do single lines.\n"
     "plane: the plane of the outlines, if there are some in several.\n"
     "over, keep: fill only voxels whose label now is in the list, or is not, as in `outline`; "
     "over=0, the background, unless given, and added to the record.",
     "between 2"},
    {COMMAND("seed-file", act_seed_file, GROUP_SEEDS, R | S | E | P),
     {NEED("FILE", VALUE_FILE, .is_read = true), KEYED("label", VALUE_LABEL, .most = 255), WITHIN,
      KEYED("regions", VALUE_LIST, .most = UINT32_MAX), KEYED("as", VALUE_LIST, .most = UINT32_MAX),
      KEYED("erode", VALUE_NUMBER, .most = 9),
      KEYED("each", VALUE_NUMBER, .least = 1, .most = 100000),
      KEYED("generator", VALUE_NUMBER, .most = 99999), OF_MAP, EXACT},
     "plant the seeds of a .csv list or a label map",
     "A list has lines x,y,z,label: voxel indices, a label's number or name. A label map is a "
     "volume on the scene's grid, whose regions (voxels of one value) become seeds of the label of "
     "that number, or all of `label`." WITHIN_NOTE "\n"
     "regions: the values, 1 and above unless given, as in 1-90,2001.\n"
     "as: their labels, one for each of `regions`, as in regions=2001,2002 as=1,2: for atlases "
     "whose values are not labels.\n"
     "erode: rounds; each removes the voxels that have a face neighbour outside their region.\n"
     "each: the number of seeds drawn at random from each region after erosion; all unless given.\n"
     "generator: the number that the drawing starts from; 1 unless given." MAP_NOTE EXACT_NOTE,
     "seed-file aal.nii.gz label=1 regions=1-90 erode=2 each=3"},
    {CALLED("labels", "atlas|segmentation", act_labels, GROUP_SEEDS, R | S | E | P),
     {NEED("FILE", VALUE_FILE, .is_read = true, .choices = "here"),
      KEYED("regions", VALUE_LIST, .most = UINT32_MAX), KEYED("as", VALUE_LIST, .most = UINT32_MAX),
      KEYED("label", VALUE_LABEL, .least = 1, .most = 255), FINISHED,
      KEYED("erode", VALUE_NUMBER, .most = PIECE_ERODE_MOST, .added = true),
      KEYED("copy", VALUE_WORD, .is_kept = true, .form = "DIGEST", .added = true), OF_MAP,
      KEYED("numbers", VALUE_LIST, .least = 1, .most = UINT32_MAX, .added = true),
      KEYED("least", VALUE_NUMBER, .least = 1, .most = 1000000),
      KEYED("rest", VALUE_CHOICE, .choices = "background|none|keep")},
     "start from a segmentation, and correct it",
     "FILE is a label map of any program on the scene's grid. Its labels are reproduced exactly. "
     "Each piece of each label, and of the background, becomes a marker, all in one undo step. "
     "The outer voxels of a piece are its seeds; the inner voxels belong to it. Seeds, strokes, "
     "boxes and polygons of another label that are planted in a piece correct it: within three "
     "times their radius, or their `within`, its seeds are removed and the border is recomputed; "
     "beyond, the piece does not change.\n"
     "here: the present labels instead of a file, as if they had been saved and read, for exact "
     "corrections of objects that were grown. finished=yes: those after `finish`, at a prompt as "
     "shown unless given.\n"
     "The names and colours in a .seg.nrrd, .nii, .nii.gz or .mgz become those of labels that have "
     "none; the journal's copy keeps them.\n"
     "regions: the values of the map; all unless given. Other voxels are background.\n"
     "as: their labels, one for each of `regions`. Without it, a region is the label of its "
     "number, "
     "up to 4294967295; at most 255 labels exist at a time. A region is rejected if a label of its "
     "number was planted by other commands.\n"
     "label: one label for all regions except the background.\n"
     "erode: rounds, 0 unless given; each removes the voxels that have a face neighbour of "
     "another label, so that borders are recomputed. A piece that would vanish keeps its "
     "innermost voxels.\n"
     "copy: the digest of the journal's own copy of the labels, which makes FILE unnecessary; "
     "added to the record.\n"
     "numbers: the regions, if some of their numbers are above 255; added to the record.\n"
     "least: omit pieces of fewer voxels; the surrounding trees grow into them.\n"
     "rest: none leaves other voxels without seeds; the surrounding trees grow into them. keep "
     "puts "
     "the other regions out of the region of interest, and `save labels` writes them back "
     "unchanged: to correct some of many objects.\n"
     "resample=yes with a part of the scene, such as a corrected crop: voxels outside it keep "
     "their "
     "labels; without one they are background." MAP_NOTE,
     "labels model.nii.gz erode=3"},
    {CALLED("object", "threshold|grow|flood", act_object, GROUP_SEEDS, R | S | E | P),
     {NEED("LABEL", VALUE_LABEL, .most = 255), NEED("HOW", VALUE_CHOICE, .choices = "threshold"),
      NEED("RANGE", VALUE_INTERVAL), KEYED("from", VALUE_POSITION), EXACT},
     "plant the connected voxels within a range",
     "One marker of all voxels whose intensity, as printed by `why`, is in the range, and that are "
     "connected by faces to a seed of the label inside the range. Voxels with seeds of other "
     "labels are left out and block connections: a stroke of background cuts off a leak. Each "
     "object may have its own range. Its trees grow beyond the range, until they meet trees of "
     "other labels.\n"
     "from: begin with this voxel instead of the label's seeds." EXACT_NOTE,
     "object 2 threshold 226..3071"},
    {CALLED("remove", "delete|erase|eliminate|rm", act_remove, GROUP_SEEDS, R | S | E | P),
     {NEED("PLACE", VALUE_POSITION), BRUSH, KEYED("of", VALUE_CHOICE, .choices = "marker|tree")},
     "remove the marker of this voxel",
     "A marker consists of the seeds planted by one command: a ball, a stroke, a region of a file. "
     "Its seeds are removed, and the surrounding trees grow into its voxels; the seeds of an older "
     "marker below it are restored. Trees are those of the last run.\n"
     "of=tree: remove only the seed of the tree that contains the voxel, and restore no older "
     "seed.\n"
     "radius: remove all markers, or trees, with a voxel in this ball.",
     "remove 100,100,50"},
    {COMMAND("run", act_run, GROUP_SEEDS, R | S | E | P),
     {KEYED("for", VALUE_COMMAND, .form = "QUESTION")},
     "apply the waiting edits as one",
     "Edits wait while `auto` is off, the default in scripts. Commands that show, write or answer "
     "from labels apply them first: `render`, `spin`, `slice`, `mosaic`, `golden`, `save`, "
     "`stats`, `compare`, `hints`, `why` and `profile`. `pick`, `hint` and `zoom fit` use the "
     "last picture, and report edits that it does not include.\n"
     "for: the question that applied the edits; added to the record, since questions have no "
     "record of their own.",
     "run"},
    {COMMAND("undo", act_undo, GROUP_SEEDS, R | S | E),
     {MAY("COUNT", VALUE_NUMBER, .least = 1, .most = 1000000)},
     "undo the last change of the segmentation",
     "Undoes the last COUNT changes, 1 unless given: seeds and their removal, runs, weights, "
     "regions of interest, labels, `hide`, `show`, cuts and the finish, but not the view. Undo "
     "reaches back to `open`, also into earlier sessions. It is exact, and recorded. `redo` "
     "reverts it, `history` lists the commands.\n"
     "A command warns if a label loses more than 500 voxels, and the label that gains them grows "
     "by more than 1 % for each seed. The warning names the edge through which the label grew. New "
     "voxels as bright as the old ones, up to 3/2 of the former mean of a seed, cause no warning.",
     "undo"},
    {COMMAND("redo", act_redo, GROUP_SEEDS, R | S | E),
     {MAY("COUNT", VALUE_NUMBER, .least = 1, .most = 1000000)},
     "restore the change that was undone last",
     "A change that was undone before another command is not lost: `goto` returns to it.",
     "redo"},
    {COMMAND("goto", act_goto, GROUP_SEEDS, R | S | E),
     {NEED("PLACE", VALUE_POINT)},
     "restore the segmentation of a record or a branch",
     "PLACE is the number of a record, which `history` and `iftty log` print, or the name of a "
     "branch for its last record. The first branch is main.",
     "goto main"},
    {COMMAND("branch", act_branch, GROUP_SEEDS, R | S),
     {NEED("NAME", VALUE_WORD, .is_kept = true)},
     "begin a branch with a name at this point",
     "Later commands belong to it; `goto` changes to another branch.",
     "branch with-brainstem"},
    {COMMAND("view", act_view, GROUP_VIEW, R | S),
     {NEED("YAW", VALUE_DECIMAL, .choices = VIEW_NAMES, .least = -TURNS, .most = TURNS),
      MAY("PITCH", VALUE_DECIMAL, .least = -TURNS, .most = TURNS),
      MAY("ROLL", VALUE_DECIMAL, .least = -TURNS, .most = TURNS)},
     "set the view: a side, or angles in degrees",
     "0 0 0 is the front: the patient faces the viewer. Yaw moves the viewer around the patient, "
     "towards the patient's left; pitch moves the viewer upwards; roll turns the picture "
     "counter-clockwise. In front, back, left and right the head is up, in top and bottom the "
     "face. In the radiological convention, the patient's left is on the right of the picture "
     "from the front, as in coronal slices, and from the bottom, as in axial slices; from the "
     "back and the top it is on the left. `info` prints the sides of the present view.",
     "view 30 15 0"},
    {CALLED("turn", "rotate", act_turn, GROUP_VIEW, R | S),
     {NEED("YAW", VALUE_DECIMAL, .least = -TURNS, .most = TURNS),
      MAY("PITCH", VALUE_DECIMAL, .least = -TURNS, .most = TURNS),
      MAY("ROLL", VALUE_DECIMAL, .least = -TURNS, .most = TURNS)},
     "turn the view by degrees",

     "The angles are added to those of the view, which `info` prints.",

     "turn 15 -5"},
    {COMES_TO("zoom", "zoom", act_zoom, GROUP_VIEW, R | S),
     {NEED("FACTOR", VALUE_DECIMAL, .choices = "fit", .least = VIEW_ZOOM_LEAST,
           .most = VIEW_ZOOM_MOST),
      KEYED("at", VALUE_POSITION)},
     "set pixels per voxel, or fit",
     "FACTOR is for an axis of the smallest spacing; along other axes a voxel has more pixels.\n"
     "fit: the shown objects fill the picture at the current angles, with their middle in the "
     "centre; without objects, the scene does. The record contains the resulting zoom and place.\n"
     "at: the voxel in the centre.",
     "zoom 1.5"},
    {COMMAND("pan", act_pan, GROUP_VIEW, R | S),
     {NEED("RIGHT", VALUE_DECIMAL, .least = -PANS, .most = PANS),
      NEED("DOWN", VALUE_DECIMAL, .least = -PANS, .most = PANS)},
     "move the picture, in pixels",
     "Fractions of a pixel are allowed. `view`, `turn`, `zoom FACTOR` and `size` keep the new "
     "centre; `focus scene` resets it.",
     "pan 40 -12.5"},
    {COMMAND("focus", act_focus, GROUP_VIEW, R | S),
     {NEED("PLACE", VALUE_POSITION, .choices = "scene")},
     "set the place in the centre of the picture",
     "A voxel, or the centre of the scene. Views rotate around it.",
     "focus 100,100,50"},
    {COMMAND("hide", act_hide, GROUP_VIEW, R | S),
     {NEED("LABEL", VALUE_LABEL, .choices = "all", .least = 1, .most = 255)},
     "hide an object",

     "In pictures and in `save border`; the labels themselves do not change.\n"
     "all: later labels are hidden too, until `show` names them.",
     "hide 2"},
    {COMMAND("show", act_show, GROUP_VIEW, R | S),
     {NEED("LABEL", VALUE_LABEL, .choices = "all", .least = 1, .most = 255)},
     "show an object again",
     "all: every object. After `hide all`, `show LABEL` shows only this object.",
     "show 2"},
    {COMMAND("opacity", act_opacity, GROUP_VIEW, R | S),
     {NEED("LABEL", VALUE_LABEL, .choices = "all", .least = 1, .most = 255),
      NEED("PERCENT", VALUE_NUMBER, .most = 100)},
     "set the opacity of an object in renditions",
     "100, the default, shows only its surface. With less, surfaces inside and behind it shine "
     "through: at most 8 before the first opaque one. `pick`, and the label, voxel and depth of a "
     "pixel, belong to the surface with the largest share of its colour. 0 leaves the object out "
     "of renditions; slices still show it.",
     "opacity 1 30"},
    {COMMAND("clip", act_clip, GROUP_CUTS, R | S),
     {NEED("PLANE", VALUE_CHOICE, .choices = "axial|coronal|sagittal|none"),
      MAY("SLICES", VALUE_RANGE, .most = 65533)},
     "show only the slices from A to B",
     "The number of a slice is the index of its voxels along its axis, as in X,Y,Z and `slice`. A "
     "and B are included. Each PLANE has its own range; `none` shows all slices again. Borders, "
     "pictures and `save border` change, but no labels.",
     "clip axial 40-120"},
    {COMMAND("plane", act_plane, GROUP_CUTS, R | S),
     {NEED("PLACE", VALUE_POSITION, .choices = "none"),
      KEYED("normal", VALUE_WORD, .is_kept = true, .choices = VIEW_NAMES, .form = "A,B,C"),
      KEYED("offset", VALUE_DECIMAL, .least = -PLANE_OFFSET_MOST, .most = PLANE_OFFSET_MOST)},
     "cut away everything in front of a voxel",
     "The plane is at right angles to the present view and contains the voxel, which is kept. The "
     "plane moves with the patient when the view turns. Up to 8 planes; `none` removes them.\n"
     "normal: the direction of the part that is cut away, independent of the view: a side of the "
     "patient, or steps to the right, the front and the head (as A,B,C of the world, of any "
     "length): normal=left and normal=-1,0,0 cut away everything left of the voxel. Oblique axes "
     "are respected.\n"
     "offset: the distance from the voxel in that direction, in millimetres: offset=-5 cuts 5 mm "
     "deeper.",
     "plane 100,100,50 normal=1,1,0.5"},
    {COMMAND("cut", act_cut, GROUP_CUTS, R | S),
     {NEED("CORNER", VALUE_POSITION, .choices = "none"), PAIRED("OPPOSITE", VALUE_POSITION)},
     "cut a box out of the shown objects",
     "Between two corners, both included. Up to 8 boxes; `none` removes them.",
     "cut 100,100,50 199,199,99"},
    {CALLED("render", "draw|picture|screenshot|snapshot", act_render, GROUP_RENDITION,
            R | S | E | A),
     {MAY("FILE", VALUE_FILE), KEYED("mode", VALUE_CHOICE, .choices = "sp|bp|ii|ray"),
      YES_NO("replace"), KEYED("layout", VALUE_CHOICE, .choices = "lines|tiled"), FINISHED},
     "draw the rendition, in FILE or inline",
     ".exr holds colour, depth, label, voxel and normal of each pixel, in lines or tiled; .png "
     "and other formats of OpenImageIO hold the colours. At the prompt a file is written in the "
     "background; a line reports when it is finished. `iftty info FILE` prints the notes of a "
     "picture.\n"
     "All modes draw the same pixels: sp draws the surface in the order of the scene, bp from "
     "front to back without hidden voxels, ray along the ray of each pixel; ii updates only the "
     "outdated pixels of the last rendition." SHOWN_NOTE,
     "render brain.png"},
    {CALLED("spin", "turntable|movie|animate", act_spin, GROUP_RENDITION, R | S | E | A),
     {NEED("N", VALUE_NUMBER, .least = 2, .most = IMAGE_FRAMES_MOST), NEED("FILE", VALUE_FILE),
      KEYED("axis", VALUE_WORD, .is_kept = true, .choices = "yaw|pitch|roll", .form = "AXIS,AXIS"),
      YES_NO("fit"), KEYED("delay", VALUE_NUMBER, .least = 20, .most = 60000), YES_NO("replace"),
      FINISHED},
     "write a turntable: N pictures of one full turn",
     "The first picture shows the present view; the command does not change the view. %03d in "
     "FILE is replaced by the number of the picture, here with three digits, from 000. Without "
     "it, a .gif is animated, in 256 colours, with `delay` milliseconds for each picture, 100 "
     "unless given; a .tif has one page for each picture.\n"
     "axis: yaw, the default, turns around the patient, pitch over the head, and roll turns the "
     "picture, in the directions of `view`. Several axes give a turn of N pictures each, in this "
     "order; each turn begins with the present view, and numbers continue.\n"
     "fit=yes: use the largest zoom at which the shown objects fit all pictures." SHOWN_NOTE,
     "spin 36 turn%03d.png fit=yes"},
    {COMMAND("cross", act_cross, GROUP_SLICES, R | S | K),
     {NEED("PLACE", VALUE_POSITION)},
     "move the cross-hair, where the slices meet",
     "`open` sets it to the centre of the scene.",
     "cross 90,108,90"},
    {COMES_TO("cross", "hint", act_hint, GROUP_SLICES, R | S),
     {NEED("N", VALUE_NUMBER, .least = 1, .most = HINTS_MOST)},
     "move the cross-hair to a place of `hints`",
     "N is the number in that list. The record contains the resulting `cross`.",
     "hint 1"},
    {CALLED("window", "contrast|brightness|level", act_window, GROUP_SLICES, R | S),
     {NEED("LOW", VALUE_REAL, .choices = "auto"), PAIRED("HIGH", VALUE_REAL)},
     "set the intensities of black and white in slices",
     "Intensities, as printed by `why`: a window of width W at level L is from L - W/2 to L + "
     "W/2.\n"
     "auto, the default: all but the darkest 1 % and the brightest 0.5 % of the scene.",
     "window 20 90.5"},
    {COMMAND("magnify", act_magnify, GROUP_SLICES, R | S),
     {NEED("TIMES", VALUE_DECIMAL, .choices = "fit", .least = SLICE_TIMES_ONE,
           .most = SLICE_TIMES_MOST),
      KEYED("at", VALUE_POSITION)},
     "set the magnification of slices",
     "TIMES multiplies the fitting size, around the cross-hair; fit shows whole slices. Applies "
     "to slices and mosaics, until the next `magnify` or `slice zoom=`.\n"
     "at: keep this voxel in the middle while the cross-hair is visible.\n"
     "A voxel of four pixels or more is a square; smaller ones are smoothed.",
     "magnify 2.5 at=90,108,90"},
    {COMMAND("slice", act_slice, GROUP_SLICES, R | S | A),
     {NEED("PLANE", VALUE_CHOICE, .choices = SLICE_WORDS), MAY("N", VALUE_NUMBER, .most = 65533),
      MAY("FILE", VALUE_FILE),
      KEYED("zoom", VALUE_DECIMAL, .choices = "fit", .least = VIEW_ZOOM_LEAST,
            .most = VIEW_ZOOM_MOST),
      YES_NO("replace"), FINISHED},
     "draw a slice at the cross-hair, in FILE or inline",
     "Slices follow the radiological convention and have the size of the view. N moves the "
     "cross-hair to that slice: the index of its voxels along its axis, from 0, as in X,Y,Z "
     "(ITK-SNAP prints one more). If the orientation is unknown, slices are named by that axis: z "
     "for axial, y for coronal, x for sagittal.\n"
     "The name of FILE must contain a dot. An .exr also has the label and voxel of each pixel.\n"
     "zoom: pixels per voxel of the smallest spacing, around the cross-hair, with voxels as "
     "squares. It stays until zoom=fit, which shows the whole slice in smooth greys." SHOWN_NOTE,
     "slice axial 90 axial.png"},
    {CALLED("mosaic", "planes|slices", act_mosaic, GROUP_SLICES, R | S | A),
     {MAY("FILE", VALUE_FILE), YES_NO("replace"), FINISHED},
     "draw three slices and the rendition",
     "Coronal, sagittal and axial through the cross-hair at one scale, and the rendition of the "
     "view at half its size." SHOWN_NOTE,
     "mosaic brain.png"},
    {COMMAND("golden", act_golden, GROUP_KEPT, R | S | E | A),
     {NEED("NAME", VALUE_GOLDEN), KEYED("of", VALUE_CHOICE, .choices = "rendition|" SLICE_KINDS),
      FINISHED},
     "store a picture as a golden image",
     "The rendition, or a slice or mosaic as it would be shown now. `iftty verify` compares it "
     "pixel for pixel. It is stored in a folder next to the journal." SHOWN_NOTE,
     "golden front-1"},
    {CALLED("finish", "smooth|relax|clean", act_finish, GROUP_KEPT, R | S | C),
     {MAY("STEP", VALUE_CHOICE, .choices = FINISH_KINDS "|none"),
      KEYED("radius", VALUE_RADIUS, .most = FINISH_RADIUS_MOST),
      KEYED("voxels", VALUE_NUMBER, .least = 1, .most = 1000000000),
      KEYED("sweeps", VALUE_NUMBER, .least = 1, .most = FINISH_SWEEPS_MOST),
      KEYED("reach", VALUE_NUMBER, .least = 1, .most = FINISH_BAND_MOST),
      KEYED("label", VALUE_LABEL, .least = 1, .most = 255)},
     "smooth and clean labels in files and pictures",
     "Adds a step to the list, which `finished=yes` applies in order; without STEP, prints the "
     "list. The segmentation itself does not change, and seeds can be planted at any time. `relax` "
     "keeps voxels that have a seed; the other steps can change these too, also those of exact "
     "gestures. `save` and `stats` with finished=yes name the labels that the finish deletes, "
     "reduces to less than half or breaks into more pieces.\n" FINISH_NOTES
     "none: remove all steps.\n"
     "radius: voxels, 1 unless given, or millimetres as in 2.5mm, which respect the spacing.\n"
     "sweeps: of `relax`, 60 unless given.\n"
     "reach: of `relax`, voxels from a border within which labels move, 2 unless given. Up to 16 "
     "corrects coarser errors, and can smooth away an object of low contrast.\n"
     "label: for one label, instead of all.",
     "finish majority radius=1"},
    {CALLED("save", "export|write", act_save, GROUP_KEPT, R | S | E | A),
     {NEED("MAP", VALUE_CHOICE, .choices = MAPS "|seeds|names|surface"), NEED("FILE", VALUE_FILE),
      YES_NO("replace"), FINISHED, KEYED("label", VALUE_LABEL, .least = 1, .most = 255),
      KEYED("smooth", VALUE_NUMBER, .most = 100),
      KEYED("triangles", VALUE_NUMBER, .least = 4, .most = INT32_MAX), YES_NO("empty")},
     "write a map, surfaces, seeds or names of labels",
     "Writes a map as .nii, .nii.gz, .nrrd or .mha, in the geometry of the scene. Labels as "
     ".seg.nrrd, a segmentation of 3D Slicer, as .nii, .nii.gz or .mgz have the names and colours "
     "of labels.\n"
     "labels: uint8, or uint16 or uint32 for numbers above 255. A voxel that no seed "
     "reaches is 0; the answer has the number of these voxels.\n"
     "cost: uint16; 65535 in a voxel that no seed reaches.\n"
     "root: uint32, the voxel index of the seed; 4294967295 where no seed reaches.\n"
     "border: uint8, 1 in border voxels of shown objects.\n"
     "distance: uint16, the plateau distance: steps along the path since its cost last rose; 65535 "
     "where no seed reaches.\n"
     "margin: uint16, how much more the best path from a seed of another label would cost: 0 where "
     "another label reaches the voxel as cheaply, 65535 where no other label does. Its computation "
     "needs about the time of a run.\n"
     "seeds: all planted seeds, as FILE.csv, which `seed-file` reads.\n"
     "names: of labels, with their colours, in a format of `label-file`: .txt or .label for "
     "ITK-SNAP, .ctab for FreeSurfer, .ctbl for 3D Slicer, .tsv for BIDS, .nii.txt or .lut for "
     "mricron.\n"
     "surface: of each label, as .stl, .ply, .obj or .vtp, in millimetres of the world: the same "
     "surface as in pictures. It is closed, and has the volume of the voxels. A .stl has no "
     "labels: it contains all of them as one.\n"
     "label: write the surface of this label only.\n"
     "smooth=0: the faces of voxels, as `shade cubes` shows them; other numbers have no effect.\n"
     "triangles: the largest number of triangles, exceeded only if surfaces would not be closed. "
     "The surfaces of touching labels then share no points.\n"
     "empty=yes: write labels even if no voxel has one." FINISHED_NOTE,
     "save labels brain-labels.nii.gz"},
    {COMMAND("journal", act_journal, GROUP_KEPT, 0),
     {MAY("FILE", VALUE_FILE)},
     "print the journal's file, or continue in another",
     "The whole journal so far is written to FILE first, with its golden images and copies of "
     "labels next to it, so that it replays alone; later commands are recorded there. The former "
     "file is left in its last intact state. Use it if the disk is full or failing, or the "
     "journal was deleted, replaced, or opened with --read-only. Not recorded.",
     "journal"},
    {COMMAND("sync", act_sync, GROUP_KEPT, 0),
     {MAY("WHEN", VALUE_CHOICE, .choices = FILE_SYNC_WORDS)},
     "set when records are synced; sync them now",
     "always, the default: each record before its command is acknowledged.\n"
     "everysec: at most a second later; a loss of power may lose the commands of that second.\n"
     "off: when the operating system decides, by `sync`, and at the end; a loss of power may lose "
     "all commands since then, and leave a damaged end, which `iftty log --repair` cuts off.\n"
     "Killing the program loses no record in any mode. Not recorded.",
     "sync always"},
    {COMMAND("history", act_history, GROUP_QUESTIONS, S),
     {MAY("COUNT", VALUE_NUMBER, .least = 1, .most = 1000000)},
     "list commands that can be undone, and branches",
     "The last COUNT, 20 unless given, with the numbers of their records. * marks the present "
     "state.",
     "history"},
    {COMMAND("pick", act_pick, GROUP_QUESTIONS, S),
     {NEED("COLUMN", VALUE_NUMBER, .most = VIEW_SIDE_MOST),
      NEED("ROW", VALUE_NUMBER, .most = VIEW_SIDE_MOST),
      KEYED("of", VALUE_CHOICE, .choices = "rendition|" SLICE_KINDS)},
     "print the voxel under a pixel of a picture",
     "Of the last rendition, or of a slice or mosaic as it would be shown now. Columns from the "
     "left, rows from the top, both from 0.\n"
     "Prints the position of the voxel, in voxels and millimetres, its intensity, its label and "
     "seed, and the distance to the border of its object: to the nearest voxel of its label with "
     "a face on another label or on the edge of the scene, hidden objects included. The search "
     "ends at 100 mm or 100 voxels.",
     "pick 256 256"},
    {CALLED("measure", "distance|ruler|length", act_measure, GROUP_QUESTIONS, S),
     {NEED("PLACE", VALUE_POSITION), NEED("OTHER", VALUE_POSITION), MAY("THIRD", VALUE_POSITION)},
     "measure a distance, or an angle, between voxels",
     "Between their centres, in millimetres and in voxels. With a THIRD, also the angle at OTHER.",
     "measure 10,20,30 40,20,30"},
    {COMMAND("profile", act_profile, GROUP_QUESTIONS, S | A),
     {NEED("PLACE", VALUE_POSITION), NEED("OTHER", VALUE_POSITION), YES_NO("values")},
     "plot the intensities along a straight line",
     "A chart of the voxels of a stroke of radius 0, with their labels below it: a digit, + for a "
     "label above 9, and . where no seed reaches. A column of several voxels shows their mean.\n"
     "values=yes: each voxel in a line: its distance, its place, its intensity and its label.",
     "profile 10,20,30 40,20,30"},
    {COMMAND("why", act_why, GROUP_QUESTIONS, S | A),
     {NEED("PLACE", VALUE_POSITION)},
     "explain the label of a voxel",
     "Prints the seed at the start of the voxel's path, the cost of the path, and the edges where "
     "the cost rose, the strongest first: a leak passes through that edge, and a seed or a shell "
     "there stops it. Also prints the second label with the cost of its path.",
     "why 100,100,50"},
    {COMMAND("hints", act_hints, GROUP_QUESTIONS, S | A),
     {MAY("COUNT", VALUE_NUMBER, .choices = "slice", .least = 1, .most = HINTS_MOST),
      KEYED("label", VALUE_LABEL, .most = 255), KEYED("report", VALUE_FILE), YES_NO("replace")},
     "list the least certain places of borders",
     "Prints the first COUNT places, 10 unless given, the least certain first: the size of each, "
     "the cost of its least certain voxel, the neighbouring label with its cost there, the edge "
     "between the two, and the strongest edge on the path to the voxel.\n"
     "The certainty of a border voxel is the additional cost of the other label, plus the height "
     "of the edge above the cost of its own path three steps before. The least certain tenth of "
     "the border is weak; a connected weak part in a block of 16 voxels a side is a place, and "
     "places with the most and the weakest voxels come first. The search needs about the time of a "
     "run, and none if nothing has changed since.\n"
     "slice: instead of places, the five slices of all three planes with the largest doubt: the "
     "sum of 4u(1 - u) over their voxels, where u is the label after `finish relax`, 1 inside and "
     "0 outside. An `outline` in the first slice removes most doubt. Slices with an outline, and "
     "their neighbours, are left out.\n"
     "In a journal of `iftty apply`, places of the label whose volume differs most from the "
     "procedure's come first.\n"
     "label: only places at the border of this label, or slices by the doubt of this label.\n"
     "report: write all places as FILE.json.",
     "hints 5"},
    {CALLED("info", "status|header|histogram", act_info, GROUP_QUESTIONS, 0),
     {{0}},
     "describe scene, view, journal and memory",
     NULL,
     "info"},
    {CALLED("stats", "statistics|volume|volumes|components|count", act_stats, GROUP_QUESTIONS,
            S | A),
     {KEYED("report", VALUE_FILE), YES_NO("replace"), FINISHED},
     "measure size, surface and intensities of labels",
     "For each label: seeds, voxels and volume; components, connected by faces, and enclosed "
     "holes; the area of the smooth surface, to 2 % unless the object is small or thin; the centre "
     "and the bounding box; the intensities of its voxels, as printed by `why`; and the voxels "
     "gained and lost by the last edit. The deviation is that of a sample.\n"
     "Labels that have a name, or that the finish deletes, are listed even with 0 voxels.\n"
     "report: write the same as FILE.json or FILE.csv." FINISHED_NOTE,
     "stats"},
    {CALLED("compare", "dice|overlap", act_compare, GROUP_QUESTIONS, S | A),
     {NEED("FILE", VALUE_FILE, .is_read = true), KEYED("regions", VALUE_LIST, .most = UINT32_MAX),
      KEYED("as", VALUE_LIST, .least = 1, .most = UINT32_MAX),
      KEYED("label", VALUE_LABEL, .least = 1, .most = 255), KEYED("at", VALUE_POSITION),
      KEYED("report", VALUE_FILE), KEYED("picture", VALUE_FILE), KEYED("surface", VALUE_FILE),
      YES_NO("replace"), FINISHED, OF_MAP},
     "compare the labels with a label map",
     "A: the present labels. B: the map, on the scene's grid. For each label, and all labels "
     "together:\n"
     "Dice: twice the voxels of A and B, divided by those of A plus those of B; 1 if equal.\n"
     "Jaccard: the voxels of A and B, divided by the voxels of A or B.\n"
     "Hausdorff: the largest distance from a voxel of one to the nearest of the other, in mm.\n"
     "95 %, mean: 95th percentile and mean of the distances from each surface to the other, in mm. "
     "A surface is the voxels that have a neighbour outside the object, by a face, an edge or a "
     "corner, but not the edge of the scene.\n"
     "Overlaps, Hausdorff and the directed means in a report equal those of ITK's filters.\n"
     "regions: compare these values of the map, 1 and above unless given. These values and named "
     "labels have a row even if no voxel has them.\n"
     "as: their labels, one for each of `regions`.\n"
     "label: compare only this label, with all `regions` as one.\n"
     "report: write FILE.json or FILE.csv.\n"
     "picture: draw slices through the voxel `at`, or the place of the largest distance, with "
     "outlines: white for A and B, orange for A alone, blue for B alone, purple for another "
     "label.\n"
     "surface: draw A's surface in the present view, all objects as one: red outside B, blue "
     "inside, by the distance to B's surface." FINISHED_NOTE MAP_NOTE,
     "compare expert.nii.gz picture=difference.png"},
    {COMMAND("pilot", act_pilot, GROUP_QUESTIONS, S),
     {{0}},
     "segment by single keys, on the whole screen",
     "Shows slices, the rendition and a cross-hair. ? lists the keys, q returns to the prompt. A "
     "key that changes the session runs a command, which is recorded. After `labels` the brush is "
     "exact: it plants with within=0. Needs a terminal; Ctrl-O at the prompt does the same.",
     "pilot"},
    {COMMAND("help", act_help, GROUP_QUESTIONS, 0),
     {MAY("COMMAND", VALUE_COMMAND, .choices = "keys|correct")},
     "print this list, help of a command, or the keys",
     "keys: list the keys of the prompt.\n"
     "correct: show how to correct a segmentation of another program.",
     "help seed"},
    {CALLED("quit", "exit|bye|q|logout", act_quit, GROUP_QUESTIONS, 0),
     {{0}},
     "end the session; the journal is complete",
     NULL,
     "quit"},
};

/* Indented lines are commands, those with a $ commands of the shell. */
static const char recipes[] =
    "Correct a segmentation: `labels FILE` loads it, and each piece becomes a marker.\n"
    "The commands below change only voxels of the named labels, `undo` reverts one,\n"
    "`save labels` writes the map. In a session grown from seeds, first type\n"
    "`labels here`; without `over` and `within=0`, seeds grow, and move borders.\n\n"
    "Erase label 5 in a ball where it leaked; other labels stay:\n"
    "    seed 60,108,90 0 radius=5 within=0 over=5\n"
    "Paint label 5 into the background alone, by ball or outline:\n"
    "    seed 60,108,90 5 radius=5 within=0 over=0\n"
    "    outline 60,90,50 5 to=70,90,50 to=65,99,50 within=0 over=0\n"
    "Grow label 5 over background alone, up to the edges of the scene:\n"
    "    seed 60,108,90 5 radius=2 within=9 over=0\n"
    "Split two touching objects of label 7 by a ball in each; their outline stays:\n"
    "    seed 40,108,90 7 radius=2 over=7\n"
    "    seed 60,108,90 8 radius=2 over=7\n"
    "Swap labels 3 and 4 of the file:\n"
    "    labels model.nii.gz regions=3,4 as=4,3 rest=none\n"
    "Merge labels 17 and 53 of the file into 11 and 5:\n"
    "    labels model.nii.gz regions=17,53 as=11,5 rest=none\n"
    "Give a piece of label 5 to label 3, by a box around it:\n"
    "    box 27,30,40 34,38,52 3 within=0 over=5\n"
    "Draw a new object without changing others, or all but label 2:\n"
    "    seed 70,100,88 9 radius=4 within=0 over=0\n"
    "    seed 70,100,88 9 radius=4 within=0 keep=2\n"
    "Start from an atlas: carry its labels to another head, where borders are\n"
    "recomputed, and correct them there by balls, which grow:\n"
    "    $ iftty -c 'open head.nii.gz; labels atlas.nii.gz' --journal head.iftty\n"
    "    $ iftty apply head.iftty other.nii.gz\n"
    "    $ iftty other.iftty\n"
    "An atlas that lies on the scene already: keep the inside of its regions:\n"
    "    labels atlas.nii.gz erode=2 resample=yes\n"
    "Touching objects without a map: a ball in each, and one sphere around all:\n"
    "    seed 40,108,90 1 radius=3\n"
    "    seed 60,108,90 2 radius=3\n"
    "    seed 50,108,90 0 radius=30 shell=yes\n";

const char *command_page(const char *name)
{
    return strcmp(name, "correct") == 0 ? recipes : NULL;
}

enum { COMMANDS = sizeof command_table / sizeof *command_table };

/* ---- with those of settings ---- */

unsigned command_count(void)
{
    unsigned settings = 0;
    while (setting_table[settings].name)
        settings++;
    return COMMANDS + settings;
}

const struct command *command_at(unsigned number)
{
    return number < COMMANDS ? &command_table[number] : &setting_table[number - COMMANDS];
}
