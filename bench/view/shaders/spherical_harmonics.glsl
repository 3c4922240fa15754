// The functions of spherical_harmonics.hpp, which says what they are and where they come from.
// GLSL 3.30 core and ES 3.00; the host puts the version line.
precision highp float;
precision highp int;

const float kPi = 3.14159265;
const vec4 kShLambert = vec4(1.0, 2.0 / 3.0, 0.25, 0.0);
const vec4 kShHair = vec4(1.0, 0.0, -0.125, 0.0);

void ShBasis(vec3 d, out float y[16]) {
  float xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z;
  y[0] = 0.282094792;
  y[1] = 0.488602512 * d.y;
  y[2] = 0.488602512 * d.z;
  y[3] = 0.488602512 * d.x;
  y[4] = 1.092548431 * d.x * d.y;
  y[5] = 1.092548431 * d.y * d.z;
  y[6] = 0.315391565 * (3.0 * zz - 1.0);
  y[7] = 1.092548431 * d.x * d.z;
  y[8] = 0.546274215 * (xx - yy);
  y[9] = 0.590043590 * d.y * (3.0 * xx - yy);
  y[10] = 2.890611442 * d.x * d.y * d.z;
  y[11] = 0.457045799 * d.y * (5.0 * zz - 1.0);
  y[12] = 0.373176333 * d.z * (5.0 * zz - 3.0);
  y[13] = 0.457045799 * d.x * (5.0 * zz - 1.0);
  y[14] = 1.445305721 * d.z * (xx - yy);
  y[15] = 0.590043590 * d.x * (xx - 3.0 * yy);
}

vec3 ShLight(vec3 sh[16], vec3 d, vec4 bands) {
  float y[16];
  ShBasis(d, y);
  vec3 sum = sh[0] * (y[0] * bands.x);
  for (int i = 1; i < 4; ++i) sum += sh[i] * (y[i] * bands.y);
  for (int i = 4; i < 9; ++i) sum += sh[i] * (y[i] * bands.z);
  for (int i = 9; i < 16; ++i) sum += sh[i] * (y[i] * bands.w);
  return max(sum, vec3(0.0));
}

void ShAddZonal(vec3 d, vec4 zonal, vec3 colour, inout vec3 sh[16]) {
  float y[16];
  ShBasis(d, y);
  for (int i = 0; i < 16; ++i) {
    int band = i == 0 ? 0 : i < 4 ? 1 : i < 9 ? 2 : 3;
    float turned = sqrt(4.0 * kPi / float(2 * band + 1)) * zonal[band];
    sh[i] += colour * (turned * y[i]);
  }
}

vec4 ShDelta() { return sqrt(vec4(1.0, 3.0, 5.0, 7.0) * (kPi / 4.0)); }

vec4 ShDisc(float half_angle) {
  float c = cos(half_angle);
  float ring = 1.0 - c * c;
  return vec4(sqrt(kPi) * (1.0 - c), sqrt(3.0 * kPi) * 0.5 * ring, sqrt(5.0 * kPi) * 0.5 * c * ring,
              sqrt(7.0 * kPi) * 0.125 * ring * (5.0 * c * c - 1.0));
}

vec4 ShHemisphere() { return ShDisc(0.5 * kPi); }

vec4 ShWindow(float width) { return 0.5 + 0.5 * cos(vec4(0.0, 1.0, 2.0, 3.0) * (kPi / width)); }

vec4 ShWrapped(float w) {
  float rest = (1.0 - w * w) * (1.0 - w * w) / 8.0;
  float slope = (1.0 + w * w * w) / 3.0 + 0.5 * w * (1.0 - w * w);
  return 2.0 * kPi / (1.0 + w) * vec4(0.5 * (1.0 + w) * (1.0 + w), slope, rest, -w * rest);
}

vec4 ShGloss(float e) {
  return 2.0 * kPi * vec4(1.0 / (e + 1.0), 1.0 / (e + 2.0), e / ((e + 1.0) * (e + 3.0)),
                          (e - 1.0) / ((e + 2.0) * (e + 4.0)));
}
