#include "ingest/checks/asf_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/quality/tracked_points.h"
#include "ingest/inspect/inspection.h"

namespace mocurate {
namespace {

constexpr std::size_t kBonesOfPerson = 15;                         // of a whole person
constexpr double kShortestRestPose = 1.0, kLongestRestPose = 3.0;  // metres, of a person's rest pose from end to end
constexpr double kMetresPerInch = 0.0254;
// A bone over its partner of the other side. In the 8 skeletons of CMU and HDM05 that are recorded the most unequal are
// hands (1.16) and collar bones (1.15), of arms and legs a forearm (1.13).
constexpr double kMostUnequal = 1.5;
// Degrees between a bone's direction at rest and its partner's, mirrored. Of the same skeletons: collar bones up to 12,
// arms and legs up to 1.
constexpr double kMirrored = 15.0, kNotMirrored = 30.0;
constexpr std::size_t kFewestMirrored = 5;  // pairs that show the plane
constexpr double kMostMirrored = 0.8;       // of all pairs
constexpr double kSameUnit = 0.05;          // of their ratio: recipes round 1 / 0.45

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

/// "rfemur" of "lfemur", "RightLeg" of "LeftLeg".
std::string PartnerBone(const std::string& bone) {
  for (const auto& [left, right] : {std::pair<const char*, const char*>{"left", "right"}, {"Left", "Right"}}) {
    if (bone.rfind(left, 0) == 0) return right + bone.substr(std::string(left).size());
  }
  if (bone.size() < 2 || (bone[0] != 'l' && bone[0] != 'L')) return "";
  return (bone[0] == 'l' ? "r" : "R") + bone.substr(1);
}

/// Bones of both sides, left and right.
std::vector<std::pair<const AsfBone*, const AsfBone*>> PairsOf(const Asf& asf) {
  std::vector<std::pair<const AsfBone*, const AsfBone*>> pairs;
  std::map<std::string, const AsfBone*> by_name;
  for (const AsfBone& bone : asf.bones) by_name.emplace(bone.name, &bone);
  for (const AsfBone& left : asf.bones) {
    const auto partner = by_name.find(PartnerBone(left.name));
    if (partner != by_name.end()) pairs.emplace_back(&left, partner->second);
  }
  return pairs;
}

std::string PlaceOfBone(const std::string& file, const AsfBone& bone) {
  return file + (bone.line > 0 ? ":" + std::to_string(bone.line) : "") + ": bone '" + bone.name + "'";
}

void CheckLimbPairs(const Asf& asf, const std::string& file, std::vector<Finding>& findings) {
  for (const auto& [left, right] : PairsOf(asf)) {
    if (left->length == right->length) continue;
    const AsfBone& shorter = left->length < right->length ? *left : *right;
    const AsfBone& longer = left->length < right->length ? *right : *left;
    const bool none = !(shorter.length > 0.0);
    const double ratio = none ? 0.0 : longer.length / shorter.length;
    if (!none && ratio < kMostUnequal) continue;
    findings.push_back(AsfContradiction("bone_length", shorter.name, ratio,
                                        PlaceOfBone(file, shorter) + " of length " + Digits(shorter.length) +
                                            (none ? ", while " : " is " + Digits(ratio) + " times shorter than ") +
                                            "'" + longer.name + "' of the other side" + (none ? " has " : ", ") +
                                            Digits(longer.length) + " (line " + std::to_string(longer.line) +
                                            "); those of people differ by less than " + Digits(kMostUnequal) +
                                            " times: correct `length` of one of them"));
  }
}

/// Bones that only turn are of no length in some dialects, several of them. One alone is a length that got lost.
void CheckZeroDegreesOfFreedom(const Asf& asf, const std::string& file, std::vector<Finding>& findings) {
  const AsfBone* none = nullptr;
  for (const AsfBone& bone : asf.bones) {
    if (bone.length > 0.0) continue;
    if (none != nullptr) return;
    none = &bone;
  }
  if (none == nullptr || asf.bones.size() < kBonesOfPerson) return;
  for (const Finding& finding : findings) {
    if (finding.joint == none->name) return;
  }
  findings.push_back(AsfContradiction("bone_length", none->name, 0.0,
                                      PlaceOfBone(file, *none) + " has length 0, all " +
                                          std::to_string(asf.bones.size() - 1) +
                                          " others have one: correct its `length`"));
}

double DegreesBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / EIGEN_PI;
}

Vector3d Flipped(Vector3d direction, int axis) {
  direction[axis] = -direction[axis];
  return direction;
}

/// The axis across which left and right mirror each other in most pairs; -1: none.
int SideAxis(const std::vector<std::pair<const AsfBone*, const AsfBone*>>& pairs) {
  for (int axis = 0; axis < 3; ++axis) {
    std::size_t mirrored = 0, aside = 0;
    for (const auto& [left, right] : pairs) {
      if (DegreesBetween(Flipped(left->direction, axis), right->direction) > kMirrored) continue;
      ++mirrored;
      if (DegreesBetween(left->direction, right->direction) > kNotMirrored) ++aside;
    }
    const bool most = static_cast<double>(mirrored) >= kMostMirrored * static_cast<double>(pairs.size());
    if (mirrored >= kFewestMirrored && aside >= 2 && most) return axis;
  }
  return -1;
}

/// The side where most bones of the left point along the axis: 1 or -1.
double LeftOf(const std::vector<std::pair<const AsfBone*, const AsfBone*>>& pairs, int axis) {
  double sum = 0.0;
  for (const auto& [left, right] : pairs) sum += left->direction[axis] - right->direction[axis];
  return sum < 0.0 ? -1.0 : 1.0;
}

/// A direction whose sign is changed along one axis is no mirror of its partner's, and becomes one with the sign back.
void CheckDirections(const Asf& asf, const std::string& file, std::vector<Finding>& findings) {
  const auto pairs = PairsOf(asf);
  const int side = SideAxis(pairs);
  if (side < 0) return;
  for (const auto& [left, right] : pairs) {
    const double off = DegreesBetween(Flipped(left->direction, side), right->direction);
    if (off < kNotMirrored || !(left->length > 0.0) || !(right->length > 0.0)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (DegreesBetween(Flipped(Flipped(left->direction, side), axis), right->direction) > kMirrored) continue;
      // Both point to one side: the one that points to the other's is wrong. Along other axes either may be.
      const bool of_left = axis != side || left->direction[side] * LeftOf(pairs, side) < 0.0;
      const AsfBone& bone = of_left ? *left : *right;
      const AsfBone& other = of_left ? *right : *left;
      const std::string letter(1, "xyz"[axis]);
      findings.push_back(AsfContradiction(
          "bone_direction", bone.name, off,
          PlaceOfBone(file, bone) + " has the direction " + Digits(bone.direction.x()) + " " +
              Digits(bone.direction.y()) + " " + Digits(bone.direction.z()) + ", " + Digits(off) +
              " degrees from the mirror image of '" + other.name + "' (line " + std::to_string(other.line) +
              "); the other pairs of bones are mirror images, and so is this one with the sign of " + letter +
              " changed" + (axis == side ? "" : " in one of the two") + ": correct `direction`"));
      break;
    }
  }
}

}  // namespace

std::vector<Finding> CheckAsfSkeleton(const Asf& asf, const std::string& file, std::optional<double> declared_m) {
  std::vector<Finding> findings;
  CheckLimbPairs(asf, file, findings);
  CheckZeroDegreesOfFreedom(asf, file, findings);
  CheckDirections(asf, file, findings);
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
