#include <fmt/format.h>

#include <chrono>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/report/json_text.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/groom_file.hpp"

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
  OutputPath out;
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

// What max_strands took away.
std::string DescribeCut(const LayerDensity& density) {
  const ScatterDensity& s = density.scatter;
  if (!density.IsCut()) return {};
  return fmt::format("  max_strands leaves {:.2g} % of the density's {:.0f}",
                     100.0 * double(s.grown) / s.asked, s.asked);
}

std::string DescribeBake(const BakeReport& report, bool with_stats) {
  std::string out;
  for (const std::string& note : report.notes) out += fmt::format("note: {}\n", note);
  out += fmt::format("{:<20} {:>8} {:>7} {:>7} {:>12} {:>10}\n", "layer", "strands", "chunks",
                     "fill", "longest mm", "spacing mm");
  for (size_t l = 0; l < report.groom.layers.size(); ++l) {
    const GroomLayer& layer = report.groom.layers[l];
    const LayerDensity& density = report.densities[l];
    out += fmt::format("{:<20} {:>8} {:>7} {:>6.1f}% {:>12.1f} {:>10.2f}{}\n", layer.name,
                       layer.strand_count, layer.chunk_count,
                       100.0 * Fill(layer.strand_count, layer.chunk_count),
                       1000.0 * double(layer.length_max),
                       1000.0 * double(density.scatter.spacing_m), DescribeCut(density));
  }
  const uint64_t strands = Strands(report.groom), chunks = report.groom.strands.size();
  out += fmt::format("{:<20} {:>8} {:>7} {:>6.1f}%\n", "all", strands, chunks,
                     100.0 * Fill(strands, chunks));
  if (with_stats) out += '\n' + FormatScatterStats(report.stats);
  out += fmt::format("import {:.0f} ms, bake {:.0f} ms ({:.2f} us a strand)\n", report.import_ms,
                     report.bake_ms, 1000.0 * report.bake_ms / double(strands));
  out += fmt::format("groom {} bytes, digest {:016x}", report.file_bytes, report.digest);
  return out + (report.out.empty() ? ", not written: no --out\n"
                                   : fmt::format(", written to {}\n", report.out.path()));
}

void AddSpacing(JsonText& json, std::string_view key, const SpacingStats& s) {
  json.BeginObject(key);
  json.Add("mean", s.mean);
  json.Add("least", s.least);
  json.Add("variation", s.variation);
  json.Add("count", s.count);
  json.EndObject();
}

std::string BakeAsJson(const BakeReport& report, bool with_stats) {
  JsonText json;
  json.BeginObject();
  json.BeginArray("notes");
  for (const std::string& note : report.notes) json.Add("", note);
  json.EndArray();
  json.Add("unit_scale", report.groom.unit_scale);
  json.Add("strands", Strands(report.groom));
  json.Add("chunks", report.groom.strands.size());
  json.Add("fill", Fill(Strands(report.groom), report.groom.strands.size()));
  json.Add("bytes", report.file_bytes);
  json.AddDigest("digest", report.digest);
  json.Add("import_ms", report.import_ms);
  json.Add("bake_ms", report.bake_ms);
  if (!report.out.empty()) json.Add("out", report.out.path());
  json.BeginArray("layers");
  for (size_t l = 0; l < report.groom.layers.size(); ++l) {
    const GroomLayer& layer = report.groom.layers[l];
    json.BeginObject();
    json.Add("layer", layer.name);
    json.Add("strands", layer.strand_count);
    json.Add("chunks", layer.chunk_count);
    json.Add("density_strands", report.densities[l].scatter.asked);
    json.Add("spacing_mm", 1000.0 * double(report.densities[l].scatter.spacing_m));
    if (with_stats) {
      json.BeginArray("prefixes");
      for (const PrefixStats& prefix : report.stats.layers[l].prefix) {
        json.BeginObject();
        json.Add("share", prefix.share);
        AddSpacing(json, "layer", prefix.layer);
        AddSpacing(json, "every_chunk", prefix.every_chunk);
        AddSpacing(json, "inside_chunks", prefix.inside_chunks);
        AddSpacing(json, "plain_every_chunk", prefix.plain_every_chunk);
        AddSpacing(json, "plain_inside_chunks", prefix.plain_inside_chunks);
        json.EndObject();
      }
      json.EndArray();
    }
    json.EndObject();
  }
  json.EndArray();
  json.EndObject();
  return json.text();
}

}  // namespace

int Bake(const BakeArgs& args) {
  if (args.keys) {
    fmt::print("{}", DescribeSetupKeys());
    return 0;
  }
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
    report.groom = BakeGroom(character, rest, setup, unit_scale, &show,
                             args.stats ? &report.stats : nullptr, &report.densities);
  }
  report.bake_ms = MsSince(start);
  for (std::string& warning : WarnOfBaldness(report.densities))
    report.notes.push_back(std::move(warning));
  const std::vector<std::byte> bytes = WriteGroom(report.groom).OrThrow();
  report.file_bytes = bytes.size();
  report.digest = HashGroomBytes(bytes);
  if (!args.out.empty()) WriteOutput("groom", args.out, bytes);
  fmt::print("{}{}", args.json ? BakeAsJson(report, args.stats) : DescribeBake(report, args.stats),
             args.json ? "\n" : "");
  return 0;
}

}  // namespace pelt
