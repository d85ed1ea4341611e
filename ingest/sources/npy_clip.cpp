#include <cmath>

#include "core/formats/npy.h"
#include "core/motion/kinematics.h"
#include "ingest/sense/array_sense.h"
#include "ingest/sources/array_clips.h"
#include "ingest/sources/damaged_frames.h"
#include "ingest/sources/mapped_file.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

std::string ShapeText(const NpyArray& array) {
  std::string text = "(";
  for (std::size_t i = 0; i < array.shape.size(); ++i) text += (i ? ", " : "") + std::to_string(array.shape[i]);
  return text + ")";
}

/// For each joint of the skeleton its place in the file: declared names, or the skeleton's own order.
Expected<std::vector<int>> FileOrder(const SourceOptions& source, const Skeleton& skeleton) {
  std::vector<int> place(skeleton.joints.size(), -1);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (source.joints.empty()) place[j] = j;
  }
  for (std::size_t k = 0; k < source.joints.size(); ++k) {
    if (const auto joint = skeleton.FindJoint(source.joints[k])) place[*joint] = static_cast<int>(k);
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (place[j] < 0) {
      return Fail(ErrorCode::kConfig,
                  "joint '" + skeleton.joints[j].name + "' of skeleton '" + skeleton.name + "' is not in the source",
                  "ingest.source.joints", "joints-only motion needs every joint of its skeleton");
    }
  }
  return place;
}

}  // namespace

Expected<IngestedClip> ReadNpyClip(const SourceFile& file) { return ReadArraySource(file, ""); }

Expected<IngestedClip> ReadArraySource(const SourceFile& file, const std::string& id) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton) return Forward(skeleton);
  const Expected<std::vector<int>> place = FileOrder(source, **skeleton);
  if (!place) return Forward(place);
  const auto mapped = MappedFile::Open(file.container);
  if (!mapped) return Forward(mapped);
  const Expected<NpyArray> array = ReadArrayClip((*mapped)->bytes(), id, file.name);
  if (!array) return Forward(array);

  const std::size_t wide = source.joints.empty() ? (*skeleton)->joints.size() : source.joints.size();
  const bool cube = array->shape.size() == 3 && array->shape[1] == wide && array->shape[2] == 3;
  const bool flat = array->shape.size() == 2 && array->shape[1] == wide * 3;
  if (!array->texts.empty()) {
    return Fail(ErrorCode::kInconsistent, "the array holds texts, joint positions are needed", file.name);
  }
  if (const std::string other = OtherThanJoints(array->shape); !cube && !flat && !other.empty()) {
    return Fail(ErrorCode::kInconsistent, "an array of shape " + ShapeText(*array) + " holds " + other, file.name);
  }
  if (const auto axes = ExchangedAxes(*array, wide); axes && !cube) {
    return Fail(ErrorCode::kInconsistent, "the array has shape " + ShapeText(*array) + ": " + axes->words, file.name,
                axes->way_out);
  }
  if ((!cube && !flat) || array->shape[0] == 0) {
    return Fail(ErrorCode::kInconsistent,
                "the array has shape " + ShapeText(*array) + ", (frames, " + std::to_string(wide) + ", 3) is needed",
                file.name, "skeleton '" + source.skeleton + "' has " + std::to_string(wide) + " joints");
  }
  const int frames = static_cast<int>(array->shape[0]);
  const int joints = (*skeleton)->joint_count();
  JointPositions positions(frames, joints);
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < joints; ++j) {
      const double* raw = array->values.data() + (static_cast<std::size_t>(f) * wide + (*place)[j]) * 3;
      positions.at(f, j) = frame->metres_from_file * Vector3d(raw[0], raw[1], raw[2]);
    }
  }
  IngestedClip ingested;
  ingested.findings = DamagedFramesOf(array->values.data(), frames, static_cast<int>(wide), file.name);
  if (!ingested.findings.empty() && source.damaged_rows == DamagedRows::kRefuse) {
    return Fail(ErrorCode::kMalformed, ingested.findings[0].message, file.name,
                "mend the file, or set ingest.source.damaged_rows: report");
  }
  std::vector<int> damaged;
  for (const Finding& finding : ingested.findings) damaged.push_back(finding.frame_begin);
  const auto bridged = BridgeFrames(damaged, frames, *source.rate_hz, file.name);
  if (!bridged) return Forward(bridged);
  for (const DamagedFrame& at : *bridged) {
    for (int j = 0; j < joints; ++j) {
      positions.at(at.frame, j) =
          (1.0 - at.share) * Vector3d(positions.at(at.before, j)) + at.share * Vector3d(positions.at(at.after, j));
    }
  }
  ingested.content = id.empty() ? std::string((*mapped)->bytes()) : BytesOf(array->values);
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  ingested.clip.motion = MakeJointsOnly(*skeleton, ingested.clip.rate, std::move(positions));
  MarkBridged(*bridged, *ingested.clip.motion, ingested.findings);
  return ingested;
}

}  // namespace mocurate
