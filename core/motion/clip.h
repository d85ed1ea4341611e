#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
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

/// Identity of a clip. `id` is stable text: source/person/recording#begin-end (frames of the recording).
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
  /// (F*K) or none: world_from_point as the source recorded it. How a point's own frame lies in its limb is the
  /// source's convention and constant in time. Read where rotation_confidence, (F*K) in [0, 1], is not 0.
  std::vector<Quaterniond> rotation;
  std::vector<double> rotation_confidence;
};

/// Depth images by reference. Values are depth along the camera's z axis.
struct DepthView {
  Camera camera;
  std::vector<std::filesystem::path> files;  ///< (F) 16-bit PNG
  std::vector<std::string> sha256;           ///< (F)
  std::vector<double> time_s;                ///< (F)
  double metres_per_unit = 0.001;
  /// (F) or none: images of the same size, 8-bit PNG or JPEG, 128 and more where the person is. Other pixels are
  /// background and need not be consistent: a person who turns before a fixed sensor is observed from all sides, the
  /// room is not.
  std::vector<std::filesystem::path> masks;
  std::vector<std::string> mask_sha256;  ///< (F) or none
};

/// Point clouds by reference, one per frame, of everything observed then. A point of a file times metres_per_unit is in
/// metres (negative: the file's axes are left-handed), and world_from_file places it.
struct CloudFiles {
  std::vector<std::filesystem::path> files;  ///< (F) PLY or PCD; empty: nothing was observed
  std::vector<std::string> sha256;           ///< (F)
  std::vector<double> time_s;                ///< (F) increasing
  double metres_per_unit = 1.0;
  RigidTransform world_from_file;
};

/// People whom a detector found in the images of one calibrated camera. F images, P people (the most that one image
/// lists), K points each. Frame f of all views of a clip is the same moment when their times are the same: a missing
/// image is one without detections. The order of an image's people is the detector's and has no meaning.
struct KeypointView {
  Camera camera;               ///< named; two views of a clip have different names
  std::vector<double> time_s;  ///< (F) increasing
  int people = 0;              ///< P
  std::vector<double> values;  ///< (F,P,K,3) u px, v px, confidence in [0, 1]; 0: not detected, u and v are never read

  int frames() const { return static_cast<int>(time_s.size()); }
  /// K; 0 when there is no image or no detection.
  int points() const;
  /// u px, v px (as detected: with the lens's distortion, and possibly outside the image), confidence.
  const double* at(int frame, int person, int point) const;
};

/// Data of sensors or other programs. Never overwritten by a fit.
struct Evidence {
  std::optional<JointTracks> tracks;
  std::vector<DepthView> depth_views;
  std::optional<CloudFiles> clouds;         ///< of clips without depth views
  std::vector<std::string> keypoint_names;  ///< (K) of the detector's layout: "nose", "left_knee", ...
  std::vector<KeypointView> keypoint_views;
  /// Which of the people in keypoint_views the clip is of, counted from 0 by how present they are: clips of several
  /// people of one recording share the views.
  int subject = 0;

  bool empty() const { return !tracks && depth_views.empty() && !clouds && keypoint_views.empty(); }
};

/// Whether names, shapes, times, cameras and values of the keypoint views hold together. Error kInconsistent naming the
/// camera and the place.
Status CheckKeypoints(const Evidence& evidence);

/// Times of the first view's depth images or of the clouds; empty without both.
const std::vector<double>& SurfaceTimes(const Evidence& evidence);

/// Times of the tracks, else those of SurfaceTimes, else of the first view's keypoints; they define the frames of a
/// clip without motion.
const std::vector<double>& EvidenceTimes(const Evidence& evidence);

/// Depth images, masks and clouds are referred to by their names in the source's folder; `files` gives their current
/// paths.
void ResolveDepthFiles(const std::map<std::string, std::filesystem::path>& files, Evidence& evidence);

struct Clip {
  ClipIdentity identity;
  std::string label;       ///< of the whole clip, or empty
  std::string fine_label;  ///< finer than `label`, or empty
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
  /// Value of `provenance`; empty: none.
  std::string Noted(const std::string& key) const;
};

/// A clip id without its frames: source/person/recording.
std::string RecordingOf(const std::string& id);
/// First frame of the span in an id, "#begin-end"; 0 without one.
int BeginFrameOf(const std::string& id);
/// The person of a clip id, with the source, because persons of two sources differ; empty where it is not known.
std::string PersonOf(const std::string& id);

/// Whether a name means a clip: its id, with its span of frames or without, what stands behind a '/' in it, or the name
/// that an inspection lists (provenance "inspected_as"), with the file's folders and ending or without.
bool IsCalled(const Clip& clip, const std::string& name);
bool IsCalled(const std::string& id, const std::string& name);

/// Frames of its motion, else those of EvidenceTimes.
int FrameCount(const Clip& clip);

/// Rate of the recording, in which the identity's frames are counted: that of the clip, unless it was resampled.
FrameRate RecordedRate(const Clip& clip);
inline constexpr const char* kRecordedRate = "recorded_rate";  ///< provenance of a clip that was resampled

/// Index of the clip's first frame in its recording, and its time in seconds from the recording's first frame.
long long FirstRecordedFrame(const Clip& clip);
double BeginInRecording(const Clip& clip);

/// Provenance of a clip whose world was chosen: what its height 0 is, one of the names below.
inline constexpr const char* kHeightOrigin = "origin";
inline constexpr const char* kOriginRoot = "root";                   ///< the root of the anchor frame
inline constexpr const char* kOriginFloor = "floor";                 ///< the floor under the feet, as measured
inline constexpr const char* kOriginSource = "source";               ///< the whole origin is the source's
inline constexpr const char* kOriginSourceHeight = "source_height";  ///< the height alone is the source's

}  // namespace mocurate
