// Blended by MIN and ADD. Coverage is whole numbers, whose sums are exact: no order of drawing
// gives other bits.

in float from_front;
in float covered;
out vec4 texel;

void main() { texel = vec4(vec3(from_front), floor(covered * 255.0 + 0.5)); }
