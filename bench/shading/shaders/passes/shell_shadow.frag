// shadow.frag, but that where no hair is there is no distance either.

in float from_front;
in float covered;
out vec4 texel;

void main() {
  float coverage = floor(covered * 255.0 + 0.5);
  if (coverage <= 0.0) discard;
  texel = vec4(vec3(from_front), coverage);
}
