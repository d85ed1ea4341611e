#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/mdm_results.h"
#include "core/formats/npy.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/array_clips.h"
#include "ingest/sources/mapped_file.h"

namespace mocurate {
namespace {

std::string ArrayShapeText(const NpyArray& array) {
  std::string text = "(";
  for (std::size_t i = 0; i < array.shape.size(); ++i) text += (i ? ", " : "") + std::to_string(array.shape[i]);
  return text + ")";
}

/// Joints of the skeleton that the file lists, and the column of each in a frame.
struct FileOrder {
  std::vector<int> joint;
  std::vector<int> place;
};

/// By the declared names, or in the skeleton's own order.
Expected<FileOrder> OrderOf(const SourceOptions& source, const Skeleton& skeleton) {
  std::vector<int> place(skeleton.joints.size(), -1);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (source.joints.empty()) place[j] = j;
  }
  for (std::size_t k = 0; k < source.joints.size(); ++k) {
    if (const auto joint = skeleton.FindJoint(source.joints[k])) place[*joint] = static_cast<int>(k);
  }
  FileOrder order;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (place[j] < 0) continue;
    order.joint.push_back(j);
    order.place.push_back(place[j]);
  }
  if (order.joint.empty()) {
    return Fail(ErrorCode::kConfig, "the source names no joint of skeleton '" + skeleton.name + "'",
                "ingest.source.joints", "name each joint of the file in its order, '-' for one that is skipped");
  }
  return order;
}

/// Where the file names its joints: error kInconsistent for a name that contradicts the declaration.
Status CheckNamesOfFile(const std::vector<std::string>& names, const FileOrder& order, const Skeleton& skeleton,
                        const std::string& file) {
  for (std::size_t k = 0; !names.empty() && k < order.joint.size(); ++k) {
    const std::string& named = names[static_cast<std::size_t>(order.place[k])];
    const auto joint = skeleton.FindJoint(named);
    if (!joint || static_cast<int>(*joint) == order.joint[k]) continue;
    return Fail(ErrorCode::kInconsistent,
                "joint_names has '" + named + "' where '" + skeleton.joints[order.joint[k]].name + "' is declared",
                file, "list the file's joints under ingest.source.joints, in its order");
  }
  return {};
}

/// Positions as joint tracks, in world metres. A point whose coordinates no person can have is missing.
JointTracks TracksOfArray(const NpyArray& array, std::size_t wide, const FileOrder& order, const Skeleton& skeleton,
                          const Matrix3d& metres_from_file, const FrameRate& rate) {
  const int joints = static_cast<int>(order.joint.size());
  JointTracks tracks;
  tracks.positions = JointPositions(static_cast<int>(array.shape[0]), joints);
  for (const int joint : order.joint) tracks.names.push_back(skeleton.joints[joint].name);
  for (int f = 0; f < tracks.positions.frames; ++f) {
    tracks.time_s.push_back(rate.FrameTime(f));
    for (int k = 0; k < joints; ++k) {
      const Eigen::Map<const Vector3d> raw(array.values.data() +
                                           (static_cast<std::size_t>(f) * wide + order.place[k]) * 3);
      const bool sound = raw.allFinite() && raw.cwiseAbs().maxCoeff() <= kLargestNumber;
      tracks.confidence.push_back(sound ? 1.0 : 0.0);
      if (sound) tracks.positions.at(f, k) = metres_from_file * raw;
    }
  }
  return tracks;
}

/// States that the file gives, joints in the skeleton's order. (F*J), or none
std::vector<JointState> StatesOfFile(const std::vector<double>& given, const FileOrder& order, std::size_t wide,
                                     int frames) {
  std::vector<JointState> states;
  if (given.size() != wide * static_cast<std::size_t>(frames)) return states;
  for (std::size_t f = 0; f < static_cast<std::size_t>(frames); ++f) {
    for (const int place : order.place) {
      states.push_back(static_cast<JointState>(given[f * wide + static_cast<std::size_t>(place)]));
    }
  }
  return states;
}

