// The module as the build made it, packed, inside the program.
#include "bench/page/page_text.hpp"

#if defined(PELT_PAGE_MODULE)
asm(".pushsection .rodata\n"
    ".global pelt_page_module_begin\n"
    ".global pelt_page_module_end\n"
    "pelt_page_module_begin:\n"
    ".incbin \"" PELT_PAGE_MODULE
    "\"\n"
    "pelt_page_module_end:\n"
    ".byte 0\n"
    ".popsection\n");
extern "C" const std::byte pelt_page_module_begin[], pelt_page_module_end[];
#endif

namespace pelt {

std::span<const std::byte> EmbeddedModule() {
#if defined(PELT_PAGE_MODULE)
  return {pelt_page_module_begin, pelt_page_module_end};
#else
  return {};
#endif
}

}  // namespace pelt
