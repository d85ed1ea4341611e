#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/finding.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// The origin of a value: the format or the source, the numbers, or none.
enum class Provenance { kUnknown, kDeclared, kMeasured };

std::string_view Name(Provenance provenance);

/// One thing that numbers show; no value where they do not show it.
template <class T>
struct Estimate {
  std::optional<T> value;
  double confidence = 0.0;  ///< 0 to 1, four decimals
  std::string evidence;
};

/// One thing that is reported of a clip, camera or cloud.
template <class T>
struct Reported : Estimate<T> {
  Provenance from = Provenance::kUnknown;
  std::optional<Estimate<T>> measured;  ///< what the numbers show beside a declared value
};

/// Rounds as reports do.
inline double FourDecimals(double value) { return std::round(value * 1e4) / 1e4; }

/// Unknown, with confidence 0, where there is no value or the text is empty.
template <class T>
Reported<T> Report(std::optional<T> value, Provenance from, double confidence, std::string evidence) {
  if constexpr (std::is_same_v<T, std::string>) {
    if (value && value->empty()) value.reset();
  }
  Reported<T> reported;
  reported.evidence = std::move(evidence);
  if (!value) return reported;
  reported.value = std::move(value);
  reported.from = from;
  reported.confidence = FourDecimals(confidence);
  return reported;
}

inline Reported<std::string> AsDeclared(std::string text, std::string evidence) {
  return Report<std::string>(std::move(text), Provenance::kDeclared, 1.0, std::move(evidence));
}

template <class T>
Reported<T> Unknown(std::string evidence) {
  return Report<T>(std::nullopt, Provenance::kUnknown, 0.0, std::move(evidence));
}

/// Frames a second that a motion allows; no value: no limit.
struct RateRange {
  std::optional<double> lowest, highest;
};

struct InspectedClip {
  std::string id;    ///< the file, and where in it
  std::string file;  ///< of a clip of many files their folder
  std::string format;
  std::string item;                     ///< of a run of the source; empty without a source
  Reported<std::string> person, label;  ///< with a source
  Reported<int> frames, joints;
  Reported<int> people;   ///< most in one frame
  int fewest_people = 1;  ///< in one frame
  Reported<double> rate_hz;
  std::optional<RateRange> rate_range;
  Reported<std::string> skeleton, units, up, handedness, facing, axes;
  Reported<double> missing_share;
  std::vector<std::string> joint_names;                        ///< (joints), or empty: unknown
  Reported<std::vector<std::optional<Vector3d>>> first_frame;  ///< (joints), file unit and axes; none: missing
  std::vector<std::pair<std::string, std::string>> facts;      ///< what else the file says

  /// One of `facts`; empty where there is none.
  std::string Fact(std::string_view key) const;
};

/// What most clips of a group report.
template <class T>
struct Pooled {
  std::optional<T> value;
  Provenance from = Provenance::kUnknown;
  double share = 0.0;  ///< of the votes, which are confidences
};

/// Clips of one folder, format and joint count.
struct InspectedGroup {
  std::string folder, format;
  std::optional<int> joints;
  std::size_t clips = 0;
  long long frames = 0;  ///< of all clips
  int fewest_frames = 0, most_frames = 0;
  Pooled<double> rate_hz;
  Pooled<std::string> skeleton, units, up, handedness, facing, axes;
};

/// Calls `visit(name, member of InspectedClip, member of InspectedGroup)` for the texts that both report.
template <class Visit>
void ForEachSharedText(const Visit& visit) {
  visit("skeleton", &InspectedClip::skeleton, &InspectedGroup::skeleton);
  visit("units", &InspectedClip::units, &InspectedGroup::units);
  visit("up", &InspectedClip::up, &InspectedGroup::up);
  visit("handedness", &InspectedClip::handedness, &InspectedGroup::handedness);
  visit("facing", &InspectedClip::facing, &InspectedGroup::facing);
  visit("axes", &InspectedClip::axes, &InspectedGroup::axes);
}

/// One view of a calibration.
struct InspectedCamera {
  std::string id, file, format, world, kind;
  Reported<std::string> units, up;
  Reported<std::string> reading;  ///< what R and t mean
  Reported<std::array<int, 2>> image_size;
  std::optional<Vector3d> centre_m;
};

struct InspectedCloud {
  std::string file, format;
  std::size_t points = 0, triangles = 0;
  Reported<Vector3d> extent;  ///< x, y, z in the file's unit
  Reported<std::string> units;
};

/// What stands beside motion: a skeleton, labels, poses of a scan, a body model, images.
struct RawCompanion {
  std::string file;
  std::string format;
  std::vector<std::pair<std::string, std::string>> texts;
  std::vector<std::pair<std::string, double>> numbers;
};

/// What a file or folder is.
struct Inspection {
  std::string path;
  std::string format = "unknown";  ///< of the clips, else of cameras, clouds or companions; "mixed"
  std::vector<InspectedClip> clips;
  std::vector<InspectedGroup> groups;
  std::vector<InspectedCamera> cameras;
  std::vector<InspectedCloud> clouds;
  std::vector<RawCompanion> companions;
  std::vector<Finding> findings;  ///< `clip` is the place, with frames and joint
};

/// docs/inspect.schema.json.
void to_json(nlohmann::json& json, const Inspection& inspection);

/// The same as text for a person.
std::string InspectionText(const Inspection& inspection);

/// One at a place: a file, a clip, or "walk.bvh frames 3-5 joint head".
Finding FindingAt(std::string place, std::string code, Severity severity, double value, std::string message);
/// Code, severity, value and message of another one.
Finding FindingAt(std::string place, const Finding& finding);
/// With four decimals.
Finding Rounded(Finding finding);
bool HasFinding(const std::vector<Finding>& findings, std::string_view code);

}  // namespace mocurate
