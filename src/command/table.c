/* THE table of commands. */
#include "command/act.h"

#include "engine/weight.h"
#include "image/volume.h"
#include "render/view.h"
#include "session/seed_file.h"
#include "session/slicing.h"

#define VOLUME_NOTE(format, note) note

/* Parameters. N is what help calls them. */
#define NEED(N, TYPE, LEAST, MOST)                                                                 \
    {                                                                                              \
        N, PARAMETER_##TYPE, false, false, LEAST, MOST, 0                                          \
    }
#define MAY(N, TYPE, LEAST, MOST)                                                                  \
    {                                                                                              \
        N, PARAMETER_##TYPE, true, false, LEAST, MOST, 0                                           \
    }
#define KEYED(N, TYPE, LEAST, MOST)                                                                \
    {                                                                                              \
        N, PARAMETER_##TYPE, true, true, LEAST, MOST, 0                                            \
    }
#define NAMED(N, TYPE, CHOICES, LEAST, MOST)                                                       \
    {                                                                                              \
        N, PARAMETER_NAMED_##TYPE, false, false, LEAST, MOST, CHOICES                              \
    }
#define KEYED_NAMED(N, TYPE, CHOICES, LEAST, MOST)                                                 \
    {                                                                                              \
        N, PARAMETER_NAMED_##TYPE, true, true, LEAST, MOST, CHOICES                                \
    }
#define ONE_OF(N, CHOICES)                                                                         \
    {                                                                                              \
        N, PARAMETER_CHOICE, false, false, 0, 0, CHOICES                                           \
    }
#define MAY_ONE_OF(N, CHOICES)                                                                     \
    {                                                                                              \
        N, PARAMETER_CHOICE, true, false, 0, 0, CHOICES                                            \
    }
#define KEYED_ONE_OF(N, CHOICES)                                                                   \
    {                                                                                              \
        N, PARAMETER_CHOICE, true, true, 0, 0, CHOICES                                             \
    }

enum {
    R = COMMAND_RECORDED,
    S = COMMAND_NEEDS_SCENE,
    E = COMMAND_EDITS,
    TURNS = 10 * VIEW_TURN, /* angles may be given beyond one turn; they are reduced */
    PANS = 1000 * VIEW_SIDE_MOST,
};

/* Real values of intensities, in thousandths. */
#define REAL_MOST INT64_C(1000000000000)

const char *const command_group_name[] = {
    [GROUP_SCENE] = "The scene",
    [GROUP_WEIGHT] = "What a step weighs, and where trees may grow",
    [GROUP_SEEDS] = "Objects and their seeds",
    [GROUP_VIEW] = "The view",
    [GROUP_LOOK] = "How surfaces look",
    [GROUP_CUTS] = "Cuts",
    [GROUP_RENDITION] = "Renditions",
    [GROUP_SLICES] = "Slices",
    [GROUP_KEPT] = "What is kept",
    [GROUP_QUESTIONS] = "Questions, and the end",
};

