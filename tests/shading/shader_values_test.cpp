// The shaders' functions as a driver compiles them against the same text in C++ (bench/shading/shading.hpp), value by
// value: a pixel for each case of random arguments, drawn into floats by the OpenGL found here. One of each kind is
// asked: the text is one. Skipped, and says why, where there is none.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "bench/shading/default_look.hpp"
#include "bench/shading/gl_context.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

// Random arguments: each component within -1 and 1, u within 0 and 1; d and e are unit vectors.
struct Arguments {
  glm::vec4 d, e, u, v;
};

struct Function {
  const char* name;
  const char*
      text;  // an expression of vec4 d, e, u, v; behind LIGHT, of what kLightText makes of them
  std::function<glm::vec4(const Arguments&)> wanted;
};

glm::vec3 Unit(const glm::vec4& v) { return glm::vec3(v); }
glm::vec4 Wide(float x) { return {x, 0.0f, 0.0f, 0.0f}; }
glm::vec4 Wide(const glm::vec3& x) { return glm::vec4(x, 0.0f); }

constexpr GLsizei kCases = 256, kRows = 4;
constexpr float kClose = 1e-3f;  // of values above 1, as a share

uint32_t BitsOf(float v) {
  uint32_t bits = 0;
  std::memcpy(&bits, &v, sizeof(bits));
  return bits;
}

// Light from every side whose coefficients come from the arguments, and a look, in both languages.
LightSet LightOf(const Arguments& a) {
  LightSet light{};
  light.to_sun = Unit(a.d);
  light.sun = glm::vec3(a.u);
  light.to_rim = Unit(a.e);
  light.rim = glm::vec3(a.v);
  ShAddZonal(Unit(a.e), ShHemisphere() * ShWindow(6.0f), glm::vec3(a.u), light.sky);
  ShAddZonal(Unit(a.d), ShDelta(), glm::vec3(a.u) * a.u.w, light.sky);
  return light;
}
constexpr HairLook kHairLook = HairLookOf({}, 3.0f);
HairPoint PointOf(const Arguments& a) {
  const glm::vec3 normal = Unit(a.d), tangent = Unit(a.e);
  return {glm::vec3(a.u), tangent, normal, glm::normalize(normal + 0.7f * glm::vec3(a.v)),
          a.u.w,          a.u.x,   a.u.y};
}
PaintLook PaintOf(const Arguments& a) {
  return {a.u.x, glm::vec3(a.u.y, a.u.z, a.u.w), glm::vec3(a.u.w, a.u.x, a.u.y), glm::vec3(a.u)};
}
// A place on the skin of both languages; axes are neither square nor of a length.
ReliefPoint ReliefPointOf(const Arguments& a) {
  const glm::vec3 u(a.u), v(a.v);
  return {.colour = u,
          .tip_colour = glm::abs(v),
          .normal = Unit(a.d),
          .axis_u = 0.4f * Unit(a.e),
          .axis_v = 0.3f * glm::cross(Unit(a.d), Unit(a.e)) + 0.1f * v,
          .uv = glm::vec2(u),
          .repeat = {3.0f, 5.0f},
          .flow = {0.3f + 0.4f * a.u.z, 0.3f + 0.4f * a.u.w, a.u.x, 1.0f},
          .longest = 0.06f,
          .floor_light = 0.22f,
          .sun_share = a.u.y,
          .to_eye = glm::normalize(Unit(a.d) + 0.7f * v)};
}
// A tile of hairs that both languages have.
constexpr const char* kTileText =
    "#undef TILE\n#undef TILE_HEIGHT\n#define TILE int\n"
    "#define TILE_HEIGHT(tile, place) (0.5 + 0.5 * sin(9.0 * (place).x) * cos(7.0 * (place).y))\n";
float HeightOf(const glm::vec2& place) {
  return 0.5f + 0.5f * std::sin(9.0f * place.x) * std::cos(7.0f * place.y);
}

