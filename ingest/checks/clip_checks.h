#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/finding.h"
#include "core/quality/duplicates.h"
#include "core/quality/tracked_points.h"
#include "ingest/checks/finding_table.h"
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

DuplicateLimits DuplicateLimitsOf(const CheckOptions& options);

/// The finding of a pair of equal clips, about the second: "duplicate", "near_duplicate",
/// "mirrored_duplicate" or "shared_frames", the same for what is inspected and what is ingested. `first_name` names the
/// other one. The clip is left to the caller.
Finding DuplicateFinding(const Duplicate& pair, const std::string& first_name, const MotionSignature& first,
                         const MotionSignature& second);

/// The code of what is wrong with a file that gives no clip, the same in an inspection and as the rule of a run's log.
/// `format` as a source names it ("joint_table"); empty or another: nothing more is known than the error says.
std::string FaultCode(const Error& error, std::string_view format);

}  // namespace mocurate
