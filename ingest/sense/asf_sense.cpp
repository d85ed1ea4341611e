#include "ingest/sense/asf_sense.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr std::size_t kBonesOfPerson = 15;                         // of a whole person
constexpr double kShortestRestPose = 1.0, kLongestRestPose = 3.0;  // metres, of a person's rest pose from end to end
constexpr double kMetresPerInch = 0.0254;
constexpr double kMostUnequal = 5.0;
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
  Finding finding = FrameFinding(code, 0, 0, bone, std::round(value * 1e4) / 1e4, std::move(message));
  finding.severity = Severity::kError;
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

}  // namespace

std::vector<Finding> DoubtLengths(const Asf& asf, std::optional<double> declared_m) {
  std::vector<Finding> findings;
  for (const AsfBone& left : asf.bones) {
    const int partner = asf.Find(PartnerBone(left.name));
    if (partner < 0) continue;
    const AsfBone& right = asf.bones[static_cast<std::size_t>(partner)];
    if (!(left.length > 0.0) || !(right.length > 0.0)) continue;
    const double ratio = std::max(left.length / right.length, right.length / left.length);
    if (ratio < kMostUnequal) continue;
    const AsfBone& shorter = left.length < right.length ? left : right;
    const AsfBone& longer = left.length < right.length ? right : left;
    findings.push_back(AsfContradiction("bone_length", shorter.name, ratio,
                                        "bone '" + shorter.name + "' of length " + Digits(shorter.length) + " is " +
                                            Digits(ratio) + " times shorter than '" + longer.name +
                                            "' of the other side, " + Digits(longer.length) +
                                            ": mend `length` of one of them"));
  }
  if (asf.bones.size() < kBonesOfPerson || !(asf.length_unit > 0.0)) return findings;
  const double units = ExtentAtRest(asf);
  const double metres = units / asf.length_unit * kMetresPerInch;
  if (!(units > 0.0)) return findings;
  const std::string own = "at rest the skeleton measures " + Digits(units) + " from end to end; with `length " +
                          Digits(asf.length_unit) + "` under :units (numbers divided by it are inches) that is " +
                          Digits(metres) + " m";
  const std::string said = declared_m ? Digits(units * *declared_m) + " m by the source's `units`" : std::string();
  if (metres < kShortestRestPose || metres > kLongestRestPose) {
    findings.push_back(AsfContradiction("length_unit_contradiction", "", metres,
                                        own + ", which is no person" + (said.empty() ? "" : " (" + said + ")") +
                                            ": mend that `length`, or those of the bones"));
  } else if (declared_m && std::abs(units * *declared_m / metres - 1.0) > kSameUnit) {
    findings.push_back(
        AsfContradiction("length_unit_contradiction", "", metres,
                         own + ", but " + said + ": mend that `length`, or say ingest.source.units of this skeleton"));
  }
  return findings;
}

}  // namespace mocurate
