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
    "With each of these methods, an intensity edge of height h has the weight h (polarity: if "    \
    "PERCENT is 0). Lengths are in voxels and ignore the spacing.\n" WEIGHT_NOTES                  \
    "FILE: a map on the scene's grid, with the weight "                                            \
    "of each voxel as an integer 0..65535." MAP_NOTE
#define OPENING_NOTE                                                                               \
    "series: select a DICOM series of a folder by its number, from 1, or a part of its "           \
    "description, as in series=t1_mprage. Without it, a folder with several series is rejected, "  \
    "and they are listed. The record has the number.\n"                                            \
    "data: the name of the data set in an HDF5 file.\n"                                            \
    "missing: blank inserts a blank slice for each missing slice of a DICOM series.\n"             \
    "skip: do not read these files of a folder, as in skip=IM0004,IM0007.\n"                       \
    "size, type, endian, offset: describe raw:FILE, voxels without a header, x fastest, as in "    \
    "`open raw:skull.raw size=512,512,400 type=int16`. endian is the byte order, by default "      \
    "little; offset is the number of bytes before the first voxel, by default 0.\n"                \
    "spacing: X,Y,Z in mm, for a file without spacing.\n"                                          \
    "private: yes omits the file names of scene and journal from pictures. Folders are never "     \
    "named in pictures.\n"                                                                         \
    "straighten: yes shifts the sheared slices of a tilted gantry in their planes, so that axes "  \
    "are perpendicular. It is applied after crop and reduce.\n"                                    \
    "weight: the initial arc weights, as in weight=gauss:1.5 (`help weight`); the default is "     \
    "morph. Records contain the weight even if it was not given."
#define VOLUME_SERIES_NOTE "volume: select a volume of a 4-D file, from 0; required there.\n"
#define PART_NOTE                                                                                  \
    "crop: load only a box, from the first to the last voxel along x, y and z, as in "             \
    "0-99,40-159,0-79. Memory is allocated only for the box, and its first voxel is 0,0,0.\n"      \
    "reduce: replace each cube of N x N x N voxels by their mean, after crop. In maps on the "     \
    "grid of the whole file, the cube is replaced by its middle voxel.\n"                          \
    "huge: yes accepts a small file that declares gigabytes of voxels in its header."
#define SYNTHETIC_NOTE                                                                             \
    "synth:geom is a synthetic scene of 200x200x100 voxels. XYZ are three digits, 1 or 2, as in "  \
    "synth:geom:221; a 2 interpolates the n voxels of an axis to 2n-1. SIZE is the size of a "     \
    "scene with the same solids, as in synth:geom:1024x1024x1024. The memory for a large scene "   \
    "is reported before it is loaded; a scene that does not fit is rejected."

enum { PLANE_OFFSET_MOST = 1000000 }; /* thousandths of a millimetre */
enum { VOLUMES_MOST = 65535 };

/* First members of a row, on one line. */
#define COMMAND(NAME, ACT, GROUP, FLAGS)        NAME, NULL, NULL, ACT, GROUP, FLAGS
#define CALLED(NAME, ALSO, ACT, GROUP, FLAGS)   NAME, ALSO, NULL, ACT, GROUP, FLAGS
#define COMES_TO(WHAT, NAME, ACT, GROUP, FLAGS) NAME, NULL, WHAT, ACT, GROUP, FLAGS

/* Parameters: name, type, and .choices, .least and .most as the type requires. */
#define PARAMETER(...)                                                                             \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define NEED(...)    PARAMETER(__VA_ARGS__, .optional = false)
#define MAY(...)     PARAMETER(__VA_ARGS__, .optional = true)
#define KEYED(...)   PARAMETER(__VA_ARGS__, .optional = true, .keyed = true)
#define PAIRED(...)  PARAMETER(__VA_ARGS__, .optional = true, .paired = true)

#define YES_NO(name) KEYED(name, VALUE_CHOICE, .choices = "yes|no")

/* Parameters shared by all commands that plant. */
#define BRUSH  KEYED("radius", VALUE_RADIUS, .most = 32)
#define WITHIN KEYED("range", VALUE_INTERVAL)
#define WITHIN_NOTE                                                                                \
    "\nrange: plant only voxels whose intensity, as printed by `why`, is from LOW to HIGH; in "    \
    "2:LOW..HIGH, the intensity in channel 2, whichever channel is shown."

/* Parameters of exact gestures. */
#define OVER  KEYED("over", VALUE_LABELS), KEYED("keep", VALUE_LABELS)
#define EXACT KEYED("within", VALUE_NUMBER, .most = 0, .form = "0"), OVER
#define EXACT_NOTE                                                                                 \
    "\nwithin=0: exact: these voxels get the label, and nothing grows from them.\n"                \
    "over, keep: with within=0, change only voxels whose label, before `finish`, is in over=, or " \
    "not in keep=, as in over=0,3-7,spleen. Later edits do not change this choice."

/* Parameters of shells. */
#define HOLLOW                                                                                     \
    KEYED("shell", VALUE_CHOICE, .choices = "yes"), KEYED("around", VALUE_LABEL, .most = 255)

/* Parameters for finished labels. */
#define FINISHED      YES_NO("finished")
#define LEFT_NOTE     "\nfinished=yes: use finished labels (`help finish`)"
#define SHOWN_NOTE    LEFT_NOTE "; by default, the setting `finished` decides."
#define FINISHED_NOTE LEFT_NOTE "; the default is no, or at a prompt the setting `finished`."

/* Parameters shared by all commands that read a map. */
#define OF_VOLUME                                                                                  \
    YES_NO("resample"), KEYED("volume", VALUE_NUMBER, .most = VOLUMES_MOST),                       \
        KEYED("data", VALUE_WORD, .form = "NAME")
#define OF_MAP OF_VOLUME, KEYED("threshold", VALUE_DECIMAL, .least = 1, .most = 1000)
#define MAP_NOTE                                                                                   \
    "\nresample: yes resamples a map from another grid, by nearest neighbour. Without it, a map "  \
    "that is displaced by more than half a voxel is rejected.\n"                                   \
    "volume, data: select a volume or data set of the file, as in `open`.\n"                       \
    "threshold: the least fraction of a voxel in a segment, for fractional segments of DICOM."

/* Parameters of weights. */
#define MAY_WEIGH(name, type, low, high)   MAY(name, VALUE_##type, .least = low, .most = high)
#define KEYED_WEIGH(name, type, low, high) KEYED(name, VALUE_##type, .least = low, .most = high)

