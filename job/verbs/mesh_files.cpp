#include "job/verbs/generate.h"

#include <algorithm>

#include "canon/exports/clip_names.h"
#include "core/base/file.h"
#include "core/base/links.h"
#include "core/formats/npz.h"
#include "core/skin/skin.h"
#include "train/items.h"

namespace mocurate {
namespace {

/// Height of the root above the lowest point of a body at rest, metres.
double HeightOfRoot(const Skin& skin) {
  double lowest = skin.joints[0].y();
  for (const Vector3d& vertex : skin.vertices) lowest = std::min(lowest, vertex.y());
  return skin.joints[0].y() - lowest;
}

NpyArray Array(std::vector<std::size_t> shape, const char* dtype, std::vector<double> values) {
  return {std::move(shape), dtype, std::move(values), {}};
}

Npz MeshOf(const Motion& motion, const Skin& body, const std::vector<double>& shape, double lift) {
  std::vector<double> vertices, faces;
  vertices.reserve(static_cast<std::size_t>(motion.frame_count()) * 3 * body.vertices.size());
  for (int f = 0; f < motion.frame_count(); ++f) {
    const Vector3d root = motion.root_translation[static_cast<std::size_t>(f)] + Vector3d(0.0, lift, 0.0);
    for (const Vector3d& vertex : PosedVertices(body, *motion.skeleton, &motion.rotation_at(f, 0), root)) {
      vertices.insert(vertices.end(), vertex.data(), vertex.data() + 3);
    }
  }
  for (const std::array<int, 3>& face : body.faces) faces.insert(faces.end(), face.begin(), face.end());
  Npz npz;
  const auto frames = static_cast<std::size_t>(motion.frame_count());
  npz.members.push_back({"vertices", Array({frames, body.vertices.size(), 3}, "<f4", std::move(vertices)), ""});
  npz.members.push_back({"faces", Array({body.faces.size(), 3}, "<i4", std::move(faces)), ""});
  npz.members.push_back({"shape", Array({shape.size()}, "<f4", shape), ""});
  npz.members.push_back({"frame_rate", Array({}, "<f8", {motion.rate.hz()}), ""});
  return npz;
}

}  // namespace

Status CheckMeshBody(const MeshBodies& bodies, const Skeleton& skeleton) {
  if (bodies.body.empty()) {
    return Fail(ErrorCode::kUsage, "no body is given, and none is below MOCURATE_WEIGHTS", "--mesh",
                "give --body SMPL_NEUTRAL.pkl or body_cc0.h5");
  }
  const auto skin = ReadSkin(bodies.body, skeleton);
  return skin ? Status() : Status(Forward(skin));
}

Expected<int> WriteMeshes(const Dataset& motions, const MeshBodies& bodies, const std::filesystem::path& folder) {
  const auto mean = ReadSkin(bodies.body, *motions.skeleton);
  if (!mean) return Forward(mean);
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  int written = 0;
  for (int k = 0; k < bodies.shapes; ++k) {
    const std::vector<double> shape =
        k == 0 ? std::vector<double>(mean->shapes.size(), 0.0) : DrawShape(*mean, bodies.seed, k);
    const Skin body = Shaped(*mean, shape);
    const double lift = HeightOfRoot(body) - HeightOfRoot(*mean);
    for (const Clip& clip : motions.clips) {
      const std::string name = NameForFile(FileNameOf(clip.id())) + "_shape" + std::to_string(k) + ".npz";
      if (!clip.motion || clip.motion->joints_only()) {
        return Fail(ErrorCode::kUsage, "the motion has no rotations, which meshes need", clip.id(),
                    "use a network of rotations: kind actor");
      }
      const auto file = FileBelow(folder, name);
      if (!file) return Forward(file);
      const auto bytes = EncodeNpz(MeshOf(*clip.motion, body, shape, lift), file->string());
      if (!bytes) return Forward(bytes);
      if (Status done = WriteFile(*file, *bytes); !done) return Forward(done);
      ++written;
    }
  }
  return written;
}

}  // namespace mocurate