const struct command command_table[] = {
    {"open",
     GROUP_SCENE,
     R,
     {NEED("FILE", FILE, 0, 0)},
     "load a scene, or synth:geom[:XYZ|:SIZE]",
     VOLUME_FORMATS(VOLUME_NOTE) "synth:geom has 200x200x100 "
                                 "voxels; X, Y, Z of 2 interpolate that axis to 2n-1, as in "
                                 "synth:geom:221. A SIZE in "
                                 "voxels, as in synth:geom:1024x1024x1024, draws the same solids "
                                 "in a scene of that size. A "
                                 "large scene says what memory it needs before it is loaded, and "
                                 "is refused where that is "
                                 "not free.",
     "open synth:geom",
     act_open},
    {"interpolate",
     GROUP_SCENE,
     R | S,
     {NEED("X", NUMBER, 1, 2), NEED("Y", NUMBER, 1, 2), NEED("Z", NUMBER, 1, 2)},
     "interpolate each axis with a 2 to 2n-1 voxels",
     "Right after `open`, before the first seed. Between two voxels comes their mean, halves "
     "rounded up; spacing halves, and voxel 0,0,0 stays where it is in the world.",
     "interpolate 2 2 1",
     act_interpolate},
    {"weight",
     GROUP_WEIGHT,
     R | S | E,
     {NAMED("FILE", FILE, WEIGHT_KINDS, 0, 0), MAY("SIGMA", DECIMAL, SIGMA_LEAST, SIGMA_MOST),
      KEYED("radius", NUMBER, 1, MORPH_RADIUS_MOST)},
     "arc weights: how dear a step is",
     "A step of height h weighs h under each gradient. Lengths are in voxels, whatever the "
     "spacing.\n"
     "morph, as at first: dilation minus erosion, over a voxel and its neighbours, or over what "
     "`radius` steps reach.\n"
     "sobel: the 3-D Sobel operator.\n"
     "gauss: the gradient of the scene smoothed by a Gaussian of SIGMA 0.5..8 voxels.\n"
     "difference: the difference of intensity between both ends of the step.\n"
     "polarity: the same, with steps to brighter and to darker weighed apart (`help polarity`).\n"
     "FILE: a NIfTI on the scene's grid with the weight of each voxel, whole numbers 0..65535.",
     "weight gauss 1.5",
     act_weight},
    {"polarity",
     GROUP_WEIGHT,
     R | S | E,
     {NEED("LABEL", LABEL, 0, 255), NEED("PERCENT", NUMBER, -POLARITY_MOST, POLARITY_MOST)},
     "how an object is told from what is around it",
     "Under `weight polarity`, paths from the seeds of the label pay PERCENT more for a step to "
     "darker and PERCENT less for one to brighter. So above 0 suits an object brighter than what "
     "is around it, below 0 a darker one; 0, which all labels begin with, neither.",
     "polarity 1 50",
     act_polarity},
    {"adjacency",
     GROUP_WEIGHT,
     R | S | E,
     {ONE_OF("COUNT", "6|26")},
     "neighbours of a voxel: by faces, or by corners too",

     "6, as at first, or 26.",

     "adjacency 26",
     act_adjacency},
    {"mask",
     GROUP_WEIGHT,
     R | S | E,
     {NAMED("FILE", FILE, "none", 0, 0), KEYED("regions", RANGE, 0, REGION_MOST)},
     "fence the forest in: the voxels of a map",
     "FILE is a NIfTI on the scene's grid. No tree grows where its value is not in `regions`, 1 "
     "and above unless given; with a `range` both hold. Weights do not look at it.",
     "mask brain.nii.gz regions=1-90",
     act_mask},
    {"range",
     GROUP_WEIGHT,
     R | S | E,
     {NAMED("LOW", DECIMAL, "none", -REAL_MOST, REAL_MOST),
      MAY("HIGH", DECIMAL, -REAL_MOST, REAL_MOST)},
     "fence the forest in: intensities",
     "No tree grows where the intensity, as `why` tells it, is below LOW or above HIGH; with a "
     "`mask` both hold.",
     "range 40 1200.5",
     act_range},
    {"label",
     GROUP_SEEDS,
     R,
     {NEED("LABEL", LABEL, 0, 255), NEED("NAME", WORD, 0, 0), MAY("COLOUR", COLOUR, 0, 0)},
     "name a label, and give it a colour",
     "Label 0 is the background.",
     "label 2 cerebellum #40c060",
     act_label},
    {"seed",
     GROUP_SEEDS,
     R | S | E,
     {NEED("PLACE", POSITION, 0, 0), NEED("LABEL", LABEL, 0, 255), KEYED("radius", NUMBER, 0, 32),
      KEYED("to", POSITION, 0, 0)},
     "plant a seed, a ball of seeds, or a stroke",
     "A voxel that has a seed gets the new label.\n"
     "to: the other end of a straight stroke, with a ball of the radius at each step.",
     "seed 100,100,50 1 radius=2",
     act_seed},
    {"seed-file",
     GROUP_SEEDS,
     R | S | E,
     {NEED("FILE", FILE, 0, 0), KEYED("label", LABEL, 0, 255),
      KEYED("regions", RANGE, 0, REGION_MOST), KEYED("erode", NUMBER, 0, 9),
      KEYED("each", NUMBER, 1, 100000), KEYED("generator", NUMBER, 0, 99999)},
     "plant the seeds of a .csv list or a label map",
     "A list has lines x,y,z,label: voxel indices, a label's number or name. A label map is a "
     "NIfTI on the scene's grid, whose regions (voxels of one value) become seeds of the label "
     "of that number, or all of `label`.\n"
     "regions: the values, 1 and above unless given.\n"
     "erode: rounds in which voxels go that have a face neighbour outside their region.\n"
     "each: how many seeds are drawn of what is left of a region; all unless given.\n"
     "generator: another number draws others; 1 unless given.",
     "seed-file aal.nii.gz label=1 regions=1-90 erode=2 each=3",
     act_seed_file},
    {"remove",
     GROUP_SEEDS,
     R | S | E,
     {NEED("PLACE", POSITION, 0, 0), KEYED("radius", NUMBER, 0, 32)},
     "eliminator: the tree that holds this voxel goes",
     "The seed of that tree is taken away, and the tree falls to the seeds around it. Trees are "
     "those of the last run.\n"
     "With a radius: the seeds of all trees that reach into the ball.",
     "remove 100,100,50",
     act_remove},
    {"run",
     GROUP_SEEDS,
     R | S | E,
     {{0}},
     "apply the edits that wait, as one",
     "Edits wait while `auto` is off, as it is in scripts. `render`, `spin`, `save` and `golden` "
     "of a rendition apply them too; slices show them as they wait.",
     "run",
     act_run},
    {"undo",
     GROUP_SEEDS,
     R | S | E,
     {MAY("COUNT", NUMBER, 1, 1000000)},
     "take back what changed the segmentation last",
     "Seeds and eliminators, runs, weights, fences, labels, `hide`, `show` and cuts; where you "
     "look from stays. The last COUNT of them, 1 unless given, as far back as `open`, whatever "
     "the session was left in between. Exact, and itself recorded: `redo` leads there again, "
     "`history` tells what there is.",
     "undo",
     act_undo},
    {"redo",
     GROUP_SEEDS,
     R | S | E,
     {MAY("COUNT", NUMBER, 1, 1000000)},
     "do again what was undone last",
     "The way one came. What is undone and followed by another command is not lost: `goto` leads "
     "there.",
     "redo",
     act_redo},
    {"goto",
     GROUP_SEEDS,
     R | S | E,
     {NEED("PLACE", POINT, 0, 0)},
     "the segmentation as a record or a branch left it",
     "The number of a record, which `history` and `iftty log` tell, or the name of a branch: "
     "where one was on it last. The first branch is main.",
     "goto main",
     act_goto},
    {"branch",
     GROUP_SEEDS,
     R | S,
     {NEED("NAME", WORD, 0, 0)},
     "begin an alternative here, by name",
     "What follows belongs to it; `goto` leads to the others. `iftty log --graph` draws them.",
     "branch with-brainstem",
     act_branch},
    {"auto",
     GROUP_SEEDS,
     R,
     {ONE_OF("STATE", "on|off")},
     "whether each edit is run by itself",
     "off in scripts, on at the prompt.",
     "auto on",
     act_auto},
    {"view",
     GROUP_VIEW,
     R | S,
     {NEED("YAW", VIEW, -TURNS, TURNS), MAY("PITCH", DECIMAL, -TURNS, TURNS),
      MAY("ROLL", DECIMAL, -TURNS, TURNS)},
     "look from a side, or from angles in degrees",
     "0 0 0 is the front: the patient faces you, his left on your right. Yaw takes you around "
     "him towards his left side, pitch above him; roll turns the picture counter-clockwise. "
     "front, back, left and right have his head up; top and bottom his face. As radiologists "
     "have it, his left is on your right from the front, as in coronal slices, and from the "
     "bottom, as in axial ones; from the back and the top it is on your left. `info` tells it "
     "for every view.",
     "view 30 15 0",
     act_view},
    {"turn",
     GROUP_VIEW,
     R | S,
     {NEED("YAW", DECIMAL, -TURNS, TURNS), MAY("PITCH", DECIMAL, -TURNS, TURNS),
      MAY("ROLL", DECIMAL, -TURNS, TURNS)},
     "turn the view by degrees",

     "Added to those of the view, which `info` tells.",

     "turn 15 -5",
     act_turn},
    {"zoom",
     GROUP_VIEW,
     R | S,
     {NAMED("FACTOR", DECIMAL, "fit", VIEW_ZOOM_LEAST, VIEW_ZOOM_MOST)},
     "pixels per voxel, or what fits",
     "Per voxel of the smallest spacing; others are larger in proportion. `fit` shows the whole "
     "scene, whatever way it is turned, its middle in the middle.",
     "zoom 1.5",
     act_zoom},
    {"pan",
     GROUP_VIEW,
     R | S,
     {NEED("RIGHT", DECIMAL, -PANS, PANS), NEED("DOWN", DECIMAL, -PANS, PANS)},
     "move what is seen, in pixels",
     "Fractions of a pixel count too. What comes to the middle of the picture stays there under "
     "`view`, `turn`, `zoom FACTOR` and `size`; `focus scene` takes it back.",
     "pan 40 -12.5",
     act_pan},
    {"focus",
     GROUP_VIEW,
     R | S,
     {NAMED("PLACE", POSITION, "scene", 0, 0)},
     "the place in the middle of the picture",
     "A voxel, or the middle of the scene. Views turn around it.",
     "focus 100,100,50",
     act_focus},
    {"size",
     GROUP_VIEW,
     R | S,
     {NEED("WIDTH", NUMBER, 1, VIEW_SIDE_MOST), NEED("HEIGHT", NUMBER, 1, VIEW_SIDE_MOST)},
     "the picture, in pixels",

     "Of renditions, slices and mosaics alike; 512 512 at first.",

     "size 512 512",
     act_size},
    {"hide",
     GROUP_VIEW,
     R | S,
     {NEED("LABEL", LABEL, 1, 255)},
     "do not show an object",

     "In pictures and in `save border`; labels stay what they are.",

     "hide 2",
     act_hide},
    {"show",
     GROUP_VIEW,
     R | S,
     {NEED("LABEL", LABEL, 1, 255)},
     "show an object again",
     NULL,
     "show 2",
     act_show},
    {"shade",
     GROUP_LOOK,
     R | S,
     {ONE_OF("NORMALS", "surface|scene|depth")},
     "what tells which way a surface faces",
     "surface, as at first: the shown objects, smoothed.\n"
     "scene: the gradient of the intensities, which has finer detail where objects end at an "
     "edge in the scene.\n"
     "depth: the depths around a pixel.",
     "shade scene",
     act_shade},
    {"light",
     GROUP_LOOK,
     R | S,
     {NEED("YAW", DECIMAL, -VIEW_TURN / 2, VIEW_TURN / 2),
      NEED("PITCH", DECIMAL, -LIGHT_PITCH_MOST, LIGHT_PITCH_MOST)},
     "where the light comes from, in degrees",
     "It moves with you: 0 0 is from behind you, YAW to your right, PITCH above. -25 30 at "
     "first, over your left shoulder.",
     "light -25 30",
     act_light},
    {"cue",
     GROUP_LOOK,
     R | S,
     {NEED("PERCENT", NUMBER, 0, 100)},
     "how much darker what lies far is",
     "The far end of the scene loses so much; 30 at first.",
     "cue 50",
     act_cue},
    {"edges",
     GROUP_LOOK,
     R | S,
     {ONE_OF("STATE", "on|off")},
     "darken where an object lies before another",

     "off at first.",

     "edges on",
     act_edges},
    {"samples",
     GROUP_LOOK,
     R | S,
     {ONE_OF("COUNT", "1|2|4")},
     "smooth outlines: COUNT x COUNT samples a pixel",
     "Each pixel is the mean of its samples; depth, label and voxel are the nearest one's. 1 at "
     "first.",
     "samples 2",
     act_samples},
    {"clip",
     GROUP_CUTS,
     R | S,
     {ONE_OF("PLANE", "axial|coronal|sagittal|none"), MAY("SLICES", RANGE, 0, 65533)},
     "show only what lies between two slices",
     "Slices are counted as `slice` counts them: axial ones from the feet, coronal ones from the "
     "back, sagittal ones from the patient's left. Both ends are kept. Each PLANE may be clipped "
     "at once; `none` shows the whole again. Borders, pictures and `save border` follow; labels "
     "stay what they are.",
     "clip axial 40-120",
     act_clip},
    {"plane",
     GROUP_CUTS,
     R | S,
     {NAMED("PLACE", POSITION, "none", 0, 0)},
     "cut away what lies before a voxel as it is seen",
     "A plane across the present view, through the voxel, which stays. The plane stays with the "
     "patient when the view turns. Up to 8; `none` takes them off.",
     "plane 100,100,50",
     act_plane},
    {"cut",
     GROUP_CUTS,
     R | S,
     {NAMED("CORNER", POSITION, "none", 0, 0), MAY("OPPOSITE", POSITION, 0, 0)},
     "take a box out of what is shown",
     "Between two corners, both taken out too. Up to 8 boxes; `none` puts them back.",
     "cut 100,100,50 199,199,99",
     act_cut},
    {"render",
     GROUP_RENDITION,
     R | S | E,
     {MAY("FILE", FILE, 0, 0), KEYED_ONE_OF("mode", "sp|bp|ii|ray"),
      KEYED_ONE_OF("replace", "yes|no"), KEYED_ONE_OF("layout", "lines|tiled")},
     "make the rendition, to FILE or inline",
     ".exr holds colour, depth, label, voxel and normal of each pixel, in lines or tiled; .png "
     "and whatever else OpenImageIO writes hold the colours. At the prompt a file is written "
     "beside the session: what became of it is told when it is known. `iftty info FILE` tells "
     "what a picture is of.\n"
     "All modes give the same pixels: sp splats every object voxel, bp border voxels, ray walks "
     "the rays, ii repairs what is there.",
     "render brain.png",
     act_render},
    {"spin",
     GROUP_RENDITION,
     R | S | E,
     {NEED("N", NUMBER, 2, IMAGE_FRAMES_MOST), NEED("FILE", FILE, 0, 0),
      KEYED("delay", NUMBER, 20, 60000), KEYED_ONE_OF("replace", "yes|no")},
     "a turntable: N pictures, all the way around",
     "From the present view on, which stays. A %03d in FILE is the number of the picture, with "
     "as many digits, from 000. Without it a .gif is animated, each picture seen for `delay` "
     "milliseconds, 100 unless given, in 256 colours; a .tif has pages, in all of them.",
     "spin 36 turn%03d.png",
     act_spin},
    {"cross",
     GROUP_SLICES,
     R | S,
     {NEED("PLACE", POSITION, 0, 0)},
     "the cross-hair: the voxel that slices go through",
     "After `open`, the middle of the scene.",
     "cross 90,108,90",
     act_cross},
    {"window",
     GROUP_SLICES,
     R | S,
     {NAMED("LOW", DECIMAL, "auto", -REAL_MOST, REAL_MOST),
      MAY("HIGH", DECIMAL, -REAL_MOST, REAL_MOST)},
     "what is black in slices, and what is white",
     "Intensities, as `why` tells them: a window of width W at level L is from L - W/2 to L + "
     "W/2.\n"
     "auto, as at first: all but the darkest 1 % and the brightest 0.5 % of the scene.",
     "window 20 90.5",
     act_window},
    {"overlay",
     GROUP_SLICES,
     R | S,
     {MAY_ONE_OF("LABELS", "none|tint|contour"), KEYED_ONE_OF("cross", "on|off"),
      KEYED_ONE_OF("marks", "on|off"), KEYED_ONE_OF("words", "on|off")},
     "what lies over the grey of slices",
     "none, tint or contour, as at first: of the labels that are shown.\n"
     "cross: the cross-hair.\n"
     "marks: a dot for a seed in the slice, an x for an eliminator of the last run, with a white "
     "rim where it waits for a run.\n"
     "words: title, letters for the patient's sides, the scale, the greys.",
     "overlay tint cross=off",
     act_overlay},
    {"slice",
     GROUP_SLICES,
     R | S,
     {ONE_OF("PLANE", SLICE_WORDS), MAY("N", NUMBER, 0, 65533), MAY("FILE", FILE, 0, 0),
      KEYED_NAMED("zoom", DECIMAL, "fit", VIEW_ZOOM_LEAST, VIEW_ZOOM_MOST),
      KEYED_ONE_OF("replace", "yes|no")},
     "a slice through the cross-hair, to FILE or inline",
     "As radiologists look at it, at the size of the view. N takes the cross-hair to that slice, "
     "counted from 0 towards superior, anterior, or the patient's right.\n"
     "A FILE has a dot in its name; .exr holds the label and voxel of each pixel too.\n"
     "zoom: pixels per voxel of the smallest spacing, around the cross-hair; voxels are squares "
     "then. It stays so until zoom=fit, which shows all of the slice, in smooth greys.",
     "slice axial 90 axial.png",
     act_slice},
    {"mosaic",
     GROUP_SLICES,
     R | S,
     {MAY("FILE", FILE, 0, 0), KEYED_ONE_OF("replace", "yes|no")},
     "three slices and the rendition, as one picture",
     "Coronal, sagittal and axial through the cross-hair at one scale, and the rendition of the "
     "view at half its size.",
     "mosaic brain.png",
     act_mosaic},
    {"golden",
     GROUP_KEPT,
     R | S | E,
     {NEED("NAME", GOLDEN, 0, 0), KEYED_ONE_OF("of", "rendition|" SLICE_KINDS)},
     "keep a picture as a golden image",
     "The rendition, or a slice or mosaic as it would be shown now. `iftty verify` compares it "
     "pixel for pixel. It lies in a folder beside the journal.",
     "golden front-1",
     act_golden},
    {"save",
     GROUP_KEPT,
     R | S | E,
     {ONE_OF("MAP", "labels|cost|root|border"), NEED("FILE", FILE, 0, 0),
      KEYED_ONE_OF("replace", "yes|no")},
     "write a map as .nii or .nii.gz",
     "In the geometry of the scene: labels and border as uint8, cost as uint16, root as uint32 "
     "(voxel index of the seed, 4294967295 where none reaches).",
     "save labels brain-labels.nii.gz",
     act_save},
    {"journal",
     GROUP_KEPT,
     0,
     {MAY("FILE", FILE, 0, 0)},
     "where the record is, or go on in another file",
     "    The whole record so far is written to FILE first, with its golden images\n"
     "    beside it, so that it replays alone; what follows is recorded there. The\n"
     "    former file stays as it was when it was last right. For a disk that is\n"
     "    full or failing, a journal that was deleted or replaced, or one opened\n"
     "    with --read-only. Not recorded.\n",
     "journal",
     act_journal},
    {"sync",
     GROUP_KEPT,
     0,
     {MAY_ONE_OF("WHEN", FILE_SYNC_WORDS)},
     "when records reach the disk; now, without a word",
     "    always, unless told: each before its command is acknowledged. everysec: a\n"
     "    second later at most; a loss of power may take the commands of that\n"
     "    second. off: whenever the system does, with `sync`, and at the end; a loss\n"
     "    of power may take all since then, and leave damage behind what was synced,\n"
     "    which `iftty log --repair` cuts off. A program that is killed loses\n"
     "    nothing under any of them. Not recorded.\n",
     "sync always",
     act_sync},
    {"history",
     GROUP_QUESTIONS,
     S,
     {MAY("COUNT", NUMBER, 1, 1000000)},
     "the commands that can be undone, and branches",
     "The last COUNT, 20 unless given, with the numbers of their records; * is where you are.",
     "history",
     act_history},
    {"pick",
     GROUP_QUESTIONS,
     S,
     {NEED("COLUMN", NUMBER, 0, VIEW_SIDE_MOST), NEED("ROW", NUMBER, 0, VIEW_SIDE_MOST),
      KEYED_ONE_OF("of", "rendition|" SLICE_KINDS)},
     "the voxel under a pixel of a picture",
     "Of the rendition as `render` made it, or of a slice or mosaic as it would be shown now. "
     "Columns from the left, rows from the top, both from 0.\n"
     "Tells where the voxel is, in voxels and millimetres, its intensity, its label and seed, "
     "and how far it is from the border of its object: from the nearest voxel of its label with "
     "a face on another label or on the edge of the scene, whatever is shown. It looks 100 mm "
     "far, and no farther than 100 voxels.",
     "pick 256 256",
     act_pick},
    {"why",
     GROUP_QUESTIONS,
     S,
     {NEED("PLACE", POSITION, 0, 0)},
     "how a voxel came to its label",

     "The seed that the path comes from, its cost, and where along it the cost rose.",

     "why 100,100,50",
     act_why},
    {"info",
     GROUP_QUESTIONS,
     0,
     {{0}},
     "the scene, the view, the journal, the memory",
     NULL,
     "info",
     act_info},
    {"stats",
     GROUP_QUESTIONS,
     S,
     {{0}},
     "seeds, voxels and volume of each label",
     NULL,
     "stats",
     act_stats},
    {"pilot",
     GROUP_QUESTIONS,
     S,
     {{0}},
     "fly through the scene by keys, on the whole screen",
     "Slices, the rendition and a cross-hair; ? tells the keys, q comes back. Each key that "
     "changes "
     "something is a command, and recorded as such. At a terminal only; Ctrl-O is the same.",
     "pilot",
     act_pilot},
    {"help",
     GROUP_QUESTIONS,
     0,
     {MAY("COMMAND", COMMAND, 0, 0)},
     "this list, or one command in full",
     NULL,
     "help seed",
     act_help},
    {"quit",
     GROUP_QUESTIONS,
     0,
     {{0}},
     "leave; the journal has everything",
     NULL,
     "quit",
     act_quit},
};

const unsigned command_count = sizeof command_table / sizeof command_table[0];
