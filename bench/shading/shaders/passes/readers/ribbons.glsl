Knot ReadKnot(uint record, int k) {
  uint left = (record * 10u + 2u * uint(k)) * 2u, right = left + 2u;
  uvec4 l = Texel(vertices, left), r = Texel(vertices, right), l_rest = Texel(vertices, left + 1u);
  vec3 from = uintBitsToFloat(l.xyz), to = uintBitsToFloat(r.xyz);
  Knot knot;
  knot.at = 0.5 * (from + to);
  knot.width = length(to - from);
  knot.tangent = vec3(uintBitsToFloat(l.w), uintBitsToFloat(l_rest.xy));
  knot.across = NormalizeOr(to - from, AcrossView(knot.tangent, eye - knot.at));
  knot.colour = LinearFromSrgb(Unorm8x4(l_rest.z));
  return knot;
}

uint ReadStrip(uint record) { return StripOfRibbon(Texel(vertices, record * 20u + 1u).w); }
