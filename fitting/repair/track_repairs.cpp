#include "fitting/repair/track_repairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/text.h"
#include "core/quality/checks.h"
#include "core/quality/tracked_points.h"
#include "fitting/repair/body_sides.h"
#include "fitting/repair/bone_violations.h"
#include "fitting/repair/exchanges.h"
#include "fitting/solver/bone_lengths.h"

namespace mocurate {
namespace {

/// The repair of a finding, without joints.
TrackRepair RepairOf(const Finding& finding) {
  return {finding.code,   TrackRepair::Action::kExcluded, finding.frame_begin, finding.frame_end, {}, finding.value,
          finding.message};
}

class Repairs {
 public:
  explicit Repairs(const SkeletonTracks& given) {
    result_.tracks = given;
    result_.exchanged.assign(given.confidence.size(), false);
    for (const Joint& joint : given.skeleton->joints) names_.push_back(joint.name);
  }

  /// Excludes the samples of findings. A span longer than `longest_s`, or with more than half of a joint's samples, may
  /// be real and stays. A lasting or unrecovered jump is reported.
  void Exclude(const std::vector<Finding>& findings, double longest_s) {
    SkeletonTracks& tracks = result_.tracks;
    for (const Finding& finding : findings) {
      const bool lasting = tracks.time_s[finding.frame_end - 1] - tracks.time_s[finding.frame_begin] > longest_s;
      if (finding.code == "unrecovered_jump" || (lasting && finding.code == "position_jump"))
        result_.findings.push_back(finding);
      if (finding.code == "unrecovered_jump" || lasting) continue;
      TrackRepair repair = RepairOf(finding);
      for (int j = 0; j < tracks.joints(); ++j) {
        if (!finding.joint.empty() && names_[j] != finding.joint) continue;
        if (Exclude(j, finding.frame_begin, finding.frame_end)) repair.joints.push_back(j);
      }
      if (!repair.joints.empty()) result_.repairs.push_back(std::move(repair));
    }
  }

  /// Excludes frames in which all joints have one position, however many: no person was observed.
  void ExcludeEmptyFrames() {
    for (const Finding& finding : FindBlanks(points())) {
      if (finding.code != "zero_frames" && finding.code != "collapsed_frames") continue;
      TrackRepair repair = RepairOf(finding);
      for (int j = 0; j < result_.tracks.joints(); ++j) {
        repair.joints.push_back(j);
        for (int f = finding.frame_begin; f < finding.frame_end; ++f) result_.tracks.confidence[At(f, j)] = 0.0;
      }
      result_.repairs.push_back(std::move(repair));
    }
  }

  void ExcludeCollapsed() {
    const SkeletonTracks given = result_.tracks;  // unchanged, so that every joint of a collapsed chain is reported
    SkeletonTracks& tracks = result_.tracks;
    int seen = 0, collapsed = 0;
    for (int f = 0; f < given.frames(); ++f) {
      for (int j = 0; j < given.joints(); ++j) {
        seen += given.seen(f, j) ? 1 : 0;
        collapsed += IsAtParent(given, f, j) ? 1 : 0;
      }
    }
    if (2 * collapsed > seen) return;  // not a person: the fit reports it
    for (int j = 1; j < tracks.joints(); ++j) {
      for (int f = 0; f < tracks.frames(); ++f) {
        if (!IsAtParent(given, f, j)) continue;
        const int begin = f;
        while (f < tracks.frames() && IsAtParent(given, f, j)) tracks.confidence[At(f++, j)] = 0.0;
        result_.repairs.push_back({"zero_length_bone",
                                   TrackRepair::Action::kExcluded,
                                   begin,
                                   f,
                                   {j},
                                   static_cast<double>(f - begin),
                                   names_[j] + " has exactly the position of its parent " +
                                       names_[tracks.skeleton->joints[j].parent] + " in " +
                                       Counted(f - begin, "frame")});
      }
    }
  }

