#include "core/quality/handedness.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kHinge = 0.6;         // cosine between a knee's hinge and the axis of the hips
constexpr double kPointingFoot = 0.2;  // sine between the foot's direction and the plane of shank and hips
constexpr double kReachingHand = 0.3;  // sine between the hand's direction and the plane of the trunk
constexpr double kOpinion = 0.15;      // least share of agreement, times weight, of a part that counts
constexpr double kDecided = 0.5;       // least weighted sum of parts that agree
constexpr double kNearlyAlways = 0.95;
constexpr double kTiny = 1e-9;

/// Reliability of joints by type of source.
struct VoteLimits {
  double bent_knee;  ///< rad, least that counts
  int fewest_votes;  ///< of a part that counts
  int many_votes;    ///< of a part that decides alone
  double alone;      ///< required share of Part::alone_share
};
/// Depth trackers bend straight legs backwards by up to 0.9 rad, in many consecutive frames.
constexpr VoteLimits kTracked{1.0, 4, 30, 1.0};
/// Motion of fixed bones: markers, sensors, fits.
constexpr VoteLimits kFixedBones{0.5, 2, 2, 0.5};
constexpr double kFixed = 1e-3;  // relative change of a fixed bone's length: files round

/// How much of a clip a part of the body must cover.
struct Part {
  const char* name;
  double weight;
  double full_share;   ///< of frames and sides, for the full weight
  double alone_share;  ///< to decide without another part
};
constexpr Part kFeet{"feet", 1.0, 0.5, 0.7};
constexpr Part kKnees{"knees", 1.0, 0.2, 0.3};
constexpr Part kHands{"hands", 0.7, 0.3, 0.4};

/// Votes of one part of the body over the frames of a clip.
struct Tally {
  double sum = 0.0;
  int votes = 0;
  void Add(double score) {
    sum += score > 0.0 ? 1.0 : -1.0;
    ++votes;
  }
};

class Frame {
 public:
  Frame(const JointPositions& positions, const std::vector<double>* confidence, int frame)
      : positions_(positions), confidence_(confidence), frame_(frame) {}

  bool Has(int point) const {
    if (point < 0) return false;
    if (confidence_ == nullptr || confidence_->empty()) return true;
    return (*confidence_)[static_cast<std::size_t>(frame_) * positions_.joints + point] > 0.0;
  }
  bool Has(const int (&pair)[2]) const { return Has(pair[0]) && Has(pair[1]); }
  Vector3d At(int point) const { return positions_.at(frame_, point); }
  /// Unit vector; empty when the points coincide.
  std::optional<Vector3d> Direction(int from, int to) const { return Unit(At(to) - At(from)); }
  static std::optional<Vector3d> Unit(const Vector3d& v) {
    const double norm = v.norm();
    if (!(norm > kTiny)) return std::nullopt;
    return v / norm;
  }

 private:
  const JointPositions& positions_;
  const std::vector<double>* confidence_;
  int frame_;
};

/// Up along the trunk: from the hips to the head, else to the shoulders.
std::optional<Vector3d> Up(const Frame& frame, const BodyLandmarks& p) {
  if (!frame.Has(p.hip)) return std::nullopt;
  const Vector3d hips = 0.5 * (frame.At(p.hip[0]) + frame.At(p.hip[1]));
  if (frame.Has(p.shoulder)) return Frame::Unit(0.5 * (frame.At(p.shoulder[0]) + frame.At(p.shoulder[1])) - hips);
  if (frame.Has(p.head)) return Frame::Unit(frame.At(p.head) - hips);
  return std::nullopt;
}

