#include "report/plot.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "report/svg.h"

namespace mocurate {
namespace {

// Pixels.
constexpr double kPlotWidth = 420.0, kPlotHeight = 270.0;
constexpr double kPlotLeft = 58.0, kPlotRight = 14.0, kPlotTop = 30.0, kPlotBottom = 42.0;
constexpr double kLegendLine = 15.0;

constexpr Colour kCurveColours[] = {kBlue,          kOrange,       {44, 150, 84},  {190, 60, 70},
                                    {124, 88, 190}, {90, 96, 104}, {180, 140, 20}, {20, 150, 170}};

struct Range {
  double low = 1e300, high = -1e300;

  void Add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void Widen() {
    if (!(high >= low)) low = 0.0, high = 1.0;
    const double margin = high > low ? 0.05 * (high - low) : std::max(1e-6, 0.1 * std::abs(high));
    low -= margin;
    high += margin;
  }
  double Of(double value) const { return (value - low) / (high - low); }
};

void Label(double x, double y, const std::string& text, double size, TextAnchor anchor, bool bold,
           std::vector<Shape>& shapes) {
  shapes.emplace_back(TextShape{Vector2d(x, y), text, size, anchor, kInkColour, bold});
}

void DrawPlot(const Plot& plot, double left, double top, std::vector<Shape>& shapes) {
  Range x, y;
  for (const PlotCurve& curve : plot.curves) {
    for (const PlotPoint& point : curve.points) {
      x.Add(point.x);
      y.Add(point.y);
      if (point.low) y.Add(*point.low);
      if (point.high) y.Add(*point.high);
    }
  }
  x.Widen();
  y.Widen();
  const double width = kPlotWidth - kPlotLeft - kPlotRight, height = kPlotHeight - kPlotTop - kPlotBottom;
  const auto place = [&](double a, double b) {
    return Vector2d(left + kPlotLeft + width * x.Of(a), top + kPlotTop + height * (1.0 - y.Of(b)));
  };
  Label(left + kPlotLeft, top + 18.0, plot.title, 12.0, TextAnchor::kStart, true, shapes);
  for (const double mark : AxisMarks(y.low, y.high, 6)) {
    if (mark < y.low || mark > y.high) continue;
    shapes.emplace_back(LineShape{{place(x.low, mark), place(x.high, mark)}, 0.6, kFaintColour});
    const Vector2d at = place(x.low, mark);
    Label(at.x() - 5.0, at.y() + 3.5, RoundedText(mark), 9.5, TextAnchor::kEnd, false, shapes);
  }
  for (const double mark : AxisMarks(x.low, x.high, 9)) {
    if (mark < x.low || mark > x.high) continue;
    const Vector2d at = place(mark, y.low);
    shapes.emplace_back(LineShape{{at, at + Vector2d(0.0, 4.0)}, 0.8, kGrey});
    Label(at.x(), at.y() + 15.0, RoundedText(mark), 9.5, TextAnchor::kMiddle, false, shapes);
  }
  shapes.emplace_back(LineShape{{place(x.low, y.high), place(x.low, y.low), place(x.high, y.low)}, 1.0, kGrey});
  Label(left + kPlotLeft + 0.5 * width, top + kPlotHeight - 10.0, plot.x_name, 10.5, TextAnchor::kMiddle, false,
        shapes);
  Label(left + 4.0, top + kPlotTop - 4.0, plot.y_name, 10.5, TextAnchor::kStart, false, shapes);
  for (std::size_t c = 0; c < plot.curves.size(); ++c) {
    const Colour& colour = kCurveColours[c % std::size(kCurveColours)];
    std::vector<Vector2d> line;
    for (const PlotPoint& point : plot.curves[c].points) {
      if (!std::isfinite(point.y)) continue;
      const Vector2d at = place(point.x, point.y);
      line.push_back(at);
      if (point.low && point.high) {
        shapes.emplace_back(LineShape{{place(point.x, *point.low), place(point.x, *point.high)}, 1.0, colour});
      }
      shapes.emplace_back(LineShape{{at, at}, 5.0, colour});
    }
    if (line.size() > 1) shapes.emplace_back(LineShape{std::move(line), 1.6, colour});
    const double row = top + kPlotHeight + kLegendLine * (static_cast<double>(c) + 0.5);
    shapes.emplace_back(LineShape{{{left + kPlotLeft, row - 3.5}, {left + kPlotLeft + 16.0, row - 3.5}}, 2.4, colour});
    Label(left + kPlotLeft + 22.0, row, plot.curves[c].name, 10.5, TextAnchor::kStart, false, shapes);
  }
}

}  // namespace

Drawing DrawPlots(const std::vector<Plot>& plots, int columns) {
  Drawing drawing;
  const auto across = static_cast<std::size_t>(std::max(1, std::min<int>(columns, static_cast<int>(plots.size()))));
  double top = 0.0;
  for (std::size_t first = 0; first < plots.size(); first += across) {
    std::size_t legend = 0;
    for (std::size_t i = first; i < std::min(plots.size(), first + across); ++i) {
      DrawPlot(plots[i], kPlotWidth * static_cast<double>(i - first), top, drawing.shapes);
      legend = std::max(legend, plots[i].curves.size());
      drawing.title += (drawing.title.empty() ? "" : "; ") + plots[i].title;
    }
    top += kPlotHeight + kLegendLine * (static_cast<double>(legend) + 1.0);
  }
  drawing.width = kPlotWidth * static_cast<double>(across);
  drawing.height = std::max(top, 10.0);
  return drawing;
}

Expected<std::vector<Plot>> PlotsOf(const nlohmann::json& json) {
  std::vector<Plot> plots;
  try {
    for (const nlohmann::json& one : json.at("plots")) {
      Plot plot{one.at("title"), one.at("x_name"), one.at("y_name"), {}};
      for (const nlohmann::json& curve : one.at("curves")) {
        PlotCurve own{curve.at("name"), {}};
        for (const nlohmann::json& point : curve.at("points")) {
          PlotPoint at{point.at("x"), point.at("y"), {}, {}};
          if (point.contains("low") && point["low"].is_number()) at.low = point["low"].get<double>();
          if (point.contains("high") && point["high"].is_number()) at.high = point["high"].get<double>();
          own.points.push_back(at);
        }
        plot.curves.push_back(std::move(own));
      }
      plots.push_back(std::move(plot));
    }
  } catch (const nlohmann::json::exception& problem) {
    return Fail(ErrorCode::kMalformed, std::string("not plots: ") + problem.what(), "plots");
  }
  return plots;
}

}  // namespace mocurate
