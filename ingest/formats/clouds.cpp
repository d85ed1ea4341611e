#include <algorithm>

#include "core/base/median.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/formats/point_cloud.h"
#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/frame_files.h"

namespace mocurate {
namespace {

constexpr double kNearest_m = 0.1, kFarthest_m = 10.0;  // median distance of a cloud's points from its centre

/// Error kInconsistent where the clouds are too small for a person, or too large for a room.
Status CheckSize(const std::vector<double>& sizes_m, const SourceFile& file) {
  const double size_m = MeanMedian(sizes_m);
  if (size_m >= kNearest_m && size_m <= kFarthest_m) return {};
  return Fail(ErrorCode::kInconsistent,
              "half of the points of a cloud are " + RoundedText(size_m, 3) +
                  " m or more from its centre; expected of people and rooms are " + RoundedText(kNearest_m) + " to " +
                  RoundedText(kFarthest_m) + " m",
              file.name, "check ingest.source.units ('" + file.source.units + "')");
}

/// PLY or PCD files, one a frame -> point clouds by reference.
Expected<IngestedClip> ReadCloudsClip(const SourceFile& file) {
  const Expected<SourceFrame> axes = FrameOf(file.source);
  if (!axes) return Forward(axes);
  const double metres = *MetresPerUnit(file.source.units);
  auto cameras = SortByCamera(file.source.files, "ingest.source.files", file.depth_files);
  if (!cameras) return Forward(cameras);
  const Expected<FrameSpan> span = MatchViews(file, *cameras);
  if (!span) return Forward(span);
  const FilesOfCamera& files = cameras->begin()->second;
  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*file.source.rate_hz);
  const double side = axes->world_from_file.determinant() < 0.0 ? -1.0 : 1.0;
  CloudFiles clouds;
  clouds.metres_per_unit = side * metres;
  clouds.world_from_file.rotation = Quaterniond(Matrix3d(side * axes->world_from_file));
  clouds.files.resize(static_cast<std::size_t>(span->frames));
  clouds.sha256.resize(clouds.files.size());
  for (int f = 0; f < span->frames; ++f) clouds.time_s.push_back(ingested.clip.rate.FrameTime(f));
  std::vector<double> sizes_m;
  const auto take = [&](int f, const std::string& bytes, const std::string& name) -> Status {
    const Expected<PointCloud> cloud = ParsePointCloud(bytes, name);
    if (!cloud) return Forward(cloud);
    if (cloud->points.empty()) return Fail(ErrorCode::kMalformed, "the cloud has no points", name, "export it again");
    sizes_m.push_back(metres * MeanMedian(DistancesFromMiddle(cloud->points)));
    clouds.files[static_cast<std::size_t>(f)] = name;
    clouds.sha256[static_cast<std::size_t>(f)] = Sha256Hex(bytes);
    return {};
  };
  ReadFrameFiles("", files, *span, take, ingested);
  if (sizes_m.empty()) {
    return Fail(ErrorCode::kMalformed, "no file of the clip has a point; " + ingested.findings.back().message,
                file.name, "export the clouds again");
  }
  if (Status size = CheckSize(sizes_m, file); !size) return Forward(size);
  ingested.clip.evidence.clouds = std::move(clouds);
  return ingested;
}

Expected<RawFile> CloudIn(const FileBytes& file) {
  Expected<PointCloud> cloud = ParsePointCloud(file.bytes, file.name);
  if (!cloud) return Forward(cloud);
  RawFile observed;
  observed.clouds.push_back(
      {KindOf(file.bytes) == FileKind::kPly ? "ply" : "pcd", std::move(cloud->points), cloud->triangles});
  return observed;
}

}  // namespace

FormatDriver CloudsFormat() {
  FormatDriver d;
  d.name = "clouds";
  d.kind = FileKind::kPly;
  d.gives = EvidenceKind::kPointClouds;
  d.grouped_by = {"frame"};
  d.check = CheckGrouped;
  d.sniff = [](const FileBytes&, FileKind kind) { return kind == FileKind::kPly || kind == FileKind::kPcd; };
  d.read_raw = CloudIn;
  d.to_clip = ReadCloudsClip;
  return d;
}

}  // namespace mocurate
