#include "ingest/checks/unit_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/inspection.h"

namespace mocurate {
namespace {

constexpr double kManyOver = 0.05;             // share of angles over a whole turn that is no root alone
constexpr double kMostRadians = 1.1;           // of pi, that a joint is turned by
constexpr double kLeastRadians = 0.5;          // of the joint that is turned most
constexpr std::size_t kFewestOverColumns = 3;  // a pelvis may turn and turn
constexpr std::size_t kFewestTurningBones = 10;
constexpr std::size_t kLivelyJoints = 22;  // hands and face of SMPL-H and SMPL-X are often still

struct Angles {
  double largest = 0.0;
  std::size_t over = 0;  ///< a whole turn, in radians
  std::size_t all = 0;

  void Add(double angle) {
    largest = std::max(largest, angle);
    over += angle > 2.0 * kPi ? 1 : 0;
    ++all;
  }
  double share() const { return all == 0 ? 0.0 : static_cast<double>(over) / static_cast<double>(all); }
};

Finding AngleContradiction(double value, std::string message) {
  return MakeFinding("angle_unit_contradiction", Severity::kError, FourDecimals(value), std::move(message));
}

std::string OverWords(const Angles& angles) {
  return "up to " + Digits(angles.largest) + ", and " + Digits(100.0 * angles.share()) +
         " % of them more than a whole turn of 2 pi";
}

/// Of the bones, without the root, which may turn and turn.
Angles AnglesOfBones(const Amc& amc, const Asf* skeleton) {
  Angles angles;
  for (std::size_t b = 0; b < amc.bones.size(); ++b) {
    const AmcBone& bone = amc.bones[b];
    const int place = skeleton == nullptr ? -1 : skeleton->Find(bone.name);
    if (bone.name == "root" || (skeleton != nullptr && place < 0)) continue;
    for (int c = 0; c < bone.channels; ++c) {
      if (place >= 0 && !IsRotation(skeleton->bones[static_cast<std::size_t>(place)].dof[static_cast<std::size_t>(c)]))
        continue;
      for (int f = 0; f < amc.frames; ++f) {
        if (amc.has(f, static_cast<int>(b))) angles.Add(std::abs(amc.value(f, bone.first_channel + c)));
      }
    }
  }
  return angles;
}

/// Whether the root turns by more than radians do, unwound for a turn or two: a person who stands as at rest may face
/// anywhere.
bool RootRotationsInDegrees(const Amc& amc, const Asf* skeleton) {
  const int root = amc.Find("root");
  if (root < 0) return false;
  const AmcBone& bone = amc.bones[static_cast<std::size_t>(root)];
  for (int c = 0; c < bone.channels; ++c) {
    const bool turns = skeleton == nullptr ? c >= 3 : IsRotation(skeleton->root_order[static_cast<std::size_t>(c)]);
    for (int f = 0; turns && f < amc.frames; ++f) {
      if (amc.has(f, root) && std::abs(amc.value(f, bone.first_channel + c)) > 4.0 * kPi) return true;
    }
  }
  return false;
}

struct DecidingNumber {
  double value = 0.0;
  std::string place;  ///< "`axis` of bone 'lfemur'"
};

/// The first that is more than a whole turn in radians: of the axes of bones, else of their limits.
std::optional<DecidingNumber> MoreThanARevolution(const Asf& asf) {
  for (const AsfBone& bone : asf.bones) {
    for (const double angle : bone.axis.angles) {
      if (std::abs(angle) > 2.0 * kPi) return DecidingNumber{angle, "`axis` of bone '" + bone.name + "'"};
    }
  }
  for (const AsfBone& bone : asf.bones) {
    for (std::size_t i = 0; i < bone.limits.size(); ++i) {
      if (!IsRotation(bone.dof[i])) continue;
      for (const double angle : {bone.limits[i].least, bone.limits[i].most}) {
        if (std::isfinite(angle) && std::abs(angle) > 2.0 * kPi)
          return DecidingNumber{angle, "`limits` of bone '" + bone.name + "'"};
      }
    }
  }
  return std::nullopt;
}

/// Of small numbers: those of a body that moves, were they radians.
bool MayBeRadians(const Angles& angles) {
  return angles.largest >= kLeastRadians && angles.largest <= kMostRadians * kPi;
}

/// "pelvis_tx", "Abs_t1": the last part of the name of a coordinate.
bool IsTranslation(const std::string& label) {
  const std::size_t at = label.rfind('_');
  if (at == std::string::npos || label.size() != at + 3) return false;
  return label[at + 1] == 't' && std::string_view("xyz123").find(label[at + 2]) != std::string_view::npos;
}

/// Of SMPL's poses (frames, columns).
std::optional<Finding> CheckRotationVectors(const std::string& array, const std::vector<double>& poses,
                                            std::size_t frames) {
  const std::size_t columns = frames == 0 ? 0 : poses.size() / frames;
  const std::size_t joints = std::min(kLivelyJoints, columns / 3);
  Angles angles;
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      const double* turn = &poses[f * columns + 3 * j];
      angles.Add(std::hypot(turn[0], turn[1], turn[2]));
    }
  }
  if (angles.share() < kManyOver) return std::nullopt;
  return AngleContradiction(angles.largest,
                            "the rotation vectors in '" + array + "' are " + OverWords(angles) +
                                ": radians of a body are not, degrees are; multiply them by pi / 180 = 0.0174533");
}