const struct parameter weight_parameter[] = {WEIGHT_ARGUMENTS(MAY_WEIGH, KEYED_WEIGH)};

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
     "interpolate axes from n to 2n-1 voxels",
     "X, Y and Z are 2 for an axis to interpolate, otherwise 1. A new voxel is the mean of its two "
     "neighbours, rounded up. The spacing is halved, and voxel 0,0,0 keeps its place in the world. "
     "Not allowed after the first seed, or with a mask, a cut or weights from a file.",
     "interpolate 2 2 1"},
    {COMMAND("orient", act_orient, GROUP_SCENE, R | S),
     {NEED("HOW", VALUE_WORD, .is_kept = true, .choices = "file|sform|qform")},
     "set the orientation of the axes",
     "HOW is three letters, as in LPI: the sides of the patient towards which x, y and z increase, "
     "R or L, A or P, S or I. Use them if a file has no orientation or a contradictory one; "
     "pictures then contain a note that the user has set the orientation. sform and qform select "
     "one of the two orientations of a NIfTI file; file restores the orientation of the file.\n"
     "A wrong orientation can swap left and right in every picture and report. Saved maps always "
     "have the geometry of the scene's file.",
     "orient RAS"},
    {COMMAND("landmark", act_landmark, GROUP_SCENE, R | S),
     {NEED("NAME", VALUE_WORD, .is_kept = true), NEED("PLACE", VALUE_POSITION, .choices = "none")},
     "set an anatomical landmark of the scene",
     "A landmark is a place that exists in all subjects, such as the anterior commissure. `iftty "
     "apply --by landmarks` transfers a procedure between two scenes by the landmarks that both "
     "have. X,Y,Z is a voxel; `none` removes it. A scene has up to 64; `info` lists them.",
     "landmark AC 90,128,72"},
    {COMMAND("origin", act_origin, GROUP_SCENE, R | S),
     {NEED("PROCEDURE", VALUE_WORD, .is_kept = true),
      KEYED("digest", VALUE_WORD, .is_kept = true, .form = "SHA256"),
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
     "digest: the digest of the procedure, which `iftty log --procedure` writes.\n"
     "by, as: the options --by and --as of `iftty apply`.\n"
     "pull: twelve numbers, the rows of a 3x4 matrix. It maps world coordinates of this scene, in "
     "millimetres to the right, front and head, to those of the procedure's scene.\n"
     "scene, from: the digests of this scene and of the procedure's.\n"
     "rms: the root mean square error of landmarks, in mm.\n"
     "gate: the allowed deviation of intensities, in percent of the range between percentiles 10 "
     "and 90 of the procedure's object.\n"
     "depth: the largest erosion of labels, in mm.\n"
     "volumes: the volume of each label in the procedure, in mm3 of this scene. `hints` begins "
     "with the label whose volume differs most.\n"
     "dropped: N/OF for each label: N of its OF seeds were not planted because of their "
     "intensities.",
     "origin 74120d6c3f0cc54e2237dc0bced98ab5 by=world as=labels"},
    {COMMAND("weight", act_weight, GROUP_WEIGHT, R | S | E | C),
     {NEED("FILE", VALUE_FILE, .is_read = true, .choices = WEIGHT_KINDS),
      WEIGHT_ARGUMENTS(MAY_WEIGH, KEYED_WEIGH), OF_VOLUME},
     "set arc weights, the costs of steps between voxels",
     WEIGHT_DETAIL,
     "weight gauss 1.5"},
    {COMMAND("channel", act_channel, GROUP_WEIGHT, R | S | E | C),
     {NEED("FILE", VALUE_FILE, .is_read = true, .is_channel = true, .choices = "1|2|3|4|5|6|7|8"),
      KEYED("percent", VALUE_NUMBER, .most = PERCENT_MOST),
      KEYED("name", VALUE_WORD, .form = "NAME"), YES_NO("remove"), OF_VOLUME},
     "add a channel: further intensities of each voxel",
     "FILE is a volume on the scene's grid, such as another sequence or phase of the same patient. "
     "The scene itself is channel 1, and files become channels 2, 3 and so on. The weight of a "
     "voxel is then the greatest of its weights in all channels, and `finish relax` moves borders "
     "to the strongest edge. With the number of a channel instead of FILE, its settings change.\n"
     "percent: scale the weights of the channel, 0..1000; the default is 100. A channel of 0 is "
     "only shown.\n"
     "name: a name for the channel.\n"
     "remove=yes: remove the channel; later ones move up.\n"
     "`show-channel` shows a channel in slices. Weights must be gradients." MAP_NOTE,
     "channel flair.nii.gz name=FLAIR"},
    {COMMAND("polarity", act_polarity, GROUP_WEIGHT, R | S | E | C),
     {NEED("LABEL", VALUE_LABEL, .most = 255),
      NEED("PERCENT", VALUE_NUMBER, .least = -POLARITY_MOST, .most = POLARITY_MOST)},
     "prefer edges to darker or to brighter voxels",
     "Under `weight polarity`, paths from the seeds of the label pay PERCENT more for a step to a "
     "darker voxel and PERCENT less for a step to a brighter voxel. Use a positive number for an "
     "object brighter than its surroundings, and a negative one for a darker object. PERCENT is "
     "-100..100, by default 0.",
     "polarity 1 50"},
    {CALLED("mask", "roi", act_mask, GROUP_WEIGHT, R | S | E),
     {NEED("FILE", VALUE_FILE, .is_read = true, .choices = "none"),
      KEYED("regions", VALUE_RANGE, .most = REGION_MOST), OF_MAP},
     "restrict trees to the voxels of a map",
     "FILE is a map on the scene's grid. Trees grow only where its value is in `regions`; the "
     "default is 1 and above. If a `range` is also set, both restrict the trees. A mask does not "
     "change arc weights." MAP_NOTE,
     "mask brain.nii.gz regions=1-90"},
    {COMMAND("range", act_range, GROUP_WEIGHT, R | S | E),
     {NEED("LOW", VALUE_INTERVAL, .form = "LOW", .choices = "none"), PAIRED("HIGH", VALUE_REAL)},
     "restrict trees to a range of intensities",
     "Trees grow only where the intensity, as printed by `why`, is from LOW to HIGH. Both are "
     "numbers of up to 19 digits, as in 1.5e-3, and are compared with the values of the file. If "
     "one of the scene's 16-bit levels contains LOW or HIGH, the answer has the number of voxels "
     "of this level. `range 2:LOW..HIGH` uses channel 2, whichever is shown. If a `mask` is also "
     "set, both restrict the trees.",
     "range 40 1200.5"},
    {CALLED("label", "name|colour|color", act_label, GROUP_SEEDS, R),
     {NEED("LABEL", VALUE_LABEL, .most = 255, .makes = true),
      NEED("NAME", VALUE_WORD, .is_kept = true), MAY("COLOUR", VALUE_COLOUR),
      KEYED("number", VALUE_NUMBER, .least = 1, .most = UINT32_MAX, .form = "N"),
      KEYED("code", VALUE_WORD, .is_code = true, .choices = "none", .form = "SCHEME:VALUE")},
     "set the name, colour and code of a label",
     "Label 0 is the background. Quote a name of several words, as in \"left hemi\".\n"
     "LABEL may be a new number up to 4294967295; at most 255 labels exist at a time. Once a "
     "session has a label above 255, made here or read by `labels`, other commands accept only "
     "labels that exist: make a new one by `label` first.\n"
     "number: give the label another number.\n"
     "code: the meaning of the label in a terminology, SCHEME:VALUE[:MEANING], which `save labels` "
     "writes to DICOM SEG and .seg.nrrd as an anatomical structure; none removes it.",
     "label 2 cerebellum #40c060 code=SCT:113305005"},
    {COMMAND("label-file", act_label_file, GROUP_SEEDS, R),
     {NEED("FILE", VALUE_FILE, .is_read = true), KEYED("regions", VALUE_LIST, .most = UINT32_MAX),
      KEYED("as", VALUE_LIST, .least = 1, .most = UINT32_MAX)},
     "read names and colours of labels from a table",
     "FILE is a label description of ITK-SNAP, a colour table of FreeSurfer or 3D Slicer, a "
     "dseg.tsv of BIDS, or the .nii.txt or .lut of an atlas of mricron. The number of an entry is "
     "its label; label 0 does not change. These tables have no codes. `save names` writes them.\n"
     "regions: read only the entries with these numbers.\n"
     "as: the labels of `regions`, one for each.",
     "label-file aal.nii.txt regions=1-90"},
    {CALLED("seed", "plant|paint|foreground", act_seed, GROUP_SEEDS, R | S | E | P | K | C),
     {NEED("PLACE", VALUE_POSITION), NEED("LABEL", VALUE_LABEL, .most = 255),
      KEYED("radius", VALUE_RADIUS, .most = BRUSH_HOLLOW_REACH_MOST), WITHIN,
      KEYED("to", VALUE_LINE), KEYED("joined", VALUE_CHOICE, .choices = "yes"), HOLLOW,
      KEYED("through", VALUE_POSITION), KEYED("within", VALUE_RADIUS, .most = REACH_MOST), OVER},
     "plant a seed, a ball of seeds, or a stroke",
     "Replaces seeds that these voxels already have.\n"
     "radius: in voxels, or in millimetres as in 2.5mm; the default is 0, one voxel. The most is "
     "128 voxels, or 512 with shell=yes. A ball in millimetres is round, for any "
     "spacing." WITHIN_NOTE
     "\nto: plant a stroke, a ball at each step of the line from X,Y,Z to this corner. Repeat to= "
     "for further corners.\n"
     "joined=yes: continue the stroke of the previous command, with the same label, as one marker "
     "and one undo step. Use it for a stroke that is too long for one line of the journal.\n"
     "shell=yes: plant only the shell of the ball, the voxels with a neighbour outside it, to "
     "enclose objects. Voxels of other objects are left out. The enclosed objects are `around` and "
     "each object whose seeds are all inside: the shell is the same if it is planted before the "
     "balls in these objects or after them.\n"
     "around: the label of an enclosed object, by default the label in the middle of the shell.\n"
     "through: a voxel on the shell, instead of `radius`.\n"
     "within: the reach of the ball's trees: they do not grow beyond this distance from X,Y,Z, in "
     "voxels or millimetres, so that a correction changes nothing farther away. A good value is "
     "three times the depth of the error. A voxel that is beyond the reach of all trees around it "
     "has label 0; `info` prints the number of such voxels." EXACT_NOTE
     "\nA ball with over or keep, but without within=0, grows if radius or `within` is given: its "
     "tree changes only voxels of these labels, up to `within`, by default three times the radius, "
     "but at least 2 voxels and at most 10 beyond the ball.",
     "seed 100,100,50 1 radius=2"},
    {COMMAND("box", act_box, GROUP_SEEDS, R | S | E | P),
     {NEED("CORNER", VALUE_POSITION), NEED("OPPOSITE", VALUE_POSITION),
      NEED("LABEL", VALUE_LABEL, .most = 255), WITHIN, HOLLOW, EXACT},
     "plant a box, or a rectangle in a slice",
     "The box has these two corners, both included." WITHIN_NOTE "\n"
     "shell=yes: plant only the six faces of the box, as in `seed`.\n"
     "around: the label of an enclosed object, by default the label in the middle of the "
     "shell." EXACT_NOTE,
     "box 80,90,50 120,110,50 2"},
    {COMMAND("fill", act_fill, GROUP_SEEDS, R | S | E | P),
     {NEED("PLACE", VALUE_POSITION), NEED("LABEL", VALUE_LABEL, .most = 255), WITHIN,
      NEED("to", VALUE_LINE, .keyed = true), EXACT},
     "plant the inside of a polygon in a slice",
     "The corners are the first X,Y,Z and each `to`, all in one slice. Plants the voxels whose "
     "centre is inside the polygon, by the nonzero winding rule, or on its outline." WITHIN_NOTE
     "\nto: a further corner; there are at least two." EXACT_NOTE,
     "fill 80,90,50 2 to=120,90,50 to=100,110,50"},
    {COMMAND("outline", act_outline, GROUP_SEEDS, R | S | E | P),
     {NEED("PLACE", VALUE_POSITION), NEED("LABEL", VALUE_LABEL, .most = 255), WITHIN,
      NEED("to", VALUE_LINE, .keyed = true), KEYED("ring", VALUE_NUMBER, .most = RING_MOST),
      KEYED("instead", VALUE_NUMBER, .least = 1, .most = UINT32_MAX, .form = "N"), EXACT},
     "outline an object in a slice, with background",
     "Fills a polygon as `fill` does, and plants a ring of background around it in the same slice. "
     "Polygon and ring are one marker. The ring leaves out voxels of other objects." WITHIN_NOTE
     " It does not apply to the ring.\n"
     "to: a further corner; there are at least two, and at most about 3000.\n"
     "ring: the width of the ring in voxels; ring=0 plants none. The default is 3, or 0 with "
     "within=0. A polygon of background has no ring, nor has one with over or keep.\n"
     "instead: remove this marker in the same undo step; N is the number after `marker=` in its "
     "record. The pilot replaces an outline in this way when it is dragged." EXACT_NOTE,
     "outline 80,90,50 2 to=120,90,50 to=100,110,50"},
    {COMMAND("between", act_between, GROUP_SEEDS, R | S | E | P),
     {NEED("LABEL", VALUE_LABEL, .least = 1, .most = 255),
      KEYED("plane", VALUE_CHOICE, .choices = SLICE_WORDS),
      KEYED("over", VALUE_LABELS, .added = true), KEYED("keep", VALUE_LABELS)},
     "fill an object in the slices between outlines",
     "Outlines are exact gestures of the label in slices of one plane: `outline` and `fill` with "
     "within=0, or `seed-file` with within=0 and a map that has the label in some slices only. In "
     "every slice between two outlined ones, however far apart, the border is interpolated by its "
     "distances; sections that overlap by less than half are moved towards each other first. "
     "Nothing is planted before the first and after the last outline. The voxels are one exact "
     "marker: `remove` it before `between` is repeated with other outlines. Voxels of an outline "
     "that a later marker covers are ignored, and so are outlines that are only a line.\n"
     "plane: the plane of the outlines, required if they are in several planes.\n"
     "over, keep: as in `outline`. The default, over=0, is added to the record.",
     "between 2"},
    {COMMAND("seed-file", act_seed_file, GROUP_SEEDS, R | S | E | P),
     {NEED("FILE", VALUE_FILE, .is_read = true), KEYED("label", VALUE_LABEL, .most = 255), WITHIN,
      KEYED("regions", VALUE_LIST, .most = UINT32_MAX), KEYED("as", VALUE_LIST, .most = UINT32_MAX),
      KEYED("erode", VALUE_NUMBER, .most = 9),
      KEYED("each", VALUE_NUMBER, .least = 1, .most = 100000),
      KEYED("generator", VALUE_NUMBER, .most = 99999), OF_MAP, EXACT},
     "plant the seeds of a .csv list or a label map",
     "A list has lines x,y,z,label: the indices of a voxel, and the number or name of a label. A "
     "label map is on the scene's grid. Each region of it, the voxels of one value, becomes seeds "
     "of the label with this number, or of `label`." WITHIN_NOTE
     "\nregions: plant only these values of the map, as in 1-90,2001; the default is 1 and above.\n"
     "as: the labels of `regions`, one for each, as in regions=2001,2002 as=1,2. Use it for "
     "atlases whose values are not labels.\n"
     "erode: the number of erosions of each region; the default is 0. An erosion removes the "
     "voxels with a face neighbour outside the region.\n"
     "each: plant this number of voxels of each region, drawn at random after erosion; the default "
     "is all.\n"
     "generator: the start value of the random generator; the default is 1." MAP_NOTE EXACT_NOTE,
     "seed-file aal.nii.gz label=1 regions=1-90 erode=2 each=3"},
    {CALLED("labels", "atlas|segmentation", act_labels, GROUP_SEEDS, R | S | E | P),
     {NEED("FILE", VALUE_FILE, .is_read = true, .choices = "here"),
      KEYED("regions", VALUE_LIST, .most = UINT32_MAX), KEYED("as", VALUE_LIST, .most = UINT32_MAX),
      KEYED("label", VALUE_LABEL, .least = 1, .most = 255), FINISHED, OF_MAP,
      KEYED("least", VALUE_NUMBER, .least = 1, .most = 1000000),
      KEYED("rest", VALUE_CHOICE, .choices = "background|none|keep"),
      /* added to records, in this order */
      KEYED("erode", VALUE_NUMBER, .most = PIECE_ERODE_MOST, .added = true),
      KEYED("numbers", VALUE_LIST, .least = 1, .most = UINT32_MAX, .added = true),
      KEYED("copy", VALUE_WORD, .is_kept = true, .form = "DIGEST", .added = true)},
     "start from a segmentation, and correct it",
     "FILE is a label map of any program, on the scene's grid. Its labels are reproduced exactly. "
     "Each connected piece of a label or of the background becomes a marker, all in one undo step. "
     "The outer voxels of a piece are planted as its seeds. To correct a piece, plant a seed, "
     "stroke, box or polygon of another label in it: nearby seeds of the piece are removed, and "
     "the border is recomputed there. Nearby is up to `within`, by default three times the radius "
     "(of a box: half its thinnest side), but at least 2 voxels and at most 10 beyond the planted "
     "ones. The rest of the piece does not change.\n"
     "here: use the present labels instead of a file, as if they had been saved and read, for "
     "exact corrections of objects that were grown. finished=yes: use the labels after `finish`; "
     "the default at a prompt is to use the labels on the screen.\n"
     "The names, codes and colours in a .seg.nrrd, .nii, .nii.gz, .mgz or DICOM SEG become those "
     "of labels that have none; the journal's copy contains them.\n"
     "regions: use only these values of the map; the default is all. Other voxels are background. "
     "Where segments of DICOM overlap, the highest of these is used.\n"
     "as: the labels of `regions`, one for each. Without it, a value is the number of its label, "
     "up to 4294967295; at most 255 labels exist at a time. A value is rejected if other commands "
     "have planted a label of this number.\n"
     "label: use this label for all regions except the background.\n"
     "erode: the number of erosions of each piece; the default is 0. An erosion removes the voxels "
     "with a face neighbour of another label, so that borders are recomputed there. A piece that "
     "would vanish keeps its innermost voxels.\n"
     "copy: the digest of the copy of FILE next to the journal, which a replay reads instead of "
     "FILE. iftty adds it to the record.\n"
     "numbers: the values, if some of them exceed 255. iftty adds them to the record.\n"
     "least: do not plant pieces of fewer voxels; the surrounding trees grow into them.\n"
     "rest: the treatment of voxels outside `regions`. background, the default: plant background. "
     "none: leave them to the surrounding trees. keep: exclude them from the region of interest; "
     "`save labels` writes their values back. Use keep to correct some of many objects.\n"
     "resample=yes with a map of a part of the scene, such as a corrected crop: voxels outside the "
     "part keep their labels; without labels they are background. Outside the segments of a DICOM "
     "SEG they are background, as without resample." MAP_NOTE,
     "labels model.nii.gz erode=3"},
    {CALLED("object", "threshold|grow|flood", act_object, GROUP_SEEDS, R | S | E | P),
     {NEED("LABEL", VALUE_LABEL, .most = 255), NEED("HOW", VALUE_CHOICE, .choices = "threshold"),
      NEED("RANGE", VALUE_INTERVAL), KEYED("from", VALUE_POSITION), EXACT},
     "plant the connected voxels within a range",
     "Plants, as one marker, the voxels whose intensity, as printed by `why`, is from LOW to HIGH, "
     "and that a path of such voxels, from face to face, connects to a seed of the label. Voxels "
     "with seeds of other labels are left out and interrupt the connection, so that a stroke of "
     "background cuts off a leak. Each object may have its own range. Its trees grow beyond the "
     "range, until they meet trees of other labels.\n"
     "from: start from this voxel instead of the label's seeds." EXACT_NOTE,
     "object 2 threshold 226..3071"},
    {CALLED("remove", "delete|erase|eliminate|rm", act_remove, GROUP_SEEDS, R | S | E | P),
     {NEED("PLACE", VALUE_POSITION), BRUSH, KEYED("of", VALUE_CHOICE, .choices = "marker|tree")},
     "remove the marker that labels a voxel",
     "A marker is the set of seeds that one command has planted, such as a ball, a stroke or a "
     "region of a file. Its seeds are removed, the seeds that it replaced are restored, and the "
     "surrounding trees grow into its voxels. The voxel belongs to the marker whose trees "
     "contained it after the last run.\n"
     "of=tree: remove only the seed of the tree that contains the voxel, without restoring an "
     "older one.\n"
     "radius: remove all markers, or trees, with a voxel in this ball, in voxels or millimetres; "
     "the default is the voxel alone.",
     "remove 100,100,50"},
    {COMMAND("run", act_run, GROUP_SEEDS, R | S | E | P),
     {KEYED("for", VALUE_COMMAND, .form = "QUESTION")},
     "apply all pending edits together",
     "Edits remain pending while `auto` is off, the default in scripts. Commands that need the "
     "labels apply them first: `render`, `spin`, `slice`, `mosaic`, `golden`, `save`, `stats`, "
     "`compare`, `hints`, `why` and `profile`. `pick`, `hint` and `zoom fit` use the last picture, "
     "and report pending edits.\n"
     "for: the command that needed the labels, such as `stats`. iftty adds it, since commands that "
     "only print have no record of their own.",
     "run"},
    {COMMAND("undo", act_undo, GROUP_SEEDS, R | S | E),
     {MAY("COUNT", VALUE_NUMBER, .least = 1, .most = 1000000)},
     "undo the last change of the segmentation",
     "Undoes the last COUNT changes, by default 1: seeds and their removal, runs, weights, regions "
     "of interest, labels, `hide`, `show`, cuts and the finish, but not the view. Undo is exact "
     "and reaches back to `open`, also into earlier sessions. It is recorded. `redo` reverts it, "
     "and `history` lists the commands.\n"
     "iftty warns after an edit of n seeds if a label loses more than 500 voxels, and more than n "
     "% of the former volume of the label that gains most or, if that is 0, 100 n and a tenth of "
     "its own, and names the edge that this grew through. It does not warn if the gained voxels "
     "are as bright as the former ones, and each seed gains less than 3/2 of the former mean.",
     "undo"},
    {COMMAND("redo", act_redo, GROUP_SEEDS, R | S | E),
     {MAY("COUNT", VALUE_NUMBER, .least = 1, .most = 1000000)},
     "redo the change that was undone last",
     "After another change, `redo` cannot restore it, but `goto` can.",
     "redo"},
    {COMMAND("goto", act_goto, GROUP_SEEDS, R | S | E),
     {NEED("PLACE", VALUE_POINT)},
     "restore the segmentation of a record or a branch",
     "PLACE is the number of a record, which `history` and `iftty log` print, or the name of a "
     "branch, which means its last record. The first branch is called main.",
     "goto main"},
    {COMMAND("branch", act_branch, GROUP_SEEDS, R | S),
     {NEED("NAME", VALUE_WORD, .is_kept = true)},
     "begin a named branch at this point",
     "Later commands belong to the new branch; `goto` changes to another branch.",
     "branch with-brainstem"},
    {COMMAND("view", act_view, GROUP_VIEW, R | S),
     {NEED("YAW", VALUE_DECIMAL, .choices = VIEW_NAMES, .least = -TURNS, .most = TURNS),
      MAY("PITCH", VALUE_DECIMAL, .least = -TURNS, .most = TURNS),
      MAY("ROLL", VALUE_DECIMAL, .least = -TURNS, .most = TURNS)},
     "set the view: a side, or angles in degrees",
     "0 0 0 is the front: the patient faces the viewer. YAW moves the viewer around the patient, "
     "towards the patient's left, PITCH moves the viewer upwards, and ROLL turns the picture "
     "counter-clockwise. The head is up in the views front, back, left and right, and the face is "
     "up in top and bottom. The views follow the radiological convention: the patient's left is on "
     "the right of the picture in the front view, as in coronal slices, and in the bottom view, as "
     "in axial slices. It is on the left in the back and top views. `info` prints the sides of the "
     "present view.",
     "view 30 15 0"},
    {CALLED("turn", "rotate", act_turn, GROUP_VIEW, R | S),
     {NEED("YAW", VALUE_DECIMAL, .least = -TURNS, .most = TURNS),
      MAY("PITCH", VALUE_DECIMAL, .least = -TURNS, .most = TURNS),
      MAY("ROLL", VALUE_DECIMAL, .least = -TURNS, .most = TURNS)},
     "turn the view by degrees",

     "Adds these angles to those of the view, which `info` prints.",

     "turn 15 -5"},
    {COMES_TO("zoom", "zoom", act_zoom, GROUP_VIEW, R | S),
     {NEED("FACTOR", VALUE_DECIMAL, .choices = "fit", .least = VIEW_ZOOM_LEAST,
           .most = VIEW_ZOOM_MOST),
      KEYED("at", VALUE_POSITION)},
     "set the zoom in pixels per voxel, or fit objects",
     "FACTOR, 0.01..64, is the number of pixels of a voxel along an axis of the smallest spacing; "
     "along other axes a voxel has more pixels.\n"
     "fit: fill the picture with the shown objects, or with the scene if there are no objects, at "
     "the present angles. The record contains the resulting zoom and centre.\n"
     "at: move this voxel to the centre.",
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
     "X,Y,Z is a voxel; `scene`, the default, is the centre of the scene. The view turns around "
     "this place.",
     "focus 100,100,50"},
    {COMMAND("hide", act_hide, GROUP_VIEW, R | S),
     {NEED("LABEL", VALUE_LABEL, .choices = "all", .least = 1, .most = 255)},
     "hide an object",

     "Hides the object in pictures and in `save border`; its label does not change.\n"
     "all: hide all objects, and later ones until `show` names them.",
     "hide 2"},
    {COMMAND("show", act_show, GROUP_VIEW, R | S),
     {NEED("LABEL", VALUE_LABEL, .choices = "all", .least = 1, .most = 255)},
     "show an object again",
     "all: show every object. After `hide all`, `show LABEL` shows only this object.",
     "show 2"},
    {COMMAND("opacity", act_opacity, GROUP_VIEW, R | S),
     {NEED("LABEL", VALUE_LABEL, .choices = "all", .least = 1, .most = 255),
      NEED("PERCENT", VALUE_NUMBER, .most = 100)},
     "set the opacity of an object in renditions",
     "The default is 100, opaque. An object with less is translucent and shows the surfaces inside "
     "and behind it: a pixel has at most 8 translucent surfaces in front of the first opaque one. "
     "The label, voxel and depth of a pixel, and the answer of `pick`, are those of the surface "
     "with the largest share of its colour. With 0, renditions do not show the object; slices "
     "still do.",
     "opacity 1 30"},
    {COMMAND("clip", act_clip, GROUP_CUTS, R | S),
     {NEED("PLANE", VALUE_CHOICE, .choices = "axial|coronal|sagittal|none"),
      MAY("SLICES", VALUE_RANGE, .most = 65533)},
     "show only the slices from A to B",
     "Slices are numbered by the index of their voxels along the axis, as in X,Y,Z and `slice`. A "
     "and B are included. Axial, coronal and sagittal slices have a range each; `none` shows all "
     "slices again. Pictures and `save border` change, but labels do not.",
     "clip axial 40-120"},
    {COMMAND("plane", act_plane, GROUP_CUTS, R | S),
     {NEED("PLACE", VALUE_POSITION, .choices = "none"),
      KEYED("normal", VALUE_WORD, .is_kept = true, .choices = VIEW_NAMES, .form = "A,B,C"),
      KEYED("offset", VALUE_DECIMAL, .least = -PLANE_OFFSET_MOST, .most = PLANE_OFFSET_MOST)},
     "cut away everything in front of a voxel",
     "The plane is perpendicular to the present direction of view and contains the voxel, which is "
     "kept. It stays fixed to the scene when the view turns. There are up to 8 planes; `none` "
     "removes all.\n"
     "normal: the direction of the part to cut away, instead of that of the view: a side of the "
     "patient, or a vector A,B,C of any length to the right, front and head in the world. "
     "normal=left and normal=-1,0,0 cut away everything left of the voxel, also if the axes of the "
     "scene are oblique.\n"
     "offset: move the plane by this distance in that direction, in millimetres; offset=-5 cuts 5 "
     "mm deeper.",
     "plane 100,100,50 normal=1,1,0.5"},
    {COMMAND("cut", act_cut, GROUP_CUTS, R | S),
     {NEED("CORNER", VALUE_POSITION, .choices = "none"), PAIRED("OPPOSITE", VALUE_POSITION)},
     "cut a box out of the shown objects",
     "The box has these two corners, both included. There are up to 8 boxes; `none` removes all.",
     "cut 100,100,50 199,199,99"},
    {CALLED("render", "draw|picture|screenshot|snapshot", act_render, GROUP_RENDITION,
            R | S | E | A),
     {MAY("FILE", VALUE_FILE), KEYED("mode", VALUE_CHOICE, .choices = "sp|bp|ii|ray"),
      YES_NO("replace"), KEYED("layout", VALUE_CHOICE, .choices = "lines|tiled"), FINISHED},
     "draw the rendition, in FILE or inline",
     "A .exr has colour, depth, label, voxel and normal of each pixel, in lines or tiles; .png and "
     "other formats of OpenImageIO have only colours. At the prompt, files are written in the "
     "background, and a line reports when a file is complete. `iftty info FILE` prints the notes "
     "in a picture.\n"
     "mode: the algorithm, to compare their times; all draw the same pixels. sp (scene projection) "
     "draws the surface in the order of the scene, bp (border projection) from front to back "
     "without hidden voxels, and ray along the ray of each pixel. ii (incremental image), the "
     "default after a rendition, redraws its outdated pixels." SHOWN_NOTE,
     "render brain.png"},
    {CALLED("spin", "turntable|movie|animate", act_spin, GROUP_RENDITION, R | S | E | A),
     {NEED("N", VALUE_NUMBER, .least = 2, .most = IMAGE_FRAMES_MOST), NEED("FILE", VALUE_FILE),
      KEYED("axis", VALUE_WORD, .is_kept = true, .choices = "yaw|pitch|roll", .form = "AXIS,AXIS"),
      YES_NO("fit"), KEYED("delay", VALUE_NUMBER, .least = 20, .most = 60000), YES_NO("replace"),
      FINISHED},
     "write a turntable: N pictures of one full turn",
     "N is 2..1000. The first picture shows the present view, which does not change. %03d in FILE "
     "is replaced by the number of the picture, here with three digits, from 000. Without %d, FILE "
     "is an animated .gif of 256 colours, or a .tif with one page for each picture.\n"
     "axis: yaw, the default, turns around the patient, pitch over the head, and roll turns the "
     "picture, in the directions of `view`. For several axes, each has a turn of N pictures that "
     "begins with the present view; the numbers of the pictures continue.\n"
     "fit=yes: use the largest zoom at which the shown objects fit into all pictures.\n"
     "delay: the time of each picture of a .gif, in milliseconds; the default is 100." SHOWN_NOTE,
     "spin 36 turn%03d.png fit=yes"},
    {COMMAND("cross", act_cross, GROUP_SLICES, R | S | K),
     {NEED("PLACE", VALUE_POSITION)},
     "move the cross-hair, where the slices meet",
     "`open` sets it to the centre of the scene.",
     "cross 90,108,90"},
    {COMES_TO("cross", "hint", act_hint, GROUP_SLICES, R | S),
     {NEED("N", VALUE_NUMBER, .least = 1, .most = HINTS_MOST)},
     "move the cross-hair to a place of `hints`",
     "N is a number in the list of `hints`. The record contains the resulting `cross`.",
     "hint 1"},
    {COMMAND("show-channel", act_show_channel, GROUP_SLICES, R | S),
     {NEED("N", VALUE_CHOICE, .choices = "1|2|3|4|5|6|7|8|next")},
     "show another channel in slices",
     "Also applies to intensities in answers, in `profile` and in `stats`. "
     "Each channel has its own window. `next` shows the next one, after the last the first.",
     "show-channel 2"},
    {CALLED("window", "contrast|brightness|level", act_window, GROUP_SLICES, R | S),
     {NEED("LOW", VALUE_REAL, .choices = "auto"), PAIRED("HIGH", VALUE_REAL)},
     "set the intensities of black and white in slices",
     "LOW is black and HIGH is white, as intensities printed by `why`. A window of width W at "
     "level L is from L - W/2 to L + W/2.\n"
     "auto, the default: the darkest 1 % of the scene is black, and the brightest 0.5 % is white.",
     "window 20 90.5"},
    {COMMAND("magnify", act_magnify, GROUP_SLICES, R | S),
     {NEED("TIMES", VALUE_DECIMAL, .choices = "fit", .least = SLICE_TIMES_ONE,
           .most = SLICE_TIMES_MOST),
      KEYED("at", VALUE_POSITION)},
     "set the magnification of slices",
     "TIMES, 1..4096, enlarges slices around the cross-hair, relative to the size at which a whole "
     "slice fits; fit, the default, shows whole slices. Applies to slices and mosaics until the "
     "next `magnify` or `slice zoom=`.\n"
     "at: the voxel in the middle, as long as the cross-hair remains visible.\n"
     "Voxels of at least four pixels are drawn as squares; smaller ones are interpolated.",
     "magnify 2.5 at=90,108,90"},
    {COMMAND("slice", act_slice, GROUP_SLICES, R | S | A),
     {NEED("PLANE", VALUE_CHOICE, .choices = SLICE_WORDS), MAY("N", VALUE_NUMBER, .most = 65533),
      MAY("FILE", VALUE_FILE),
      KEYED("zoom", VALUE_DECIMAL, .choices = "fit", .least = VIEW_ZOOM_LEAST,
            .most = VIEW_ZOOM_MOST),
      YES_NO("replace"), FINISHED},
     "draw a slice at the cross-hair, in FILE or inline",
     "Slices follow the radiological convention and have the size set by `size`. N moves the "
     "cross-hair to another slice: the index of its voxels along the axis, from 0, as in X,Y,Z "
     "(ITK-SNAP counts from 1). If the orientation is unknown, slices are named after this axis: z "
     "for axial, y for coronal, x for sagittal.\n"
     "The name of FILE must contain a dot. A .exr also has the label and voxel of each pixel.\n"
     "zoom: pixels per voxel of the smallest spacing, around the cross-hair, with voxels as "
     "squares. It applies until zoom=fit, which shows the whole slice, interpolated." SHOWN_NOTE,
     "slice axial 90 axial.png"},
    {CALLED("mosaic", "planes|slices", act_mosaic, GROUP_SLICES, R | S | A),
     {MAY("FILE", VALUE_FILE), YES_NO("replace"), FINISHED},
     "draw three slices and the rendition",
     "Draws the coronal, sagittal and axial slices through the cross-hair at one scale, and the "
     "rendition at half its size." SHOWN_NOTE,
     "mosaic brain.png"},
    {COMMAND("golden", act_golden, GROUP_KEPT, R | S | E | A),
     {NEED("NAME", VALUE_GOLDEN), KEYED("of", VALUE_CHOICE, .choices = "rendition|" SLICE_KINDS),
      FINISHED},
     "store a picture as a golden image",
     "Stores the present rendition in a folder next to the journal; `of` selects a slice or the "
     "mosaic instead. `iftty verify` replays the journal and compares the image pixel for "
     "pixel." SHOWN_NOTE,
     "golden front-1"},
    {CALLED("finish", "smooth|relax|clean", act_finish, GROUP_KEPT, R | S | C),
     {MAY("STEP", VALUE_CHOICE, .choices = FINISH_KINDS "|none"),
      KEYED("radius", VALUE_RADIUS, .most = FINISH_RADIUS_MOST),
      KEYED("voxels", VALUE_NUMBER, .least = 1, .most = 1000000000),
      KEYED("sweeps", VALUE_NUMBER, .least = 1, .most = FINISH_SWEEPS_MOST),
      KEYED("reach", VALUE_NUMBER, .least = 1, .most = FINISH_BAND_MOST),
      KEYED("label", VALUE_LABEL, .least = 1, .most = 255)},
     "smooth and clean labels in files and pictures",
     "Adds a step to a list of steps, which together make the finished labels; without a step, "
     "prints the list. The segmentation itself does not change, and seeds can be planted at any "
     "time. `relax` keeps voxels that have a seed; the other steps can change these too, also "
     "those of exact gestures. `save` and `stats` with finished=yes report labels that the steps "
     "delete, reduce to less than half or break into more pieces.\n" FINISH_NOTES
     "none: remove all steps.\n"
     "radius: in voxels, or in millimetres as in 2.5mm; the default is 1 voxel.\n"
     "voxels: the size of the smallest piece that components keeps; required there.\n"
     "sweeps: the number of iterations of relax; the default is 20.\n"
     "reach: the largest distance by which relax moves a border, in voxels; the default is 2. "
     "Larger values, up to 16, correct coarser errors, but can remove an object of low contrast.\n"
     "label: apply the step only to this label.",
     "finish majority radius=1"},
    {CALLED("save", "export|write", act_save, GROUP_KEPT, R | S | E | A),
     {NEED("MAP", VALUE_CHOICE, .choices = MAPS "|seeds|names|surface"), NEED("FILE", VALUE_FILE),
      YES_NO("replace"), FINISHED, KEYED("label", VALUE_LABEL, .least = 1, .most = 255),
      KEYED("smooth", VALUE_NUMBER, .most = 100),
      KEYED("triangles", VALUE_NUMBER, .least = 4, .most = INT32_MAX), YES_NO("empty"),
      KEYED("identity", VALUE_CHOICE, .choices = "keep"), YES_NO("times")},
     "write a map, surfaces, seeds or names of labels",
     "Writes a map as .nii, .nii.gz, .nrrd, .mha, .mgh or .mgz, in the geometry of the scene. "
     "Labels as .nii, .nii.gz, .mgz or .seg.nrrd, a segmentation for 3D Slicer, include names and "
     "colours. So do labels as .dcm, a DICOM SEG that refers to the DICOM series of the scene.\n"
     "labels: uint8, or uint16 or uint32 if labels have numbers above 255. A voxel that no seed "
     "reaches is 0; the answer has the number of such voxels.\n"
     "cost: uint16; 65535 in a voxel that no seed reaches.\n"
     "root: uint32, the index of the seed's voxel, x + NX (y + NY z) in a scene of NX x NY x NZ "
     "voxels; 4294967295 where no seed reaches. Not as .mgh or .mgz.\n"
     "border: uint8, 1 in border voxels of shown objects.\n"
     "distance: uint16, the plateau distance: steps along the path since its cost last rose; 65535 "
     "where no seed reaches.\n"
     "margin: uint16, the additional cost of the best path from a seed of another label: 0 if "
     "another label reaches the voxel at the same cost, 65535 if no other label reaches it. The "
     "computation needs twice the time of a run with one thread.\n"
     "seeds: all planted seeds, as FILE.csv, which `seed-file` reads.\n"
     "names: the names and colours of labels, in a format of `label-file`: .txt or .label for "
     "ITK-SNAP, .ctab for FreeSurfer, .ctbl for 3D Slicer, .tsv for BIDS, .nii.txt or .lut for "
     "mricron.\n"
     "surface: the surface of each label, as in pictures, as .stl, .ply, .obj or .vtp, in "
     "millimetres of the world. It is closed, and encloses the volume of the voxels. A .stl "
     "contains all labels as one object.\n"
     "label: write the surface of this label only.\n"
     "smooth=0: write the faces of voxels, as drawn by `shade cubes`. Any other number writes the "
     "smooth surface, as by default.\n"
     "triangles: reduce the surfaces to at most this number of triangles, as far as they remain "
     "closed. Reduced surfaces of touching labels do not share points.\n"
     "empty=yes: write a map of labels even if no voxel has a label.\n"
     "identity=keep: write the patient and study of the series into the .dcm, by default left "
     "empty. times=yes: write the present date into it, by default 1900-01-01." FINISHED_NOTE,
     "save labels brain-labels.nii.gz"},
    {COMMAND("journal", act_journal, GROUP_KEPT, 0),
     {MAY("FILE", VALUE_FILE)},
     "print the journal's path, or continue in FILE",
     "The whole journal is written to FILE, with its golden images and copies of labels next to "
     "it, so that FILE can be replayed alone. Later commands are recorded in FILE; the former file "
     "keeps its last valid state. Use this if a disk is full or failing, or if the journal was "
     "deleted, replaced or opened with --read-only. The command is not recorded.",
     "journal"},
    {COMMAND("sync", act_sync, GROUP_KEPT, 0),
     {MAY("WHEN", VALUE_CHOICE, .choices = FILE_SYNC_WORDS)},
     "set when records are synced; sync them now",
     "always, the default: sync a record before its command is acknowledged; if the command "
     "changes only the view, within a second.\n"
     "everysec: sync within a second; a loss of power may lose the commands of that second.\n"
     "off: leave syncing to the operating system, except for `sync` and the end of the session. A "
     "loss of power may lose all commands since the last sync, and damage the end of the journal, "
     "which `iftty log --repair` cuts off.\n"
     "In all modes, killing the program loses no record. The command is not recorded.",
     "sync always"},
    {COMMAND("history", act_history, GROUP_QUESTIONS, S),
     {MAY("COUNT", VALUE_NUMBER, .least = 1, .most = 1000000)},
     "list commands that can be undone, and branches",
     "Lists the last COUNT commands, by default 20, with the numbers of their records. * marks the "
     "present state.",
     "history"},
    {COMMAND("pick", act_pick, GROUP_QUESTIONS, S),
     {NEED("COLUMN", VALUE_NUMBER, .most = VIEW_SIDE_MOST),
      NEED("ROW", VALUE_NUMBER, .most = VIEW_SIDE_MOST),
      KEYED("of", VALUE_CHOICE, .choices = "rendition|" SLICE_KINDS)},
     "print the voxel under a pixel of a picture",
     "COLUMN, from the left, and ROW, from the top, count from 0. The picture is the last "
     "rendition; `of` selects a slice or the mosaic, as it would be drawn now, instead.\n"
     "Prints the position of the voxel, in voxels and millimetres, its intensity, its label and "
     "seed, and its distance from the border of its object: from the nearest voxel of its label "
     "with a face on another label, shown or hidden, or on the boundary of the scene. The search "
     "ends at 100 mm, or at 100 voxels along an axis, whichever is nearer.",
     "pick 256 256"},
    {CALLED("measure", "distance|ruler|length", act_measure, GROUP_QUESTIONS, S),
     {NEED("PLACE", VALUE_POSITION), NEED("OTHER", VALUE_POSITION), MAY("THIRD", VALUE_POSITION)},
     "measure a distance, or an angle, between voxels",
     "Measures between the centres of voxels, in millimetres and in voxels. With a third voxel, "
     "also measures the angle at the second one.",
     "measure 10,20,30 40,20,30"},
    {COMMAND("profile", act_profile, GROUP_QUESTIONS, S | A),
     {NEED("PLACE", VALUE_POSITION), NEED("OTHER", VALUE_POSITION), YES_NO("values")},
     "plot the intensities along a straight line",
     "Draws a chart of the voxels on the line, with their labels below it: a digit, + for a label "
     "above 9, and . where no seed reaches. A column of several voxels shows their mean.\n"
     "values=yes: print a line for each voxel, with its distance, position, intensity and label.",
     "profile 10,20,30 40,20,30"},
    {COMMAND("why", act_why, GROUP_QUESTIONS, S | A),
     {NEED("PLACE", VALUE_POSITION)},
     "explain the label of a voxel",
     "Prints the seed at the start of the path to the voxel, the cost of the path, and the edges "
     "where the cost rose, the strongest first. A leak passes through the strongest edge; a seed "
     "or a shell there stops it. Also prints the second best label with the cost of its path.",
     "why 100,100,50"},
    {COMMAND("hints", act_hints, GROUP_QUESTIONS, S | A),
     {MAY("COUNT", VALUE_NUMBER, .choices = "slice", .least = 1, .most = HINTS_MOST),
      KEYED("label", VALUE_LABEL, .most = 255), KEYED("report", VALUE_FILE), YES_NO("replace")},
     "list the least certain places on borders",
     "Prints COUNT places, 1..999, by default 10. For each, prints its size, the cost of its least "
     "certain voxel, the neighbouring label with its cost there, the edge between the two labels, "
     "and the strongest edge on the path to the voxel.\n"
     "The certainty of a border voxel is the additional cost of the other label, plus the height "
     "of the edge, minus the cost of the voxel's path three steps before. The least certain tenth "
     "of the border is weak. A place is a connected weak part within a cube of 16 voxels a side; "
     "places with more and weaker voxels are listed first. The search needs about the time of a "
     "run; repeating it without a change is immediate.\n"
     "slice: instead of places, list the five slices with the largest doubt, in any plane. The "
     "doubt of a slice is the sum of 4u(1 - u) over its voxels, where u is the field of a label "
     "after `finish relax`: 1 inside, 0 outside, and between 0 and 1 where the border is "
     "uncertain. An `outline` in the first slice removes the most doubt. Slices with an outline, "
     "and their neighbours, are left out.\n"
     "In a journal of `iftty apply`, places of the label whose volume differs most from the "
     "procedure's are listed first.\n"
     "label: list only places at the border of this label, or slices by the doubt of this label "
     "alone.\n"
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
     "For each label, prints its seeds, voxels and volume in ml; its components, connected by "
     "faces, and enclosed holes; the area of its smooth surface in mm2, with an error below 2 % "
     "unless the object is small or thin; its centre in voxels and world mm, and its bounding box; "
     "the intensities of its voxels, as printed by `why`; and the voxels gained and lost by the "
     "last edit. The standard deviation is that of a sample (n - 1).\n"
     "Labels that have a name, or that the finish deletes, are listed even without voxels.\n"
     "report: write the same as FILE.json or FILE.csv." FINISHED_NOTE,
     "stats"},
    {CALLED("compare", "dice|overlap", act_compare, GROUP_QUESTIONS, S | A),
     {NEED("FILE", VALUE_FILE, .is_read = true), KEYED("regions", VALUE_LIST, .most = UINT32_MAX),
      KEYED("as", VALUE_LIST, .least = 1, .most = UINT32_MAX),
      KEYED("label", VALUE_LABEL, .least = 1, .most = 255), KEYED("at", VALUE_POSITION),
      KEYED("report", VALUE_FILE), KEYED("picture", VALUE_FILE), KEYED("surface", VALUE_FILE),
      YES_NO("replace"), FINISHED, OF_MAP},
     "compare the labels with a label map",
     "A is the present labels, B is the map, on the scene's grid. For each label, and for all "
     "labels together, prints:\n"
     "Dice: twice the voxels in both A and B, divided by the voxels in A plus the voxels in B; 1 "
     "if equal.\n"
     "Jaccard: the voxels in both A and B, divided by the voxels in A, B or both.\n"
     "Hausdorff: the largest distance from a voxel of A or B to the nearest of the other, in mm.\n"
     "95 %, mean: the 95th percentile and the mean of the distances from each surface to the "
     "other, in mm. A surface is the set of voxels with a neighbour outside the object, by a face, "
     "an edge or a corner; the boundary of the scene does not count.\n"
     "The overlaps, the Hausdorff distance and the directed means in a report equal those of ITK's "
     "filters.\n"
     "regions: compare only these values of the map; the default is 1 and above. These values and "
     "named labels have a row even if they have no voxels.\n"
     "as: the labels of `regions`, one for each.\n"
     "label: compare this label with all `regions` together.\n"
     "report: write FILE.json or FILE.csv.\n"
     "picture: draw slices through the voxel `at`, by default the place of the largest distance, "
     "with outlines: white for A and B, orange for A alone, blue for B alone, purple for different "
     "labels.\n"
     "surface: draw A's surface in the present view, all objects as one, coloured by its distance "
     "from B's surface: red outside B, blue inside." FINISHED_NOTE MAP_NOTE,
     "compare expert.nii.gz picture=difference.png"},
    {COMMAND("pilot", act_pilot, GROUP_QUESTIONS, S),
     {{0}},
     "segment with single keys, in full screen",
     "Shows slices, the rendition and a cross-hair. ? lists the keys, and q returns to the prompt. "
     "A key that changes the session runs a command, which is recorded. After `labels` the brush "
     "is exact: it plants with within=0. Needs a terminal. Ctrl-O at the prompt also opens it.",
     "pilot"},
    {COMMAND("help", act_help, GROUP_QUESTIONS, 0),
     {MAY("COMMAND", VALUE_COMMAND, .choices = "all|keys|correct")},
     "show how to segment, list or describe commands",
     "all: list all commands.\n"
     "keys: list the keys of the prompt.\n"
     "correct: show how to correct a segmentation of another program.",
     "help seed"},
    {CALLED("quit", "exit|bye|q|logout", act_quit, GROUP_QUESTIONS, 0),
     {{0}},
     "end the session; all commands are recorded",
     NULL,
     "quit"},
};

