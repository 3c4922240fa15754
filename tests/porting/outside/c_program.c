/* An engine in C: it makes a scene, gets the faults of bad input reported, runs the same frame on
 * the caller, on a job system of two functions and by polling, and draws what comes out. Prints the
 * picture and the digest of the README's example; returns the number of checks that failed.
 *
 *   c_program GROOM */
#include <math.h>
#include <stdlib.h>

#include "draw_frame.h"
#include "pelt/jobs/pelt.h"

static int failures = 0;

static void Expect(int holds, const char* what, const char* text) {
  if (holds) return;
  fprintf(stderr, "FAILED: %s: '%s'\n", what, text ? text : "");
  ++failures;
}

/* The text must name what is wrong. */
static void ExpectRefused(const char* text, const char* word) {
  Expect(text != NULL && strstr(text, word) != NULL, word, text);
}
static void ExpectDone(const char* text, const char* what) { Expect(text == NULL, what, text); }

/* ---- A job system: tasks wait in a queue until they are asked for ---- */

typedef struct Job {
  PeltTask task;
  void* context;
} Job;
typedef struct Jobs {
  Job queue[4096];
  uint32_t count;
} Jobs;

static void* Enqueue(PeltTask task, void* context, void* user, const char* name) {
  Jobs* jobs = user;
  (void)name;
  if (jobs->count == 4096) { /* full: done at once */
    task(context);
    return NULL;
  }
  jobs->queue[jobs->count].task = task;
  jobs->queue[jobs->count].context = context;
  return &jobs->queue[jobs->count++];
}
static void Finish(void* handle, void* user) {
  Job* job = handle;
  (void)user;
  job->task(job->context);
}

/* ---- Memory: one block of the caller's ---- */

typedef struct Arena {
  void* given;
  void* aligned;
  uint64_t bytes;
} Arena;

static void* Allocate(uint64_t bytes, void* user) {
  Arena* arena = user;
  arena->bytes = bytes;
  arena->given = malloc(bytes + 128);
  arena->aligned = (char*)arena->given + (128 - (uintptr_t)arena->given % 128);
  return arena->aligned;
}
static void* GiveNothing(uint64_t bytes, void* user) {
  (void)bytes, (void)user;
  return NULL;
}

/* What the file holds, and how much; null: it cannot be read. */
static void* ReadFile(const char* path, size_t* bytes) {
  FILE* in = fopen(path, "rb");
  if (!in) return NULL;
  fseek(in, 0, SEEK_END);
  *bytes = (size_t)ftell(in);
  rewind(in);
  void* data = malloc(*bytes);
  if (fread(data, 1, *bytes, in) != *bytes) *bytes = 0;
  fclose(in);
  return data;
}

/* ---- Bad input ---- */

static void TryBadScenes(PeltBytes good) {
  char why[200] = "";
  PeltBytes bad = good;
  PeltSceneOptions options = {0};
  Expect(!pelt_create(NULL, 1, NULL, why, sizeof why), "null grooms", why);
  Expect(!pelt_create(&good, 0, NULL, NULL, 0), "no groom", "");
  bad.bytes /= 2;
  Expect(!pelt_create(&bad, 1, NULL, why, sizeof why), "half a groom", why);
  ExpectRefused(why, "it was cut or extended");
  bad.data = NULL;
  Expect(!pelt_create(&bad, 1, NULL, why, sizeof why), "a null groom", why);
  ExpectRefused(why, "is null");
  options.memory_budget_bytes = 1;
  Expect(!pelt_create(&good, 1, &options, why, sizeof why), "a budget", why);
  ExpectRefused(why, "memory budget of 1");
  Expect(!pelt_create(&good, 1, &options, why, 8) && strlen(why) == 7, "a cut text", why);
  options.memory_budget_bytes = 0;
  options.allocate = GiveNothing;
  Expect(!pelt_create(&good, 1, &options, why, sizeof why), "no memory", why);
  ExpectRefused(why, "gave none");
  options.vertex_order = 7;
  Expect(!pelt_create(&good, 1, &options, why, sizeof why), "an order", why);
  ExpectRefused(why, "vertex order");
}