constexpr const char* kLightText = R"(
  LightSet light;
  light.to_sun = d.xyz;
  light.sun = u.xyz;
  light.to_rim = e.xyz;
  light.rim = v.xyz;
  for (int i = 0; i < 16; ++i) light.sky[i] = vec3(0.0);
  ShAddZonal(e.xyz, ShHemisphere() * ShWindow(6.0), u.xyz, light.sky);
  ShAddZonal(d.xyz, ShDelta(), u.xyz * u.w, light.sky);
  HairLook look = HairLook(vec3(1.0), 0.1, 90.0, 0.1, 0.55, 28.0, 0.1, 0.7, 0.4, 1.0, 3.0, 0.8, 0.35, 6.0, 0.6, 1.0);
  HairPoint point = HairPoint(u.xyz, e.xyz, d.xyz, normalize(d.xyz + 0.7 * v.xyz), u.w, u.x, u.y);
  PaintLook paint = PaintLook(u.x, u.yzw, u.wxy, u.xyz);
  ReliefPoint p = ReliefPoint(u.xyz, abs(v.xyz), d.xyz, 0.4 * e.xyz, 0.3 * cross(d.xyz, e.xyz) + 0.1 * v.xyz, u.xy,
                              vec2(3.0, 5.0), vec4(0.3 + 0.4 * u.zw, u.x, 1.0), 0.06, 0.22, u.y,
                              normalize(d.xyz + 0.7 * v.xyz));
  ReliefMarch march = ReliefMarch(4.0, 16.0, 0.3, 0.01 * v.xyz, u.zw);
)";

std::vector<Function> ListFunctions() {
  using A = const Arguments&;
  return {
      {"HairDiffuse", "vec4(HairDiffuse(d.xyz, e.xyz), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(HairDiffuse(Unit(a.d), Unit(a.e))); }},
      // Whole numbers.
      {"OctahedralNormal", "vec4(OctahedralNormal(floatBitsToUint(d.x) * 2654435761u), 0.0)",
       [](A a) { return Wide(OctahedralNormal(BitsOf(a.d.x) * 2654435761u)); }},
      {"HashShare", "vec4(HashShare(floatBitsToUint(d.x)), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(HashShare(BitsOf(a.d.x))); }},
      {"StripCoverage",
       "vec4(StripCoverage(uint(32.0 * u.x), u.y, u.z, 0.02 + 0.5 * u.w), 0.0, 0.0, 0.0)",
       [](A a) {
         return Wide(StripCoverage(uint32_t(32.0f * a.u.x), a.u.y, a.u.z, 0.02f + 0.5f * a.u.w));
       }},
      // All that is lit, tinted and looked up.
      {"ShadeHair", "LIGHT vec4(ShadeHair(light, PaintedHair(look, u), point), 0.0)",
       [](A a) { return Wide(ShadeHair(LightOf(a), PaintedHair(kHairLook, a.u), PointOf(a))); }},
      {"ShadeEye", "LIGHT vec4(ShadeEye(light, look, -point.to_eye, e.xyz, point.to_eye), 0.0)",
       [](A a) {
         const glm::vec3 to_eye = PointOf(a).to_eye;
         return Wide(ShadeEye(LightOf(a), kHairLook, -to_eye, Unit(a.e), to_eye));
       }},
      {"StudioColour", "vec4(StudioColour(d.xyz, u.x), Tone(3.0 * u.y))",
       [](A a) { return glm::vec4(StudioColour(Unit(a.d), a.u.x), Tone(3.0f * a.u.y)); }},
      {"PaintedColour",
       "LIGHT vec4(PaintedColour(paint, abs(v.xyz), SeenPaint(u, d.xyz, abs(v.x))), 0.0)",
       [](A a) {
         const glm::vec4 seen = SeenPaint(a.u, Unit(a.d), std::abs(a.v.x));
         return Wide(PaintedColour(PaintOf(a), glm::abs(glm::vec3(a.v)), seen));
       }},
      {"ShadeRelief", "LIGHT vec4(ShadeRelief(0, light, look, march, p).rgb, 0.0)",
       [](A a) {
         const ReliefMarch march{4.0f, 16.0f, 0.3f, 0.01f * glm::vec3(a.v), {a.u.z, a.u.w}};
         return Wide(
             glm::vec3(ShadeRelief(HeightOf, LightOf(a), kHairLook, march, ReliefPointOf(a))));
       }},
      {"TexelColour",
       "vec4(TexelColour(1, u, abs(v.xyz), abs(d.xyz), e.xyz), TexelCover(2, u, abs(v.zx)))",
       [](A a) {
         const glm::vec3 lit = glm::abs(glm::vec3(a.v)), highlights = glm::abs(Unit(a.d));
         return glm::vec4(TexelColour(1, a.u, lit, highlights, Unit(a.e)),
                          TexelCover(2, a.u, glm::abs(glm::vec2(a.v.z, a.v.x))));
       }},
      {"ShellPosition",
       "vec4(ShellPosition(u.xyz, d.xyz, v.xyz, u.w), ShellCoverage(u.x, u.y, u.z))",
       [](A a) {
         return glm::vec4(ShellPosition(glm::vec3(a.u), Unit(a.d), glm::vec3(a.v), a.u.w),
                          ShellCoverage(a.u.x, a.u.y, a.u.z));
       }},
      {"ShellBend",
       "vec4(ShellBend(20.0 * PublishedWind(v.xyz, u.xyz, e.xyz, d.xyz), d.xyz, u.x, 0.2, u.w), "
       "0.0)",
       [](A a) {
         const glm::vec3 wind = PublishedWind(glm::vec3(a.v), glm::vec3(a.u), Unit(a.e), Unit(a.d));
         return Wide(ShellBend(20.0f * wind, Unit(a.d), a.u.x, 0.2f, a.u.w));
       }},
  };
}

std::vector<Arguments> RandomArguments() {
  std::mt19937 random(15);
  std::uniform_real_distribution<float> side(-1.0f, 1.0f), share(0.0f, 1.0f);
  std::normal_distribution<float> normal;
  const auto unit = [&] {
    return glm::vec4(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))), 0);
  };
  std::vector<Arguments> all(kCases);
  for (Arguments& a : all) {
    a.d = unit();
    a.e = unit();
    for (int i = 0; i < 4; ++i) a.u[i] = share(random);
    for (int i = 0; i < 4; ++i) a.v[i] = side(random);
  }
  return all;
}

