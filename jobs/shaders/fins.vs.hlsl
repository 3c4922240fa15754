// Fins (jobs/DRAWING.md): a strip of four quads along the fur for each edge of the skin that is seen from
// the side. 12 bytes an instance, of WriteFins; the shells' vertices and their places on the skin's
// texture are read as structured buffers.
//   DrawInstanced(10, fin_count, 0, 0) with D3D_PRIMITIVE_TOPOLOGY_TRIANGLESTRIP
#include "fur_vertex.hlsl"

struct Vertex {
  float3 position;   // m, world
  uint base_colour;  // four unsigned bytes, normalised; sRGB, stencil
  float3 groom;      // m
  uint tip_colour;
  float3 force;  // m
  uint normal;   // 16 bits each, signed normalised
};
StructuredBuffer<Vertex> vertices : register(t1);
StructuredBuffer<float2> uvs : register(t2);

cbuffer Frame : register(b0) {
  float4x4 world_to_clip;
  float texture_repeat;  // the draw's
  float shadow;
};

// Of an instance, R32G32B32_UINT at offset 0: from, to, fade of 255.
Fur main(uint3 fin : TEXCOORD0, uint vertex : SV_VertexID) {
  const uint end = vertex % 2 == 0 ? fin.x : fin.y;
  const Vertex at = vertices[end];
  const float height = float(vertex / 2) / 4.0;
  const float4 base = Unorm8x4(at.base_colour), tip = Unorm8x4(at.tip_colour);
  Fur fur;
  fur.normal = OctahedralNormal(at.normal);
  fur.colour = float4(HairColour(base, tip, height).rgb, float(fin.z) / 255.0);
  fur.direction = NormalizeOr(ShellSlope(at.groom, at.force, height), fur.normal);
  fur.uv = uvs[end] * texture_repeat;
  fur.stencil_threshold = float2(base.a, height);
  fur.light_left = lerp(shadow, 1.0, height);
  const float3 place = ShellPosition(at.position, at.groom, at.force, height);
  fur.position = mul(world_to_clip, float4(place, 1.0));
  return fur;
}
