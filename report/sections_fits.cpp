#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/text.h"
#include "report/charts.h"
#include "report/html.h"
#include "report/motion_rows.h"
#include "report/page.h"
#include "report/run_facts.h"

namespace mocurate {
namespace {

constexpr int kMostPersons = 24;
constexpr std::size_t kFewClips = 4;  ///< below, a table suffices

struct Measure {
  const char* name;
  const char* key;
  const char* unit;
  double factor;
};

constexpr Measure kMeasures[] = {{"Bone length deviation", "bone_spread_mm", "mm", 1.0},
                                 {"Jerk", "jerk", "m/s³", 1.0},
                                 {"Missing joints", "missing_share", "%", 100.0},
                                 {"Frozen frames", "frozen_frames", "frames", 1.0},
                                 {"Foot skate", "foot_skate", "mm/s", 1000.0}};

std::vector<double> Scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

std::string MedianCell(const std::vector<double>& values) {
  return values.empty() ? "–" : ShortText(Quantile(values, 0.5));
}
std::string HighCell(const std::vector<double>& values) {
  return values.empty() ? "–" : ShortText(Quantile(values, 0.95));
}

std::string ResidualTable(const nlohmann::json& run) {
  const std::vector<double> rms = OverClips(run, "", "residual_rms_mm");
  const std::vector<double> p95 = OverClips(run, "", "residual_p95_mm");
  const std::vector<double> iterations = OverClips(run, "", "iterations");
  HtmlTable table{"Fit to the evidence, over clips", {"", "Median", "95th percentile", "Worst"}};
  const auto add = [&table](const char* name, const std::vector<double>& values) {
    if (!values.empty())
      table.rows.push_back({name, MedianCell(values), HighCell(values), ShortText(Quantile(values, 1.0))});
  };
  add("Residual RMS, mm", rms);
  add("Residual 95th percentile, mm", p95);
  add("Iterations", iterations);
  return table.rows.empty() ? "" : table.Html();
}

std::string Figures(const DrawnClip& clip) {
  std::string text = EscapeHtml(clip.rank);
  if (const auto rms = NumberOf(clip.figures, "residual_rms_mm"))
    text += ", residual " + FixedText(*rms, 1) + " mm RMS";
  if (const auto p95 = NumberOf(clip.figures, "residual_p95_mm"))
    text += ", " + FixedText(*p95, 1) + " mm at the 95th percentile";
  if (!clip.evidence.label.empty()) text += "; labelled " + EscapeHtml(clip.evidence.label);
  return Paragraph(text, "soft");
}

/// Clips over a measure, before and after the fit; values beyond the 98th percentile of both are in the last bin.
Plot Histogram(const std::string& name, const std::string& unit, const std::vector<double>& before,
               const std::vector<double>& after) {
  constexpr int kBins = 32;
  const double high = std::max({Quantile(before, 0.98), Quantile(after, 0.98), 1e-9});
  Plot plot{name, unit, "clips"};
  for (const auto& [label, values, colour] : {std::tuple("before", &before, 5), std::tuple("after", &after, 0)}) {
    PlotCurve curve{label, {}, colour};
    for (int bin = 0; bin < kBins; ++bin) curve.points.push_back({high * (bin + 0.5) / kBins, 0.0});
    for (const double value : *values) {
      curve.points[static_cast<std::size_t>(std::min(kBins - 1.0, std::clamp(value / high, 0.0, 1.0) * kBins))].y +=
          1.0;
    }
    if (!values->empty()) plot.curves.push_back(std::move(curve));
  }
  return plot;
}

/// Share of whitened errors within a number of estimated standard deviations, beside the expected share.
std::string CoverageChart(const nlohmann::json& error) {
  Plot chart{"Errors within a number of estimated standard deviations, %", "standard deviations", "%", {{}, {}}};
  chart.curves[0] = {"if calibrated", {{0.0, 0.0}}, 5};
  chart.curves[1] = {"measured", {{0.0, 0.0}}, 0};
  double sigmas = 0.0;
  for (const double share : NumbersOf(Field(error, "within_quarters_of_sigma"))) {
    sigmas += 0.25;
    chart.curves[0].points.push_back({sigmas, 100.0 * std::erf(sigmas / std::sqrt(2.0))});
    chart.curves[1].points.push_back({sigmas, 100.0 * share});
  }
  return sigmas == 0.0 ? "" : PlotHtml(chart);
}

/// Measures of stated uncertainty: positions and rotations of each group, then positions of each kind of evidence.
std::string SigmaTable(const nlohmann::json& sigma) {
  HtmlTable table{
      "Errors within one and two stated standard deviations, and how well the deviations order the errors "
      "(AUC: of errors above " +
          NumberCell(sigma, "large_error_mm", 0) + " mm)",
      {"", "Samples", "Within one, % (68.3)", "Within two, % (95.4)", "Calibration error", "Spearman", "AUC"}};
  const auto add = [&table](const std::string& name, const nlohmann::json& measures) {
    if (CountOf(measures, "samples") == 0) return;
    const auto share = [&measures](const char* key) {
      const auto value = NumberOf(measures, key);
      return value ? FixedText(100.0 * *value, 1) : std::string("–");
    };
    table.rows.push_back({EscapeHtml(name), CountCell(measures, "samples"), share("within_one_sigma"),
                          share("within_two_sigma"), NumberCell(measures, "ece", 3),
                          NumberCell(measures, "spearman", 2), NumberCell(measures, "auc", 2)});
  };
  const nlohmann::json& groups = Field(sigma, "groups");
  for (const auto& [part, heading] : {std::pair("positions", "Positions"), {"rotations", "Rotations"}}) {
    for (const auto& [key, name] : {std::pair("all", "all joints"),
                                    {"trunk", "trunk"},
                                    {"head", "head"},
                                    {"arms", "arms"},
                                    {"legs", "legs"},
                                    {"not_observed", "not observed"}})
      add(std::string(heading) + ": " + name, Field(Field(groups, key), part));
  }
  if (const nlohmann::json& kinds = Field(sigma, "by_evidence"); kinds.is_object()) {
    for (const auto& [kind, of_kind] : kinds.items())
      add("Positions from " + kind, Field(Field(of_kind, "all"), "positions"));
  }
  std::string html = table.rows.empty() ? "" : table.Html();
  for (const nlohmann::json& warning : Elements(Field(sigma, "warnings")))
    html += Paragraph(TextCell(warning, "message") + ".", "soft");
  return html;
}

/// Mean error over the share of joints that is kept, by the stated deviation and in the ideal order.
std::string RiskCoverageChart(const nlohmann::json& sigma) {
  const nlohmann::json& positions = Field(Field(Field(sigma, "groups"), "all"), "positions");
  Plot chart{"Mean error of the joints with the smallest stated deviations, mm", "joints kept, %", "mm"};
  for (const auto& [name, key, colour] : {std::tuple("by error (ideal)", "ideal_risk_coverage_mm", 5),
                                          std::tuple("by stated deviation", "risk_coverage_mm", 0)}) {
    PlotCurve curve{name, {}, colour};
    double kept = 0.0;
    for (const double risk : NumbersOf(Field(positions, key))) curve.points.push_back({kept += 10.0, risk});
    if (curve.points.empty()) return "";
    chart.curves.push_back(std::move(curve));
  }
  return PlotHtml(chart);
}

/// The skeleton's rest pose from the front with a dot at each joint, as wide as its mean error.
std::string JointErrorFigure(const nlohmann::json& joints_mm, const Skeleton& skeleton) {
  constexpr double kSide = 360.0, kEdge = 24.0, kWidest = 22.0;
  std::vector<Vector3d> places;
  for (const Joint& joint : skeleton.joints) {
    places.push_back(joint.rest_offset + (joint.parent < 0 ? Vector3d::Zero() : places[joint.parent]));
  }
  Eigen::AlignedBox2d box;
  for (const Vector3d& place : places) box.extend(place.head<2>());
  const double scale = (kSide - 2.0 * kEdge) / std::max(1e-9, box.sizes().maxCoeff());
  const auto at = [&](std::size_t j) {
    return Vector2d(kSide / 2.0 + scale * (places[j].x() - box.center().x()),
                    kEdge + scale * (box.max().y() - places[j].y()));
  };
  double most = 0.0;
  for (const Joint& joint : skeleton.joints)
    most = std::max(most, NumberOf(joints_mm, joint.name.c_str()).value_or(0.0));
  if (most <= 0.0) return "";
  Drawing drawing{kSide, 2.0 * kEdge + scale * box.sizes().y(), "Mean error of each joint, on the body from the front"};
  for (std::size_t j = 1; j < places.size(); ++j) {
    drawing.Line({at(static_cast<std::size_t>(skeleton.joints[j].parent)), at(j)}, 2.0, kFaintColour);
  }
  for (std::size_t j = 0; j < places.size(); ++j) {
    const auto mm = NumberOf(joints_mm, skeleton.joints[j].name.c_str());
    if (!mm) continue;
    drawing.Dot(at(j), kWidest * *mm / most, *mm > 0.75 * most ? kBadColour : kAfterColour,
                skeleton.joints[j].name + ": " + FixedText(*mm, 1) + " mm");
  }
  return Figure("Mean error of each joint, from the front, as the width of its dot: the widest is " +
                    FixedText(most, 1) + " mm, those above three quarters of it are red",
                ToInlineSvg(drawing));
}

/// Errors of joints, the largest first, on a body and as a table; and of labels.
std::string ErrorsByPart(const nlohmann::json& error, const Skeleton* skeleton) {
  const auto table_of = [](const std::string& name, const char* head, const nlohmann::json& values) {
    HtmlTable table{name, {head, "Joint position, mm"}};
    std::vector<std::pair<double, std::string>> sorted;
    for (const auto& [key, value] : values.items()) {
      const auto mm = value.is_object() ? NumberOf(value, "joint_mm") : NumberOf(values, key.c_str());
      if (mm) sorted.emplace_back(-*mm, key);
    }
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [mm, key] : sorted)
      table.rows.push_back({key.empty() ? "no label" : EscapeHtml(key), FixedText(-mm, 1)});
    return table.rows.size() < 2 ? std::string() : "<div>" + table.Html() + "</div>\n";
  };
  const nlohmann::json& joints = Field(error, "joints_mm");
  const std::string figure = skeleton == nullptr ? "" : JointErrorFigure(joints, *skeleton);
  const std::string inside = figure + table_of("Mean error by joint", "Joint", joints) +
                             table_of("Mean error by label", "Label", Field(error, "labels"));
  return inside.empty() ? "" : "<div class=\"charts\">\n" + inside + "</div>\n";
}

}  // namespace

