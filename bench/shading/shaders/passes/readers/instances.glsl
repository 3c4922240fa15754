Knot ReadKnot(uint record, int k) {
  Curve curve = UnpackCurve(uintBitsToFloat(Texel(vertices, record * 4u)),
                            uintBitsToFloat(Texel(vertices, record * 4u + 1u)),
                            uintBitsToFloat(Texel(vertices, record * 4u + 2u)));
  uvec4 rest = Texel(vertices, record * 4u + 3u);
  float t = float(k) / float(knots - 1);
  Knot knot;
  knot.at = CurvePoint(curve, t);
  knot.width = CurveWidth(uintBitsToFloat(rest.z), tip_width, t);
  knot.tangent = CurveTangent(curve, t);
  knot.across = AcrossView(knot.tangent, eye - knot.at);
  knot.colour = HairColour(Unorm8x4(rest.x), Unorm8x4(rest.y), t);
  return knot;
}

uint ReadStrip(uint record) { return StripOfTag(Texel(vertices, record * 4u + 3u).w); }
