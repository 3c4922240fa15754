// Light from all around as real spherical harmonics of bands 0 to 3, 16 coefficients a colour in the
// order (l, m) = 00, 1-1, 10, 11, 2-2 .. 22, 3-3 .. 33, all signs positive.
//
// Radiance 1 is what a white Lambert patch reflects that faces a sun of 1: pi of irradiance is in it.
// A surface weighs the bands with four factors, a vec4: how much of band l its lobe keeps.
//
// Source: Ramamoorthi & Hanrahan, "An Efficient Representation for Irradiance Environment Maps", 2001;
// Sloan, "Stupid Spherical Harmonics (SH) Tricks", 2008; Funk-Hecke's theorem for the lobes' factors.

CONST float kPi = 3.14159265f;
// Kept of each band of radiance by a white Lambert patch, and by Kajiya and Kay's sin(T, L) round a tangent;
// constant radiance 1 gives 1.
CONST vec4 kShLambert = vec4(1.0f, 2.0f / 3.0f, 0.25f, 0.0f);
CONST vec4 kShHair = vec4(1.0f, 0.0f, -0.125f, 0.0f);

// The functions' values in the unit direction d.
FN void ShBasis(vec3 d, out float y[16]) {
  float xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z;
  y[0] = 0.282094792f;
  y[1] = 0.488602512f * d.y;
  y[2] = 0.488602512f * d.z;
  y[3] = 0.488602512f * d.x;
  y[4] = 1.092548431f * d.x * d.y;
  y[5] = 1.092548431f * d.y * d.z;
  y[6] = 0.315391565f * (3.0f * zz - 1.0f);
  y[7] = 1.092548431f * d.x * d.z;
  y[8] = 0.546274215f * (xx - yy);
  y[9] = 0.590043590f * d.y * (3.0f * xx - yy);
  y[10] = 2.890611442f * d.x * d.y * d.z;
  y[11] = 0.457045799f * d.y * (5.0f * zz - 1.0f);
  y[12] = 0.373176333f * d.z * (5.0f * zz - 3.0f);
  y[13] = 0.457045799f * d.x * (5.0f * zz - 1.0f);
  y[14] = 1.445305721f * d.z * (xx - yy);
  y[15] = 0.590043590f * d.x * (xx - 3.0f * yy);
}

// What a lobe of these bands sees round the unit direction d; never below 0, where few bands swing to.
FN vec3 ShLight(const vec3 sh[16], vec3 d, vec4 bands) {
  float y[16];
  ShBasis(d, y);
  vec3 sum = sh[0] * (y[0] * bands.x);
  for (int i = 1; i < 4; ++i) sum += sh[i] * (y[i] * bands.y);
  for (int i = 4; i < 9; ++i) sum += sh[i] * (y[i] * bands.z);
  for (int i = 9; i < 16; ++i) sum += sh[i] * (y[i] * bands.w);
  return max(sum, vec3(0.0f));
}

// Adds light of a shape that is round about the unit direction d: `zonal` is its coefficient of m = 0 in
// each band, were d the axis z.
FN void ShAddZonal(vec3 d, vec4 zonal, vec3 colour, inout vec3 sh[16]) {
  float y[16];
  ShBasis(d, y);
  for (int i = 0; i < 16; ++i) {
    int band = i == 0 ? 0 : i < 4 ? 1 : i < 9 ? 2 : 3;
    float turned = sqrt(4.0f * kPi / float(2 * band + 1)) * zonal[band];
    sh[i] += colour * (turned * y[i]);
  }
}

// Zonal coefficients of a light at infinity that gives a white Lambert patch that faces it 1.
FN vec4 ShDelta() { return sqrt(vec4(1.0f, 3.0f, 5.0f, 7.0f) * (kPi / 4.0f)); }

// Of a disc of radiance 1 whose rim is seen under `half_angle` from its middle, rad: a ball of radius R in the
// distance D has asin(R / D), and pi / 2 from within.
FN vec4 ShDisc(float half_angle) {
  float c = cos(half_angle);
  float ring = 1.0f - c * c;
  return vec4(sqrt(kPi) * (1.0f - c), sqrt(3.0f * kPi) * 0.5f * ring, sqrt(5.0f * kPi) * 0.5f * c * ring,
              sqrt(7.0f * kPi) * 0.125f * ring * (5.0f * c * c - 1.0f));
}

// Of radiance 1 all over the half sphere round the axis.
FN vec4 ShHemisphere() { return ShDisc(0.5f * kPi); }

// Factors that keep cut-off bands from ringing behind strong lights: Hann's window of this width.
FN vec4 ShWindow(float width) { return 0.5f + 0.5f * cos(vec4(0.0f, 1.0f, 2.0f, 3.0f) * (kPi / width)); }

// Kept of each band, integrals over the sphere, by the lobes max(0, (z + w) / (1 + w)) and max(0, z)^e.
FN vec4 ShWrapped(float w) {
  float rest = (1.0f - w * w) * (1.0f - w * w) / 8.0f;
  float slope = (1.0f + w * w * w) / 3.0f + 0.5f * w * (1.0f - w * w);
  return 2.0f * kPi / (1.0f + w) * vec4(0.5f * (1.0f + w) * (1.0f + w), slope, rest, -w * rest);
}

FN vec4 ShGloss(float e) {
  return 2.0f * kPi * vec4(1.0f / (e + 1.0f), 1.0f / (e + 2.0f), e / ((e + 1.0f) * (e + 3.0f)),
                          (e - 1.0f) / ((e + 2.0f) * (e + 4.0f)));
}
