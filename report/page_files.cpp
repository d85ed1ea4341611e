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

std::string PageStyles(std::initializer_list<std::string_view> names) {
  std::string styles(PageFile("page.css"));
  for (const std::string_view name : names) styles += PageFile(name);
  return styles;
}

std::string PageScripts(const std::vector<std::string_view>& names) {
  std::string html;
  for (const std::string_view name : names) html.append("<script>").append(PageFile(name)).append("</script>\n");
  return html;
}

}  // namespace mocurate
