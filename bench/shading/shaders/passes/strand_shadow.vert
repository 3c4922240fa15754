// A strand in the sun's map: a line, as wide as a texel, that covers what the hair does of it; of a
// card, its silhouettes' share.
// After: strand_shading.glsl
// After: film_strip.glsl
// After: spherical_harmonics.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
// After: passes/strand.glsl
uniform int character;
uniform float map_side;  // texels
uniform float shadow_width;  // how many strands each stands for

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
  if (strand.strip >= 0) covered *= StripShare(uint(strand.strip));
#endif
  gl_Position = vec4(at.xy * (2.0 / map_side) - 1.0, 0.0, 1.0);
}
