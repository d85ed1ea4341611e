#include <cmath>

#include "core/base/text.h"
#include "core/formats/amass.h"
#include "core/motion/kinematics.h"
#include "ingest/sources/babel_segments.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr int kSmplJoints = 24;
constexpr int kBodyJoints = 22;  // what SMPL, SMPL-H and SMPL-X share

/// SMPL's joints in the order of `poses`; those of the hands are SMPL's alone.
const char* const kNames[kSmplJoints] = {"pelvis",     "left_hip",      "right_hip",      "spine1",      "left_knee",
                                         "right_knee", "spine2",        "left_ankle",     "right_ankle", "spine3",
                                         "left_foot",  "right_foot",    "neck",           "left_collar", "right_collar",
                                         "head",       "left_shoulder", "right_shoulder", "left_elbow",  "right_elbow",
                                         "left_wrist", "right_wrist",   "left_hand",      "right_hand"};

/// Column of each of the skeleton's joints in `poses`, -1 for a joint that the file says nothing of.
Expected<std::vector<int>> Columns(const Skeleton& skeleton, int joints_in_file) {
  std::vector<int> columns(skeleton.joints.size(), -1);
  for (int k = 0; k < kSmplJoints; ++k) {
    const std::optional<int> joint = skeleton.FindJoint(kNames[k]);
    if (!joint || (k == 0) != (skeleton.joints[*joint].parent < 0)) {
      return Fail(ErrorCode::kConfig,
                  "skeleton '" + skeleton.name + "' has no joint '" + kNames[k] + "' of SMPL's tree",
                  "ingest.source.skeleton", "AMASS files are read on smpl24");
    }
    if (k < joints_in_file) columns[*joint] = 3 * k;
  }
  return columns;
}

Finding NotTheSubject(const Skeleton& skeleton) {
  Finding finding;
  finding.code = "bones_not_the_subjects";
  finding.severity = Severity::kInfo;
  finding.message =
      "the file gives the body's shape as numbers of a body model that is not here: bone lengths are those "
      "of skeleton '" +
      skeleton.name +
      "', and the pelvis lies at `trans`, which the model's rest pelvis (0.2 to 0.4 m, constant over the "
      "clip) is missing from";
  finding.action = "rest offsets of the skeleton used";
  return finding;
}

Status AddSegments(const SourceFile& file, Clip& clip, std::size_t frames, std::vector<Finding>& findings) {
  if (file.source.annotations.empty()) return {};
  if (file.annotation.empty()) {
    Finding finding;
    finding.code = "not_annotated";
    finding.severity = Severity::kInfo;
    finding.message = "no annotation file speaks of this motion";
    finding.action = "kept without labels";
    findings.push_back(std::move(finding));
    return {};
  }
  const Expected<std::vector<BabelSequence>> sequences = ParseBabel(file.annotation, file.name + " (annotation)");
  if (!sequences) return Forward(sequences);
  const double frame_s = clip.rate.FrameTime(1);
  clip.segments = SegmentsOf(sequences->at(0), static_cast<double>(frames) * frame_s, frame_s, findings);
  clip.provenance["babel_sid"] = std::to_string(sequences->at(0).babel_sid);
  return {};
}

}  // namespace

Expected<IngestedClip> ReadAmassClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  if (axes->handedness() == Handedness::kLeft) {
    return Fail(ErrorCode::kConfig, "axes '" + source.axes + "' are left-handed", "ingest.source.axes",
                "the rotations of AMASS are those of a right-handed frame; z up is '+x -z +y'");
  }
  Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (skeleton && !*skeleton) skeleton = LoadSkeleton("smpl24");
  if (!skeleton) return Forward(skeleton);
  const Expected<Amass> amass = ParseAmass(file.bytes, file.name);
  if (!amass) return Forward(amass);
  const int joints_in_file = amass->pose_columns == 3 * kSmplJoints ? kSmplJoints : kBodyJoints;
  const Expected<std::vector<int>> columns = Columns(**skeleton, joints_in_file);
  if (!columns) return Forward(columns);
  if (amass->frames == 0) return Fail(ErrorCode::kInconsistent, "the file has no frame", file.name);

  const Quaterniond world_from_file(axes->canonical_from_source);
  const std::size_t joints = columns->size();
  std::vector<Vector3d> root_translation;
  std::vector<Quaterniond> rotation(amass->frames * joints, Quaterniond::Identity());
  for (std::size_t f = 0; f < amass->frames; ++f) {
    const double* trans = &amass->translation_m[f * 3];
    root_translation.push_back(axes->canonical_from_source * Vector3d(trans[0], trans[1], trans[2]));
    for (std::size_t j = 0; j < joints; ++j) {
      const int column = (*columns)[j];
      if (column < 0) continue;
      const double* vector = &amass->poses[f * amass->pose_columns + static_cast<std::size_t>(column)];
      const Quaterniond local = ExpQuaternion(Vector3d(vector[0], vector[1], vector[2]));
      rotation[f * joints + j] = (column == 0 ? world_from_file * local : local).normalized();
    }
  }
  for (std::size_t j = 0; j < joints; ++j) MakeSignContinuous(rotation.data() + j, amass->frames, joints);

  IngestedClip ingested;
  Clip& clip = ingested.clip;
  if (amass->rate_hz > 0.0) NoteRate(source, amass->rate_hz, ingested.findings);
  clip.rate = FrameRate::FromHz(amass->rate_hz);
  clip.motion = MakeMotion(*skeleton, clip.rate, std::move(root_translation), std::move(rotation), {});
  ingested.findings.push_back(NotTheSubject(**skeleton));
  if (!amass->gender.empty()) clip.provenance["gender"] = amass->gender;
  if (!amass->surface_model.empty()) clip.provenance["body_model"] = amass->surface_model;
  if (Status added = AddSegments(file, clip, amass->frames, ingested.findings); !added) return Forward(added);
  return ingested;
}

}  // namespace mocurate
