#include "report/charts.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "report/html.h"

namespace mocurate {
namespace {

// Pixels.
constexpr double kText = 11.0;
constexpr double kPlotWidth = 440.0, kPlotHeight = 250.0, kLeft = 60.0, kRight = 14.0, kTop = 36.0, kBottom = 44.0;
constexpr double kLegendLine = 16.0;

/// Blue, orange, green, purple, ochre, grey, then others that colour-blind people tell apart.
constexpr Colour kCurveColours[] = {{37, 99, 201},   {194, 87, 26}, {44, 138, 87},  {138, 79, 191}, {176, 137, 0},
                                    {123, 135, 148}, {190, 60, 70}, {20, 150, 170}, {140, 86, 75},  {90, 96, 104}};
const Colour& CurveColour(int index) {
  return kCurveColours[static_cast<std::size_t>(index) % std::size(kCurveColours)];
}

std::string MarkText(double value) { return RoundedText(value, 6); }

/// Names beside samples of their colours, in lines of at most `width`; returns where the last line ends.
double DrawLegend(const std::vector<std::pair<std::string, Colour>>& names, double left, double top, double width,
                  Drawing& drawing) {
  double x = left, y = top;
  for (const auto& [name, colour] : names) {
    const double needed = 24.0 + TextWidth(name, kText);
    if (x > left && x + needed > left + width) x = left, y += kLegendLine;
    drawing.Box(x, y + 3.0, 14.0, 4.0, colour);
    drawing.Text(x + 18.0, y + 9.0, name, kText);
    x += needed + 8.0;
  }
  return names.empty() ? top : y + kLegendLine;
}

struct AxisRange {
  double low = 1e300, high = -1e300;

  void Add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// With 0 where the values come near it, and a margin where `margin`.
  void Widen(bool margin) {
    if (!(high >= low)) low = 0.0, high = 1.0;
    if (margin && low > 0.0 && low < 0.5 * high) low = 0.0;
    if (high == low) high = low + (low != 0.0 ? std::abs(low) : 1.0);
    const double more = margin ? 0.05 * (high - low) : 0.0;
    if (low != 0.0) low -= more;
    high += more;
  }
  double Of(double value) const { return (value - low) / (high - low); }
};

/// Draws one plot with its upper left corner at a place; returns its height.
class PlotPainter {
 public:
  PlotPainter(const Plot& plot, double left, double top, Drawing& drawing)
      : plot_(plot),
        head_(plot.title.empty() ? kTop - 16.0 : kTop),
        left_(left + kLeft),
        top_(top + head_),
        drawing_(drawing) {
    for (const PlotCurve& curve : plot.curves) {
      AxisRange& y = curve.right ? right_ : y_;
      two_sided_ |= curve.right;
      for (const PlotPoint& point : curve.points) {
        if (std::isfinite(point.y)) x_.Add(point.x);
        for (const double value : {point.y, point.low.value_or(point.y), point.high.value_or(point.y)}) y.Add(value);
      }
    }
    if (!plot.x_texts.empty()) x_ = {-0.5, static_cast<double>(plot.x_texts.size()) - 0.5};
    x_.Widen(false);
    y_.Widen(true);
    right_.Widen(true);
    if (plot.decades) y_ = {(*plot.decades)[0], (*plot.decades)[1]};
    width_ = kPlotWidth - kLeft - (two_sided_ ? kLeft : kRight);
  }

  double Draw() {
    drawing_.Text(left_ - kLeft + 8.0, top_ - 22.0, plot_.title, 12.0, TextAnchor::kStart, kInkColour, true);
    DrawAxes();
    std::vector<std::pair<std::string, Colour>> names;
    for (const bool bands : {true, false}) {
      for (std::size_t c = 0; c < plot_.curves.size(); ++c) {
        const PlotCurve& curve = plot_.curves[c];
        const Colour& colour = CurveColour(curve.colour < 0 ? static_cast<int>(c) : curve.colour);
        bands ? DrawBand(curve, colour) : DrawCurve(curve, colour);
        if (bands) names.emplace_back(curve.name, colour);
      }
    }
    const double legend = top_ - kTop + kPlotHeight;
    return DrawLegend(names, left_, legend, width_ + kRight, drawing_) + 8.0 - (top_ - head_);
  }

 private:
  double Height() const { return kPlotHeight - kTop - kBottom; }

  Vector2d Place(double x, double y, bool right) const {
    if (plot_.decades) y = std::clamp(y > 0.0 ? std::log10(y) : y_.low, y_.low, y_.high);
    return {left_ + width_ * x_.Of(x), top_ + Height() * (1.0 - (right ? right_ : y_).Of(y))};
  }

