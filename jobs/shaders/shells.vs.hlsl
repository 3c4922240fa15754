// Shells (jobs/DRAWING.md): 48 bytes a vertex of the skin, and its place on the skin's texture from a
// buffer of its own that never changes; 16 bytes an instance, a shell.
//   DrawIndexedInstanced(index_count, shell_count, 0, 0, 0)

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

struct Fur {
  float4 position : SV_Position;
  float4 colour : COLOR;  // linear; a: fade
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

float3 UnpackNormal(float2 at) {
  float3 n = float3(at, 1.0 - abs(at.x) - abs(at.y));
  const float fold = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -fold : fold;
  n.y += n.y >= 0.0 ? -fold : fold;
  return normalize(n);
}

Fur main(Vertex vertex) {
  const float height = vertex.shell.x;
  Fur fur;
  fur.normal = UnpackNormal(vertex.normal);
  fur.colour = float4(lerp(Linear(vertex.base_colour.rgb), Linear(vertex.tip_colour.rgb), height), vertex.shell.w);
  fur.direction = NormalizeOr(vertex.groom + 2.0 * height * vertex.force, fur.normal);
  fur.uv = vertex.uv * texture_repeat;
  fur.stencil_threshold = float2(vertex.base_colour.a, vertex.shell.z);
  fur.light_left = vertex.shell.y;
  const float3 at = vertex.position + height * (vertex.groom + height * vertex.force);
  fur.position = mul(world_to_clip, float4(at, 1.0));
  return fur;
}
