// Fur as relief on the skin (jobs/DRAWING.md): of any mesh with texture coordinates, behind the engine's own vertex
// shader. Blended over the skin, or over the layers before: one, one minus source alpha.
SamplerState repeated : register(s0);  // linear, WRAP along u and v
#define CONST static const
#define FN_OF_TILE
#define TILE Texture2D<float4>
#define TILE_HEIGHT(tile, place) tile.SampleLevel(repeated, place, 0.0).x
#define vec2 float2
#define vec3 float3
#define vec4 float4
#define mix lerp
#include "relief.glsl"

cbuffer Relief : register(b0) { ReliefSettings settings; };
Texture2D<float4> flow_map : register(t1);  // pelt bake --flow-map
Texture2D<float4> hairs : register(t2);     // pelt bake --height-field

struct Skin {
  float4 pixel : SV_Position;
  float3 position : POSITION;  // m, world
  float3 normal : NORMAL;      // world
  float2 uv : TEXCOORD0;       // of the mesh, as the flow map lies on it
};

// Linear, premultiplied.
float4 main(Skin skin) : SV_Target {
  const float4 flow = flow_map.Sample(repeated, skin.uv);
  // Before pixels leave, for their neighbours' differences.
  const ReliefAxes axes = FindReliefAxes(ddx(skin.position), ddy(skin.position), ddx(skin.uv), ddy(skin.uv));
  if (flow.a <= 0.0) discard;
  return DrawRelief(hairs, settings, axes, skin.position, skin.normal, skin.uv, flow, skin.pixel.xy);
}
