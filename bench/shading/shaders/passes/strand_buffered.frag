// After: strand_texture.glsl
// After: passes/card.glsl

uniform sampler2DArray lighting;
uniform vec2 target_size;  // samples

in vec3 sunlit, skylit, rimlit;
in float coverage;
out vec4 colour;

void main() {
  vec3 c = texture(lighting, vec3(gl_FragCoord.xy / target_size, 0.0)).rgb;
  vec3 shaded = max(sunlit * c.r + skylit * c.g + rimlit * c.b, vec3(0.0));
  vec4 seen = OnCard(shaded, vec3(0.0));  // the buffer has no highlights
  float covered = coverage * seen.a;
  colour = vec4(seen.rgb * covered, covered);
}
