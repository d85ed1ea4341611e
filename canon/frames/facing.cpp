#include "canon/frames/facing.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/base/json_text.h"
#include "core/base/options.h"
#include "core/base/text.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr double kUpright = 1e-9;  // a floor stays level under a rotation that moves +y by less

/// World rotation of the clip by the single entry of `given` that matches it.
Expected<Quaterniond> GivenRotation(const FacingOptions& options, const Clip& clip) {
  const auto names = [](const std::vector<std::string>& list, const std::string& name) {
    return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
  };
  const GivenRotationOptions* found = nullptr;
  for (const GivenRotationOptions& entry : options.given) {
    if (!names(entry.persons, clip.identity.person) || !names(entry.views, clip.identity.view)) continue;
    if (found != nullptr) {
      return Fail(ErrorCode::kConfig, "canon.facing.given has two rotations for person '" + clip.identity.person + "'",
                  "canon.facing.given", "name each person and view once");
    }
    found = &entry;
  }
  if (found == nullptr) {
    return Fail(ErrorCode::kConfig,
                "canon.facing.given has no rotation for person '" + clip.identity.person + "', view '" +
                    clip.identity.view + "'",
                "canon.facing.given", "add an entry for them, or one without persons and views for all");
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
                "the matrix is not a rotation: the nearest one differs by " + RoundedText(apart) + ", 0.001 is allowed",
                "canon.facing.given", "give an orthogonal matrix of determinant +1");
  }
  return Quaterniond(rotation);
}

}  // namespace

bool ReadsHeading(FacingRule rule) {
  return rule == FacingRule::kHips || rule == FacingRule::kEuler || rule == FacingRule::kTwist;
}

Expected<Heading> HeadingOfFrame(const Motion& motion, int frame, const FacingOptions& options) {
  const auto axes = BodyAxes(motion, frame);
  if (!axes) return Forward(axes);
  const HeadingRule rule = options.rule == FacingRule::kTwist   ? HeadingRule::kTwist
                           : options.rule == FacingRule::kEuler ? HeadingRule::kEuler
                                                                : HeadingRule::kHips;
  return HeadingOfAxes(*axes, rule, options.min_horizontal);
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
                    "use canon.facing.anchor: first_segment with clips of several segments only (trim.rule: triples)");
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
    return Fail(ErrorCode::kInconsistent, "the clip has no motion to canonicalise", clip.id(),
                "run the stage fitting first");
  }
  Heading heading;
  if (options.rule == FacingRule::kNone) {
    // A clip canonicalised by a version that did not note its origin keeps none.
    if (clip.provenance.count(kFacingNoted) == 0) clip.provenance.emplace(kHeightOrigin, kOriginSource);
    return heading;
  }
  const Motion& motion = *clip.motion;
  const Expected<int> anchor = AnchorFrame(options, clip);
  if (!anchor) return Forward(anchor);
  RigidTransform canonical_from_clip;
  if (ReadsHeading(options.rule)) {
    const auto found = HeadingOfFrame(motion, *anchor, options);
    if (!found) return Forward(found);
    heading = *found;
    canonical_from_clip.rotation = Quaterniond(Eigen::AngleAxisd(-heading.yaw, Vector3d::UnitY()));
  } else if (options.rule == FacingRule::kZero) {
    const auto axes = BodyAxes(motion, *anchor);
    if (!axes) return Forward(axes);
    const bool turns = !motion.joints_only() && RestLeftAxis(*motion.skeleton).has_value();
    canonical_from_clip.rotation = turns ? motion.rotation_at(*anchor, 0).conjugate() : Quaterniond(axes->transpose());
  } else if (options.rule == FacingRule::kGiven) {
    const auto given = GivenRotation(options, clip);
    if (!given) return Forward(given);
    canonical_from_clip.rotation = *given;
  }
  const bool upright = (canonical_from_clip.rotation * Vector3d::UnitY() - Vector3d::UnitY()).norm() < kUpright;
  const bool on_floor = upright && clip.Noted(kHeightOrigin) == kOriginFloor;
  FacingOptions noted = options;
  if (options.height == HeightOrigin::kMeasured) noted.height = on_floor ? HeightOrigin::kFloor : HeightOrigin::kRoot;
  Vector3d origin = motion.joints.at(*anchor, 0);
  if (noted.height == HeightOrigin::kFloor) origin = Vector3d(origin.x(), 0.0, origin.z());
  canonical_from_clip.translation = -(canonical_from_clip.rotation * origin);
  Transform(canonical_from_clip, clip);
  clip.provenance[kHeightOrigin] = noted.height == HeightOrigin::kRoot ? kOriginRoot
                                   : on_floor                          ? kOriginFloor
                                                                       : kOriginSourceHeight;
  clip.provenance[kFacingNoted] = OptionsToJson(noted).dump();
  return heading;
}

Status FaceAgain(Clip& clip) {
  const auto noted = clip.provenance.find(kFacingNoted);
  if (noted == clip.provenance.end()) return {};
  const auto json = ParseJson(noted->second, kFacingNoted);
  if (!json) return Forward(json);
  auto options = OptionsFromJson<FacingOptions>(*json, kFacingNoted);
  if (!options) return Forward(options);
  // The given rotation of the world is applied already; a frame that was cut away cannot be the anchor.
  if (options->rule == FacingRule::kGiven) options->rule = FacingRule::kOrigin;
  if (!AnchorFrame(*options, clip)) options->anchor = Anchor::kFirst;
  const auto faced = FaceFront(*options, clip);
  return faced ? Status() : Forward(faced);
}

}  // namespace mocurate