/// Whether thighs and shanks keep their length in all frames that show them, at least two.
bool HasFixedBones(const JointPositions& positions, const BodyLandmarks& p, const std::vector<double>* confidence) {
  for (int side = 0; side < 2; ++side) {
    for (const auto& [from, to] : {std::pair{p.hip[side], p.knee[side]}, {p.knee[side], p.ankle[side]}}) {
      double shortest = 1e300, longest = 0.0;
      int seen = 0;
      for (int f = 0; f < positions.frames; ++f) {
        const Frame frame(positions, confidence, f);
        if (!frame.Has(from) || !frame.Has(to)) continue;
        const double length = (frame.At(to) - frame.At(from)).norm();
        shortest = std::min(shortest, length);
        longest = std::max(longest, length);
        ++seen;
      }
      if (seen < 2 || !(longest - shortest <= kFixed * longest)) return false;
    }
  }
  return true;
}

/// A knee flexes so that thigh x shank points to the person's left in a right-handed frame.
void AddKnees(const Frame& frame, const BodyLandmarks& p, const Vector3d& right, double bent_knee, Tally& tally) {
  for (int side = 0; side < 2; ++side) {
    if (!frame.Has(p.hip[side]) || !frame.Has(p.knee[side]) || !frame.Has(p.ankle[side])) continue;
    const auto thigh = frame.Direction(p.hip[side], p.knee[side]);
    const auto shank = frame.Direction(p.knee[side], p.ankle[side]);
    if (!thigh || !shank) continue;
    const Vector3d hinge = thigh->cross(*shank);
    if (std::atan2(hinge.norm(), thigh->dot(*shank)) <= bent_knee) continue;
    const double score = right.dot(hinge);
    if (std::abs(score) > kHinge * hinge.norm()) tally.Add(score);
  }
}

void AddFeet(const Frame& frame, const BodyLandmarks& p, const Vector3d& right, Tally& tally) {
  for (int side = 0; side < 2; ++side) {
    if (!frame.Has(p.knee[side]) || !frame.Has(p.ankle[side]) || !frame.Has(p.toe[side])) continue;
    const auto up = frame.Direction(p.ankle[side], p.knee[side]);
    const auto front = frame.Direction(p.ankle[side], p.toe[side]);
    if (!up || !front) continue;
    const double score = right.dot(up->cross(*front));
    if (std::abs(score) > kPointingFoot) tally.Add(score);
  }
}

void AddHands(const Frame& frame, const BodyLandmarks& p, const Vector3d& up, Tally& tally) {
  if (!frame.Has(p.shoulder)) return;
  const auto right = frame.Direction(p.shoulder[0], p.shoulder[1]);
  if (!right) return;
  for (int side = 0; side < 2; ++side) {
    if (!frame.Has(p.wrist[side])) continue;
    const auto reach = frame.Direction(p.shoulder[side], p.wrist[side]);
    if (!reach) continue;
    const double score = right->dot(up.cross(*reach));
    if (std::abs(score) > kReachingHand) tally.Add(score);
  }
}

/// `possible` is the number of votes if every frame and side voted.
HandednessCue Cue(const Part& part, const Tally& tally, int possible) {
  HandednessCue cue;
  cue.name = part.name;
  cue.frames = tally.votes;
  if (tally.votes == 0) return cue;
  cue.share = static_cast<double>(tally.votes) / possible;
  cue.score = tally.sum / tally.votes;
  cue.weight = part.weight * std::min(1.0, cue.share / part.full_share);
  return cue;
}

bool HasOpinion(const HandednessCue& cue, const VoteLimits& limits) {
  return cue.frames >= limits.fewest_votes && std::abs(cue.score) * cue.weight >= kOpinion;
}

bool IsFirm(const HandednessCue& cue, const VoteLimits& limits) {
  return std::abs(cue.score) >= kNearlyAlways && cue.frames >= limits.many_votes;
}

bool IsOverwhelming(const HandednessCue& cue, const VoteLimits& limits) {
  const Part& part = cue.name == kFeet.name ? kFeet : cue.name == kKnees.name ? kKnees : kHands;
  return IsFirm(cue, limits) && cue.share >= limits.alone * part.alone_share;
}

/// Hands may reach anywhere, also behind a lying person: confident feet and knees that agree overrule them.
bool OverruleHands(const std::vector<HandednessCue>& cues, const VoteLimits& limits) {
  const HandednessCue& feet = cues[0];
  const HandednessCue& knees = cues[1];
  return IsFirm(feet, limits) && IsFirm(knees, limits) && feet.score * knees.score > 0.0;
}

