#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/npy.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// How an array holds joint positions.
struct ArrayShape {
  bool batch = false;        ///< several clips of one length
  bool frames_last = false;  ///< coordinates before frames
  std::size_t clips = 1;
  std::size_t classes = 0;  ///< of a batch of batches: length of the second axis, which is the class; else 0
  std::size_t frames = 0;
  std::size_t joints = 0;
};

/// (frames, joints, 3), (frames, joints * 3), or a batch of them, of at least three joints; also batches with the
/// frames last: (clips, joints, 3, frames) as MDM and ACTOR have them in memory, and (samples, classes, joints, 3,
/// frames), ACTOR's generation.npy. Nothing for others.
std::optional<ArrayShape> ShapeOfJoints(const std::vector<std::size_t>& shape);

/// "", or what an array of this shape is known to hold instead of positions, and the way to them: HumanML3D's features.
std::string OtherThanJoints(const std::vector<std::size_t>& shape);

/// One clip of a file of arrays.
struct ArrayClip {
  std::string id;  ///< "[3]" of a batch, "[member]" of an .npz, "[member][3]"; empty: the file is the clip,
                   ///< an .npz of `mocurate export` too
  std::size_t joints = 0;
  std::string label;  ///< where the file says one: a name, or the index of a class
};

/// The clips of an .npy, of which only the head is read, or .npz. Empty where the file is none of joints, is too short
/// for the shape that its head announces, or cannot be read: its reader says why. Also those of MDM's results.npy.
std::vector<ArrayClip> ArrayClipsOf(const std::filesystem::path& file, const std::string& name);

/// What the clip's name gets in addition: "[walk][3]" gives ".walk.0003", "[a/b]" gives ".a.b".
std::string RecordingSuffix(const std::string& id);

/// What a file says of one clip.
struct ArrayOfClip {
  NpyArray array;
  std::vector<std::string> names;  ///< of the joints, where the file is one of `mocurate export`
  std::optional<double> rate_hz;   ///< likewise
};

/// Errors of the formats; kInconsistent where there is no such clip.
Expected<ArrayOfClip> ReadArrayClip(std::string_view bytes, const std::string& id, const std::string& name);

}  // namespace mocurate
