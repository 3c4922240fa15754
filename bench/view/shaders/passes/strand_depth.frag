precision highp float;

in float coverage;
out vec4 colour;

void main() {
  if (coverage <= 0.3) discard;
  colour = vec4(0.0);
}
