// A progress bar for long work: on a terminal one line on standard error that redraws itself, in a
// pipe nothing.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "bench/report/machine.hpp"

namespace pelt {

class Progress {
 public:
  Progress(std::string_view what, uint64_t total)
      : what_(what), total_(total ? total : 1), shown_(IsTerminal()) {}
  ~Progress() { Clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(uint64_t done, std::string_view detail = {}) {
    const auto now = std::chrono::steady_clock::now();
    if (!shown_ || (drawn_ && now - last_ < std::chrono::milliseconds(100))) return;
    last_ = now;
    drawn_ = true;
    constexpr uint64_t kWidth = 30;
    const uint64_t filled = (done < total_ ? done : total_) * kWidth / total_;
    std::fputs(fmt::format("\r\033[K{} [{}{}] {}/{} {}", what_, std::string(filled, '='),
                           std::string(kWidth - filled, ' '), done, total_, detail)
                   .c_str(),
               stderr);
    std::fflush(stderr);
  }
  void Clear() {
    if (drawn_) std::fputs("\r\033[K", stderr);
    drawn_ = false;
  }

 private:
  std::string what_;
  uint64_t total_;
  bool shown_, drawn_ = false;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace pelt