  void Exclude(const BoneViolation& violation, double longest_s) {
    const SkeletonTracks& tracks = result_.tracks;
    if (tracks.time_s[violation.frame_end - 1] - tracks.time_s[violation.frame_begin] > longest_s) return;
    if (!Exclude(violation.joint, violation.frame_begin, violation.frame_end)) return;
    result_.repairs.push_back(
        {"bone_length_violation",
         TrackRepair::Action::kExcluded,
         violation.frame_begin,
         violation.frame_end,
         {violation.joint},
         violation.distance,
         names_[violation.joint] + " is in a wrong position in " +
             Counted(violation.frame_end - violation.frame_begin, "frame") +
             (violation.jumped ? ": it jumps there or back by " : ": its bones would be too long by ") +
             RoundedText(violation.distance, 3) + " m"});
  }

  void Exchange(const LimbExchange& limb) {
    std::vector<std::string> joints;
    for (const int left : limb.pairs) joints.push_back(names_[left]);
    Exchange(limb.frame_begin, limb.frame_end, limb.pairs, limb.margin,
             JoinTexts(joints) + " and their mirror joints are exchanged in " +
                 Counted(limb.frame_end - limb.frame_begin, "frame") +
                 ": after the exchange, steps and bone lengths are more likely");
  }

  void Exchange(const BodyExchange& body) {
    Exchange(body.frame_begin, body.frame_end, LeftJoints(*result_.tracks.skeleton), body.confidence,
             "left and right of the whole body are exchanged in " +
                 Counted(body.frame_end - body.frame_begin, "frame") + ": " + body.evidence);
  }

  void ReportMirroredBody(const BodyExchange& body) {
    result_.findings.push_back(
        MakeFinding("sides_exchanged", Severity::kError, body.confidence,
                    "left and right are exchanged throughout, or the axes are mirrored: " + body.evidence +
                        "; correct the joint names or the axes in the source declaration"));
  }

  void ReportReversedBody(const LimbExchange& limb) {
    result_.findings.push_back(FrameFinding(
        "body_turned", limb.frame_begin, limb.frame_end, "", limb.margin,
        "the body's facing reverses from one frame to the next, as if left and right were exchanged, in " +
            Counted(limb.frame_end - limb.frame_begin, "frame") +
            ". The frames are kept, because an exchange would point knees, feet, hands or shoulders backwards. Check "
            "facing in these frames and in the others"));
  }

  TrackedPoints points() const {
    return {result_.tracks.positions, result_.tracks.confidence, result_.tracks.time_s, names_};
  }
  const SkeletonTracks& tracks() const { return result_.tracks; }
  RepairedTracks Take() { return std::move(result_); }

 private:
  std::size_t At(int f, int j) const {
    return static_cast<std::size_t>(f) * names_.size() + static_cast<std::size_t>(j);
  }

  void Exchange(int begin, int end, const std::vector<int>& left_joints, double value, std::string message) {
    ExchangeJoints(left_joints, begin, end, result_.tracks);
    observed_count_.clear();
    for (int f = begin; f < end; ++f) {
      for (const int left : left_joints) {
        for (const int joint : {left, result_.tracks.skeleton->joints[left].mirror})
          result_.exchanged[At(f, joint)] = !result_.exchanged[At(f, joint)];
      }
    }
    result_.repairs.push_back(
        {"swapped_sides", TrackRepair::Action::kExchanged, begin, end, left_joints, value, std::move(message)});
  }

  bool Exclude(int joint, int begin, int end) {
    SkeletonTracks& tracks = result_.tracks;
    int here = 0;
    for (int f = begin; f < end; ++f) here += tracks.seen(f, joint) ? 1 : 0;
    if (here == 0) return false;
    int& all = ObservedCount(joint);
    if (2 * here > all) return false;
    for (int f = begin; f < end; ++f) tracks.confidence[At(f, joint)] = 0.0;
    all -= here;
    return true;
  }

