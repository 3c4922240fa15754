// Lines (jobs/DRAWING.md): five points of 32 bytes per strand, widened here into a strip of four quads
// that faces the camera. No input layout and no index buffer: points are read as a structured buffer.
//   DrawInstanced(10, strand_count, 0, 0) with D3D_PRIMITIVE_TOPOLOGY_TRIANGLESTRIP
#include "fur_vertex.hlsl"

struct Point {
  float3 position;  // m, world
  float width;      // m, whole
  uint2 tangent_v;  // 16 bits each, signed normalised: tangent (unit, root to tip), v
  uint colour;      // four unsigned bytes, normalised; sRGB
  uint tag;
};
StructuredBuffer<Point> points : register(t1);
StructuredBuffer<uint> order : register(t2);  // the draw's; kIndexBuffer

cbuffer Frame : register(b0) {
  float4x4 world_to_clip;
  float3 eye;           // m, world
  int in_strand_order;  // 1 with kIndexBuffer
};

Hair main(uint vertex : SV_VertexID, uint instance : SV_InstanceID) {
  const uint strand = in_strand_order != 0 ? order[instance] : instance;
  const Point at = points[strand * 5 + vertex / 2];
  const float side = float(vertex % 2);
  const float4 tangent_v = LineTangent(at.tangent_v);
  Hair hair;
  hair.colour = LinearFromSrgb(Unorm8x4(at.colour));
  hair.tangent = tangent_v.xyz;
  hair.across_along = float2(side, tangent_v.w);
  hair.film_strip = StripOfTag(at.tag);
  const float3 corner = StripCorner(at.position, hair.tangent, at.width, eye, side);
  hair.position = mul(world_to_clip, float4(corner, 1.0));
  return hair;
}
