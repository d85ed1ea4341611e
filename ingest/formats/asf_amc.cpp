#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/amc.h"
#include "core/motion/kinematics.h"
#include "ingest/formats/driver.h"
#include "ingest/sense/angle_sense.h"
#include "ingest/sense/asf_sense.h"
#include "ingest/sense/path_sense.h"
#include "ingest/sense/rate_sense.h"
#include "ingest/sense/tree_points.h"
#include "ingest/sources/bvh_skeleton.h"
#include "ingest/sources/damaged_frames.h"

namespace mocurate {
namespace {

Status CheckSkeletonFiles(const SourceOptions& source) {
  if (!source.skeleton_files.empty()) return {};
  return Fail(ErrorCode::kConfig, "source '" + source.name + "' does not say which .asf belongs to an .amc",
              "ingest.source.skeleton_files", "e.g. '{subject}.asf' where files are '{subject}_{take}.amc'");
}

/// A tree of fixed bones holds no bone that stretches or moves off its parent.
Status CheckDof(const Asf& asf, const std::string& name) {
  for (const AsfBone& bone : asf.bones) {
    for (const AcclaimChannel channel : bone.dof) {
      if (IsRotation(channel)) continue;
      return Fail(ErrorCode::kUnsupported,
                  "bone '" + bone.name + "' has the degree of freedom '" + Name(channel) +
                      "': a tree of fixed bones cannot hold it",
                  name, "bones that only turn are read");
    }
  }
  return {};
}

/// The unit that the source says, metres; none where it says none.
std::optional<double> DeclaredUnit(const SourceOptions& source) {
  const Expected<double> metres = MetresPerUnit(source.units);
  return metres ? std::optional<double>(*metres) : std::nullopt;
}

/// The tree of an ASF: a joint where each bone starts, named as the bone, parents first; joint 0 is the root. `order`
/// is the bone of each joint.
struct AsfTree {
  Bvh tree;
  BvhOffsets offsets;
  std::vector<int> order;
};

AsfTree TreeOf(const Asf& asf, const Matrix3d& metres_from_file) {
  AsfTree made;
  made.order.push_back(-1);
  for (const int bone : asf.Order()) made.order.push_back(bone);
  std::vector<int> joint_of(asf.bones.size(), 0);
  for (std::size_t j = 1; j < made.order.size(); ++j) joint_of[made.order[j]] = static_cast<int>(j);
  for (const int bone : made.order) {
    BvhJoint joint;
    BvhOffsets::Joint offset;
    joint.name = bone < 0 ? "root" : asf.bones[bone].name;
    joint.parent = -1;
    if (bone >= 0) {
      const int parent = asf.bones[bone].parent;
      joint.parent = parent < 0 ? 0 : joint_of[parent];
      if (parent >= 0) offset.offset = metres_from_file * AsfOffset(asf.bones[parent]);
    }
    offset.above_carrier = bone < 0;
    joint.offset = offset.offset;
    made.tree.joints.push_back(std::move(joint));
    made.offsets.joints.push_back(offset);
  }
  return made;
}

/// Of every joint of the tree in one frame, parent_from_joint in the file's axes; `root` receives the place of the
/// root.
void LocalRotations(const Asf& asf, const Amc& amc, int frame, const AsfTree& made, std::vector<Matrix3d>& local,
                    Vector3d& root) {
  std::vector<Vector3d> ends;
  std::vector<Matrix3d> global;
  AcclaimForward(asf, amc, frame, ends, &root, &global);
  local.assign(made.order.size(), Matrix3d::Identity());
  for (std::size_t j = 1; j < made.order.size(); ++j) {
    const int bone = made.order[j];
    local[j] = AcclaimLocalRotation(asf, amc, frame, bone);
    if (asf.bones[bone].parent < 0) local[0] = global[bone] * local[j].transpose();
  }
}

/// AMC and its ASF -> given motion. A joint stands where its bone starts; rest offsets and lengths are the ASF's. Bones
/// that stretch or shift are refused.
Expected<IngestedClip> ReadAsfAmcClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  const Expected<SkeletonPtr> declared = SourceSkeleton(source);
  if (!declared) return Forward(declared);
  const Expected<Asf> asf = ParseAsf(file.skeleton_bytes, file.skeleton_name);
  if (!asf) return Forward(asf);
  if (Status turns = CheckDof(*asf, file.skeleton_name); !turns) return Forward(turns);
  AmcOptions reading;
  reading.skeleton = &*asf;
  reading.damaged_rows = source.damaged_rows;
  Expected<Amc> amc = ParseAmc(file.bytes, reading, file.name);
  if (!amc) return Forward(amc);
  if (asf->bones.empty() || amc->frames == 0) {
    return Fail(ErrorCode::kInconsistent, asf->bones.empty() ? "the skeleton has no bone" : "the file has no frame",
                asf->bones.empty() ? file.skeleton_name : file.name);
  }

