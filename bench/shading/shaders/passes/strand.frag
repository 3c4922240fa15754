// Premultiplied: drawn over what is there.
// After: passes/card.glsl

in vec3 lit;
in float coverage;
out vec4 colour;

void main() {
  float covered = coverage * CardCover();
  colour = vec4(lit * covered, covered);
}