std::string QualityHtml(const ReportInput& input) {
  // Depth has no joints to measure before the fit.
  const bool measured = std::any_of(std::begin(kMeasures), std::end(kMeasures), [&](const Measure& measure) {
    return !OverClips(input.run, "before", measure.key).empty();
  });
  HtmlTable table{"Medians over clips of the fitted motion", {"", "Median", "95th percentile"}};
  if (measured) {
    table = {"Medians over clips, before (evidence) and after (fitted motion)",
             {"", "Before", "After", "Before, 95th percentile", "After, 95th percentile"}};
  }
  std::string charts;
  for (const Measure& measure : kMeasures) {
    const auto before = Scaled(OverClips(input.run, "before", measure.key), measure.factor);
    const auto after = Scaled(OverClips(input.run, "after", measure.key), measure.factor);
    if (before.empty() && after.empty()) continue;
    const std::string name = std::string(measure.name) + ", " + measure.unit;
    if (measured) {
      table.rows.push_back({name, MedianCell(before), MedianCell(after), HighCell(before), HighCell(after)});
    } else {
      table.rows.push_back({name, MedianCell(after), HighCell(after)});
    }
    const bool flat = Quantile(before, 1.0) < 1e-3 && Quantile(after, 1.0) < 1e-3;
    if (flat || before.size() + after.size() < kFewClips) continue;
    charts += PlotHtml(Histogram(name, measure.unit, before, after));
  }
  const std::vector<double> residuals = OverClips(input.run, "", "residual_rms_mm");
  if (residuals.size() >= kFewClips) {
    charts += PlotHtml(Histogram("Residual RMS per clip", "mm", {}, residuals));
  }
  const std::string fit = ResidualTable(input.run);
  if (table.rows.empty() && fit.empty())
    return Paragraph("Nothing was fitted in this run: the motion was given, or no fit succeeded.");
  std::string html;
  if (!table.rows.empty()) html += table.Html();
  html += fit;
  if (charts.empty()) return html;
  html += Paragraph("Clips over each measure; the last bin holds everything beyond.", "soft");
  return html + "<div class=\"charts\">\n" + charts + "</div>\n";
}

