#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/bvh.h"
#include "core/motion/kinematics.h"
#include "ingest/checks/root_scale.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/raw_clip.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/bvh_skeleton.h"
#include "ingest/sources/damaged_frames.h"

namespace mocurate {
namespace {

/// A parsed file, and the findings about its numbers.
struct OpenedBvh {
  Bvh bvh;
  std::optional<Finding> angles, rate;
};

Expected<OpenedBvh> OpenBvh(std::string_view bytes, const std::string& name, DamagedRows damaged) {
  Expected<Bvh> bvh = ParseBvh(bytes, name, damaged);
  if (!bvh) return Forward(bvh);
  if (Status bones = CheckBones(*bvh, name); !bones) return Forward(bones);
  OpenedBvh opened{*std::move(bvh), {}, {}};
  opened.angles = CheckAngleUnits(opened.bvh);
  opened.rate = CheckStatedRate(opened.bvh.hz(), RateUnit::kSecondsPerFrame,
                                name + ":" + std::to_string(opened.bvh.frame_time_line));
  return opened;
}

std::string SlideText(double metres) { return FormatDouble(std::round(metres * 1e6) / 1e3) + " mm"; }

/// Joints whose bones change their length: flagged up to `max_slide`, refused beyond it.
Status CheckSliding(const BvhOffsets& offsets, const Bvh& bvh, double max_slide, const std::string& name,
                    std::vector<Finding>& findings) {
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    const double slide = offsets.joints[j].slide;
    if (slide <= BvhOffsets::kConstant || offsets.joints[j].above_carrier) continue;
    if (slide > max_slide) {
      return Fail(
          ErrorCode::kUnsupported,
          "joint '" + bvh.joints[j].name + "' slides along its bone by " + SlideText(slide) + ", more than the " +
              SlideText(max_slide) + " of max_slide",
          name,
          "a tree of fixed bones cannot represent it; raise ingest.source.max_slide to use the middle of its range");
    }
    findings.push_back(MakeFinding(
        "bone_slides", Severity::kWarning, slide,
        "the bone changes its length by " + RoundedText(slide, 3) + " m over the clip; middle of its range used",
        FindingAction::kKept));
    findings.back().joint = bvh.joints[j].name;
  }
  return {};
}

/// The root position in one frame that puts the carrier where the file has it, with fixed bones between the two.
/// `above` receives the rotation, in the file's axes, of the joint above the skeleton's root.
Vector3d RootPlace(const Bvh& bvh, int frame, const BvhOffsets& offsets, const BvhSkeleton& fit,
                   const Matrix3d& metres_from_file, const Matrix3d& world_from_file, Matrix3d& above) {
  Vector3d place = Vector3d::Zero();      // of the current joint, file frame
  Vector3d from_root = Vector3d::Zero();  // of the current joint with fixed bones, world axes, metres
  Matrix3d global = Matrix3d::Identity();
  for (const int j : offsets.Path(bvh)) {
    place += global * BvhLocalPosition(bvh, frame, j);
    if (j == fit.root) above = global;
    if (j > fit.root) {
      from_root += world_from_file * global * world_from_file.transpose() * fit.offset[j];
    }
    global = global * BvhLocalRotation(bvh, frame, j);
  }
  return metres_from_file * place - from_root;
}

/// The joints above the skeleton's root: how far from it they lie at most is the value.
Finding SceneRoot(const Bvh& bvh, const BvhSkeleton& fit, double away) {
  std::string above;
  for (int j = 0; j < fit.root; ++j) above += (j > 0 ? ", " : "") + ("'" + bvh.joints[j].name + "'");
  const std::string& root = bvh.joints[fit.root].name;
  Finding finding = MakeFinding("scene_root", Severity::kInfo, away,
                                "'" + root + "' moves below " + above + ", up to " + RoundedText(away, 3) +
                                    " m from the file's root: '" + root + "' is the root of the motion, and " + above +
                                    (fit.root > 1 ? " are no joints of it" : " is no joint of it"),
                                FindingAction::kExcluded);
  finding.joint = bvh.joints[0].name;
  return finding;
}

/// The root was moved by `moved` metres at most, so that the carrier lies where the file has it.
Finding RootMoved(const Bvh& bvh, const BvhOffsets& offsets, const Skeleton& declared, double moved) {
  Finding finding = MakeFinding("root_moved", Severity::kWarning, moved,
                                "'" + bvh.joints[0].name + "' lies up to " + RoundedText(moved, 3) +
                                    " m from where the file has it: skeleton '" + declared.name +
                                    "' has bones of fixed length from there to '" + bvh.joints[offsets.carrier].name +
                                    "', which the file moves; declare a skeleton without '" + bvh.joints[0].name +
                                    "', or none to use the file's own",
                                FindingAction::kRepaired);
  finding.joint = bvh.joints[0].name;
  return finding;
}

/// What was done to the root of a file whose translation another joint carries. A declared skeleton in which the two
/// coincide declares it.
std::optional<Finding> CheckRoot(const Bvh& bvh, const BvhOffsets& offsets, const BvhSkeleton& fit, double moved) {
  if (offsets.carrier == 0) return std::nullopt;
  if (fit.root > 0) return SceneRoot(bvh, fit, moved);
  double bones = 0.0;
  for (const int j : offsets.Path(bvh)) bones += fit.offset[j].norm();
  if (bones <= BvhOffsets::kConstant) return std::nullopt;
  return RootMoved(bvh, offsets, *fit.skeleton, moved);
}

constexpr double kCarriesFrom =
    0.01;  // of the summed bone length; the root's children slide less where they do not carry the translation

/// The joint that carries the translation of a file whose unit is unknown (Bandai's files: the hips).
int CarrierOf(const Bvh& bvh) {
  double bones = 0.0;
  for (const BvhJoint& joint : bvh.joints) bones += joint.offset.norm();
  return MeasureOffsets(bvh, Matrix3d::Identity(), kCarriesFrom * bones, nullptr).carrier;
}

Expected<RawFile> BvhIn(const FileBytes& file) {
  const Expected<OpenedBvh> opened = OpenBvh(file.bytes, file.name, DamagedRows::kReport);
  if (!opened) return Forward(opened);
  const Bvh* bvh = &opened->bvh;
  RawClip clip;
  clip.format = "bvh";
  clip.frames = bvh->frames;
  clip.joints = static_cast<int>(bvh->joints.size());
  clip.rate_evidence = "Frame Time of the file";
  clip.rate_hz = std::round(bvh->hz() * 1000.0) / 1000.0;
  clip.rate_finding = opened->rate;
  for (const BvhJoint& joint : bvh->joints) clip.names.push_back(joint.name);
  clip.positions = JointPositions(bvh->frames, clip.joints);
  std::vector<Vector3d> positions;
  for (int f = 0; f < bvh->frames; ++f) {
    BvhForward(*bvh, f, positions);
    for (int j = 0; j < clip.joints; ++j) clip.positions.at(f, j) = positions[static_cast<std::size_t>(j)];
  }
  clip.SetMissing(bvh->damaged);
  std::vector<int> parents;
  for (const BvhJoint& joint : bvh->joints) parents.push_back(joint.parent);
  FollowTree(parents, "HIERARCHY with ROOT " + clip.names[0], clip);
  clip.layout_evidence = "header of the file";
  if (opened->angles) {
    clip.remarks.push_back(*opened->angles);
    clip.positions = JointPositions();
    clip.confidence.clear();
    clip.silence = kInvalidPoses;
  }
  if (clip.positions.frames > 0) {
    JointPositions carried = clip.positions;
    const int carrier = CarrierOf(*bvh);
    for (int f = 0; f < carried.frames && carrier > 0; ++f) carried.at(f, 0) = Vector3d(carried.at(f, carrier));
    if (carrier > 0) clip.facts.emplace_back("translation_from", clip.names[static_cast<std::size_t>(carrier)]);
    if (const auto path = CheckRootPath(carried, clip.points)) clip.remarks.push_back(*path);
  }
  clip.AddRemarks(bvh->findings);
  return RawFile::Of(std::move(clip));
}

/// A body in a wrong unit breaks the rules of a skeleton: the declared unit is the error then.
Error UnitsOr(const Error& otherwise, const SourceFile& file) {
  const Expected<RawFile> observed = BvhIn({file.bytes, file.name, {}});
  if (!observed) return otherwise;
  const RawClip& clip = observed->clips.front();
  const ClipMeasures measures = Measure(clip);
  for (const Comparison& comparison : CompareFrame(DeclaredFrameOf(clip, file.source), measures)) {
    if (comparison.finding.code != "units_contradiction" || !comparison.contradicts) continue;
    return {ErrorCode::kInconsistent, comparison.finding.message, file.name,
            "correct ingest.source.units" +
                (comparison.measured.empty() ? std::string() : ": write `units: " + comparison.measured + "`")};
  }
  return otherwise;
}

/// BVH -> given motion. Local frames are rotated with the axes; OFFSETs become rest offsets and bone lengths. Where a
/// joint below the root moves, it carries the translation: in a tree of the file's own it is the root, and the joints
/// above it are none (finding scene_root). A declared skeleton keeps them: the root's position is then that joint's
/// minus the rest offsets between them (bandai22: joint_Root lies on Hips; else finding root_moved). Joints that slide
/// along their bones by more than max_slide are refused.
Expected<IngestedClip> ReadBvhClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  const Expected<SkeletonPtr> declared = SourceSkeleton(source);
  if (!declared) return Forward(declared);
  const Expected<OpenedBvh> opened = OpenBvh(file.bytes, file.name, source.damaged_rows);
  if (!opened) return Forward(opened);
  const Bvh* bvh = &opened->bvh;

