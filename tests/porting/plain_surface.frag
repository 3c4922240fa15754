// What relief.frag's instructions are compared with (shaders_test.sh): a surface with colour and normal maps, a sun
// with GGX highlights, and light from all around.
#version 450
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec2 uv;
layout(binding = 0) uniform Surface {
  vec3 eye;
  float roughness;
  vec3 to_sun, sun, ambient;
};
layout(binding = 1) uniform sampler2D colours;
layout(binding = 2) uniform sampler2D normals;
layout(location = 0) out vec4 colour;

void main() {
  const vec3 across = cross(normal, tangent.xyz) * tangent.w, bump = texture(normals, uv).xyz * 2.0 - 1.0;
  const vec3 n = normalize(tangent.xyz * bump.x + across * bump.y + normal * bump.z);
  const vec3 to_eye = normalize(eye - position), halfway = normalize(to_sun + to_eye);
  const float n_l = max(dot(n, to_sun), 0.0), n_v = max(dot(n, to_eye), 1e-3), n_h = max(dot(n, halfway), 0.0);
  const float alpha = roughness * roughness, squared = alpha * alpha, k = 0.5 * alpha;
  const float bottom = n_h * n_h * (squared - 1.0) + 1.0, seen = 0.25 / ((n_v * (1.0 - k) + k) * (n_l * (1.0 - k) + k));
  const float fresnel = 0.04 + 0.96 * pow(1.0 - max(dot(to_eye, halfway), 0.0), 5.0);
  const vec4 own = texture(colours, uv);
  const float shine = squared / (3.14159265 * bottom * bottom) * seen * fresnel;
  colour = vec4(own.rgb * (ambient + sun * n_l) + sun * (shine * n_l), own.a);
}
