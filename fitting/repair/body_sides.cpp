#include "fitting/repair/body_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/quality/handedness.h"
#include "core/quality/tracked_points.h"
#include "fitting/repair/exchanges.h"

namespace mocurate {
namespace {

constexpr double kNearlyAll = 0.6;          ///< least share of the pairs' total evidence in favour of a change
constexpr int kFewestAnatomyFrames = 10;    ///< fewest frames for the anatomy test
constexpr double kFacing = 0.3;             ///< sine between the nose's direction and the plane of the trunk
constexpr double kFaceNearlyAlways = 0.95;  ///< share of the frames that must agree for the face test to count
constexpr double kOften = 0.5;              ///< share of the frames that must show the face

/// Consecutive frames without a long gap, and whether the sides of each differ from those of the first.
struct Chain {
  int begin = 0;
  int end = 0;
  std::vector<bool> other;
};

/// Follows the pairs of a body from frame to frame.
class SidesFollower {
 public:
  SidesFollower(const SkeletonTracks& tracks, const std::vector<int>& left, double sigma, double least_margin)
      : tracks_(tracks),
        left_(left),
        variance_(2.0 * sigma * sigma),
        least_margin_(least_margin),
        centres_(BodyCentres({tracks.positions, tracks.confidence, tracks.time_s})),
        last_(left.size(), -1) {}

  std::vector<Chain> Chains() {
    std::vector<Chain> chains;
    bool other = false;
    for (int f = 0; f < tracks_.frames(); ++f) {
      const Change change = Into(f, other);
      if (change.linked && change.gain >= least_margin_ && change.gain >= kNearlyAll * change.total) other = !other;
      if (chains.empty() || (change.seen && !change.linked)) {
        if (!chains.empty()) chains.back().end = f;
        chains.push_back({f, tracks_.frames(), {}});
        other = false;
        std::fill(last_.begin(), last_.end(), -1);
      }
      chains.back().other.push_back(other);
      Keep(f, other);
    }
    return chains;
  }

 private:
  struct Change {
    bool seen = false;
    bool linked = false;
    double gain = 0.0;   ///< log-likelihood ratio: sides changed against unchanged
    double total = 0.0;  ///< sum of |log-likelihood ratio| over the pairs
  };

  bool Seen(int f, std::size_t i) const {
    return tracks_.seen(f, left_[i]) && tracks_.seen(f, tracks_.skeleton->joints[left_[i]].mirror);
  }
  std::array<Vector3d, 2> Places(int f, std::size_t i, bool other) const {
    const Vector3d left = tracks_.positions.at(f, left_[i]);
    const Vector3d right = tracks_.positions.at(f, tracks_.skeleton->joints[left_[i]].mirror);
    return other ? std::array<Vector3d, 2>{right, left} : std::array<Vector3d, 2>{left, right};
  }

  Change Into(int f, bool other) const {
    Change change;
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (!Seen(f, i)) continue;
      change.seen = true;
      const int before = last_[i];
      if (before < 0 || tracks_.time_s[f] - tracks_.time_s[before] > kStepGap_s) continue;
      change.linked = true;
      const bool centred = centres_[f].seen && centres_[before].seen;
      const Vector3d moved =
          centred ? Vector3d(centres_[f].place - centres_[before].place) : Vector3d(Vector3d::Zero());
      const double way = kLimbSpeed * (tracks_.time_s[f] - tracks_.time_s[before]);
      const std::array<Vector3d, 2> then = Places(before, i, followed_[static_cast<std::size_t>(before)]);
      const auto cost = [&](bool changed) {
        const std::array<Vector3d, 2> now = Places(f, i, other != changed);
        double sum = 0.0;
        for (const std::size_t side : {0, 1}) {
          const double square = (now[side] - moved - then[side]).squaredNorm() / (variance_ + way * way);
          sum += std::min(0.5 * square, kMostSampleCost);
        }
        return sum;
      };
      const double gain = cost(false) - cost(true);
      change.gain += gain;
      change.total += std::abs(gain);
    }
    return change;
  }

