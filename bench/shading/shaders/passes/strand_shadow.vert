// A strand in the sun's map: a line, as wide as a texel, that covers what the hair does of it; of a
// card, its silhouettes' share, and of an artist's what it covers there.
// After: strand_shading.glsl
// After: film_strip.glsl
// After: spherical_harmonics.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
// After: strand_texture.glsl
// After: passes/strand.glsl
uniform int character;
uniform float map_side;  // texels
uniform float shadow_width;  // how many strands each stands for
#ifdef CARDS
uniform sampler2DArray strips;
uniform int strip_meaning;
#endif

out float from_front;
out float covered;

void main() {
  Strand strand = ReadStrand();
  Knot knot = ReadKnot(strand.record, gl_VertexID);
  vec4 ball = BallOf(character);
  vec3 at = ToMap(knot.at, ball, map_side);
  from_front = at.z;
  covered = min(knot.width * shadow_width * 0.5 * map_side / ball.w, 1.0) * knot.colour.a;
#ifdef CARDS
  if (strand.strip >= 0 && strip_meaning == 0) {
    covered *= StripShare(uint(strand.strip));
  } else if (strand.strip >= 0) {
    float along = float(gl_VertexID) / float(knots - 1), whole = log2(float(textureSize(strips, 0).x));
    vec4 texel = textureLod(strips, vec3(0.5, along, float(strand.strip)), whole);
    covered *= TexelCover(strip_meaning, texel, WetAndDirty(strand.paint));
  }
#endif
  gl_Position = vec4(at.xy * (2.0 / map_side) - 1.0, 0.0, 1.0);
}
