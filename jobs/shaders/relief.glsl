// Fur as relief on the skin ("groom parallax mapping"): the eye's ray is followed through a tile of hairs that lean as
// the groom does, so that a flat surface shows their sides, gaps and shadows. It needs no geometry, and has no
// outline of its own. One text that is GLSL, HLSL (relief.ps.hlsl) and C++ (bench/shading/shading.hpp); jobs/DRAWING.md
// says how an engine takes it. TraceRelief below is all of it for a place, DrawRelief that with light.
//
// Directions are in the tangent space of the texture: x along u, y along v, z along the normal. A flow is the direction
// of a hair, root to tip, and need not be unit. Heights are 0 at the skin and 1 at the longest hair's tip; what is seen
// of the mesh is where the ray enters at 1. Hairs are distinguished by where their roots are: a place at height h on a
// hair that leans is above another root, which is why flow and view act as one shift.
//
// Source: Tatarchuk, "Dynamic Parallax Occlusion Mapping with Approximate Soft Shadows", 2006; Estevez & Kulla,
// "Production Friendly Microfacet Sheen BRDF", 2017 (Charlie); Ashikhmin & Premoze, "Distribution-based BRDFs", 2007;
// Neubelt & Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886", 2013 (visibility); Jimenez,
// "Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014 (interleaved gradient noise).
#ifndef FN
#define FN
#endif
// Of a constant; and of a function that looks up a tile of hairs, which is its first argument, and a height of it.
#ifndef CONST
#define CONST const
#endif
#ifndef TILE
#define FN_OF_TILE
#define TILE sampler2D
#define TILE_HEIGHT(tile, place) textureLod(tile, place, 0.0).r
#endif

// Lower than this neither view nor hair is followed: what lies flat would be shifted without end.
CONST float kReliefLowest = 0.2f;
CONST float kReliefDepth = 0.3f;  // of the fur's height, that a flat skin can show
CONST float kReliefShadow = 0.75f;
CONST float kReliefGust = 0.0833333f;  // a gust is as wide as 12 hairs

// A place on the skin, and the fur that grows there.
struct ReliefPoint {
  vec3 colour, tip_colour;  // of the hairs' two ends, linear
  vec3 normal;              // unit
  vec3 axis_u, axis_v;      // metres that the skin goes along for one unit of u and of v
  vec2 uv;
  vec2 repeat;        // how often the tile of hairs goes along u and v
  vec4 flow;          // the flow map's texel, channels 0 to 1
  float longest;      // of the flow map, m
  float floor_light;  // share of light that reaches the skin
  float sun_share;
  vec3 to_eye;  // unit
};

// How the eye's ray is followed, and how wind moves the hairs.
struct ReliefMarch {
  float least, most;  // steps: where the ray goes along the hairs, and across them; 1 or more
  float jitter;       // 0 to 1: the share of a step that all of them are nearer by, ReliefJitter; 0: none
  vec3 wind;          // how far a gust pushes the tips of the longest hairs, world, m; 0: none
  vec2 pan;           // how far the gusts have gone, in tiles of 12 x 12: time times a speed
};

// What is seen there.
struct ReliefFur {
  vec3 hair;     // its direction, unit, world
  vec2 place;    // in the tile
  float height;  // on the hair
  float steps;   // that the ray was followed for
  float light, sun_share;  // share of the light from all around that reaches it, and of the sun
};

// The flow that a texel of a flow map holds, its channels 0 to 1 (core/groom/flow_map.hpp); unit.
FN vec3 ReliefFlow(vec4 texel) {
  vec2 lean = (vec2(texel.x, texel.y) * 255.0f - 128.0f) / 127.0f;
  return vec3(lean, sqrt(max(1.0f - dot(lean, lean), 0.0f)));
}

// Steps that the ray is followed for at most: the fewest where it goes along the hairs, more the more it goes across.
FN float ReliefSteps(vec3 flow, vec3 view, float least, float most) {
  return max(least, least + (most - least) * (1.0f - dot(flow, view)));
}

// How far the roots below the ray move while it sinks by `depth`.
FN vec2 ReliefShift(vec3 flow, vec3 view, float depth) {
  return (vec2(view.x, view.y) / max(view.z, kReliefLowest) -
          vec2(flow.x, flow.y) / max(flow.z, kReliefLowest)) * depth;
}