constexpr std::size_t kBonesOfPerson = 15;                         // of a whole person
constexpr double kShortestRestPose = 1.0, kLongestRestPose = 3.0;  // metres, of a person's rest pose from end to end
constexpr double kMetresPerInch = 0.0254;
constexpr double kSameUnit = 0.05;  // of their ratio: recipes round 1 / 0.45

/// The longest side of the box around all ends of bones at rest, file units.
double ExtentAtRest(const Asf& asf) {
  std::vector<Vector3d> ends(asf.bones.size(), Vector3d::Zero());
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();
  for (const int bone : asf.Order()) {
    const AsfBone& b = asf.bones[static_cast<std::size_t>(bone)];
    Vector3d end = AsfOffset(b);
    if (b.parent >= 0) end += ends[static_cast<std::size_t>(b.parent)];
    ends[static_cast<std::size_t>(bone)] = end;
    low = low.cwiseMin(end);
    high = high.cwiseMax(end);
  }
  return (high - low).maxCoeff();
}

Finding AsfContradiction(const char* code, const std::string& bone, double value, std::string message) {
  Finding finding = MakeFinding(code, Severity::kError, FourDecimals(value), std::move(message));
  finding.joint = bone;
  return finding;
}

/// "rfemur" of "lfemur" and the other way round, "RightLeg" of "LeftLeg"; else empty.
std::string PartnerBone(std::string bone) {
  for (const auto& [left, right] : {std::pair<std::string, std::string>{"left", "right"}, {"Left", "Right"}}) {
    if (bone.rfind(left, 0) == 0) return right + bone.substr(left.size());
    if (bone.rfind(right, 0) == 0) return left + bone.substr(right.size());
  }
  const std::string sides = "lrLR", partners = "rlRL";
  const std::size_t side = bone.empty() ? std::string::npos : sides.find(bone[0]);
  if (side == std::string::npos) return "";
  bone[0] = partners[side];
  return bone;
}

/// Bones that only turn are of no length in some dialects, several of them on both sides. One alone, or one whose
/// partner of the other side has a length, has lost its own.
void CheckLostLengths(const Asf& asf, const std::string& file, std::vector<Finding>& findings) {
  std::map<std::string, double> lengths;
  for (const AsfBone& bone : asf.bones) lengths[bone.name] = bone.length;
  const auto none = [](const AsfBone& bone) { return !(bone.length > 0.0); };
  const bool alone = asf.bones.size() >= kBonesOfPerson && std::count_if(asf.bones.begin(), asf.bones.end(), none) == 1;
  for (const AsfBone& bone : asf.bones) {
    const auto partner = lengths.find(PartnerBone(bone.name));
    if (!none(bone) || !(alone || (partner != lengths.end() && partner->second > 0.0))) continue;
    findings.push_back(AsfContradiction(
        "bone_length", bone.name, 0.0,
        file + (bone.line > 0 ? ":" + std::to_string(bone.line) : "") + ": bone '" + bone.name + "' has length 0, " +
            (alone ? "all others have one" : "'" + partner->first + "' has one") + ": correct its `length`"));
  }
}

}  // namespace

std::optional<Finding> CheckAngleUnits(const Bvh& bvh) {
  Angles angles;
  std::size_t turning = 0;
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    const BvhJoint& joint = bvh.joints[j];
    bool turns = false;
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      if (IsPosition(joint.channels[c])) continue;
      turns = true;
      for (int f = 0; f < bvh.frames; ++f) {
        const double angle = std::abs(bvh.value(f, joint.first_channel + static_cast<int>(c)));
        if (j > 0) angles.Add(angle);
        if (j == 0 && angle > 4.0 * kPi) return std::nullopt;  // who stands as at rest may face anywhere
      }
    }
    turning += turns ? 1 : 0;
  }
  if (turning < kFewestTurningBones || !MayBeRadians(angles)) return std::nullopt;
  return AngleContradiction(angles.largest, "a BVH is in degrees, but no joint is rotated by more than " +
                                                Digits(angles.largest) + " in any of " + Counted(bvh.frames, "frame") +
                                                ": they are radians; multiply them by 180 / pi = 57.2958");
}

