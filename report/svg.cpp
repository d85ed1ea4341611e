#include "report/svg.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "report/html.h"

namespace mocurate {
namespace {

constexpr int kWidth = 640;

std::string Open(int width, int height, const std::string& title) {
  return "<svg viewBox=\"0 0 " + std::to_string(width) + " " + std::to_string(height) +
         "\" role=\"img\" aria-label=\"" + EscapeHtml(title) + "\" style=\"max-width:" + std::to_string(width) +
         "px\">\n";
}

std::string Rect(double x, double y, double width, double height, const std::string& css_class,
                 const std::string& tip) {
  return "<rect x=\"" + Coordinate(x) + "\" y=\"" + Coordinate(y) + "\" width=\"" + Coordinate(width) + "\" height=\"" +
         Coordinate(height) + "\" class=\"" + css_class + "\">" +
         (tip.empty() ? "" : "<title>" + EscapeHtml(tip) + "</title>") + "</rect>\n";
}

std::string Text(double x, double y, const std::string& text, const char* anchor, const char* css_class = "label") {
  return "<text x=\"" + Coordinate(x) + "\" y=\"" + Coordinate(y) + "\" text-anchor=\"" + anchor + "\" class=\"" +
         css_class + "\">" + EscapeHtml(text) + "</text>\n";
}

std::string MarkText(double value) {
  if (value != 0.0 && std::abs(value) >= 1e4) return FixedText(value / 1e3, std::fmod(value, 1e3) == 0.0 ? 0 : 1) + "k";
  std::string text = FixedText(value, 6);
  while (text.find('.') != std::string::npos && (text.back() == '0' || text.back() == '.')) {
    const bool point = text.back() == '.';
    text.pop_back();
    if (point) break;
  }
  return text;
}

std::vector<int> CountBins(const std::vector<double>& values, double high, int bins) {
  std::vector<int> counts(bins, 0);
  for (const double value : values) {
    const double place = high > 0.0 ? value / high * bins : 0.0;
    ++counts[std::clamp(static_cast<int>(place), 0, bins - 1)];
  }
  return counts;
}

/// Plot area of a chart with axes.
struct Frame {
  double left, right, top, bottom;
  double x_low, x_high, y_low, y_high;

  double x(double value) const { return left + (right - left) * (value - x_low) / (x_high - x_low); }
  double y(double value) const { return bottom - (bottom - top) * (value - y_low) / (y_high - y_low); }

