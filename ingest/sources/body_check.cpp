// What the body itself says against the declaration of its source.

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ingest/sense/tree_points.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// Head to ankle along trunk and leg, metres: no person, standing or not, is outside.
constexpr double kShortest = 0.6;
constexpr double kTallest = 2.4;
/// Mean height of the head over the ankles, as a part of that length, below which the person stands on the head.
constexpr double kUpsideDown = -0.4;

/// The points of a clip in metres and canonical axes, by name.
struct BodyPoints {
  const JointPositions* positions = nullptr;
  const std::vector<double>* confidence = nullptr;  ///< (F*J) or null: all seen
  HandednessPoints points;

  bool Sees(int frame, int point) const {
    if (point < 0) return false;
    const std::size_t at = static_cast<std::size_t>(frame) * positions->joints + point;
    return confidence == nullptr || (*confidence)[at] > 0.0;
  }
};

/// By the names that all skeletons share, or, in a tree of a file's own, by what its names look like.
HandednessPoints PointsOf(const Skeleton& skeleton) {
  const HandednessPoints known = FindHandednessPoints([&](std::string_view name) { return skeleton.FindJoint(name); });
  if (known.knee[0] >= 0 && known.knee[1] >= 0) return known;
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
  }
  return PointsOfTree(names, parents);
}

std::optional<BodyPoints> PointsOf(const SourceOptions& source, const Clip& clip) {
  if (clip.evidence.tracks) {
    const JointTracks& tracks = *clip.evidence.tracks;
    const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
    const auto find = [&](std::string_view name) -> std::optional<int> {
      const std::optional<int> joint = skeleton && *skeleton ? (*skeleton)->FindJoint(name) : std::nullopt;
      for (std::size_t k = 0; k < tracks.names.size(); ++k) {
        if (tracks.names[k] == name) return static_cast<int>(k);
        if (joint && (*skeleton)->FindJoint(tracks.names[k]) == joint) return static_cast<int>(k);
      }
      return std::nullopt;
    };
    return BodyPoints{&tracks.positions, &tracks.confidence, FindHandednessPoints(find)};
  }
  if (!clip.motion) return std::nullopt;
  return BodyPoints{&clip.motion->joints, nullptr, PointsOf(*clip.motion->skeleton)};
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Length of the body and height of the head over the ankles, medians over the frames that show both; metres.
struct BodyMeasure {
  int frames = 0;
  double length = 0.0;
  double head_over_ankles = 0.0;
};

BodyMeasure MeasureBody(const BodyPoints& body) {
  const HandednessPoints& p = body.points;
  std::vector<double> lengths;
  std::vector<double> heights;
  for (int f = 0; f < body.positions->frames; ++f) {
    const bool seen = body.Sees(f, p.head) && body.Sees(f, p.hip[0]) && body.Sees(f, p.hip[1]) &&
                      body.Sees(f, p.knee[0]) && body.Sees(f, p.knee[1]) && body.Sees(f, p.ankle[0]) &&
                      body.Sees(f, p.ankle[1]);
    if (!seen) continue;
    const auto at = [&](int point) { return Vector3d(body.positions->at(f, point)); };
    const Vector3d hips = 0.5 * (at(p.hip[0]) + at(p.hip[1]));
    double length = (at(p.head) - hips).norm();
    for (int side = 0; side < 2; ++side) {
      length += 0.5 * ((at(p.hip[side]) - at(p.knee[side])).norm() + (at(p.knee[side]) - at(p.ankle[side])).norm());
    }
    lengths.push_back(length);
    heights.push_back(at(p.head).y() - 0.5 * (at(p.ankle[0]) + at(p.ankle[1])).y());
  }
  if (lengths.empty()) return {};
  return {static_cast<int>(lengths.size()), Median(lengths), Median(heights)};
}

}  // namespace

void CheckBody(const SourceOptions& source, IngestedClip& ingested) {
  const std::optional<BodyPoints> body = PointsOf(source, ingested.clip);
  if (!body) return;
  const auto contradict = [&](const char* code, double value, std::string message) {
    Finding finding;
    finding.code = code;
    finding.severity = Severity::kError;
    finding.value = value;
    finding.message = std::move(message);
    finding.action = source.on_contradiction == OnContradiction::kRefuse ? "refused" : "flagged";
    ingested.findings.push_back(finding);
  };
  const BodyMeasure measure = MeasureBody(*body);
  if (measure.frames > 0 && (measure.length < kShortest || measure.length > kTallest)) {
    contradict("units_contradiction", measure.length,
               "in units of '" + source.units + "' the person is " +
                   FormatDouble(std::round(measure.length * 100.0) / 100.0) +
                   " m from head to ankle; mend ingest.source.units");
  }
  if (measure.frames > 0 && measure.head_over_ankles < kUpsideDown * measure.length) {
    contradict("up_contradiction", measure.head_over_ankles,
               "with axes '" + source.axes + "' the head is below the feet; mend ingest.source.axes");
  }
  const HandednessMeasure hand = MeasureHandedness(*body->positions, body->points, body->confidence);
  if (hand.handedness != Handedness::kLeft) return;
  contradict("handedness_contradiction", hand.confidence,
             hand.evidence + ": with axes '" + source.axes +
                 "' the motion is left-handed, or left and right are exchanged; mend ingest.source.axes");
}

}  // namespace mocurate
