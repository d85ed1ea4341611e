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
