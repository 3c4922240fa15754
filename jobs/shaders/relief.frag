// Fur as relief on the skin (jobs/DRAWING.md): of any mesh with texture coordinates, behind the engine's own vertex
// shader. Blended over the skin, or over the layers before: one, one minus source alpha.
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "relief.glsl"

layout(location = 0) in vec3 position;  // m, world
layout(location = 1) in vec3 normal;    // world
layout(location = 2) in vec2 uv;        // of the mesh, as the flow map lies on it

layout(binding = 0) uniform Relief { ReliefSettings settings; };
layout(binding = 1) uniform sampler2D flow_map;  // repeats; pelt bake --flow-map
layout(binding = 2) uniform sampler2D hairs;     // repeats; pelt bake --height-field

layout(location = 0) out vec4 colour;  // linear, premultiplied

void main() {
  const vec4 flow = texture(flow_map, uv);
  // Before pixels leave, for their neighbours' differences.
  const ReliefAxes axes = FindReliefAxes(dFdx(position), dFdy(position), dFdx(uv), dFdy(uv));
  if (flow.a <= 0.0) discard;
  colour = DrawRelief(hairs, settings, axes, position, normal, uv, flow, gl_FragCoord.xy);
}
