// Premultiplied: drawn over what is there.
precision highp float;

in vec3 lit;
in float coverage;
out vec4 colour;

void main() { colour = vec4(lit * coverage, coverage); }
