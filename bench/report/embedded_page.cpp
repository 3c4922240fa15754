#include "bench/report/embedded_page.hpp"

namespace pelt {
namespace {

void Replace(std::string& text, std::string_view mark, std::string_view with) {
  const size_t at = text.find(mark);
  text.replace(at, mark.size(), with);
}

}  // namespace

std::string FillPage(const EmbeddedPage& parts, std::string json) {
  // '<' occurs in JSON only inside strings, where its escape means the same.
  for (size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
    json.replace(at, 1, "\\u003c");
  std::string page(parts.html);
  // The data last: it may hold anything, the marks too.
  Replace(page, "@PELT_CSS@", parts.css);
  Replace(page, "@PELT_SCRIPT@", parts.script);
  Replace(page, "@PELT_DATA@", json);
  return page;
}

}  // namespace pelt
