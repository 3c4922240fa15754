// The modules as the build made them, packed, inside the program.
#include "bench/viewer/page_text.hpp"

#if defined(PELT_PAGE_MODULE)
#define PELT_EMBED(name, path)      \
  asm(".pushsection .rodata\n"      \
      ".global " name               \
      "_begin\n"                    \
      ".global " name "_end\n" name \
      "_begin:\n"                   \
      ".incbin \"" path "\"\n" name \
      "_end:\n"                     \
      ".byte 0\n"                   \
      ".popsection\n");
PELT_EMBED("pelt_page_module", PELT_PAGE_MODULE)
PELT_EMBED("pelt_page_plain_module", PELT_PAGE_PLAIN_MODULE)
extern "C" const std::byte pelt_page_module_begin[], pelt_page_module_end[];
extern "C" const std::byte pelt_page_plain_module_begin[], pelt_page_plain_module_end[];
#endif

namespace pelt {

std::span<const std::byte> EmbeddedModule() {
#if defined(PELT_PAGE_MODULE)
  return {pelt_page_module_begin, pelt_page_module_end};
#else
  return {};
#endif
}

std::span<const std::byte> EmbeddedPlainModule() {
#if defined(PELT_PAGE_MODULE)
  return {pelt_page_plain_module_begin, pelt_page_plain_module_end};
#else
  return {};
#endif
}

}  // namespace pelt