std::string Words(const HandednessCue& cue) {
  const bool left = cue.score > 0.0;
  std::string words = cue.name == "knees"  ? (left ? "knees bend backwards" : "knees bend forwards")
                      : cue.name == "feet" ? (left ? "feet point backwards" : "feet point forwards")
                                           : (left ? "hands reach behind the back" : "hands reach to the front");
  const int share = static_cast<int>(std::lround(50.0 * (1.0 + std::abs(cue.score))));
  return words + " (" + std::to_string(share) + " % of " + std::to_string(cue.frames) + ")";
}

/// Combines the cues into handedness, confidence and evidence.
void Decide(const VoteLimits& limits, HandednessMeasure& measure) {
  double sum[2] = {0.0, 0.0};  // for right, for left
  int parts[2] = {0, 0};
  bool overwhelming = false;
  for (const HandednessCue& cue : measure.cues) {
    if (!HasOpinion(cue, limits)) continue;
    const int side = cue.score > 0.0 ? 1 : 0;
    if (cue.name == kHands.name && parts[1 - side] > 0 && OverruleHands(measure.cues, limits)) continue;
    sum[side] += std::abs(cue.score) * cue.weight;
    ++parts[side];
    overwhelming = overwhelming || IsOverwhelming(cue, limits);
    measure.evidence += (measure.evidence.empty() ? "" : ", ") + Words(cue);
  }
  if (parts[0] > 0 && parts[1] > 0) {
    measure.evidence += ": they contradict each other";
    return;
  }
  const int side = parts[1] > 0 ? 1 : 0;
  if (sum[side] < kDecided || (parts[side] < 2 && !overwhelming)) {
    if (parts[side] > 0) measure.evidence += ": not enough evidence";
    return;
  }
  measure.confidence = std::min(1.0, sum[side]);
  measure.handedness = side == 1 ? Handedness::kLeft : Handedness::kRight;
}

}  // namespace

BodyLandmarks FindHandednessPoints(const std::function<std::optional<int>(std::string_view name)>& find) {
  const auto index = [&](std::string_view name) { return find(name).value_or(-1); };
  BodyLandmarks p;
  p.head = index("head");
  for (int side = 0; side < 2; ++side) {
    const std::string prefix = side == 0 ? "left_" : "right_";
    const auto of = [&](const char* name) { return index(prefix + name); };
    p.hip[side] = of("hip");
    p.knee[side] = of("knee");
    p.ankle[side] = of("ankle");
    p.shoulder[side] = of("shoulder");
    p.wrist[side] = of("wrist");
    for (const char* name : {"toe", "toe_base", "foot"}) {
      const int toe = of(name);
      if (p.toe[side] < 0 && toe >= 0 && toe != p.ankle[side]) p.toe[side] = toe;
    }
  }
  return p;
}

HandednessMeasure MeasureHandedness(const JointPositions& positions, const BodyLandmarks& points,
                                    const std::vector<double>* confidence) {
  const VoteLimits& limits = HasFixedBones(positions, points, confidence) ? kFixedBones : kTracked;
  Tally knees, feet, hands;
  for (int f = 0; f < positions.frames; ++f) {
    const Frame frame(positions, confidence, f);
    if (frame.Has(points.hip)) {
      if (const auto right = frame.Direction(points.hip[0], points.hip[1])) {
        AddKnees(frame, points, *right, limits.bent_knee, knees);
        AddFeet(frame, points, *right, feet);
      }
    }
    if (const auto up = Up(frame, points)) AddHands(frame, points, *up, hands);
  }
  const int possible = 2 * std::max(1, positions.frames);
  HandednessMeasure measure;
  measure.cues = {Cue(kFeet, feet, possible), Cue(kKnees, knees, possible), Cue(kHands, hands, possible)};
  Decide(limits, measure);
  return measure;
}

}  // namespace mocurate
