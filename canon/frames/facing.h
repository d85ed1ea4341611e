#pragma once

#include <array>
#include <optional>

#include "canon/options.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Left and right hip, or shoulder where there are none; of a tree whose joints have other names, the first joints of
/// its legs or arms.
std::optional<std::array<int, 2>> HipsOrShoulders(const Skeleton& skeleton);

/// Directions of a person in the world, unit and orthogonal: columns left (+x of the canonical frame), up, forward.
/// With rotations they turn with the root (of SMPL: its matrix); joints only: right to left hip (else shoulder), hips
/// to neck. Error kInconsistent if the skeleton names neither hips nor shoulders.
Expected<Matrix3d> BodyAxes(const Motion& motion, int frame);

/// What a heading was read from; kept with the clip, since definitions differ away from upright.
enum class YawSource { kHipAxis, kForwardAxis, kTwist };
const char* Name(YawSource source);

struct Heading {
  double yaw = 0.0;  ///< radians about +y, from canonical facing (+z) to the person's
  YawSource source = YawSource::kHipAxis;
  double horizontal = 1.0;  ///< of what yaw is read from, 1 for upright; at 0 yaw is not defined
};

/// Yaw of body axes (columns left, up, forward), `rule` one of the three that read a heading:
///   kHips   atan2(-left.z, left.x); where its horizontal part is shorter than `min_horizontal`,
///           atan2(forward.x, forward.z) [multiact.md B.4]
///   kEuler  atan2(-left.z, left.x) always, as the released code has it: jumps where the hip axis passes the vertical
///           [multiact.md B.1, y-up form B.3]
///   kTwist  the turn about +y in R = Ry(yaw) S, S about a horizontal axis: 2 atan2(q.y, q.w). Continuous in every pose
///           but upside down
Heading HeadingOfAxes(const Matrix3d& axes, FacingRule rule, double min_horizontal);

/// Whether a rule reads a heading.
bool ReadsHeading(FacingRule rule);

/// HeadingOfAxes of one frame. Error of BodyAxes.
Expected<Heading> HeadingOfFrame(const Motion& motion, int frame, const FacingOptions& options);

/// The anchor's frame. Error kConfig for a frame that the clip lacks, or the end of a first segment where it has none.
Expected<int> AnchorFrame(const FacingOptions& options, const Clip& clip);

/// Moves the clip into its canonical frame: x -> Q (x - x_anchor), Q by options.rule, so that the anchor's root is at
/// the origin (with kFloor: above it, at its height over y = 0). kNone moves nothing. Acts on all fields;
/// canonical_from_source keeps what undoing needs. Errors of BodyAxes and AnchorFrame; kConfig where kGiven has no
/// rotation for the clip, or two.
Expected<Heading> FaceFront(const FacingOptions& options, Clip& clip);

/// The options of FaceFront in a clip's provenance, JSON.
inline constexpr const char* kFacingNoted = "facing";

/// FaceFront by the options that the clip notes, for a part of a clip that was faced; where its anchor was cut away, by
/// the first frame. Nothing for a clip that notes none. Errors of FaceFront.
Status FaceAgain(Clip& clip);

/// The clip as it lay in the world of its source.
void UndoCanonical(Clip& clip);

}  // namespace mocurate
