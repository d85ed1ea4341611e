#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/expmap_table.h"
#include "core/motion/kinematics.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/damaged_frames.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

constexpr double kTurn = 6.2832;          // radians; no rotation vector of these sets is longer
constexpr double kStill = 1e-5;           // radians; rounding of the exporter
constexpr double kFewestConstant = 0.15;  // share of columns; bones without a degree of freedom stay at 0

constexpr double kFewestVectors = 0.5;  // share of rows, of what is named a table of rotations

/// 99 or 117 where most rows of the file have as many numbers; 0: another file.
int ColumnsOfExpmap(std::string_view bytes) {
  std::size_t rows = 0, as_99 = 0, as_117 = 0;
  for (const std::string_view line : SplitText(bytes, '\n')) {
    if (Trim(line).empty()) continue;
    const auto commas = std::count(line.begin(), line.end(), ',');
    ++rows;
    as_99 += commas == 98 ? 1 : 0;
    as_117 += commas == 116 ? 1 : 0;
  }
  return 2 * as_99 > rows ? 99 : 2 * as_117 > rows ? 117 : 0;
}

/// Of a row: whether its numbers are finite, and no vector longer than a turn.
struct RowContent {
  bool finite = true, short_vectors = true;
};

RowContent ContentOf(const ExpmapTable& table, std::size_t f) {
  RowContent row;
  row.finite = Eigen::Map<const Vector3d>(&table.root[f * 3]).allFinite();
  const std::size_t columns = static_cast<std::size_t>(table.joints) * 3;
  for (std::size_t c = 0; c < columns; c += 3) {
    const double length = Eigen::Map<const Vector3d>(&table.rotation_rad[f * columns + c]).norm();
    row.finite = row.finite && std::isfinite(length);
    row.short_vectors = row.short_vectors && length <= kTurn;
  }
  return row;
}

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
  const std::size_t joints = columns->size();
  std::vector<Vector3d> root_translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(table->frames) * joints);
  std::vector<int> damaged;
  for (std::size_t f = 0; f < static_cast<std::size_t>(table->frames); ++f) {
    double *place = &table->root[f * 3], *vectors = &table->rotation_rad[f * source.joints.size() * 3];
    if (!ContentOf(*table, f).finite) {
      damaged.push_back(static_cast<int>(f));
      std::fill_n(place, 3, 0.0);
      std::fill_n(vectors, source.joints.size() * 3, 0.0);
    }
    root_translation.push_back(*world_from_file * (*metres * Vector3d(place[0], place[1], place[2])));
    for (std::size_t j = 0; j < joints; ++j) {
      const double* vector = vectors + 3 * (*columns)[j];
      const Quaterniond local = ExpQuaternion(-Vector3d(vector[0], vector[1], vector[2]));
      rotation[f * joints + j] = (*world_from_file * local * world_from_file->conjugate()).normalized();
    }
  }
  IngestedClip ingested;
  ingested.findings = std::move(table->findings);
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  if (Status added =
          AddMotion(damaged, *skeleton, {}, std::move(root_translation), std::move(rotation), file.name, ingested);
      !added) {
    return Forward(added);
  }
  return ingested;
}

}  // namespace

std::optional<RawClip> ReadRawExpmap(std::string_view bytes, const std::string& name) {
  const int wide = ColumnsOfExpmap(bytes);
  if (wide == 0) return std::nullopt;
  auto table = ParseExpmapTable(bytes, name, wide, DamagedRows::kReport);
  if (!table || table->frames < 2) return std::nullopt;
  const auto columns = static_cast<std::size_t>(table->joints) * 3;
  std::vector<int> whole;  // rows of vectors
  int damaged = 0;
  for (int f = 0; f < table->frames; ++f) {
    const RowContent row = ContentOf(*table, static_cast<std::size_t>(f));
    if (row.finite && row.short_vectors) whole.push_back(f);
    damaged += row.finite ? 0 : 1;
  }
  if (whole.empty() || static_cast<double>(whole.size()) < kFewestVectors * table->frames) return std::nullopt;
  const auto at = [&](int f, std::size_t c) { return table->rotation_rad[static_cast<std::size_t>(f) * columns + c]; };
  std::size_t constant = 0;
  for (std::size_t c = 0; c < columns; ++c) {
    constant +=
        std::all_of(whole.begin(), whole.end(), [&](int f) { return std::abs(at(f, c) - at(whole[0], c)) <= kStill; })
            ? 1
            : 0;
  }
  if (static_cast<double>(constant) < kFewestConstant * static_cast<double>(columns)) return std::nullopt;
  RawClip clip;
  clip.format = "expmap_table";
  clip.frames = table->frames;
  clip.joints = table->joints;
  clip.layout_evidence = std::to_string(3 + columns) + " columns: place of the root and " +
                         std::to_string(table->joints) + " rotation vectors, " + std::to_string(constant) +
                         " numbers of them constant";
  clip.skeleton.evidence = "rotations; the tree is not in the file";
  clip.silence = "rotations of a skeleton that is not in the file";
  clip.rate_evidence = "the file does not declare it";
  clip.AddRemarks(table->findings);
  clip.CutDamagedEnds();
  clip.missing_share = static_cast<double>(damaged - (table->frames - clip.frames)) / clip.frames;
  return clip;
}

FormatDriver ExpmapFormat() {
  FormatDriver d;
  d.name = "expmap";
  d.inspected = "expmap_table";
  d.kinds = {FileKind::kNumbers};
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.needs_skeleton = true;
  d.lengths_assumed = true;
  d.to_clip = ReadExpmapClip;
  return d;
}

}  // namespace mocurate