std::string TruthHtml(const ReportInput& input) {
  const nlohmann::json& error = Field(input.run, "fit_error");
  if (!error.is_object() || error.empty()) return Paragraph("This source has no truth to compare with.");
  const auto cell = [&error](const char* key) {
    const auto value = NumberOf(error, key);
    return value && *value > 0.0 ? FixedText(*value, 2) : std::string("–");
  };
  HtmlTable table{"Mean over " + CountCell(error, "frames") + " frames, clips: " + CountCell(error, "clips"),
                  {"", "Evidence (before)", "Fitted (after)"}};
  table.rows.push_back({"Joint position, mm", cell("evidence_mm"), cell("joint_mm")});
  table.rows.push_back({"Joint rotation, degrees", "–", cell("rotation_deg")});
  table.rows.push_back({"Bone direction, degrees", "–", cell("bone_direction_deg")});
  const nlohmann::json& sigma = Field(error, "sigma");
  const std::string charts = CoverageChart(error) + RiskCoverageChart(sigma);
  const Skeleton* skeleton = input.dataset ? input.dataset->skeleton.get() : nullptr;
  return table.Html() + ErrorsByPart(error, skeleton) + SigmaTable(sigma) +
         (charts.empty() ? "" : "<div class=\"charts wide\">" + charts + "</div>\n") +
         Paragraph("No stage before the evaluation reads the truth; the viewer shows it beside the fits.", "soft");
}

