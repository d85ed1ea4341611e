#include "fitting/repair/bone_violations.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace mocurate {
namespace {

constexpr double kViolation = 0.15;       ///< metres, least excess of a distance over the bone length
constexpr double kViolationOfBone = 0.5;  ///< of the bone length
constexpr double kViolationSigmas = 6.0;  ///< standard deviations of the distance of two joints
/// Metres of bone length error that are normal: a Kinect's bones vary by 4 to 19 mm. Source: bench_real_tracks
/// (docs/refitted_sets.md)
constexpr double kWrongBone = 0.05;
constexpr double kWrongSigmas = 3.0;    ///< standard deviations of the noise: smaller errors of a bone are normal
constexpr int kMinViolationFrames = 3;  ///< shorter runs are outliers among their neighbours in time
constexpr double kJumpReach_s = 0.5;    ///< longest time from the run to the jump that starts or ends it
constexpr double kJump = 0.15;          ///< m; least step of a joint at the start or end of a run
constexpr double kJumpOfExcess = 0.5;   ///< of the excess length
constexpr double kFastestHand = 12.0;   ///< m/s, faster than any hand
/// Ratio to the speed of the steps before and after. Source: recorded clips of KARD with a joint displaced by 0.4 m for
/// 8 frames
constexpr double kSudden = 4.0;
constexpr double kCutOff_s = 0.35;    ///< longest run at the start or end of a clip that one jump bounds
constexpr double kFarAway = 0.3;      ///< m; least step of a joint that jumps away
constexpr double kFarSigmas = 6.0;    ///< standard deviations of the noise, least step likewise
constexpr double kMostlyWrong = 0.7;  ///< share of the frames with wrong bones: difference inside against around
constexpr double kBack = 0.5;         ///< of the step: largest distance to the earlier position at which the joint has
                                      ///< returned

class ViolationSearch {
 public:
  ViolationSearch(const SkeletonTracks& tracks, const std::vector<double>& bone_length, double sigma, double longest_s)
      : tracks_(tracks),
        bone_length_(bone_length),
        children_(tracks.skeleton->Children()),
        noise_(std::sqrt(2.0) * sigma),
        longest_s_(longest_s) {}

  std::vector<BoneViolation> Find() {
    const auto joints = static_cast<std::size_t>(tracks_.joints());
    std::vector<double> excess(tracks_.confidence.size(), 0.0);
    for (int f = 0; f < tracks_.frames(); ++f) FindViolations(f, excess.data() + static_cast<std::size_t>(f) * joints);
    std::vector<BoneViolation> found;
    for (int j = 0; j < tracks_.joints(); ++j) {
      std::vector<BoneViolation> of_joint = Runs(j, excess);
      for (const BoneViolation& jump : Jumps(j)) of_joint.push_back(jump);
      Merge(std::move(of_joint), found);
    }
    RemoveWholeBodies(found);
    return found;
  }

 private:
  double Slack(double length) const {
    return std::max({kViolation, kViolationOfBone * length, kViolationSigmas * noise_});
  }

  /// Metres by which the distance of joints a and b exceeds the bones between them; 0 within the tolerance.
  double Excess(int f, int a, int b, double length) const {
    const double away = (tracks_.positions.at(f, a) - tracks_.positions.at(f, b)).norm() - length;
    return away > Slack(length) ? away : 0.0;
  }

  /// Calls `visit(joint, length)` for the nearest joints along the tree for which `stops` is true.
  template <class Stops, class Visit>
  void VisitNearest(int at, int from, double length, const Stops& stops, const Visit& visit) const {
    const auto go = [&](int next, double bone) {
      if (next == from) return;
      if (stops(next)) {
        visit(next, length + bone);
      } else {
        VisitNearest(next, at, length + bone, stops, visit);
      }
    };
    const int parent = tracks_.skeleton->joints[at].parent;
    if (parent >= 0) go(parent, bone_length_[at]);
    for (const int child : children_[at]) go(child, bone_length_[child]);
  }

