#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/axes.h"
#include "core/geometry/camera.h"
#include "core/motion/motion.h"

namespace mocurate {

/// Labelled span of a clip in seconds from its first frame, [begin, end). Segments may overlap.
struct Segment {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string label;
  std::string category;  ///< coarser class, or empty
  std::string origin;    ///< "annotated", "measured", "file_name"
};

/// Who and what a clip is. `id` is stable text: source/person/recording#begin-end (frames of the recording).
struct ClipIdentity {
  std::string source;
  std::string person;
  std::string recording;
  std::string session;
  std::string view;
  std::string licence;
  int begin_frame = 0;
  int end_frame = 0;

  std::string id() const;
};

/// Joint positions as a tracker gave them: already in metres and in the canonical world, otherwise untouched.
/// K tracked points, F frames. A missing observation has confidence 0 and its value is never read.
struct JointTracks {
  std::vector<std::string> names;  ///< (K) names of the source
  std::vector<double> time_s;      ///< (F) increasing
  JointPositions positions;        ///< (F,K,3)
  std::vector<double> confidence;  ///< (F*K) in [0, 1]
};

/// Depth images by reference. Values are depth along the camera's z axis.
struct DepthView {
  Camera camera;
  std::vector<std::filesystem::path> files;  ///< (F) 16-bit PNG
  std::vector<std::string> sha256;           ///< (F)
  std::vector<double> time_s;                ///< (F)
  double metres_per_unit = 0.001;
};

/// What sensors or other programs said. Never overwritten by what is fitted to it.
struct Evidence {
  std::optional<JointTracks> tracks;
  std::vector<DepthView> depth_views;

  bool empty() const { return !tracks && depth_views.empty(); }
};

/// Depth images are referred to by their names in the source's folder; `files` says where each lies now.
void ResolveDepthFiles(const std::map<std::string, std::filesystem::path>& files, Evidence& evidence);

struct Clip {
  ClipIdentity identity;
  std::string label;  ///< of the whole clip, or empty
  std::vector<Segment> segments;
  FrameRate rate;
  Evidence evidence;
  std::optional<Motion> motion;
  /// World of the source from the canonical world of this clip: what uncanonicalising needs.
  RigidTransform canonical_from_source;
  double fit_rms = 0.0;  ///< root mean square residual of the fit, metres; 0 if not fitted
  std::string role;      ///< "train", "test" or empty, as the source declares it
  std::string evidence_sha256;
  std::map<std::string, std::string> provenance;  ///< sorted by key

  std::string id() const { return identity.id(); }
};

}  // namespace mocurate