/// Action2Motion's raw outputs, root translation and a rotation vector per joint, as positions by its released
/// kinematics (a2m_actor.md B.3).
Expected<NpyArray> JointsOfLie(const NpyArray& array, std::size_t wide, const Skeleton& skeleton,
                               const std::vector<double>& bone_lengths) {
  const auto joints = static_cast<std::size_t>(skeleton.joint_count());
  if (!skeleton.lie || bone_lengths.size() != joints) {
    return Fail(ErrorCode::kConfig,
                std::to_string(bone_lengths.size()) + " bone lengths, skeleton '" + skeleton.name + "' has " +
                    std::to_string(joints) + " joints" + (skeleton.lie ? "" : " and no Lie chains"),
                "ingest.source.lie_bone_lengths", "one per joint, 0 for the root, of a skeleton with lie_chains");
  }
  if (wide != joints) {
    return Fail(ErrorCode::kConfig,
                std::to_string(wide) + " joints are listed, Lie parameters are of all " + std::to_string(joints) +
                    " of skeleton '" + skeleton.name + "'",
                "ingest.source.joints", "remove `joints`");
  }
  NpyArray positions = array;
  std::vector<Vector3d> frame(joints);
  for (std::size_t f = 0; f < array.shape[0]; ++f) {
    const double* parameters = array.values.data() + f * joints * 3;
    if (!std::all_of(parameters, parameters + joints * 3, [](double value) { return std::isfinite(value); })) continue;
    if (std::all_of(parameters, parameters + joints * 3, [](double value) { return value == 0.0; }))
      continue;  // padding
    LieForward(skeleton, parameters, bone_lengths, LieExp::kReleased, frame.data());
    for (std::size_t j = 0; j < joints; ++j) {
      for (std::size_t k = 0; k < 3; ++k) positions.values[(f * joints + j) * 3 + k] = frame[j][static_cast<int>(k)];
    }
  }
  return positions;
}

Expected<IngestedClip> ReadArraySource(const SourceFile& file) {
  const std::string& id = file.facts.array;
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton) return Forward(skeleton);
  const Expected<FileOrder> order = OrderOf(source, **skeleton);
  if (!order) return Forward(order);
  const auto mapped = MappedFile::Open(file.container);
  if (!mapped) return Forward(mapped);
  const Expected<ArrayOfClip> read = ReadArrayClip((*mapped)->bytes(), id, file.name);
  if (!read) return Forward(read);
  const NpyArray* array = &read->array;

  const std::size_t wide = source.joints.empty() ? (*skeleton)->joints.size() : source.joints.size();
  const bool cube = array->shape.size() == 3 && array->shape[1] == wide && array->shape[2] == 3;
  const bool flat = array->shape.size() == 2 && array->shape[1] == wide * 3;
  if (!array->texts.empty()) {
    return Fail(ErrorCode::kInconsistent, "the array holds text, not joint positions", file.name);
  }
  if (source.lie_bone_lengths.empty()) {
    std::vector<std::string> joints = source.joints;
    for (const Joint& joint : (*skeleton)->joints) {
      if (source.joints.empty()) joints.push_back(joint.name);
    }
    const std::string rotations = RotationsInstead(*array, file.name, BonesOf(joints, **skeleton));
    if (!rotations.empty()) return Fail(ErrorCode::kUnsupported, "the array holds " + rotations, file.name);
  }
  if (const std::string other = OtherThanJoints(array->shape); !cube && !flat && !other.empty()) {
    return Fail(ErrorCode::kInconsistent, "an array of shape " + ArrayShapeText(*array) + " holds " + other, file.name);
  }
  if (const auto axes = ExchangedAxes(*array, wide); axes && !cube) {
    return Fail(ErrorCode::kInconsistent, "the array has shape " + ArrayShapeText(*array) + ": " + axes->words,
                file.name, axes->way_out);
  }
  if ((!cube && !flat) || array->shape[0] == 0) {
    return Fail(
        ErrorCode::kInconsistent,
        "the array has shape " + ArrayShapeText(*array) + ", (frames, " + std::to_string(wide) + ", 3) is needed",
        file.name, "skeleton '" + source.skeleton + "' has " + std::to_string(wide) + " joints");
  }
  if (Status named = CheckNamesOfFile(read->names, *order, **skeleton, file.name); !named) return Forward(named);
  const int frames = static_cast<int>(array->shape[0]);
  NpyArray positions;
  if (!source.lie_bone_lengths.empty()) {
    Expected<NpyArray> forward = JointsOfLie(*array, wide, **skeleton, source.lie_bone_lengths);
    if (!forward) return Forward(forward);
    positions = std::move(*forward);
    array = &positions;
  }
  IngestedClip ingested;
  DamagedNumbers damaged = DamagedNumbersOf(array->values.data(), frames, static_cast<int>(wide), file.name);
  ingested.findings = std::move(damaged.findings);
  if (!ingested.findings.empty() && source.damaged_rows == DamagedRows::kRefuse) {
    return Fail(ErrorCode::kMalformed, ingested.findings[0].message, file.name,
                "repair the file, or declare the source with damaged_rows: report");
  }
  ingested.content = id.empty() ? std::string((*mapped)->bytes()) : BytesOf(array->values);
  ingested.clip.rate =
      read->rate_hz ? RateOfFile(source, *read->rate_hz, ingested) : FrameRate::FromHz(*source.rate_hz);
  JointTracks tracks = TracksOfArray(*array, wide, *order, **skeleton, frame->metres_from_file, ingested.clip.rate);
  if (std::count(tracks.confidence.begin(), tracks.confidence.end(), 0.0) ==
      static_cast<std::ptrdiff_t>(tracks.confidence.size())) {
    return NoValidSamples(array->values.size(), file.name);
  }
  if (order->joint.size() == (*skeleton)->joints.size()) {
    // A joints-only motion needs every joint in every frame: missing points are interpolated and marked.
    Expected<Motion> motion = MotionFromTracks(tracks, *skeleton, ingested.clip.rate, source.max_gap_s);
    if (motion) {
      if (damaged.frames.empty()) motion->state = StatesOfFile(read->state, *order, wide, frames);
      ingested.clip.motion = *std::move(motion);
      for (Finding& finding : ingested.findings) finding.action = FindingAction::kInterpolated;
      return ingested;
    }
  }
  for (Finding& finding : ingested.findings) finding.action = FindingAction::kMissing;
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.evidence.tracks = std::move(tracks);  // a joint that is never observed
  return ingested;
}

