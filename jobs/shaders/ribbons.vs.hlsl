// Ribbons (jobs/DRAWING.md): a vertex of 32 bytes, four quads per hair, already turned to the camera.
// The input layout: R32G32B32_FLOAT at 0, R32G32B32_FLOAT at 12, R8G8B8A8_UNORM at 24, R32_UINT at 28.
#include "fur_vertex.hlsl"

cbuffer Frame : register(b0) {
  float4x4 world_to_clip;
};

struct Vertex {
  float3 position : POSITION;  // m, world
  float3 tangent : TANGENT;    // unit, root to tip
  float4 colour : COLOR;       // sRGB
  uint texture_ : TEXCOORD;
};

Hair main(Vertex vertex) {
  Hair hair;
  hair.position = mul(world_to_clip, float4(vertex.position, 1.0));
  hair.colour = LinearFromSrgb(vertex.colour);
  hair.tangent = vertex.tangent;
  hair.across_along = RibbonPlace(vertex.texture_);
  hair.film_strip = StripOfRibbon(vertex.texture_);
  return hair;
}
