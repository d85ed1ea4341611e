#include "report/clip_page.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/motion.h"
#include "core/quality/measures.h"
#include "report/charts.h"
#include "report/html.h"
#include "report/motion_rows.h"
#include "report/page_files.h"
#include "report/painters.h"
#include "report/run_facts.h"
#include "report/stages.h"
#include "report/viewer_data.h"
#include "report/viewer_evidence.h"

namespace mocurate {
namespace {

constexpr int kViews = 6;  // over which the body is drawn, at most
constexpr std::size_t kMostRepairs = 200;
constexpr int kMostCurvePoints = 1200;  ///< of a curve

using Points = std::vector<PlotPoint>;

/// A curve over time; for long ones the largest value of each interval is kept, so that no peak is lost.
Points Over(const Motion& motion, const std::vector<double>& values) {
  Points points;
  const std::size_t step = (values.size() + kMostCurvePoints - 1) / kMostCurvePoints;
  for (std::size_t i = 0; i < values.size(); i += std::max<std::size_t>(1, step)) {
    std::size_t most = i;
    for (std::size_t k = i; k < std::min(values.size(), i + step); ++k) {
      if (std::isfinite(values[k]) && !(values[k] <= values[most])) most = k;
    }
    points.push_back({motion.rate.FrameTime(static_cast<std::int64_t>(most)), values[most]});
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

/// Measures of the evidence's tracks, and of the fit.
struct BeforeAndAfter {
  std::optional<MotionMeasures> before;
  MotionMeasures after;
};

BeforeAndAfter Measured(const ClipPageInput& input) {
  const Motion& motion = *input.clip.fitted.motion;
  BeforeAndAfter measured{std::nullopt, MeasureMotion(motion)};
  if (const JointTracks* tracks = TracksOf(input.clip)) {
    const TracksOfJoints own = InJoints(*tracks, *motion.skeleton);
    measured.before = MeasureJoints(*motion.skeleton, own.joints, own.confidence, tracks->time_s);
  }
  return measured;
}

/// Estimated standard deviation of a joint position per axis over a clip, root mean square, millimetres.
double SigmaMm(const Motion& motion) {
  double square = 0.0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) square += std::pow(StatedSigmaMm(motion, f, j), 2);
  }
  return std::sqrt(square / motion.frame_count() / motion.joint_count());
}

std::string HeadOf(const ClipPageInput& input, const BeforeAndAfter& measured) {
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
  if (measured.before) {
    html += Tile("Bone length deviation", FixedText(measured.after.bone_spread_mm, 1) + " mm",
                 FixedText(measured.before->bone_spread_mm, 1) + " mm before") +
            Tile("Jerk", FixedText(measured.after.jerk, 0) + " m/s³", FixedText(measured.before->jerk, 0) + " before");
  }
  if (!motion.position_cov.empty()) {
    html +=
        Tile("Estimated standard deviation", FixedText(SigmaMm(motion), 1) + " mm", "of a joint position, per axis");
  }
  return html + "</dl>\n";
}

std::string SeenHtml(const ClipPageInput& input) {
  const DrawnClip& clip = input.clip;
  std::string html;
  if (!input.options.video.empty()) {
    html += "<video controls preload=\"none\" src=\"" + EscapeHtml(input.options.video) +
            "\" poster=\"data:image/svg+xml;base64," + Base64(ToSvg(DrawFilmstrip(clip.fitted))) +
            "\">The video is beside this page: " + EscapeHtml(input.options.video) + "</video>\n";
  } else if (!input.options.no_video.empty()) {
    html += Paragraph("No video: " + EscapeHtml(input.options.no_video), "soft");
  }
  const bool points = TracksOf(clip) != nullptr;
  if (points) {
    html += Figure("Before: the tracked points", ToInlineSvg(DrawFilmstrip(clip.fitted, TracksOf(clip), false)));
  }
  html += Figure("After: the fitted motion", ToInlineSvg(DrawFilmstrip(clip.fitted)));
  return html + "<div id=\"viewer\"></div>\n<noscript>" +
         Paragraph("The viewer needs JavaScript, which is switched off.") + "</noscript>\n";
}

/// The clip for the viewer of the page: its index, and the frames as text.
std::pair<nlohmann::json, std::vector<std::string>> ViewedMotion(const ClipPageInput& input) {
  std::vector<std::string> parts;
  ViewerData data([&](int, const std::string& bytes) {
    parts.push_back(Base64(bytes));
    return Status();
  });
  const Clip& clip = input.clip.fitted;
  std::optional<JointTracks> tracks;
  if (TracksOf(input.clip) != nullptr) tracks = TracksOfClip(clip, input.clip.evidence);
  ViewedClip viewed{clip, FindingsOf(clip, {{clip.id(), input.findings}})};
  viewed.tracks = tracks ? &*tracks : nullptr;
  data.AddSource(input.clip.item);
  (void)data.Add(0, viewed);  // the sink has no errors
  (void)data.Finish();
  nlohmann::json index = data.Index();
  index["embedded"] = "inside";
  return {std::move(index), std::move(parts)};
}

std::string TimeHtml(const ClipSeries& series, const Motion& motion) {
  std::string charts;
  if (Finite(series.residual).size() == 1) {
    return Paragraph(EscapeHtml(series.residual_name) + ": " + ShortText(Finite(series.residual).front()) + ".");
  }
  if (!Finite(series.residual).empty()) {
    Plot chart{series.residual_name, "s", "", {}};
    if (!series.residual_most.empty()) {
      chart.curves.push_back({"worst joint", Over(motion, series.residual_most), 5});
      chart.curves.push_back({"root mean square over joints", Over(motion, series.residual), 0});
    } else {
      chart.curves.push_back({"each frame", Over(motion, series.residual), 0});
    }
    charts += PlotHtml(chart);
  }
  if (!Finite(series.keypoint_residual).empty()) {
    Plot chart{series.keypoint_residual_name, "s", "", {}};
    chart.curves.push_back({"each frame", Over(motion, series.keypoint_residual), 0});
    charts += PlotHtml(chart);
  }
  return charts.empty() ? Paragraph("The evidence has no points to compare with, frame by frame.")
                        : "<div class=\"charts wide\">\n" + charts + "</div>\n";
}

std::string BonesHtml(const BeforeAndAfter& measured, const Skeleton& skeleton) {
  if (!measured.before) {
    return Paragraph("The evidence has no joints to measure bone lengths from; the fit's bones have constant lengths.");
  }
  HtmlTable table{"Standard deviation of each bone's length over the frames, mm", {"Ends at", "Before", "After"}};
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const double before = measured.before->bone_spreads_mm[static_cast<std::size_t>(j)];
    if (before <= 0.0) continue;
    table.rows.push_back({EscapeHtml(skeleton.joints[j].name), FixedText(before, 1),
                          FixedText(measured.after.bone_spreads_mm[static_cast<std::size_t>(j)], 1)});
  }
  return table.Html();
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
  return (table.rows.empty() ? Paragraph("No joints were exchanged or set to missing.") : table.Html()) + html;
}

std::string SigmaHtml(const Motion& motion) {
  if (motion.position_cov.empty()) return Paragraph("The fit has no uncertainty estimate.");
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
  return table.Html() +
         Paragraph(
             "An unobservable axis, such as the twist of a straight limb, keeps the prior's standard deviation "
             "and is uncertain.",
             "soft");
}

/// The frame in the middle and the one that fits worst.
std::vector<int> FramesToDraw(const ClipSeries& series, int middle) {
  std::vector<int> frames = {middle};
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
  const std::vector<int> frames = FramesToDraw(series, input.clip.fitted.motion->frame_count() / 2),
                         chosen = ChosenViews(evidence, kViews);
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
  const BeforeAndAfter measured = Measured(input);
  std::string html = PageHead(input.clip.item + " - mocurate report", PageStyles({"viewer.css"})) +
                     "<body>\n<a class=\"skip\" href=\"#seen-section\">Skip to the content</a>\n<header>\n"
                     "<p><a href=\"index.html\">All clips of the run</a></p>\n" +
                     HeadOf(input, measured) + "</header>\n<main id=\"main\">\n";
  const auto section = [&html](const char* id, const char* title, const std::string& inside) {
    if (inside.empty()) return;
    html += "<section id=\"" + std::string(id) + "\" aria-labelledby=\"" + id + "-title\">\n<h2 id=\"" + id +
            "-title\">" + title + "</h2>\n" + inside + "</section>\n";
  };
  section("seen-section", "Before and after", SeenHtml(input));
  section("time", "Residual over time", TimeHtml(*series, motion));
  section("bones", "Bone lengths", BonesHtml(measured, *motion.skeleton));
  section("repairs", "Corrections", RepairsHtml(input));
  section("uncertainty", "Uncertainty", SigmaHtml(motion));
  section("views", "Over the views", ViewsHtml(input, *series));
  const auto [index, parts] = ViewedMotion(input);
  return html + "</main>\n<footer>\n" + Paragraph("Made by " + EscapeHtml(CreatedBy()) + " from stored results.") +
         "</footer>\n" + ViewerHtml(index, parts, {"open.js"}) + "</body>\n</html>\n";
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
