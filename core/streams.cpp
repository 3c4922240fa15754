#include "core/streams.hpp"

#include <array>

#include "core/block_rows.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

template <class B>
constexpr StreamDesc Describe(const StreamRow<B>& row) {
  static_assert(kListedMembers<B> > 0 && ListsAllMembers<B>(),
                "a member that is not listed (kBlockMembers) is neither hashed nor located");
  return {row.name, row.domain, uint32_t(sizeof(B)), row.role, row.lanes, row.kinds,
          row.kept, kRowsOf<B>};
}
constexpr auto kStreams =
    WithMembers(kTable<Streams>, [](const auto&... row) { return std::array{Describe(row)...}; });

}  // namespace

const StreamDesc& DescribeStream(Stream stream) { return kStreams[size_t(stream)]; }

std::string_view RoleName(Role role) {
  constexpr std::string_view kNames[] = {"input", "value", "bookkeeping", "scratch"};
  return kNames[size_t(role)];
}

}  // namespace pelt
