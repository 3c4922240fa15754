Knot ReadKnot(uint record, int k) {
  uint at = (record * 5u + uint(k)) * 2u;
  vec4 place = uintBitsToFloat(Texel(vertices, at));
  uvec4 rest = Texel(vertices, at + 1u);
  Knot knot;
  knot.at = place.xyz;
  knot.width = place.w;
  knot.tangent = NormalizeOr(LineTangent(rest.xy).xyz, vec3(0.0, 1.0, 0.0));
  knot.across = AcrossView(knot.tangent, eye - knot.at);
  knot.colour = LinearFromSrgb(Unorm8x4(rest.z));
  return knot;
}

uint ReadStrip(uint record) { return StripOfTag(Texel(vertices, record * 10u + 1u).w); }
