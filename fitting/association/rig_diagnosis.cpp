#include "fitting/association/rig_diagnosis.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {
namespace {

constexpr int kMomentsDiagnosed = 40;  ///< moments to diagnose, evenly spread over the take (numerical)

constexpr double kParallelAngle = 2.0;      ///< degrees; below, depth is nearly undetermined
constexpr double kSmallestRigPerson = 0.4;  ///< share of the rest pose's size; a toddler has 0.45
constexpr double kLargestRigPerson = 1.6;   ///< share of the rest pose's size, at most
/// Log ratio, absolute, mean over the lengths: beyond, the proportions are no person's; people have up to 0.15.
constexpr double kImplausible = 0.3;
constexpr int kLengthsToDiagnose = 4;  ///< lengths that a diagnosis needs

/// Rays of two entries, compared keypoint by keypoint.
struct PairRays {
  std::vector<double> angle;  ///< degrees
  std::vector<double> px;     ///< distance of the nearest point from the rays, in the first view
  int behind = 0;             ///< nearest points behind a camera
  int count = 0;
};

void AddPair(const RigView& a, const RigView& b, const Sight& at, const Sight& there, PairRays& rays) {
  for (int k = 0; k < a.keypoints; ++k) {
    const std::size_t i = a.Point(at.frame, at.person, k);
    const std::size_t j = b.Point(there.frame, there.person, k);
    if (a.confidence[i] <= 0.0 || b.confidence[j] <= 0.0) continue;
    const Vector2d& n = a.normalised[i];
    const Vector2d& m = b.normalised[j];
    const Vector3d u = (a.camera.rotation.transpose() * Vector3d(n.x(), n.y(), 1.0)).normalized();
    const Vector3d w = (b.camera.rotation.transpose() * Vector3d(m.x(), m.y(), 1.0)).normalized();
    const double sine = u.cross(w).norm();
    ++rays.count;
    rays.angle.push_back(kDegrees * std::atan2(sine, std::abs(u.dot(w))));
    if (sine < 1e-6) continue;
    const Vector3d base = b.camera.centre - a.camera.centre;
    const double c = u.dot(w);
    const double s = (base.dot(u) - c * base.dot(w)) / (sine * sine);
    const double t = (c * base.dot(u) - base.dot(w)) / (sine * sine);
    if (s <= 0.0 || t <= 0.0) ++rays.behind;
    const Vector3d gap = (a.camera.centre + s * u) - (b.camera.centre + t * w);
    rays.px.push_back(0.5 * gap.norm() / std::max(std::abs(s), 1e-9) * a.camera.camera.fx);
  }
}

int ViewFrameAt(const RigView& view, double moment, double reach) {
  const auto next = std::lower_bound(view.time_s.begin(), view.time_s.end(), moment - reach);
  if (next == view.time_s.end() || std::abs(*next - moment) > reach) return -1;
  return static_cast<int>(next - view.time_s.begin());
}

/// The entry with the most keypoints; -1: none.
int FullestEntry(const RigView& view, int frame) {
  int best = -1;
  int most = 0;
  for (int p = 0; p < view.people; ++p) {
    const int seen = view.seen[view.Entry(frame, p)];
    if (seen <= most) continue;
    most = seen;
    best = p;
  }
  return best;
}

Error Because(const std::string& what, const std::string& hint) {
  return {ErrorCode::kInconsistent, what, "keypoints", hint};
}

}  // namespace

