#include "ingest/checks/pose_checks.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestFrames = 5;
constexpr std::size_t kMostSpans = 20;
constexpr std::size_t kFirstColumn = 3, kColumnsOfBody = 66;  // root, 21 joints of the body

class FrozenPoses {
 public:
  explicit FrozenPoses(const Amass& amass) : amass_(amass) {}

  bool SamePose(std::size_t f) const {
    const std::size_t last = std::min(kColumnsOfBody, amass_.pose_columns);
    return Same(amass_.poses, amass_.pose_columns, f, kFirstColumn, last);
  }
  bool SamePlace(std::size_t f) const { return Same(amass_.translation_m, 3, f, 0, 3); }
  bool AllZero(std::size_t f) const {
    const auto row = amass_.poses.begin() + static_cast<std::ptrdiff_t>(f * amass_.pose_columns);
    return std::all_of(row + kFirstColumn, row + std::min<std::ptrdiff_t>(kColumnsOfBody, amass_.pose_columns),
                       [](double value) { return value == 0.0; });
  }
  bool Damaged(std::size_t f) const {
    return std::binary_search(amass_.damaged.begin(), amass_.damaged.end(), static_cast<int>(f));
  }

 private:
  /// Columns [first, last) of frame f and of the one before.
  static bool Same(const std::vector<double>& values, std::size_t wide, std::size_t f, std::size_t first,
                   std::size_t last) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(f * wide);
    const auto before = row - static_cast<std::ptrdiff_t>(wide);
    return std::equal(row + first, row + last, before + first);
  }

  const Amass& amass_;
};

/// `carried`: while the root goes on.
Finding FrozenPose(bool zero, bool carried, std::size_t begin, std::size_t end, std::size_t frames) {
  Finding finding =
      FrameFinding("frozen_pose", static_cast<int>(begin), static_cast<int>(end), "", static_cast<double>(end - begin),
                   (zero ? "all rotations of the body are 0 in " : "no joint of the body turns in ") +
                       Counted(static_cast<long long>(end - begin), "frame") + " on end (" + std::to_string(begin) +
                       "-" + std::to_string(end) + (carried ? "), while `trans` carries it on: " : "): ") +
                       (zero ? "the poses are not there" : "the poses are repeated or of another file") +
                       "; copy the file again, or leave these frames out");
  if (2 * (end - begin) >= frames) finding.severity = Severity::kError;
  return finding;
}

}  // namespace

std::vector<Finding> CheckFrozenPoses(const Amass& amass) {
  std::vector<Finding> findings;
  const FrozenPoses poses(amass);
  if (amass.pose_columns <= kFirstColumn) return findings;
  for (std::size_t begin = 0, f = 1; begin < amass.frames; begin = f, ++f) {
    std::size_t moved = 0;
    for (; f < amass.frames && poses.SamePose(f) && !poses.Damaged(f) && !poses.Damaged(f - 1); ++f)
      moved += poses.SamePlace(f) ? 0 : 1;
    const std::size_t held = f - begin;
    const bool zero = poses.AllZero(begin) && !poses.Damaged(begin), carried = held > 1 && 2 * moved >= held - 1;
    const bool blank = zero && held < amass.frames;
    if ((blank || (held >= kFewestFrames && carried)) && findings.size() < kMostSpans)
      findings.push_back(FrozenPose(zero, carried, begin, f, amass.frames));
  }
  return findings;
}

std::optional<Finding> CheckTranslations(const Amass& amass) {
  const FrozenPoses poses(amass);
  bool turns = false;
  for (std::size_t f = 1; f < amass.frames && !turns; ++f)
    turns = amass.pose_columns > kFirstColumn && !poses.SamePose(f);
  const auto zero = [](double value) { return value == 0.0; };
  if (!turns || amass.frames < kFewestFrames || !amass.damaged.empty() ||
      !std::all_of(amass.translation_m.begin(), amass.translation_m.end(), zero))
    return std::nullopt;
  const int frames = static_cast<int>(amass.frames);
  return FrameFinding("path_missing", 0, frames, "", frames,
                      "`trans` is 0 0 0 in every one of " + Counted(frames, "frame") +
                          ", while the body turns: the file does not say where the body goes; copy the file again, or "
                          "use its rotations alone");
}

std::optional<Finding> CheckMarkers(const Amass& amass, const JointPositions& posed) {
  constexpr int kFrames = 50;  // looked at, all over the clip
  std::vector<double> ratios;
  const int step = std::max(1, posed.frames / kFrames);
  JointPositions markers(static_cast<int>(amass.frames), static_cast<int>(amass.markers));
  markers.xyz = amass.marker_data_m;
  const std::vector<double> seen(amass.marker_observed.begin(), amass.marker_observed.end()), all, times;
  const TrackedPoints of_markers{markers, seen, times}, of_body{posed, all, times};
  for (int f = 0; f < std::min(posed.frames, markers.frames); f += step) {
    const auto extent = of_markers.Extent(f, 3), body = of_body.Extent(f, 3);
    if (extent && body && *extent > 0.0 && *body > 0.0) ratios.push_back(*extent / *body);
  }
  if (ratios.empty()) return std::nullopt;
  const double ratio = Median(std::move(ratios)), factor = std::pow(10.0, std::round(std::log10(ratio)));
  if (factor == 1.0) return std::nullopt;
  const char* unit = factor == 1000.0 ? " (millimetres)" : factor == 100.0 ? " (centimetres)" : "";
  return MakeFinding("units_contradiction", Severity::kError, ratio,
                     "`marker_data` is " + Digits(ratio) +
                         " times as large as the body that `poses` and `trans` give: AMASS has metres, "
                         "these numbers are to be divided by " +
                         FormatDouble(factor) + unit + "; the body is looked at without them");
}

}  // namespace mocurate
