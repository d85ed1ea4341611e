#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/finding.h"
#include "core/base/text.h"
#include "core/formats/amass.h"
#include "core/formats/npz.h"
#include "core/motion/kinematics.h"
#include "core/motion/motion.h"
#include "core/quality/tracked_points.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/raw_clip.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/babel_segments.h"
#include "ingest/sources/damaged_frames.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestFrames = 5;
constexpr std::size_t kMostSpans = 20;
constexpr std::size_t kFirstColumn = 3, kColumnsOfBody = 66;  // root, 21 joints of the body

class FrozenPoses {
 public:
  explicit FrozenPoses(const Amass& amass) : amass_(amass) {}

  bool SamePose(std::size_t f) const {
    const std::size_t last = std::min(kColumnsOfBody, amass_.pose_columns);
    return Same(amass_.poses, amass_.pose_columns, f, kFirstColumn, last);
  }
  bool SamePlace(std::size_t f) const { return Same(amass_.translation_m, 3, f, 0, 3); }
  bool AllZero(std::size_t f) const {
    const auto row = amass_.poses.begin() + static_cast<std::ptrdiff_t>(f * amass_.pose_columns);
    return std::all_of(row + kFirstColumn, row + std::min<std::ptrdiff_t>(kColumnsOfBody, amass_.pose_columns),
                       [](double value) { return value == 0.0; });
  }
  bool Damaged(std::size_t f) const {
    return std::binary_search(amass_.damaged.begin(), amass_.damaged.end(), static_cast<int>(f));
  }

 private:
  /// Columns [first, last) of frame f and of the one before.
  static bool Same(const std::vector<double>& values, std::size_t wide, std::size_t f, std::size_t first,
                   std::size_t last) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(f * wide);
    const auto before = row - static_cast<std::ptrdiff_t>(wide);
    return std::equal(row + first, row + last, before + first);
  }

  const Amass& amass_;
};

/// `carried`: while the root goes on.
Finding FrozenPose(bool zero, bool carried, std::size_t begin, std::size_t end, std::size_t frames) {
  Finding finding =
      FrameFinding("frozen_pose", static_cast<int>(begin), static_cast<int>(end), "", static_cast<double>(end - begin),
                   (zero ? "all rotations of the body are 0 in " : "no joint of the body turns in ") +
                       Counted(static_cast<long long>(end - begin), "frame") + " on end (" + std::to_string(begin) +
                       "-" + std::to_string(end) + (carried ? "), while `trans` carries it on: " : "): ") +
                       (zero ? "the poses are not there" : "the poses are repeated or of another file") +
                       "; copy the file again, or leave these frames out");
  if (2 * (end - begin) >= frames) finding.severity = Severity::kError;
  return finding;
}

/// "frozen_pose": frames on end in which every rotation of the body's joints (the root's and the hands' aside) is what
/// it was to the last digit, while the root is carried on: `trans` changes in at least half of the steps. 5 frames or
/// more are reported, at most 20 spans; value: frames; an error from half of the clip on. Fitted poses of who stands
/// still differ in every frame, and who repeats as a whole is "frozen_frames" (core/quality/checks.h). Of rotations
/// that are all 0, which no fit gives, a single such frame is reported, wherever the root is.
std::vector<Finding> CheckFrozenPoses(const Amass& amass) {
  std::vector<Finding> findings;
  const FrozenPoses poses(amass);
  if (amass.pose_columns <= kFirstColumn) return findings;
  for (std::size_t begin = 0, f = 1; begin < amass.frames; begin = f, ++f) {
    std::size_t moved = 0;
    for (; f < amass.frames && poses.SamePose(f) && !poses.Damaged(f) && !poses.Damaged(f - 1); ++f)
      moved += poses.SamePlace(f) ? 0 : 1;
    const std::size_t held = f - begin;
    const bool zero = poses.AllZero(begin) && !poses.Damaged(begin), carried = held > 1 && 2 * moved >= held - 1;
    const bool blank = zero && held < amass.frames;
    if ((blank || (held >= kFewestFrames && carried)) && findings.size() < kMostSpans)
      findings.push_back(FrozenPose(zero, carried, begin, f, amass.frames));
  }
  return findings;
}

