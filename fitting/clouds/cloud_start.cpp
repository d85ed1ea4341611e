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
/// share; horizontal part of the front of the pelvis, from which it has a heading (numerical).
constexpr double kHasHeading = 0.5;
constexpr double kTaller = 1.35;  ///< ratio of the heights of stance and points, above which a part is hidden
/// Factor on the distance limit of the matches (numerical).
constexpr double kWidening = 2.0;
constexpr std::size_t kRanked =
    96;  ///< (half with a facing) starts that are fitted: the nearest to the points (numerical)
constexpr int kRankedPoints = 150;     ///< points to rank them by (numerical)
constexpr double kRankedReach = 0.4;   ///< m, cap on the distance of a point (numerical)
constexpr std::size_t kFinalists = 6;  ///< starts that the last round refines, at most (numerical)
constexpr double kHopeful = 1.5;       ///< factor on the least cost, up to which limbs are searched
constexpr double kOtherTurn = 1.6;     ///< rad; from here the pelvis is turned around, or over

/// Rounds of the search: points and matchings per start, and the share of starts that continues.
struct Round {
  int points;
  int matchings;
  double kept;
};
/// Rounds of the search: points, matchings per start, share of the starts that continues (numerical).
constexpr std::array<Round, 2> kStartRounds = {{{300, 6, 0.4}, {600, 15, 1.0}}};

enum class Arms { kDown, kOut, kUp, kForward };

/// Legs and hips of a stance, rad, and where its trunk points before it is turned about the vertical.
struct Stance {
  Vector3d root = Vector3d::Zero();  ///< rotation vector of the pelvis
  double hip = 0.0;                  ///< bend, negative: thighs forwards
  double knee = 0.0;                 ///< bend
  double spread = 0.0;               ///< of the thighs, sideways
  double step = 0.0;                 ///< left thigh ahead, right one behind
  Arms arms = Arms::kDown;
  bool stands = true;  ///< on its feet, trunk upright
  bool sits = false;   ///< on a chair
};

/// Stances of the first pose, each tried in every heading (numerical): on the feet, on a chair, bent over, on knees,
/// hands or the floor, lying on each side, and upside down.
const std::vector<Stance>& Stances() {
  static const std::vector<Stance> stances = [] {
    std::vector<Stance> all;
    const auto add = [&](Stance stance, std::initializer_list<Arms> arms) {
      for (const Arms of : arms) stance.arms = of, all.push_back(stance);
    };
    const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ();
    const double over = 0.5 * kPi;
    const auto down = Arms::kDown, out = Arms::kOut, up = Arms::kUp, forward = Arms::kForward;
    add({}, {down, out, up, forward});
    add({Vector3d::Zero(), 0.0, 0.3, 0.0, 0.35}, {down});
    add({Vector3d::Zero(), 0.0, 0.3, 0.0, -0.35}, {down});
    add({Vector3d::Zero(), -1.2, 1.6}, {down, forward});                                         // squatting
    add({Vector3d::Zero(), -1.45, 1.4, 0.0, 0.0, down, false, true}, {down, forward, out, up});  // on a chair
    add({0.4 * x, -2.0, 2.3, 0.2, 0.0, down, false}, {forward, down});                           // crouching
    add({Vector3d::Zero(), 0.0, 1.5, 0.0, 0.0, down, false}, {down, forward});                   // kneeling
    add({Vector3d::Zero(), -0.9, 1.6, 0.0, 0.8, down, false}, {down});                           // on one knee
    add({Vector3d::Zero(), -0.9, 1.6, 0.0, -0.8, down, false}, {down});
    add({Vector3d::Zero(), -1.4, 0.1, 0.1, 0.0, down, false}, {down, forward});  // legs stretched out
    add({Vector3d::Zero(), -1.4, 2.0, 0.9, 0.0, down, false}, {down});           // cross-legged
    add({0.9 * x, -0.9, 0.1, 0.0, 0.0, down, false}, {down, forward});           // bent over
    add({over * x, -over, 0.1, 0.0, 0.0, down, false}, {down, forward});
    add({over * x, -over, 1.5, 0.0, 0.0, down, false}, {forward});                         // on all fours
    for (const Vector3d& side : {Vector3d(-x), Vector3d(x), Vector3d(-z), Vector3d(z)}) {  // lying
      add({over * side, 0.0, 0.1, 0.0, 0.0, down, false}, {down, out});
      add({over * side, -0.8, 1.0, 0.0, 0.0, down, false}, {forward});
    }
    add({kPi * z, 0.0, 0.1, 0.0, 0.0, down, false}, {up});  // on the hands
    return all;
  }();
  return stances;
}

