#include "fitting/clouds/cloud_files.h"

#include <utility>

#include "core/base/file.h"
#include "core/formats/point_cloud.h"
#include "fitting/clouds/depth_normals.h"
#include "fitting/clouds/person_points.h"

namespace mocurate {
namespace {

constexpr double kVoxelsBetween = 2.5;  ///< voxels between neighbours of a thinned cloud, at most

}  // namespace

Expected<FusedCloud> ReadPersonCloud(const CloudFiles& clouds, int frame, double voxel_size) {
  const std::filesystem::path& file = clouds.files[frame];
  if (file.empty()) return FusedCloud{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), 0};
  const Expected<std::string> bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  if (Status same = CheckUnchanged(file, clouds.sha256[frame]); !same) return Forward(same);
  Expected<PointCloud> cloud = ParsePointCloud(*bytes, file.string());
  if (!cloud) return Forward(cloud);
  const double side = clouds.metres_per_unit < 0.0 ? -1.0 : 1.0;
  for (Vector3d& point : cloud->points) point = clouds.world_from_file * Vector3d(clouds.metres_per_unit * point);
  for (Vector3d& normal : cloud->normals) normal = side * (clouds.world_from_file.rotation * normal);
  const bool has_normals = !cloud->normals.empty();
  const Expected<FusedCloud> fused = FusePoints(std::move(cloud->points), std::move(cloud->normals), voxel_size);
  if (!fused) return Forward(fused);
  FusedCloud person = PersonPoints(*fused, voxel_size);
  if (!has_normals) FaceOutwards(kVoxelsBetween * voxel_size, person);
  return person;
}

}  // namespace mocurate
