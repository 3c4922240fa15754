// What the tests of a verification plant, and how they run it.
//
// Faults are planted in the plan of a case: a kernel is replaced by one that is wrong in one
// way. The reference is never touched.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/verify/verify.hpp"

namespace pelt::testing {

inline const Scenario& Tiny() {
  static const Scenario kTiny = LoadScenario("tiny");
  return kTiny;
}

// The kernel that the planted one stands in for, and where its ports are.
struct HealthyKernel {
  void (*run)(const void*, const Binding*) = nullptr;
  std::span<const PortDesc> ports;
  std::byte* kept = nullptr;  // what a faulty kernel remembers

  template <class T>
  T* As(const Binding* bindings, Stream stream) const {
    for (size_t p = 0; p < ports.size(); ++p)
      if (ports[p].stream == stream) return static_cast<T*>(bindings[p].block);
    return nullptr;
  }
  // Itself, with another block of a stream.
  void RunWith(const void* params, const Binding* bindings, Stream stream, void* block) const {
    Binding other[kMaxPorts];
    std::copy_n(bindings, ports.size(), other);
    for (size_t p = 0; p < ports.size(); ++p)
      if (ports[p].stream == stream) other[p].block = block;
    run(params, other);
  }
  // Of a stream that is gathered: the record that is first in the item's list.
  template <class Record>
  const Record* FirstListed(const Binding* bindings, Stream stream) const {
    for (size_t p = 0; p < ports.size(); ++p)
      if (ports[p].stream == stream)
        return static_cast<const Record*>(bindings[p].block) +
               (bindings[p].index ? bindings[p].index[0] : 0);
    return nullptr;
  }
};
inline HealthyKernel healthy;

using Planted = void (*)(const void*, const Binding*);
using Tamper = std::function<void(const VerifyCase&, Plan&)>;

inline void Plant(Plan& plan, std::string_view stage, Planted planted) {
  for (Stage& s : plan.stages) {
    if (s.kernel.name != stage) continue;
    healthy = {s.kernel.run, s.kernel.ports, nullptr};
    s.kernel.run = planted;
    return;
  }
  FAIL() << "no stage " << stage;
}

inline Tamper Planting(std::string_view stage, Planted planted) {
  return [=](const VerifyCase&, Plan& plan) { Plant(plan, stage, planted); };
}

// Hides the address from the compiler: faulty kernels go where the language does not let them.
template <class T>
T* Launder(T* p) {
  asm volatile("" : "+r"(p));
  return p;
}

inline VerifyOptions NoCases(uint32_t frames) {
  VerifyOptions options;
  options.frames = frames;
  options.skips = options.checks = false;
  options.filter = [](const VerifyCase&) { return false; };
  return options;
}

inline VerifyOptions OneExecutor(ExecutorKind executor, uint32_t frames) {
  VerifyOptions options = NoCases(frames);
  options.filter = [executor](const VerifyCase& c) {
    return c.executor == executor && c.isa == BestIsa() && c.fuse && !c.piecewise_sort &&
           c.vertex_order == VertexOrder::kSorted && c.settings == Settings::kSkips &&
           !c.odd_floats;
  };
  return options;
}

// The case behind those that compare vertex orders.
inline CaseResult RunOne(const VerifyOptions& options) {
  return Verify(Tiny(), options).cases.back();
}

inline std::vector<CheckResult> ChecksOf(const VerifyReport& report, std::string_view section) {
  std::vector<CheckResult> found;
  for (const CheckResult& c : report.checks)
    if (c.section == section) found.push_back(c);
  return found;
}

inline bool AnyFailed(const std::vector<CheckResult>& checks, FindingKind kind,
                      std::string_view name) {
  return std::any_of(checks.begin(), checks.end(), [&](const CheckResult& c) {
    return !c.passed && c.kind == kind && c.name.find(name) != std::string::npos;
  });
}

// One section of the checks and nothing else; `tamper` empty: the healthy scene.
inline VerifyReport RunSection(const char* section, uint32_t frames, Tamper tamper) {
  VerifyOptions options = NoCases(frames);
  options.checks = true;
  options.sections = {section};
  options.tamper = std::move(tamper);
  return Verify(Tiny(), options);
}

// Whether the section has a failed check of this kind and name where the kernel is planted.
inline ::testing::AssertionResult Finds(const char* section, uint32_t frames, FindingKind kind,
                                        std::string_view name, std::string_view stage,
                                        Planted planted) {
  const VerifyReport report = RunSection(section, frames, Planting(stage, planted));
  const bool found = AnyFailed(ChecksOf(report, section), kind, name);
  return ::testing::AssertionResult(found) << stage << ": " << DescribeReport(report);
}

// Two frames by this executor with a planted kernel: the fault shows.
inline CaseResult RunPlanted(ExecutorKind executor, std::string_view stage, Planted planted) {
  VerifyOptions options = OneExecutor(executor, 2);
  options.tamper = Planting(stage, planted);
  const CaseResult result = RunOne(options);
  EXPECT_FALSE(result.passed);
  return result;
}

}  // namespace pelt::testing
