#include "ingest/inspect/calibration_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/geometry/camera.h"
#include "ingest/options.h"

namespace mocurate {
namespace {

constexpr std::array<PoseConvention, 3> kPoseConventions = {PoseConvention::kWorldToCamera, PoseConvention::kCentre,
                                                            PoseConvention::kCameraToWorld};
constexpr double kAimError = 8.0 * kPi / 180.0;  ///< how far cameras aim beside the common point
constexpr double kDepthRange = 5.0;              ///< metres; Kinect-like depth cameras measure nothing beyond
constexpr double kContradiction = 0.99;

std::string ThreeDigits(double value) {
  const double digits = value == 0.0 ? 1.0 : std::pow(10.0, 2.0 - std::floor(std::log10(std::abs(value))));
  return FormatDouble(std::round(value * digits) / digits);
}

/// What one reading of a calibration implies.
struct ConventionScore {
  double log_likelihood = 0.0;
  std::vector<double> miss;      ///< of the axes, file units
  std::vector<double> distance;  ///< camera to the common point, file units; in front only
  std::size_t behind = 0;        ///< cameras that have the common point behind them
  std::optional<double> subject_share;
};

/// Optical axes of one world: each camera's angle to the common point, heavy-tailed; and the distance of that point,
/// which is about the distance between cameras that surround a person (nearly parallel axes meet far away, in any
/// reading).
void ScoreAxes(const std::vector<RigidTransform>& poses, ConventionScore& score) {
  const std::optional<AxesMeeting> meeting = NearestPointToAxes(poses);
  if (!meeting) return;
  // Cameras of a large dome say the same thing again and again.
  const double weight = std::min(1.0, 12.0 / static_cast<double>(poses.size()));
  Vector3d middle = Vector3d::Zero();
  for (const RigidTransform& pose : poses) middle += Inverse(pose).translation / static_cast<double>(poses.size());
  double spread = 0.0;
  std::vector<double> distances;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    spread = std::max(spread, (Inverse(poses[i]).translation - middle).norm());
    const double angle = std::atan2(meeting->miss[i], meeting->depth[i]) / kAimError;
    score.log_likelihood -= weight * std::log1p(angle * angle);
    score.miss.push_back(meeting->miss[i]);
    distances.push_back(std::abs(meeting->depth[i]));
    if (meeting->depth[i] > 0.0) {
      score.distance.push_back(meeting->depth[i]);
    } else {
      ++score.behind;
    }
  }
  const double distance = Median(distances);
  if (spread > 0.0 && distance > spread) {
    const double far = std::log(distance / spread);
    score.log_likelihood -= 2.0 * std::log1p(far * far);
  }
}

/// Subject points: the share in front of each camera, inside or near its image and within reach of a depth camera.
/// `reach`: per camera, file units.
void ScoreSubject(const std::vector<Camera>& cameras, const std::vector<double>& reach,
                  const std::vector<Vector3d>& points, ConventionScore& score, std::vector<double>& shares) {
  if (points.empty()) return;
  const double weight = std::min(1.0, 12.0 / static_cast<double>(cameras.size()));
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const Camera& camera = cameras[c];
    double seen = 0.0;
    for (const Vector3d& point : points) {
      const Vector3d here = camera.camera_from_world * point;
      if (here.z() <= 0.0 || here.z() > reach[c]) continue;
      const double u = camera.fx * here.x() / here.z() + camera.cx;
      const double v = camera.fy * here.y() / here.z() + camera.cy;
      const double width = camera.width > 0 ? camera.width : 2.0 * camera.cx;
      const double height = camera.height > 0 ? camera.height : 2.0 * camera.cy;
      if (u > -0.5 * width && u < 1.5 * width && v > -0.5 * height && v < 1.5 * height) seen += 1.0;
    }
    shares.push_back(seen / static_cast<double>(points.size()));
    score.log_likelihood += weight * std::log(0.05 + 0.95 * shares.back());
  }
}

