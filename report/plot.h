#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "report/drawing.h"

namespace mocurate {

/// A number with its interval, over x.
struct PlotPoint {
  double x = 0.0, y = 0.0;
  std::optional<double> low, high;
};

struct PlotCurve {
  std::string name;
  std::vector<PlotPoint> points;  ///< in order of x
};

/// A diagram for a paper, on its own: curves with intervals, marks, a legend.
struct Plot {
  std::string title, x_name, y_name;
  std::vector<PlotCurve> curves;
};

/// Plots side by side, at most `columns` in a row.
Drawing DrawPlots(const std::vector<Plot>& plots, int columns);

/// {"plots": [{"title", "x_name", "y_name", "curves": [{"name", "points": [{"x", "y", "low", "high"}]}]}], "columns"}.
/// Error kMalformed.
Expected<std::vector<Plot>> PlotsOf(const nlohmann::json& json);

}  // namespace mocurate
