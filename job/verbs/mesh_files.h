#pragma once

#include <cstdint>
#include <filesystem>

#include "core/store/store.h"

namespace mocurate {

/// Bodies of meshes.
struct MeshBodies {
  std::filesystem::path body;  ///< SMPL's file or body_cc0.h5
  int shapes = 1;              ///< 1: the mean body; more: random bodies in addition
  std::uint64_t seed = 1;      ///< of the random bodies
};

/// Reads the skeleton's body once before the work. Errors of ReadSkin; kUsage without a body.
Status CheckMeshBody(const MeshBodies& bodies, const Skeleton& skeleton);

/// Skins motions of rotations (ACTOR 4.3): for each motion and body FOLDER/ID_shapeK.npz with vertices (T,V,3) float32
/// metres in the motion's world, faces (F,3) int32, shape (S) float32, frame_rate. The root of a body with longer legs
/// is accordingly higher. Returns the number of files. Errors kUsage for motions without rotations, kCannotWrite.
Expected<int> WriteMeshes(const Dataset& motions, const MeshBodies& bodies, const std::filesystem::path& folder);

}  // namespace mocurate
