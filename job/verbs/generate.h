#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/motion/request.h"
#include "core/store/store.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {

/// An action of a script as written; 0 frames: the network's usual number.
struct ScriptActionOptions {
  std::string action;
  std::int64_t frames = 0;
  std::int64_t transition_frames = 0;  ///< of the transition before it
  void Declare(OptionVisitor& v);
};

/// A script of actions, a YAML file: `actions: [{action: throw, frames: 20, transition_frames: 14}, ...]`.
struct ScriptOptions {
  std::string name, description;
  std::vector<ScriptActionOptions> actions;
  void Declare(OptionVisitor& v);
};

/// "throw,catch:30,throw" (an action and its frames), a name of configs/scripts, or a YAML file. Errors: kUsage for
/// other texts, and those of the file.
Expected<ScriptOptions> ReadScript(const std::string& text);

/// The class of that name or index. Error kUsage with the names there are.
Expected<int> RequestedClass(const std::string& text, const std::vector<std::string>& labels, const std::string& where);

/// The steps of a script for a network: classes by name or index; without durations in the script, usual ones of the
/// network's training set. `continues`: a transition precedes the first action too. Error kUsage names the step, the
/// value and the valid ones.
Expected<std::vector<ScriptStep>> StepsOf(const ScriptOptions& script, const Checkpoint& network, bool continues);

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