void RemarkDamaged(const DamagedNumbers& damaged, RawClip& clip) {
  for (const Finding& finding : damaged.findings)  // its frames reach from the first to the last such number
    clip.remarks.push_back(MakeFinding(finding.code, finding.severity, finding.value, finding.message));
}

bool IsCoordinate(double value) { return std::isfinite(value) && std::abs(value) <= kLargestNumber; }

/// The positions of one clip, (frames, joints, 3) from `values` on; invalid coordinates are missing.
RawClip PlacesIn(const double* values, std::size_t frames, std::size_t joints, const std::string& name) {
  RawClip clip;
  clip.format = "npy";
  clip.frames = static_cast<int>(frames);
  clip.joints = static_cast<int>(joints);
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(frames * joints, 1.0);
  for (std::size_t i = 0; i < clip.positions.xyz.size(); ++i) {
    clip.positions.xyz[i] = IsCoordinate(values[i]) ? values[i] : 0.0;
    if (!IsCoordinate(values[i])) clip.confidence[i / 3] = 0.0;
  }
  RemarkDamaged(DamagedNumbersOf(values, clip.frames, clip.joints, name), clip);
  return clip;
}

/// Names the points, or says why they have no names.
void RecognisePoints(RawClip& clip) {
  if (std::none_of(clip.confidence.begin(), clip.confidence.end(), [](double seen) { return seen > 0.0; })) {
    clip.remarks.push_back(
        MakeFinding("no_joint_seen", Severity::kError, static_cast<double>(clip.frames),
                    "no joint is seen in " + std::to_string(clip.frames) + " of " + Counted(clip.frames, "frame")));
  } else if (!RecogniseOrder(clip)) {
    CheckPositions(clip);
  }
}

