#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/file.h"
#include "core/base/median.h"
#include "core/base/text.h"
#include "core/formats/humanact12_pickle.h"
#include "core/motion/kinematics.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/mapped_file.h"
#include "ingest/sources/smpl_motion.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

using OpenPickle = MappedArchive<HumanAct12Archive>;

Expected<std::shared_ptr<const OpenPickle>> PickleOf(const std::filesystem::path& path) {
  static KeptOpen<OpenPickle> last;
  return last.Get(path, OpenPickle::Open);
}

/// The pickle names no clip: "c0007_y04" are the place in the file and the class, from 1.
Expected<std::vector<ContainerEntry>> HumanAct12Entries(const SourceOptions& source,
                                                        const std::filesystem::path& folder) {
  const auto pickle = PickleOf(folder / source.container);
  if (!pickle) return Forward(pickle);
  std::vector<ContainerEntry> entries;
  for (std::size_t i = 0; i < (*pickle)->archive.size(); ++i) {
    const Expected<int> label = (*pickle)->archive.Label(i);
    if (!label) return Forward(label);
    char name[48];
    std::snprintf(name, sizeof(name), "c%04zu_y%02d", i + 1, *label + 1);
    entries.push_back({name, "", 0, ""});
  }
  return entries;
}

Expected<HumanAct12Clip> ReadEntry(const SourceFile& file) {
  const auto pickle = PickleOf(file.container);
  if (!pickle) return Forward(pickle);
  const HumanAct12Archive& archive = (*pickle)->archive;
  if (Status there = CheckEntry(file.facts.entry, archive.size(), file.name); !there) return Forward(there);
  return archive.Clip(static_cast<std::size_t>(file.facts.entry));
}

constexpr double kFits = 1e-3;  // metres; largest distance of recorded positions from those of the rotations

/// Median distance of each joint from its parent.
std::vector<double> FileBoneLengths(const JointPositions& joints, const Skeleton& skeleton) {
  std::vector<double> lengths(skeleton.joints.size(), 0.0);
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    std::vector<double> frames;
    for (int f = 0; f < joints.frames; ++f) {
      frames.push_back((joints.at(f, j) - joints.at(f, skeleton.joints[j].parent)).norm());
    }
    lengths[j] = Median(std::move(frames));
  }
  return lengths;
}

/// Where SMPL's bones point elsewhere at rest than the skeleton's, the file's positions come out displaced.
void NoteDisplaced(const JointPositions& recorded, const Motion& motion, std::vector<Finding>& findings) {
  std::vector<double> distances;
  for (int f = 0; f < recorded.frames; ++f) {
    for (int j = 0; j < recorded.joints; ++j) {
      distances.push_back((recorded.at(f, j) - motion.joints.at(f, j)).norm());
    }
  }
  const double median = Median(std::move(distances));
  if (median <= kFits) return;
  findings.push_back(
      MakeFinding("joints_displaced", Severity::kInfo, median,
                  "joints lie " + RoundedText(median, 3) +
                      " m (median) off the recorded positions: the skeleton's bones point elsewhere at rest than "
                      "the subject's body; rotations kept; to keep the positions, read joints alone (format npy)",
                  FindingAction::kKept));
}

/// One clip of humanact12poses.pkl. On a skeleton with SMPL's joints: its rotations, with bone lengths of the recorded
/// positions; on another: the positions alone.
Expected<IngestedClip> ReadHumanAct12Clip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<Quaterniond> world_from_file = RotationOfAxes(source.axes);
  if (!world_from_file) return Forward(world_from_file);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton) return Forward(skeleton);
  const Expected<std::vector<int>> columns = SmplColumns(**skeleton, kSmplJoints);
  if (!columns) return Forward(columns);
  const Expected<HumanAct12Clip> clip = ReadEntry(file);
  if (!clip) return Forward(clip);

  JointPositions joints(static_cast<int>(clip->frames), (*skeleton)->joint_count());
  std::vector<Vector3d> root_translation;
  for (int f = 0; f < joints.frames; ++f) {
    for (int j = 0; j < joints.joints; ++j) {
      const double* place = &clip->joints[static_cast<std::size_t>(f) * 3 * kSmplJoints + (*columns)[j]];
      joints.at(f, j) = *world_from_file * Vector3d(place[0], place[1], place[2]);
    }
    root_translation.push_back(joints.at(f, 0));
  }
  const SmplRotations rotations{clip->poses, clip->frames};
  Expected<std::vector<Quaterniond>> rotation = SmplLocalRotations(**skeleton, rotations, *world_from_file);
  if (!rotation) return Forward(rotation);
  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  ingested.clip.motion = MakeMotion(*skeleton, ingested.clip.rate, std::move(root_translation), *std::move(rotation),
                                    FileBoneLengths(joints, **skeleton));
  std::optional<Finding> invalid_poses = CheckAngleUnits(*clip);
  if (invalid_poses)
    ingested.findings.push_back(*std::move(invalid_poses));
  else
    NoteDisplaced(joints, *ingested.clip.motion, ingested.findings);
  // The file's joints beside the rotations that the clip keeps; an inspection reads them.
  CheckPoints(source, ReadRawHumanAct12Clip(*clip), ingested);
  ingested.content = BytesOf(clip->poses) + BytesOf(clip->joints);
  return ingested;
}

void ProposeHumanAct12(const Proposal& proposal, DeclarationWriter& writer) {
  WriteContainer(proposal, "c{clip:4}_y{action:2}", writer);
  writer.Name("person", kUnknownPerson, "the file does not declare it: by a fixed name all clips are one person's");
  writer.Value("label", YamlQuoted("{action}"), "declared by the format");
}

}  // namespace

FormatDriver HumanAct12PickleFormat() {
  FormatDriver d;
  d.name = "humanact12_pickle";
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.unit = UnitOf::kMetres;
  d.needs_skeleton = true;
  d.tree = "smpl24";
  d.needs_container = true;
  d.options = {"container"};
  d.sniff = [](const FileBytes&, FileKind kind) { return kind == FileKind::kPickle; };  // of VIBE, too
  d.open = ReadRawPickle;
  d.propose = ProposeHumanAct12;
  d.to_clip = ReadHumanAct12Clip;
  d.entries = HumanAct12Entries;
  return d;
}

}  // namespace mocurate
