#include "canon/frames/facing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "core/base/options.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/motion/limbs.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

/// Rest-pose left axis in the root's frame, right to left hip; nothing when the hips do not hang from the root.
std::optional<Vector3d> RestLeft(const Skeleton& skeleton) {
  const auto hips = HipsOrShoulders(skeleton);
  if (!hips) return std::nullopt;
  const Joint& left = skeleton.joints[(*hips)[0]];
  const Joint& right = skeleton.joints[(*hips)[1]];
  if (left.parent != 0 || right.parent != 0) return std::nullopt;
  const Vector3d axis = left.rest_offset - right.rest_offset;
  if (axis.norm() < 1e-9) return std::nullopt;
  return Vector3d(axis.normalized());
}

/// Columns left, up, forward: left as it is, up and forward made orthogonal to it.
Matrix3d AxesOf(const Vector3d& left, const Vector3d& up) {
  Vector3d forward = left.cross(up);
  forward = forward.norm() > 1e-9 ? Vector3d(forward.normalized()) : Vector3d(left.unitOrthogonal());
  Matrix3d axes;
  axes << left, forward.cross(left), forward;
  return axes;
}

Expected<Matrix3d> AxesFromJoints(const Motion& motion, int frame) {
  const Skeleton& skeleton = *motion.skeleton;
  const auto pair = HipsOrShoulders(skeleton);
  if (!pair) {
    return Fail(ErrorCode::kInconsistent, "skeleton '" + skeleton.name + "' names neither hips nor shoulders",
                "canon.facing", "name the mirrored hip joints left_hip and right_hip, or set facing.rule: origin");
  }
  const Vector3d left_joint = motion.joints.at(frame, (*pair)[0]);
  const Vector3d right_joint = motion.joints.at(frame, (*pair)[1]);
  Vector3d left = left_joint - right_joint;
  left = left.norm() > 1e-9 ? Vector3d(left.normalized()) : Vector3d(Vector3d::UnitX());
  Vector3d up = Vector3d::UnitY();
  if (const auto neck = skeleton.FindJoint("neck")) {
    const Vector3d trunk = Vector3d(motion.joints.at(frame, *neck)) - 0.5 * (left_joint + right_joint);
    if (trunk.norm() > 1e-6) up = trunk.normalized();
  }
  return AxesOf(left, up);
}

/// World rotation of the clip by the one entry of `given` that names it.
Expected<Quaterniond> GivenRotation(const FacingOptions& options, const Clip& clip) {
  const auto names = [](const std::vector<std::string>& list, const std::string& name) {
    return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
  };
  const GivenRotationOptions* found = nullptr;
  for (const GivenRotationOptions& entry : options.given) {
    if (!names(entry.persons, clip.identity.person) || !names(entry.views, clip.identity.view)) continue;
    if (found != nullptr) {
      return Fail(ErrorCode::kConfig, "two rotations are given for person '" + clip.identity.person + "'",
                  "canon.facing.given", "name each person and view once");
    }
    found = &entry;
  }
  if (found == nullptr) {
    return Fail(ErrorCode::kConfig,
                "no rotation is given for person '" + clip.identity.person + "', view '" + clip.identity.view + "'",
                "canon.facing.given", "add an entry that names them, or one without persons and views for all");
  }
  const std::vector<double>& r = found->rotation;
  if (r.size() != 9) {
    return Fail(ErrorCode::kConfig,
                Counted(static_cast<long long>(r.size()), "number") + ", a rotation matrix has 9, row by row",
                "canon.facing.given", "e.g. rotation: [1, 0, 0,  0, 1, 0,  0, 0, 1]");
  }
  const Matrix3d matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
  const Matrix3d rotation = NearestRotation(matrix);
  const double apart = (matrix - rotation).cwiseAbs().maxCoeff();
  if (apart > 1e-3) {
    return Fail(ErrorCode::kConfig,
                "the matrix is no rotation: the nearest one differs by " + RoundedText(apart) + ", 0.001 is allowed",
                "canon.facing.given", "give an orthogonal matrix of determinant +1");
  }
  return Quaterniond(rotation);
}

}  // namespace

std::optional<std::array<int, 2>> HipsOrShoulders(const Skeleton& skeleton) {
  if (const auto named = skeleton.Hips()) return named;
  const Limbs limbs = LimbsOf(skeleton);
  for (const std::array<Limb, 2>* pair : {&limbs.leg, &limbs.arm}) {
    const int left = (*pair)[0].root, right = (*pair)[1].root;
    if (left >= 0 && right >= 0 && left != right) return std::array<int, 2>{left, right};
  }
  return std::nullopt;
}

const char* Name(YawSource source) {
  switch (source) {
    case YawSource::kHipAxis:
      return "hip_axis";
    case YawSource::kForwardAxis:
      return "forward_axis";
    case YawSource::kTwist:
      return "twist";
  }
  return "";
}

Expected<Matrix3d> BodyAxes(const Motion& motion, int frame) {
  const auto rest_left = motion.joints_only() ? std::nullopt : RestLeft(*motion.skeleton);
  if (!rest_left) return AxesFromJoints(motion, frame);
  return Matrix3d(motion.rotation_at(frame, 0) * AxesOf(*rest_left, Vector3d::UnitY()));
}

