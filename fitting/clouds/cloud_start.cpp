#include "fitting/clouds/cloud_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/pi.h"

namespace mocurate {
namespace {

/// Initial headings, evenly spaced (numerical).
constexpr int kHeadings = 8;
/// rad relative to a given facing: initial headings (numerical).
constexpr std::array<double, 4> kAboutTheFacing = {-0.6, -0.2, 0.2, 0.6};
constexpr double kFacingError = 1.4;  ///< rad; larger deviations from the given facing contradict it
constexpr double kTaller = 1.35;      ///< ratio of the heights of stance and points, above which a part is hidden
/// Factor on the distance limit of the matches (numerical).
constexpr double kWidening = 2.0;
constexpr std::size_t kFinalists = 6;  ///< starts that the last round refines, at most (numerical)
constexpr double kSameHeading = 0.6;   ///< rad; finalists differ by more, or started with other legs
constexpr double kOtherHeading = 1.6;  ///< rad; from here the opposite direction

/// Rounds of the search: points and matchings per start, and the share of starts that continues.
struct Round {
  int points;
  int matchings;
  double kept;
};
/// Rounds of the search: points, matchings per start, share of the starts that continues (numerical).
constexpr std::array<Round, 2> kStartRounds = {{{300, 6, 0.4}, {600, 15, 1.0}}};

enum class Legs { kStanding, kLeftStep, kRightStep, kSquatting, kSeated };
enum class Arms { kDown, kOut, kUp, kForward };

struct Stance {
  Legs legs;
  Arms arms;
};
/// Stances of the first pose, each tried in every heading (numerical).
constexpr std::array<Stance, 12> kStances = {{{Legs::kStanding, Arms::kDown},
                                              {Legs::kStanding, Arms::kOut},
                                              {Legs::kStanding, Arms::kUp},
                                              {Legs::kStanding, Arms::kForward},
                                              {Legs::kLeftStep, Arms::kDown},
                                              {Legs::kRightStep, Arms::kDown},
                                              {Legs::kSquatting, Arms::kDown},
                                              {Legs::kSquatting, Arms::kForward},
                                              {Legs::kSeated, Arms::kDown},
                                              {Legs::kSeated, Arms::kForward},
                                              {Legs::kSeated, Arms::kOut},
                                              {Legs::kSeated, Arms::kUp}}};

void BendLegs(const Skeleton& skeleton, Legs legs, int frame, PoseState& state) {
  const auto hips = LegsOfBody(skeleton);
  if (!hips || legs == Legs::kStanding) return;
  const auto children = skeleton.Children();
  for (const int side : {0, 1}) {
    const bool ahead = (legs == Legs::kLeftStep) == (side == 0);
    const double hip = legs == Legs::kSeated ? -1.45 : legs == Legs::kSquatting ? -1.2 : ahead ? -0.4 : 0.3;
    const double knee = legs == Legs::kSeated ? 1.4 : legs == Legs::kSquatting ? 1.6 : 0.3;
    const int lower = OnlyChild(children, (*hips)[side]);
    if (lower < 0) continue;
    state.rotation(frame, (*hips)[side])[0] = hip;
    if (state.active(lower)) state.rotation(frame, lower)[0] = knee;
  }
}

void SwingArms(const Skeleton& skeleton, Arms arms, int frame, PoseState& state) {
  const auto shoulders = skeleton.Shoulders();
  if (!shoulders) return;
  for (const int side : {0, 1}) {
    double* angles = state.rotation(frame, (*shoulders)[side]);
    const double sign = side == 0 ? -1.0 : 1.0;
    if (arms == Arms::kForward) {
      angles[1] = 1.2 * sign;
    } else {
      angles[2] = sign * (arms == Arms::kDown ? 1.3 : arms == Arms::kOut ? 0.2 : -1.0);
    }
  }
}

/// Approximate mean position of a posed body's surface.
Vector3d MiddleOf(const CapsuleBody& body, const PoseState& state, int frame) {
  Vector3d sum = Vector3d::Zero();
  double area = 0.0;
  for (const BodyCapsule& capsule : body.capsules) {
    const CapsuleEnds ends = EndsOf(capsule, state, frame);
    const double share = capsule.radius * ((ends.end - ends.begin).norm() + 2.0 * capsule.radius);
    sum += 0.5 * share * (ends.begin + ends.end);
    area += share;
  }
  return sum / area;
}

/// A stance with heading `heading` about y, centred in the points.
void SetStance(const CapsuleBody& body, const FusedCloud& cloud, int frame, double heading, const Stance& stance,
               PoseState& state) {
  std::fill(state.translation(frame), state.rotation(frame, 0), 0.0);
  for (int j = 0; j < state.joints(); ++j) Eigen::Map<Vector3d>(state.rotation(frame, j)).setZero();
  state.rotation(frame, 0)[1] = heading;
  BendLegs(*body.skeleton, stance.legs, frame, state);
  SwingArms(*body.skeleton, stance.arms, frame, state);
  state.Update(frame, frame + 1, false);
  const HeightSpan of_body = HeightOf(body, state, frame);
  const HeightSpan of_cloud = HeightOf(cloud.points);
  const Vector3d across = cloud.points.rowwise().mean() - MiddleOf(body, state, frame);
  // When a part is hidden, assume that the upper part is visible.
  const double up = of_body.height() > kTaller * of_cloud.height()
                        ? of_cloud.high - of_body.high
                        : 0.5 * (of_cloud.low + of_cloud.high - of_body.low - of_body.high);
  Eigen::Map<Vector3d>(state.translation(frame)) = Vector3d(across.x(), up, across.z());
}

struct Candidate {
  bool contradicts = false;  ///< the given facing
  double cost = 0.0;
  double heading = 0.0;
  Legs legs = Legs::kStanding;
  std::vector<double> parameters;
};

Status RefineCandidate(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                       const PointCloudOptions& options, PoseState& state, Candidate& candidate) {
  const auto fitted = FitCloudFrame(body, cloud, fit, state, options);
  if (!fitted) return Forward(fitted);
  candidate.cost = PoseCost(body, cloud, fit, state, options);
  candidate.heading = HeadingOf(state, fit.frame);
  candidate.parameters = state.FrameParameters(fit.frame);
  return {};
}

double HeadingsApart(double heading, double other) { return std::abs(std::remainder(heading - other, 2.0 * kPi)); }

void SortByCost(std::vector<Candidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::make_pair(a.contradicts, a.cost) < std::make_pair(b.contradicts, b.cost);
  });
}

