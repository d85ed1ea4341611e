#include <cmath>

#include "core/base/text.h"
#include "core/formats/amass.h"
#include "core/motion/kinematics.h"
#include "ingest/formats/driver.h"
#include "ingest/sense/angle_sense.h"
#include "ingest/sense/pose_sense.h"
#include "ingest/sense/rate_sense.h"
#include "ingest/sources/babel_segments.h"
#include "ingest/sources/damaged_frames.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

constexpr int kBodyJoints = 22;  // what SMPL, SMPL-H and SMPL-X share

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
  finding.message += "; rest offsets of the skeleton used";
  finding.action = FindingAction::kKept;
  return finding;
}

Status AddSegments(const SourceFile& file, Clip& clip, std::size_t frames, std::vector<Finding>& findings) {
  if (file.source.annotations.empty()) return {};
  if (file.annotation.empty()) {
    Finding finding;
    finding.code = "not_annotated";
    finding.severity = Severity::kInfo;
    finding.message = "no annotation file speaks of this motion";
    finding.message += "; kept without labels";
    finding.action = FindingAction::kKept;
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

/// AMASS -> given motion on SMPL's 24 joints: the body's rotations; hands, jaw and eyes of SMPL-H and SMPL-X are left
/// out. Without a body model rest offsets are the skeleton's, and the pelvis lies at `trans`: a finding says so. With
/// `annotations`, BABEL's labels are the segments.
Expected<IngestedClip> ReadAmassClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<Quaterniond> world_from_file = TurnOf(source.axes);
  if (!world_from_file) return Forward(world_from_file);
  Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (skeleton && !*skeleton) skeleton = LoadSkeleton("smpl24");
  if (!skeleton) return Forward(skeleton);
  const Expected<Amass> amass = ParseAmass(file.bytes, file.name, source.damaged_rows);
  if (!amass) return Forward(amass);
  const int joints_in_file = amass->pose_columns == 3 * kSmplJoints ? kSmplJoints : kBodyJoints;
  if (amass->frames == 0) return Fail(ErrorCode::kInconsistent, "the file has no frame", file.name);
  const SmplRotations rotations{amass->poses, amass->frames, amass->pose_columns, joints_in_file};
  Expected<std::vector<Quaterniond>> rotation = SmplLocalRotations(**skeleton, rotations, *world_from_file);
  if (!rotation) return Forward(rotation);
  std::vector<Vector3d> root_translation;
  for (std::size_t f = 0; f < amass->frames; ++f) {
    const double* trans = &amass->translation_m[f * 3];
    root_translation.push_back(*world_from_file * Vector3d(trans[0], trans[1], trans[2]));
  }

  IngestedClip ingested;
  Clip& clip = ingested.clip;
  clip.rate = RateOfFile(source, amass->rate_hz, ingested,
                         DoubtRate(amass->rate_hz, RateWord::kFramesPerSecond, file.name + ":mocap_framerate"));
  const auto bridged = BridgeFrames(amass->damaged, static_cast<int>(amass->frames), clip.rate.hz(), file.name);
  if (!bridged) return Forward(bridged);
  const int joints = (*skeleton)->joint_count();
  Bridge(*bridged, joints, root_translation, *rotation);
  for (int j = 0; j < joints && !bridged->empty(); ++j) {
    MakeSignContinuous(rotation->data() + j, amass->frames, static_cast<std::size_t>(joints));
  }
  clip.motion = MakeMotion(*skeleton, clip.rate, std::move(root_translation), *std::move(rotation), {});
  ingested.findings.insert(ingested.findings.end(), amass->findings.begin(), amass->findings.end());
  MarkBridged(*bridged, *clip.motion, ingested.findings);
  ingested.findings.push_back(NotTheSubject(**skeleton));
  if (auto angles = DoubtAngles(*amass)) ingested.findings.push_back(*std::move(angles));
  for (Finding& frozen : DoubtPoses(*amass)) ingested.findings.push_back(std::move(frozen));
  if (auto places = DoubtPlaces(*amass)) ingested.findings.push_back(*std::move(places));
  if (!amass->gender.empty()) clip.provenance["gender"] = amass->gender;
  if (!amass->surface_model.empty()) clip.provenance["body_model"] = amass->surface_model;
  if (Status added = AddSegments(file, clip, amass->frames, ingested.findings); !added) return Forward(added);
  return ingested;
}

}  // namespace

const FormatDriver& AmassFormat() {
  static const FormatDriver driver = [] {
    FormatDriver d;
    d.format = SourceFormat::kAmass;
    d.name = "amass";
    d.inspected = "amass";
    d.gives = Gives::kMotion;
    d.rotations = true;
    d.unit = UnitOf::kMetres;
    d.says_rate = true;
    d.lengths_assumed = true;
    d.options = {"annotations", "annotation_roles"};
    d.to_clip = ReadAmassClip;
    return d;
  }();
  return driver;
}

}  // namespace mocurate
