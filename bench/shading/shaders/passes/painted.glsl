// What mud, snow, water and dust are to the layer or the skin that is drawn.
// After: paint_shading.glsl
uniform float paint_wet_darken;
uniform vec3 paint_mud, paint_snow, paint_dust;

PaintLook LookOfPaint() {
  return PaintLook(paint_wet_darken, paint_mud, paint_snow, paint_dust);
}

// Of a hair with these amounts; none change nothing.
void PaintHair(vec4 amounts, vec3 normal, float noise, inout vec3 colour, inout HairLook hair) {
  if (amounts == vec4(0.0)) return;
  vec4 seen = SeenPaint(amounts, normal, noise);
  colour = PaintedColour(LookOfPaint(), colour, seen);
  hair = PaintedHair(hair, seen);
}