  void DrawAxes() {
    const double bottom = top_ + Height(), end = left_ + width_;
    const auto level = [&](double mark, const AxisRange& y) { return top_ + Height() * (1.0 - y.Of(mark)); };
    for (const double mark : AxisMarks(y_.low, y_.high, plot_.decades ? 9 : 5)) {
      if (plot_.decades && mark != std::round(mark)) continue;
      const double y = level(mark, y_);
      drawing_.Line({{left_, y}, {end, y}}, plot_.decades && mark == 0.0 ? 1.4 : 0.7, kFaintColour);
      drawing_.Text(left_ - 6.0, y + 4.0, plot_.decades ? RoundedText(std::pow(10.0, mark), 4) : MarkText(mark), kText,
                    TextAnchor::kEnd, kQuietColour);
    }
    if (two_sided_) {
      for (const double mark : AxisMarks(right_.low, right_.high, 5)) {
        drawing_.Text(end + 6.0, level(mark, right_) + 4.0, MarkText(mark), kText, TextAnchor::kStart, kQuietColour);
      }
      drawing_.Text(end, top_ - 8.0, plot_.right_name, kText, TextAnchor::kEnd, kQuietColour);
    }
    const auto below = [&](double x, const std::string& text) {
      const bool corner = x_.Of(x) > 0.98 && text.size() > 4;  // would be cut off
      drawing_.Text(corner ? end + kRight : left_ + width_ * x_.Of(x), bottom + 16.0, text, kText,
                    corner ? TextAnchor::kEnd : TextAnchor::kMiddle, kQuietColour);
    };
    for (std::size_t i = 0; i < plot_.x_texts.size(); ++i) below(static_cast<double>(i), plot_.x_texts[i]);
    if (plot_.x_texts.empty()) {
      for (const double mark : AxisMarks(x_.low, x_.high, 7)) below(mark, MarkText(mark));
    }
    drawing_.Line({{left_, top_}, {left_, bottom}, {end, bottom}}, 1.0, kQuietColour);
    drawing_.Text(end, bottom + 33.0, plot_.x_name, kText, TextAnchor::kEnd, kQuietColour);
    drawing_.Text(left_ - kLeft + 8.0, top_ - 8.0, plot_.y_name, kText, TextAnchor::kStart, kQuietColour);
  }

  void DrawBand(const PlotCurve& curve, const Colour& colour) {
    for (std::size_t i = 1; i < curve.points.size(); ++i) {
      const PlotPoint &a = curve.points[i - 1], &b = curve.points[i];
      if (!a.low || !a.high || !b.low || !b.high) continue;
      drawing_.shapes.emplace_back(PolygonShape{{Place(a.x, *a.low, curve.right), Place(a.x, *a.high, curve.right),
                                                 Place(b.x, *b.high, curve.right), Place(b.x, *b.low, curve.right)},
                                                Lightened(colour, 0.8)});
    }
  }

  void DrawCurve(const PlotCurve& curve, const Colour& colour) {
    const bool dots = curve.points.size() <= 40;
    std::vector<Vector2d> run;  // of one kind of line
    bool run_seen = true;
    const auto end_run = [&] {
      if (run.size() > 1) drawing_.Line(run, 1.7, colour, !run_seen);
      run.clear();
    };
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const PlotPoint& point = curve.points[i];
      if (!std::isfinite(point.y)) {
        end_run();
        continue;
      }
      const Vector2d at = Place(point.x, point.y, curve.right);
      const bool seen =
          !plot_.solid || run.empty() || (curve.points[i - 1].x >= (*plot_.solid)[0] && point.x <= (*plot_.solid)[1]);
      if (run.size() > 1 && seen != run_seen) {
        const Vector2d last = run.back();
        end_run();
        run = {last};
      }
      run_seen = seen;
      run.push_back(at);
      if (!dots) continue;
      drawing_.Dot(at, point.marked ? 7.0 : 3.5, colour,
                   curve.name + ": " + RoundedText(point.y, 4) + (point.marked ? ", responds" : ""));
    }
    end_run();
  }

  const Plot& plot_;
  const double head_;  ///< above the axes
  double left_, top_, width_ = 0.0;
  bool two_sided_ = false;
  AxisRange x_, y_, right_;
  Drawing& drawing_;
};

}  // namespace

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

