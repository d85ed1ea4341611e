#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/largest_number.h"
#include "core/formats/npy.h"
#include "ingest/sense/array_sense.h"
#include "ingest/sense/observe.h"
#include "ingest/sources/array_clips.h"

namespace mocurate {
namespace {

void RemarkDamaged(const DamagedNumbers& damaged, ObservedClip& clip) {
  for (const Finding& finding : damaged.findings)  // its frames reach from the first to the last such number
    clip.remarks.push_back(MakeFinding(finding.code, finding.severity, finding.value, finding.message));
}

bool IsCoordinate(double value) { return std::isfinite(value) && std::abs(value) <= kLargestNumber; }

/// The places of one clip of an array; what is no coordinate is missing.
ObservedClip PlacesIn(const NpyArray& array, const ArrayShape& held, std::size_t number, const std::string& name) {
  ObservedClip clip;
  clip.frames = static_cast<int>(held.frames);
  clip.joints = static_cast<int>(held.joints);
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(held.frames * held.joints, 1.0);
  const double* values = array.values.data() + number * clip.positions.xyz.size();
  for (std::size_t i = 0; i < clip.positions.xyz.size(); ++i) {
    clip.positions.xyz[i] = IsCoordinate(values[i]) ? values[i] : 0.0;
    if (!IsCoordinate(values[i])) clip.confidence[i / 3] = 0.0;
  }
  RemarkDamaged(DamagedNumbersOf(values, clip.frames, clip.joints, name), clip);
  return clip;
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveNpy(std::string_view bytes, const std::string& name) {
  const Expected<NpyArray> array = ParseNpy(bytes, name);
  if (!array) return Forward(array);
  return ObserveArray(*array, name);
}

Expected<std::vector<ObservedClip>> ObserveArray(const NpyArray& array, const std::string& name) {
  std::string shape;
  for (const std::size_t size : array.shape) shape += (shape.empty() ? "(" : ", ") + std::to_string(size);
  shape += ")";
  if (const auto axes = ExchangedAxes(array, 0)) {
    return Fail(ErrorCode::kInconsistent, "the array has shape " + shape + ": " + axes->words, name, axes->way_out);
  }
  const std::optional<ArrayShape> held = ShapeOfJoints(array.shape);
  if (!held || array.values.empty()) {
    const std::string other = OtherThanJoints(array.shape);
    if (!other.empty()) return Fail(ErrorCode::kUnsupported, "an array of shape " + shape + " holds " + other, name);
    return Fail(ErrorCode::kUnsupported, "an array of shape " + shape + " is no sequence of joint positions", name,
                "wanted: (frames, joints, 3), (frames, joints * 3), or a batch of them");
  }
  if (std::none_of(array.values.begin(), array.values.end(), IsCoordinate))
    return NobodySeen(array.values.size(), name);
  std::vector<ObservedClip> observed;
  for (std::size_t c = 0; c < held->clips; ++c) {
    ObservedClip clip = PlacesIn(array, *held, c, name);
    clip.id = held->batch ? "[" + std::to_string(c) + "]" : "";
    clip.format = "npy";
    clip.layout_evidence = "shape " + shape + " of " + array.dtype;
    if (std::none_of(clip.confidence.begin(), clip.confidence.end(), [](double seen) { return seen > 0.0; }))
      clip.remarks.push_back(
          MakeFinding("no_joint_seen", Severity::kError, static_cast<double>(clip.frames),
                      "no joint is seen in " + std::to_string(clip.frames) + " of " + Counted(clip.frames, "frame")));
    else if (!RecogniseOrder(clip))
      DoubtPositions(clip);
    observed.push_back(std::move(clip));
  }
  return observed;
}

Expected<ObservedClip> ObserveExported(const ExportedMotion& exported, const std::string& name) {
  const NpyArray& array = *exported.joints;
  if (std::none_of(array.values.begin(), array.values.end(), IsCoordinate))
    return NobodySeen(array.values.size(), name);
  ArrayShape shape;
  shape.frames = array.shape[0];
  shape.joints = array.shape[1];
  ObservedClip clip = PlacesIn(array, shape, 0, name);
  clip.format = "npz";
  clip.layout_evidence = "array 'joints' of a file of `mocurate export`";
  clip.rate_hz = exported.rate_hz;
  clip.rate_evidence = "mocap_frame_rate of the file";
  clip.units = "m";
  clip.up = "+y";
  clip.handedness = "right";
  clip.axes = "+x +y +z";
  const auto known = KnownSkeleton(exported.skeleton);
  const bool all = known && std::all_of(exported.names.begin(), exported.names.end(), [&](const std::string& joint) {
                     return (*known)->FindJoint(joint).has_value();
                   });
  clip.names = exported.names;
  if (all)
    FollowFormat(exported.skeleton, exported.names, "joint_names of the file", clip);
  else
    FollowTree(exported.parents, "joint_names and parents of the file", clip);
  return clip;
}

}  // namespace mocurate
