// b: how much of the rim; only what is behind everything has it, and blurring brings it in over the
// outline.

in vec2 sun_and_sky;
out vec4 coefficients;

void main() { coefficients = vec4(sun_and_sky, 0.0, 1.0); }