// Of a pixel in a frame, 0 to 1: what lies between two steps is seen in other frames and pixels, so that few steps look
// like many where frames are accumulated (temporal antialiasing, or the eye).
FN float ReliefJitter(vec2 pixel, float frame) {
  float x = pixel.x + 5.588238f * frame, y = pixel.y + 5.588238f * frame;
  float inner = 0.06711056f * x + 0.00583715f * y;
  float noise = 52.9829189f * (inner - floor(inner));
  return noise - floor(noise);
}

// The first hair that the ray meets: its place in the tile, the height there, and steps until then; at the skin, if
// none. `shift` is ReliefShift of the whole depth in the tile's coordinates.
FN_OF_TILE vec4 ReliefHit(TILE tile, vec2 entry, vec2 shift, float steps, float jitter) {
  int count = int(ceil(steps));
  float step_size = 1.0f / float(count);
  float last = 1.0f - TILE_HEIGHT(tile, entry);  // of the ray above the hairs
  int last_step = jitter > 0.0f ? count + 1 : count;  // which ends at the skin
  for (int i = 1; i <= last_step; ++i) {
    float sunk = min((float(i) - jitter) * step_size, 1.0f);
    vec2 place = entry - shift * sunk;
    float above = 1.0f - sunk - TILE_HEIGHT(tile, place);
    if (above <= 0.0f) {
      float stepped = i == 1 ? sunk : (i > count ? jitter * step_size : step_size);
      float met = sunk - stepped * above / min(above - last, -1e-6f);
      place = entry - shift * met;
      return vec4(place.x, place.y, 1.0f - met, float(i));
    }
    last = above;
  }
  vec2 root = entry - shift;
  return vec4(root.x, root.y, 0.0f, float(last_step));
}

// Light that reaches this height of a coat from all around; `floor_light` of it reaches the skin.
FN float ReliefAmbient(float height, float floor_light) {
  return floor_light + (1.0f - floor_light) * height;
}

// Share of a light that reaches what was hit, past the hairs that stand higher towards it. `shift` is ReliefShift
// towards the light, as above; `strength` the share that a hair takes that is a quarter of the depth above the ray.
FN_OF_TILE float ReliefShadow(TILE tile, vec3 hit, vec2 shift, float strength) {
  float most = 0.0f;
  for (int i = 1; i <= 4; ++i) {
    float rise = (1.0f - hit.z) * 0.25f * float(i);
    most = max(most, TILE_HEIGHT(tile, vec2(hit.x, hit.y) + shift * rise) - hit.z - rise);
  }
  return 1.0f - strength * clamp(4.0f * most, 0.0f, 1.0f);
}

// Of fibres that stand up, by how far the half vector is from the normal; both distributions are normalised.
FN float SheenCharlie(float n_dot_h, float roughness) {
  float across = max(1.0f - n_dot_h * n_dot_h, 1e-6f);
  return (2.0f + 1.0f / roughness) * pow(across, 0.5f / roughness) * 0.15915494f;
}

FN float SheenAshikhmin(float n_dot_h, float roughness) {
  float rough = roughness * roughness, along = n_dot_h * n_dot_h;
  float across = max(1.0f - along, 0.0078125f);
  float hollow = 4.0f * exp(-along / (rough * across));
  return (hollow / (across * across) + 1.0f) / (3.14159265f * (4.0f * rough + 1.0f));
}

// What of the sheen is seen, with the microfacet's denominator.
FN float SheenVisibility(float n_dot_v, float n_dot_l) {
  return 1.0f / (4.0f * max(n_dot_l + n_dot_v - n_dot_l * n_dot_v, 1e-4f));
}

// Schlick's, of the angle to the normal.
FN float Fresnel(float cosine, float at_normal) {
  return at_normal + (1.0f - at_normal) * pow(clamp(1.0f - cosine, 0.0f, 1.0f), 5.0f);
}

