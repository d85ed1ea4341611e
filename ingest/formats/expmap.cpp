#include <cmath>

#include "core/formats/expmap_table.h"
#include "core/motion/kinematics.h"
#include "ingest/formats/driver.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

/// Column of each of the skeleton's joints among those of the file.
Expected<std::vector<std::size_t>> ColumnsOf(const SourceOptions& source, const Skeleton& skeleton) {
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> columns(skeleton.joints.size(), kNone);
  for (std::size_t k = 0; k < source.joints.size(); ++k) {
    if (const auto joint = skeleton.FindJoint(source.joints[k])) columns[*joint] = k;
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (columns[j] != kNone) continue;
    return Fail(ErrorCode::kConfig,
                "joint '" + skeleton.joints[j].name + "' of skeleton '" + skeleton.name + "' is not in the source",
                "ingest.source.joints", "every joint of the skeleton needs its rotation");
  }
  return columns;
}

/// Exponential maps -> given motion. `joints` names the file's joints in its order. Its rotations are for row vectors
/// (a position is multiplied from the left), so that parent_from_joint is the rotation by the negative vector.
Expected<IngestedClip> ReadExpmapClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<Quaterniond> world_from_file = RotationOfAxes(source.axes);
  if (!world_from_file) return Forward(world_from_file);
  const Expected<double> metres = MetresPerUnit(source.units);
  if (!metres) return Forward(metres);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton) return Forward(skeleton);
  const Expected<std::vector<std::size_t>> columns = ColumnsOf(source, **skeleton);
  if (!columns) return Forward(columns);
  Expected<ExpmapTable> table =
      ParseExpmapTable(file.bytes, file.name, 3 + 3 * static_cast<int>(source.joints.size()), source.damaged_rows);
  if (!table) return Forward(table);
  if (table->frames == 0) return Fail(ErrorCode::kInconsistent, "the file has no frame", file.name);
  if (!table->findings.empty()) {
    return Fail(ErrorCode::kMalformed, table->findings.front().message, file.name,
                "a given motion must have every frame: cut the file there");
  }
  const std::size_t joints = columns->size();
  std::vector<Vector3d> root_translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(table->frames) * joints);
  for (std::size_t f = 0; f < static_cast<std::size_t>(table->frames); ++f) {
    const double* place = &table->root[f * 3];
    root_translation.push_back(*world_from_file * (*metres * Vector3d(place[0], place[1], place[2])));
    for (std::size_t j = 0; j < joints; ++j) {
      const double* vector = &table->rotation_rad[(f * source.joints.size() + (*columns)[j]) * 3];
      const Quaterniond local = ExpQuaternion(-Vector3d(vector[0], vector[1], vector[2]));
      rotation[f * joints + j] = (*world_from_file * local * world_from_file->conjugate()).normalized();
    }
  }
  for (std::size_t j = 0; j < joints; ++j) {
    MakeSignContinuous(rotation.data() + j, static_cast<std::size_t>(table->frames), joints);
  }
  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  ingested.clip.motion =
      MakeMotion(*skeleton, ingested.clip.rate, std::move(root_translation), std::move(rotation), {});
  return ingested;
}

}  // namespace

FormatDriver ExpmapFormat() {
  FormatDriver d;
  d.name = "expmap";
  d.inspected = "expmap_table";
  d.kind = FileKind::kNumbers;
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.needs_skeleton = true;
  d.lengths_assumed = true;
  d.to_clip = ReadExpmapClip;
  return d;
}

}  // namespace mocurate