std::string FilmstripsHtml(const ReportInput& input) {
  std::string html;
  if (input.drawn.empty())
    html += Paragraph("No clip has a fit to draw.");
  else {
    html += Paragraph("Fits ordered by residual, from the best to the worst; a name opens its clip in 3-D.");
    html += Paragraph(
        "<span class=\"k-before\"></span>evidence (grey lines, light points)<span class=\"k-left\"></span>left side "
        "and trunk of the fit"
        "<span class=\"k-right\"></span>right side",
        "key soft");
  }
  for (const DrawnClip& clip : input.drawn) {
    html += "<h3>" + ViewerLink(input, clip.item, 0, clip.item) + "</h3>\n" + Figures(clip) +
            ToInlineSvg(DrawFilmstrip(clip.fitted, TracksOf(clip)));
  }
  for (const std::string& reason : input.not_drawn) html += Paragraph("Not drawn: " + EscapeHtml(reason), "soft");
  return html;
}

std::string PersonsHtml(const ReportInput& input) {
  const nlohmann::json& persons = Field(input.run, "persons");
  if (!persons.is_object() || persons.empty()) return Paragraph("No bone lengths were estimated in this run.");
  HtmlTable table{"Length of the bone that ends at the joint, mm; one set per body", {"Joint"}};
  std::vector<std::string> bones;
  std::vector<const nlohmann::json*> shown;
  for (const auto& [name, person] : persons.items()) {
    if (!Field(person, "bone_length_m").is_object() || static_cast<int>(shown.size()) == kMostPersons) continue;
    table.head.push_back(EscapeHtml(name));
    shown.push_back(&person);
  }
  if (shown.empty()) return Paragraph("No bone lengths could be estimated.");
  if (input.dataset && input.dataset->skeleton) {
    for (const Joint& joint : input.dataset->skeleton->joints) bones.push_back(joint.name);
  } else {
    for (const auto& [bone, length] : Field(*shown.front(), "bone_length_m").items()) bones.push_back(bone);
  }
  for (const std::string& bone : bones) {
    std::vector<std::string> row = {EscapeHtml(bone)};
    bool known = false;
    for (const nlohmann::json* person : shown) {
      const auto length = NumberOf(Field(*person, "bone_length_m"), bone.c_str());
      row.push_back(length ? FixedText(1e3 * *length, 1) : "–");
      known = known || length;
    }
    if (known) table.rows.push_back(row);
  }
  for (const auto& [name, key] :
       {std::pair("Height from the lowest to the highest joint, standing straight with these bones, m", "stature_m"),
        std::pair("Clips that the lengths were read from", "clips")}) {
    std::vector<std::string> row = {name};
    for (const nlohmann::json* person : shown) {
      const auto value = NumberOf(*person, key);
      row.push_back(value ? FixedText(*value, std::string(key) == "clips" ? 0 : 3) : "–");
    }
    table.rows.push_back(row);
  }
  const int left = static_cast<int>(persons.size()) - static_cast<int>(shown.size());
  return table.Html() + (left > 0 ? Paragraph("Not shown: " + Counted(left, "more set") + ".", "soft") : "");
}

}  // namespace mocurate