// The soft edge of velvet and short fur, of a light of 1: the more aslant it is seen, the more fibres shine.
FN float ReliefSheen(vec3 normal, vec3 to_light, vec3 to_eye, float roughness) {
  vec3 sum = to_light + to_eye;
  vec3 halfway = sum / max(length(sum), 1e-6f);
  float n_dot_l = clamp(dot(normal, to_light), 0.0f, 1.0f);
  float n_dot_v = clamp(dot(normal, to_eye), 0.0f, 1.0f);
  return SheenCharlie(clamp(dot(normal, halfway), 0.0f, 1.0f), roughness) *
         SheenVisibility(n_dot_v, n_dot_l) * Fresnel(n_dot_v, 0.04f) *
         n_dot_l * 3.14159265f;
}

FN vec3 UnitOr(vec3 v, vec3 otherwise) {
  float size = length(v);
  return size > 1e-12f ? v / size : otherwise;
}

// The steps along u and v that make up the step `d`, as well as they can.
FN vec2 InTexture(vec3 d, vec3 u, vec3 v) {
  float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
  float det = uu * vv - uv * uv;
  if (!(det > 1e-6f * uu * vv)) return vec2(0.0f, 0.0f);
  float du = dot(d, u), dv = dot(d, v);
  return vec2(du * vv - dv * uv, dv * uu - du * uv) / det;
}

// A ReliefPoint's axes, of a mesh that has none: from how its place and u, v change to the next pixels, dFdx and dFdy.
struct ReliefAxes {
  vec3 u, v;
};
FN ReliefAxes FindReliefAxes(vec3 at_x, vec3 at_y, vec2 uv_x, vec2 uv_y) {
  float det = uv_x.x * uv_y.y - uv_y.x * uv_x.y;
  float scale = abs(det) > 1e-20f ? 1.0f / det : 0.0f;
  ReliefAxes axes;
  axes.u = (at_x * uv_y.y - at_y * uv_x.y) * scale;
  axes.v = (at_y * uv_x.x - at_x * uv_y.x) * scale;
  return axes;
}

// Along u on the skin, across it, the normal; and a direction's parts along them.
struct ReliefFrame {
  vec3 x, y, z;
};
FN vec3 PartsAlong(ReliefFrame frame, vec3 d) {
  return vec3(dot(frame.x, d), dot(frame.y, d), dot(frame.z, d));
}

// ReliefShift in the tile's coordinates, of directions in the world.
FN vec2 ReliefTileShift(ReliefPoint p, ReliefFrame frame, vec3 hair, vec3 towards, float depth) {
  vec2 m = ReliefShift(PartsAlong(frame, hair), PartsAlong(frame, towards), depth);
  return InTexture(frame.x * m.x + frame.y * m.y, p.axis_u, p.axis_v) * p.repeat;
}

// The fur that is seen at the place.
FN_OF_TILE ReliefFur TraceRelief(TILE tile, ReliefMarch march, ReliefPoint p, vec3 to_sun) {
  vec3 flow = ReliefFlow(p.flow), none = vec3(0.0f, 0.0f, 0.0f);
  vec3 along = p.axis_u * flow.x + p.axis_v * flow.y;  // the skin; zero where hairs stand up
  along = UnitOr(along - p.normal * dot(along, p.normal), none);
  ReliefFur fur;
  fur.hair = UnitOr(along * length(vec2(flow.x, flow.y)) + p.normal * flow.z, p.normal);
  ReliefFrame frame;
  frame.x = UnitOr(p.axis_u - p.normal * dot(p.axis_u, p.normal), along);
  frame.y = cross(p.normal, frame.x);
  frame.z = p.normal;
  float size = p.flow.z * p.longest;
  float depth = kReliefDepth * p.flow.z * p.longest * max(flow.z, kReliefLowest);
  vec2 entry = p.uv * p.repeat;
  vec2 shift = ReliefTileShift(p, frame, fur.hair, p.to_eye, depth);
  vec2 sun_shift = ReliefTileShift(p, frame, fur.hair, to_sun, depth);
  float steps = ReliefSteps(PartsAlong(frame, fur.hair), PartsAlong(frame, p.to_eye), march.least, march.most);
  if (dot(march.wind, march.wind) > 0.0f) {
    // Roots stay and tips are pushed, evenly in between: the root below a place is another one, as by a flow.
    float gust = TILE_HEIGHT(tile, entry * kReliefGust - march.pan);
    vec3 push = (march.wind - p.normal * dot(march.wind, p.normal)) * (gust * p.flow.z);
    vec2 sway = InTexture(push * kReliefDepth, p.axis_u, p.axis_v) * p.repeat;
    entry -= sway;
    shift -= sway;
    sun_shift -= sway;
    fur.hair = UnitOr(fur.hair * size + push, fur.hair);
  }
  vec4 hit = ReliefHit(tile, entry, shift, steps, march.jitter);
  fur.place = vec2(hit.x, hit.y);
  fur.height = hit.z;
  fur.steps = hit.w;
  fur.light = ReliefAmbient(hit.z, p.floor_light);
  fur.sun_share = p.sun_share * ReliefShadow(tile, vec3(hit.x, hit.y, hit.z), sun_shift, kReliefShadow);
  return fur;
}

