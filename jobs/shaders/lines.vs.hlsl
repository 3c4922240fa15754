// Lines (jobs/DRAWING.md): five points of 32 bytes per strand, widened here into a strip of four quads
// that faces the camera. No input layout and no index buffer: points are read as a structured buffer.
//   DrawInstanced(10, strand_count, 0, 0) with D3D_PRIMITIVE_TOPOLOGY_TRIANGLESTRIP

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

// Two signed 16-bit numbers, the low half first.
float2 Unpack(uint two) { return max(float2(int2(two << 16, two) >> 16) / 32767.0, -1.0); }

Hair main(uint vertex : SV_VertexID, uint instance : SV_InstanceID) {
  const uint strand = in_strand_order != 0 ? order[instance] : instance;
  const Point at = points[strand * 5 + vertex / 2];
  const float side = float(vertex % 2);
  const float2 xy = Unpack(at.tangent_v.x);
  const float2 zv = Unpack(at.tangent_v.y);
  const float3 tangent = float3(xy, zv.x);
  const float3 across = NormalizeOr(cross(tangent, eye - at.position), float3(1.0, 0.0, 0.0));
  const float half_width = 0.5 * at.width;
  const float4 colour = float4(uint4(at.colour, at.colour >> 8, at.colour >> 16, at.colour >> 24) & 255) / 255.0;
  Hair hair;
  hair.position = mul(world_to_clip, float4(at.position + across * (half_width * (2.0 * side - 1.0)), 1.0));
  hair.colour = float4(Linear(colour.rgb), colour.a);
  hair.tangent = tangent;
  hair.across_along = float2(side, zv.y);
  hair.film_strip = at.tag >> 24;
  return hair;
}