  /// Writes the excess length of each joint of a frame that the body cannot reach.
  void FindViolations(int f, double* excess) {
    const int joints = tracks_.joints();
    const auto seen = [&](int joint) { return tracks_.seen(f, joint); };
    std::vector<int> part(static_cast<std::size_t>(joints), -1);
    std::vector<int> sizes;
    for (int j = 0; j < joints; ++j) {  // parents come first
      if (!seen(j)) continue;
      int above = tracks_.skeleton->joints[j].parent;
      double length = bone_length_[j];
      while (above >= 0 && !seen(above)) {
        length += bone_length_[above];
        above = tracks_.skeleton->joints[above].parent;
      }
      const bool joined = above >= 0 && Excess(f, j, above, length) == 0.0;
      if (!joined) sizes.push_back(0);
      part[j] = joined ? part[above] : static_cast<int>(sizes.size()) - 1;
      ++sizes[part[j]];
    }
    if (sizes.size() < 2) return;
    const int body = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    std::vector<bool> of_body(sizes.size(), false);
    of_body[body] = true;
    std::vector<double> off(sizes.size(), 0.0);
    for (bool grown = true; grown;) {
      grown = false;
      std::fill(off.begin(), off.end(), 0.0);
      for (int j = 0; j < joints; ++j) {
        if (part[j] < 0 || of_body[part[j]]) continue;
        const auto stops = [&](int joint) {
          return part[joint] >= 0 && (of_body[part[joint]] || part[joint] == part[j]);
        };
        VisitNearest(j, -1, 0.0, stops, [&](int joint, double length) {
          if (of_body[part[joint]]) off[part[j]] = std::max(off[part[j]], Excess(f, j, joint, length));
        });
      }
      for (std::size_t p = 0; p < off.size(); ++p) {
        if (of_body[p] || off[p] > 0.0) continue;
        of_body[p] = grown = true;
      }
    }
    for (int j = 0; j < joints; ++j) {
      if (part[j] >= 0 && !of_body[part[j]]) excess[j] = off[part[j]];
    }
    for (int j = 1; j < joints; ++j) {
      if (excess[j] > 0.0) AssignExcessAbove(f, j, part, excess);
    }
  }

  /// A joint in a wrong position makes its children look wrong while the joint itself is still near its parent. Moves
  /// the excess to the joint when all its other bones have wrong lengths and its children are within reach of the rest
  /// of the body.
  void AssignExcessAbove(int f, int joint, const std::vector<int>& part, double* excess) const {
    const auto fine = [&](int other) { return tracks_.seen(f, other) && excess[other] == 0.0; };
    int above = tracks_.skeleton->joints[joint].parent;
    while (above >= 0 && !tracks_.seen(f, above)) above = tracks_.skeleton->joints[above].parent;
    if (above < 0 || !fine(above)) return;
    int others = 0;
    bool wrong = true, reached = true;
    VisitNearest(above, -1, 0.0, fine, [&](int other, double length) {
      const double away = (tracks_.positions.at(f, other) - tracks_.positions.at(f, above)).norm() - length;
      wrong = wrong && std::abs(away) > std::max(kWrongBone, kWrongSigmas * noise_);
      ++others;
    });
    const auto but_above = [&](int other) { return other != above && fine(other); };
    VisitNearest(joint, -1, 0.0, but_above,
                 [&](int other, double length) { reached = reached && Excess(f, joint, other, length) == 0.0; });
    if (others == 0 || !wrong || !reached) return;
    excess[above] = excess[joint];
    for (int j = 0; j < tracks_.joints(); ++j) {
      if (part[j] == part[joint]) excess[j] = 0.0;
    }
  }

  /// A joint's step into frame f from its last observation, metres and seconds; empty when not observed.
  std::optional<std::pair<double, double>> Step(int joint, int f) const {
    if (f <= 0 || f >= tracks_.frames() || !tracks_.seen(f, joint)) return {};
    const int before = SeenBefore(joint, f);
    if (before < 0) return {};
    return std::pair((tracks_.positions.at(f, joint) - tracks_.positions.at(before, joint)).norm(),
                     tracks_.time_s[f] - tracks_.time_s[before]);
  }

  int SeenBefore(int joint, int f) const {
    do {
      --f;
    } while (f >= 0 && !tracks_.seen(f, joint));
    return f;
  }

