Knot ReadKnot(uint record, int k) {
  uint at = (record * 5u + uint(k)) * 2u;
  vec4 place = uintBitsToFloat(Texel(vertices, at));
  uvec4 rest = Texel(vertices, at + 1u);
  Knot knot;
  knot.at = place.xyz;
  knot.width = place.w;
  knot.tangent = NormalizeOr(vec3(Snorm16(rest.x), Snorm16(rest.x >> 16u), Snorm16(rest.y)),
                             vec3(0.0, 1.0, 0.0));
  knot.across = AcrossView(knot.tangent, knot.at);
  knot.colour = ColourOf(rest.z);
  return knot;
}

uint ReadStrip(uint record) { return Texel(vertices, record * 10u + 1u).w >> 24u; }
