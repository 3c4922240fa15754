/* Pelt's door for engines that are not C++: one scene of furry characters, from groom files to what
 * there is to draw. The same door as jobs/scene.hpp and jobs/engine_door.hpp, in C11.
 *
 *   PeltScene* scene = pelt_create(&groom, 1, NULL, why, sizeof why);
 *   for (;;) {
 *     pelt_set_joint(scene, 0, joint, &transform);     for every joint, from your animation
 *     pelt_begin(scene, &frame);                       NULL, or why the frame must not run
 *     pelt_run(scene, &door);                          on your job system; or pelt_pull
 *     count = pelt_draws(scene, draws, room);
 *   }
 *   pelt_destroy(scene);
 *
 * What fails returns a text that says why, and has changed nothing; NULL is success. A text lives
 * until the next call on its scene. A null scene, an index out of range, input that is not finite
 * or a damaged groom is refused, never followed. Calls on one scene come from one thread at a time;
 * but any thread may call pelt_pull while a frame is open.
 *
 * Invariant: after pelt_create only the first pelt_run with a door allocates. */
#ifndef PELT_JOBS_PELT_H
#define PELT_JOBS_PELT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Running: what the engine implements. No exceptions may leave the functions. ---- */

typedef void (*PeltTask)(void* context);

typedef struct PeltDoor {
  /* Has task(context) called exactly once, on any thread, at any time from now until `finish`
   * returns. May call it before returning, and then return NULL: nothing to finish. `name` is for
   * the engine's profiler and lives as long as the program. */
  void* (*enqueue)(PeltTask task, void* context, void* user, const char* name);
  /* Returns when the task of this handle has returned. Called once for each handle that is not
   * NULL. It may run this task, or others, on the calling thread meanwhile. */
  void (*finish)(void* handle, void* user);
  void* user;
  /* Threads that may run tasks at one time, the one that calls pelt_run included. */
  uint32_t worker_count;
} PeltDoor;

/* ---- A scene ---- */

typedef struct PeltScene PeltScene;

typedef struct PeltBytes {
  const void* data;
  size_t bytes;
} PeltBytes;

enum PeltVertexOrder {
  PELT_SORTED = 0,      /* vertices lie in drawing order */
  PELT_INDEX_BUFFER = 1 /* vertices lie in strand order and are drawn through an index buffer */
};

typedef struct PeltSceneOptions {
  uint32_t vertex_order;        /* PeltVertexOrder */
  uint64_t memory_budget_bytes; /* a scene that needs more is refused; 0: no budget */
  /* Gives the scene's one block, aligned to 128 bytes, once; it is the caller's again after
   * pelt_destroy, or when pelt_create has failed. NULL: Pelt allocates it. */
  void* (*allocate)(uint64_t bytes, void* user);
  void* user;
  /* Not 0: poses may come with velocities (pelt_set_joint_velocity), for layers with the modal
   * solver. */
  int velocities;
  /* Not 0: each character has an origin (pelt_set_origin), which its placement and all that is drawn
   * of it are relative to: as fine far from the world's origin as at it. */
  int origins;
  /* Not 0: characters are meant to be of any size beside their groom's, no note of it (pelt_note). */
  int any_scale;
  uint32_t strand_writes; /* the most that PeltFrame has of them */
} PeltSceneOptions;

/* A scene of `count` characters, one groom file (`pelt bake`) in memory for each; the bytes are
 * copied, and read once where characters share them. `options` may be NULL. NULL when it fails, and
 * the reason in `why`, cut to `why_bytes`. Every character stands in its bind pose. */
PeltScene* pelt_create(const PeltBytes* grooms, uint32_t count, const PeltSceneOptions* options,
                       char* why, size_t why_bytes);
void pelt_destroy(PeltScene* scene);