Heading HeadingOfAxes(const Matrix3d& axes, FacingRule rule, double min_horizontal) {
  const Vector3d left = axes.col(0), forward = axes.col(2);
  Heading heading;
  if (rule == FacingRule::kTwist) {
    const Quaterniond q(axes);
    heading.source = YawSource::kTwist;
    heading.horizontal = std::hypot(q.w(), q.y());
    heading.yaw = std::remainder(2.0 * std::atan2(q.y(), q.w()), 2.0 * kPi);
    return heading;
  }
  heading.horizontal = std::hypot(left.x(), left.z());
  heading.yaw = std::atan2(-left.z(), left.x());
  if (rule == FacingRule::kEuler || heading.horizontal >= min_horizontal) return heading;
  heading.source = YawSource::kForwardAxis;
  heading.horizontal = std::hypot(forward.x(), forward.z());
  heading.yaw = std::atan2(forward.x(), forward.z());
  return heading;
}

bool ReadsHeading(FacingRule rule) {
  return rule == FacingRule::kHips || rule == FacingRule::kEuler || rule == FacingRule::kTwist;
}

Expected<Heading> HeadingOfFrame(const Motion& motion, int frame, const FacingOptions& options) {
  const auto axes = BodyAxes(motion, frame);
  if (!axes) return Forward(axes);
  return HeadingOfAxes(*axes, options.rule, options.min_horizontal);
}

Expected<int> AnchorFrame(const FacingOptions& options, const Clip& clip) {
  const int frames = clip.motion->frame_count();
  switch (options.anchor) {
    case Anchor::kFirst:
      return 0;
    case Anchor::kMiddle:
      return frames / 2;
    case Anchor::kLast:
      return frames - 1;
    case Anchor::kFirstSegment: {
      if (clip.segments.empty()) {
        return Fail(ErrorCode::kConfig, "the clip has no segment whose end could be the anchor", clip.id(),
                    "canon.facing.anchor: first_segment is for clips of several segments (trim.rule: triples)");
      }
      const auto first =
          std::min_element(clip.segments.begin(), clip.segments.end(), [](const Segment& a, const Segment& b) {
            return std::tie(a.begin_s, a.end_s) < std::tie(b.begin_s, b.end_s);
          });
      return std::clamp(static_cast<int>(std::lround(first->end_s * clip.motion->rate.hz())) - 1, 0, frames - 1);
    }
    case Anchor::kFrame:
      if (options.anchor_frame >= frames) {
        return Fail(ErrorCode::kConfig,
                    "the clip has " + Counted(frames, "frame") + ", facing.anchor_frame is " +
                        std::to_string(options.anchor_frame),
                    clip.id(), "name an earlier frame, or set facing.anchor: last");
      }
      return static_cast<int>(options.anchor_frame);
  }
  return 0;
}

Expected<Heading> FaceFront(const FacingOptions& options, Clip& clip) {
  if (!clip.motion || clip.motion->frame_count() == 0) {
    return Fail(ErrorCode::kInconsistent, "clip has no motion to canonicalise", clip.id(),
                "run the stage fitting first");
  }
  Heading heading;
  if (options.rule == FacingRule::kNone) return heading;
  const Motion& motion = *clip.motion;
  const Expected<int> anchor = AnchorFrame(options, clip);
  if (!anchor) return Forward(anchor);
  RigidTransform canonical_from_clip;
  switch (options.rule) {
    case FacingRule::kNone:
    case FacingRule::kOrigin:
      break;
    case FacingRule::kHips:
    case FacingRule::kEuler:
    case FacingRule::kTwist: {
      const auto found = HeadingOfFrame(motion, *anchor, options);
      if (!found) return Forward(found);
      heading = *found;
      canonical_from_clip.rotation = Quaterniond(Eigen::AngleAxisd(-heading.yaw, Vector3d::UnitY()));
      break;
    }
    case FacingRule::kZero: {
      const auto axes = BodyAxes(motion, *anchor);
      if (!axes) return Forward(axes);
      const bool turns = !motion.joints_only() && RestLeft(*motion.skeleton).has_value();
      canonical_from_clip.rotation =
          turns ? motion.rotation_at(*anchor, 0).conjugate() : Quaterniond(axes->transpose());
      break;
    }
    case FacingRule::kGiven: {
      const auto given = GivenRotation(options, clip);
      if (!given) return Forward(given);
      canonical_from_clip.rotation = *given;
      break;
    }
  }
  Vector3d origin = motion.joints.at(*anchor, 0);
  if (options.height == HeightOrigin::kFloor) origin = Vector3d(origin.x(), 0.0, origin.z());
  canonical_from_clip.translation = -(canonical_from_clip.rotation * origin);
  Transform(canonical_from_clip, clip);
  clip.provenance[kFacingNoted] = OptionsToJson(options).dump();
  return heading;
}

Status FaceAgain(Clip& clip) {
  const auto noted = clip.provenance.find(kFacingNoted);
  if (noted == clip.provenance.end()) return {};
  auto options = OptionsFromJson<FacingOptions>(nlohmann::json::parse(noted->second, nullptr, false), kFacingNoted);
  if (!options) return Forward(options);
  // The world is turned as given already; a frame that was cut away cannot be the anchor.
  if (options->rule == FacingRule::kGiven) options->rule = FacingRule::kOrigin;
  if (!AnchorFrame(*options, clip)) options->anchor = Anchor::kFirst;
  const auto faced = FaceFront(*options, clip);
  return faced ? Status() : Forward(faced);
}

void UndoCanonical(Clip& clip) { Transform(Inverse(clip.canonical_from_source), clip); }

}  // namespace mocurate
