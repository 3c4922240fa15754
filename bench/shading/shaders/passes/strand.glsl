// A strand of a layer, by the instance's number: vertices as LayerDraw has them, in texels of 16
// bytes, and what they do not say of its root. A file of readers/ makes a knot of each format.
uniform usampler2D vertices;
// Two for each place of the drawing order: root, m, and depth of light; normal, strand with kCard.
uniform usampler2D roots;
uniform usampler2D looks;  // of a lit layer: LookRecord, in strand order
uniform int knots;
uniform int is_lit, in_strand_order;
uniform int first_strand;  // of the layer, among all of the scene
uniform float tip_width;
uniform float samples_at_1m;  // that a metre across the view covers, 1 m ahead

const uint kCard = 0x80000000u;  // wide enough to show silhouettes of several hairs

uvec4 Texel(usampler2D texels, uint i) {
  return texelFetch(texels, ivec2(int(i & 2047u), int(i >> 11u)), 0);
}

struct Strand {
  uint number;  // of the scene
  uint record;  // its place in `vertices`
  vec3 root, normal;
  float depth;
  vec4 paint;  // amounts of mud, snow, water, dust
  int strip;   // of the film strip; -1: a hair of its own
};

uint ReadStrip(uint record);

Strand ReadStrand() {
  uint place = uint(gl_InstanceID);
  uvec4 first = Texel(roots, 2u * place), second = Texel(roots, 2u * place + 1u);
  uint number = second.w & ~kCard;
  uvec4 record = is_lit != 0 ? Texel(looks, number) : uvec4(0u);
  vec3 normal = is_lit != 0 ? OctahedralNormal(record.x) : uintBitsToFloat(second.xyz);
  uint vertex_record = in_strand_order != 0 ? number : place;
  int strip = (second.w & kCard) != 0u ? int(ReadStrip(vertex_record)) : -1;
  return Strand(uint(first_strand) + number, vertex_record, uintBitsToFloat(first.xyz), normal,
                uintBitsToFloat(first.w), Unorm8x4(record.z), strip);
}

struct Knot {
  vec3 at;
  float width;  // m, whole
  vec3 tangent, across;
  vec4 colour;  // linear; a carries the LOD fade
};

// One of the two corners at a knot: hairs thinner than a sample are as wide as one, with less
// coverage. `place` is card.glsl's, `along` the knot's share of the strand.
vec4 CornerOf(Knot knot, float side, float along, out float coverage, out vec3 place) {
  float samples_per_m = samples_at_1m / (world_to_clip * vec4(knot.at, 1.0)).w;
  float wide = knot.width * samples_per_m;
  coverage = min(wide, 1.0) * knot.colour.a;
  float from_middle = max(wide, 1.0) * (side - 0.5);
  place = vec3(from_middle, max(wide, 1.0), along);
  return world_to_clip * vec4(knot.at + knot.across * (from_middle / samples_per_m), 1.0);
}
