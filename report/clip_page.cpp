#include "report/clip_page.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/motion.h"
#include "report/charts.h"
#include "report/html.h"
#include "report/motion_rows.h"
#include "report/page_scripts.h"
#include "report/painters.h"
#include "report/run_facts.h"
#include "report/stages.h"

namespace mocurate {
namespace {

constexpr int kViews = 6;  // over which the body is drawn, at most

const Colour& ColourOf(JointState state) {
  switch (state) {
    case JointState::kObserved:
      return kFaintColour;
    case JointState::kRepaired:
      return kBadColour;
    case JointState::kInterpolated:
      return kSuspectColour;
    default:
      return kQuietColour;
  }
}

/// States of all joints (rows) over the frames as one SVG; empty for a motion without states.
std::string StateMapSvg(const Motion& motion) {
  constexpr double kLeft = 130.0;
  constexpr double kWidth = 900.0;
  constexpr double kRow = 13.0;
  if (motion.state.empty() || motion.frame_count() == 0) return "";
  const int frames = motion.frame_count();
  const int joints = motion.joint_count();
  const double cell = (kWidth - kLeft) / frames;
  const double bottom = kRow * joints;
  Drawing drawing{kWidth, bottom + 18.0, "State of every joint over the frames"};
  for (int j = 0; j < joints; ++j) {
    drawing.Text(kLeft - 6.0, kRow * j + 10.0, motion.skeleton->joints[j].name, 10.0, TextAnchor::kEnd, kQuietColour);
    for (int f = 0; f < frames;) {
      const JointState state = motion.state[static_cast<std::size_t>(f) * joints + j];
      int end = f + 1;
      while (end < frames && motion.state[static_cast<std::size_t>(end) * joints + j] == state) ++end;
      drawing.Box(kLeft + cell * f, kRow * j + 1.0, std::max(0.6, cell * (end - f)), kRow - 2.0, ColourOf(state));
      f = end;
    }
  }
  for (const double mark : AxisMarks(0.0, frames, 8)) {
    if (mark != static_cast<int>(mark)) continue;
    drawing.Text(kLeft + cell * mark, bottom + 14.0, std::to_string(static_cast<int>(mark)), 10.0, TextAnchor::kMiddle,
                 kQuietColour);
  }
  return ToInlineSvg(drawing);
}

constexpr int kClipPlayerNumbers = 300000;
constexpr std::size_t kBonesDrawn = 3;
constexpr std::size_t kMostRepairs = 200;
constexpr int kMostCurvePoints = 1200;  ///< of a curve

using Points = std::vector<PlotPoint>;

/// A curve over time; for long ones the largest value of each interval is kept, so that no peak is lost.
Points Over(const std::vector<double>& time, const std::vector<double>& values) {
  Points points;
  const std::size_t step = (values.size() + kMostCurvePoints - 1) / kMostCurvePoints;
  for (std::size_t i = 0; i < values.size(); i += std::max<std::size_t>(1, step)) {
    std::size_t most = i;
    for (std::size_t k = i; k < std::min(values.size(), i + step); ++k) {
      if (std::isfinite(values[k]) && !(values[k] <= values[most])) most = k;
    }
    points.push_back({time[most], values[most]});
  }
  return points;
}

std::vector<double> Finite(const std::vector<double>& values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return finite;
}

std::string FramesText(int begin, int end) {
  return end - begin <= 1 ? std::to_string(begin) : std::to_string(begin) + "–" + std::to_string(end - 1);
}

double RmsOf(const std::vector<double>& values) {
  double sum = 0.0;
  const std::vector<double> finite = Finite(values);
  for (const double value : finite) sum += value * value;
  return finite.empty() ? std::nan("") : std::sqrt(sum / static_cast<double>(finite.size()));
}

std::string HeadOf(const ClipPageInput& input, const ClipSeries& series) {
  const DrawnClip& clip = input.clip;
  const Motion& motion = *clip.fitted.motion;
  std::string html = "<h1>" + EscapeHtml(clip.item) + "</h1>\n";
  std::string lead = clip.fitted.label.empty() ? "" : EscapeHtml(clip.fitted.label) + ", ";
  lead += Counted(motion.frame_count(), "frame") + " at " + ShortText(motion.rate.hz()) + " Hz, fitted on skeleton " +
          EscapeHtml(motion.skeleton->name);
  html += Paragraph(lead, "lead") + "<dl class=\"tiles\">\n";
  if (clip.fitted.fit_rms > 0.0) {
    html += Tile("Residual", FixedText(1e3 * clip.fitted.fit_rms, 1) + " mm", "RMS over the evidence used");
  }
  if (series.raw_bones) {
    double raw = 0.0;
    double fitted = 0.0;
    int bones = 0;
    for (const BoneSeries& bone : series.bones) {
      if (!std::isfinite(bone.raw_spread)) continue;
      raw += bone.raw_spread;
      fitted += bone.fitted_spread;
      ++bones;
    }
    html += Tile("Bone length deviation", FixedText(fitted / std::max(1, bones), 1) + " mm",
                 FixedText(raw / std::max(1, bones), 1) + " mm before");
  }
  if (!Finite(series.jerk_raw).empty()) {
    html += Tile("Jerk", FixedText(RmsOf(series.jerk_fitted), 0) + " m/s³",
                 FixedText(RmsOf(series.jerk_raw), 0) + " before");
  }
  if (!series.sigma_mm.empty()) {
    html += Tile("Estimated standard deviation", FixedText(RmsOf(series.sigma_mm), 1) + " mm",
                 "of a joint position, per axis");
  }
  return html + "</dl>\n";
}

std::string SeenHtml(const ClipPageInput& input) {
  const DrawnClip& clip = input.clip;
  std::string html;
  if (!input.options.video.empty()) {
    html += "<video controls preload=\"metadata\" src=\"" + EscapeHtml(input.options.video) +
            "\">The video is beside this page: " + EscapeHtml(input.options.video) + "</video>\n";
  } else if (!input.options.no_video.empty()) {
    html += Paragraph("No video: " + EscapeHtml(input.options.no_video), "soft");
  }
  const bool points = TracksOf(clip) != nullptr;
  if (points) {
    html += Figure("Before: the tracked points", ToInlineSvg(DrawFilmstrip(clip.fitted, TracksOf(clip), false)));
  }
  html += Figure("After: the fitted motion", ToInlineSvg(DrawFilmstrip(clip.fitted)));
  return html + "<div class=\"alone\">\n" + PlayerHtml(clip.item, "clip", points) + "</div>\n" +
         Paragraph(
             "<span class=\"k-before\"></span>evidence<span class=\"k-left\"></span>left side and trunk of the "
             "fit<span class=\"k-right\"></span>right side",
             "key soft");
}

std::string TimeHtml(const ClipSeries& series) {
  std::string charts;
  if (Finite(series.residual).size() == 1) {
    return Paragraph(EscapeHtml(series.residual_name) + ": " + ShortText(Finite(series.residual).front()) + ".");
  }
  if (!Finite(series.residual).empty()) {
    Plot chart{series.residual_name, "s", "", {}};
    if (!series.residual_most.empty()) {
      chart.curves.push_back({"worst joint", Over(series.time_s, series.residual_most), 5});
      chart.curves.push_back({"root mean square over joints", Over(series.time_s, series.residual), 0});
    } else {
      chart.curves.push_back({"each frame", Over(series.time_s, series.residual), 0});
    }
    charts += PlotHtml(chart);
  }
  if (!Finite(series.keypoint_residual).empty()) {
    Plot chart{series.keypoint_residual_name, "s", "", {}};
    chart.curves.push_back({"each frame", Over(series.time_s, series.keypoint_residual), 0});
    charts += PlotHtml(chart);
  }
  Plot jerk{"Jerk, root mean square over joints", "s", "m/s³", {}};
  if (!Finite(series.jerk_raw).empty()) jerk.curves.push_back({"before", Over(series.time_s, series.jerk_raw), 5});
  if (!Finite(series.jerk_fitted).empty()) jerk.curves.push_back({"after", Over(series.time_s, series.jerk_fitted), 0});
  charts += PlotHtml(jerk);
  if (charts.empty()) return Paragraph("The clip is too short for curves over time.");
  return "<div class=\"charts wide\">\n" + charts + "</div>\n" +
         Paragraph("Compare both: over-smoothed motion has low jerk and a large residual.", "soft");
}

std::string BonesHtml(const ClipSeries& series, const Skeleton& skeleton) {
  if (!series.raw_bones) {
    return Paragraph("The evidence has no joints to measure bone lengths from; the fit's bones have constant lengths.");
  }
  std::vector<const BoneSeries*> sorted;
  for (const BoneSeries& bone : series.bones) {
    if (std::isfinite(bone.raw_spread)) sorted.push_back(&bone);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const BoneSeries* a, const BoneSeries* b) { return a->raw_spread > b->raw_spread; });
  std::string charts;
  for (std::size_t i = 0; i < std::min(kBonesDrawn, sorted.size()) && series.time_s.size() > 1; ++i) {
    const BoneSeries& bone = *sorted[i];
    const std::string name =
        skeleton.joints[skeleton.joints[bone.joint].parent].name + " to " + skeleton.joints[bone.joint].name;
    const Plot chart{name + ", mm",
                     "s",
                     "mm",
                     {{"before", Over(series.time_s, bone.raw), 5}, {"after", Over(series.time_s, bone.fitted), 0}}};
    charts += PlotHtml(chart);
  }
  HtmlTable table{"All bones, mm", {"Ends at", "Before, mean", "Before, std", "After", "After, std"}};
  for (const BoneSeries* bone : sorted) {
    table.rows.push_back({EscapeHtml(skeleton.joints[bone->joint].name), FixedText(bone->raw_mean, 1),
                          FixedText(bone->raw_spread, 1), FixedText(bone->fitted.front(), 1),
                          FixedText(bone->fitted_spread, 1)});
  }
  return "<div class=\"charts wide\">\n" + charts + "</div>\n<details><summary>All bones</summary>" + table.Html() +
         "</details>\n";
}

std::string RepairsHtml(const ClipPageInput& input) {
  const Clip& fitted = input.clip.fitted;
  std::string html;
  HtmlTable table{"Corrections before the fit; each can be undone", {"Frames", "What", "Joints", "Value"}, {}, false};
  const auto repairs = fitted.provenance.find("track_repairs");
  if (repairs != fitted.provenance.end()) {
    const nlohmann::json list = ParseJson(repairs->second, "").value_or(nullptr);
    for (const nlohmann::json& repair : Elements(list)) {
      const std::vector<double> frames = NumbersOf(Field(repair, "frames"));
      if (frames.size() != 2 || table.rows.size() >= kMostRepairs) continue;
      std::string joints;
      for (const nlohmann::json& joint : Elements(Field(repair, "joints"))) {
        if (joint.is_string()) joints += (joints.empty() ? "" : ", ") + EscapeHtml(joint.get<std::string>());
      }
      const auto value = NumberOf(repair, "value");
      table.rows.push_back({FramesText(static_cast<int>(frames[0]), static_cast<int>(frames[1])),
                            EscapeHtml(TextOf(repair, "code") + " (" + TextOf(repair, "action") + ")"), joints,
                            value ? ShortText(*value) : "–"});
    }
    if (table.rows.size() < Elements(list).size()) {
      html += Paragraph(CountText(static_cast<long long>(Elements(list).size() - table.rows.size())) +
                            " more corrections are in the clip's provenance.",
                        "soft");
    }
  }
  html = (table.rows.empty() ? Paragraph("No joints were exchanged or set to missing.") : table.Html()) + html;
  HtmlTable findings{"Findings", {"Frames", "Code", "Joint", "What", "Done"}, {}, false};
  for (const Finding& finding : input.findings) {
    if (findings.rows.size() >= kMostRepairs) break;
    const bool all = finding.frame_end <= finding.frame_begin;
    findings.rows.push_back({all ? "–" : FramesText(finding.frame_begin, finding.frame_end), EscapeHtml(finding.code),
                             EscapeHtml(finding.joint), EscapeHtml(finding.message), EscapeHtml(Name(finding.action))});
  }
  if (!findings.rows.empty()) html += findings.Html();
  const std::string map = StateMapSvg(*fitted.motion);
  if (map.empty()) return html;
  return html +
         Paragraph(
             "Source of each joint over the frames: <span class=\"s-observed\"></span>"
             "observed<span class=\"s-repaired\"></span>corrected (observed as the other side)"
             "<span class=\"s-interpolated\"></span>interpolated<span class=\"s-inferred\"></span>inferred",
             "key soft") +
         map;
}

std::string SigmaHtml(const ClipSeries& series, const Motion& motion) {
  if (series.sigma_mm.empty()) return Paragraph("The fit has no uncertainty estimate.");
  const Plot chart{"Estimated standard deviation of a joint position, per axis",
                   "s",
                   "mm",
                   {{"root mean square over joints", Over(series.time_s, series.sigma_mm), 0}}};
  HtmlTable table{"Means over the frames",
                  {"Joint", "Position, mm per axis", "Largest", "Rotation, degrees", "Observable axes, of 3"}};
  const int frames = motion.frame_count();
  const int joints = motion.joint_count();
  for (int j = 0; j < joints; ++j) {
    double sum = 0.0, most = 0.0, turn = 0.0, decided = 0.0;
    for (int f = 0; f < frames; ++f) {
      const double sigma = StatedSigmaMm(motion, f, j);
      sum += sigma / frames;
      most = std::max(most, sigma);
      const std::size_t first = 3 * (static_cast<std::size_t>(f) * joints + j);
      for (std::size_t axis = first; axis < first + 3; ++axis) {
        if (!motion.rotation_sigma.empty()) turn += motion.rotation_sigma[axis] * 57.29577951308232 / (3.0 * frames);
        if (!motion.rotation_observed.empty()) decided += static_cast<double>(motion.rotation_observed[axis]) / frames;
      }
    }
    table.rows.push_back({EscapeHtml(motion.skeleton->joints[j].name), FixedText(sum, 1), FixedText(most, 1),
                          motion.rotation_sigma.empty() ? "–" : FixedText(turn, 1),
                          motion.rotation_observed.empty() ? "–" : FixedText(decided, 2)});
  }
  const std::string drawn = frames > 1 ? "<div class=\"charts wide\">" + PlotHtml(chart) + "</div>\n" : "";
  return drawn + "<details><summary>Joint by joint</summary>" + table.Html() + "</details>\n" +
         Paragraph(
             "An unobservable axis, such as the twist of a straight limb, keeps the prior's standard deviation "
             "and is uncertain.",
             "soft");
}

/// The frame in the middle and the one that fits worst.
std::vector<int> FramesToDraw(const ClipSeries& series) {
  std::vector<int> frames = {static_cast<int>(series.time_s.size()) / 2};
  const std::vector<double>& residual = series.residual;
  int worst = -1;
  for (std::size_t f = 0; f < residual.size(); ++f) {
    if (std::isfinite(residual[f]) && (worst < 0 || residual[f] > residual[worst])) worst = static_cast<int>(f);
  }
  if (worst >= 0 && worst != frames.front()) frames.push_back(worst);
  return frames;
}

std::string ViewsHtml(const ClipPageInput& input, const ClipSeries& series) {
  const Evidence& evidence = input.clip.evidence.evidence;
  const int views = ViewCount(evidence);
  if (views == 0) return "";
  const std::vector<int> frames = FramesToDraw(series), chosen = ChosenViews(evidence, kViews);
  std::string html;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    html += "<h3>Frame " + std::to_string(frames[i]) + (i == 0 ? ", the middle" : ", the worst fit") +
            "</h3>\n<div class=\"overlays\">\n";
    for (const int view : chosen) {
      html += OverlayHtml(input.clip.fitted, evidence, view, frames[i]);
    }
    html += "</div>\n";
  }
  const auto shown = static_cast<int>(chosen.size());
  if (shown < views) html += Paragraph(std::to_string(shown) + " of " + std::to_string(views) + " views.", "soft");
  return html + Paragraph(
                    "White: outline of the fitted body. Depth: near is bright. Keypoints: those of the person "
                    "yellow, other people's grey; the camera pose is that of the calibration.",
                    "soft");
}

}  // namespace

