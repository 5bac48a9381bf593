#include "tandem/server/page.h"

// The assembler takes the file as it is: a megabyte of string literal would keep the compiler busy.
asm(".pushsection .rodata\n"
    "tandem_page_begin:\n"
    ".incbin \"" TANDEM_PAGE_FILE
    "\"\n"
    "tandem_page_end:\n"
    ".byte 0\n"
    ".popsection\n");

extern "C" {
extern const char tandem_page_begin[] __attribute__((visibility("hidden")));
extern const char tandem_page_end[] __attribute__((visibility("hidden")));
}

namespace tandem::server {

std::string_view embedded_page() {
  return {tandem_page_begin, static_cast<std::size_t>(tandem_page_end - tandem_page_begin)};
}

}  // namespace tandem::server