/* A character is placed in its file's units; one that is not is reported, once. */
static void TryScales(PeltBytes groom) {
  char why[200] = "";
  const float factors[] = {1.0f, 9.9f, 0.11f, 100.0f, 0.01f};
  for (int any = 0; any < 2; ++any)
    for (int i = 0; i < 5; ++i) {
      const PeltSceneOptions options = {.any_scale = any};
      PeltScene* scene = pelt_create(&groom, 1, &options, why, sizeof why);
      PeltFrame frame;
      pelt_default_frame(&frame);
      const float s = pelt_unit_scale(scene, 0) * factors[i];
      const float root[12] = {s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0};
      Expect(s > 0.0f && pelt_unit_scale(scene, 1) == 0.0f, "a unit", "");
      ExpectDone(pelt_note(scene), "no note before the first frame");
      ExpectDone(pelt_place(scene, 0, root, 0), "places");
      ExpectDone(pelt_begin(scene, &frame), "begins");
      if (i >= 3 && !any)
        ExpectRefused(pelt_note(scene), i == 3 ? "100 times larger" : "100 times smaller");
      ExpectDone(pelt_note(scene), "no second note");
      ExpectDone(pelt_run(scene, NULL), "runs");
      ExpectDone(pelt_begin(scene, &frame), "begins again");
      ExpectDone(pelt_note(scene), "no note in a second frame");
      ExpectDone(pelt_run(scene, NULL), "runs");
      pelt_destroy(scene);
    }
}

static void TryNulls(void) {
  PeltFrame frame;
  pelt_default_frame(&frame);
  pelt_default_frame(NULL);
  pelt_destroy(NULL);
  ExpectRefused(pelt_begin(NULL, &frame), "null");
  ExpectRefused(pelt_run(NULL, NULL), "null");
  ExpectRefused(pelt_open(NULL), "null");
  ExpectRefused(pelt_set_joint(NULL, 0, 0, NULL), "null");
  ExpectRefused(pelt_place(NULL, 0, NULL, 0), "null");
  ExpectRefused(pelt_refused_pose(NULL, 0), "null");
  ExpectRefused(pelt_door_faults(NULL), "null");
  ExpectRefused(pelt_note(NULL), "null");
  Expect(pelt_pull(NULL) == PELT_IDLE, "pull", "null");
  Expect(pelt_pull_as(NULL, 1) == PELT_IDLE, "pull_as", "null");
  Expect(pelt_draws(NULL, NULL, 0) == 0 && pelt_copy_curves(NULL, 0, NULL, 0) == 0 &&
             pelt_digest(NULL) == 0 && pelt_layer_count(NULL) == 0 && !pelt_layer_name(NULL, 0) &&
             pelt_strand_count(NULL, 0) == 0 && pelt_unit_scale(NULL, 0) == 0.0f &&
             pelt_joint_count(NULL, 0) == 0 && !pelt_joint_name(NULL, 0, 0) &&
             pelt_ribbon_indices(NULL, 1, NULL, 24) == 0 &&
             pelt_shell_indices(NULL, 0, NULL, 0) == 0 && pelt_shell_uvs(NULL, 0, NULL, 0) == 0 &&
             pelt_fur_texture(NULL, 0, NULL, 0) == 0 && pelt_fins(NULL, 0, NULL, 0) == 0 &&
             pelt_strand_texture(NULL, 0, NULL) == 0,
         "nothing of a null scene", "");
}

