#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rigid.h"

namespace mocurate {

/// One depth camera of a rig. Rig and camera axes: x right, y down, z forward; metres, pixels.
struct DepthSequenceView {
  std::string name;
  RigidTransform camera_from_rig;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  int width = 0, height = 0;  ///< 0: not declared, in the file of one moment
};

/// Labelled frames, both ends included.
struct DepthSequenceLabel {
  std::string action;
  int first = 0;
  int last = 0;
};

/// A JSON description of synchronous depth views: keys fps, frames, views.NAME.{R_p_to_d, t_m, fx_fy_cx_cy, size},
/// labels[].{action, first, last}, and words about body, frame and floor. Without fps and frames it is of one moment,
/// and views need no size.
struct DepthSequence {
  double fps = 0.0;  ///< 0: one moment
  int frames = 0;
  std::string body;
  std::string floor;
  std::vector<DepthSequenceView> views;  ///< sorted by name
  std::vector<DepthSequenceLabel> labels;
};

/// The truth in the same file (frames_data; of one moment at the top), in the rig's frame.
struct DepthSequenceTruth {
  double fps = 0.0;
  int frames = 0;
  int joints = 0;
  std::vector<Vector3d> rotation_vector;  ///< (frames, joints) parent_from_joint; joint 0 rig_from_root
  std::vector<Vector3d> joint;            ///< (frames, joints) metres
  std::vector<Vector3d> translation;      ///< (frames) added after skinning, metres
};

/// Reads everything but the truth. Error kMalformed names the key, kInconsistent values that contradict each other.
Expected<DepthSequence> ParseDepthSequence(std::string_view bytes, const std::string& name);

/// Reads only the truth. Error kNotFound when the file carries none.
Expected<DepthSequenceTruth> ParseDepthSequenceTruth(std::string_view bytes, const std::string& name);

}  // namespace mocurate