/* Of things that are not there: 0, or NULL. */
uint32_t pelt_layer_count(const PeltScene* scene);
const char* pelt_layer_name(const PeltScene* scene, uint32_t layer);
uint32_t pelt_joint_count(const PeltScene* scene, uint32_t character);
const char* pelt_joint_name(const PeltScene* scene, uint32_t character, uint32_t joint);
/* The most strands that a draw of the layer can have, as long as the scene lives. */
uint32_t pelt_strand_count(const PeltScene* scene, uint32_t layer);
/* A layer's strands have numbers below it; and whose layer it is (UINT32_MAX: of none). */
uint32_t pelt_strand_places(const PeltScene* scene, uint32_t layer);
uint32_t pelt_layer_character(const PeltScene* scene, uint32_t layer);
/* Metres that a unit of the character's file is long, as its groom was baked: 0.01 of a file in
 * centimetres. */
float pelt_unit_scale(const PeltScene* scene, uint32_t character);

/* ---- A frame ---- */

typedef struct PeltJoint {
  float translation[3];
  float rotation[4]; /* a unit quaternion, xyzw */
  float scale[3];
} PeltJoint;

/* What is set here is refused, with the reason, from pelt_begin until its frame has run: that frame
 * reads it. */

/* The transform of a joint relative to its parent, as the character file has it. */
const char* pelt_set_joint(PeltScene* scene, uint32_t character, uint32_t joint,
                           const PeltJoint* local);
/* Where the character stands: row-major 3x4, from the character file's units to metres, so that its
 * scale is pelt_unit_scale where the character has the size that it was baked for (a placement of
 * scale 1 makes one of a file in centimetres 100 times too large). Lengths and widths of its fur are
 * the groom's times what the scale is beside pelt_unit_scale. `teleported`: its fur starts from its
 * groom. */
const char* pelt_place(PeltScene* scene, uint32_t character, const float root[12], int teleported);

/* What pelt_place's root is relative to, world, m; 0 until it is set. To be moved with the character,
 * in every frame or now and then: what it moves by is part of the character's motion. Velocities
 * are the world's all the same. A scene made without origins refuses it. */
const char* pelt_set_origin(PeltScene* scene, uint32_t character, const double origin[3]);

/* How fast a joint's transform changes at the pose's time. With it the roots of strands are known
 * between frames too: at 30 frames per second their motion is several times as exact. */
typedef struct PeltJointVelocity {
  float translation[3]; /* of the translation, 1/s */
  float spin[3];        /* rad/s, about the parent's axes */
  float scale[3];       /* of the scale, 1/s */
} PeltJointVelocity;

/* A frame has the velocities of a character for which one of these was called since the pelt_begin
 * before it; what was not set then stands still. A scene that takes none refuses them. */
const char* pelt_set_joint_velocity(PeltScene* scene, uint32_t character, uint32_t joint,
                                    const PeltJointVelocity* velocity);
/* Of pelt_place's root: its derivative by time, row-major 3x4, 1/s. */
const char* pelt_place_velocity(PeltScene* scene, uint32_t character, const float root[12]);

enum PeltSkip { /* what may be left out; of these only PELT_LOD and PELT_CULL can change a bit */
                PELT_SLEEP = 1,
                PELT_UNMOVED = 2,
                PELT_SORT = 4,
                PELT_CULL = 8,
                PELT_WIND = 16,
                PELT_LOD = 32,
                PELT_LIGHT = 64
};

#define PELT_FREE UINT32_MAX

/* What a ball covers on its way from one point to another. Free: ends in the world, m. Bound to a
 * joint: ends where the joint's own space has them, in the units of the character file. */
typedef struct PeltCapsule {
  float from[3], to[3];
  float radius;       /* m */
  uint32_t character; /* whose joint it is */
  uint32_t joint;     /* or PELT_FREE */
  /* Of a free one's ends, m/s, in the frame that ends where they are; a bound one's are known. */
  float from_velocity[3], to_velocity[3];
} PeltCapsule;

/* A ball that shines; of radius 0 a point. Colours are linear. */
typedef struct PeltLight {
  float position[3]; /* m, world */
  float radius;      /* m */
  float rgb[3];      /* irradiance of what faces it, at 1 m */
  float range;       /* m: it falls to 0 there; 0: it reaches everywhere */
} PeltLight;

/* The surroundings as seen from a place: a sky above a ground, linear radiance. */
typedef struct PeltIrradianceSample {
  float position[3]; /* m, world */
  float falloff;     /* m, above 0: its weight falls to 0 there */
  float sky[3], ground[3];
  float up[3]; /* unit */
} PeltIrradianceSample;

