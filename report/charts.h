#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report/drawing.h"

namespace mocurate {

/// The charts of pages, papers and studies, as drawings.

struct BarPart {
  double value = 0.0;
  Colour colour{};
  std::string name{};
};

/// One horizontal bar of stacked parts per row, with a legend where `legend` names the parts.
struct BarChart {
  struct Row {
    std::string name;
    std::vector<BarPart> parts;
    std::string value_text;
    std::optional<std::array<double, 2>> interval{};  ///< a whisker, in units of the values
  };
  std::string title;
  std::vector<Row> rows{};
  double full = 0.0;  ///< value of a full bar; 0: of the longest row
  std::vector<BarPart> legend{};
  std::string note{}, corner{};  ///< below the bars

  Drawing Draw() const;
};

/// A number with its interval, over x.
struct PlotPoint {
  double x = 0.0, y = 0.0;
  std::optional<double> low{}, high{};
  bool marked = false;  ///< a large dot
};

struct PlotCurve {
  std::string name;
  std::vector<PlotPoint> points{};  ///< in order of x; one that is not finite interrupts the curve
  int colour = -1;                  ///< of kCurveColours; -1: the curve's index
  bool right = false;               ///< of the axis on the right
};

/// Curves with bands over a common horizontal axis, and a legend.
struct Plot {
  std::string title, x_name, y_name;
  std::vector<PlotCurve> curves{};
  std::string right_name{};                        ///< of the axis on the right, where a curve has it
  std::optional<std::array<double, 2>> solid{};    ///< curves are dashed outside: values that training lacked
  std::vector<std::string> x_texts{};              ///< names of x = 0, 1, ...; else numbers
  std::optional<std::array<double, 2>> decades{};  ///< a logarithmic y axis between these powers of ten
};

/// Plots below a title and above a note, at most `columns` side by side.
struct PlotSheet {
  std::string title, note, corner;
  std::vector<Plot> plots;
  int columns = 3;

  Drawing Draw() const;
  /// {"title", "corner", "plots": [{"title", "x_name", "solid", "curves": [{"name", "right", "points": [{"x", "y",
  /// "low", "high"}]}]}]}; what is absent is left out.
  nlohmann::json Json() const;
};

/// A plot in a page, its title as caption; empty without a finite number.
std::string PlotHtml(const Plot& plot);

/// A plot a damage from eval's dose_response.json: each metric over the doses, as a multiple of its value on undamaged
/// motions (of real motions, where that is 0 or the metric is a distance to them; of 0.001 where both are 0), from 1/10
/// to 1000 on a logarithmic axis.
PlotSheet DoseSheet(const nlohmann::json& dose, const std::string& title);

/// How networks learned: FID_equal, KID, accuracy and movement over the steps of their samples, beside the levels of
/// real motions and of yardsticks. `rows` as of metrics.json; nothing where no network has two samples.
std::optional<PlotSheet> LearningSheet(const nlohmann::json& rows, const std::string& title);

/// Round steps (1, 2, 5 times a power of ten) that cover [low, high] with at most `most` marks.
std::vector<double> AxisMarks(double low, double high, int most);

}  // namespace mocurate