/// "path_missing": `trans` is 0 0 0 in every frame, 5 or more, while joints turn. Value: frames.
std::optional<Finding> CheckTranslations(const Amass& amass) {
  const FrozenPoses poses(amass);
  bool turns = false;
  for (std::size_t f = 1; f < amass.frames && !turns; ++f)
    turns = amass.pose_columns > kFirstColumn && !poses.SamePose(f);
  const auto zero = [](double value) { return value == 0.0; };
  if (!turns || amass.frames < kFewestFrames || !amass.damaged.empty() ||
      !std::all_of(amass.translation_m.begin(), amass.translation_m.end(), zero))
    return std::nullopt;
  const int frames = static_cast<int>(amass.frames);
  return FrameFinding("path_missing", 0, frames, "", frames,
                      "`trans` is 0 0 0 in every one of " + Counted(frames, "frame") +
                          ", while the body turns: the file does not say where the body goes; copy the file again, or "
                          "use its rotations alone");
}

/// Findings about the numbers of a file.
struct AmassFindings {
  std::vector<Finding> findings;
  std::optional<Finding> rate;
};

AmassFindings CheckAmass(const Amass& amass, const std::string& name) {
  AmassFindings checked;
  checked.findings = amass.findings;
  if (auto angles = CheckAngleUnits(amass)) checked.findings.push_back(*std::move(angles));
  for (Finding& frozen : CheckFrozenPoses(amass)) checked.findings.push_back(std::move(frozen));
  if (auto places = CheckTranslations(amass)) checked.findings.push_back(*std::move(places));
  checked.rate = CheckStatedRate(amass.rate_hz, RateUnit::kFramesPerSecond, name + ":mocap_framerate");
  return checked;
}

constexpr int kBodyJoints = 22;  // common to SMPL, SMPL-H and SMPL-X; SMPL's two hands are their fingers

SmplRotations RotationsIn(const Amass& amass) {
  return {amass.poses, amass.frames, amass.pose_columns,
          amass.pose_columns == std::size_t{3} * kSmplJoints ? kSmplJoints : kBodyJoints};
}

Finding NotTheSubject(const Skeleton& skeleton) {
  return MakeFinding(
      "bones_not_the_subjects", Severity::kInfo, 0.0,
      "the file states the body's shape as coefficients of a body model that is not available: bone lengths are "
      "those of skeleton '" +
          skeleton.name +
          "', and the pelvis lies at `trans`, which the model's rest pelvis (0.2 to 0.4 m, constant "
          "over the clip) would have to be added to; rest offsets of the skeleton used",
      FindingAction::kKept);
}

Status AddSegments(const SourceFile& file, Clip& clip, std::size_t frames, std::vector<Finding>& findings) {
  if (file.source.annotations.empty()) return {};
  if (file.facts.annotation.empty()) {
    findings.push_back(MakeFinding("not_annotated", Severity::kInfo, 0.0,
                                   "no annotation file lists this motion; kept without labels", FindingAction::kKept));
    return {};
  }
  const Expected<std::vector<BabelSequence>> sequences = ParseBabel(file.facts.annotation, file.name + " (annotation)");
  if (!sequences) return Forward(sequences);
  const double frame_s = clip.rate.FrameTime(1);
  clip.segments = SegmentsOf(sequences->at(0), static_cast<double>(frames) * frame_s, frame_s, findings);
  clip.provenance["babel_sid"] = std::to_string(sequences->at(0).babel_sid);
  return {};
}

/// AMASS -> given motion on SMPL's 24 joints: the body's rotations, without the hands, jaw and eyes of SMPL-H and
/// SMPL-X. Without a body model, rest offsets are the skeleton's and the pelvis lies at `trans`; a finding reports
/// this. With `annotations`, BABEL's labels become the segments.
Expected<IngestedClip> ReadAmassClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<Quaterniond> world_from_file = RotationOfAxes(source.axes);
  if (!world_from_file) return Forward(world_from_file);
  Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (skeleton && !*skeleton) skeleton = LoadSkeleton("smpl24");
  if (!skeleton) return Forward(skeleton);
  const Expected<Amass> amass = ParseAmass(file.bytes, file.name, source.damaged_rows);
  if (!amass) return Forward(amass);
  if (amass->frames == 0) return Fail(ErrorCode::kInconsistent, "the file has no frame", file.name);
  Expected<std::vector<Quaterniond>> rotation = SmplLocalRotations(**skeleton, RotationsIn(*amass), *world_from_file);
  if (!rotation) return Forward(rotation);
  std::vector<Vector3d> root_translation;
  for (std::size_t f = 0; f < amass->frames; ++f) {
    const double* trans = &amass->translation_m[f * 3];
    root_translation.push_back(*world_from_file * Vector3d(trans[0], trans[1], trans[2]));
  }

  IngestedClip ingested;
  Clip& clip = ingested.clip;
  const AmassFindings checked = CheckAmass(*amass, file.name);
  clip.rate = RateOfFile(source, amass->rate_hz, ingested, checked.rate);
  ingested.findings.insert(ingested.findings.end(), checked.findings.begin(), checked.findings.end());
  if (Status added = AddMotion(amass->damaged, *skeleton, {}, std::move(root_translation), *std::move(rotation),
                               file.name, ingested);
      !added) {
    return Forward(added);
  }
  ingested.findings.push_back(NotTheSubject(**skeleton));
  if (!amass->gender.empty()) clip.provenance["gender"] = amass->gender;
  if (!amass->surface_model.empty()) clip.provenance["body_model"] = amass->surface_model;
  if (Status added = AddSegments(file, clip, amass->frames, ingested.findings); !added) return Forward(added);
  return ingested;
}

