// When what ran, for a viewer: tracks of nested slices, arrows between them, and counters. It
// knows nothing of frames or plans; bench/report/timeline.hpp makes one of recorded frames.
//
// Invariant: the slices of a track are in the order of a walk through the tree: by begin, parents
// before children, each inside its parent and after the slice before it on its own depth. A viewer
// drops slices that break this, and says so only in its statistics.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pelt {

struct Timeline {
  struct Slice {
    uint32_t name;   // in `names`
    uint32_t depth;  // 0: lies in no other slice
    uint64_t begin_ns, end_ns;
  };
  struct Track {
    std::string name;
    std::vector<Slice> slices;
  };
  // Where a slice lies.
  struct Place {
    uint32_t track, slice;
  };
  // From the end of one slice to the begin of another.
  struct Flow {
    uint32_t name;
    Place from, to;
  };
  struct Sample {
    uint64_t at_ns;
    std::vector<double> values;  // one a series
  };
  // Several series share a counter when they are of one unit.
  struct Counter {
    std::string name;
    std::vector<std::string> series;
    std::vector<Sample> samples;
  };

  std::string process;
  std::vector<std::pair<std::string, std::string>> metadata;
  std::vector<std::string> names;
  std::vector<Track> tracks;  // the first is that of the thread that asks for the work
  std::vector<Flow> flows;
  std::vector<Counter> counters;
};

}  // namespace pelt
