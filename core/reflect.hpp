// The members of an aggregate, one by one: how a kernel's ports and a table of streams are read off
// the struct that declares them, so that no list of them is kept beside it.
//
// Idea: C++20 has no reflection, but it counts: an aggregate takes as many initialisers as it has
// members, and a structured binding of so many names reaches them. The bindings for each count are
// written out below; a struct of more members than kMaxMembers needs more lines, and says so.
//
// Invariant: members come in the order in which they are declared. Members that are arrays are not
// counted right.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace pelt {

inline constexpr size_t kMaxMembers = 72;

namespace reflect_detail {

// Converts to a member of any type; never run.
struct AnyMember {
  template <class T>
  operator T() const;
};

template <class T, class... A>
consteval size_t CountMembers() {
  if constexpr (requires { T{A{}..., AnyMember{}}; })
    return CountMembers<T, A..., AnyMember>();
  else
    return sizeof...(A);
}

template <class C, class M>
C ClassOf(M C::*);
template <class C, class M>
M TypeOf(M C::*);

}  // namespace reflect_detail

template <class T>
inline constexpr size_t kMemberCount = reflect_detail::CountMembers<T>();

// Calls visit(member, member, ...) with all members of the aggregate.
template <class T, class Visit>
constexpr decltype(auto) WithMembers(T&& t, Visit&& visit) {
  constexpr size_t n = kMemberCount<std::remove_cvref_t<T>>;
  static_assert(n <= kMaxMembers, "more members than there are lines below: add some");
  if constexpr (n == 0) return visit();
// clang-format off
#define PELT_M1 m1
#define PELT_M2 PELT_M1, m2
#define PELT_M3 PELT_M2, m3
#define PELT_M4 PELT_M3, m4
#define PELT_M5 PELT_M4, m5
#define PELT_M6 PELT_M5, m6
#define PELT_M7 PELT_M6, m7
#define PELT_M8 PELT_M7, m8
#define PELT_M9 PELT_M8, m9
#define PELT_M10 PELT_M9, m10
#define PELT_M11 PELT_M10, m11
#define PELT_M12 PELT_M11, m12
#define PELT_M13 PELT_M12, m13
#define PELT_M14 PELT_M13, m14
#define PELT_M15 PELT_M14, m15
#define PELT_M16 PELT_M15, m16
#define PELT_M17 PELT_M16, m17
#define PELT_M18 PELT_M17, m18
#define PELT_M19 PELT_M18, m19
#define PELT_M20 PELT_M19, m20
#define PELT_M21 PELT_M20, m21
#define PELT_M22 PELT_M21, m22
#define PELT_M23 PELT_M22, m23
#define PELT_M24 PELT_M23, m24
#define PELT_M25 PELT_M24, m25
#define PELT_M26 PELT_M25, m26
#define PELT_M27 PELT_M26, m27
#define PELT_M28 PELT_M27, m28
#define PELT_M29 PELT_M28, m29
#define PELT_M30 PELT_M29, m30
#define PELT_M31 PELT_M30, m31
#define PELT_M32 PELT_M31, m32
#define PELT_M33 PELT_M32, m33
#define PELT_M34 PELT_M33, m34
#define PELT_M35 PELT_M34, m35
#define PELT_M36 PELT_M35, m36
#define PELT_M37 PELT_M36, m37
#define PELT_M38 PELT_M37, m38
#define PELT_M39 PELT_M38, m39
#define PELT_M40 PELT_M39, m40
#define PELT_M41 PELT_M40, m41
#define PELT_M42 PELT_M41, m42
#define PELT_M43 PELT_M42, m43
#define PELT_M44 PELT_M43, m44
#define PELT_M45 PELT_M44, m45
#define PELT_M46 PELT_M45, m46
#define PELT_M47 PELT_M46, m47
#define PELT_M48 PELT_M47, m48
#define PELT_M49 PELT_M48, m49
#define PELT_M50 PELT_M49, m50
#define PELT_M51 PELT_M50, m51
#define PELT_M52 PELT_M51, m52
#define PELT_M53 PELT_M52, m53
#define PELT_M54 PELT_M53, m54
#define PELT_M55 PELT_M54, m55
#define PELT_M56 PELT_M55, m56
#define PELT_M57 PELT_M56, m57
#define PELT_M58 PELT_M57, m58
#define PELT_M59 PELT_M58, m59
#define PELT_M60 PELT_M59, m60
#define PELT_M61 PELT_M60, m61
#define PELT_M62 PELT_M61, m62
#define PELT_M63 PELT_M62, m63
#define PELT_M64 PELT_M63, m64
#define PELT_M65 PELT_M64, m65
#define PELT_M66 PELT_M65, m66
#define PELT_M67 PELT_M66, m67
#define PELT_M68 PELT_M67, m68
#define PELT_M69 PELT_M68, m69
#define PELT_M70 PELT_M69, m70
#define PELT_M71 PELT_M70, m71
#define PELT_M72 PELT_M71, m72
#define PELT_MEMBERS(k) if constexpr (n == k) { auto& [PELT_M##k] = t; return visit(PELT_M##k); }
  PELT_MEMBERS(1) PELT_MEMBERS(2) PELT_MEMBERS(3) PELT_MEMBERS(4) PELT_MEMBERS(5) PELT_MEMBERS(6)
  PELT_MEMBERS(7) PELT_MEMBERS(8) PELT_MEMBERS(9) PELT_MEMBERS(10) PELT_MEMBERS(11)
  PELT_MEMBERS(12) PELT_MEMBERS(13) PELT_MEMBERS(14) PELT_MEMBERS(15) PELT_MEMBERS(16)
  PELT_MEMBERS(17) PELT_MEMBERS(18) PELT_MEMBERS(19) PELT_MEMBERS(20) PELT_MEMBERS(21)
  PELT_MEMBERS(22) PELT_MEMBERS(23) PELT_MEMBERS(24) PELT_MEMBERS(25) PELT_MEMBERS(26)
  PELT_MEMBERS(27) PELT_MEMBERS(28) PELT_MEMBERS(29) PELT_MEMBERS(30) PELT_MEMBERS(31)
  PELT_MEMBERS(32) PELT_MEMBERS(33) PELT_MEMBERS(34) PELT_MEMBERS(35) PELT_MEMBERS(36)
  PELT_MEMBERS(37) PELT_MEMBERS(38) PELT_MEMBERS(39) PELT_MEMBERS(40) PELT_MEMBERS(41)
  PELT_MEMBERS(42) PELT_MEMBERS(43) PELT_MEMBERS(44) PELT_MEMBERS(45) PELT_MEMBERS(46)
  PELT_MEMBERS(47) PELT_MEMBERS(48) PELT_MEMBERS(49) PELT_MEMBERS(50) PELT_MEMBERS(51)
  PELT_MEMBERS(52) PELT_MEMBERS(53) PELT_MEMBERS(54) PELT_MEMBERS(55) PELT_MEMBERS(56)
  PELT_MEMBERS(57) PELT_MEMBERS(58) PELT_MEMBERS(59) PELT_MEMBERS(60) PELT_MEMBERS(61)
  PELT_MEMBERS(62) PELT_MEMBERS(63) PELT_MEMBERS(64) PELT_MEMBERS(65) PELT_MEMBERS(66)
  PELT_MEMBERS(67) PELT_MEMBERS(68) PELT_MEMBERS(69) PELT_MEMBERS(70) PELT_MEMBERS(71)
  PELT_MEMBERS(72)
#undef PELT_MEMBERS
#undef PELT_M1
#undef PELT_M2
#undef PELT_M3
#undef PELT_M4
#undef PELT_M5
#undef PELT_M6
#undef PELT_M7
#undef PELT_M8
#undef PELT_M9
#undef PELT_M10
#undef PELT_M11
#undef PELT_M12
#undef PELT_M13
#undef PELT_M14
#undef PELT_M15
#undef PELT_M16
#undef PELT_M17
#undef PELT_M18
#undef PELT_M19
#undef PELT_M20
#undef PELT_M21
#undef PELT_M22
#undef PELT_M23
#undef PELT_M24
#undef PELT_M25
#undef PELT_M26
#undef PELT_M27
#undef PELT_M28
#undef PELT_M29
#undef PELT_M30
#undef PELT_M31
#undef PELT_M32
#undef PELT_M33
#undef PELT_M34
#undef PELT_M35
#undef PELT_M36
#undef PELT_M37
#undef PELT_M38
#undef PELT_M39
#undef PELT_M40
#undef PELT_M41
#undef PELT_M42
#undef PELT_M43
#undef PELT_M44
#undef PELT_M45
#undef PELT_M46
#undef PELT_M47
#undef PELT_M48
#undef PELT_M49
#undef PELT_M50
#undef PELT_M51
#undef PELT_M52
#undef PELT_M53
#undef PELT_M54
#undef PELT_M55
#undef PELT_M56
#undef PELT_M57
#undef PELT_M58
#undef PELT_M59
#undef PELT_M60
#undef PELT_M61
#undef PELT_M62
#undef PELT_M63
#undef PELT_M64
#undef PELT_M65
#undef PELT_M66
#undef PELT_M67
#undef PELT_M68
#undef PELT_M69
#undef PELT_M70
#undef PELT_M71
#undef PELT_M72
  // clang-format on
}

// Of a pointer to a member: the struct, and the member's type.
template <auto kMember>
using MemberClass = decltype(reflect_detail::ClassOf(kMember));
template <auto kMember>
using MemberType = decltype(reflect_detail::TypeOf(kMember));

// The member's name, as it is declared.
template <auto kMember>
consteval std::string_view MemberName() {
  // "... [with auto kMember = &pelt::Streams::mesh; ...]", "... [kMember = &pelt::Streams::mesh]"
  std::string_view s = __PRETTY_FUNCTION__;
  s = s.substr(s.find("kMember = ") + 10);
  s = s.substr(0, s.find_first_of(";]"));
  return s.substr(s.rfind(':') + 1);
}

}  // namespace pelt
