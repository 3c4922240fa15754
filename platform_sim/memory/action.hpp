// Something to do later, once: a callable that is moved, not copied.
//
// Idea: what a memory model asks for are closures of a few words, millions of them. They lie inside
// the action itself; only larger ones, or ones that may throw when moved, are put on the heap.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

namespace pelt {

class Action {
 public:
  Action() = default;
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, Action> &&
           std::is_invocable_v<std::remove_cvref_t<F>&>)
      Action(F&& f) {  // NOLINT: a closure is an action
    using Callable = std::remove_cvref_t<F>;
    if constexpr (kLiesInside<Callable>) {
      new (place_) Callable(std::forward<F>(f));
      kind_ = &kInside<Callable>;
    } else {
      new (place_) Callable*(new Callable(std::forward<F>(f)));
      kind_ = &kOnHeap<Callable>;
    }
  }
  Action(Action&& other) noexcept { Take(other); }
  Action& operator=(Action&& other) noexcept {
    if (this == &other) return *this;
    Clear();
    Take(other);
    return *this;
  }
  ~Action() { Clear(); }

  explicit operator bool() const { return kind_ != nullptr; }
  void operator()() { kind_->run(place_); }

 private:
  struct Kind {
    void (*run)(std::byte* place);
    void (*move)(std::byte* from, std::byte* to);  // and end what is at `from`
    void (*end)(std::byte* place);
  };
  static constexpr size_t kPlaceBytes = 48;

  template <class F>
  static constexpr bool kLiesInside =
      sizeof(F) <= kPlaceBytes &&
      alignof(F) <= alignof(std::max_align_t) && std::is_nothrow_move_constructible_v<F>;
  template <class F>
  static F& At(std::byte* place) {
    return *std::launder(reinterpret_cast<F*>(place));
  }
  template <class F>
  static constexpr Kind kInside = {[](std::byte* place) { At<F>(place)(); },
                                   [](std::byte* from, std::byte* to) {
                                     new (to) F(std::move(At<F>(from)));
                                     At<F>(from).~F();
                                   },
                                   [](std::byte* place) { At<F>(place).~F(); }};
  template <class F>
  static constexpr Kind kOnHeap = {
      [](std::byte* place) { (*At<F*>(place))(); },
      [](std::byte* from, std::byte* to) { new (to) F*(At<F*>(from)); },
      [](std::byte* place) { delete At<F*>(place); }};

  void Take(Action& other) {
    kind_ = std::exchange(other.kind_, nullptr);
    if (kind_) kind_->move(other.place_, place_);
  }
  void Clear() {
    if (kind_) std::exchange(kind_, nullptr)->end(place_);
  }

  const Kind* kind_ = nullptr;
  alignas(std::max_align_t) std::byte place_[kPlaceBytes];
};

}  // namespace pelt
