#include "report/page_files.h"

#include <cstdlib>

namespace mocurate {
namespace {

struct PageText {
  const char* name;
  const char* text;
};

const PageText kPageTexts[] = {
#include "page_files.inc"
};

}  // namespace

std::string_view PageFile(std::string_view name) {
  for (const PageText& known : kPageTexts) {
    if (known.name == name) return known.text;
  }
  std::abort();  // a name in the program's text
}

}  // namespace mocurate
