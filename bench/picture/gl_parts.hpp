// What a picture shows, as the graphics card has it: skin and eyes, relief, strands, shells, and the sun's maps and the
// light of all of them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "bench/picture/gl_objects.hpp"
#include "bench/picture/picture.hpp"

namespace pelt {

// The characters' skin and eyes.
class GlBodies {
 public:
  GlBodies(const GlApi& gl, const PictureScene& scene);

  // By the program that is in use: of GlPrograms, `body` or `body_shadow`.
  void DrawSkin(uint32_t actor) const;
  // By GlPrograms' eye, in use.
  void DrawEyes(const GlProgram& program, const std::vector<Eye>& eyes) const;

 private:
  struct Part {  // triangles with one image
    GlTexture image;
    GLint first;
    GLsizei vertices;
  };
  struct Skin {
    GlMesh mesh;
    std::vector<Part> parts;
    GlTexture growth;  // sheets of its mapped layers
  };
  Skin Upload(const Body& body) const;

  const GlApi& gl_;
  GlVertexArray nothing_;
  std::vector<Skin> skins_;
};

// Fur as relief: the skin's triangles once more for each of its layers, over the skin.
class GlRelief {
 public:
  GlRelief(const GlApi& gl, const PictureScene& scene);

  bool Has(uint32_t actor) const { return !coats_[actor].parts.empty(); }
  // By GlPrograms' relief, in use, where the skin has been drawn: layers in the setup's order, each behind light(layer).
  void Draw(const GlProgram& program, uint32_t actor,
            const std::function<void(size_t)>& light) const;

 private:
  struct Part {  // triangles of a layer with one sheet of its flow map
    size_t layer;
    GlTexture flow;
    glm::vec2 repeat;
    float longest_m;
    GLint first;
    GLsizei vertices;
  };
  struct Coat {
    GlMesh mesh;
    GlTexture tile;
    std::vector<Part> parts;
  };
  Coat Upload(const Body& body) const;

  const GlApi& gl_;
  std::vector<Coat> coats_;
};

// Film strips: strip_texture.hpp's levels, a layer of one texture for each strip.
class GlStrips {
 public:
  explicit GlStrips(const GlApi& gl) : gl_(&gl), texture_(gl) {}

  // At least so many strips. Those that there are stay for the next picture.
  void Make(uint32_t strips);
  GLuint texture() const { return texture_; }

 private:
  const GlApi* gl_;
  GlTexture texture_;
  uint32_t strips_ = 0;
};

// A frame's draw list: vertices as they are, and the roots that they do not know of.
class GlStrands {
 public:
  // `strips`: Pelt's own, of layers that have no texture of an artist's.
  GlStrands(const GlApi& gl, const PictureScene& scene, GLuint strips);

  size_t layers() const { return layers_.size(); }
  // By a program of the layer's output, in use from here on: strips of two corners at each knot; or lines, of what
  // casts shadows.
  void DrawStrips(const std::vector<GlProgram>& programs, size_t layer) const;
  void DrawShadows(const std::vector<GlProgram>& programs, size_t layer) const;

 private:
  struct Layer {
    GlTexture vertices, roots, looks, shadow_roots;  // the last of those alone that cast shadows
    size_t output = 0;                               // its place in GlPrograms' lists
    GLsizei strands = 0, casting = 0, knots = 0;
    uint32_t actor = 0, first_strand = 0;
    float tip_width = 1.0f, shadow_width = 1.0f;
    bool is_lit = false;
    PaintLook paint = kDefaultPaint;
    std::shared_ptr<const GlTexture> strips = {};  // an artist's; null: Pelt's own
    int strip_meaning = 0;                         // of their texels
    glm::vec3 strand_tint{1.0f};
    float shadow_alpha = 0.0f;
  };
  Layer Upload(const LayerDraw& draw, const std::vector<Hair>& hairs,
               const StripTexture* strips) const;
  void Bind(const std::vector<GlProgram>& programs, const Layer& layer) const;

  const GlApi& gl_;
  bool in_strand_order_;
  GLuint strips_;
  std::vector<Layer> layers_;
};

// Layers of shells: the skin's triangles, drawn once for each shell.
class GlShells {
 public:
  GlShells(const GlApi& gl, const PictureScene& scene);

  bool Has(size_t layer) const { return layers_[layer].corners > 0; }
  // By GlPrograms' shell, in use: from the skin up, over what is there; as instances, or with a draw for each.
  void Draw(const GlProgram& program, size_t layer, std::span<const Shell> shells,
            bool one_by_one) const;
  // By GlPrograms' shell_shadow, in use.
  void DrawShadow(const GlProgram& program, size_t layer) const;

  bool HasFins(size_t layer) const { return layers_[layer].fin_count > 0; }
  // By GlPrograms' fin, in use: over what is there.
  void DrawFins(const GlProgram& program, size_t layer, const ShellDraw& shells) const;

 private:
  struct Layer {
    GlMesh mesh;
    GlBuffer shells;  // instances
    GlTexture texture;
    GLsizei corners;
    GlMesh fins;  // an instance each
    GLsizei fin_count;
    GlTexture covers;            // ShadowShell::covers, a row each
    std::vector<float> heights;  // and what they are of
    GlTexture growth;
    float growth_scale;  // passes/stencil.glsl has it
  };
  Layer Upload(const LayerDraw& draw, const FurTexture& texture, const ShellGrowth& growth) const;
  void BindTextures(const GlProgram& program, const Layer& layer) const;

  const GlApi& gl_;
  GlVertexArray nothing_;
  std::vector<Layer> layers_;
};

// The sun's maps, as shadows.hpp has them in software: one for each character, the layers of one texture.
//
// Invariant: blended by MIN, and by ADD of whole numbers: what is drawn in another order gives the same bits.
class GlShadows {
 public:
  // Draws them, and leaves them bound where passes look for them.
  GlShadows(const GlApi& gl, const GlPrograms& programs, const PictureScene& scene,
            const GlBodies& bodies, const GlStrands& strands, const GlShells& shells);

  // A normal's length by which skin is lifted out of its own shadow, m.
  float Lift(uint32_t actor) const;
  // A character's map: r, g, b the nearest distance, a the coverage, of 255.
  std::vector<glm::vec4> Read(uint32_t actor) const;

 private:
  GlTexture UploadCharacters(const glm::vec3& to_sun) const;
  void DrawMap(const GlPrograms& programs, const PictureScene& scene, const GlBodies& bodies,
               const GlStrands& strands, const GlShells& shells, uint32_t actor) const;
  void Attach(GLuint texture, uint32_t layer) const;

  const GlApi& gl_;
  std::vector<Ball> balls_;
  GlTexture maps_, soft_, characters_;
  GlFramebuffer target_;
};

// Columns: along a map's x and y, to the sun.
glm::mat3 SunAxes(const glm::vec3& to_sun);

// EyePet's lighting buffer: what light does at the skin, in half of the picture's width and height, blurred so that
// hair takes it from where it is seen; a hair then costs no light of its own. What is behind everything has rim light,
// which blurring brings in over the outline.
class GlLighting {
 public:
  // Draws it, and leaves it bound where passes look for it.
  GlLighting(const GlApi& gl, const GlPrograms& programs, const PictureScene& scene,
             const GlBodies& bodies, const GlShadows& shadows, const PictureOptions& options);

 private:
  GlTexture coefficients_;
};

}  // namespace pelt
