// Fur as relief on the skin ("groom parallax mapping"): the eye's ray is followed through a tile of hairs that lean as
// the groom does, so that a flat surface shows their sides, gaps and shadows. It needs no geometry, and has no
// outline of its own.
//
// Directions are in the tangent space of the texture: x along u, y along v, z along the normal. A flow is the direction
// of a hair, root to tip, and need not be unit. Heights are 0 at the skin and 1 at the longest hair's tip; what is seen
// of the mesh is where the ray enters at 1. Hairs are distinguished by where their roots are: a place at height h on a
// hair that leans is above another root, which is why flow and view act as one shift.
//
// Source: Tatarchuk, "Dynamic Parallax Occlusion Mapping with Approximate Soft Shadows", 2006; Estevez & Kulla,
// "Production Friendly Microfacet Sheen BRDF", 2017 (Charlie); Ashikhmin & Premoze, "Distribution-based BRDFs", 2007;
// Neubelt & Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886", 2013 (visibility).
// After: strand_shading.glsl

// Lower than this neither view nor hair is followed: what lies flat would be shifted without end.
CONST float kReliefLowest = 0.2f;

// The flow that a texel of a flow map holds, its channels 0 to 1 (core/groom/flow_map.hpp); unit.
FN vec3 ReliefFlow(vec4 texel) {
  vec2 lean = (vec2(texel) * 255.0f - 128.0f) / 127.0f;
  return vec3(lean, sqrt(max(1.0f - dot(lean, lean), 0.0f)));
}

// Layers that the ray is followed through: the fewest where it goes along the hairs, more the more it goes across.
FN float ReliefSteps(vec3 flow, vec3 view, float least, float most) {
  return max(least, least + (most - least) * (1.0f - dot(flow, view)));
}

// How far the roots below the ray move while it sinks by `depth`.
FN vec2 ReliefShift(vec3 flow, vec3 view, float depth) {
  return (vec2(view) / max(view.z, kReliefLowest) - vec2(flow) / max(flow.z, kReliefLowest)) * depth;
}

// The first hair that the ray meets: its place in the tile, and the height there; at the skin, if none. `shift` is
// ReliefShift of the whole depth in the tile's coordinates.
FN_OF_TILE vec3 ReliefHit(TILE tile, vec2 entry, vec2 shift, float steps) {
  int count = int(ceil(steps));
  float step_size = 1.0f / float(count);
  float last = 1.0f - TILE_HEIGHT(tile, entry);  // of the ray above the hairs
  for (int i = 1; i <= count; ++i) {
    float sunk = float(i) * step_size;
    float above = 1.0f - sunk - TILE_HEIGHT(tile, entry - shift * sunk);
    if (above <= 0.0f) {
      float met = sunk - step_size * above / min(above - last, -1e-6f);
      return vec3(entry - shift * met, 1.0f - met);
    }
    last = above;
  }
  return vec3(entry - shift, 0.0f);
}

// Light that reaches this height of a coat from all around; `floor_light` of it reaches the skin.
FN float ReliefAmbient(float height, float floor_light) {
  return floor_light + (1.0f - floor_light) * height;
}

// Share of a light that reaches what was hit, past the hairs that stand higher towards it. `shift` is ReliefShift
// towards the light, as above; `strength` the share that a hair takes which stands a quarter of the depth above the ray.
FN_OF_TILE float ReliefShadow(TILE tile, vec3 hit, vec2 shift, float strength) {
  float most = 0.0f;
  for (int i = 1; i <= 4; ++i) {
    float rise = (1.0f - hit.z) * 0.25f * float(i);
    most = max(most, TILE_HEIGHT(tile, vec2(hit) + shift * rise) - hit.z - rise);
  }
  return 1.0f - strength * Saturate(4.0f * most);
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
  return at_normal + (1.0f - at_normal) * pow(Saturate(1.0f - cosine), 5.0f);
}

// The soft edge of velvet and short fur, of a light of 1: the more aslant it is seen, the more fibres shine.
FN float ReliefSheen(vec3 normal, vec3 to_light, vec3 to_eye, float roughness) {
  vec3 halfway = Halfway(to_light, to_eye);
  float n_dot_l = Saturate(dot(normal, to_light));
  float n_dot_v = Saturate(dot(normal, to_eye));
  return SheenCharlie(Saturate(dot(normal, halfway)), roughness) *
         SheenVisibility(n_dot_v, n_dot_l) * Fresnel(n_dot_v, 0.04f) *
         n_dot_l * 3.14159265f;
}