class Judge {
 public:
  explicit Judge(const Calibration& calibration) : calibration_(calibration) {
    for (std::size_t i = 0; i < calibration.views.size(); ++i) worlds_[calibration.views[i].world].push_back(i);
    for (const PoseConvention reading : kPoseConventions) scores_.push_back(Score(reading));
  }

  CalibrationEstimate Decide() const {
    CalibrationEstimate sense;
    CheckFocalLengths(sense);
    sense.reading = Reading(sense);
    if (sense.reading.value.empty()) return sense;
    const std::size_t chosen = IndexOf(sense.reading.value);
    sense.unit = Unit(scores_[chosen], sense);
    std::vector<Camera> cameras;
    const double metres = MetresPerUnit(sense.unit.value).value_or(0.001);
    for (const CalibratedView& view : calibration_.views)
      cameras.push_back(CameraOf(view, kPoseConventions[chosen], metres));
    sense.up = Up(cameras);
    CheckPlaces(cameras, sense);
    if (!sense.unit.value.empty()) sense.cameras = std::move(cameras);
    return sense;
  }

 private:
  static std::size_t IndexOf(std::string_view reading) {
    for (std::size_t r = 0; r < kPoseConventions.size(); ++r) {
      if (Name(kPoseConventions[r]) == reading) return r;
    }
    return 0;
  }

  ConventionScore Score(PoseConvention reading) const {
    ConventionScore score;
    std::vector<Camera> all;
    for (const CalibratedView& view : calibration_.views) all.push_back(CameraOf(view, reading, 1.0));
    std::vector<double> shares;
    for (const auto& [world, views] : worlds_) {
      std::vector<Camera> cameras;
      std::vector<RigidTransform> poses;
      std::vector<double> reach;
      for (const std::size_t view : views) {
        const bool depth = calibration_.views[view].kind == "depth" && calibration_.metres_per_unit > 0.0;
        reach.push_back(depth ? kDepthRange / calibration_.metres_per_unit : std::numeric_limits<double>::infinity());
        cameras.push_back(all[view]);
        poses.push_back(all[view].camera_from_world);
      }
      ScoreAxes(poses, score);
      std::vector<Vector3d> points;
      for (const Calibration::SubjectPoint& point : calibration_.subject_points) {
        if (point.world == world) points.push_back(point.position);
      }
      ScoreSubject(cameras, reach, points, score, shares);
    }
    if (!shares.empty()) {
      double sum = 0.0;
      for (const double share : shares) sum += share;
      score.subject_share = sum / static_cast<double>(shares.size());
    }
    return score;
  }

  /// "axes pass 0.21 from a common point 5.2 away, 0 of 4 cameras have it behind them".
  static std::string Words(const ConventionScore& score) {
    std::string text;
    if (!score.miss.empty()) {
      text = "optical axes pass " + ThreeDigits(Median(score.miss)) + " units from a common point " +
             ThreeDigits(Median(score.distance)) + " units away, " + std::to_string(score.behind) + " of " +
             std::to_string(score.miss.size()) + " cameras have it behind them";
    }
    if (score.subject_share)
      text += (text.empty() ? "" : "; ") + ThreeDigits(100.0 * *score.subject_share) +
              " % of the subject's points are in view and in reach";
    return text.empty() ? "nothing to compare" : text;
  }