enum PeltChannel { PELT_MUD = 0, PELT_SNOW = 1, PELT_WET = 2, PELT_DUST = 3 };

/* A ball that paints the strands of painted layers whose roots it holds, in every frame it is
 * there. They act one after the other. */
typedef struct PeltBrush {
  float centre[3];  /* m, world */
  float radius;     /* m */
  float hardness;   /* 0 to 1: share of the radius within which it paints all of `amount` */
  uint32_t channel; /* PeltChannel */
  float amount;     /* -1 to 1, of the most that a strand can have; below 0: takes away */
} PeltBrush;

/* Values of one strand in place of its groom's, in the frames that have them. */
typedef struct PeltStrandWrite {
  uint32_t layer, strand;           /* by its number in the layer, as `order` has it */
  uint32_t base_colour, tip_colour; /* 0xAABBGGRR */
  float width;                      /* at the root, 0 to 0.1 m */
  uint32_t film_strip;              /* below 256 */
} PeltStrandWrite;

enum PeltWindKind { PELT_GUSTS = 0, PELT_PUBLISHED_WIND = 1 };
enum PeltForceShape { PELT_FORCE_BALL = 0, PELT_FORCE_BOX = 1 };
enum PeltForceKind { PELT_FORCE_PUSH = 0, PELT_FORCE_PULL = 1 };

/* Pushes the strands whose roots it holds along a direction, or pulls them to its centre, beside gravity and
 * wind. Free: centre, sides and direction in the world, m. Bound to a joint: the centre where the joint's own
 * space has it, in the units of the character file; sides and direction along the joint's axes. */
typedef struct PeltForce {
  float centre[3];
  float half[3];        /* radii of a ball, half the sides of a box; m, free or bound; from 1e-3 on */
  uint32_t shape, kind; /* PeltForceShape, PeltForceKind */
  float direction[3];   /* unit, of a pull too */
  float strength;       /* m/s^2; below 0: the other way */
  float hardness;       /* 0 to 1: share of the way out that has all of it; at the surface there is none */
  uint32_t character;   /* whose joint it is */
  uint32_t joint;       /* or PELT_FREE */
} PeltForce;

/* Places and directions are the world's: right-handed, metres. jobs/README.md has a table of all that
 * a frame is given. */
