// Instances (jobs/DRAWING.md): 64 bytes per strand. A strand is drawn as a triangle strip of two
// vertices at each of `knots` places along its curve; no index buffer and no vertex buffer.
//   DrawInstanced(2 * knots, strand_count, 0, 0)
// The input layout, each per instance: R32G32B32A32_FLOAT at 0, 16 and 32, R8G8B8A8_UNORM at 48 and
// 52, R32_FLOAT at 56, R32_UINT at 60.
#include "fur_vertex.hlsl"

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

Hair main(Strand strand, uint vertex : SV_VertexID) {
  const Curve curve = UnpackCurve(strand.curve_a, strand.curve_b, strand.curve_c);
  const float t = float(vertex / 2) / float(knots - 1);
  const float side = float(vertex % 2);
  const float wide = CurveWidth(strand.width, tip_width, t);
  Hair hair;
  hair.colour = HairColour(strand.base_colour, strand.tip_colour, t);
  hair.tangent = CurveTangent(curve, t);
  hair.across_along = float2(side, t);
  hair.film_strip = StripOfTag(strand.tag);
  const float3 corner = StripCorner(CurvePoint(curve, t), hair.tangent, wide, eye, side);
  hair.position = mul(world_to_clip, float4(corner, 1.0));
  return hair;
}
