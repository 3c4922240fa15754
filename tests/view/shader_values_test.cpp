// The shaders' functions against those in C++, value by value: a pixel for each case of random arguments, drawn into
// floats by whatever OpenGL is here. Skipped, and says why, where there is none.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <regex>
#include <vector>

#include "bench/view/gl_context.hpp"
#include "bench/view/gl_program.hpp"
#include "bench/view/paint_shading.hpp"
#include "bench/view/shader_files.hpp"
#include "bench/view/shell_shading.hpp"
#include "bench/view/spherical_harmonics.hpp"
#include "bench/view/strand_light.hpp"
#include "bench/view/strand_shading.hpp"
#include "bench/view/studio.hpp"
#include "tests/view/relief_functions.hpp"

namespace pelt {
namespace {

constexpr GLsizei kCases = 256, kRows = 4;
constexpr float kNear = 1e-3f;  // of values above 1, as a share

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
constexpr HairLook kLook{0.1f, 90.0f, 0.1f, 0.55f, 28.0f, 0.1f, 0.7f,
                         0.4f, 3.0f,  0.8f, 0.35f, 6.0f,  0.6f, 1.0f};
HairPoint PointOf(const Arguments& a) {
  const glm::vec3 normal = Unit(a.d), tangent = Unit(a.e);
  return {glm::vec3(a.u), tangent, normal, glm::normalize(normal + 0.7f * glm::vec3(a.v)),
          a.u.w,          a.u.x,   a.u.y};
}
PaintLook PaintOf(const Arguments& a) {
  return {a.u.x, glm::vec3(a.u.y, a.u.z, a.u.w), glm::vec3(a.u.w, a.u.x, a.u.y), glm::vec3(a.u)};
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
  HairLook look = HairLook(0.1, 90.0, 0.1, 0.55, 28.0, 0.1, 0.7, 0.4, 3.0, 0.8, 0.35, 6.0, 0.6, 1.0);
  HairPoint point = HairPoint(u.xyz, e.xyz, d.xyz, normalize(d.xyz + 0.7 * v.xyz), u.w, u.x, u.y);
  PaintLook paint = PaintLook(u.x, u.yzw, u.wxy, u.xyz);
)";

std::vector<Function> ListFunctions() {
  using A = const Arguments&;
  return {
      {"Saturate", "vec4(Saturate(3.0 * v.x))",
       [](A a) { return glm::vec4(Saturate(3.0f * a.v.x)); }},
      {"HairDiffuse", "vec4(HairDiffuse(d.xyz, e.xyz), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(HairDiffuse(Unit(a.d), Unit(a.e))); }},
      {"ShiftTangent", "vec4(ShiftTangent(d.xyz, e.xyz, 0.5 * v.x), 0.0)",
       [](A a) { return Wide(ShiftTangent(Unit(a.d), Unit(a.e), 0.5f * a.v.x)); }},
      {"Halfway", "vec4(Halfway(d.xyz, e.xyz), 0.0)",
       [](A a) { return Wide(Halfway(Unit(a.d), Unit(a.e))); }},
      {"HairLobe", "vec4(HairLobe(d.xyz, e.xyz, 1.0 + 90.0 * u.x), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(HairLobe(Unit(a.d), Unit(a.e), 1.0f + 90.0f * a.u.x)); }},
      {"WrapDiffuse", "vec4(WrapDiffuse(v.x, u.x), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(WrapDiffuse(a.v.x, a.u.x)); }},
      {"Rim", "vec4(Rim(d.xyz, e.xyz, 1.0 + 4.0 * u.x), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(Rim(Unit(a.d), Unit(a.e), 1.0f + 4.0f * a.u.x)); }},
      {"RimFrom", "vec4(RimFrom(d.xyz, e.xyz, u.x), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(RimFrom(Unit(a.d), Unit(a.e), a.u.x)); }},
      {"AddRim", "vec4(AddRim(u.xyz, v.xyz), 0.0)",
       [](A a) { return Wide(AddRim(glm::vec3(a.u), glm::vec3(a.v))); }},
      {"DepthShadow",
       "vec4(DepthShadow(v.xyz * 0.03, vec3(0.0), d.xyz, 0.03, 0.22), 0.0, 0.0, 0.0)",
       [](A a) {
         return Wide(DepthShadow(glm::vec3(a.v) * 0.03f, glm::vec3(0.0f), Unit(a.d), 0.03f, 0.22f));
       }},
      {"SelfShadow", "vec4(SelfShadow(2.0 * u.x, 0.1 * v.x, 0.004, 45.0, 0.9), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(SelfShadow(2.0f * a.u.x, 0.1f * a.v.x, 0.004f, 45.0f, 0.9f)); }},
      {"Backlight",
       "vec4(Backlight(d.xyz, e.xyz, -normalize(e.xyz + v.xyz * 0.5), 6.0), 0.0, 0.0, 0.0)",
       [](A a) {
         const glm::vec3 to_eye = -glm::normalize(Unit(a.e) + glm::vec3(a.v) * 0.5f);
         return Wide(Backlight(Unit(a.d), Unit(a.e), to_eye, 6.0f));
       }},
      {"TransmittedColour", "vec4(TransmittedColour(u.xyz), 0.0)",
       [](A a) { return Wide(TransmittedColour(glm::vec3(a.u))); }},
      {"MultipleScatter", "vec4(MultipleScatter(u.xyz, u.w, 2.0), 0.0)",
       [](A a) { return Wide(MultipleScatter(glm::vec3(a.u), a.u.w, 2.0f)); }},
      {"Over", "vec4(Over(u.xyz, u.w, v.xyz), 0.0)",
       [](A a) { return Wide(Over(glm::vec3(a.u), a.u.w, glm::vec3(a.v))); }},
      {"LinearFromSrgb", "vec4(LinearFromSrgb(u.x), LinearFromSrgb(0.04 * u.y), 0.0, 0.0)",
       [](A a) { return glm::vec4(LinearFromSrgb(a.u.x), LinearFromSrgb(0.04f * a.u.y), 0, 0); }},
      {"SrgbFromLinear", "vec4(SrgbFromLinear(u.x), SrgbFromLinear(0.004 * u.y), 0.0, 0.0)",
       [](A a) { return glm::vec4(SrgbFromLinear(a.u.x), SrgbFromLinear(0.004f * a.u.y), 0, 0); }},
      {"Snorm16", "vec4(Snorm16(floatBitsToUint(d.x)), Snorm16(32768u), 0.0, 0.0)",
       [](A a) { return glm::vec4(Snorm16(BitsOf(a.d.x)), Snorm16(32768u), 0.0f, 0.0f); }},
      {"OctahedralNormal", "vec4(OctahedralNormal(floatBitsToUint(d.x) * 2654435761u), 0.0)",
       [](A a) { return Wide(OctahedralNormal(BitsOf(a.d.x) * 2654435761u)); }},
      {"Tone", "vec4(Tone(3.0 * u.x), Tone(0.5 * u.y), 0.0, 0.0)",
       [](A a) { return glm::vec4(Tone(3.0f * a.u.x), Tone(0.5f * a.u.y), 0.0f, 0.0f); }},
      {"Untone", "vec4(Untone(u.x), Untone(0.5 * u.y), Untone(1.0), Tone(Untone(u.x)) - u.x)",
       [](A a) {
         return glm::vec4(Untone(a.u.x), Untone(0.5f * a.u.y), Untone(1.0f),
                          Tone(Untone(a.u.x)) - a.u.x);
       }},
      {"FloorDistance", "vec4(FloorDistance(u.x, -0.1 - u.y), FloorDistance(u.x, u.y), 0.0, 0.0)",
       [](A a) {
         return glm::vec4(FloorDistance(a.u.x, -0.1f - a.u.y), FloorDistance(a.u.x, a.u.y), 0, 0);
       }},
      {"StudioColour", "vec4(StudioColour(d.xyz, u.x), 0.0)",
       [](A a) { return Wide(StudioColour(Unit(a.d), a.u.x)); }},
      {"ShadeEye", "LIGHT vec4(ShadeEye(light, look, -point.to_eye, e.xyz, point.to_eye), 0.0)",
       [](A a) {
         const glm::vec3 to_eye = PointOf(a).to_eye;
         return Wide(ShadeEye(LightOf(a), kLook, -to_eye, Unit(a.e), to_eye));
       }},
      {"HashShare", "vec4(HashShare(floatBitsToUint(d.x)), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(HashShare(BitsOf(a.d.x))); }},
      {"StrandNoise", "vec4(StrandNoise(uint(40000.0 * u.x), u.y, 8.0), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(StrandNoise(uint32_t(40000.0f * a.u.x), a.u.y, 8.0f)); }},
      {"ShBasis",
       "float y[16]; ShBasis(d.xyz, y); vec4(y[0] + 2.0 * y[4] + 3.0 * y[8] + 5.0 * y[12], y[1] + "
       "2.0 * y[5] + 3.0 * "
       "y[9] + 5.0 * y[13], y[2] + 2.0 * y[6] + 3.0 * y[10] + 5.0 * y[14], y[3] + 2.0 * y[7] + 3.0 "
       "* y[11] + 5.0 * "
       "y[15])",
       [](A a) {
         float y[16];
         ShBasis(Unit(a.d), y);
         glm::vec4 sum(0.0f);
         for (int i = 0; i < 4; ++i)
           sum[i] = y[i] + 2.0f * y[i + 4] + 3.0f * y[i + 8] + 5.0f * y[i + 12];
         return sum;
       }},
      {"ShDisc", "ShDisc(1.5 * u.x)", [](A a) { return ShDisc(1.5f * a.u.x); }},
      {"ShWindow", "ShWindow(4.0 + 2.0 * u.x)", [](A a) { return ShWindow(4.0f + 2.0f * a.u.x); }},
      {"ShWrapped", "ShWrapped(u.x)", [](A a) { return ShWrapped(a.u.x); }},
      {"ShGloss", "ShGloss(28.0 * u.x)", [](A a) { return ShGloss(28.0f * a.u.x); }},
      {"ShLight", "LIGHT vec4(ShLight(light.sky, e.xyz, kShLambert), 0.0)",
       [](A a) { return Wide(ShLight(LightOf(a).sky, Unit(a.e), kShLambert)); }},
      {"CoatColour", "LIGHT vec4(CoatColour(look, u.xyz, u.w), 0.0)",
       [](A a) { return Wide(CoatColour(kLook, glm::vec3(a.u), a.u.w)); }},
      {"Highlights", "LIGHT vec4(Highlights(look, point, light.to_sun), 0.0)",
       [](A a) { return Wide(Highlights(kLook, PointOf(a), Unit(a.d))); }},
      {"OutlineLight", "LIGHT vec4(OutlineLight(light, look, u.xyz, e.xyz, point.to_eye), 0.0)",
       [](A a) {
         const glm::vec3 to_eye = PointOf(a).to_eye;
         return Wide(OutlineLight(LightOf(a), kLook, glm::vec3(a.u), Unit(a.e), to_eye));
       }},
      {"ShadeHair", "LIGHT vec4(ShadeHair(light, look, point), 0.0)",
       [](A a) { return Wide(ShadeHair(LightOf(a), kLook, PointOf(a))); }},
      {"ShellPosition", "vec4(ShellPosition(u.xyz, d.xyz, v.xyz, u.w), 0.0)",
       [](A a) { return Wide(ShellPosition(glm::vec3(a.u), Unit(a.d), glm::vec3(a.v), a.u.w)); },
       "shell_shading.glsl"},
      {"ShellDirection", "vec4(ShellDirection(d.xyz, 0.4 * v.xyz, u.w), 0.0)",
       [](A a) { return Wide(ShellDirection(Unit(a.d), 0.4f * glm::vec3(a.v), a.u.w)); },
       "shell_shading.glsl"},
      {"ShellCoverage", "vec4(ShellCoverage(u.x, u.y, 0.5 * u.z), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(ShellCoverage(a.u.x, a.u.y, 0.5f * a.u.z)); }, "shell_shading.glsl"},
      {"ShadeSkin", "LIGHT vec4(ShadeSkin(light, look, u.xyz, e.xyz, point.to_eye, u.w, u.x), 0.0)",
       [](A a) {
         return Wide(ShadeSkin(LightOf(a), kLook, glm::vec3(a.u), Unit(a.e), PointOf(a).to_eye,
                               a.u.w, a.u.x));
       }},
      {"TintColour", "vec4(TintColour(u.xyz, 0.5 + 0.5 * u.w, 0.2 * u.zyx), 0.0)",
       [](A a) {
         const glm::vec3 add = 0.2f * glm::vec3(a.u.z, a.u.y, a.u.x);
         return Wide(TintColour(glm::vec3(a.u), 0.5f + 0.5f * a.u.w, add));
       }},
      {"WetColour", "vec4(WetColour(u.xyz, u.w, abs(v.x)), 0.0)",
       [](A a) { return Wide(WetColour(glm::vec3(a.u), a.u.w, std::abs(a.v.x))); }},
      {"MudColour", "vec4(MudColour(u.xyz, u.w, abs(v.xyz)), 0.0)",
       [](A a) { return Wide(MudColour(glm::vec3(a.u), a.u.w, glm::abs(glm::vec3(a.v)))); }},
      {"DustColour", "vec4(DustColour(u.xyz, u.w, abs(v.xyz)), 0.0)",
       [](A a) { return Wide(DustColour(glm::vec3(a.u), a.u.w, glm::abs(glm::vec3(a.v)))); }},
      {"Clotted", "vec4(Clotted(u.x, u.y), Clotted(0.0, u.y), Clotted(1.0, u.y), 0.0)",
       [](A a) {
         return glm::vec4(Clotted(a.u.x, a.u.y), Clotted(0.0f, a.u.y), Clotted(1.0f, a.u.y), 0);
       }},
      {"SnowCover", "vec4(SnowCover(u.x, d.xyz, u.y), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(SnowCover(a.u.x, Unit(a.d), a.u.y)); }},
      {"SeenPaint", "SeenPaint(u, d.xyz, abs(v.x))",
       [](A a) { return SeenPaint(a.u, Unit(a.d), std::abs(a.v.x)); }},
      {"PaintedColour", "LIGHT vec4(PaintedColour(paint, abs(v.xyz), u), 0.0)",
       [](A a) { return Wide(PaintedColour(PaintOf(a), glm::abs(glm::vec3(a.v)), a.u)); }},
      {"PaintedHair",
       "LIGHT vec4(PaintedHair(look, u).primary, PaintedHair(look, u).secondary, PaintedHair(look, "
       "u).primary_exponent + PaintedHair(look, u).secondary_exponent, PaintedHair(look, u).noise "
       "+ "
       "2.0 * PaintedHair(look, u).backlight + 4.0 * PaintedHair(look, u).scatter)",
       [](A a) {
         const HairLook look = PaintedHair(kLook, a.u);
         return glm::vec4(look.primary, look.secondary,
                          look.primary_exponent + look.secondary_exponent,
                          look.noise + 2.0f * look.backlight + 4.0f * look.scatter);
       }},
  };
}

std::vector<Function> ListAllFunctions() {
  std::vector<Function> all = ListFunctions();
  for (const auto& list :
       {ListReliefFunctions(), ListReliefShading(LightOf, kLook), ListStripFunctions()})
    all.insert(all.end(), list.begin(), list.end());
  return all;
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
    const std::string text = function.text;
    const size_t last = text.rfind(';');
    std::string before = last == text.npos ? "" : text.substr(0, last + 1);
    std::string value = last == text.npos ? text : text.substr(last + 1);
    constexpr std::string_view kMark = "LIGHT ";
    const size_t mark = value.find_first_not_of(' ');
    const bool is_lit = value.compare(mark, kMark.size(), kMark) == 0;
    if (is_lit) {
      before += kLightText;
      value.erase(mark, kMark.size());
    }
    return kHeightText + ShaderText(function.file) +
           (is_lit || function.file == std::string_view(kStudioFile)
                ? std::string(OwnText("paint_shading.glsl"))
                : "") +
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
  for (const Function& function : ListAllFunctions()) {
    const Result<std::vector<glm::vec4>> values = bench.Draw(function);
    ASSERT_TRUE(values) << function.name << ": " << values.error();
    for (GLsizei i = 0; i < kCases; ++i) {
      const glm::vec4 wanted = function.wanted(arguments[size_t(i)]);
      for (int c = 0; c < 4; ++c)
        ASSERT_NEAR((*values)[size_t(i)][c], wanted[c], kNear * std::max(1.0f, std::abs(wanted[c])))
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
  Function faulty = ListFunctions()[1];
  faulty.text = "vec4(HairDiffuse(d.xyz, e.xyz) * 1.01, 0.0, 0.0, 0.0)";
  const std::vector<glm::vec4> values = bench.Draw(faulty).OrThrow();
  float most = 0.0f;
  for (size_t i = 0; i < values.size(); ++i)
    most = std::max(most, std::abs(values[i].x - faulty.wanted(arguments[i]).x));
  EXPECT_GT(most, kNear);
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

// A function that is added to the shaders and not to the list above is found here.
TEST(ShaderValues, CoverEveryFunction) {
  std::string compared = kLightText;
  for (const Function& function : ListAllFunctions()) compared += std::string(function.text) + '\n';
  const std::regex function(R"((?:^|\n)\w+ ([A-Z]\w*)\()");
  int found = 0;
  for (const ShaderFile& file : EmbeddedShaders()) {
    if (file.name.starts_with("passes/")) continue;  // pictures are compared for those
    const std::string text(file.text);
    for (std::sregex_iterator at(text.begin(), text.end(), function), end; at != end; ++at) {
      EXPECT_NE(compared.find((*at)[1].str() + "("), compared.npos)
          << (*at)[1] << " of " << file.name;
      ++found;
    }
  }
  EXPECT_GT(found, 20);
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