  Measured Reading(CalibrationEstimate& sense) const {
    double total = 0.0;
    std::size_t best = 0;
    for (std::size_t r = 1; r < scores_.size(); ++r) {
      if (scores_[r].log_likelihood > scores_[best].log_likelihood) best = r;
    }
    for (const ConventionScore& score : scores_) {
      total += std::exp(score.log_likelihood - scores_[best].log_likelihood);
    }
    Measured reading{std::string(Name(kPoseConventions[best])), 1.0 / total, ""};
    std::string others;
    for (std::size_t r = 0; r < scores_.size(); ++r) {
      if (r != best) others += "; as " + std::string(Name(kPoseConventions[r])) + ": " + Words(scores_[r]);
    }
    reading.evidence = "as " + reading.value + ": " + Words(scores_[best]) + others;
    if (calibration_.reading != PoseConvention::kUnknown) {
      const std::string declared(Name(calibration_.reading));
      if (declared != reading.value && reading.confidence > kContradiction) {
        sense.remarks.push_back(MakeFinding("calibration_contradiction", Severity::kWarning, reading.confidence,
                                            "the format declares " + declared + ", but " + reading.evidence + " (" +
                                                RoundedText(100.0 * reading.confidence, 3) + " % confidence)"));
      }
      return {declared, 1.0, "the format declares it; " + Words(scores_[IndexOf(declared)])};
    }
    const ConventionScore& score = scores_[best];
    if (!score.subject_share && !score.miss.empty() && 2 * score.behind >= score.miss.size()) {
      sense.remarks.push_back(
          MakeFinding("calibration_contradiction", Severity::kError, static_cast<double>(score.behind),
                      "in no reading do most cameras look at one point before them: " + reading.evidence +
                          "; are signs of rotations or translations exchanged?"));
      return {"", 0.0, reading.evidence};
    }
    if (reading.confidence < kSureOfCalibration) reading.value.clear();
    return reading;
  }

  /// No lens sees more than kWidest to one side: lengths in millimetres, or normalised ones, stand for pixels. And no
  /// pixel is much longer than wide.
  void CheckFocalLengths(CalibrationEstimate& sense) const {
    constexpr double kWidest = 85.0 * kPi / 180.0;
    constexpr double kTallestPixel = 2.0;  // anamorphic lenses; of television 1.5
    for (const CalibratedView& view : calibration_.views) {
      if (const double aspect = std::max(view.fx / view.fy, view.fy / view.fx); aspect > kTallestPixel) {
        sense.remarks.push_back(MakeFinding("calibration_contradiction", Severity::kError, aspect,
                                            "camera '" + view.name + "': focal lengths of " + ThreeDigits(view.fx) +
                                                " and " + ThreeDigits(view.fy) + " px make pixels " +
                                                ThreeDigits(aspect) + " times as long as wide: correct one of them"));
      }
      const double half = view.width > 0 ? 0.5 * view.width : view.cx;
      if (!(half > 1.0) || !(view.fx > 0.0)) continue;
      const double sees = std::atan2(half, view.fx);
      if (sees <= kWidest) continue;
      sense.remarks.push_back(MakeFinding("calibration_contradiction", Severity::kError, view.fx,
                                          "camera '" + view.name + "': a focal length of " + ThreeDigits(view.fx) +
                                              " px beside a middle at " + ThreeDigits(half) + " px sees " +
                                              ThreeDigits(2.0 * sees * 180.0 / kPi) +
                                              " degrees: is it in millimetres, or divided by the image's size?"));
    }
  }