  std::string Axes(const std::string& x_name, const std::string& y_name) const {
    std::string svg;
    for (const double mark : AxisMarks(y_low, y_high, 5)) {
      svg += SvgLine(left, y(mark), right, y(mark), "grid") + Text(left - 6, y(mark) + 4, MarkText(mark), "end");
    }
    for (const double mark : AxisMarks(x_low, x_high, 7)) svg += Text(x(mark), bottom + 16, MarkText(mark), "middle");
    svg += SvgLine(left, bottom, right, bottom, "axis");
    return svg + Text(right, bottom + 32, x_name, "end") + Text(left, top - 8, y_name, "start");
  }
};

}  // namespace

std::string Coordinate(double value) {
  const double tenths = std::round(value * 10.0);
  const long long whole = static_cast<long long>(tenths);
  std::string text = std::to_string(std::llabs(whole) / 10);
  if (whole % 10 != 0) text += "." + std::to_string(std::llabs(whole) % 10);
  return (whole < 0 ? "-" : "") + text;
}

std::string SvgLine(double x1, double y1, double x2, double y2, const char* css_class) {
  return "<line x1=\"" + Coordinate(x1) + "\" y1=\"" + Coordinate(y1) + "\" x2=\"" + Coordinate(x2) + "\" y2=\"" +
         Coordinate(y2) + "\" class=\"" + css_class + "\"/>\n";
}

std::vector<double> AxisMarks(double low, double high, int most) {
  std::vector<double> marks;
  if (!(high > low) || !std::isfinite(high - low)) return marks;
  double step = std::pow(10.0, std::floor(std::log10((high - low) / most)));
  for (const double factor : {2.0, 2.5, 2.0, 2.0, 2.5}) {
    if ((high - low) / step <= most) break;
    step *= factor;
  }
  const long long first = std::llround(std::ceil(low / step - 1e-9));
  const long long last = std::llround(std::floor(high / step + 1e-9));
  for (long long i = first; i <= last; ++i) marks.push_back(static_cast<double>(i) * step);
  return marks;
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

std::string BarChart::Svg() const {
  const int left = 130;
  const int right = kWidth - 130;
  const int step = 30;
  double most = 0.0;
  for (const Row& row : rows) {
    double sum = 0.0;
    for (const BarPart& part : row.parts) sum += part.value;
    most = std::max(most, sum);
  }
  std::string svg = Open(kWidth, step * static_cast<int>(rows.size()) + 6, title);
  double y = 4.0;
  for (const Row& row : rows) {
    svg += Text(left - 10, y + 15, row.name, "end");
    double x = left;
    for (const BarPart& part : row.parts) {
      if (!(part.value > 0.0)) continue;
      const double width = std::max(1.5, (right - left) * part.value / most);
      svg += Rect(x, y, width, 21, part.css_class, row.name + ": " + MarkText(part.value) + " " + part.name);
      x += width;
    }
    svg += Text(x + 8, y + 15, row.value_text, "start", "value");
    y += step;
  }
  return svg + "</svg>\n";
}

std::string TwoSidedHistogram::Svg() const {
  constexpr int kBins = 48;
  constexpr double kHalf = 52.0;
  const bool one_sided = before.empty() || after.empty();
  const Frame frame{8.0, kWidth / 2.0 - 8.0,
                    8.0, 8.0 + (one_sided ? 1 : 2) * kHalf,
                    0.0, std::max({Quantile(before, 0.98), Quantile(after, 0.98), 1e-9}),
                    0.0, 1.0};
  std::string svg = Open(kWidth / 2, static_cast<int>(frame.bottom) + 36, title);
  const double width = (frame.right - frame.left) / kBins;
  const double middle = frame.top + kHalf;
  const std::vector<double>* samples[] = {&before, &after};
  for (int side = 0; side < 2; ++side) {
    if (samples[side]->empty()) continue;
    const bool upwards = side == 0 || one_sided;
    const std::vector<int> counts = CountBins(*samples[side], frame.x_high, kBins);
    const int most = std::max(1, *std::max_element(counts.begin(), counts.end()));
    for (int bin = 0; bin < kBins; ++bin) {
      if (counts[bin] == 0) continue;
      const double height = std::max(1.0, (kHalf - 4.0) * counts[bin] / most);
      const std::string tip = Counted(counts[bin], "clip") + ", from " +
                              MarkText(std::round(1e3 * frame.x_high * bin / kBins) / 1e3) + " " + unit +
                              (bin + 1 == kBins ? " up" : "");
      svg += Rect(frame.left + bin * width, upwards ? middle - 1 - height : middle + 1, width - 0.8, height,
                  side == 0 ? "before" : "after", tip);
    }
    const double median = frame.x(std::min(frame.x_high, Quantile(*samples[side], 0.5)));
    svg += SvgLine(median, upwards ? frame.top : middle + 1, median, upwards ? middle - 1 : frame.bottom, "median");
  }
  svg += SvgLine(frame.left, middle, frame.right, middle, "axis");
  for (const double mark : AxisMarks(0.0, frame.x_high, 4)) {
    svg += Text(frame.x(mark), frame.bottom + 14, MarkText(mark), mark == 0.0 ? "start" : "middle");
  }
  return svg + Text(frame.right, frame.bottom + 30, unit, "end") + "</svg>\n";
}

std::string LineChart::Svg() const {
  Frame frame{56, kWidth - 16.0, 28, 218, 1e300, -1e300, 1e300, -1e300};
  for (const Curve& curve : curves) {
    for (const auto& [x, y] : curve.points) {
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      frame.x_low = std::min(frame.x_low, x), frame.x_high = std::max(frame.x_high, x);
      frame.y_low = std::min(frame.y_low, y), frame.y_high = std::max(frame.y_high, y);
    }
  }
  if (frame.x_low > frame.x_high) return "";
  if (frame.y_low > 0.0 && frame.y_low < 0.5 * frame.y_high) frame.y_low = 0.0;
  if (frame.y_high == frame.y_low) frame.y_high = frame.y_low + 1.0;
  if (frame.x_high == frame.x_low) frame.x_high = frame.x_low + 1.0;
  std::string svg = Open(kWidth, 262, title) + frame.Axes(x_name, y_name);
  double key_x = frame.left;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::size_t colour = curves[i].colour < 0 ? i % 6 : static_cast<std::size_t>(curves[i].colour);
    const std::string css_class = "curve c" + std::to_string(colour);
    const std::string begin = "<polyline class=\"" + css_class + "\" points=\"";
    const std::string end = "\"><title>" + EscapeHtml(curves[i].name) + "</title></polyline>\n";
    std::string part;
    for (const auto& [x, y] : curves[i].points) {
      if (std::isfinite(x) && std::isfinite(y)) {
        part += Coordinate(frame.x(x)) + "," + Coordinate(frame.y(y)) + " ";
      } else if (!part.empty()) {
        svg += begin + part + end;
        part.clear();
      }
    }
    if (!part.empty()) svg += begin + part + end;
    svg += SvgLine(key_x, 250, key_x + 18, 250, css_class.c_str()) + Text(key_x + 24, 254, curves[i].name, "start");
    key_x += 42.0 + 6.6 * static_cast<double>(curves[i].name.size());
  }
  return svg + "</svg>\n";
}

}  // namespace mocurate