static void TryBadFrames(PeltScene* scene) {
  PeltFrame frame, bad;
  PeltJoint joint = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
  const float root[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const uint32_t joints = pelt_joint_count(scene, 0);
  PeltDoor door = {NULL, Finish, NULL, 1};
  pelt_default_frame(&frame);
  Expect(joints > 0 && pelt_joint_name(scene, 0, joints - 1) != NULL, "joints", "");
  ExpectRefused(pelt_set_joint(scene, 0, joints, &joint), "no such joint");
  ExpectRefused(pelt_set_joint(scene, 1, 0, &joint), "no such joint");
  ExpectRefused(pelt_set_joint(scene, 0, 0, NULL), "null");
  ExpectRefused(pelt_place(scene, 9, root, 0), "no such character");
  ExpectRefused(pelt_place(scene, 0, NULL, 0), "null");
  ExpectRefused(pelt_begin(scene, NULL), "null");
  bad = frame;
  bad.dt_s = NAN;
  ExpectRefused(pelt_begin(scene, &bad), "dt_s");
  bad = frame;
  bad.sphere_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "spheres are null");
  bad.sphere_count = 4000000000u;
  ExpectRefused(pelt_begin(scene, &bad), "more spheres");
  bad = frame;
  bad.capsule_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "capsules are null");
  bad.capsule_count = 4000000000u;
  ExpectRefused(pelt_begin(scene, &bad), "more capsules");
  const PeltCapsule capsule = {{0, 0, 0}, {0, 1, 0}, 0.1f, 0, joints, {0, 0, 0}, {0, 0, 0}};
  bad.capsules = &capsule;
  bad.capsule_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "joint");
  bad = frame;
  bad.light_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "lights are null");
  bad.light_count = 4000000000u;
  ExpectRefused(pelt_begin(scene, &bad), "more lights");
  const PeltLight light = {{0, 2, 0}, -1, {1, 1, 1}, 0};
  bad.lights = &light;
  bad.light_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "light 0: its radius");
  bad = frame;
  bad.irradiance_sample_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "irradiance samples are null");
  bad.irradiance_sample_count = 4000000000u;
  ExpectRefused(pelt_begin(scene, &bad), "more irradiance samples");
  bad = frame;
  bad.brush_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "brushes are null");
  bad.brush_count = 4000000000u;
  ExpectRefused(pelt_begin(scene, &bad), "more brushes");
  const PeltBrush brush = {{0, 1, 0}, 0.1f, 0.5f, PELT_DUST + 1, 1};
  bad.brushes = &brush;
  bad.brush_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "brush 0: its channel");
  bad = frame;
  bad.force_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "force volumes are null");
  bad.force_count = 4000000000u;
  ExpectRefused(pelt_begin(scene, &bad), "more force volumes");
  const PeltForce force = {{0}, {0}, PELT_FORCE_BOX, PELT_FORCE_PULL, {0, 1, 0}, 9, 0, 0, PELT_FREE};
  bad.forces = &force;
  bad.force_count = 1;
  ExpectRefused(pelt_begin(scene, &bad), "force volume 0: half of a side");
  bad = frame;
  bad.wind_kind = PELT_PUBLISHED_WIND + 1;
  ExpectRefused(pelt_begin(scene, &bad), "wind: its kind");
  bad = frame;
  bad.sun_direction[1] = 2;
  ExpectRefused(pelt_begin(scene, &bad), "sun's direction");
  ExpectRefused(pelt_run(scene, NULL), "no frame was begun");
  ExpectRefused(pelt_run(scene, &door), "enqueue and finish");
}

/* ---- Frames ---- */

enum { kDraws = 64 };

