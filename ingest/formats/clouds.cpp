#include <algorithm>
#include <map>
#include <optional>

#include "core/base/median.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/formats/point_cloud.h"
#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/declaration_writer.h"
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

/// Where depth is missing, cameras write 0 0 0. `share`: of the points of a cloud.
Finding WithoutDepth(double share, const std::string& place) {
  return MakeFinding(
      "points_without_depth", Severity::kWarning, share,
      place + ": " + RoundedText(100.0 * share, 3) + " % of the points are 0 0 0, where no depth was measured: dropped",
      FindingAction::kDropped);
}

double ShareWithoutDepth(const PointCloud& cloud) {
  return static_cast<double>(cloud.without_depth) / static_cast<double>(cloud.points.size() + cloud.without_depth);
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
  std::optional<Finding> without_depth;  // the largest share
  const auto take = [&](int f, const std::string& bytes, const std::string& name) -> Status {
    const Expected<PointCloud> cloud = ParsePointCloud(bytes, name);
    if (!cloud) return Forward(cloud);
    if (cloud->points.empty()) {
      const char* what =
          cloud->without_depth > 0 ? "all points are 0 0 0: no depth was measured" : "the cloud has no points";
      return Fail(ErrorCode::kMalformed, what, name, "export it again");
    }
    const double share = ShareWithoutDepth(*cloud);
    if (share > (without_depth ? without_depth->value : 0.0)) without_depth = WithoutDepth(share, name);
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
  if (without_depth) ingested.findings.push_back(*without_depth);
  if (Status size = CheckSize(sizes_m, file); !size) return Forward(size);
  ingested.clip.evidence.clouds = std::move(clouds);
  return ingested;
}

Expected<RawFile> CloudIn(const FileBytes& file) {
  Expected<PointCloud> cloud = ParsePointCloud(file.bytes, file.name);
  if (!cloud) return Forward(cloud);
  RawFile observed;
  if (cloud->without_depth > 0) observed.remarks.push_back(WithoutDepth(ShareWithoutDepth(*cloud), file.name));
  observed.clouds.push_back(
      {KindOf(file.bytes) == FileKind::kPly ? "ply" : "pcd", std::move(cloud->points), cloud->triangles});
  return observed;
}

void ProposeClouds(const Proposal& proposal, DeclarationWriter& writer) {
  std::map<std::string, std::string> first;  // of each folder
  for (const InspectedCloud& cloud : proposal.inspection.clouds) first.emplace(FolderOf(cloud.file), cloud.file);
  std::vector<std::string> names;
  for (const auto& [folder, file] : first) names.push_back(file);
  WriteFrames(names, false, writer);
  WritePersonAndLabel(false, writer);
  const Reported<std::string>& units = proposal.inspection.clouds.front().units;
  if (units.value)
    writer.Value("units", *units.value, "measured: " + units.evidence);
  else
    writer.Unknown("units", units.evidence);
  writer.Unknown("axes", "clouds do not declare up");
  writer.Unknown("rate", "clouds do not declare it");
}

}  // namespace

FormatDriver CloudsFormat() {
  FormatDriver d;
  d.name = "clouds";
  d.kinds = {FileKind::kPly, FileKind::kPcd};
  d.gives = EvidenceKind::kPointClouds;
  d.grouped_by = {"frame"};
  d.check = CheckGrouped;
  d.open = CloudIn;
  d.propose = ProposeClouds;
  d.to_clip = ReadCloudsClip;
  return d;
}

}  // namespace mocurate