  /// One camera that stands far outside the others. In the recorded rigs of 4 cameras and more the outermost is at most
  /// 1.34 times as far from their middle as the next.
  void CheckPlaces(const std::vector<Camera>& cameras, CalibrationEstimate& sense) const {
    constexpr double kFarther = 4.0;
    constexpr std::size_t kFewest = 4;
    for (const auto& [world, views] : worlds_) {
      if (views.size() < kFewest) continue;
      std::vector<Vector3d> centres;
      for (const std::size_t view : views) centres.push_back(Inverse(cameras[view].camera_from_world).translation);
      Vector3d middle;
      for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Vector3d& centre : centres) values.push_back(centre[axis]);
        middle[axis] = Median(std::move(values));
      }
      std::vector<std::pair<double, std::size_t>> distances;
      for (std::size_t i = 0; i < views.size(); ++i) distances.emplace_back((centres[i] - middle).norm(), views[i]);
      std::sort(distances.begin(), distances.end());
      const auto [farthest, outermost] = distances.back();
      const double next = distances[distances.size() - 2].first;
      if (!(next > 0.0) || farthest < kFarther * next) continue;
      sense.remarks.push_back(
          MakeFinding("calibration_contradiction", Severity::kError, farthest / next,
                      "camera '" + calibration_.views[outermost].name + "'" +
                          (world.empty() ? "" : " of '" + world + "'") + " stands " + ThreeDigits(farthest / next) +
                          " times as far from the middle of all cameras as any other: correct its translation, "
                          "or leave it out"));
    }
  }

  Measured Unit(const ConventionScore& score, CalibrationEstimate& sense) const {
    constexpr std::array<std::pair<const char*, double>, 4> kUnits = {
        {{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}}};
    constexpr std::array<double, 4> kUsual = {1.0, 1.0, 1.0, 0.1};  // few programs write inches
    constexpr double kTypical = 3.0;
    constexpr double kSpread = 0.6;
    Measured unit;
    const double distance = Median(score.distance);
    std::array<double, 4> likelihood{};
    double total = 0.0;
    std::size_t best = 0;
    for (std::size_t u = 0; u < kUnits.size() && distance > 0.0; ++u) {
      const double z = std::log(distance * kUnits[u].second / kTypical) / kSpread;
      likelihood[u] = kUsual[u] * (std::exp(-0.5 * std::min(z * z, 1000.0)) + 1e-9);
      total += likelihood[u];
      if (likelihood[u] > likelihood[best]) best = u;
    }
    if (total > 0.0) {
      unit = {kUnits[best].first, likelihood[best] / total,
              "cameras stand " + ThreeDigits(distance) + " units from where they look: " +
                  ThreeDigits(distance * kUnits[best].second) + " m if the unit is " + kUnits[best].first};
      for (std::size_t u = 0; u < kUnits.size(); ++u) {
        if (u == best || likelihood[u] < 0.05 * total) continue;
        unit.evidence += ", " + ThreeDigits(distance * kUnits[u].second) + " m if it is " + kUnits[u].first;
      }
    } else {
      unit.evidence = "the cameras look at no common point, so nothing gives a scale";
    }
    if (calibration_.metres_per_unit > 0.0) {
      std::string declared;
      for (const auto& [name, metres] : kUnits) {
        if (metres == calibration_.metres_per_unit) declared = name;
      }
      if (!unit.value.empty() && unit.value != declared && unit.confidence > kContradiction) {
        sense.remarks.push_back(MakeFinding("calibration_contradiction", Severity::kWarning, unit.confidence,
                                            "the file declares " + declared + ", but " + unit.evidence + " (" +
                                                RoundedText(100.0 * unit.confidence, 3) + " % confidence)"));
      }
      return {declared, 1.0, "the file or its format declares it; " + unit.evidence};
    }
    if (unit.confidence < kSureOfCalibration) unit.value.clear();
    return unit;
  }

  static Measured Up(const std::vector<Camera>& cameras) {
    Vector3d sum = Vector3d::Zero();
    std::vector<Vector3d> tops;
    for (const Camera& camera : cameras) {
      tops.emplace_back(Inverse(camera.camera_from_world).rotation * -Vector3d::UnitY());
      sum += tops.back();
    }
    int axis = 0;
    sum.cwiseAbs().maxCoeff(&axis);
    Vector3d up = Vector3d::Zero();
    up[axis] = sum[axis] < 0.0 ? -1.0 : 1.0;
    double near = 0.0;
    for (const Vector3d& top : tops) near += top.dot(up) > 0.5 ? 1.0 : 0.0;
    Measured measured;
    measured.confidence = tops.empty() ? 0.0 : near / static_cast<double>(tops.size());
    measured.evidence = "the top of " + std::to_string(static_cast<int>(near)) + " of " + std::to_string(tops.size()) +
                        " images points within 60 degrees of it";
    if (measured.confidence >= kSureOfCalibration && sum.norm() > 0.0 && sum.normalized().dot(up) > 0.85) {
      measured.value = std::string(up[axis] < 0.0 ? "-" : "+") + "xyz"[axis];
    }
    return measured;
  }

  const Calibration& calibration_;
  std::map<std::string, std::vector<std::size_t>> worlds_;
  std::vector<ConventionScore> scores_;
};

}  // namespace

CalibrationEstimate EstimateCalibration(const Calibration& calibration) {
  if (calibration.views.empty()) return {};
  return Judge(calibration).Decide();
}

}  // namespace mocurate
