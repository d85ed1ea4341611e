#include "report/html.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"

namespace mocurate {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";

void AppendEscaped(char c, std::string& html) {
  switch (c) {
    case '&':
      html += "&amp;";
      break;
    case '<':
      html += "&lt;";
      break;
    case '>':
      html += "&gt;";
      break;
    case '"':
      html += "&quot;";
      break;
    case '\'':
      html += "&#39;";
      break;
    default:
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t')
        html += kReplacement;
      else
        html += c;
  }
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t good = FirstNotUtf8(text).value_or(text.size());
    for (const char c : text.substr(0, good)) AppendEscaped(c, html);
    if (good == text.size()) break;
    html += kReplacement;
    text.remove_prefix(good + 1);
  }
  return html;
}

std::string JsonForScript(const nlohmann::json& json) {
  const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

std::string PercentEncoded(std::string_view text) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z') ||
                       std::string_view("-._~").find(c) != std::string_view::npos;
    if (plain)
      encoded += c;
    else
      encoded += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return encoded;
}

std::string Base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < 3; ++b) word = word << 8 | (b < left ? static_cast<unsigned char>(bytes[i + b]) : 0U);
    for (std::size_t digit = 0; digit < 4; ++digit) {
      text += digit <= left ? kDigits[word >> (18 - 6 * digit) & 63U] : '=';
    }
  }
  return text;
}

std::string ShortText(double value) {
  const double size = std::abs(value);
  if (size == 0.0) return "0";
  if (size < 5e-4) return "&lt; 0.001";
  if (size < 1.0) return FixedText(value, 3);
  if (size < 10.0) return FixedText(value, 2);
  return FixedText(value, size < 100.0 ? 1 : 0);
}

std::string CountText(long long count) {
  std::string digits = std::to_string(count < 0 ? -count : count);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(at, "\u2009");
  return (count < 0 ? "-" : "") + digits;
}

std::string PercentText(double share) { return FixedText(100.0 * share, 1) + " %"; }

std::string HtmlTable::Html() const {
  std::string html = std::string("<div class=\"scroll\"><table") + (numeric ? " class=\"numeric\"" : "") + ">";
  if (!caption.empty()) html += "<caption>" + caption + "</caption>";
  html += "<thead><tr>";
  for (const std::string& cell : head) html += "<th scope=\"col\">" + cell + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += i == 0 ? "<th scope=\"row\">" + row[i] + "</th>" : "<td>" + row[i] + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string PageHead(const std::string& title, const std::string& styles) {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<link rel=\"icon\" href=\"data:,\">\n<title>" +
         EscapeHtml(title) + "</title>\n<style>" + styles + "</style>\n</head>\n";
}

std::string Paragraph(const std::string& html, const char* css_class) {
  const std::string attribute = *css_class == '\0' ? "" : std::string(" class=\"") + css_class + "\"";
  return "<p" + attribute + ">" + html + "</p>\n";
}

std::string Figure(const std::string& caption, const std::string& inside) {
  return inside.empty() ? "" : "<figure><figcaption>" + caption + "</figcaption>" + inside + "</figure>\n";
}

std::string Tile(const std::string& name, const std::string& value, const std::string& note) {
  return "<div><dt>" + name + "</dt><dd>" + value + (note.empty() ? "" : "<small>" + note + "</small>") +
         "</dd></div>\n";
}

}  // namespace mocurate
