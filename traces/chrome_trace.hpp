// A timeline as Chrome's trace-event JSON, which Perfetto (ui.perfetto.dev), speedscope and
// chrome://tracing open.
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

#include <string>
#include <string_view>

#include "traces/timeline.hpp"

namespace pelt {

// A JSON string that every reader takes, for any bytes in it: names of layers and files come
// from outside.
//
// Invariant: what is appended is valid JSON and valid UTF-8. A byte that is no UTF-8 becomes the
// replacement character; if it went through, a viewer would refuse the whole file.

// Appends `text` with its quotation marks.
void AppendJsonString(std::string& out, std::string_view text);

std::string ChromeTrace(const Timeline& timeline);

}  // namespace pelt