// A row of pixels: the arguments in, a function's values out.
class Bench {
 public:
  Bench(const GlApi& gl, const std::vector<Arguments>& arguments) : gl_(gl) {
    gl_.GenTextures(2, textures_);
    Fill(textures_[0], kRows, arguments.data());
    Fill(textures_[1], 1, nullptr);
    gl_.GenFramebuffers(1, &target_);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, target_);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures_[1], 0);
    gl_.GenVertexArrays(1, &vertices_);
    gl_.BindVertexArray(vertices_);
    gl_.Viewport(0, 0, kCases, 1);
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.BindTexture(GL_TEXTURE_2D, textures_[0]);
  }
  ~Bench() {
    gl_.DeleteVertexArrays(1, &vertices_);
    gl_.DeleteFramebuffers(1, &target_);
    gl_.DeleteTextures(2, textures_);
  }
  bool IsComplete() const {
    return gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  }

  // The values, or the driver's words.
  Result<std::vector<glm::vec4>> Draw(const Function& function) const {
    static const std::string kVertex =
        "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, "
        "0.0, 1.0); }\n";
    const Result<GLuint> program = MakeProgram(gl_, kVertex, FragmentOf(function));
    if (!program) return Failure{program.error()};
    gl_.UseProgram(*program);
    gl_.Uniform1i(gl_.GetUniformLocation(*program, "arguments"), 0);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    std::vector<glm::vec4> values(kCases);
    gl_.ReadPixels(0, 0, kCases, 1, GL_RGBA, GL_FLOAT, values.data());
    gl_.DeleteProgram(*program);
    return values;
  }

 private:
  // A texel for each argument, those of a case in a row.
  void Fill(GLuint texture, GLsizei width, const void* texels) const {
    const GLsizei columns = width == 1 ? kCases : width, rows = width == 1 ? 1 : kCases;
    gl_.BindTexture(GL_TEXTURE_2D, texture);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, columns, rows, 0, GL_RGBA, GL_FLOAT, texels);
  }

  static std::string FragmentOf(const Function& function) {
    constexpr std::string_view kMark = "LIGHT ";
    std::string value = function.text, before;
    if (value.starts_with(kMark)) {
      before = kLightText;
      value.erase(0, kMark.size());
    }
    std::string functions = ShaderText("studio.glsl");
    functions.insert(functions.find(OwnText("spherical_harmonics.glsl")), kTileText);
    for (const char* file : {"paint_shading.glsl", "shell_shading.glsl", "film_strip.glsl",
                             "strand_texture.glsl", "relief.glsl", "relief_shading.glsl"})
      functions += OwnText(file);
    return functions +
           "uniform sampler2D arguments;\nout vec4 result;\n"
           "vec4 At(int i) { return texelFetch(arguments, ivec2(i, int(gl_FragCoord.x)), 0); }\n"
           "void main() {\n  vec4 d = At(0), e = At(1), u = At(2), v = At(3);\n" +
           before + "\n  result = " + value + ";\n}\n";
  }

  const GlApi& gl_;
  GLuint textures_[2] = {}, target_ = 0, vertices_ = 0;
};

