#include "fitting/association/rig_view.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "fitting/triangulation/normal_equations3.h"

namespace mocurate {
namespace {

constexpr double kInlierShare = 0.04;       ///< of the distance from the camera: rays farther off are outliers
constexpr double kRobustScaleShare = 0.02;  ///< of the distance from the camera: scale of the robust weight

struct Ray {
  const RigView* view = nullptr;
  Vector2d normalised = Vector2d::Zero();
  Vector3d direction = Vector3d::Zero();
  double weight = 0.0;
};

Vector3d NearestToSights(const std::vector<Ray>& rays, const std::vector<double>& weight) {
  NormalEquations3 equations;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    equations.AddAcross(weight[i], rays[i].direction, rays[i].view->camera.centre);
  }
  Vector3d point = Vector3d::Constant(std::nan(""));
  equations.Solve(point);
  return point;
}

bool AllSightsParallel(const std::vector<Ray>& rays) {
  for (std::size_t i = 1; i < rays.size(); ++i) {
    if (rays[0].direction.cross(rays[i].direction).norm() >= kParallelRays) return false;
  }
  return true;
}

/// The point nearest to the rays. Returns false when it lies in front of fewer than two cameras.
bool Meet(const std::vector<Ray>& rays, std::vector<double>& weight, Vector3d& point) {
  if (rays.size() < 2 || AllSightsParallel(rays)) return false;
  weight.clear();
  for (const Ray& ray : rays) weight.push_back(ray.weight);
  point = NearestToSights(rays, weight);
  for (std::size_t i = 0; rays.size() > 2 && i < rays.size(); ++i) {
    const double off = OffTheRay(*rays[i].view, rays[i].normalised, point);
    const double distance = (point - rays[i].view->camera.centre).norm();
    const double robust_weight =
        off == kNoMatch ? 1e-3 : 1.0 / (1.0 + std::pow(off / (kRobustScaleShare * distance), 2));
    weight[i] = rays[i].weight * robust_weight * robust_weight;
  }
  if (rays.size() > 2) point = NearestToSights(rays, weight);
  if (!point.allFinite()) return false;
  int near = 0;
  for (const Ray& ray : rays) {
    const double distance = (point - ray.view->camera.centre).norm();
    near += OffTheRay(*ray.view, ray.normalised, point) < kInlierShare * distance ? 1 : 0;
  }
  return near >= 2;
}

}  // namespace

RigView::RigView(const KeypointView& view, int keypoint_count, double min_confidence)
    : camera(view.camera), time_s(view.time_s), people(view.people), keypoints(keypoint_count) {
  const std::size_t points = time_s.size() * static_cast<std::size_t>(people) * static_cast<std::size_t>(keypoints);
  normalised.assign(points, Vector2d::Zero());
  confidence.assign(points, 0.0);
  seen.assign(time_s.size() * static_cast<std::size_t>(people), 0);
  for (std::size_t i = 0; i < points; ++i) {
    const double sure = view.values[3 * i + 2];
    if (!(sure > 0.0) || sure < min_confidence) continue;
    const Vector2d pixel(view.values[3 * i], view.values[3 * i + 1]);
    normalised[i] = view.camera.Unproject(pixel, 1.0).head<2>();
    if (!normalised[i].allFinite()) continue;
    confidence[i] = sure;
    ++seen[i / static_cast<std::size_t>(keypoints)];
  }
}

RigView RigView::Frames(int begin, int end) const {
  const auto cut = [&](const auto& values, std::size_t numbers) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin * numbers);
    return std::decay_t<decltype(values)>(first, first + static_cast<std::ptrdiff_t>((end - begin) * numbers));
  };
  RigView part = *this;
  part.time_s = cut(time_s, 1);
  part.normalised = cut(normalised, Point(1, 0, 0));
  part.confidence = cut(confidence, Point(1, 0, 0));
  part.seen = cut(seen, Entry(1, 0));
  return part;
}

int BodyPoints::KnownCount() const { return static_cast<int>(std::count(known.begin(), known.end(), 1)); }

void BodyPoints::MeasureExtent() {
  Vector3d low = Vector3d::Constant(kNoMatch);
  Vector3d high = Vector3d::Constant(-kNoMatch);
  for (std::size_t k = 0; k < position.size(); ++k) {
    if (known[k] == 0) continue;
    low = low.cwiseMin(position[k]);
    high = high.cwiseMax(position[k]);
  }
  extent = KnownCount() > 0 ? (high - low).norm() : 0.0;
}

double OffTheRay(const RigView& view, const Vector2d& normalised, const Vector3d& point) {
  const Vector3d in_camera = view.camera.rotation * (point - view.camera.centre);
  if (!(in_camera.z() > 0.0)) return kNoMatch;
  return (in_camera.head<2>() - in_camera.z() * normalised).norm();
}

double EntryDistance(const RigView& view, int frame, int person, const BodyPoints& body, int least) {
  constexpr int kMost = 64;  ///< keypoints in a buffer on the stack (numerical)
  double off[kMost];
  int count = 0;
  const std::size_t first = view.Point(frame, person, 0);
  for (int k = 0; k < view.keypoints && count < kMost; ++k) {
    const std::size_t at = first + static_cast<std::size_t>(k);
    if (body.known[static_cast<std::size_t>(k)] == 0 || view.confidence[at] <= 0.0) continue;
    off[count++] = OffTheRay(view, view.normalised[at], body.position[static_cast<std::size_t>(k)]);
  }
  if (count < std::max(least, 1)) return kNoMatch;
  std::nth_element(off, off + count / 2, off + count);
  return off[count / 2];
}

BodyPoints NearestBody(const std::vector<RigView>& rig, const std::vector<Sight>& sights) {
  BodyPoints body;
  const int keypoints = rig.empty() ? 0 : rig[0].keypoints;
  body.position.assign(static_cast<std::size_t>(keypoints), Vector3d::Zero());
  body.known.assign(static_cast<std::size_t>(keypoints), 0);
  std::vector<Ray> rays;
  std::vector<double> weight;
  for (int k = 0; k < keypoints; ++k) {
    rays.clear();
    for (const Sight& sight : sights) {
      const RigView& view = rig[static_cast<std::size_t>(sight.view)];
      const std::size_t at = view.Point(sight.frame, sight.person, k);
      if (view.confidence[at] <= 0.0) continue;
      const Vector3d in_camera(view.normalised[at].x(), view.normalised[at].y(), 1.0);
      rays.push_back({&view, view.normalised[at], (view.camera.rotation.transpose() * in_camera).normalized(),
                      view.confidence[at]});
    }
    Vector3d point;
    if (!Meet(rays, weight, point)) continue;
    body.position[static_cast<std::size_t>(k)] = point;
    body.known[static_cast<std::size_t>(k)] = 1;
  }
  body.MeasureExtent();
  return body;
}

namespace {

constexpr int kMomentsDiagnosed = 40;  ///< moments to diagnose, evenly spread over the take (numerical)

constexpr double kParallelAngle = 2.0;  ///< degrees; below, depth is nearly undetermined

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

}  // namespace mocurate
