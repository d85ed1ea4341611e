#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/joint_table.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// Where the numbers of a joint stand within its columns; -1: not there.
struct ColumnPlaces {
  int axis[3] = {-1, -1, -1};
  int confidence = -1;
};

ColumnPlaces PlacesOf(const std::vector<std::string>& columns) {
  ColumnPlaces places;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int index = static_cast<int>(c);
    if (columns[c] == "x") places.axis[0] = index;
    if (columns[c] == "y") places.axis[1] = index;
    if (columns[c] == "z") places.axis[2] = index;
    if (columns[c] == "confidence") places.confidence = index;
  }
  return places;
}

bool IsMissing(const Vector3d& raw, MissingValue missing) {
  if (!raw.allFinite()) return true;
  return missing == MissingValue::kZero && raw.isZero(0.0);
}

}  // namespace

Expected<IngestedClip> ReadJointTableClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<double> scale = MetresPerUnit(source.units);
  if (!scale) return Forward(scale);
  const int joints = static_cast<int>(source.joints.size());
  const int per_joint = static_cast<int>(source.columns.size());
  JointTableLayout layout;
  layout.rows_per_frame = source.rows_per_frame > 0 ? static_cast<int>(source.rows_per_frame) : joints;
  const int joints_per_row = joints / layout.rows_per_frame;
  layout.columns = joints_per_row * per_joint;
  layout.allow_nan = source.missing == MissingValue::kNan;
  const Expected<JointTable> table = ParseJointTable(file.bytes, layout, file.name);
  if (!table) return Forward(table);

  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  JointTracks tracks;
  tracks.names = source.joints;
  tracks.positions = JointPositions(table->frames, joints);
  tracks.confidence.assign(static_cast<std::size_t>(table->frames) * joints, 0.0);
  const ColumnPlaces places = PlacesOf(source.columns);
  const Matrix3d metres_from_source = *scale * axes->canonical_from_source;
  for (int f = 0; f < table->frames; ++f) {
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < joints; ++j) {
      const int row = j / joints_per_row;
      const int first = (j % joints_per_row) * per_joint;
      const Vector3d raw(table->at(f, row, first + places.axis[0]), table->at(f, row, first + places.axis[1]),
                         table->at(f, row, first + places.axis[2]));
      double confidence = places.confidence < 0 ? 1.0 : table->at(f, row, first + places.confidence);
      if (std::isnan(confidence) || IsMissing(raw, source.missing)) confidence = 0.0;
      confidence = std::clamp(confidence, 0.0, 1.0);
      tracks.confidence[static_cast<std::size_t>(f) * joints + j] = confidence;
      if (confidence > 0.0) tracks.positions.at(f, j) = metres_from_source * raw;
    }
  }
  const bool any = std::any_of(tracks.confidence.begin(), tracks.confidence.end(), [](double c) { return c > 0.0; });
  if (!any) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen in any of " + std::to_string(table->frames) + " frames",
                file.name, "the tracker lost the person: leave the file out");
  }
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