  std::vector<BoneViolation> Runs(int joint, const std::vector<double>& excess) const {
    const auto at = [&](int f) { return excess[static_cast<std::size_t>(f) * tracks_.joints() + joint]; };
    std::vector<BoneViolation> runs;
    for (int f = 0; f < tracks_.frames(); ++f) {
      if (at(f) == 0.0) continue;
      BoneViolation run{joint, f, f, 0.0, false};
      int off = 0;
      while (f < tracks_.frames() && (at(f) > 0.0 || !tracks_.seen(f, joint))) {
        run.distance = std::max(run.distance, at(f));
        off += at(f) > 0.0 ? 1 : 0;
        if (at(f) > 0.0) run.frame_end = f + 1;
        ++f;
      }
      if (off < kMinViolationFrames) continue;
      const double jump = std::max(kJump, kJumpOfExcess * run.distance);
      for (int begin = run.frame_begin; begin > 0; --begin) {
        const auto step = Step(joint, begin);
        if (tracks_.time_s[run.frame_begin] - tracks_.time_s[begin] > kJumpReach_s) break;
        if (!step || step->first < jump) continue;
        run.frame_begin = begin;
        break;
      }
      for (int end = run.frame_end; end < tracks_.frames(); ++end) {
        const auto step = Step(joint, end);
        if (tracks_.time_s[end] - tracks_.time_s[run.frame_end - 1] > kJumpReach_s) break;
        if (!step || step->first < jump) continue;
        run.frame_end = end;
        break;
      }
      runs.push_back(run);
    }
    return runs;
  }

  /// Speed of a joint's step into frame f, m/s; 0 without a step.
  double Speed(int joint, int f) const {
    const auto step = Step(joint, f);
    return step && step->second > 0.0 ? step->first / step->second : 0.0;
  }

  /// Whether a joint jumps in frame f: faster than any hand, or much faster than in the steps before and after.
  bool JumpsInto(int joint, int f) const {
    const auto step = Step(joint, f);
    if (!step || step->first < std::max(kFarAway, kFarSigmas * noise_)) return false;
    return step->first >= kFastestHand * step->second || Sudden(joint, f);
  }

  bool Sudden(int joint, int f) const {
    const double around = std::max(Speed(joint, SeenBefore(joint, f)), Speed(joint, SeenAfter(joint, f)));
    return Speed(joint, f) >= kSudden * around;
  }

  int SeenAfter(int joint, int f) const {
    do {
      ++f;
    } while (f < tracks_.frames() && !tracks_.seen(f, joint));
    return f;
  }

  /// Share of frames [begin, end) in which one of the joint's bones is too long or too short; empty when not observed.
  std::optional<double> WrongBones(int joint, int begin, int end) const {
    int wrong = 0;
    int all = 0;
    for (int f = std::max(begin, 0); f < std::min(end, tracks_.frames()); ++f) {
      if (!tracks_.seen(f, joint)) continue;
      bool any = false;
      int bones = 0;
      const auto seen = [&](int other) { return tracks_.seen(f, other); };
      VisitNearest(joint, -1, 0.0, seen, [&](int other, double length) {
        const double away = (tracks_.positions.at(f, other) - tracks_.positions.at(f, joint)).norm() - length;
        const bool next =
            tracks_.skeleton->joints[joint].parent == other || tracks_.skeleton->joints[other].parent == joint;
        // The path over unobserved joints may be bent, so a short distance is no violation.
        if (!next && away < 0.0) return;
        any = any || std::abs(away) > std::max(kWrongBone, kWrongSigmas * noise_);
        ++bones;
      });
      if (bones == 0) continue;
      wrong += any ? 1 : 0;
      ++all;
    }
    if (all == 0) return {};
    return static_cast<double>(wrong) / all;
  }

  /// Share of frames with wrong bones in [begin, end), less that in equally many frames before and after; -1 to 1.
  double MoreWrongBetween(int joint, int begin, int end) const {
    const int length = end - begin;
    const auto inside = WrongBones(joint, begin, end);
    const auto before = WrongBones(joint, begin - length, begin);
    const auto after = WrongBones(joint, end, end + length);
    if (!inside || (!before && !after)) return 0.0;
    return *inside - std::max(before.value_or(0.0), after.value_or(0.0));
  }

