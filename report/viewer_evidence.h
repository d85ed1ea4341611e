#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// The tracks of a recording (its evidence) as they were observed at the frames of a clip of it, in the clip's world:
/// of each frame the sample nearest in time, none where it is more than half a frame away.
JointTracks TracksOfClip(const Clip& clip, const Clip& recorded);

/// What was observed of a clip, in its world.
struct ClipEvidence {
  std::optional<JointTracks> tracks;
  std::vector<Camera> cameras;
  std::vector<std::vector<Vector3d>> clouds;  ///< (F) measured points near the body, at most 300; or none
  std::size_t lost = 0;                       ///< frames whose images or clouds cannot be read
};

/// Evidence of the recordings of a set. Clips of one recording, which stand together, are read once.
class RecordedEvidence {
 public:
  /// Inputs "evidence of NAME" and, for clouds, "depth of NAME".
  RecordedEvidence(const StageRequest& request, const std::string& name, bool clouds);

  /// Nothing where there is no evidence of the clip's recording. Errors of ReadEvidence.
  Expected<ClipEvidence> Of(const Clip& clip);

 private:
  void AddClouds(const Clip& clip, ClipEvidence& seen) const;

  std::map<std::string, std::filesystem::path> files_, depth_;
  bool clouds_;
  std::string recording_;  ///< that was read last
  Clip recorded_;
};

}  // namespace mocurate
