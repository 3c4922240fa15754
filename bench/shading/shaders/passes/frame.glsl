// What each pass is given. Light and look are blocks of floats in the order of their structs in C++.

layout(std140) uniform Look {
  LightSet light;
  HairLook look;
};
uniform mat4 world_to_clip;  // w is the distance along the view, m
uniform vec3 eye;