Expected<std::string> MakeClipPage(const ClipPageInput& input) {
  const auto series = SeriesOf(input.clip.fitted, input.clip.evidence.evidence);
  if (!series) return Forward(series);
  const Motion& motion = *input.clip.fitted.motion;
  std::string html = PageHead(input.clip.item + " - mocurate report", kPageStyle) +
                     "<body>\n<a class=\"skip\" href=\"#seen-section\">Skip to the content</a>\n<header>\n"
                     "<p><a href=\"index.html\">All clips of the run</a></p>\n" +
                     HeadOf(input, *series) + "</header>\n<main id=\"main\">\n";
  const auto section = [&html](const char* id, const char* title, const std::string& inside) {
    if (inside.empty()) return;
    html += "<section id=\"" + std::string(id) + "\" aria-labelledby=\"" + id + "-title\">\n<h2 id=\"" + id +
            "-title\">" + title + "</h2>\n" + inside + "</section>\n";
  };
  section("seen-section", "Before and after", SeenHtml(input));
  section("time", "Residual and jerk", TimeHtml(*series));
  section("bones", "Bone lengths", BonesHtml(*series, *motion.skeleton));
  section("repairs", "Corrections and findings", RepairsHtml(input));
  section("uncertainty", "Uncertainty", SigmaHtml(*series, motion));
  section("views", "Over the views", ViewsHtml(input, *series));
  const nlohmann::json players =
      nlohmann::json::array({PlayerData(input.clip.item, motion, TracksOf(input.clip), kClipPlayerNumbers)});
  return html + "</main>\n<footer>\n" + Paragraph("Made by " + EscapeHtml(CreatedBy()) + " from stored results.") +
         "</footer>\n<script type=\"application/json\" id=\"player-data\">" + JsonForScript(players) +
         "</script>\n<script>" + kPlayerScript + "</script>\n</body>\n</html>\n";
}

Expected<StageOutcome> ClipPageStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ClipPageOptions>(request.options, "clip_page");
  if (!options) return Forward(options);
  ClipPageInput input;
  input.options = *options;
  auto drawn = ReadDrawnClip(request, &input.findings);
  if (!drawn) return Forward(drawn);
  input.clip = std::move(*drawn);
  const auto page = MakeClipPage(input);
  if (!page) return Forward(page);
  if (Status written = WriteFile(request.output, *page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"bytes", page->size()}};
  return outcome;
}

}  // namespace mocurate
