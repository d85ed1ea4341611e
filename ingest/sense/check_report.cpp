#include "ingest/sense/check_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/quality/checks.h"
#include "ingest/sense/clip_report.h"

namespace mocurate {
namespace {

constexpr double kUsualRate = 30.0;

/// Metres, y up, from units of the file; the heading is whatever it becomes.
Matrix3d MetresYUp(double metres, const std::string& up) {
  Matrix3d turn = Matrix3d::Identity();
  if (up.size() == 2 && up[1] >= 'x' && up[1] <= 'z') {
    Vector3d axis = Vector3d::Zero();
    axis[up[1] - 'x'] = up[0] == '-' ? -1.0 : 1.0;
    turn = SwingBetween(axis, Vector3d::UnitY()).toRotationMatrix();
  }
  return metres * turn;
}

}  // namespace

void ReportChecks(const ObservedClip& clip, const std::string& units, const std::string& up, const std::string& where,
                  nlohmann::json& findings) {
  if (clip.positions.empty() || clip.positions.frames < 2) return;
  const auto metres = MetresPerUnit(units);
  const Matrix3d map = MetresYUp(metres ? *metres : 1.0, up);
  JointPositions positions(clip.positions.frames, clip.positions.joints);
  const double rate = clip.rate_hz.value_or(kUsualRate);
  std::vector<double> time_s;
  for (int f = 0; f < positions.frames; ++f) {
    time_s.push_back(f / rate);
    for (int j = 0; j < positions.joints; ++j) positions.at(f, j) = map * clip.positions.at(f, j);
  }
  CheckLimits limits;
  limits.metres = metres.has_value() && !up.empty();
  const TrackedPoints points{positions, clip.confidence, time_s, clip.names};
  for (const Finding& finding : CheckPoints(points, rate, limits)) {
    if (finding.code == "rate_doubtful" && !clip.rate_hz) continue;
    if (finding.code == "zero_joint" && !clip.parents.empty()) continue;  // a tree's joint may lie at its origin
    std::string place = where;
    if (finding.frame_end > finding.frame_begin) {
      place += " frames " + std::to_string(finding.frame_begin) + "-" + std::to_string(finding.frame_end);
    }
    if (!finding.joint.empty()) place += " joint " + finding.joint;
    findings.push_back(InspectionFinding(finding.code, finding.severity, place, std::round(finding.value * 1e4) / 1e4,
                                         finding.message));
  }
}

}  // namespace mocurate