Expected<RawFile> MdmIn(const FileBytes& file) {
  const Expected<MdmResults> results = MdmResults::Open(file.bytes, file.name);
  if (!results) return Forward(results);
  RawFile observed;
  for (std::size_t i = 0; i < results->size(); ++i) {
    const Expected<NpyArray> motion = results->Motion(i);
    if (!motion) return Forward(motion);
    RawClip clip = PlacesIn(motion->values.data(), motion->shape[0], motion->shape[1], file.name);
    clip.id = "[" + std::to_string(i) + "]";
    clip.layout_evidence = "`motion` of MDM's results, cut to its `lengths`";
    if (!results->Label(i).empty()) clip.facts.emplace_back("label", results->Label(i));
    RecognisePoints(clip);
    observed.clips.push_back(std::move(clip));
  }
  return observed;
}

Expected<RawFile> NpyIn(const FileBytes& file) {
  const Expected<NpyArray> header = ParseNpyHeader(file.bytes, file.name);
  if (header && IsArrayOfObjects(*header)) return MdmIn(file);
  const Expected<NpyArray> array = ParseNpy(file.bytes, file.name);
  if (!array) return Forward(array);
  return RawFile::Of(ReadRawArray(*array, file.name));
}

/// MDM's results say what each motion is.
void ProposeArrays(const Proposal& proposal, DeclarationWriter& writer) {
  WriteFiles(proposal, writer);
  const std::vector<std::string> labels = proposal.source.Facts("label");
  if (std::all_of(labels.begin(), labels.end(), [](const std::string& label) { return label.empty(); }))
    return WritePersonAndLabel(false, writer);
  writer.Name("person", kUnknownPerson, "a fixed name, by which all clips are one person's");
  writer.Value("label", YamlQuoted(""), "declared by the file: each clip's own");
}

}  // namespace

Expected<std::vector<RawClip>> ReadRawArray(const NpyArray& array, const std::string& name) {
  const std::string shape = ArrayShapeText(array);
  if (const std::string rotations = RotationsInstead(array, name); !rotations.empty())
    return Fail(ErrorCode::kUnsupported, "the array holds " + rotations, name);
  if (const auto axes = ExchangedAxes(array, 0)) {
    return Fail(ErrorCode::kInconsistent, "the array has shape " + shape + ": " + axes->words, name, axes->way_out);
  }
  const std::optional<ArrayShape> held = ShapeOfJoints(array.shape);
  if (!held || array.values.empty()) {
    const std::string other = OtherThanJoints(array.shape);
    if (!other.empty()) return Fail(ErrorCode::kUnsupported, "an array of shape " + shape + " holds " + other, name);
    return Fail(ErrorCode::kUnsupported, "an array of shape " + shape + " is not a sequence of joint positions", name,
                "expected: (frames, joints, 3), (frames, joints * 3), or a batch of them");
  }
  if (std::none_of(array.values.begin(), array.values.end(), IsCoordinate))
    return NoValidSamples(array.values.size(), name);
  std::vector<RawClip> observed;
  const std::size_t numbers = held->frames * held->joints * 3;
  for (std::size_t c = 0; c < held->clips; ++c) {
    const double* values = array.values.data() + c * numbers;
    NpyArray turned;
    if (held->frames_last) {
      turned.shape = {held->joints, 3, held->frames};
      turned.values.assign(values, values + numbers);
      turned = FramesFirst(turned, held->frames);
      values = turned.values.data();
    }
    RawClip clip = PlacesIn(values, held->frames, held->joints, name);
    clip.id = held->batch ? "[" + std::to_string(c) + "]" : "";
    clip.layout_evidence = "shape " + shape + " of " + array.dtype;
    RecognisePoints(clip);
    observed.push_back(std::move(clip));
  }
  return observed;
}

Expected<RawClip> ReadRawExported(const ExportedMotion& exported, const std::string& name) {
  const NpyArray& array = *exported.joints;
  if (std::none_of(array.values.begin(), array.values.end(), IsCoordinate))
    return NoValidSamples(array.values.size(), name);
  RawClip clip = PlacesIn(array.values.data(), array.shape[0], array.shape[1], name);
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

FormatDriver NpyFormat() {
  FormatDriver d;
  d.name = "npy";
  d.kinds = {FileKind::kNpy};
  d.gives = EvidenceKind::kMotion;
  d.needs_skeleton = true;
  d.lists_joints = true;
  d.holds_clips = true;
  d.options = {"lie_bone_lengths"};
  d.open = NpyIn;
  d.propose = ProposeArrays;
  d.to_clip = ReadArraySource;
  return d;
}

}  // namespace mocurate
