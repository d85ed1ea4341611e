#pragma once

#include <optional>

#include "core/quality/tracked_points.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// Whether a cause is known that makes a pose of every frame wrong, so that what the body shows is its consequence:
/// angles of another unit than the file says.
bool InvalidatesPoses(const std::vector<Finding>& findings);

/// The points of a clip: its tracks, else the joints of its motion. Nothing for clips without either.
struct ClipPoints {
  explicit ClipPoints(const Clip& clip, const SkeletonPtr& skeleton);

  bool empty() const { return positions == nullptr || positions->frames == 0; }
  TrackedPoints view() const {
    return {*positions, *confidence, *time_s, names, bones.parents, bones.rest_lengths, body};
  }

  const JointPositions* positions = nullptr;
  const std::vector<double>* confidence = nullptr;
  const std::vector<double>* time_s = nullptr;
  std::vector<std::string> names;
  PointBones bones;
  BodyLandmarks body;
  std::vector<double> own_time_s, own_confidence;  ///< of a motion
};

/// A clip that is excluded, by which finding.
struct DroppedClip {
  Finding finding;
  double threshold = 0.0;
};

/// What is wrong with points, as CheckPoints says, and "motionless_clip": the same for what is inspected and what is
/// ingested. `metres`: unit and up are beyond doubt. Without a rate none is doubted. `lost_frames`: that the clip may
/// lack between two of its own.
std::vector<Finding> FindDefects(const CheckOptions& options, const TrackedPoints& points,
                                 std::optional<double> rate_hz, bool metres, int lost_frames = 0);

/// Says of findings of zeros what is to be done about them in a source of `format`.
void ExplainZeros(std::string_view format, std::vector<Finding>& findings);

/// "joint_never_seen" (info): joints that are missing in every frame of a clip in which others are seen; value their
/// number. Joints that `reported` already names are skipped.
std::vector<Finding> FindNeverObserved(const TrackedPoints& points, const std::vector<Finding>& reported = {});

/// Of a file that says neither when its frames were taken nor how fast: up to half a second at 30 Hz, a second at 15.
/// HumanAct12's clips, which omit frames without annotation, lack up to 17 frames.
inline constexpr int kLostWithoutRate = 15;

/// Asks core/quality what is wrong with the clip, which is in metres and canonical axes, and the name whether it agrees
/// with the content; appends findings and does about them what `source.checks` says: each finding's action tells.
/// Samples that are to be missing lose their confidence. Returns the first finding that drops the clip. Where the body
/// contradicts its declared units or axes, "motionless_clip" drops none.
std::optional<DroppedClip> CheckClip(const SourceOptions& source, const NamedFile& named, IngestedClip& ingested);

}  // namespace mocurate
