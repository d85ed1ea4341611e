#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/text.h"
#include "eval/dose/dose_table.h"

namespace mocurate {
namespace {

constexpr int kColumns = 2;
constexpr double kPanelWidth = 420.0, kPanelHeight = 240.0, kLeft = 46.0, kRight = 14.0, kTop = 30.0, kBottom = 40.0,
                 kHead = 40.0, kLegendLine = 18.0;
constexpr double kLowest = -1.0, kHighest = 3.0;  // powers of ten

/// Plotted metrics, in an order that separates similar colours.
constexpr const char* kDrawn[] = {"FID_train",     "KID",        "accuracy", "diversity",   "multimodality",
                                  "nearest_train", "foot_skate", "jerk",     "bone_spread", "coverage"};
constexpr const char* kColours[] = {"#0072b2", "#56b4e9", "#d55e00", "#009e73", "#cc79a7",
                                    "#888888", "#e69f00", "#8c564b", "#6a3d9a", "#b8a800"};

std::string Place(double value) { return RoundedText(value, 5); }

std::string EscapeSvg(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return escaped;
}

std::string SvgText(double x, double y, const std::string& text, const char* anchor, const char* css_class) {
  return "<text x=\"" + Place(x) + "\" y=\"" + Place(y) + "\" text-anchor=\"" + anchor + "\" class=\"" + css_class +
         "\">" + EscapeSvg(text) + "</text>\n";
}

std::string SvgLine(double x1, double y1, double x2, double y2, const char* css_class) {
  return "<line x1=\"" + Place(x1) + "\" y1=\"" + Place(y1) + "\" x2=\"" + Place(x2) + "\" y2=\"" + Place(y2) +
         "\" class=\"" + css_class + "\"/>\n";
}

double Height(double multiple) {
  const double power = std::clamp(multiple > 0.0 ? std::log10(multiple) : kLowest, kLowest, kHighest);
  return kTop + (kPanelHeight - kTop - kBottom) * (kHighest - power) / (kHighest - kLowest);
}

/// The reference that a metric's values are divided by; nothing where it has no value.
std::optional<double> UnitOf(const DoseTable& table, Damage damage, const std::string& metric) {
  constexpr double kNothing = 1e-6, kSmall = 1e-3;  // kSmall: for bones, a millimetre
  const DoseValue* undamaged = table.Find(damage, InfoOf(damage).none, metric);
  // Distances to the same motions are 0 up to rounding, and KID's estimate may be negative.
  const bool distance = metric == "FID_train" || metric == "FID_test" || metric == "KID" || metric == "nearest_train";
  if (!distance && undamaged != nullptr && std::abs(undamaged->value) > kNothing) return undamaged->value;
  const auto real = table.real.find(metric);
  if (real != table.real.end() && std::abs(real->second) > kNothing) return std::abs(real->second);
  return undamaged == nullptr ? std::nullopt : std::optional(kSmall);
}

std::string Panel(const DoseTable& table, const DoseSeries& series) {
  const DamageInfo& info = InfoOf(series.damage);
  std::vector<double> doses = series.doses;
  doses.push_back(info.none);
  std::sort(doses.begin(), doses.end());
  const double width = kPanelWidth - kLeft - kRight;
  const auto at = [&](std::size_t i) {
    return kLeft + width * (static_cast<double>(i) + 0.5) / static_cast<double>(doses.size());
  };
  std::string svg = SvgText(kLeft, kTop - 12.0, std::string(info.name), "start", "name");
  for (int power = static_cast<int>(kLowest); power <= static_cast<int>(kHighest); ++power) {
    const double y = Height(std::pow(10.0, power));
    svg += SvgLine(kLeft, y, kPanelWidth - kRight, y, power == 0 ? "one" : "grid");
    svg += SvgText(kLeft - 6.0, y + 4.0, RoundedText(std::pow(10.0, power), 4), "end", "mark");
  }
  for (std::size_t i = 0; i < doses.size(); ++i) {
    svg += SvgText(at(i), kPanelHeight - kBottom + 16.0, FormatDouble(doses[i]), "middle", "mark");
  }
  svg += SvgText(kLeft + 0.5 * width, kPanelHeight - 8.0, info.unit, "middle", "mark");
  for (std::size_t k = 0; k < std::size(kDrawn); ++k) {
    const auto unit = UnitOf(table, series.damage, kDrawn[k]);
    if (!unit) continue;
    std::string points, dots;
    for (std::size_t i = 0; i < doses.size(); ++i) {
      const DoseValue* value = table.Find(series.damage, doses[i], kDrawn[k]);
      if (value == nullptr) continue;
      const double y = Height(value->value / *unit);
      points += Place(at(i)) + "," + Place(y) + " ";
      dots += "<circle cx=\"" + Place(at(i)) + "\" cy=\"" + Place(y) + "\" r=\"" + (value->answers ? "3.4" : "1.6") +
              "\" fill=\"" + kColours[k] + "\"><title>" + EscapeSvg(kDrawn[k]) + " at " + FormatDouble(doses[i]) +
              ": " + RoundedText(value->value, 4) + (value->answers ? ", answers" : "") + "</title></circle>\n";
    }
    svg += "<polyline points=\"" + points + "\" stroke=\"" + kColours[k] + "\"/>\n" + dots;
  }
  return svg;
}

}  // namespace

std::string DoseSvg(const DoseTable& table, const std::string& title) {
  const auto panels = static_cast<int>(table.series.size());
  const double width = kColumns * kPanelWidth;
  const double legend = kHead + kPanelHeight * ((panels + kColumns - 1) / kColumns) + 12.0;
  const double height = legend + 2.0 * kLegendLine + 12.0;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + Place(width) + " " + Place(height) +
                    "\" role=\"img\" font-family=\"sans-serif\" font-size=\"12\">\n<title>" + EscapeSvg(title) +
                    "</title>\n<style>svg{background:#fff}text{fill:#222}.mark{fill:#555;font-size:11px}"
                    ".name,.head{font-weight:600}.head{font-size:15px}line{stroke:#ddd}.one{stroke:#888}"
                    "polyline{fill:none;stroke-width:1.6}"
                    "@media(prefers-color-scheme:dark){svg{background:#1b1b1b}text{fill:#eee}.mark{fill:#aaa}"
                    "line{stroke:#444}.one{stroke:#999}}</style>\n";
  svg += SvgText(12.0, 24.0, title, "start", "head");
  for (int i = 0; i < panels; ++i) {
    svg += "<g transform=\"translate(" + Place(kPanelWidth * (i % kColumns)) + "," +
           Place(kHead + kPanelHeight * (i / kColumns)) + ")\">\n" +
           Panel(table, table.series[static_cast<std::size_t>(i)]) + "</g>\n";
  }
  const std::size_t half = (std::size(kDrawn) + 1) / 2;
  for (std::size_t k = 0; k < std::size(kDrawn); ++k) {
    const double x = 16.0 + static_cast<double>(k % half) * (width - 32.0) / static_cast<double>(half);
    const double y = legend + kLegendLine * static_cast<double>(k / half);
    svg += "<circle cx=\"" + Place(x) + "\" cy=\"" + Place(y) + "\" r=\"4\" fill=\"" + kColours[k] + "\"/>" +
           SvgText(x + 10.0, y + 4.0, kDrawn[k], "start", "mark");
  }
  svg += SvgText(16.0, legend + 2.0 * kLegendLine + 4.0,
                 "Multiples of the undamaged motions' value; of FID, KID and nearest_train of real motions among each "
                 "other; of 0.001 where that is 0. Large dots: the metric responds.",
                 "start", "mark");
  return svg + "</svg>\n";
}

}  // namespace mocurate
