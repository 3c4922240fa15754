// How much of the fur stands at a place: where the layer's map is known, as it says, else as the vertices do.

uniform sampler2DArray growth;
uniform float growth_scale;  // from the fur texture's coordinates to the skin's; 0: there is no map

// `place`: on the fur's texture; what the vertices have; layer of `growth`.
float StencilAt(vec4 place) {
  if (growth_scale <= 0.0) return place.z;
  return textureLod(growth, vec3(place.xy * growth_scale, place.w), 0.0).r;
}