TEST(ShaderValues, AreThoseOfTheFunctionsInCpp) {
  const Result<GlContext> context = GlContext::Open();
  if (!context) GTEST_SKIP() << context.error();
  const std::vector<Arguments> arguments = RandomArguments();
  const Bench bench(context->gl(), arguments);
  ASSERT_TRUE(bench.IsComplete()) << context->Renderer();
  for (const Function& function : ListFunctions()) {
    const Result<std::vector<glm::vec4>> values = bench.Draw(function);
    ASSERT_TRUE(values) << function.name << ": " << values.error();
    for (GLsizei i = 0; i < kCases; ++i) {
      const glm::vec4 wanted = function.wanted(arguments[size_t(i)]);
      for (int c = 0; c < 4; ++c)
        ASSERT_NEAR((*values)[size_t(i)][c], wanted[c],
                    kClose * std::max(1.0f, std::abs(wanted[c])))
            << function.name << ", case " << i << ", component " << c << ", "
            << context->Renderer();
    }
  }
  EXPECT_EQ(context->gl().GetError(), GLenum(GL_NO_ERROR));
}

// The comparison sees a function that is off by a hundredth.
TEST(ShaderValues, APlantedFaultIsSeen) {
  const Result<GlContext> context = GlContext::Open();
  if (!context) GTEST_SKIP() << context.error();
  const std::vector<Arguments> arguments = RandomArguments();
  const Bench bench(context->gl(), arguments);
  Function faulty = ListFunctions()[0];
  faulty.text = "vec4(HairDiffuse(d.xyz, e.xyz) * 1.01, 0.0, 0.0, 0.0)";
  const std::vector<glm::vec4> values = bench.Draw(faulty).OrThrow();
  float most = 0.0f;
  for (size_t i = 0; i < values.size(); ++i)
    most = std::max(most, std::abs(values[i].x - faulty.wanted(arguments[i]).x));
  EXPECT_GT(most, kClose);
}

TEST(ShaderValues, ABrokenShaderIsToldInTheDriversWords) {
  const Result<GlContext> context = GlContext::Open();
  if (!context) GTEST_SKIP() << context.error();
  const Result<GLuint> program =
      MakeProgram(context->gl(), "void main() {}\n", "void main() { nowhere(); }\n");
  ASSERT_FALSE(program);
  EXPECT_NE(program.error().find("fragment shader: "), std::string::npos) << program.error();
  EXPECT_NE(program.error().find("nowhere"), std::string::npos) << program.error();
}

TEST(ShaderValues, AFileComesBehindThoseThatItNames) {
  const std::string text = ShaderText("strand_light.glsl");
  const size_t basis = text.find("void ShBasis("), lobe = text.find("float HairLobe("),
               hair = text.find("vec3 ShadeHair(");
  ASSERT_NE(hair, text.npos);
  EXPECT_LT(basis, hair);
  EXPECT_LT(lobe, hair);
  EXPECT_EQ(ShaderText("nowhere.glsl"), "");
}

}  // namespace
}  // namespace pelt