Drawing BarChart::Draw() const {
  constexpr double kBar = 380.0, kStep = 30.0;
  double most = full, left = 60.0, right = 60.0;
  for (const Row& row : rows) {
    double sum = 0.0;
    for (const BarPart& part : row.parts) sum += part.value;
    most = std::max(most, sum);
    left = std::max(left, 16.0 + TextWidth(row.name, 12.0));
    right = std::max(right, 16.0 + TextWidth(row.value_text, 12.0));
  }
  Drawing drawing{left + kBar + right, 0.0, title};
  double y = 4.0;
  for (const Row& row : rows) {
    drawing.Text(left - 10.0, y + 15.0, row.name, 12.0, TextAnchor::kEnd, kQuietColour);
    double x = left;
    for (const BarPart& part : row.parts) {
      if (!(part.value > 0.0)) continue;
      const double width = std::max(1.5, kBar * part.value / most);
      drawing.Box(x, y, width, 21.0, part.colour, row.name + ": " + MarkText(part.value) + " " + part.name);
      x += width;
    }
    if (row.interval) {
      const double low = left + kBar * (*row.interval)[0] / most, high = left + kBar * (*row.interval)[1] / most;
      drawing.Line({{low, y + 10.5}, {high, y + 10.5}}, 1.5, kInkColour);
      for (const double end : {low, high}) drawing.Line({{end, y + 6.0}, {end, y + 15.0}}, 1.5, kInkColour);
      x = std::max(x, high);
    }
    drawing.Text((full > 0.0 ? left + kBar : x) + 8.0, y + 15.0, row.value_text, 12.0);
    y += kStep;
  }
  for (const double share : {0.0, 0.5, 1.0}) {
    if (full <= 0.0) break;
    drawing.Line({{left + kBar * share, 0.0}, {left + kBar * share, y}}, 0.7, kQuietColour, share == 0.5);
    drawing.Text(left + kBar * share, y + 12.0, MarkText(share * full), kText, TextAnchor::kMiddle, kQuietColour);
  }
  if (full > 0.0) y += 18.0;
  std::vector<std::pair<std::string, Colour>> names;
  for (const BarPart& part : legend) names.emplace_back(part.name, part.colour);
  y = DrawLegend(names, left, y, kBar, drawing);
  drawing.Finish(y + 4.0, note, corner);
  return drawing;
}

std::string PlotHtml(const Plot& plot) {
  const bool finite = std::any_of(plot.curves.begin(), plot.curves.end(), [](const PlotCurve& curve) {
    return std::any_of(curve.points.begin(), curve.points.end(), [](const PlotPoint& p) { return std::isfinite(p.y); });
  });
  PlotSheet sheet{"", "", "", {plot}};
  sheet.plots.front().title.clear();  // the caption has it
  Drawing drawing = sheet.Draw();
  drawing.title = plot.title;
  return finite ? Figure(EscapeHtml(plot.title), ToInlineSvg(drawing)) : "";
}

Drawing PlotSheet::Draw() const {
  const auto across = static_cast<std::size_t>(std::clamp(static_cast<int>(plots.size()), 1, std::max(1, columns)));
  Drawing drawing{kPlotWidth * static_cast<double>(across), 0.0, title};
  double top = drawing.Head();
  for (std::size_t first = 0; first < plots.size(); first += across) {
    double height = 0.0;
    for (std::size_t i = first; i < std::min(plots.size(), first + across); ++i) {
      height = std::max(height,
                        PlotPainter(plots[i], kPlotWidth * static_cast<double>(i - first), top + 4.0, drawing).Draw());
    }
    top += height + 4.0;
  }
  drawing.Finish(top, note, corner);
  return drawing;
}

nlohmann::json PlotSheet::Json() const {
  nlohmann::json json = {{"title", title}, {"corner", corner}, {"plots", nlohmann::json::array()}};
  for (const Plot& plot : plots) {
    nlohmann::json one = {{"title", plot.title}, {"x_name", plot.x_name}, {"curves", nlohmann::json::array()}};
    if (plot.solid) one["solid"] = *plot.solid;
    for (const PlotCurve& curve : plot.curves) {
      nlohmann::json points = nlohmann::json::array();
      for (const PlotPoint& point : curve.points) {
        points.push_back({{"x", point.x}, {"y", point.y}});
        if (point.low) points.back()["low"] = *point.low;
        if (point.high) points.back()["high"] = *point.high;
      }
      one["curves"].push_back({{"name", curve.name}, {"right", curve.right}, {"points", std::move(points)}});
    }
    json["plots"].push_back(std::move(one));
  }
  return json;
}

}  // namespace mocurate