// Steps as a colour: blue for none, green for half of `most`, red for all of them and more.
FN vec3 ReliefStepColour(float steps, float most) {
  float share = clamp(2.0f * steps / most, 0.0f, 2.0f);
  return vec3(max(share - 1.0f, 0.0f), 1.0f - abs(share - 1.0f), max(1.0f - share, 0.0f));
}

// All that relief.frag is given: rows of 16 bytes in GLSL's std140, in HLSL and in C++. Colours are linear.
struct ReliefSettings {
  vec3 eye;          // m, world
  float longest;     // of the flow map, m
  vec3 base_colour;  // of the hairs
  float least_steps;
  vec3 tip_colour;
  float most_steps;
  vec3 to_sun;  // unit, world
  float floor_light;
  vec3 sun;     // what a white patch that faces it reflects
  float frame;  // number of the frame, where frames are accumulated; below 0: no jitter
  vec3 ambient;
  float roughness;  // of the sheen
  vec3 wind;           // ReliefMarch's
  float shows_steps;   // above 0: ReliefStepColour
  vec4 repeat_pan;     // ReliefPoint's repeat, ReliefMarch's pan
};

// The fur at a place of the skin under a sun and light from all around, premultiplied: Kajiya and Kay's diffuse light
// and a sheen. An engine's own hair shading takes TraceRelief instead.
FN_OF_TILE vec4 DrawRelief(TILE tile, ReliefSettings s, ReliefAxes axes, vec3 position, vec3 normal, vec2 uv, vec4 flow,
                           vec2 pixel) {
  ReliefPoint p;
  p.colour = s.base_colour;
  p.tip_colour = s.tip_colour;
  p.normal = normalize(normal);
  p.axis_u = axes.u;
  p.axis_v = axes.v;
  p.uv = uv;
  p.repeat = vec2(s.repeat_pan.x, s.repeat_pan.y);
  p.flow = flow;
  p.longest = s.longest;
  p.floor_light = s.floor_light;
  p.sun_share = 1.0f;  // or what a shadow map says
  p.to_eye = normalize(s.eye - position);
  ReliefMarch march;
  march.least = s.least_steps;
  march.most = s.most_steps;
  march.jitter = s.frame < 0.0f ? 0.0f : ReliefJitter(floor(pixel), s.frame);
  march.wind = s.wind;
  march.pan = vec2(s.repeat_pan.z, s.repeat_pan.w);
  ReliefFur fur = TraceRelief(tile, march, p, s.to_sun);
  vec3 hair = mix(s.base_colour, s.tip_colour, fur.height), white = vec3(1.0f, 1.0f, 1.0f);
  float along = dot(fur.hair, s.to_sun);
  float facing = sqrt(max(1.0f - along * along, 0.0f)) * max(dot(p.normal, s.to_sun), 0.0f);
  float shine = ReliefSheen(p.normal, s.to_sun, p.to_eye, s.roughness);
  vec3 lit = hair * s.ambient * fur.light +
             s.sun * (hair * (facing * fur.light) + mix(hair, white, 0.25f) * shine) * fur.sun_share;
  if (s.shows_steps > 0.0f) lit = ReliefStepColour(fur.steps, s.most_steps);
  return vec4(lit.x, lit.y, lit.z, 1.0f) * flow.w;
}