/* What an engine would upload of them, once and each frame. */
static void DrawShells(PeltScene* scene, const PeltDraw* draw, Canvas* canvas) {
  const uint32_t count = pelt_shell_indices(scene, draw->layer, NULL, 0);
  const uint32_t vertices = pelt_shell_uvs(scene, draw->layer, NULL, 0);
  const uint32_t side = pelt_fur_texture(scene, draw->layer, NULL, 0);
  Expect(count > 0 && count % 3 == 0 && side > 0, "triangles and a texture", draw->output_name);
  Expect(draw->vertex_bytes == 48 && draw->vertices_bytes == (size_t)vertices * 48, "vertices",
         draw->output_name);
  uint32_t* indices = malloc(count * sizeof *indices);
  float(*uvs)[2] = malloc(vertices * sizeof *uvs);
  uint8_t* texels = malloc((size_t)side * side);
  pelt_shell_indices(scene, draw->layer, indices, count);
  pelt_shell_uvs(scene, draw->layer, uvs, vertices);
  pelt_fur_texture(scene, draw->layer, texels, (size_t)side * side);
  uint32_t hairs = 0;
  for (uint32_t i = 0; i < side * side; ++i) hairs += texels[i] != 0;
  Expect(hairs > 0 && hairs < side * side, "hairs and gaps", draw->output_name);
  for (uint32_t i = 0; i < count; ++i) {
    Expect(indices[i] < vertices, "an index", draw->output_name);
    Expect(isfinite(uvs[indices[i]][0]) && isfinite(uvs[indices[i]][1]), "uv", draw->output_name);
  }
  for (uint32_t s = 0; s < draw->shell_count; ++s)
    DrawShell(canvas, draw->vertices, indices, count, draw->shells[s].height);
  Expect(draw->shell_count > 0 && draw->shells[draw->shell_count - 1].height == 1.0f, "shells",
         draw->output_name);
  free(indices);
  free(uvs);
  free(texels);
}

/* Each edge once, and none that is not seen. */
static void DrawFins(PeltScene* scene, const PeltDraw* draw, Canvas* canvas) {
  const uint32_t count = pelt_fins(scene, draw->layer, NULL, 0);
  const uint32_t vertices = (uint32_t)(draw->vertices_bytes / draw->vertex_bytes);
  Expect(count > 0 && draw->fur_shadow > 0.0f && draw->fur_shadow < 1.0f, "fins",
         draw->output_name);
  PeltFin* fins = malloc(count * sizeof *fins);
  Expect(pelt_fins(scene, draw->layer, fins, count) == count, "as many fins", draw->output_name);
  for (uint32_t i = 0; i < count; ++i) {
    Expect(fins[i].from < vertices && fins[i].to < vertices && fins[i].from != fins[i].to &&
               fins[i].fade >= 1 && fins[i].fade <= 255,
           "a fin", draw->output_name);
    DrawFin(canvas, draw->vertices, fins[i].from, fins[i].to);
  }
  free(fins);
}

static uint32_t DrawFrame(PeltScene* scene) {
  static Canvas canvas;
  PeltDraw draws[kDraws];
  const uint32_t count = pelt_draws(scene, draws, kDraws);
  if (count == 0 || count > kDraws) return 0;
  float low[3], high[3];
  memcpy(low, draws[0].low, sizeof low);
  memcpy(high, draws[0].high, sizeof high);
  for (uint32_t i = 1; i < count; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      if (draws[i].low[axis] < low[axis]) low[axis] = draws[i].low[axis];
      if (draws[i].high[axis] > high[axis]) high[axis] = draws[i].high[axis];
    }
  LookAt(&canvas, low, high);
  for (uint32_t i = 0; i < count; ++i) {
    const PeltDraw* draw = &draws[i];
    if (draw->output == PELT_SHELLS) {
      DrawShells(scene, draw, &canvas);
      DrawFins(scene, draw, &canvas);
      continue;
    }
    Expect(pelt_shell_indices(scene, draw->layer, NULL, 0) == 0 && draw->shell_count == 0 &&
               pelt_fins(scene, draw->layer, NULL, 0) == 0,
           "no shells", draw->output_name);
    if (draw->output == PELT_INSTANCES) {
      DrawInstances(&canvas, draw->vertices, draw->strand_count);
    } else if (draw->output == PELT_RIBBONS) {
      const uint32_t room = draw->strand_count * 24;
      uint32_t* indices = malloc(room * sizeof *indices);
      DrawRibbons(&canvas, draw->vertices, indices,
                  pelt_ribbon_indices(NULL, draw->strand_count, indices, room));
      free(indices);
    }
    PeltStrandCurve* curves = malloc(draw->live_strands * sizeof *curves);
    Expect(pelt_copy_curves(scene, draw->layer, curves, draw->live_strands) == draw->live_strands,
           "curves", draw->output_name);
    Expect(draw->strand_count <= draw->live_strands &&
               draw->live_strands <= pelt_strand_count(scene, draw->layer),
           "no more strands than the layer has", draw->output_name);
    Expect(curves[0].point[0][3] > 0.0f && pelt_layer_name(scene, draw->layer) != NULL, "a width",
           draw->output_name);
    free(curves);
  }
  return ShowCanvas(&canvas);
}

