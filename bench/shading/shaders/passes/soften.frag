// Running means along one direction, of what is at most 1 when scaled; the edge goes on beyond the
// edge.

uniform sampler2DArray source;
uniform int layer, reach;
uniform ivec2 along;
uniform float scale;
out vec4 mean;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(source, 0).xy - 1;
  vec4 sum = vec4(0.0);
  for (int i = -reach; i <= reach; ++i)
    sum += min(texelFetch(source, ivec3(clamp(at + along * i, ivec2(0), last), layer), 0) * scale,
               vec4(1.0));
  mean = sum / float(2 * reach + 1);
}