  IngestedClip ingested;
  ingested.findings = bvh->findings;
  if (opened->angles) ingested.findings.push_back(*opened->angles);
  ingested.clip.rate = RateOfFile(source, bvh->hz(), ingested, opened->rate);
  const Matrix3d& world_from_file = frame->world_from_file;
  const Matrix3d& metres_from_file = frame->metres_from_file;
  const BvhOffsets offsets = MeasureOffsets(*bvh, metres_from_file, source.max_slide, declared->get());
  if (Status ok = CheckSliding(offsets, *bvh, source.max_slide, file.name, ingested.findings); !ok) return Forward(ok);
  const Expected<BvhSkeleton> fit = MakeBvhSkeleton(*bvh, offsets, *declared, source.name, file.name);
  if (!fit) return tl::unexpected<Error>(UnitsOr(fit.error(), file));

  const int joints = fit->skeleton->joint_count();
  std::vector<Vector3d> root_translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(bvh->frames) * joints);
  double moved = 0.0;
  for (int f = 0; f < bvh->frames; ++f) {
    Matrix3d above = Matrix3d::Identity();
    root_translation.push_back(RootPlace(*bvh, f, offsets, *fit, metres_from_file, world_from_file, above));
    moved = std::max(moved, (root_translation.back() - metres_from_file * BvhLocalPosition(*bvh, f, 0)).norm());
    for (int j = fit->root; j < static_cast<int>(bvh->joints.size()); ++j) {
      const Matrix3d local =
          j == fit->root ? Matrix3d(above * BvhLocalRotation(*bvh, f, j)) : BvhLocalRotation(*bvh, f, j);
      rotation[static_cast<std::size_t>(f) * joints + fit->target[j]] =
          Quaterniond(Matrix3d(world_from_file * local * world_from_file.transpose())).normalized();
    }
  }
  if (Status added = AddMotion(bvh->damaged, fit->skeleton, fit->bone_length, std::move(root_translation),
                               std::move(rotation), file.name, ingested);
      !added) {
    return Forward(added);
  }
  if (auto path = CheckRootPath(ingested.clip.motion->joints, PointsOfBody(*fit->skeleton))) {
    path->action = ContradictionAction(source);
    ingested.findings.push_back(*std::move(path));
  }
  if (auto root = CheckRoot(*bvh, offsets, *fit, moved)) ingested.findings.push_back(*std::move(root));
  if (offsets.carrier > 0) {
    ingested.clip.provenance["translation_from"] = bvh->joints[offsets.carrier].name;
  }
  return ingested;
}

}  // namespace

FormatDriver BvhFormat() {
  FormatDriver d;
  d.name = "bvh";
  d.kinds = {FileKind::kBvh};
  d.ending = ".bvh";
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.states_rate = true;
  d.options = {"max_slide"};
  d.open = BvhIn;
  d.to_clip = ReadBvhClip;
  return d;
}

}  // namespace mocurate