/* Two frames; in the second, what the capsule pushes away, if there is one. */
static uint64_t RunFrames(PeltBytes groom, int how, const PeltCapsule* capsule, uint64_t* first,
                          int show) {
  static Jobs jobs;
  char why[200] = "";
  Arena arena = {NULL, NULL, 0};
  const PeltSceneOptions options = {.allocate = Allocate, .user = &arena};
  PeltScene* scene = pelt_create(&groom, 1, &options, why, sizeof why);
  Expect(scene != NULL, "creates", why);
  if (!scene) return 0;
  TryBadFrames(scene);
  PeltFrame frame;
  pelt_default_frame(&frame);
  const PeltDoor door = {Enqueue, Finish, &jobs, 4};
  for (int f = 0; f < 2; ++f) {
    jobs.count = 0;
    frame.time_s = f * frame.dt_s;
    frame.capsules = capsule;
    frame.capsule_count = f == 1 && capsule ? 1 : 0;
    ExpectDone(pelt_begin(scene, &frame), "begins");
    ExpectDone(pelt_refused_pose(scene, 0), "the pose");
    Expect(pelt_draws(scene, NULL, 0) == 0, "no draws while a frame is open", "");
    if (how == 0) ExpectDone(pelt_run(scene, NULL), "runs");
    if (how == 1) ExpectDone(pelt_run(scene, &door), "runs through the door");
    if (how == 2) {
      ExpectDone(pelt_open(scene), "opens");
      for (uint32_t call = 0; pelt_pull_as(scene, call) != PELT_IDLE; ++call) continue;
      Expect(pelt_pull(scene) == PELT_IDLE, "pull", "behind the frame");
    }
    if (f == 0) *first = pelt_digest(scene);
  }
  ExpectDone(pelt_door_faults(scene), "door faults");
  if (show) Expect(DrawFrame(scene) > 50, "something to see", "");
  const uint64_t digest = pelt_digest(scene);
  pelt_destroy(scene);
  free(arena.given);
  return digest;
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  size_t bytes = 0;
  void* const file = ReadFile(argv[1], &bytes);
  if (!file) return 2;
  const PeltBytes groom = {file, bytes};
  TryNulls();
  TryBadScenes(groom);
  TryScales(groom);
  uint64_t first[3], last[3];
  const PeltCapsule in_the_fur = {{0, 0, 0}, {0, 1, 0.4f}, 0.2f,     0,
                                  PELT_FREE, {0, 0, 0},    {0, 0, 0}};
  for (int how = 0; how < 3; ++how)
    last[how] = RunFrames(groom, how, &in_the_fur, &first[how], how == 1);
  Expect(first[0] == first[1] && first[0] == first[2], "first digests", "differ");
  Expect(last[0] == last[1] && last[0] == last[2], "last digests", "differ");
  uint64_t same;
  Expect(RunFrames(groom, 0, NULL, &same, 0) != last[0] && same == first[0], "a capsule",
         "no touch");
  printf("%016llx\n", (unsigned long long)first[0]);
  free(file);
  return failures;
}
