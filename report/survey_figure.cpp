// Shares of votes as an SVG file with its own style.

#include <algorithm>

#include "core/base/text.h"
#include "report/html.h"
#include "report/survey_tally.h"
#include "report/svg.h"

namespace mocurate {
namespace {

constexpr double kBarWidth = 360.0;  ///< of the share 1, pixels
constexpr double kRowHeight = 24.0;
constexpr double kTextWidth = 6.8;  ///< of a character, approximately
constexpr double kTop = 56.0;       ///< of the first row

constexpr const char* kFigureStyle =
    "<style>text{font:12px system-ui,sans-serif;fill:#1c2127}.soft{fill:#5a6470}.head{font-weight:600}"
    ".first{fill:#2563c9}.rest{fill:#d9dee5}.whisker{stroke:#1c2127;stroke-width:1.5}"
    ".half{stroke:#5a6470;stroke-dasharray:3 3}.page{fill:#fff}</style>\n";

std::string FigureText(double x, double y, const std::string& text, const char* anchor, const char* css_class = "") {
  return "<text x=\"" + Coordinate(x) + "\" y=\"" + Coordinate(y) + "\" text-anchor=\"" + anchor + "\"" +
         (*css_class == '\0' ? "" : " class=\"" + std::string(css_class) + "\"") + ">" + EscapeHtml(text) + "</text>\n";
}

std::string FigureRect(double x, double y, double width, double height, const char* css_class) {
  return "<rect x=\"" + Coordinate(x) + "\" y=\"" + Coordinate(y) + "\" width=\"" + Coordinate(width) + "\" height=\"" +
         Coordinate(height) + "\" class=\"" + css_class + "\"/>\n";
}

std::string FigureLine(double x1, double y1, double x2, double y2, const char* css_class) {
  return "<line x1=\"" + Coordinate(x1) + "\" y1=\"" + Coordinate(y1) + "\" x2=\"" + Coordinate(x2) + "\" y2=\"" +
         Coordinate(y2) + "\" class=\"" + css_class + "\"/>\n";
}

std::string Whisker(const ShareInterval& interval, double left, double middle) {
  const double low = left + kBarWidth * interval.low, high = left + kBarWidth * interval.high;
  return FigureLine(low, middle, high, middle, "whisker") + FigureLine(low, middle - 4, low, middle + 4, "whisker") +
         FigureLine(high, middle - 4, high, middle + 4, "whisker");
}

std::string TallyHead(const TallyRow& row) {
  return row.second.empty() ? row.first : row.first + " preferred to " + row.second;
}

/// The bar of one row, `middle` pixels from the top.
std::string BarOf(const TallyRow& row, double left, double middle) {
  std::string svg = FigureText(left - 10, middle + 4, row.label.empty() ? "all" : row.label, "end");
  if (row.votes == 0) return svg + FigureText(left + 8, middle + 4, "no votes", "start", "soft");
  const double width = kBarWidth * row.share();
  svg += FigureRect(left, middle - 7, kBarWidth, 14, "rest") + FigureRect(left, middle - 7, width, 14, "first");
  if (row.wilson) svg += Whisker(*row.wilson, left, middle);
  return svg + FigureText(left + kBarWidth + 10, middle + 4,
                          FixedText(100.0 * row.share(), 0) + " % of " + std::to_string(row.votes), "start");
}

}  // namespace

std::string TallyToSvg(const SurveyTally& tally) {
  const bool preference = tally.kind == SurveyKind::kPreference;
  double left = 90.0, heads = 0.0;
  for (const TallyRow& row : tally.rows) {
    left = std::max(left, 20.0 + kTextWidth * static_cast<double>(row.label.size()));
    if (row.label.empty()) heads += 1.0;
  }
  const double height = kTop + kRowHeight * (static_cast<double>(tally.rows.size()) + heads) + 30.0;
  const std::string title =
      preference ? "Share of votes for the first of two sources (blue)" : "Share of votes that a motion is real (blue)";
  const std::string people = tally.participants.empty()
                                 ? "There are no answers."
                                 : Counted(static_cast<long long>(tally.participants.size()), "participant") +
                                       "; whiskers: 95 % (Wilson), assuming independent votes";
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + Coordinate(left + kBarWidth + 130.0) +
                    " " + Coordinate(height) + "\" role=\"img\" aria-label=\"" + EscapeHtml(title) + "\">\n" +
                    kFigureStyle + "<rect width=\"100%\" height=\"100%\" class=\"page\"/>\n" +
                    FigureText(10, 20, title, "start", "head") + FigureText(10, 38, people, "start", "soft");
  double y = kTop;
  for (const TallyRow& row : tally.rows) {
    if (row.label.empty()) {
      svg +=
          FigureText(left, y + 16, TallyHead(row) + (row.first == tally.real ? " (recordings)" : ""), "start", "head");
      y += kRowHeight;
    }
    svg += BarOf(row, left, y + 0.5 * kRowHeight);
    y += kRowHeight;
  }
  svg += FigureLine(left + 0.5 * kBarWidth, kTop, left + 0.5 * kBarWidth, y + 4, "half");
  for (const auto& [share, text] : {std::pair(0.0, "0"), std::pair(0.5, "50 %"), std::pair(1.0, "100 %")}) {
    svg += FigureText(left + kBarWidth * share, y + 20, text, "middle", "soft");
  }
  return svg + "</svg>\n";
}

}  // namespace mocurate
