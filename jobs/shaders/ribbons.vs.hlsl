// Ribbons (jobs/DRAWING.md): a vertex of 32 bytes, four quads per hair, already turned to the camera.
// The input layout: R32G32B32_FLOAT at 0, R32G32B32_FLOAT at 12, R8G8B8A8_UNORM at 24, R32_UINT at 28.

cbuffer Frame : register(b0) {
  float4x4 world_to_clip;
};

struct Vertex {
  float3 position : POSITION;  // m, world
  float3 tangent : TANGENT;    // unit, root to tip
  float4 colour : COLOR;       // sRGB
  uint texture_ : TEXCOORD;
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

Hair main(Vertex vertex) {
  Hair hair;
  hair.position = mul(world_to_clip, float4(vertex.position, 1.0));
  hair.colour = float4(Linear(vertex.colour.rgb), vertex.colour.a);
  hair.tangent = vertex.tangent;
  hair.across_along = float2(float(vertex.texture_ & 255u) / 255.0, float(vertex.texture_ >> 16) / 65535.0);
  hair.film_strip = (vertex.texture_ >> 8) & 255u;
  return hair;
}
