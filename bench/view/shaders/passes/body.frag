// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: studio.glsl
// After: passes/frame.glsl
// After: paint_shading.glsl
// After: passes/painted.glsl
in vec3 skin_at, skin_normal, skin_fur;
in vec3 skin_shares;
in vec4 skin_tint;
in vec2 skin_uv;
in vec4 skin_paint;
out vec4 colour;

uniform sampler2D surface;  // sRGB

void main() {
  vec3 image = texture(surface, skin_uv).rgb;
  vec3 own = skin_tint.rgb *
             vec3(LinearFromSrgb(image.r), LinearFromSrgb(image.g), LinearFromSrgb(image.b));
  bool unlit = skin_tint.a > 0.5;
  vec3 skin = unlit ? skin_fur : mix(own, skin_fur, skin_shares.x);
  if (skin_paint != vec4(0.0)) skin = PaintedColour(LookOfPaint(), skin, skin_paint);
  vec3 shaded = ShadeSkin(light, look, skin, normalize(skin_normal), normalize(eye - skin_at),
                          skin_shares.y, skin_shares.z);
  if (unlit) shaded = mix(vec3(Untone(own.r), Untone(own.g), Untone(own.b)), shaded, skin_shares.x);
  colour = vec4(shaded, 1.0);
}