/// The rotations on SMPL's tree, which is the same for every body. The joints have standard proportions, so that bone
/// lengths mean nothing.
Expected<Motion> PoseTree(const Amass& amass) {
  const Expected<SkeletonPtr> skeleton = KnownSkeleton("smpl24");
  if (!skeleton) return Forward(skeleton);
  Expected<std::vector<Quaterniond>> local =
      SmplLocalRotations(**skeleton, RotationsIn(amass), Quaterniond::Identity());
  if (!local) return Forward(local);
  std::vector<Vector3d> pelvis;
  for (std::size_t f = 0; f < amass.frames; ++f)
    pelvis.push_back(Eigen::Map<const Vector3d>(&amass.translation_m[3 * f]));
  const FrameRate rate = FrameRate::FromHz(amass.rate_hz > 0.0 ? amass.rate_hz : 1.0);
  const auto bridged = BridgeFrames(amass.damaged, static_cast<int>(amass.frames), "");
  if (bridged) Bridge(*bridged, (*skeleton)->joint_count(), pelvis, *local);
  return MakeMotion(*skeleton, rate, std::move(pelvis), std::move(*local), {});
}

void StandOnTree(const Motion& motion, const std::vector<int>& damaged, RawClip& clip) {
  clip.positions = motion.joints;
  clip.SetMissing(damaged);
  const Reported<std::string> declared = clip.skeleton;
  std::vector<std::string> names;
  for (const Joint& joint : motion.skeleton->joints) names.push_back(joint.name);
  FollowFormat("smpl24", names, declared.evidence + "; posed on SMPL's tree with standard proportions", clip);
  clip.skeleton.value = declared.value;
  clip.lengths_assumed = true;
}

RawClip AmassClip(const Amass& amass, const std::string& name) {
  RawClip clip;
  clip.format = "amass";
  clip.frames = static_cast<int>(amass.frames);
  clip.joints = static_cast<int>(amass.pose_columns / 3);
  clip.rate_hz = amass.rate_hz;
  clip.rate_evidence =
      amass.layout == Amass::Layout::kSplit ? "mocap_frame_rate of the file" : "mocap_framerate of the file";
  const AmassFindings checked = CheckAmass(amass, name);
  clip.rate_finding = checked.rate;
  clip.layout_evidence = std::to_string(amass.pose_columns) + " pose numbers a frame";
  clip.skeleton = AsDeclared(!amass.surface_model.empty() ? amass.surface_model
                             : amass.pose_columns == 156  ? "smplh"
                             : amass.pose_columns == 165  ? "smplx"
                                                          : "smpl",
                             clip.layout_evidence);
  clip.units = "m";
  clip.facts.emplace_back("gender", amass.gender.empty() ? "unknown" : amass.gender);
  clip.facts.emplace_back("betas", std::to_string(amass.betas.size()));
  clip.facts.emplace_back("markers", std::to_string(amass.markers));
  clip.missing_share = 0.0;
  clip.AddRemarks(checked.findings);
  // Poses in another unit show nothing.
  const Expected<Motion> posed =
      InvalidatesPoses(checked.findings) ? Fail(ErrorCode::kInconsistent, kInvalidPoses, name) : PoseTree(amass);
  if (posed) {
    clip.root_scale = MeasureRootScale(posed->joints, PointsOfBody(*posed->skeleton));
    StandOnTree(*posed, amass.damaged, clip);
  } else {
    clip.silence = posed.error().what;
  }
  return clip;
}