void BendLegs(const Skeleton& skeleton, const Stance& stance, int frame, PoseState& state) {
  const auto hips = LegsOfBody(skeleton);
  if (!hips) return;
  const auto children = skeleton.Children();
  for (const int side : {0, 1}) {
    const double sign = side == 0 ? 1.0 : -1.0;
    const int lower = OnlyChild(children, (*hips)[side]);
    if (lower < 0) continue;
    state.rotation(frame, (*hips)[side])[0] = stance.hip - sign * stance.step;
    state.rotation(frame, (*hips)[side])[2] = sign * stance.spread;
    if (state.active(lower)) state.rotation(frame, lower)[0] = stance.knee;
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
  const Quaterniond root = ExpQuaternion(heading * Vector3d::UnitY()) * ExpQuaternion(stance.root);
  Eigen::Map<Vector3d>(state.rotation(frame, 0)) = LogQuaternion(root);
  BendLegs(*body.skeleton, stance, frame, state);
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
  state.Update(frame, frame + 1, false);
}

struct Candidate {
  bool contradicts = false;  ///< the given facing
  double cost = 0.0;
  std::vector<double> parameters{};
  std::vector<Vector3d> joints{};
  Matrix3d root = Matrix3d::Identity();
};

/// Of the pose in the state, up to date.
Candidate CandidateOf(const PoseState& state, int frame, double cost, const std::optional<double>& facing) {
  Candidate candidate{false, cost, state.FrameParameters(frame), {}, state.global(frame, 0)};
  for (int j = 0; j < state.joints(); ++j) candidate.joints.push_back(state.position(frame, j));
  const Vector3d front = candidate.root.col(2);
  if (facing && std::hypot(front.x(), front.z()) > kHasHeading)
    candidate.contradicts = std::abs(std::remainder(HeadingOf(state, frame) - *facing, 2.0 * kPi)) > kFacingError;
  return candidate;
}

/// Mean distance of the joints, m.
double JointsApart(const Candidate& a, const Candidate& b) {
  double sum = 0.0;
  for (std::size_t j = 0; j < a.joints.size(); ++j) sum += (a.joints[j] - b.joints[j]).norm();
  return sum / static_cast<double>(a.joints.size());
}

void SortByCost(std::vector<Candidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::make_pair(a.contradicts, a.cost) < std::make_pair(b.contradicts, b.cost);
  });
}

/// Appends the best candidate that is turned around or over, unless `chosen` has one: they are compared after a full
/// fit.
void AddTurned(const std::vector<Candidate>& candidates, std::vector<Candidate>& chosen) {
  const auto turned = [&](const Candidate& candidate) {
    return AngleBetween(Quaterniond(candidate.root), Quaterniond(candidates[0].root)) >= kOtherTurn;
  };
  if (std::any_of(chosen.begin(), chosen.end(), turned)) return;
  const auto other = std::find_if(candidates.begin(), candidates.end(), turned);
  if (other != candidates.end()) chosen.push_back(*other);
}

/// The cheapest candidates that are distinct; one is turned if any is.
std::vector<Candidate> Finalists(const std::vector<Candidate>& candidates, std::size_t most) {
  std::vector<Candidate> finalists;
  for (const Candidate& candidate : candidates) {
    const bool is_new = std::none_of(finalists.begin(), finalists.end(), [&](const Candidate& other) {
      return JointsApart(candidate, other) < kDistinctPose;
    });
    if (is_new && finalists.size() < most) finalists.push_back(candidate);
  }
  AddTurned(candidates, finalists);
  return finalists;
}

/// The pose with left and right exchanged: turned about the trunk, each limb where the other one was.
void Exchange(const Skeleton& skeleton, const std::vector<double>& pose, int frame, PoseState& state) {
  state.SetFrameParameters(frame, pose);
  const PoseState given = state;
  const Vector3d signs(-1.0, 1.0, -1.0);  // half a turn about y
  for (int j = 1; j < state.joints(); ++j) {
    const int mirror = skeleton.joints[static_cast<std::size_t>(j)].mirror;
    Eigen::Map<Vector3d>(state.rotation(frame, j)) =
        signs.cwiseProduct(Eigen::Map<const Vector3d>(given.rotation(frame, mirror)));
  }
  const Quaterniond root = ExpQuaternion(Eigen::Map<const Vector3d>(given.rotation(frame, 0)));
  Eigen::Map<Vector3d>(state.rotation(frame, 0)) = LogQuaternion(root * ExpQuaternion(kPi * Vector3d::UnitY()));
  state.Update(frame, frame + 1, false);
}

