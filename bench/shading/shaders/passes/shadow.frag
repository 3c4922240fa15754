// Blended by MIN and ADD. Coverage is whole numbers, whose sums are exact: no order of drawing
// gives other bits. What covers less than `shadow_alpha` is cut.

uniform float shadow_alpha;  // of strands; else 0

in float from_front;
in float covered;
out vec4 texel;

void main() {
  if (covered < shadow_alpha) discard;
  texel = vec4(vec3(from_front), floor(covered * 255.0 + 0.5));
}