typedef struct PeltFrame {
  double dt_s;   /* the time that passes in the frame: 1e-6 to 1; or 0: a pause */
  double time_s; /* at its end, 0 or later: where the wind is in its course */
  /* The camera: world space, right-handed, metres. */
  float eye[3];                                /* where it is */
  float target[3];                             /* a place that it looks at, at any distance but 0 */
  float up[3];                                 /* upwards in the picture, of any length */
  float vertical_fov_rad;                      /* whole angle, in (0, pi) */
  float viewport_width_px, viewport_height_px; /* from 1 on */
  float near_m, far_m;      /* in front of the eye, from 1e-4 on; beyond near_m */
  float gravity[3];         /* m/s^2 */
  float wind_velocity[3];   /* mean of the air over time, m/s */
  float gust_strength;      /* 0.5: gusts swing the velocity by up to half of it */
  float gust_period_s;      /* of the slowest sine; from 1e-3 on */
  float turbulence;         /* most that an eddy adds along an axis, m/s */
  float turbulence_scale_m; /* size of an eddy; from 1e-3 on */
  uint32_t wind_kind;       /* PeltWindKind */
  int use_ground;
  float ground[4];           /* n.x + d >= 0 is above; n is unit */
  uint32_t sphere_count;     /* at most 8 */
  const float (*spheres)[4]; /* centre, radius; m */
  /* Of each sphere and of the ground, m/s, in the frame that ends where they are: they move along in
   * it and take strands with them. NULL: they stand still. */
  const float (*sphere_velocities)[3];
  float ground_velocity[3];
  uint32_t capsule_count; /* at most 8 */
  const PeltCapsule* capsules;
  uint32_t light_count; /* at most 8 */
  const PeltLight* lights;
  uint32_t irradiance_sample_count; /* at most 12 */
  const PeltIrradianceSample* irradiance_samples;
  float sun_direction[3], sun_rgb[3];               /* towards it, unit */
  float rim_direction[3], rim_rgb[3], rim_exponent; /* the side that has the rim, unit */
  uint32_t brush_count;                             /* at most 16 */
  const PeltBrush* brushes;
  uint32_t force_count; /* at most 8 */
  const PeltForce* forces;
  /* Wetness and dirt, 0 to 1, of each character; NULL: dry and clean. */
  const float (*weather)[2];
  /* Of each layer (pelt_layer_count), a factor on its size on the screen as level of detail and budgets see it:
   * 0.01 to 100, or 0: the layer is off, and starts from its groom when it is on again. NULL: 1 each. */
  const float* importance;
  /* Haircuts: a byte for each place of a strand, pelt_strand_places of each layer, one layer after the other. Not
   * 0: the strand is not drawn. NULL: 0 each. */
  const uint8_t* cut;
  uint32_t strand_write_count; /* at most PeltSceneOptions has */
  const PeltStrandWrite* strand_writes;
  /* Level of detail, with PELT_LOD. The box diagonal on the screen from which a layer has all its
   * strands, px; the least share of them, the change of the share over the share that it follows, and
   * the share of the living strands that fade out, each 0 to 1; and the least share of its chains at mesh
   * vertices that is simulated, which thin with its strands: 1 keeps all. */
  float full_detail_px, min_fraction, hysteresis, fade_share, least_chains;
  uint32_t strand_budget; /* living strands over all layers in view; 0: no budget */
  /* Typical error on the screen, px, up to which modal layers of quality `fine` are simulated in `fast`; 0:
   * never. */
  float fast_quality_px;
  /* Core time of the fur in view, us; 0: no budget. What is over it by the costs below, ns of a chunk or patch,
   * of a mesh vertex, of a living strand, and of each point but the root of a chain by PBD, Verlet, fast, fine, best, is taken from
   * what is seen least: `fast` for `fine` up to a typical error of worst_px, then, with PELT_LOD, strands. */
  uint32_t budget_us;
  float worst_px, chunk_ns, vertex_ns, strand_ns, node_ns[5];
  uint32_t skip; /* PeltSkip */
  /* What the places above are relative to, world, m; not 0 only in a scene that has origins. */
  double origin[3];
} PeltFrame;

/* Fills in what a frame has unless the caller sets it otherwise. */
void pelt_default_frame(PeltFrame* frame);

/* The published wind of a frame, for a vertex shader that works it out (PublishedWind of shaders/fur_vertex.glsl).
 * Waves: strength, m/s; turns a metre; turns at 0. `origin`: the draw's; NULL: 0. All 0 for another kind of wind. */
typedef struct PeltWindWaves {
  float mean[3]; /* m/s */
  float along_x[3], along_z[3];
} PeltWindWaves;
void pelt_wind_waves(const PeltFrame* frame, const double origin[3], PeltWindWaves* waves);

/* Takes poses and input. The frame must then be run, once. */
const char* pelt_begin(PeltScene* scene, const PeltFrame* frame);
/* Why a character's pose was not used by the last pelt_begin (it keeps its last one); NULL when it
 * was. */
const char* pelt_refused_pose(PeltScene* scene, uint32_t character);
/* What looks like a mistake in frames that were begun and is computed all the same: that a character
 * is placed over 10 times larger or smaller than its groom was baked for. Reported once for each
 * character; NULL: nothing more. */
const char* pelt_note(PeltScene* scene);

/* Runs the frame and returns when it is done. `door` NULL: on the calling thread alone. The door
 * may change from frame to frame; what is kept for it is made when it does. */
const char* pelt_run(PeltScene* scene, const PeltDoor* door);
/* What the present door did wrong since it came, and what to look for; NULL: nothing. The frames
 * are right all the same. */
const char* pelt_door_faults(PeltScene* scene);

/* Instead of pelt_run, for engines that would rather poll: pelt_open once, then pelt_pull on any
 * threads until it returns PELT_IDLE, which says that the frame is done. */
enum PeltPull {
  PELT_RAN,           /* an item was run */
  PELT_NOTHING_READY, /* all items that may run are running elsewhere */
  PELT_IDLE           /* no frame is open: it is done */
};
const char* pelt_open(PeltScene* scene);
int pelt_pull(PeltScene* scene);
/* The same by a thread that says its number, from 0 on, each a different one: it is given what it was
 * given in the frame before, as far as that costs nothing, and finds that in its core's cache. A wrong
 * number costs time and nothing else. */