std::optional<Finding> CheckAngleUnits(const OpenSimTable& table) {
  if (!table.in_degrees || table.components != 1 || table.title != "Coordinates") return std::nullopt;
  Angles angles;
  std::size_t turning = 0, over = 0;
  for (int c = 0; c < static_cast<int>(table.labels.size()); ++c) {
    if (IsTranslation(table.labels[static_cast<std::size_t>(c)])) continue;
    Angles own;
    for (int row = 0; row < table.rows(); ++row) own.Add(std::abs(table.value(row, c)));
    if (own.largest == 0.0) continue;  // a locked coordinate
    ++turning;
    over += own.over > 0 ? 1 : 0;
    angles.largest = std::max(angles.largest, own.largest);
    angles.over += own.over;
    angles.all += own.all;
  }
  if (turning < kFewestTurningBones) return std::nullopt;
  if (!*table.in_degrees && over >= kFewestOverColumns && angles.share() >= kManyOver) {
    return AngleContradiction(angles.largest, "the header declares inDegrees=no, but angles are " + OverWords(angles) +
                                                  ": they are degrees; write inDegrees=yes");
  }
  if (*table.in_degrees && MayBeRadians(angles)) {
    return AngleContradiction(angles.largest,
                              "the header declares inDegrees=yes, but no coordinate is rotated by more than " +
                                  Digits(angles.largest) + " in any of " + Counted(table.rows(), "row") +
                                  ": they are radians; write inDegrees=no");
  }
  return std::nullopt;
}

std::optional<Finding> CheckAngleUnits(const Amass& amass) {
  return CheckRotationVectors("poses", amass.poses, amass.frames);
}

std::optional<Finding> CheckAngleUnits(const HumanAct12Clip& clip) {
  return CheckRotationVectors("poses", clip.poses, clip.frames);
}

std::optional<Finding> CheckAngleUnits(const VibeTrack& track) {
  return CheckRotationVectors("pose", track.pose, track.frames);
}

std::optional<Finding> CheckAngleUnits(const Amc& amc, const Asf* skeleton) {
  if (amc.bones.size() < kFewestTurningBones || (!amc.degrees && skeleton == nullptr)) return std::nullopt;
  const bool degrees = amc.degrees ? *amc.degrees : skeleton->degrees;
  const std::string who = amc.degrees ? "the header declares " : "the skeleton's :units declare ";
  const Angles angles = AnglesOfBones(amc, skeleton);
  if (!degrees && angles.share() >= kManyOver) {
    return AngleContradiction(angles.largest, who + ":RADIANS, but angles of bones are " + OverWords(angles) +
                                                  ": they are degrees; write :DEGREES");
  }
  if (degrees && MayBeRadians(angles) && !RootRotationsInDegrees(amc, skeleton)) {
    return AngleContradiction(angles.largest, who + ":DEGREES, but no bone is rotated by more than " +
                                                  Digits(angles.largest) + " in any of " + std::to_string(amc.frames) +
                                                  " frames: they are radians; write :RADIANS");
  }
  return std::nullopt;
}

std::optional<Finding> CheckAngleUnits(const Asf& asf, const Amc* amc) {
  if (asf.degrees) return std::nullopt;
  const std::optional<DecidingNumber> number = MoreThanARevolution(asf);
  if (!number) return std::nullopt;
  const std::string other = amc == nullptr || !amc->degrees ? ""
                            : *amc->degrees                 ? ", the motion's header :DEGREES"
                                                            : ", the motion's header :RADIANS";
  return AngleContradiction(number->value, "the skeleton's :units declare `angle rad`" + other + ", but " +
                                               number->place + " is " + Digits(number->value) +
                                               ", more than a whole turn of 2 pi: its angles are degrees; write "
                                               "`angle deg` under :units");
}

std::vector<Finding> CheckAsfSkeleton(const Asf& asf, const std::string& file, std::optional<double> declared_m) {
  std::vector<Finding> findings;
  CheckLostLengths(asf, file, findings);
  if (asf.bones.size() < kBonesOfPerson || !(asf.length_unit > 0.0)) return findings;
  const double units = ExtentAtRest(asf);
  const double metres = units / asf.length_unit * kMetresPerInch;
  if (!(units > 0.0)) return findings;
  const std::string own = "the rest pose measures " + Digits(units) + " file units from end to end; with `length " +
                          Digits(asf.length_unit) + "` in :units (file units per inch) that is " + Digits(metres) +
                          " m";
  const std::string said = declared_m ? Digits(units * *declared_m) + " m by the source's `units`" : std::string();
  if (metres < kShortestRestPose || metres > kLongestRestPose) {
    findings.push_back(AsfContradiction("length_unit_contradiction", "", metres,
                                        own + " (a person: " + Digits(kShortestRestPose) + " to " +
                                            Digits(kLongestRestPose) + " m)" + (said.empty() ? "" : " (" + said + ")") +
                                            ": correct `length` in :units, or the lengths of the bones"));
  } else if (declared_m && std::abs(units * *declared_m / metres - 1.0) > kSameUnit) {
    findings.push_back(AsfContradiction(
        "length_unit_contradiction", "", metres,
        own + ", but " + said + ": correct `length` in :units, or declare ingest.source.units of this skeleton"));
  }
  return findings;
}

}  // namespace mocurate