  /// Frames that observe a joint; the cache is cleared after exchanges.
  int& ObservedCount(int joint) {
    const auto of_joint = observed_count_.find(joint);
    if (of_joint != observed_count_.end()) return of_joint->second;
    int& count = observed_count_[joint];
    for (int f = 0; f < result_.tracks.frames(); ++f) count += result_.tracks.seen(f, joint) ? 1 : 0;
    return count;
  }

  RepairedTracks result_;
  std::vector<std::string> names_;
  std::map<int, int> observed_count_;
};

/// Repeats without their first frame, which is a normal observation.
std::vector<Finding> Repeated(std::vector<Finding> findings) {
  for (Finding& finding : findings) ++finding.frame_begin;
  return findings;
}

/// Where most frames of a chain are exchanged, the search by limbs would exchange the others.
void CorrectBodies(double noise_sigma, double least_margin, Repairs& repairs) {
  std::vector<BodyExchange> bodies = FindBodyExchanges(repairs.tracks(), noise_sigma, least_margin);
  bodies.erase(std::remove_if(bodies.begin(), bodies.end(), [](const BodyExchange& body) { return body.rarer; }),
               bodies.end());
  if (bodies.empty()) return;
  if (CoverAll(bodies, repairs.tracks())) return repairs.ReportMirroredBody(bodies.front());
  for (const BodyExchange& body : bodies) repairs.Exchange(body);
}

bool Overlap(const LimbExchange& a, const LimbExchange& b) {
  return a.frame_begin < b.frame_end && b.frame_begin < a.frame_end;
}

/// Whether the shoulder line points against the hip line in most frames.
bool TwistedTrunk(const SkeletonTracks& tracks) {
  const auto hips = tracks.skeleton->Hips();
  const auto shoulders = tracks.skeleton->Shoulders();
  if (!hips || !shoulders) return false;
  int seen = 0, against = 0;
  for (int f = 0; f < tracks.frames(); ++f) {
    const auto across = [&](const std::array<int, 2>& pair) {
      return Vector3d(tracks.positions.at(f, pair[1]) - tracks.positions.at(f, pair[0]));
    };
    const std::array<int, 4> joints = {(*hips)[0], (*hips)[1], (*shoulders)[0], (*shoulders)[1]};
    if (!std::all_of(joints.begin(), joints.end(), [&](int joint) { return tracks.seen(f, joint); })) continue;
    ++seen;
    against += across({joints[0], joints[1]}).dot(across({joints[2], joints[3]})) < 0.0 ? 1 : 0;
  }
  return 2 * against > seen;
}

/// A tracker that takes the back of a person for the front rotates the whole body in one step, feet and face included.
/// An exchange of sides would then point the feet backwards, or the shoulders against the hips. Which of both is
/// correct is ambiguous: nothing is changed.
void CorrectLimbs(const std::vector<double>& bone_length, double noise_sigma, double least_margin, bool keep_reversed,
                  Repairs& repairs) {
  const SkeletonTracks given = repairs.tracks();
  std::vector<LimbExchange> limbs = FindExchanges(given, bone_length, noise_sigma, least_margin);
  SkeletonTracks corrected = given;
  for (const LimbExchange& limb : limbs) ExchangeJoints(limb.pairs, limb.frame_begin, limb.frame_end, corrected);
  std::vector<LimbExchange> reversed;
  for (const LimbExchange& limb : limbs) {
    const SkeletonTracks before = CutTracks(given, limb.frame_begin, limb.frame_end);
    const SkeletonTracks after = CutTracks(corrected, limb.frame_begin, limb.frame_end);
    const bool backwards = SidesExchangedByAnatomy(before) == false && SidesExchangedByAnatomy(after) == true;
    if (keep_reversed && (backwards || (!TwistedTrunk(before) && TwistedTrunk(after)))) reversed.push_back(limb);
  }
  for (const LimbExchange& limb : limbs) {
    const bool with_reversed =
        std::any_of(reversed.begin(), reversed.end(), [&](const LimbExchange& other) { return Overlap(limb, other); });
    if (!with_reversed) repairs.Exchange(limb);
  }
  for (std::size_t i = 0; i < reversed.size(); ++i) {
    if (i == 0 || !Overlap(reversed[i], reversed[i - 1])) repairs.ReportReversedBody(reversed[i]);
  }
}

}  // namespace

RepairedTracks RepairLimbs(const SkeletonTracks& given, const std::vector<double>& bone_length, double noise_sigma,
                           const RepairOptions& options) {
  Repairs repairs(given);
  CorrectLimbs(bone_length, noise_sigma, options.swap_margin, options.rules.on(FittingRule::kReversedBody), repairs);
  return repairs.Take();
}

RepairedTracks RepairTracks(const SkeletonTracks& given, const std::vector<double>& bone_length, double noise_sigma,
                            const RepairOptions& options) {
  Repairs repairs(given);
  if (options.collapsed) {
    repairs.ExcludeEmptyFrames();
    repairs.ExcludeCollapsed();
  }
  if (options.position_jumps) repairs.Exclude(FindPositionJumps(repairs.points()), options.longest_jump_s);
  if (options.repeated_values) {
    const auto least = static_cast<int>(options.repeated_frames);
    repairs.Exclude(Repeated(FindRepeats(repairs.points(), {least, least})), options.longest_repeat_s);
  }
  if (options.swaps) {
    if (options.rules.on(FittingRule::kBodySides)) CorrectBodies(noise_sigma, options.swap_margin, repairs);
    CorrectLimbs(bone_length, noise_sigma, options.swap_margin, options.rules.on(FittingRule::kReversedBody), repairs);
  }
  if (options.bone_violations) {  // last: an exchanged hand looks like a bone-length violation
    for (const BoneViolation& violation :
         DetectBoneViolations(repairs.tracks(), bone_length, noise_sigma, options.longest_jump_s))
      repairs.Exclude(violation, options.longest_jump_s);
  }
  return repairs.Take();
}

void MarkRepaired(const std::vector<bool>& exchanged, Motion& motion) {
  for (std::size_t i = 0; i < exchanged.size(); ++i) {
    JointState& state = motion.state[i];
    if (exchanged[i] && state == JointState::kObserved) state = JointState::kRepaired;
  }
}

std::vector<Finding> FindingsOf(const std::vector<TrackRepair>& repairs, const Skeleton& skeleton) {
  std::vector<Finding> findings;
  for (const TrackRepair& repair : repairs) {
    const bool exchanged = repair.action == TrackRepair::Action::kExchanged;
    const bool whole = exchanged ? repair.joints == LeftJoints(skeleton)
                                 : static_cast<int>(repair.joints.size()) == skeleton.joint_count();
    findings.push_back(FrameFinding(repair.code.c_str(), repair.frame_begin, repair.frame_end,
                                    whole ? "" : skeleton.joints[repair.joints.front()].name, repair.value,
                                    repair.message));
    findings.back().severity = Severity::kInfo;
    findings.back().action = exchanged ? FindingAction::kRepaired : FindingAction::kMissing;
  }
  return findings;
}

std::string RepairsText(const std::vector<TrackRepair>& repairs, const Skeleton& skeleton) {
  nlohmann::json list = nlohmann::json::array();
  for (const TrackRepair& repair : repairs) {
    nlohmann::json joints = nlohmann::json::array();
    for (const int joint : repair.joints) joints.push_back(skeleton.joints[joint].name);
    list.push_back({{"code", repair.code},
                    {"action", repair.action == TrackRepair::Action::kExchanged ? "exchanged" : "excluded"},
                    {"frames", {repair.frame_begin, repair.frame_end}},
                    {"joints", joints},
                    {"value", std::round(1e3 * repair.value) / 1e3}});
  }
  return list.dump();
}

}  // namespace mocurate