/// The best of the sorted candidates from `begin` on that faces away from the first of all; null where that contradicts
/// the given facing.
const Candidate* BestFacingAway(const std::vector<Candidate>& candidates, std::size_t begin) {
  for (std::size_t i = begin; i < candidates.size(); ++i) {
    if (HeadingsApart(candidates[i].heading, candidates[0].heading) < kOtherHeading) continue;
    return candidates[i].contradicts ? nullptr : &candidates[i];
  }
  return nullptr;
}

/// Appends the best candidate that faces away, unless `chosen` has one: front and back are compared after a full fit.
void AddFacingAway(const std::vector<Candidate>& candidates, std::vector<Candidate>& chosen) {
  if (BestFacingAway(chosen, 1) != nullptr) return;
  if (const Candidate* other = BestFacingAway(candidates, 1)) chosen.push_back(*other);
}

/// The cheapest candidates that face in different directions or started with other legs; one faces away if any does.
std::vector<Candidate> Finalists(const std::vector<Candidate>& candidates) {
  std::vector<Candidate> finalists;
  for (const Candidate& candidate : candidates) {
    const bool is_new = std::none_of(finalists.begin(), finalists.end(), [&](const Candidate& other) {
      return candidate.legs == other.legs && HeadingsApart(candidate.heading, other.heading) < kSameHeading;
    });
    if (is_new && finalists.size() < kFinalists) finalists.push_back(candidate);
  }
  AddFacingAway(candidates, finalists);
  return finalists;
}

bool IsWanted(const Stance& stance, StartPosture posture) {
  if (posture == StartPosture::kSeated) return stance.legs == Legs::kSeated;
  if (posture == StartPosture::kStanding) return stance.legs != Legs::kSeated && stance.legs != Legs::kSquatting;
  return true;
}

