// Instances (jobs/DRAWING.md): 64 bytes per strand. A strand is drawn as a triangle strip of two
// vertices at each of `knots` places along its curve; no index buffer and no vertex buffer.
//   DrawInstanced(2 * knots, strand_count, 0, 0)
// The input layout, each per instance: R32G32B32A32_FLOAT at 0, 16 and 32, R8G8B8A8_UNORM at 48 and
// 52, R32_FLOAT at 56, R32_UINT at 60.

cbuffer Frame : register(b0) {
  float4x4 world_to_clip;
  float3 eye;       // m, world
  float tip_width;  // the draw's: over the width at the root
  int knots;        // 2 or more
};

struct Strand {
  float4 curve_a : CURVE0;     // c0, and c1.x
  float4 curve_b : CURVE1;     // c1.yz, c2.xy
  float4 curve_c : CURVE2;     // c2.z, c3
  float4 base_colour : COLOR0;  // sRGB
  float4 tip_colour : COLOR1;
  float width : WIDTH;  // m, whole, at the root
  uint tag : TAG;
};

struct Hair {
  float4 position : SV_Position;
  float4 colour : COLOR;  // linear; a carries the LOD fade
  float3 tangent : TANGENT;
  float2 across_along : TEXCOORD0;  // u across the hair, v from root to tip
  nointerpolation uint film_strip : TEXCOORD1;
};

float3 Linear(float3 srgb) {
  const float3 low = srgb / 12.92;
  const float3 high = pow((srgb + 0.055) / 1.055, 2.4);
  return lerp(low, high, step(0.04045, srgb));
}

float3 NormalizeOr(float3 a, float3 otherwise) {
  const float squared = dot(a, a);
  return squared > 1e-20 ? a * rsqrt(squared) : otherwise;
}

Hair main(Strand strand, uint vertex : SV_VertexID) {
  const float3 c0 = strand.curve_a.xyz;
  const float3 c1 = float3(strand.curve_a.w, strand.curve_b.xy);
  const float3 c2 = float3(strand.curve_b.zw, strand.curve_c.x);
  const float3 c3 = strand.curve_c.yzw;
  const float t = float(vertex / 2) / float(knots - 1);
  const float side = float(vertex % 2);
  const float3 at = c0 + t * (c1 + t * (c2 + t * c3));
  const float3 tangent = NormalizeOr(c1 + t * (2.0 * c2 + t * 3.0 * c3), float3(0.0, 1.0, 0.0));
  const float3 across = NormalizeOr(cross(tangent, eye - at), float3(1.0, 0.0, 0.0));
  const float half_width = 0.5 * strand.width * lerp(1.0, tip_width, t);
  Hair hair;
  hair.position = mul(world_to_clip, float4(at + across * (half_width * (2.0 * side - 1.0)), 1.0));
  hair.colour = lerp(float4(Linear(strand.base_colour.rgb), strand.base_colour.a),
                     float4(Linear(strand.tip_colour.rgb), strand.tip_colour.a), t);
  hair.tangent = tangent;
  hair.across_along = float2(side, t);
  hair.film_strip = strand.tag >> 24;
  return hair;
}