int pelt_pull_as(PeltScene* scene, uint32_t worker);

/* ---- The state as bytes ---- */

/* What the next frame begins with and nothing else, for going back to an earlier frame, or going on
 * elsewhere: always so many bytes of a scene, the same on every machine. */
uint64_t pelt_snapshot_bytes(const PeltScene* scene);
/* Between two frames. `room`: of `to`, at least as many. */
const char* pelt_snapshot(PeltScene* scene, void* to, size_t room);
/* Likewise; of a scene of the same grooms and options. Poses are those of the frame before: what was
 * set for the next one is to be set again. What there is to draw comes with the next frame, which may
 * be a pause. Refused with the reason, and nothing done, when the bytes are of another scene or
 * damaged. */
const char* pelt_restore(PeltScene* scene, const void* from, size_t bytes);

/* ---- What there is to draw ---- */

enum PeltOutput { PELT_INSTANCES = 0, PELT_RIBBONS = 1, PELT_LINES = 2, PELT_SHELLS = 3 };

/* What a strand of a lit layer is shaded with. */
typedef struct PeltLook {
  uint32_t normal;  /* of the skin, world: octahedral, x low, y high, 16 bits signed each */
  uint32_t uv;      /* on the skin's texture: u low, v high, of 65535 */
  uint32_t amounts; /* of 255 for each PeltChannel, from the low byte up */
  uint32_t random;  /* the same in every frame */
} PeltLook;

/* What lights a layer. Colours are linear. */
typedef struct PeltLayerLight {
  float harmonics[3][16]; /* of the radiance; red, green, blue: jobs/DRAWING.md has the order */
  float ambient[3];       /* mean radiance */
  float sun_direction[3], sun_rgb[3];
  float rim_direction[3], rim_rgb[3], rim_exponent;
} PeltLayerLight;

/* How a layer takes light: what its setup's [layer.look] says (jobs/DRAWING.md). */
typedef struct PeltLayerLook {
  float tint[3]; /* linear; multiplies both colours */
  float specular, specular_exponent, specular_shift;
  float second, second_exponent, second_shift;
  float specular_noise;
  float wrap;
  float rim, rim_from;
  float backlight, backlight_exponent;
  float scatter, scatter_depth;
  float strand_tint[3]; /* linear; multiplies the colour where a strand texture has extra tint */
  float shadow_alpha;   /* strands that cover less of a shadow map's texel are cut from it; 0: none */
} PeltLayerLook;

/* One shell: an instance of the layer's triangles. */
typedef struct PeltShell {
  float height;    /* h: vertices are at position + h groom + h^2 force */
  float shadow;    /* share of the light that gets down to it */
  float threshold; /* drawn where the texture, times the stencil, is above */
  float fade;      /* alpha */
} PeltShell;

typedef struct PeltDraw {
  uint32_t layer;
  uint32_t output;         /* PeltOutput: jobs/DRAWING.md describes the bytes of each */
  const char* output_name; /* "instances" */
  const void* vertices;    /* in the scene's memory, until the next frame runs */
  size_t vertices_bytes;
  uint32_t vertex_bytes;
  uint32_t vertices_per_strand;
  uint32_t strand_count;
  const uint32_t* order; /* the strand at each of `strand_count` places */
  uint32_t live_strands; /* what pelt_copy_curves has */
  float low[3], high[3]; /* box around the layer's strands; m */
  float tip_width;       /* over the width at the root */
  uint32_t pieces;       /* straight ones, 2 to 8, that PELT_INSTANCES' curves need from where the camera is */
  /* Of a lit layer: a record for each of `look_count` strands, by the strand's number; else NULL. */
  const PeltLook* looks;
  uint32_t look_count;
  const PeltLayerLight* light;
  /* PELT_SHELLS, which have no strands: what to draw of the layer's triangles, from the skin up. */
  const PeltShell* shells;
  uint32_t shell_count;
  float texture_repeat; /* of the fur's texture, along 0 to 1 of the skin's coordinates */
  float fur_shadow; /* light left at the skin: at height h there is 1 + (fur_shadow - 1) (1 - h) */
  /* Of a painted layer, whose colours are left dry and clean: what a soaked strand keeps of its
   * brightness, and the sRGB colour that mud is mixed in with. Else 1, and 0. */
  float wet_darken, mud_colour[3];
  /* What all places of the draw are relative to, world, m: its character's origin. */
  double origin[3];
  const PeltLayerLook* look; /* as long as the scene lives */
} PeltDraw;

