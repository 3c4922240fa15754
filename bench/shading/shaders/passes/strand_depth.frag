// After: passes/card.glsl

in float coverage;
out vec4 colour;

void main() {
  if (coverage * CardCover() <= 0.3) discard;
  colour = vec4(0.0);
}
