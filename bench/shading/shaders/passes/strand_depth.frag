// After: strand_texture.glsl
// After: passes/card.glsl

in float coverage;
out vec4 colour;

void main() {
  if (coverage * OnCard(vec3(0.0), vec3(0.0)).a <= 0.3) discard;
  colour = vec4(0.0);
}
