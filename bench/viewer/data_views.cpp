#include "bench/viewer/data_views.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

#include "core/bind_pose.hpp"
#include "core/random.hpp"
#include "jobs/draws.hpp"

namespace pelt {
namespace {

// m
constexpr float kNormalLength = 0.025f, kNormalWidth = 0.003f, kChainWidth = 0.002f;
constexpr float kStrandWidth = 0.001f, kJointWidth = 0.01f;

// ---- Colours, 0xAABBGGRR
// ----------------------------------------------------------------------------------------------

constexpr uint32_t kOpaque = 0xff000000u;

uint32_t Rgb(float r, float g, float b) {
  const auto byte = [](float v) { return uint32_t(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f); };
  return kOpaque | byte(b) << 16 | byte(g) << 8 | byte(r);
}

// Blue over green to red.
uint32_t Ramp(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return Rgb(2.0f * t - 0.6f, 1.0f - std::abs(2.0f * t - 1.0f), 1.0f - 1.6f * t);
}

// Neighbours in number are far apart in colour.
uint32_t ColourOfNumber(uint32_t number) {
  Random random(number + 1);
  const auto channel = [&] { return 0.15f + 0.8f * float(random.Below(256)) / 255.0f; };
  const float r = channel(), g = channel(), b = channel();
  return Rgb(r, g, b);
}

// ---- The fur's own strands in other colours
// ---------------------------------------------------------------------------

void Recolour(uint32_t colour, CurveRecord& record) {
  record.base_colour = record.tip_colour = colour;
}
void Recolour(uint32_t colour, RibbonVertex& vertex) { vertex.colour = colour; }
void Recolour(uint32_t colour, LineVertex& vertex) { vertex.colour = colour; }

template <class Vertex>
void RecolourVertices(const LayerDraw& draw, uint32_t place, uint32_t colour,
                      std::span<std::byte> vertices) {
  if (&kVertexType<Vertex> != draw.format().vertex_type) return;
  const size_t bytes = draw.format().StrandBytes();
  for (size_t at = place * bytes; at < (place + 1) * bytes; at += sizeof(Vertex)) {
    Vertex vertex;
    std::memcpy(&vertex, &vertices[at], sizeof(vertex));
    Recolour(colour, vertex);
    std::memcpy(&vertices[at], &vertex, sizeof(vertex));
  }
}

// colour(draw's number, place in drawing order) of every strand that is drawn.
void ColourStrands(PictureScene& shown, const auto& colour) {
  const std::span<std::vector<std::byte>> vertices = OwnVertices(shown);
  for (size_t i = 0; i < shown.draws.size(); ++i)
    for (uint32_t place = 0; place < shown.layers[i].size(); ++place) {
      const uint32_t value = colour(i, place);
      RecolourVertices<CurveRecord>(shown.draws[i], place, value, vertices[i]);
      RecolourVertices<RibbonVertex>(shown.draws[i], place, value, vertices[i]);
      RecolourVertices<LineVertex>(shown.draws[i], place, value, vertices[i]);
      shown.layers[i][place].base_colour = shown.layers[i][place].tip_colour = value;
    }
}

uint32_t ChunkOf(const FurScene& scene, const LayerDraw& draw, uint32_t place) {
  return scene.shape().layer_first_chunk[draw.layer] + draw.order[place] / kStrandsPerChunk;
}

void ShowChunks(const FurScene& scene, PictureScene& shown) {
  ColourStrands(shown, [&](size_t i, uint32_t place) {
    return ColourOfNumber(ChunkOf(scene, shown.draws[i], place));
  });
}

void ShowRest(const FurScene& scene, PictureScene& shown) {
  ColourStrands(shown, [&](size_t i, uint32_t place) {
    const auto& state =
        *scene.memory().Of<&Streams::chunk_state>(ChunkOf(scene, shown.draws[i], place));
    if (state.flags & kChunkSimulate) return Rgb(1.0f, 0.55f, 0.1f);
    return state.flags & kChunkSkin ? Rgb(0.3f, 0.8f, 0.4f) : Rgb(0.2f, 0.35f, 0.9f);
  });
}

void ShowSubsteps(const FurScene& scene, PictureScene& shown) {
  ColourStrands(shown, [&](size_t i, uint32_t) {
    const uint32_t layer = shown.draws[i].layer;
    const uint32_t kind = scene.shape().layer_kind[layer];
    if (!(kind & kLayerModal)) return Rgb(0.5f, 0.5f, 0.5f);
    const uint32_t substeps = WithPoints(StrandPointsOf(kind), [&]<uint32_t kPoints> {
      return scene.memory().Of<ChainStreams<kPoints, false>::kTable>(layer)->substeps;
    });
    return Ramp(float(substeps) / 8.0f);
  });
}

void ShowDrawOrder(const FurScene&, PictureScene& shown) {
  ColourStrands(shown, [&](size_t i, uint32_t place) {
    return Ramp(float(place) / float(std::max<size_t>(shown.layers[i].size() - 1, 1)));
  });
}

// Of each place of a layer, where it would be if strands were drawn by the depth of their middles.
std::vector<uint32_t> PlacesByDepth(const PictureScene& shown, size_t draw) {
  const std::vector<Hair>& hairs = shown.layers[draw];
  glm::vec3 eye, target;
  for (int c = 0; c < 3; ++c) {
    eye[c] = shown.camera.eye[c];
    target[c] = shown.camera.target[c];
  }
  std::vector<float> depth;
  depth.reserve(hairs.size());
  for (const Hair& hair : hairs)
    depth.push_back(glm::dot(hair.knot[hair.knots / 2].at - eye, target - eye));
  std::vector<uint32_t> by_depth(hairs.size()), place(hairs.size());
  std::iota(by_depth.begin(), by_depth.end(), 0u);
  std::ranges::stable_sort(by_depth, std::greater{}, [&](uint32_t i) { return depth[i]; });
  for (uint32_t rank = 0; rank < by_depth.size(); ++rank) place[by_depth[rank]] = rank;
  return place;
}

void ShowOrderError(const FurScene&, PictureScene& shown) {
  std::vector<std::vector<uint32_t>> right;
  for (size_t i = 0; i < shown.draws.size(); ++i) right.push_back(PlacesByDepth(shown, i));
  ColourStrands(shown, [&](size_t i, uint32_t place) {
    const double off = std::abs(double(right[i][place]) - double(place));
    // A tenth of the layer too early or too late is all red.
    return Ramp(float(10.0 * off / double(right[i].size())));
  });
}

// ---- Lines in the place of the fur
// ------------------------------------------------------------------------------------

struct Polyline {
  std::array<glm::vec3, kRibbonPoints> point;
  glm::vec3 normal;
  uint32_t colour;
  float width;  // m
};

Hair HairOf(const Polyline& line, uint32_t actor, uint32_t number) {
  Hair hair{};
  hair.knots = kRibbonPoints;
  for (uint32_t k = 0; k < kRibbonPoints; ++k) hair.knot[k] = {line.point[k], line.width};
  hair.base_colour = hair.tip_colour = line.colour;
  hair.actor = actor;
  hair.number = number;
  hair.root = line.point[0];
  hair.normal = line.normal;
  hair.paint_look = kDefaultPaint;
  return hair;
}

std::vector<std::byte> VerticesOf(const std::vector<Polyline>& lines) {
  std::vector<std::byte> bytes(lines.size() * kRibbonPoints * sizeof(LineVertex));
  for (size_t i = 0; i < lines.size(); ++i)
    for (uint32_t k = 0; k < kRibbonPoints; ++k) {
      LineVertex vertex{};
      std::memcpy(vertex.position, &lines[i].point[k], sizeof(vertex.position));
      vertex.width = lines[i].width;
      vertex.colour = lines[i].colour;
      std::memcpy(&bytes[(i * kRibbonPoints + k) * sizeof(vertex)], &vertex, sizeof(vertex));
    }
  return bytes;
}

// lines_of(layer) in the place of what the layer draws.
void ShowLines(const FurScene& scene, PictureScene& shown, const auto& lines_of) {
  shown.own_vertices.resize(shown.draws.size());
  shown.own_orders.resize(shown.draws.size());
  for (size_t i = 0; i < shown.draws.size(); ++i) {
    LayerDraw& draw = shown.draws[i];
    const uint32_t layer = draw.layer;
    const std::vector<Polyline> lines = lines_of(layer);
    shown.own_vertices[i] = VerticesOf(lines);
    shown.own_orders[i].resize(lines.size());
    std::iota(shown.own_orders[i].begin(), shown.own_orders[i].end(), 0u);
    LayerDraw to{};
    to.layer = layer;
    to.output = Output::kLines;
    to.vertices = shown.own_vertices[i];
    to.strand_count = uint32_t(lines.size());
    to.order = shown.own_orders[i];
    std::copy_n(draw.origin, 3, to.origin);
    std::copy_n(draw.low, 3, to.low);
    std::copy_n(draw.high, 3, to.high);
    to.tip_width = to.wet_darken = 1.0f;
    draw = to;
    shown.layers[i].clear();
    for (uint32_t n = 0; n < lines.size(); ++n)
      shown.layers[i].push_back(HairOf(lines[n], scene.shape().layer_character[layer], n));
  }
}

glm::vec3 VecAt(const float* p) { return {p[0], p[1], p[2]}; }

void ShowSkin(const FurScene& scene, PictureScene& shown) {
  ShowLines(scene, shown, [&](uint32_t layer) {
    std::vector<Polyline> lines;
    const SceneShape& shape = scene.shape();
    for (uint32_t p = shape.layer_first_patch[layer]; p < shape.layer_first_patch[layer + 1]; ++p)
      for (uint32_t v = 0; v < scene.memory().Of<&Streams::patch_state>(p)->live_vertices; ++v) {
        const SkinnedVertex& vertex = scene.memory().Of<&Streams::skinned>(p)->vertex[v];
        Polyline line{{}, VecAt(vertex.normal), Rgb(0.95f, 0.85f, 0.3f), kNormalWidth};
        for (uint32_t k = 0; k < kRibbonPoints; ++k)
          line.point[k] = VecAt(vertex.position) +
                          line.normal * (kNormalLength * float(k) / float(kRibbonPoints - 1));
        lines.push_back(line);
      }
    return lines;
  });
}

// Of the chains that are simulated: roots, and points of kPoints - 1 links.
template <uint32_t kPoints>
void AddChains(const RootBlock& roots, const PointBlock<kPoints>& points, uint32_t count,
               uint32_t colour, std::vector<Polyline>& lines) {
  for (uint32_t lane = 0; lane < count; ++lane) {
    Polyline line{{}, {}, colour, kChainWidth};
    for (int c = 0; c < 3; ++c) {
      line.normal[c] = roots.normal[c][lane];
      line.point[0][c] = roots.position[c][lane];
      // Of 9 points every second one; a chain of fewer than 5 has its tip twice.
      constexpr uint32_t kStep = kPoints > kRibbonPoints ? (kPoints - 1) / (kRibbonPoints - 1) : 1;
      for (uint32_t k = 1; k < kRibbonPoints; ++k)
        line.point[k][c] = points.position[std::min(kStep * k, kPoints - 1) - 1][c][lane];
    }
    lines.push_back(line);
  }
}

void ShowChains(const FurScene& scene, PictureScene& shown) {
  ShowLines(scene, shown, [&](uint32_t layer) {
    std::vector<Polyline> lines;
    const SceneShape& shape = scene.shape();
    const FrameMemory& memory = scene.memory();
    const uint32_t kind = shape.layer_kind[layer], colour = ColourOfNumber(layer);
    if (kind & kLayerShells) return lines;
    for (uint32_t p = shape.layer_first_patch[layer];
         (kind & kLayerVertexChains) && p < shape.layer_first_patch[layer + 1]; ++p)
      AddChains(*memory.Of<&Streams::anchors>(p), CopyChainPoints(memory, p),
                memory.Of<&Streams::patch_state>(p)->live_chains, colour, lines);
    if (kind & kLayerVertexChains) return lines;
    for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c) {
      const auto& state = *memory.Of<&Streams::chunk_state>(c);
      WithPoints(StrandPointsOf(kind), [&]<uint32_t kPoints> {
        AddChains(*memory.Of<&Streams::roots>(c),
                  *memory.Of<ChainStreams<kPoints, false>::kPosition>(c), state.live_strands,
                  colour, lines);
      });
    }
    return lines;
  });
}

void ShowStrands(const FurScene& scene, PictureScene& shown) {
  ShowLines(scene, shown, [&](uint32_t layer) {
    std::vector<Polyline> lines;
    std::vector<StrandCurve> curves(size_t(scene.shape().LayerChunks(layer)) * kStrandsPerChunk);
    curves.resize(scene.CopyCurves(layer, curves));
    std::vector<bool> is_drawn(size_t(scene.shape().LayerChunks(layer)) * kStrandsPerChunk);
    for (const LayerDraw& draw : scene.Draws())
      if (draw.layer == layer)
        for (uint32_t place = 0; place < draw.strand_count; ++place)
          is_drawn[draw.order[place]] = true;
    for (const StrandCurve& curve : curves) {
      const uint32_t colour =
          is_drawn[curve.strand] ? Rgb(0.85f, 0.85f, 0.85f) : Rgb(0.9f, 0.1f, 0.1f);
      Polyline line{{}, {}, colour, kStrandWidth};
      for (uint32_t k = 0; k < kRibbonPoints; ++k) line.point[k] = VecAt(curve.point[k]);
      line.normal = glm::vec3(0.0f, 1.0f, 0.0f);
      lines.push_back(line);
    }
    return lines;
  });
}

// ---- The skeleton
// -----------------------------------------------------------------------------------------------

glm::vec3 PlaceOfJoint(const SkeletonBlock& skeleton, const PaletteBlock& palette, uint32_t joint) {
  double bound[3];
  PlaceInMesh(skeleton, joint, {0.0f, 0.0f, 0.0f}, bound);
  const float* m = palette.matrix[joint];
  glm::vec3 at;
  for (int c = 0; c < 3; ++c, m += 4)
    at[c] = float(double(m[0]) * bound[0] + double(m[1]) * bound[1] + double(m[2]) * bound[2] +
                  double(m[3]));
  return at;
}

void ShowJoints(const FurScene& scene, PictureScene& shown) {
  ShowLines(scene, shown, [&](uint32_t layer) {
    std::vector<Polyline> lines;
    const uint32_t character = scene.shape().layer_character[layer];
    const auto& skeleton = *scene.memory().Of<&Streams::skeleton>(character);
    const auto& palette = *scene.memory().Of<&Streams::palette>(character);
    const auto& joints = *scene.memory().Of<&Streams::layer_joints>(layer);
    for (uint32_t i = 0; i < joints.count; ++i) {
      const uint32_t joint = joints.joint[i];
      const glm::vec3 to = PlaceOfJoint(skeleton, palette, joint);
      const int32_t parent = skeleton.parent[joint];
      const glm::vec3 from = parent < 0 ? to - glm::vec3(0.0f, kJointWidth, 0.0f)
                                        : PlaceOfJoint(skeleton, palette, uint32_t(parent));
      Polyline line{{}, {0.0f, 1.0f, 0.0f}, ColourOfNumber(joint), kJointWidth};
      for (uint32_t k = 0; k < kRibbonPoints; ++k)
        line.point[k] = glm::mix(from, to, float(k) / float(kRibbonPoints - 1));
      lines.push_back(line);
    }
    return lines;
  });
}

glm::vec3 VecOfColour(uint32_t colour) {
  return glm::vec3(float(colour & 255u), float(colour >> 8 & 255u), float(colour >> 16 & 255u)) /
         255.0f;
}

// Of a vertex of the mesh: its joints' colours by their weights.
glm::vec3 ColourOfWeights(const MeshBlock& mesh, uint32_t vertex) {
  const uint32_t group = vertex / kLaneGroup;
  glm::vec3 colour(0.0f);
  for (uint32_t row = mesh.group_first_row[group]; row < mesh.group_first_row[group + 1]; ++row)
    colour +=
        mesh.weight[row][vertex % kLaneGroup] * VecOfColour(ColourOfNumber(mesh.row_joint[row]));
  return colour;
}

void ShowWeights(const FurScene& scene, PictureScene& shown) {
  ColourStrands(shown, [&](size_t i, uint32_t place) {
    const LayerDraw& draw = shown.draws[i];
    const uint32_t chunk = ChunkOf(scene, draw, place), s = draw.order[place] % kStrandsPerChunk;
    const auto& strands = *scene.memory().Of<&Streams::strands>(chunk);
    const auto& halo = *scene.memory().Of<&Streams::halo>(chunk);
    glm::vec3 colour(0.0f);
    for (int k = 0; k < 3; ++k) {
      const uint32_t vertex = halo.vertex[strands.vertex[k][s]];
      const uint32_t patch =
          scene.shape().layer_first_patch[draw.layer] + vertex / kVerticesPerChunk;
      colour += strands.bary[k][s] * ColourOfWeights(*scene.memory().Of<&Streams::mesh>(patch),
                                                     vertex % kVerticesPerChunk);
    }
    return Rgb(colour.r, colour.g, colour.b);
  });
}

constexpr DataView kViews[] = {
    {"fur", "What is drawn: strands far to near, lit.", nullptr},
    {"joints", "The joints that move each layer's fur, each a line from its parent.", ShowJoints},
    {"weights", "By which joints each strand is moved: their colours, mixed by the skin's weights.",
     ShowWeights},
    {"skin",
     "Skinning: each chunk's own vertices of the mesh, with their normals. Only these are skinned, "
     "not the mesh.",
     ShowSkin},
    {"chains",
     "Simulation: a chain of three or four links at every skinned vertex, or one for every strand.",
     ShowChains},
    {"strands",
     "All strands that live, after interpolation, clumping and fitting. Red ones are not drawn: "
     "they face away.",
     ShowStrands},
    {"chunks",
     "Chunks, each in a colour: 128 strands that fit a local store, one item of every job.",
     ShowChunks},
    {"work",
     "What ran for each chunk. Orange: simulated; green: only skinned; blue: at rest, nothing.",
     ShowRest},
    {"substeps",
     "Substeps of the solver, by the size on the screen: blue few, red eight. Grey: another "
     "solver.",
     ShowSubsteps},
    {"draw order", "The order of drawing in each layer: blue first and farthest, red last.",
     ShowDrawOrder},
    {"order error",
     "How far each strand is from its place by depth: blue right, red a tenth of the layer off.",
     ShowOrderError},
};

constexpr auto kNames = [] {
  std::array<std::string_view, std::size(kViews)> names;
  for (size_t i = 0; i < names.size(); ++i) names[i] = kViews[i].name;
  return names;
}();

}  // namespace

uint32_t ColourOfJoint(uint32_t joint) { return ColourOfNumber(joint); }
std::span<const DataView> DataViews() { return kViews; }
std::span<const std::string_view> DataViewNames() { return kNames; }

}  // namespace pelt