/* The layers to draw, in drawing order. Writes at most `room` and returns how many there are: none
 * while a frame is begun or runs. */
uint32_t pelt_draws(PeltScene* scene, PeltDraw* draws, uint32_t room);

typedef struct PeltStrandCurve {
  float point[5][4];                /* x, y, z, full width; m, world; root first */
  uint32_t base_colour, tip_colour; /* 0xAABBGGRR */
  uint32_t strand;                  /* its number in its layer, the same in every frame */
  uint32_t film_strip;
} PeltStrandCurve;

/* A layer's living strands as points, for those who draw in another way. Returns how many were
 * written. */
uint32_t pelt_copy_curves(PeltScene* scene, uint32_t layer, PeltStrandCurve* curves, uint32_t room);

/* What a shadow pass draws of a layer whose setup says `shadow_share`: places of strands in the draw's vertices, in
 * drawing order, to be as many times wider as there are fewer than the draw's strand_count. Returns how many
 * there are, and writes what there is room for. */
uint32_t pelt_shadow_places(PeltScene* scene, uint32_t layer, uint32_t* places, uint32_t room);

/* Indices of triangles for ribbons: of strands 0, 1, 2, ... with `order` NULL, of the strands it
 * names otherwise. 24 for each strand. Returns how many were written. */
uint32_t pelt_ribbon_indices(const uint32_t* order, uint32_t strand_count, uint32_t* indices,
                             uint32_t room);

/* What does not change of a layer of shells: ask once. Each returns how much there is, 0 for other
 * layers, and writes what there is room for: three indices a triangle; u and v of each vertex that the
 * draw has; a byte for each texel of the fur's texture, whose side is returned. */
uint32_t pelt_shell_indices(const PeltScene* scene, uint32_t layer, uint32_t* indices,
                            uint32_t room);
uint32_t pelt_shell_uvs(const PeltScene* scene, uint32_t layer, float (*uvs)[2], uint32_t room);
uint32_t pelt_fur_texture(const PeltScene* scene, uint32_t layer, uint8_t* texels, size_t room);

/* The artist's texture of a layer's strands, RGBA, 8 bits each, linear: `strips` silhouettes, equally wide,
 * side by side, rows from root to tip. A strand shows the one that its film strip's number says. */
enum PeltStrandChannels {
  PELT_STRAND_LOOK,   /* r extra tint, g extra highlights, b shadow, a coverage */
  PELT_STRAND_WEATHER /* coverage, of a dry and clean strand in r, a wet one in g, a dirty one in b */
};
typedef struct PeltStrandTexture {
  uint32_t width, height, strips;
  uint32_t channels; /* PeltStrandChannels */
  const uint8_t* rgba; /* as long as the scene lives */
} PeltStrandTexture;

/* It never changes: ask once. Returns 1, or 0 of a layer that has none. */
int pelt_strand_texture(const PeltScene* scene, uint32_t layer, PeltStrandTexture* texture);

/* An edge of the skin that is drawn out along the fur, from h = 0 to 1. */
typedef struct PeltFin {
  uint32_t from, to; /* among the draw's vertices */
  uint32_t fade;     /* of 255, above 0: what its colour and alpha are multiplied with */
} PeltFin;

/* The fins that are seen in the last frame, of a layer with `fins = true`. Returns how many there are,
 * none of other layers and while a frame is begun or runs, and writes what there is room for. */
uint32_t pelt_fins(PeltScene* scene, uint32_t layer, PeltFin* fins, uint32_t room);

/* Digest of all that the last frame computed: the same on every machine and thread count. */
uint64_t pelt_digest(const PeltScene* scene);

#ifdef __cplusplus
}
#endif
#endif
