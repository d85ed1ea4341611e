#include "core/quality/handedness.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kBentKnee = 0.7;      // rad: below it a tracker's straight leg bends either way by noise
constexpr double kReachingHand = 0.3;  // sine between the hand's direction and the plane of the trunk
constexpr double kDecided = 0.4;       // least weighted sum that is an answer
constexpr double kTiny = 1e-9;

/// Frames of a clip as seen by one part of the body.
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
std::optional<Vector3d> Up(const Frame& frame, const HandednessPoints& p) {
  if (!frame.Has(p.hip)) return std::nullopt;
  const Vector3d hips = 0.5 * (frame.At(p.hip[0]) + frame.At(p.hip[1]));
  if (frame.Has(p.shoulder)) return Frame::Unit(0.5 * (frame.At(p.shoulder[0]) + frame.At(p.shoulder[1])) - hips);
  if (frame.Has(p.head)) return Frame::Unit(frame.At(p.head) - hips);
  return std::nullopt;
}

/// A knee flexes so that thigh x shank points to the person's left in a right-handed frame.
void AddKnees(const Frame& frame, const HandednessPoints& p, const Vector3d& right, Tally& tally) {
  for (int side = 0; side < 2; ++side) {
    if (!frame.Has(p.hip[side]) || !frame.Has(p.knee[side]) || !frame.Has(p.ankle[side])) continue;
    const auto thigh = frame.Direction(p.hip[side], p.knee[side]);
    const auto shank = frame.Direction(p.knee[side], p.ankle[side]);
    if (!thigh || !shank) continue;
    const Vector3d hinge = thigh->cross(*shank);
    if (std::atan2(hinge.norm(), thigh->dot(*shank)) > kBentKnee) tally.Add(right.dot(hinge));
  }
}

void AddFeet(const Frame& frame, const HandednessPoints& p, const Vector3d& right, Tally& tally) {
  for (int side = 0; side < 2; ++side) {
    if (!frame.Has(p.knee[side]) || !frame.Has(p.ankle[side]) || !frame.Has(p.toe[side])) continue;
    const auto up = frame.Direction(p.ankle[side], p.knee[side]);
    const auto front = frame.Direction(p.ankle[side], p.toe[side]);
    if (!up || !front) continue;
    const double score = right.dot(up->cross(*front));
    if (std::abs(score) > 0.2) tally.Add(score);
  }
}

void AddHands(const Frame& frame, const HandednessPoints& p, const Vector3d& up, Tally& tally) {
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

/// `possible` is the number of votes if every frame had an opinion; a share of `full_share` gives the full weight.
HandednessCue Cue(const char* name, const Tally& tally, int possible, double full_share, double weight) {
  HandednessCue cue;
  cue.name = name;
  cue.frames = tally.votes;
  if (tally.votes == 0) return cue;
  cue.score = tally.sum / tally.votes;
  cue.weight = weight * std::min(1.0, tally.votes / (full_share * possible));
  return cue;
}

std::string Words(const HandednessCue& cue) {
  const bool left = cue.score > 0.0;
  std::string words = cue.name == "knees"  ? (left ? "knees bend backwards" : "knees bend forwards")
                      : cue.name == "feet" ? (left ? "feet point backwards" : "feet point forwards")
                                           : (left ? "hands reach behind the back" : "hands reach to the front");
  const int share = static_cast<int>(std::lround(50.0 * (1.0 + std::abs(cue.score))));
  return words + " (" + std::to_string(share) + " % of " + std::to_string(cue.frames) + ")";
}

}  // namespace

HandednessPoints FindHandednessPoints(const std::function<std::optional<int>(std::string_view name)>& find) {
  const auto index = [&](std::string_view name) { return find(name).value_or(-1); };
  HandednessPoints p;
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

HandednessMeasure MeasureHandedness(const JointPositions& positions, const HandednessPoints& points,
                                    const std::vector<double>* confidence) {
  Tally knees, feet, hands;
  for (int f = 0; f < positions.frames; ++f) {
    const Frame frame(positions, confidence, f);
    if (frame.Has(points.hip)) {
      if (const auto right = frame.Direction(points.hip[0], points.hip[1])) {
        AddKnees(frame, points, *right, knees);
        AddFeet(frame, points, *right, feet);
      }
    }
    if (const auto up = Up(frame, points)) AddHands(frame, points, *up, hands);
  }
  const int possible = 2 * std::max(1, positions.frames);
  HandednessMeasure measure;
  measure.cues = {Cue("feet", feet, possible, 0.5, 1.0), Cue("knees", knees, possible, 0.2, 1.0),
                  Cue("hands", hands, possible, 0.3, 0.7)};
  double sum = 0.0;
  for (const HandednessCue& cue : measure.cues) sum += cue.weight * cue.score;
  measure.confidence = std::min(1.0, std::abs(sum));
  if (measure.confidence >= kDecided) measure.handedness = sum > 0.0 ? Handedness::kLeft : Handedness::kRight;
  for (const HandednessCue& cue : measure.cues) {
    if (cue.weight == 0.0 || (cue.score > 0.0) != (sum > 0.0)) continue;
    if (!measure.evidence.empty()) measure.evidence += ", ";
    measure.evidence += Words(cue);
  }
  return measure;
}

}  // namespace mocurate