Error WhyNoPerson(const std::vector<RigView>& rig) {
  PairRays all;
  std::size_t entries = 0;
  for (const RigView& view : rig) {
    entries +=
        static_cast<std::size_t>(std::count_if(view.seen.begin(), view.seen.end(), [](int seen) { return seen > 0; }));
  }
  if (entries == 0) {
    return Because("no view shows a person",
                   "exclude the clip, or lower "
                   "fitting.keypoints.triangulation.min_confidence");
  }
  for (std::size_t v = 0; v < rig.size(); ++v) {
    const RigView& a = rig[v];
    const RigView& b = rig[(v + 1) % rig.size()];
    const int step = std::max(1, a.frames() / kMomentsDiagnosed);
    for (int f = 0; f < a.frames(); f += step) {
      const double reach = a.frames() > 1 ? 0.6 * (a.time_s.back() - a.time_s.front()) / (a.frames() - 1) : 1e-3;
      const int there = ViewFrameAt(b, a.time_s[static_cast<std::size_t>(f)], reach);
      const int one = FullestEntry(a, f);
      const int other = there < 0 ? -1 : FullestEntry(b, there);
      if (one < 0 || other < 0) continue;
      AddPair(a, b, {0, f, one}, {0, there, other}, all);
    }
  }
  if (all.count == 0) {
    return Because("no two views show the same keypoint at the same time, among " +
                       Counted(static_cast<long long>(entries), "detection"),
                   "compare the time stamps of the views");
  }
  const double angle = MeanMedian(all.angle);
  const double px = MeanMedian(all.px);
  const double behind = static_cast<double>(all.behind) / all.count;
  if (angle < kParallelAngle) {
    return Because("the cameras view the person along nearly the same line: rays of neighbouring views differ by " +
                       RoundedText(angle) + " degrees (median), so that depth is undetermined",
                   "give views at least 20 degrees apart");
  }
  if (behind > 0.5) {
    return Because(
        std::to_string(std::lround(100.0 * behind)) + " % of the keypoints lie behind the cameras that observe them",
        "check whether the calibration's R and t map world to camera or camera to world; they are probably inverted");
  }
  return Because("no two views agree on a person: rays to the same keypoint miss each other by " + RoundedText(px, 3) +
                     " px (median)",
                 "check that the calibration is of this recording, and that each camera has its own file");
}

std::optional<UnitMisreading> FindUnit(double scale) {
  if (scale >= kSmallestRigPerson && scale <= kLargestRigPerson) return {};
  /// Factor of the measured size for each wrong unit (numerical).
  constexpr std::pair<double, const char*> kUnits[] = {
      {1000.0, "millimetres read as metres"},    {100.0, "centimetres read as metres"},
      {39.37, "inches read as metres"},          {3.281, "feet read as metres"},
      {10.0, "millimetres read as centimetres"}, {0.1, "centimetres read as millimetres"},
      {0.01, "metres read as centimetres"},      {0.001, "metres read as millimetres"}};
  std::optional<UnitMisreading> unit;
  double nearest = std::log(1.6);
  for (const auto& [factor, text] : kUnits) {
    const double off = std::abs(std::log(scale / factor));
    if (off >= nearest) continue;
    nearest = off;
    unit = {factor, text};
  }
  return unit;
}

Status CheckPersonShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths) {
  const ShapeMatch shape = CompareShape(measured, lengths);
  if (shape.lengths < kLengthsToDiagnose) return {};
  std::size_t worst = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (measured[i] <= 0.0) continue;
    const double off = std::abs(std::log(measured[i] / (shape.scale * lengths[i].rest)));
    if (off > most) worst = i, most = off;
  }
  if (shape.mismatch > kImplausible) {
    return tl::unexpected<Error>(Because(
        "the limbs have implausible proportions: " + lengths[worst].name + " is " + RoundedText(measured[worst], 3) +
            " m, the other lengths predict " + RoundedText(shape.scale * lengths[worst].rest, 3) +
            " m; mean deviation by a factor of " + RoundedText(std::exp(shape.mismatch), 3),
        "check that the keypoint names have the detector's order (BODY_25, BODY_25B, COCO_17 ...)"));
  }
  if (shape.scale >= kSmallestRigPerson && shape.scale <= kLargestRigPerson) return {};
  const auto unit = FindUnit(shape.scale);
  return tl::unexpected<Error>(Because("the person would be " + RoundedText(shape.scale, 3) +
                                           " times a person's size (" + lengths[worst].name + " " +
                                           RoundedText(measured[worst], 3) + " m)",
                                       unit ? "the calibration looks like " + unit->text +
                                                  ": declare its unit, or set fitting.keypoints.audit.unit to correct"
                                            : "check the calibration's unit"));
}

}  // namespace mocurate
