#pragma once

#include <string>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// Networks that compute features.
enum class ExtractorNetwork {
  kGru,    ///< Action2Motion's recogniser, and MultiAct's (a2m_actor.md D.1, multiact.md E)
  kStGcn,  ///< ACTOR's for UESTC
};
/// Network input of a frame.
enum class ExtractorValues { kJoints, kRotation6DRows };
/// Origin of the joint positions (a2m_actor.md D.8).
enum class RootRule {
  kAsGiven,
  kFirstFrame,  ///< the root of the first frame that is read
  kEveryFrame,  ///< the root of each frame: no trajectory
};
/// How a motion of another length is converted to `frames`.
enum class LengthRule {
  kCrop,      ///< a window; shorter motions are padded
  kResample,  ///< the whole motion, evenly spaced in time
};
enum class PaddingRule {
  kRepeatLast,
  kZeros,
  kZerosMinusRoot,  ///< zeros from which the root rule subtracts the root as well (MultiAct)
};
/// Output of the recurrent network that is used.
enum class ReadOut {
  kLastFrame,  ///< after the padding
  kLastValid,  ///< of the last frame that is not padding (ACTOR)
};
/// Bone lengths of the joints.
enum class BodyRule {
  kOwn,
  kMeanShape,  ///< SMPL with beta = 0 (ACTOR); without SMPL's files joints are read as given, and the result reports it
};

/// A network and the conversion of motions to its input. Motions are in the canonical world (metres, y up, facing +z);
/// the network's own frame is given by `axes` and `metres_per_unit`.
struct ExtractorOptions {
  std::string name;
  std::string weights;  ///< file below MOCURATE_WEIGHTS, or a path; a checkpoint of mocurate contains the other options
  std::string obtain;
  ExtractorNetwork network = ExtractorNetwork::kGru;
  ExtractorValues values = ExtractorValues::kJoints;
  std::string skeleton;
  std::string axes = "+x +y +z";
  double metres_per_unit = 1.0;
  double rate_hz = 0.0;  ///< of the training motions; 0: unknown
  std::int64_t frames = 60;
  LengthRule length = LengthRule::kCrop;
  PaddingRule padding = PaddingRule::kRepeatLast;
  ReadOut read_out = ReadOut::kLastFrame;
  RootRule real_root = RootRule::kFirstFrame;
  RootRule generated_root = RootRule::kAsGiven;
  BodyRule body = BodyRule::kOwn;
  double yaw_rad = 0.0;              ///< rotation of scored motions, not of the reference, about the vertical
  std::vector<std::string> classes;  ///< in the order of the network's outputs

  void Declare(OptionVisitor& v);
};

}  // namespace mocurate