  /// Whether the span is short, lies at an end of the clip and begins or ends with a jump too fast for a hand. Bone
  /// lengths may be correct by chance.
  bool CutOff(int joint, int begin, int end) const {
    const int jump = begin == 0 ? end : begin;
    if (begin > 0 && end < tracks_.frames()) return false;
    const double length_s = tracks_.time_s[end - 1] - tracks_.time_s[begin];
    return length_s <= kCutOff_s && Speed(joint, jump) >= kFastestHand && Sudden(joint, jump);
  }

  std::vector<BoneViolation> Jumps(int joint) const {
    std::vector<int> into = {0};
    for (int f = 1; f < tracks_.frames(); ++f) {
      if (JumpsInto(joint, f)) into.push_back(f);
    }
    into.push_back(tracks_.frames());
    std::vector<BoneViolation> jumps;
    for (std::size_t b = 0; b + 1 < into.size(); ++b) {
      const int begin = into[b];
      for (std::size_t e = b + 1; e < into.size(); ++e) {
        const int end = into[e];
        const bool whole = begin == 0 && end == tracks_.frames();
        if (whole || tracks_.time_s[end - 1] - tracks_.time_s[begin] > longest_s_) break;
        const auto there = Step(joint, begin);
        const auto back = Step(joint, end);
        const double step = std::max(there ? there->first : 0.0, back ? back->first : 0.0);
        const bool returns =
            there && back &&
            (tracks_.positions.at(end, joint) - tracks_.positions.at(SeenBefore(joint, begin), joint)).norm() <=
                kBack * there->first;
        if (end - begin < kMinViolationFrames) continue;
        const double more = MoreWrongBetween(joint, begin, end);
        const bool violation = more >= kMostlyWrong || (more > -kMostlyWrong && (returns || CutOff(joint, begin, end)));
        if (!violation) continue;
        jumps.push_back({joint, begin, end, step, true});
        b = e;
        break;
      }
    }
    return jumps;
  }

  /// Removes jumps that most joints make together: the whole person is in another place, as over frames missing in the
  /// data set.
  void RemoveWholeBodies(std::vector<BoneViolation>& found) const {
    std::vector<std::vector<std::pair<int, int>>> jumped(static_cast<std::size_t>(tracks_.joints()));
    for (const BoneViolation& run : found) {  // per joint sorted and disjoint
      if (run.jumped) jumped[static_cast<std::size_t>(run.joint)].emplace_back(run.frame_begin, run.frame_end);
    }
    const auto with_most = [&](const BoneViolation& violation) {
      if (!violation.jumped) return false;
      int jumping = 0, seen = 0;
      for (int j = 0; j < tracks_.joints(); ++j) {
        seen += tracks_.seen(violation.frame_begin, j) ? 1 : 0;
        const auto& runs = jumped[static_cast<std::size_t>(j)];
        const auto run = std::partition_point(runs.begin(), runs.end(),
                                              [&](const auto& other) { return other.second <= violation.frame_begin; });
        jumping += run != runs.end() && run->first < violation.frame_end ? 1 : 0;
      }
      return 2 * jumping > seen;
    };
    found.erase(std::remove_if(found.begin(), found.end(), with_most), found.end());
  }

  /// Joins runs that overlap.
  static void Merge(std::vector<BoneViolation> of_joint, std::vector<BoneViolation>& found) {
    std::sort(of_joint.begin(), of_joint.end(), [](const BoneViolation& a, const BoneViolation& b) {
      return std::pair(a.frame_begin, a.frame_end) < std::pair(b.frame_begin, b.frame_end);
    });
    const std::size_t first = found.size();
    for (const BoneViolation& run : of_joint) {
      if (found.size() == first || run.frame_begin > found.back().frame_end) {
        found.push_back(run);
        continue;
      }
      found.back().frame_end = std::max(found.back().frame_end, run.frame_end);
      found.back().distance = std::max(found.back().distance, run.distance);
      found.back().jumped = found.back().jumped && run.jumped;
    }
  }

  const SkeletonTracks& tracks_;
  const std::vector<double>& bone_length_;
  std::vector<std::vector<int>> children_;
  double noise_;
  double longest_s_;
};

}  // namespace

std::vector<BoneViolation> DetectBoneViolations(const SkeletonTracks& tracks, const std::vector<double>& bone_length,
                                                double noise_sigma, double longest_s) {
  return ViolationSearch(tracks, bone_length, noise_sigma, longest_s).Find();
}

}  // namespace mocurate
