#include "fitting/contacts/foot_contacts.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/pi.h"
#include "core/geometry/rotation.h"
#include "core/motion/kinematics.h"
#include "core/motion/limbs.h"
#include "fitting/solver/track_problem.h"
#include "fitting/uncertainty/pose_posterior.h"

namespace mocurate {
namespace {

constexpr double kStraightest = 0.9995;  ///< share of the leg's length: a knee is never quite straight
constexpr double kNoFaster = 1e-4;       ///< m/s; a smaller increase of speed is rounding (numerical)
constexpr int kTrials = 5;               ///< trials of a correction: each halves it, the last removes it (numerical)

/// Frames in which a joint is in contact.
struct Stand {
  int joint = -1;
  std::vector<bool> frames;
};

/// Horizontal speed of joints between frames of contact, metres per second.
struct Slide {
  double mean = 0.0;
  double fastest = 0.0;
};

Slide SlideIn(const Motion& motion, const std::vector<Stand>& stands, FrameRun run) {
  Slide slide;
  int steps = 0;
  for (const Stand& stand : stands) {
    for (int f = run.begin + 1; f < run.end; ++f) {
      if (!stand.frames[f] || !stand.frames[f - 1]) continue;
      const Vector3d step = motion.joints.at(f, stand.joint) - motion.joints.at(f - 1, stand.joint);
      const double speed = std::hypot(step.x(), step.z()) * motion.rate.hz();
      slide.mean += speed;
      slide.fastest = std::max(slide.fastest, speed);
      ++steps;
    }
  }
  if (steps > 0) slide.mean /= steps;
  return slide;
}

/// A foot, its joints that can be in contact, and its correction.
struct Foot {
  Leg leg;
  std::vector<Stand> stands;
  std::vector<bool> standing;      ///< any joint in contact
  std::vector<FrameRun> contacts;  ///< of `standing`
  std::vector<double> applied;     ///< of each contact: share of the full correction that is applied
  std::vector<Vector3d> still;     ///< full correction, (F) as the others
  std::vector<Vector3d> shift;
};

/// Subtracts from each step of a contact the mean movement of the joints (ankle, toe) that are in contact before and
/// after it. When the heel lifts and the toe stays, the foot continues from its place. The middle of the contact is
/// fixed.
void HoldStill(const Motion& motion, FrameRun contact, Foot& foot) {
  Vector3d middle = Vector3d::Zero();
  for (int f = contact.begin + 1; f < contact.end; ++f) {
    Vector3d step = Vector3d::Zero();
    int count = 0;
    for (const Stand& stand : foot.stands) {
      if (!stand.frames[f] || !stand.frames[f - 1]) continue;
      step += motion.joints.at(f, stand.joint) - motion.joints.at(f - 1, stand.joint);
      ++count;
    }
    foot.still[f] = foot.still[f - 1];
    if (count > 0) foot.still[f] -= step / count;
    middle += foot.still[f] / (contact.end - contact.begin);
  }
  for (int f = contact.begin; f < contact.end; ++f) foot.still[f] -= middle;
}

Foot FootOf(const Motion& motion, const Leg& leg, const ContactOptions& options) {
  const int frames = motion.frame_count();
  Foot foot;
  foot.leg = leg;
  foot.standing.assign(frames, false);
  for (const int joint : {leg.ankle, leg.toe}) {
    if (joint < 0) continue;
    foot.stands.push_back({joint, JointContacts(motion, joint, LimitsOf(options))});
    for (int f = 0; f < frames; ++f) foot.standing[f] = foot.standing[f] || foot.stands.back().frames[f];
  }
  foot.contacts = RunsWhere(foot.standing, true);
  foot.applied.assign(foot.contacts.size(), 1.0);
  foot.still.assign(frames, Vector3d::Zero());
  for (const FrameRun& contact : foot.contacts) HoldStill(motion, contact, foot);
  return foot;
}

/// 1 at 0, 0 at 1 and beyond, flat at both ends.
double Fade(double x) { return x >= 1.0 ? 0.0 : 0.5 + 0.5 * std::cos(kPi * x); }

/// Between contacts the shift of each neighbour fades within `blend` frames.
void FadeShifts(const std::vector<bool>& standing, double blend, std::vector<Vector3d>& shift) {
  const int frames = static_cast<int>(shift.size());
  for (const FrameRun& gap : RunsWhere(standing, false)) {
    const double length = std::min(blend, static_cast<double>(gap.end - gap.begin) + 1.0);
    for (int f = gap.begin; f < gap.end; ++f) {
      Vector3d sum = Vector3d::Zero();
      if (gap.begin > 0) sum += Fade((f - gap.begin + 1) / length) * shift[gap.begin - 1];
      if (gap.end < frames) sum += Fade((gap.end - f) / length) * shift[gap.end];
      shift[f] = sum;
    }
  }
}

/// Sets the foot's corrections, scaled by the applied share of each contact.
void SetShifts(const ContactOptions& options, double hz, Foot& foot) {
  foot.shift.assign(foot.still.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < foot.contacts.size(); ++i) {
    for (int f = foot.contacts[i].begin; f < foot.contacts[i].end; ++f) foot.shift[f] = foot.applied[i] * foot.still[f];
  }
  FadeShifts(foot.standing, options.blend_s * hz, foot.shift);
}

/// Rotates hip and knee so that the ankle reaches `target`; the foot keeps its orientation. Joints and globals are
/// those before the change. Returns whether the leg is long enough.
bool BendLeg(const Leg& leg, int frame, const JointPositions& joints, const Vector3d& target,
             const std::vector<Quaterniond>& global, Motion& motion) {
  const Vector3d hip = joints.at(frame, leg.hip);
  const Vector3d knee = joints.at(frame, leg.knee);
  const Vector3d ankle = joints.at(frame, leg.ankle);
  const double thigh = (knee - hip).norm();
  const double shank = (ankle - knee).norm();
  const double wanted = (target - hip).norm();
  const double reach = std::clamp(wanted, std::abs(thigh - shank) + 1e-6, kStraightest * (thigh + shank));
  const auto angle = [](double a, double b, double opposite) {
    return std::acos(std::clamp((a * a + b * b - opposite * opposite) / (2.0 * a * b), -1.0, 1.0));
  };
  const double before = angle(thigh, shank, (ankle - hip).norm());
  const double after = angle(thigh, shank, reach);
  Vector3d axis = (hip - knee).cross(ankle - knee);
  // A straight leg bends backwards about the x axis of its knee: axis = x without its part along the shank, negative.
  if (axis.norm() < 1e-6 * thigh * shank) {
    axis = (global[leg.knee] * Vector3d::UnitX()).cross(ankle - knee).cross(ankle - knee);
  }
  if (axis.norm() == 0.0) return false;
  axis.normalize();
  const Quaterniond bend(Eigen::AngleAxisd(after - before, axis));
  const Vector3d bent = knee + bend * (ankle - knee);
  const Quaterniond swing = Quaterniond::FromTwoVectors(bent - hip, target - hip);
  const Quaterniond hip_global = swing * global[leg.hip];
  const Quaterniond knee_global = swing * bend * global[leg.knee];
  const int above = motion.skeleton->joints[leg.hip].parent;
  const Quaterniond parent = above < 0 ? Quaterniond::Identity() : global[above];
  motion.rotation_at(frame, leg.hip) = (parent.conjugate() * hip_global).normalized();
  motion.rotation_at(frame, leg.knee) = (hip_global.conjugate() * knee_global).normalized();
  motion.rotation_at(frame, leg.ankle) = (knee_global.conjugate() * global[leg.ankle]).normalized();
  return wanted <= kStraightest * (thigh + shank);
}

/// Bends the legs to the corrected places of the feet. Returns the number of foot frames out of reach.
int BendToTargets(const Motion& before, const std::vector<Foot>& feet, Motion& motion) {
  int unreachable = 0;
  std::vector<Vector3d> joints(motion.joint_count());
  std::vector<Quaterniond> global(motion.joint_count());
  for (int f = 0; f < motion.frame_count(); ++f) {
    ForwardKinematics(*motion.skeleton, motion.root_translation[f], &before.rotation_at(f, 0), motion.bone_length,
                      joints.data(), global.data());
    for (const Foot& foot : feet) {
      if (foot.shift[f].norm() < 1e-9) continue;
      const Vector3d target = before.joints.at(f, foot.leg.ankle) + foot.shift[f];
      if (!BendLeg(foot.leg, f, before.joints, target, global, motion)) ++unreachable;
    }
  }
  ComputeJoints(motion);
  return unreachable;
}

/// Multiplies the applied share of contacts in which a foot became faster by `factor`. Returns whether there are any.
bool ReduceCorrections(const Motion& before, const Motion& motion, double factor, std::vector<Foot>& feet) {
  bool any = false;
  for (Foot& foot : feet) {
    for (std::size_t i = 0; i < foot.contacts.size(); ++i) {
      const double was = SlideIn(before, foot.stands, foot.contacts[i]).fastest;
      if (SlideIn(motion, foot.stands, foot.contacts[i]).fastest <= was + kNoFaster) continue;
      foot.applied[i] *= factor;
      any = true;
    }
  }
  return any;
}

void MeasureChange(const Motion& before, const Motion& after, SlidingRemoval& removal) {
  for (int f = 0; f < after.frame_count(); ++f) {
    for (int j = 0; j < after.joint_count(); ++j) {
      const double shift = (after.joints.at(f, j) - before.joints.at(f, j)).norm();
      removal.largest_rotation =
          std::max(removal.largest_rotation, before.rotation_at(f, j).angularDistance(after.rotation_at(f, j)));
      if (shift <= removal.largest_shift) continue;
      removal.largest_shift = shift;
      removal.frame = f;
      removal.joint = j;
    }
  }
}

constexpr double kMoved = 1e-3;  ///< metres; a joint that is moved farther is a repaired one

/// Adds the correction to the stated uncertainties: shifts and rotations count as errors of unknown sign.
void StateChange(const Motion& before, Motion& after) {
  const std::size_t samples = after.joints.xyz.size() / 3;
  const auto joints = static_cast<std::size_t>(after.joint_count());
  for (std::size_t i = 0; i < samples; ++i) {
    const auto frame = static_cast<int>(i / joints);
    const auto joint = static_cast<int>(i % joints);
    const Vector3d shift = after.joints.at(frame, joint) - before.joints.at(frame, joint);
    if (!after.position_cov.empty()) {
      float* cov = &after.position_cov[6 * i];
      for (int row = 0; row < 3; ++row) {
        for (int column = row; column < 3; ++column) *cov++ += static_cast<float>(shift[row] * shift[column]);
      }
    }
    if (!after.rotation_sigma.empty()) {
      const Vector3d rotation_change = LogQuaternion(before.rotation[i].conjugate() * after.rotation[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        float none = 1.0F;
        WidenRotation(Square(rotation_change[static_cast<Eigen::Index>(axis)]), after.rotation_sigma[3 * i + axis],
                      after.rotation_observed.empty() ? none : after.rotation_observed[3 * i + axis]);
      }
    }
    if (!after.state.empty() && after.state[i] == JointState::kObserved && shift.norm() > kMoved) {
      after.state[i] = JointState::kRepaired;
    }
  }
}

}  // namespace

Expected<std::vector<Leg>> LegsOf(const Skeleton& skeleton) {
  const Limbs limbs = LimbsOf(skeleton);
  std::vector<Leg> legs;
  for (const Limb& limb : limbs.leg) {
    const bool chain = limb.root >= 0 && limb.end >= 0 && skeleton.joints[limb.middle].parent == limb.root &&
                       skeleton.joints[limb.end].parent == limb.middle;
    if (!chain) {
      const char* side = legs.empty() ? "left" : "right";
      return Fail(
          ErrorCode::kUnsupported,
          std::string("hip, knee and ankle of the ") + side + " leg form no chain of joints in skeleton '" +
              skeleton.name + "'",
          "fitting.contacts",
          "choose a skeleton that has this chain, e.g. smpl24, or set fitting.contacts.remove_sliding to false");
    }
    legs.push_back({limb.root, limb.middle, limb.end, limb.tip});
    if (limb.tip >= 0 && skeleton.joints[limb.tip].parent != limb.end) legs.back().toe = -1;
  }
  return legs;
}

Expected<SlidingRemoval> RemoveFootSliding(const ContactOptions& options, Motion& motion) {
  const Expected<std::vector<Leg>> legs = LegsOf(*motion.skeleton);
  if (!legs) return Forward(legs);
  const int frames = motion.frame_count();
  const Motion before = motion;
  SlidingRemoval removal;
  motion.contact.assign(2 * static_cast<std::size_t>(frames), 0);
  std::vector<Foot> feet;
  std::vector<Stand> stands;
  std::size_t contacts = 0;
  for (std::size_t side = 0; side < legs->size(); ++side) {
    feet.push_back(FootOf(before, (*legs)[side], options));
    const Foot& foot = feet.back();
    stands.insert(stands.end(), foot.stands.begin(), foot.stands.end());
    for (int f = 0; f < frames; ++f) {
      motion.contact[2 * static_cast<std::size_t>(f) + side] = foot.standing[f] ? 1 : 0;
      contacts += foot.standing[f] ? 1 : 0;
    }
  }
  for (int trial = 1; trial <= kTrials; ++trial) {
    for (Foot& foot : feet) SetShifts(options, motion.rate.hz(), foot);
    motion.rotation = before.rotation;
    removal.unreachable = BendToTargets(before, feet, motion);
    if (!ReduceCorrections(before, motion, trial + 1 == kTrials ? 0.0 : 0.5, feet)) break;
  }
  for (int j = 0; j < motion.joint_count(); ++j) {
    MakeSignContinuous(motion.rotation.data() + j, frames, motion.joint_count());
  }
  MeasureChange(before, motion, removal);
  StateChange(before, motion);
  const Slide slid = SlideIn(before, stands, {0, frames}), slides = SlideIn(motion, stands, {0, frames});
  removal.sliding_before = slid.mean;
  removal.sliding_after = slides.mean;
  removal.fastest_before = slid.fastest;
  removal.fastest_after = slides.fastest;
  removal.contact_share = frames > 0 ? static_cast<double>(contacts) / (2.0 * frames) : 0.0;
  return removal;
}

nlohmann::json SlidingJson(const SlidingRemoval& removal, const Skeleton& skeleton) {
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  return {{"sliding_before", rounded(removal.sliding_before)},
          {"sliding_after", rounded(removal.sliding_after)},
          {"fastest_before", rounded(removal.fastest_before)},
          {"fastest_after", rounded(removal.fastest_after)},
          {"contact_share", rounded(removal.contact_share)},
          {"largest_shift_mm", rounded(removal.largest_shift * 1e3)},
          {"largest_turn_deg", rounded(kDegrees * removal.largest_rotation)},
          {"frame", removal.frame},
          {"joint", removal.joint < 0 ? std::string() : skeleton.joints[removal.joint].name},
          {"unreachable_frames", removal.unreachable}};
}

namespace {
constexpr double kStanding = 0.3;  ///< m/s, apparent speed of a standing foot, at most: noise of the current pose
}

void HoldStandingFeet(const Motion& pose, const TrackProblem& window, ProcessNoiseScale& factors) {
  const auto legs = LegsOf(*pose.skeleton);
  if (!legs) return;
  ContactOptions contacts;
  contacts.speed = kStanding;
  const double largest = *window.options.contact_process_noise / window.options.priors.position_noise;
  for (const Leg& leg : *legs) {
    for (const int joint : {leg.ankle, leg.toe}) {
      if (joint < 0) continue;
      const std::vector<bool> stands = JointContacts(pose, joint, LimitsOf(contacts));
      for (int f = 0; f + 1 < window.frames(); ++f) {
        if (!stands[f] || !stands[f + 1]) continue;
        double& factor = factors.position[window.Index(f, joint)];
        factor = std::min(factor, largest);
      }
    }
  }
}

}  // namespace mocurate