  IngestedClip ingested;
  ingested.findings = asf->findings;
  for (const std::vector<Finding>& more :
       {amc->findings, DoubtSkeleton(*asf, file.skeleton_name, DeclaredUnit(source))})
    ingested.findings.insert(ingested.findings.end(), more.begin(), more.end());
  std::optional<Finding> angles = DoubtAngles(*asf, &*amc);
  if (!angles) angles = DoubtAngles(*amc, &*asf);
  if (angles) ingested.findings.push_back(*std::move(angles));
  ingested.clip.rate =
      !amc->hz ? FrameRate::FromHz(*source.rate_hz)
               : RateOfFile(source, *amc->hz, ingested,
                            DoubtRate(*amc->hz, RateWord::kFramesPerSecond, file.name + ": :SAMPLES-PER-SECOND"));
  const Matrix3d& world_from_file = frame->world_from_file;
  const Matrix3d& metres_from_file = frame->metres_from_file;
  const AsfTree made = TreeOf(*asf, metres_from_file);
  const Expected<BvhSkeleton> fit =
      MakeBvhSkeleton(made.tree, made.offsets, *declared, source.name, file.skeleton_name);
  if (!fit) return Forward(fit);

  const std::size_t joints = made.order.size();
  std::vector<Vector3d> root_translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(amc->frames) * joints);
  std::vector<Matrix3d> local;
  for (int f = 0; f < amc->frames; ++f) {
    Vector3d root;
    LocalRotations(*asf, *amc, f, made, local, root);
    root_translation.push_back(metres_from_file * root);
    for (std::size_t j = 0; j < joints; ++j) {
      rotation[static_cast<std::size_t>(f) * joints + fit->target[j]] =
          Quaterniond(Matrix3d(world_from_file * local[j] * world_from_file.transpose())).normalized();
    }
  }
  const auto bridged = BridgeFrames(amc->damaged, amc->frames, ingested.clip.rate.hz(), file.name);
  if (!bridged) return Forward(bridged);
  Bridge(*bridged, static_cast<int>(joints), root_translation, rotation);
  for (std::size_t j = 0; j < joints; ++j) {
    MakeSignContinuous(rotation.data() + j, static_cast<std::size_t>(amc->frames), joints);
  }
  ingested.clip.motion =
      MakeMotion(fit->skeleton, ingested.clip.rate, std::move(root_translation), std::move(rotation), fit->bone_length);
  MarkBridged(*bridged, *ingested.clip.motion, ingested.findings);
  if (auto path = DoubtPath(ingested.clip.motion->joints, PointsOfBody(*fit->skeleton))) {
    path->action =
        source.on_contradiction == OnContradiction::kRefuse ? FindingAction::kRefused : FindingAction::kFlagged;
    ingested.findings.push_back(*std::move(path));
  }
  ingested.clip.provenance["skeleton_file"] = file.skeleton_name;
  return ingested;
}

}  // namespace

const FormatDriver& AsfAmcFormat() {
  static const FormatDriver driver = [] {
    FormatDriver d;
    d.format = SourceFormat::kAsfAmc;
    d.name = "asf_amc";
    d.inspected = "amc";
    d.kind = FileKind::kAmc;
    d.ending = ".amc";
    d.gives = Gives::kMotion;
    d.rotations = true;
    d.check = CheckSkeletonFiles;
    d.options = {"skeleton_files"};
    d.to_clip = ReadAsfAmcClip;
    return d;
  }();
  return driver;
}

}  // namespace mocurate