bool IsWanted(const Stance& stance, StartPosture posture) {
  if (posture == StartPosture::kSeated) return stance.sits;
  if (posture == StartPosture::kStanding) return stance.stands && stance.hip == 0.0;
  return true;
}

/// Starts nearest to the points.
std::vector<Candidate> Starts(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                              const CloudStartOptions& options, StartSearch search, PoseState& state) {
  const FusedCloud few = CoarseCloud(cloud, kRankedPoints);
  std::vector<Candidate> starts;
  for (const Stance& stance : Stances()) {
    const bool upright = stance.stands || stance.sits;
    if (!IsWanted(stance, options.posture) || (search != StartSearch::kStancesAndLimbs && !upright)) continue;
    const bool given = options.facing && (ExpQuaternion(stance.root) * Vector3d::UnitZ()).z() > kHasHeading;
    const std::size_t headings = given ? kAboutTheFacing.size() : kHeadings;
    for (std::size_t h = 0; h < headings; ++h) {
      const double heading =
          given ? *options.facing + kAboutTheFacing[h] : 2.0 * kPi * static_cast<double>(h) / kHeadings;
      SetStance(body, cloud, frame, heading, stance, state);
      starts.push_back(CandidateOf(state, frame, MeanDistance(body, few, state, frame, kRankedReach), {}));
    }
  }
  SortByCost(starts);
  const std::size_t most = options.facing ? kRanked / 2 : kRanked;
  if (starts.size() > most) starts.resize(most);
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
  std::vector<Candidate> candidates = Starts(body, cloud, frame, options.start, search, state);
  const auto refine = [&](const FusedCloud& points, const FrameFit& fit, std::size_t begin) -> Status {
    for (std::size_t i = begin; i < candidates.size(); ++i) {
      state.SetFrameParameters(frame, candidates[i].parameters);
      if (const auto fitted = FitCloudFrame(body, points, fit, state, options); !fitted) return Forward(fitted);
      candidates[i] = CandidateOf(state, frame, PoseCost(body, points, fit, state, options), options.start.facing);
    }
    SortByCost(candidates);
    return {};
  };
  for (const Round& round : kStartRounds) {
    const FrameFit fit = ComparedFit(frame, round.matchings, kWidening);
    if (Status refined = refine(CoarseCloud(cloud, round.points), fit, 0); !refined) return Forward(refined);
    const auto kept = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(round.kept * candidates.size())));
    std::vector<Candidate> best(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(kept));
    AddTurned(candidates, best);
    candidates = std::move(best);
  }
  candidates = Finalists(candidates, kFinalists);
  const FrameFit fit = ComparedFit(frame, options.iterations);
  if (Status refined = refine(cloud, fit, 0); !refined) return Forward(refined);
  if (search != StartSearch::kUpright) {
    Exchange(*body.skeleton, candidates[0].parameters, frame, state);
    candidates.push_back(CandidateOf(state, frame, 0.0, {}));
    if (Status refined = refine(cloud, fit, candidates.size() - 1); !refined) return Forward(refined);
    candidates = Finalists(candidates, kFinalists);
    const double hopeful = kHopeful * candidates[0].cost;
    for (Candidate& candidate : candidates) {
      if (candidate.cost > hopeful || (candidate.contradicts && !candidates[0].contradicts)) continue;
      state.SetFrameParameters(frame, candidate.parameters);
      const Expected<double> cost = SearchLimbs(body, cloud, frame, options, state);
      if (!cost) return Forward(cost);
      candidate = CandidateOf(state, frame, *cost, options.start.facing);
    }
    SortByCost(candidates);
  }
  const Candidate& best = candidates[0];
  CloudStart start{best.cost};
  state.SetFrameParameters(frame, best.parameters);
  state.Update(frame, frame + 1, false);
  if (best.contradicts)
    start.off_facing = std::abs(std::remainder(HeadingOf(state, frame) - *options.start.facing, 2.0 * kPi));
  if (search != StartSearch::kStancesAndLimbs) return start;
  const std::vector<double> costs = PointCosts(body, cloud, fit, state, options);
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (candidates[i].contradicts || JointsApart(candidates[i], best) < kDistinctPose) continue;
    state.SetFrameParameters(frame, candidates[i].parameters);
    state.Update(frame, frame + 1, false);
    const CostDifference more = Compare(cloud, PointCosts(body, cloud, fit, state, options), costs);
    if (more.sum < kClearlyWorse * more.sigma()) start.others.push_back(candidates[i].parameters);
  }
  state.SetFrameParameters(frame, best.parameters);
  state.Update(frame, frame + 1, false);
  return start;
}

}  // namespace mocurate
