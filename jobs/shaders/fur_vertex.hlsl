// What the shaders in HLSL have in common: fur_vertex.glsl, and what is passed on.
#define vec2 float2
#define vec3 float3
#define vec4 float4
#define uvec2 uint2
#define mix lerp
#define inversesqrt rsqrt
#include "fur_vertex.glsl"

// Of a strand.
struct Hair {
  float4 position : SV_Position;
  float4 colour : COLOR;  // linear; a carries the LOD fade
  float3 tangent : TANGENT;
  float2 across_along : TEXCOORD0;  // u across the hair, v from root to tip
  nointerpolation uint film_strip : TEXCOORD1;
};

// Of a shell, and of a fin, whose colour is to be multiplied with a too.
struct Fur {
  float4 position : SV_Position;
  float4 colour : COLOR;  // linear; a: fade
  float3 direction : TANGENT;
  float3 normal : NORMAL;  // of the skin
  float2 uv : TEXCOORD0;
  float2 stencil_threshold : TEXCOORD1;  // drawn where texture * x > y
  float light_left : TEXCOORD2;
};