static const char beginning[] =
    "To segment an object, plant seeds: balls of its label inside it, and balls\n"
    "of background outside. Labels grow from seeds up to edges of the intensity.\n"
    "Where the result is wrong, plant more. `iftty tutorial` teaches this.\n\n"
    "In the pilot, which Ctrl-O opens (`?` shows all keys, `q` returns):\n"
    "    h j k l, H J K L    move the cross-hair; 30l moves 30 voxels\n"
    "    i                   plant a ball of the brush's label, at first label 1\n"
    "    s0                  plant a ball of background; s2 plants label 2\n"
    "    I, then i           plant a stroke, for example across a leak\n"
    "    u                   undo\n"
    "    :stats              print volumes; `:` begins any command\n\n"
    "At the prompt, where X,Y,Z is a voxel:\n"
    "    seed 60,108,90 1 radius=6       plant a ball of label 1\n"
    "    seed 20,108,90 0 radius=6       plant a ball of background\n"
    "    undo                            undo; `history` lists changes\n"
    "    save labels brain.nii.gz        write a label map\n\n"
    "`help all` lists commands, `help seed` describes one, `help keys` lists keys\n"
    "of the prompt, `help correct` shows how to correct a segmentation.\n";

/* Indented lines are commands, those with a $ commands of the shell. */
static const char recipes[] =
    "Correct a segmentation: `labels FILE` loads it; each piece becomes a marker.\n"
    "Commands with `over`, `keep` or `within=0` change only described voxels;\n"
    "seeds without these grow, and move borders. `undo` reverts a command, `save\n"
    "labels` writes the map. In a session grown from seeds, first type `labels\n"
    "here`.\n\n"
    "Erase label 5 in a ball where it leaked; other labels stay:\n"
    "    seed 60,108,90 0 radius=5 within=0 over=5\n"
    "Paint label 5 over background only, by a ball or an outline:\n"
    "    seed 60,108,90 5 radius=5 within=0 over=0\n"
    "    outline 60,90,50 5 to=70,90,50 to=65,99,50 within=0 over=0\n"
    "Grow label 5 over background only, up to edges, at most 9 voxels away:\n"
    "    seed 60,108,90 5 radius=2 within=9 over=0\n"
    "Split two touching objects of label 7 by balls in both; their outline stays:\n"
    "    seed 40,108,90 7 radius=2 over=7\n"
    "    seed 60,108,90 8 radius=2 over=7\n"
    "Swap labels 3 and 4 of the file:\n"
    "    labels model.nii.gz regions=3,4 as=4,3 rest=none\n"
    "Merge labels 17 and 53 of the file into 11 and 5:\n"
    "    labels model.nii.gz regions=17,53 as=11,5 rest=none\n"
    "Give a piece of label 5 to label 3, by a box around it:\n"
    "    box 27,30,40 34,38,52 3 within=0 over=5\n"
    "Draw a new object over background only, or over every label except 2:\n"
    "    seed 70,100,88 9 radius=4 within=0 over=0\n"
    "    seed 70,100,88 9 radius=4 within=0 keep=2\n"
    "Start from an atlas: carry its labels to another head, where borders are\n"
    "recomputed, and correct them there by balls, which grow:\n"
    "    $ iftty -c 'open head.nii.gz; labels atlas.nii.gz' --journal head.iftty\n"
    "    $ iftty apply head.iftty other.nii.gz\n"
    "    $ iftty other.iftty\n"
    "An atlas that fits the scene already: keep the inside of its regions:\n"
    "    labels atlas.nii.gz resample=yes erode=2\n"
    "Touching objects without a map: a ball in each, and one sphere around all:\n"
    "    seed 40,108,90 1 radius=3\n"
    "    seed 60,108,90 2 radius=3\n"
    "    seed 50,108,90 0 radius=30 shell=yes\n";

const char *command_page(const char *name)
{
    return !name ? beginning : strcmp(name, "correct") == 0 ? recipes : NULL;
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
