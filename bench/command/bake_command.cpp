#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/report/report_tree.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/flow_map.hpp"
#include "core/groom/groom_file.hpp"
#include "core/groom/height_field.hpp"
#include "core/groom/nearest_word.hpp"
#include "core/groom/photo_strip.hpp"

namespace pelt {
namespace {

using Clock = std::chrono::steady_clock;

double MsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct BakeReport {
  std::vector<std::string> notes;
  Groom groom;
  ScatterStats stats;
  std::vector<LayerDensity> densities = {};
  std::vector<uint32_t> max_strands = {};  // of each layer; 0: no limit
  OutputPath out;
  struct Grey {
    const char *key, *what;
    OutputPath out;
  };
  std::vector<Grey> greys = {};
  struct Flow {
    OutputPath out;
    uint32_t sheets = 0;
    double covered = 0.0, contested = 0.0;  // shares
    float longest_m = 0.0f;
  } flow = {};
  uint64_t file_bytes = 0, digest = 0;
  double import_ms = 0.0, bake_ms = 0.0;
};

uint64_t Strands(const Groom& groom) {
  uint64_t strands = 0;
  for (const GroomLayer& layer : groom.layers) strands += layer.strand_count;
  return strands;
}

double Fill(uint64_t strands, uint64_t chunks) {
  return chunks ? double(strands) / (double(chunks) * kStrandsPerChunk) : 0.0;
}

struct Spacing {
  const char *key, *heading;
  SpacingStats PrefixStats::*of;
};
constexpr Spacing kSpacings[] = {
    {"layer", "layer", &PrefixStats::layer},
    {"every_chunk", "every chunk", &PrefixStats::every_chunk},
    {"inside_chunks", "inside a chunk", &PrefixStats::inside_chunks},
    {"plain_every_chunk", "plain", &PrefixStats::plain_every_chunk},
    {"plain_inside_chunks", "plain inside", &PrefixStats::plain_inside_chunks}};

// In text one column for each spacing, in JSON its members.
ReportTable PrefixTable(const LayerScatterStats& layer) {
  ReportTable table{{}, {{"share", "%", -3, "prefix", 100}}};
  for (const Spacing& spacing : kSpacings) {
    table.columns.push_back(InText(spacing.heading));
    for (const char* member : {"mean", "least", "variation", "count"})
      table.columns.push_back(InJson(fmt::format("{}.{}", spacing.key, member)));
  }
  for (const PrefixStats& prefix : layer.prefix) {
    std::vector<Value> row = {prefix.share};
    for (const Spacing& spacing : kSpacings) {
      const SpacingStats& s = prefix.*spacing.of;
      for (Value value : {Value(fmt::format("{:.3f} {:.3f} {:.2f}", s.mean, s.least, s.variation)),
                          Value(s.mean), Value(s.least), Value(s.variation), Value(s.count)})
        row.push_back(std::move(value));
    }
    table.Add(std::move(row));
  }
  return table;
}

// Which of the two said how many strands there are.
bool IsByMaxStrands(const BakeReport& report, size_t layer) {
  const uint32_t most = report.max_strands[layer];
  const LayerDensity& density = report.densities[layer];
  return most > 0 && (density.scatter.grown == most || density.IsCut());
}

// A cut is seen at once, and a max_strands that decides nothing, too.
void SayWhatDecided(const BakeReport& report, ReportTree& tree) {
  size_t by_most = 0, idle = 0;
  for (size_t l = 0; l < report.max_strands.size(); ++l) {
    by_most += IsByMaxStrands(report, l);
    idle += report.max_strands[l] > 0 && !IsByMaxStrands(report, l);
  }
  if (by_most)
    tree.Say(
        fmt::format("max_strands cuts {} of {} layers: their density says where fur is denser, "
                    "no longer how dense it is.",
                    by_most, report.max_strands.size()));
  if (idle)
    tree.Say(fmt::format("max_strands of {} of {} layers is not reached: density decides.", idle,
                         report.max_strands.size()));
}

void AddLayers(const BakeReport& report, ReportTree& tree) {
  ReportTable& layers = tree.AddTable("layers", {{"layer"},
                                                 {"strands"},
                                                 {"chunks"},
                                                 InText("fill", "%", 1),
                                                 InText("longest", "mm", 1),
                                                 {"spacing_mm", "mm", 2, "spacing"},
                                                 {"density_strands", "strands", 0, "density's"},
                                                 {"max_strands", "strands"},
                                                 {"decided_by"},
                                                 InText("left", "%", -2),
                                                 InJson("prefixes")});
  for (size_t l = 0; l < report.groom.layers.size(); ++l) {
    const GroomLayer& layer = report.groom.layers[l];
    const LayerDensity& density = report.densities[l];
    const ScatterDensity& scatter = density.scatter;
    layers.Add({layer.name, layer.strand_count, layer.chunk_count,
                100.0 * Fill(layer.strand_count, layer.chunk_count),
                1000.0 * double(layer.length_max), 1000.0 * double(scatter.spacing_m),
                scatter.asked, report.max_strands[l] ? Value(report.max_strands[l]) : Value{},
                IsByMaxStrands(report, l) ? "max_strands" : "density",
                density.IsCut() ? Value(100.0 * double(scatter.grown) / scatter.asked) : Value{},
                report.stats.layers.empty() ? Value{} : PrefixTable(report.stats.layers[l])});
  }
  const uint64_t strands = Strands(report.groom), chunks = report.groom.strands.size();
  layers.Add({"all", strands, chunks, 100.0 * Fill(strands, chunks)}, Show::kText);
  SayWhatDecided(report, tree);
  tree.Add(InJson("strands"), strands).Add(InJson("chunks"), chunks);
  tree.Add(InJson("fill"), Fill(strands, chunks));
}

// Cost against error of chains that are left out.
void AddChains(const BakeReport& report, ReportTree& tree) {
  const auto is_cut = [](const LayerDensity& layer) {
    return layer.chains.simulated < layer.chains.all;
  };
  if (!std::ranges::any_of(report.densities, is_cut)) return;
  tree.BlankLine();
  tree.Say(
      "Chains at mesh vertices, those simulated, those of the chain_mesh; from the vertices of the "
      "others to where the chains that they follow put them, mean and 95 %:");
  ReportTable& table = tree.AddTable("simulated_chains", {{"layer"},
                                                          {"chains"},
                                                          {"simulated"},
                                                          {"of_chain_mesh"},
                                                          {"apart_mean_mm", "mm", 2, "mean"},
                                                          {"apart_p95_mm", "mm", 2, "95 %"}});
  for (const LayerDensity& layer : report.densities)
    if (const LayerChains& chains = layer.chains; is_cut(layer))
      table.Add({layer.layer, chains.all, chains.simulated, chains.of_mesh, 1000.0 * chains.mean_m,
                 1000.0 * chains.p95_m});
}

void AddStats(const ScatterStats& stats, ReportTree& tree) {
  tree.BlankLine();
  tree.Say(
      "Spacing: nearest-neighbour distance over that of the densest packing (1 is the ideal): "
      "mean, least, variation; 'every chunk' is what LOD draws, 'plain' is rejection sampling.");
  for (const LayerScatterStats& layer : stats.layers) {
    tree.BlankLine();
    tree.Say(fmt::format(
        "layer '{}': {} strands in {} chunks, filled {:.1f} %; {} patches, filled {:.1f} % with "
        "vertices, {:.1f} % with weight rows; {:.2f} joints for 16 vertices, {:.2f} chunks use a "
        "vertex",
        layer.name, layer.strand_count, layer.chunk_count, 100.0 * layer.strand_fill,
        layer.patch_count, 100.0 * layer.vertex_fill, 100.0 * layer.row_fill, layer.rows_per_group,
        layer.chunks_per_vertex));
    tree.AddTable({}, {}) = PrefixTable(layer);
  }
}

void AddMaps(const BakeReport& report, ReportTree& tree) {
  if (const BakeReport::Flow& flow = report.flow; !flow.out.empty()) {
    tree.EndLine();
    tree.Add({"flow_map", "", -1, "flow map"}, flow.out.path());
    tree.Add({"flow_sheets", "", -1, "sheets"}, flow.sheets);
    tree.Add({"flow_covered", "%", 1, "covered", 100}, flow.covered);
    tree.Add({"flow_contested", "%", -2, "contested", 100}, flow.contested);
    tree.Add({"flow_longest_mm", "mm", 1, "longest"}, 1000.0 * double(flow.longest_m));
    tree.Say(
        fmt::format("read back by: flow_map = {{ map = \"{}\", blue = \"length\", longest = {} }}",
                    flow.out.path(), flow.longest_m));
  }
  for (const BakeReport::Grey& grey : report.greys) {
    tree.EndLine();
    tree.Add({grey.key, "", -1, grey.what}, grey.out.path());
  }
}

ReportTree MakeTree(const BakeReport& report) {
  ReportTree tree;
  tree.AddTexts("notes", report.notes, "note");
  tree.Add(InJson("unit_scale"), report.groom.unit_scale);
  AddLayers(report, tree);
  AddChains(report, tree);
  if (!report.stats.layers.empty()) AddStats(report.stats, tree);
  tree.BlankLine();
  tree.Add({"import_ms", "ms", 0, "import"}, report.import_ms);
  tree.Add({"bake_ms", "ms", 0, "bake"}, report.bake_ms);
  tree.Add(InText("a strand", "us", 2), 1000.0 * report.bake_ms / double(Strands(report.groom)));
  tree.EndLine();
  tree.Add({"bytes", "bytes", -1, "groom"}, report.file_bytes);
  tree.Add({"digest"}, DigestText(report.digest));
  if (report.out.empty())
    tree.Say("not written: no --out");
  else
    tree.Add({"out", "", -1, "written to"}, report.out.path());
  AddMaps(report, tree);
  return tree;
}

const LayerSetup& FindLayer(const FurSetup& setup, const std::string& name) {
  if (name.empty() && !setup.layers.empty()) return setup.layers.front();
  std::vector<std::string> known;
  for (const LayerSetup& layer : setup.layers) {
    if (layer.name == name) return layer;
    known.push_back(layer.name);
  }
  throw Error(fmt::format("{}: no layer '{}'; there are: {}{}", setup.path, name,
                          fmt::join(known, ", "), DidYouMean(name, known)));
}

void WriteFlowMap(const BakeArgs& args, const Character& character, const RestGeometry& rest,
                  const FurSetup& setup, BakeReport& report) {
  if (args.flow_map.empty()) return;
  const LayerSetup& layer = FindLayer(setup, args.flow_layer);
  const FlowMap map = MakeFlowMap(character, rest, setup, layer, args.flow_side);
  const double texels = double(map.side) * map.side * map.sheets;
  const double taken = double(std::max<uint64_t>(map.covered, 1));
  report.flow = {args.flow_map, map.sheets, double(map.covered) / texels,
                 double(map.contested) / taken, map.longest_m};
  if (map.sheets > 1)
    report.notes.push_back(fmt::format(
        "flow map: UVs give places of the texture to several of the surface; {} sheets, one below "
        "the other",
        map.sheets));
  WritePng("flow map", args.flow_map, map.rgba, map.side, map.side * map.sheets, 4);
}

void WriteGreys(const BakeArgs& args, const Character& character, const RestGeometry& rest,
                const FurSetup& setup, BakeReport& report) {
  const auto write = [&](const char* key, const char* what, const OutputPath& out, uint32_t side,
                         const auto& make) {
    if (out.empty()) return;
    WritePng(what, out, make(), side, side, 1);
    report.greys.push_back({key, what, out});
  };
  write("height_field", "height field", args.height_field, kHairTileSide, MakeHairTile);
  write("skin_map", "skin map", args.skin_map, args.flow_side,
        [&] { return DrawSkinMap(character, setup, report.groom, args.flow_side, report.notes); });
  write("stencil_map", "stencil map", args.stencil_map, args.flow_side,
        [&] { return MakeStencil(character, rest, setup, args.flow_side); });
}

void WriteStrip(const BakeArgs& args) {
  RequirePictures();
  const StrandTexture strip =
      CutStrips(ReadControlMapFile(args.strip_from), args.strips, args.strip_from);
  WritePng("strip", args.strip, strip.rgba, strip.width, strip.height, 4);
  fmt::print("{}: {} strips of {} x {} texels\n", args.strip.path(), strip.strips,
             strip.width / strip.strips, strip.height);
}

}  // namespace

ExitCode Bake(const BakeArgs& args) {
  if (args.keys) {
    fmt::print("{}", DescribeSetupKeys());
    return kDone;
  }
  if (!args.strip.empty()) {
    WriteStrip(args);
    return kDone;
  }
  for (const OutputPath* png :
       {&args.flow_map, &args.height_field, &args.skin_map, &args.stencil_map})
    if (!png->empty()) RequirePictures();
  BakeReport report;
  report.out = args.out;
  auto start = Clock::now();
  const Character character = LoadCharacter(args.character);
  const FurSetup setup = LoadSetup(args.setup, args.seed);
  if (args.check_files_read) args.check_files_read(FilesReadFor(character, setup));
  report.notes = character.notes;
  const float unit_scale = ChooseUnitScale(setup, character, report.notes);
  const RestGeometry rest = ComputeRestGeometry(character, unit_scale);
  report.import_ms = MsSince(start);
  start = Clock::now();
  {
    Progress bar("bake", 100);
    const BakeProgress show = [&](std::string_view layer, float share) {
      bar.Show(uint64_t(100.0f * share), layer);
    };
    report.groom =
        BakeGroom(character, rest, setup, unit_scale, &show, args.stats ? &report.stats : nullptr,
                  &report.densities, &report.notes);
  }
  report.bake_ms = MsSince(start);
  for (const LayerSetup& layer : setup.layers) report.max_strands.push_back(layer.max_strands);
  if (!IsBuiltInName(args.setup) || !IsBuiltInName(args.character))  // ours are as bare as meant
    for (std::string& warning : WarnOfBaldness(report.densities))
      report.notes.push_back(std::move(warning));
  const std::vector<std::byte> bytes = WriteGroom(report.groom).OrThrow();
  report.file_bytes = bytes.size();
  report.digest = HashGroomBytes(bytes);
  if (!args.out.empty()) WriteOutput("groom", args.out, bytes);
  WriteFlowMap(args, character, rest, setup, report);
  WriteGreys(args, character, rest, setup, report);
  MakeTree(report).Print(args.json);
  return kDone;
}

}  // namespace pelt