  void Keep(int f, bool other) {
    followed_.push_back(other);
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (Seen(f, i)) last_[i] = f;
    }
  }

  const SkeletonTracks& tracks_;
  const std::vector<int>& left_;
  double variance_;
  double least_margin_;
  std::vector<BodyCentre> centres_;
  std::vector<int> last_;       ///< last frame that observes each pair
  std::vector<bool> followed_;  ///< (frames so far) whether the sides were changed
};

/// Whether anatomy shows left and right exchanged, and the evidence.
struct SidesByAnatomy {
  std::optional<bool> exchanged;
  double confidence = 0.0;
  std::string evidence;
};

/// Tests whether the nose lies in front of the ears. `exchanged` where it lies behind; empty where the frames do not
/// agree.
SidesByAnatomy TestFace(const SkeletonTracks& tracks) {
  const Skeleton& skeleton = *tracks.skeleton;
  const auto nose = skeleton.FindJoint("nose");
  const auto hips = skeleton.Hips();
  const auto shoulders = skeleton.Shoulders();
  const std::array<std::optional<int>, 2> ears = {skeleton.FindJoint("left_ear"), skeleton.FindJoint("right_ear")};
  if (!nose || !hips || !shoulders || !ears[0] || !ears[1]) return {};
  int before = 0;
  int behind = 0;
  for (int f = 0; f < tracks.frames(); ++f) {
    const std::array<int, 7> points = {*nose,      *ears[0],        *ears[1],       (*hips)[0],
                                       (*hips)[1], (*shoulders)[0], (*shoulders)[1]};
    if (!std::all_of(points.begin(), points.end(), [&](int joint) { return tracks.seen(f, joint); })) continue;
    const auto middle = [&](int a, int b) {
      return Vector3d(0.5 * (tracks.positions.at(f, a) + tracks.positions.at(f, b)));
    };
    const Vector3d up = middle((*shoulders)[0], (*shoulders)[1]) - middle((*hips)[0], (*hips)[1]);
    const Vector3d right = tracks.positions.at(f, (*shoulders)[1]) - tracks.positions.at(f, (*shoulders)[0]);
    const Vector3d front = tracks.positions.at(f, *nose) - middle(*ears[0], *ears[1]);
    const double score = right.stableNormalized().dot(up.stableNormalized().cross(front.stableNormalized()));
    before += score < -kFacing ? 1 : 0;
    behind += score > kFacing ? 1 : 0;
  }
  const int all = before + behind;
  const double share = all > 0 ? std::max(before, behind) / static_cast<double>(all) : 0.0;
  if (all < kFewestAnatomyFrames || share < kFaceNearlyAlways || all < kOften * tracks.frames()) return {};
  SidesByAnatomy result;
  result.exchanged = behind > before;
  result.confidence = share;
  result.evidence = std::string("the face lies ") + (behind > before ? "behind" : "in front of") + " the ears (" +
                    std::to_string(std::lround(100.0 * share)) + " % of " + std::to_string(all) + " frames)";
  return result;
}

SidesByAnatomy TestAnatomy(const SkeletonTracks& tracks) {
  if (tracks.frames() < kFewestAnatomyFrames) return {};
  const Skeleton& skeleton = *tracks.skeleton;
  BodyLandmarks points = FindHandednessPoints([&](std::string_view name) { return skeleton.FindJoint(name); });
  const std::vector<bool> seen = tracks.JointObservations();
  for (int side = 0; side < 2; ++side) {
    const auto toe = skeleton.FindJoint(side == 0 ? "left_big_toe" : "right_big_toe");
    if (toe && (points.toe[side] < 0 || !seen[points.toe[side]])) points.toe[side] = *toe;
  }
  const HandednessMeasure limbs = MeasureHandedness(tracks.positions, points, &tracks.confidence);
  SidesByAnatomy face = TestFace(tracks);
  if (!limbs.handedness) return face;
  SidesByAnatomy result{*limbs.handedness == Handedness::kLeft, limbs.confidence, limbs.evidence};
  if (!face.exchanged) return result;
  if (face.exchanged != result.exchanged) return {};
  result.confidence = std::max(result.confidence, face.confidence);
  result.evidence += ", " + face.evidence;
  return result;
}

}  // namespace