/// AMASS, exports, body models (which are only named), and archives of arrays.
Expected<RawFile> NpzIn(const FileBytes& file) {
  const Expected<Npz> archive = ParseNpz(file.bytes, file.name);
  if (!archive) return Forward(archive);
  RawFile observed;
  if (const auto exported = ExportedMotionIn(*archive)) {
    Expected<RawClip> clip = ReadRawExported(*exported, file.name);
    if (!clip) return Forward(clip);
    return RawFile::Of(*std::move(clip));
  }
  if (archive->Find("trans") != nullptr || archive->Find("poses") != nullptr || archive->Find("pose_body") != nullptr) {
    const Expected<Amass> amass = ParseAmass(file.bytes, file.name, DamagedRows::kReport);
    if (!amass) return Forward(amass);
    return RawFile::Of(AmassClip(*amass, file.name));
  }
  if (archive->Find("v_template") != nullptr) {
    return RawFile::Of(RawCompanion{file.name, "body_model", {}, {}});
  }
  for (const Error& unsafe : archive->unsafe) observed.remarks.push_back(UnsafeMember(unsafe));
  std::optional<Error> exchanged;
  std::vector<std::string> parameters;
  for (const NpzMember& member : archive->members) {
    if (!member.skipped.empty()) continue;
    if (IsBodyParameter(member.name)) {
      parameters.push_back(member.name);
      continue;
    }
    auto clips = ReadRawArray(member.array, file.name + ":" + member.name);
    // An archive may hold other arrays beside those of joints.
    if (!clips && clips.error().code == ErrorCode::kInconsistent) exchanged = clips.error();
    if (!clips) continue;
    for (RawClip& clip : *clips) {
      clip.id = "[" + member.name + "]" + clip.id;
      clip.format = "npz";
      observed.clips.push_back(std::move(clip));
    }
  }
  if (observed.clips.empty() && !archive->unsafe.empty()) return tl::unexpected<Error>(archive->unsafe.front());
  if (observed.clips.empty() && exchanged) return tl::unexpected<Error>(*exchanged);
  if (observed.clips.empty() && !parameters.empty()) {
    return Fail(ErrorCode::kUnsupported, "parameters of SMPL (" + JoinTexts(parameters) + "), not joint positions",
                file.name, "write them as AMASS does: `poses`, `trans`, `betas`, `gender` and `mocap_framerate`");
  }
  if (observed.clips.empty()) {
    return Fail(ErrorCode::kUnsupported, "no array of the archive is a sequence of joint positions", file.name,
                "expected: (frames, joints, 3), or AMASS");
  }
  return observed;
}

/// BABEL's files of the folder, and how many of the motions they speak of.
void WriteAnnotations(const Proposal& proposal, DeclarationWriter& writer) {
  std::vector<std::string> files;
  std::string list;
  for (const RawCompanion& companion : proposal.inspection.companions) {
    if (companion.format != "babel") continue;
    files.push_back(companion.file);
    list += (list.empty() ? "" : ", ") + YamlQuoted(files.back());
  }
  if (files.empty()) return writer.Comment("annotations: no file of BABEL's lies in the folder, clips have no labels");
  Expected<BabelIndex> babel = BabelIndex::Read(proposal.folder, files);
  if (!babel) return writer.Comment("annotations: not written, " + babel.error().Message());
  const auto spoken_of = [&](const InspectedClip* clip) { return babel->Find(clip->file) != nullptr; };
  const auto joined = std::count_if(proposal.source.clips().begin(), proposal.source.clips().end(), spoken_of);
  writer.Value("annotations", "[" + list + "]",
               "BABEL's, joined by the path in `feat_p`, which names " + std::to_string(joined) + " of the " +
                   Counted(proposal.source.clips().size(), "motion") +
                   (joined > 0 ? "" : ": keep AMASS's folders as they were"));
}

void ProposeAmass(const Proposal& proposal, DeclarationWriter& writer) {
  WriteFiles(proposal, writer);
  WritePersonAndLabel(false, writer);
  if (proposal.asked == proposal.folder) WriteAnnotations(proposal, writer);
}

}  // namespace

FormatDriver AmassFormat() {
  FormatDriver d;
  d.name = "amass";
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.unit = UnitOf::kMetres;
  d.states_rate = true;
  d.lengths_assumed = true;
  d.tree = "smpl24";
  d.zeros = "; the file does not state where the body moves";
  d.options = {"annotations", "annotation_roles"};
  d.sniff = [](const FileBytes&, FileKind kind) { return kind == FileKind::kZip; };  // arrays, too
  d.open = NpzIn;
  d.propose = ProposeAmass;
  d.to_clip = ReadAmassClip;
  return d;
}

}  // namespace mocurate
