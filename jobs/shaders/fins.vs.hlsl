// Fins (jobs/DRAWING.md): a strip of four quads along the fur for each edge of the skin that is seen from
// the side. 12 bytes an instance, of WriteFins; the shells' vertices and their places on the skin's
// texture are read as structured buffers.
//   DrawInstanced(10, fin_count, 0, 0) with D3D_PRIMITIVE_TOPOLOGY_TRIANGLESTRIP

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

struct Fur {
  float4 position : SV_Position;
  float4 colour : COLOR;  // linear; a: fade, which the colour is to be multiplied with too
  float3 direction : TANGENT;
  float3 normal : NORMAL;  // of the skin
  float2 uv : TEXCOORD0;
  float2 stencil_threshold : TEXCOORD1;  // drawn where texture * x > y
  float light_left : TEXCOORD2;
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

float3 UnpackNormal(uint packed) {
  const float2 at = max(float2(int2(packed << 16, packed) >> 16) / 32767.0, -1.0);
  float3 n = float3(at, 1.0 - abs(at.x) - abs(at.y));
  const float fold = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -fold : fold;
  n.y += n.y >= 0.0 ? -fold : fold;
  return normalize(n);
}

float4 UnpackColour(uint colour) {
  return float4(uint4(colour, colour >> 8, colour >> 16, colour >> 24) & 255) / 255.0;
}

// Of an instance, R32G32B32_UINT at offset 0: from, to, fade of 255.
Fur main(uint3 fin : TEXCOORD0, uint vertex : SV_VertexID) {
  const uint end = vertex % 2 == 0 ? fin.x : fin.y;
  const Vertex at = vertices[end];
  const float height = float(vertex / 2) / 4.0;
  const float4 base = UnpackColour(at.base_colour), tip = UnpackColour(at.tip_colour);
  Fur fur;
  fur.normal = UnpackNormal(at.normal);
  fur.colour = float4(lerp(Linear(base.rgb), Linear(tip.rgb), height), float(fin.z) / 255.0);
  fur.direction = NormalizeOr(at.groom + 2.0 * height * at.force, fur.normal);
  fur.uv = uvs[end] * texture_repeat;
  fur.stencil_threshold = float2(base.a, height);
  fur.light_left = lerp(shadow, 1.0, height);
  const float3 place = at.position + height * (at.groom + height * at.force);
  fur.position = mul(world_to_clip, float4(place, 1.0));
  return fur;
}