std::optional<bool> SidesExchangedByAnatomy(const SkeletonTracks& tracks) { return TestAnatomy(tracks).exchanged; }

std::vector<int> LeftJoints(const Skeleton& skeleton) {
  std::vector<int> left;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (skeleton.joints[j].mirror > j) left.push_back(j);
  }
  return left;
}

void ExchangeJoints(const std::vector<int>& left, int begin, int end, SkeletonTracks& tracks) {
  const auto joints = static_cast<std::size_t>(tracks.joints());
  for (int f = begin; f < end; ++f) {
    for (const int joint : left) {
      const int partner = tracks.skeleton->joints[joint].mirror;
      const std::size_t here = static_cast<std::size_t>(f) * joints + static_cast<std::size_t>(joint);
      const std::size_t there = static_cast<std::size_t>(f) * joints + static_cast<std::size_t>(partner);
      const Vector3d place = tracks.positions.at(f, joint);
      tracks.positions.at(f, joint) = Vector3d(tracks.positions.at(f, partner));
      tracks.positions.at(f, partner) = place;
      std::swap(tracks.confidence[here], tracks.confidence[there]);
      if (!tracks.precision.empty()) std::swap(tracks.precision[here], tracks.precision[there]);
      if (tracks.rotation.empty()) continue;
      std::swap(tracks.rotation[here], tracks.rotation[there]);
      std::swap(tracks.rotation_confidence[here], tracks.rotation_confidence[there]);
    }
  }
}

bool CoverAll(const std::vector<BodyExchange>& exchanges, const SkeletonTracks& tracks) {
  std::vector<bool> outside = tracks.ObservedFrames();
  for (const BodyExchange& exchange : exchanges)
    std::fill(outside.begin() + exchange.frame_begin, outside.begin() + exchange.frame_end, false);
  return std::find(outside.begin(), outside.end(), true) == outside.end();
}

std::vector<BodyExchange> FindBodyExchanges(const SkeletonTracks& tracks, double noise_sigma, double least_margin) {
  std::vector<BodyExchange> found;
  const std::vector<int> left = LeftJoints(*tracks.skeleton);
  if (left.size() < 2) return found;  // a single pair may cross in a normal movement
  for (const Chain& chain : SidesFollower(tracks, left, noise_sigma, least_margin).Chains()) {
    SkeletonTracks part = CutTracks(tracks, chain.begin, chain.end);
    for (int f = 0; f < part.frames(); ++f) {
      if (chain.other[static_cast<std::size_t>(f)]) ExchangeJoints(left, f, f + 1, part);
    }
    const auto others = std::count(chain.other.begin(), chain.other.end(), true);
    const SidesByAnatomy anatomy = TestAnatomy(part);
    const bool first = anatomy.exchanged ? *anatomy.exchanged : 2 * others > part.frames();
    const auto exchanged = first ? part.frames() - others : others;
    for (int begin = 0; begin < part.frames(); ++begin) {
      const auto is = [&](int f) { return chain.other[static_cast<std::size_t>(f)] != first; };
      if (!is(begin)) continue;
      BodyExchange exchange;
      exchange.rarer = 2 * exchanged <= part.frames();
      const auto all = static_cast<double>(part.frames());
      exchange.confidence = anatomy.exchanged ? anatomy.confidence : 1.0 - static_cast<double>(exchanged) / all;
      exchange.evidence = !anatomy.exchanged ? "the steps are likelier so, and the other frames are the majority"
                          : first            ? anatomy.evidence
                                             : "the steps are likelier so; in the other frames " + anatomy.evidence;
      exchange.frame_begin = chain.begin + begin;
      while (begin < part.frames() && is(begin)) ++begin;
      exchange.frame_end = chain.begin + begin;
      found.push_back(std::move(exchange));
    }
  }
  return found;
}

}  // namespace mocurate
