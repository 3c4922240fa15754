// Shells (jobs/DRAWING.md): 48 bytes a vertex of the skin, and its place on the skin's texture from a
// buffer of its own that never changes; 16 bytes an instance, a shell.
//   DrawIndexedInstanced(index_count, shell_count, 0, 0, 0)
#include "fur_vertex.hlsl"

struct Vertex {
  float3 position : POSITION;     // offset 0, R32G32B32_FLOAT; m, world
  float4 base_colour : COLOR0;    // offset 12, R8G8B8A8_UNORM; sRGB, stencil
  float3 groom : TEXCOORD0;       // offset 16, R32G32B32_FLOAT; m
  float4 tip_colour : COLOR1;     // offset 28, R8G8B8A8_UNORM; sRGB
  float3 force : TEXCOORD1;       // offset 32, R32G32B32_FLOAT; m
  float2 normal : NORMAL;         // offset 44, R16G16_SNORM
  float2 uv : TEXCOORD2;          // second buffer: R32G32_FLOAT
  float4 shell : TEXCOORD3;       // per instance, R32G32B32A32_FLOAT: height, shadow, threshold, fade
};

cbuffer Frame : register(b0) {
  float4x4 world_to_clip;
  float texture_repeat;  // the draw's
};

Fur main(Vertex vertex) {
  const float height = vertex.shell.x;
  Fur fur;
  fur.normal = OctahedralNormal(vertex.normal);
  fur.colour = float4(HairColour(vertex.base_colour, vertex.tip_colour, height).rgb, vertex.shell.w);
  fur.direction = NormalizeOr(ShellSlope(vertex.groom, vertex.force, height), fur.normal);
  fur.uv = vertex.uv * texture_repeat;
  fur.stencil_threshold = float2(vertex.base_colour.a, vertex.shell.z);
  fur.light_left = vertex.shell.y;
  const float3 at = ShellPosition(vertex.position, vertex.groom, vertex.force, height);
  fur.position = mul(world_to_clip, float4(at, 1.0));
  return fur;
}
