#pragma once

#include <string>
#include <utility>
#include <vector>

namespace mocurate {

/// Charts as inline SVG text. Colours are classes of the page's style ("before", "after", ...), which follow the
/// reader's light or dark scheme. `title` is the text alternative. All texts are escaped here.

struct BarPart {
  double value = 0.0;
  const char* css_class = "after";
  std::string name;
};

/// One horizontal bar of stacked parts per row.
struct BarChart {
  struct Row {
    std::string name;
    std::vector<BarPart> parts;
    std::string value_text;
  };
  std::string title;
  std::vector<Row> rows;

  std::string Svg() const;
};

/// Two samples of one measure over a common axis: `before` upwards, `after` downwards. Values beyond the 98th
/// percentile of both are in the last bin. A single sample is drawn upwards.
struct TwoSidedHistogram {
  std::string title;
  std::string unit;
  std::vector<double> before;
  std::vector<double> after;

  std::string Svg() const;
};

/// Curves over a common horizontal axis. Every curve has points (x, y) in order of x; a point
/// that is not finite interrupts it.
struct LineChart {
  struct Curve {
    std::string name;
    std::vector<std::pair<double, double>> points;
    int colour = -1;  ///< of the six of the page's style (0 blue, 1 orange, 5 grey); -1: the curve's index
  };
  std::string title;
  std::string x_name;
  std::string y_name;
  std::vector<Curve> curves;

  std::string Svg() const;
};

/// Round steps (1, 2, 5 times a power of ten) that cover [low, high] with at most `most` marks.
std::vector<double> AxisMarks(double low, double high, int most);

/// Coordinates: at most one decimal.
std::string Coordinate(double value);

std::string SvgLine(double x1, double y1, double x2, double y2, const char* css_class);

double Quantile(std::vector<double> values, double share);

}  // namespace mocurate
