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

std::size_t JointsDeclared(const SourceOptions& source) {
  if (!source.joints.empty()) return source.joints.size();
  const auto skeleton = KnownSkeleton(source.skeleton.empty() ? "smpl24" : source.skeleton);
  return skeleton ? (*skeleton)->joints.size() : 0;
}

void RemarkDamaged(const DamagedNumbers& damaged, ObservedClip& clip) {
  for (const Finding& finding : damaged.findings)  // its frames reach from the first to the last such number
    clip.remarks.push_back({finding.code, finding.severity, finding.value, finding.message});
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveNpy(std::string_view bytes, const std::string& name,
                                               const std::optional<SourceOptions>& source) {
  const Expected<NpyArray> array = ParseNpy(bytes, name);
  if (!array) return Forward(array);
  return ObserveArray(*array, name, source);
}

Expected<std::vector<ObservedClip>> ObserveArray(const NpyArray& array, const std::string& name,
                                                 const std::optional<SourceOptions>& source) {
  std::string shape;
  for (const std::size_t size : array.shape) shape += (shape.empty() ? "(" : ", ") + std::to_string(size);
  shape += ")";
  const bool declared = source && source->format == SourceFormat::kNpy;
  if (const auto axes = ExchangedAxes(array, declared ? JointsDeclared(*source) : 0)) {
    return Fail(ErrorCode::kInconsistent, "the array has shape " + shape + ": " + axes->words, name, axes->way_out);
  }
  const std::optional<ArrayShape> held = ShapeOfJoints(array.shape);
  if (!held || array.values.empty()) {
    const std::string other = OtherThanJoints(array.shape);
    if (!other.empty()) return Fail(ErrorCode::kUnsupported, "an array of shape " + shape + " holds " + other, name);
    return Fail(ErrorCode::kUnsupported, "an array of shape " + shape + " is no sequence of joint positions", name,
                "wanted: (frames, joints, 3), (frames, joints * 3), or a batch of them");
  }
  const auto finite = [](double value) { return std::isfinite(value) && std::abs(value) <= kLargestNumber; };
  if (std::none_of(array.values.begin(), array.values.end(), finite)) {
    return NobodySeen(array.values.size(), name);
  }
  const auto frames = static_cast<int>(held->frames);
  const auto joints = static_cast<int>(held->joints);
  std::vector<ObservedClip> observed;
  for (std::size_t c = 0; c < held->clips; ++c) {
    ObservedClip clip;
    clip.id = held->batch ? "[" + std::to_string(c) + "]" : "";
    clip.format = "npy";
    clip.frames = frames;
    clip.joints = joints;
    clip.positions = JointPositions(frames, joints);
    clip.confidence.assign(static_cast<std::size_t>(frames) * joints, 1.0);
    for (std::size_t i = 0; i < clip.positions.xyz.size(); ++i) {
      const double value = array.values[c * clip.positions.xyz.size() + i];
      clip.positions.xyz[i] = finite(value) ? value : 0.0;
      if (!finite(value)) clip.confidence[i / 3] = 0.0;
    }
    clip.layout_evidence = "shape " + shape + " of " + array.dtype;
    RemarkDamaged(DamagedNumbersOf(array.values.data() + c * clip.positions.xyz.size(), frames, joints, name), clip);
    if (declared)
      DeclareOrder(*source, clip);
    else if (std::none_of(clip.confidence.begin(), clip.confidence.end(), [](double seen) { return seen > 0.0; }))
      clip.remarks.push_back({"no_joint_seen", Severity::kError, static_cast<double>(frames),
                              "no joint is seen in " + std::to_string(frames) + " of " + Counted(frames, "frame")});
    else if (!RecogniseOrder(clip))
      DoubtPositions(clip);
    observed.push_back(std::move(clip));
  }
  return observed;
}

}  // namespace mocurate