std::vector<Candidate> Starts(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                              const CloudStartOptions& options, PoseState& state) {
  std::vector<double> headings;
  for (int h = 0; !options.facing && h < kHeadings; ++h) headings.push_back(2.0 * kPi * h / kHeadings);
  for (const double off : kAboutTheFacing) {
    if (options.facing) headings.push_back(*options.facing + off);
  }
  std::vector<Candidate> starts;
  for (const double heading : headings) {
    for (const Stance& stance : kStances) {
      if (!IsWanted(stance, options.posture)) continue;
      SetStance(body, cloud, frame, heading, stance, state);
      starts.push_back({false, 0.0, heading, stance.legs, state.FrameParameters(frame)});
    }
  }
  return starts;
}

}  // namespace

double HeadingOf(const PoseState& state, int frame) {
  const Vector3d front = state.global(frame, 0).col(2);
  return std::atan2(front.x(), front.z());
}

HeightSpan HeightOf(const Eigen::Matrix3Xd& points) {
  std::vector<double> y(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) y[i] = points(1, i);
  std::sort(y.begin(), y.end());
  const std::size_t stray = y.size() / 2000;
  return {y[stray], y[y.size() - 1 - stray]};
}

HeightSpan HeightOf(const CapsuleBody& body, const PoseState& state, int frame) {
  HeightSpan span{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const BodyCapsule& capsule : body.capsules) {
    const CapsuleEnds ends = EndsOf(capsule, state, frame);
    span.low = std::min({span.low, ends.begin.y() - capsule.radius, ends.end.y() - capsule.radius});
    span.high = std::max({span.high, ends.begin.y() + capsule.radius, ends.end.y() + capsule.radius});
  }
  return span;
}

Expected<CloudStart> FindStart(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                               const PointCloudOptions& options, PoseState& state, StartSearch search) {
  std::vector<Candidate> candidates = Starts(body, cloud, frame, options.start, state);
  const auto contradicts = [&](double heading) {
    return options.start.facing && HeadingsApart(heading, *options.start.facing) > kFacingError;
  };
  const auto refine = [&](const FusedCloud& points, const FrameFit& fit) -> Status {
    for (Candidate& candidate : candidates) {
      state.SetFrameParameters(frame, candidate.parameters);
      if (Status fitted = RefineCandidate(body, points, fit, options, state, candidate); !fitted) return fitted;
      candidate.contradicts = contradicts(candidate.heading);
    }
    SortByCost(candidates);
    return {};
  };
  for (const Round& round : kStartRounds) {
    const FrameFit fit = ComparedFit(frame, round.matchings, kWidening);
    if (Status refined = refine(CoarseCloud(cloud, round.points), fit); !refined) return Forward(refined);
    const auto kept = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(round.kept * candidates.size())));
    std::vector<Candidate> best(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(kept));
    AddFacingAway(candidates, best);
    candidates = std::move(best);
  }
  candidates = Finalists(candidates);
  const FrameFit fit = ComparedFit(frame, options.iterations);
  if (Status refined = refine(cloud, fit); !refined) return Forward(refined);
  if (search == StartSearch::kStancesAndLimbs) {
    const std::size_t count = options.start.facing ? 1 : candidates.size();
    for (std::size_t i = 0; i < count; ++i) {
      state.SetFrameParameters(frame, candidates[i].parameters);
      const Expected<double> cost = SearchLimbs(body, cloud, frame, options, state);
      if (!cost) return Forward(cost);
      candidates[i].cost = *cost;
      candidates[i].heading = HeadingOf(state, frame);
      candidates[i].contradicts = contradicts(candidates[i].heading);
      candidates[i].parameters = state.FrameParameters(frame);
    }
    SortByCost(candidates);
  }
  CloudStart start{candidates.size(), candidates[0].cost, std::nullopt, std::nullopt};
  if (candidates[0].contradicts) start.off_facing = HeadingsApart(candidates[0].heading, *options.start.facing);
  if (const Candidate* other = BestFacingAway(candidates, 1)) {
    start.margin = (other->cost - candidates[0].cost) / candidates[0].cost;
  }
  state.SetFrameParameters(frame, candidates[0].parameters);
  state.Update(frame, frame + 1, false);
  return start;
}

}  // namespace mocurate
