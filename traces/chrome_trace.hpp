// When what ran, for a viewer (tracks of nested slices, arrows between them, and counters), and that as
// Chrome's trace-event JSON, which Perfetto (ui.perfetto.dev), speedscope and chrome://tracing open. It
// knows nothing of frames or plans; bench/report/timeline.hpp makes a timeline of recorded frames.
//
// Invariant: the slices of a track are in the order of a walk through the tree: by begin, parents
// before children, each inside its parent and after the slice before it on its own depth. A viewer
// drops slices that break this, and says so only in its statistics.
//
// What the viewers are particular about, and is kept here:
//  - slices are pairs of B and E events, not X: readers turn microseconds into nanoseconds through
//    a double, and begin + duration of child and parent then differ by a nanosecond, which they
//    report as overlap; a time written twice in the same digits is rounded twice the same way;
//  - an E event repeats its B's name, and neither has arguments: speedscope compares both;
//  - events are in the order of their times, and at the same time in the order of nesting;
//  - a flow's s lies in its producer and its f, bound to the enclosing slice (bp "e"), at the begin
//    of its consumer; each flow has its own id;
//  - thread 0 means "idle" to Perfetto, and the thread numbered like the process is its main
//    thread: track t is thread t + 1 of process 1.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
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

// A JSON string that every reader takes, for any bytes in it: names of layers and files come
// from outside.
//
// Invariant: what is appended is valid JSON and valid UTF-8. A byte that is no UTF-8 becomes the
// replacement character; if it went through, a viewer would refuse the whole file.

// Appends `text` with its quotation marks.
void AppendJsonString(std::string& out, std::string_view text);

std::string ChromeTrace(const Timeline& timeline);

}  // namespace pelt
