Knot ReadKnot(uint record, int k) {
  vec4 a = uintBitsToFloat(Texel(vertices, record * 4u)),
       b = uintBitsToFloat(Texel(vertices, record * 4u + 1u)),
       c = uintBitsToFloat(Texel(vertices, record * 4u + 2u));
  uvec4 rest = Texel(vertices, record * 4u + 3u);
  vec3 c1 = vec3(a.w, b.xy), c2 = vec3(b.zw, c.x), c3 = c.yzw;
  float t = float(k) / float(knots - 1);
  Knot knot;
  knot.at = a.xyz + t * (c1 + t * (c2 + t * c3));
  knot.width = uintBitsToFloat(rest.z) * mix(1.0, tip_width, t);
  knot.tangent = NormalizeOr(c1 + t * (2.0 * c2 + t * 3.0 * c3), vec3(0.0, 1.0, 0.0));
  knot.across = AcrossView(knot.tangent, knot.at);
  knot.colour = mix(ColourOf(rest.x), ColourOf(rest.y), t);
  return knot;
}

uint ReadStrip(uint record) { return Texel(vertices, record * 4u + 3u).w >> 24u; }
