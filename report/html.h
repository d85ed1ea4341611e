#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/table_text.h"

namespace mocurate {

/// Text escaped for HTML and attribute values. Bytes that are not UTF-8 become U+FFFD.
std::string EscapeHtml(std::string_view text);

/// JSON safe inside <script type="application/json">: it contains no "</" and no "<!--".
std::string JsonForScript(const nlohmann::json& json);

/// Text as part of an address: all but letters, digits and -._~ as %41.
std::string PercentEncoded(std::string_view text);

std::string Base64(const std::string& bytes);

/// About three significant digits, as HTML: "0.012", "12.3", "1234", "&lt; 0.001".
std::string ShortText(double value);
/// 1234567 -> "1 234 567" (thin spaces).
std::string CountText(long long count);
/// 0.9312 -> "93.1 %".
std::string PercentText(double share);

/// Cells are HTML already. The first column is the row's heading; `numeric` columns (all but the first) line up right.
struct HtmlTable {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows{};
  bool numeric = true;

  std::string Html() const;
};

/// From the doctype to the end of <head>. `title` is plain text.
std::string PageHead(const std::string& title, const std::string& styles);

std::string Paragraph(const std::string& html, const char* css_class = "");

/// Empty where nothing is inside. `caption` is HTML.
std::string Figure(const std::string& caption, const std::string& inside);

/// One of the numbers at the head of a page; `note` may be empty.
std::string Tile(const std::string& name, const std::string& value, const std::string& note);

}  // namespace mocurate
