#include "ingest/synthetic/performance.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/base/random.h"
#include "core/base/text.h"
#include "ingest/synthetic/actions.h"

namespace mocurate {
namespace {

/// Groups of body lengths that vary together.
enum BodyPart { kLegs, kArms, kTrunk, kWidth, kHead, kPartCount };

BodyPart PartOf(const std::string& joint) {
  const auto has = [&](const char* word) { return joint.find(word) != std::string::npos; };
  if (has("knee") || has("ankle") || has("foot")) return kLegs;
  if (has("elbow") || has("wrist") || has("hand")) return kArms;
  if (has("hip") || joint == "left_shoulder" || joint == "right_shoulder") return kWidth;
  return has("head") ? kHead : kTrunk;
}

double Around(Random& random, double middle, double spread) { return random.Uniform(middle - spread, middle + spread); }

/// Position and heading of a take, and its time scale.
struct Staging {
  Manner manner;
  double lead_s = 0.3;
  int frames = 0;
  double heading = 0.0;               ///< of the person, 0: towards the sensor
  Vector3d place = Vector3d::Zero();  ///< of the pelvis above the floor in frame 0, in the sensor's frame
  double floor = 0.0;                 ///< height of the floor
  double sway_phase = 0.0;
};

Staging Stage(const SyntheticOptions& options, const Take& take, const Subject& subject) {
  // The sensor stays in one position for the whole capture; its yaw appears as a heading of every take.
  Random room(static_cast<std::uint64_t>(options.seed), "studio.room");
  const double sensor_height = room.Uniform(0.9, 1.2);
  const double sensor_yaw = Around(room, 0.0, 0.3);
  Random random(static_cast<std::uint64_t>(options.seed), "studio.take", take.file());
  Staging staging;
  const double tempo = subject.tempo * Around(random, 1.0, 0.12);
  const double length_s = options.duration_s / tempo;
  staging.frames = std::max(2, static_cast<int>(std::lround(length_s * options.rate_hz)));
  staging.lead_s = length_s * random.Uniform(0.06, 0.14);
  staging.manner.active_s = length_s * random.Uniform(0.72, 0.80);
  staging.manner.amplitude = subject.amplitude * Around(random, 1.0, 0.10);
  staging.manner.phase = Around(random, 0.0, kPi);
  const double pace = take.action == "walk" ? 0.95 : 1.0;  // cycles per second at tempo 1
  staging.manner.cycles = std::max(1.0, pace * options.duration_s * 0.76 * Around(random, 1.0, 0.2));
  staging.heading = sensor_yaw + Around(random, 0.0, 0.25);
  staging.floor = -sensor_height;
  const double back = take.action == "walk" ? 0.6 : 0.0;  // room to walk in
  staging.place = Vector3d(Around(random, 0.0, 0.25), 0.0, -(2.7 + back + Around(random, 0.0, 0.2)));
  staging.sway_phase = random.Uniform(0.0, 2.0 * kPi);
  return staging;
}

Pose PoseAt(const Take& take, const Subject& subject, const Staging& staging, double time_s) {
  Pose pose = StandingPose(subject, time_s, staging.sway_phase);
  pose.yaw = staging.heading;
  Perform(take.action, std::clamp((time_s - staging.lead_s) / staging.manner.active_s, 0.0, 1.0), staging.manner, pose);
  return pose;
}

}  // namespace

std::string Take::file() const {
  return action + "_p" + ZeroPadded(subject + 1, 2) + "_r" + ZeroPadded(repetition + 1, 2) + ".txt";
}

std::vector<Take> Takes(const SyntheticOptions& options) {
  const std::set<std::string> actions(options.actions.begin(), options.actions.end());
  std::vector<Take> takes;
  for (const std::string& action : actions) {
    for (int subject = 0; subject < options.subjects; ++subject) {
      for (int repetition = 0; repetition < options.repetitions; ++repetition)
        takes.push_back({action, subject, repetition});
    }
  }
  return takes;
}

Pose StandingPose(const Subject& subject, double time_s, double sway_phase) {
  Pose pose;
  const double sway = std::sin(2.0 * kPi * 0.3 * time_s + sway_phase);
  const double breath = std::sin(2.0 * kPi * 0.25 * time_s + 1.7 * sway_phase);
  for (int side = 0; side < 2; ++side) {
    pose.arm[side] = {0.05, subject.arm_abduct + 0.015 * breath, 0.0, subject.elbow, 0.0};
    pose.leg[side] = {0.05, subject.stance, 0.08, 0.08, 0.0};
  }
  pose.trunk_bend = subject.stoop + 0.01 * breath;
  pose.trunk_side = 0.012 * sway;
  pose.head_rotation = 0.05 * sway;
  return pose;
}

std::vector<Subject> Cast(std::int64_t options_seed, std::int64_t subjects, const Skeleton& skeleton) {
  const auto seed = static_cast<std::uint64_t>(options_seed);
  const auto count = static_cast<std::size_t>(subjects);
  std::vector<std::size_t> step(count);
  std::iota(step.begin(), step.end(), std::size_t{0});
  Random order(seed, "studio.cast");
  for (std::size_t i = count; i > 1; --i) std::swap(step[i - 1], step[order.Below(i)]);
  std::vector<Subject> cast;
  for (std::size_t i = 0; i < count; ++i) {
    Subject subject;
    subject.name = "p" + ZeroPadded(static_cast<int>(i) + 1, 2);
    Random random(seed, "studio.subject", subject.name);
    const double stature = 0.90 + 0.20 * (static_cast<double>(step[i]) + random.Uniform()) / static_cast<double>(count);
    double part[kPartCount];
    for (double& factor : part) factor = stature * Around(random, 1.0, 0.05);
    for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
      subject.bone_length.push_back(part[PartOf(skeleton.joints[j].name)] * skeleton.joints[j].rest_offset.norm());
    }
    subject.amplitude = Around(random, 1.0, 0.12);
    subject.tempo = Around(random, 1.0, 0.12);
    subject.stance = random.Uniform(0.03, 0.10);
    subject.arm_abduct = random.Uniform(0.10, 0.24);
    subject.elbow = random.Uniform(0.12, 0.40);
    subject.stoop = random.Uniform(-0.04, 0.10);
    subject.knee = random.Uniform(0.0, 0.22);
    cast.push_back(std::move(subject));
  }
  return cast;
}

Motion PerformTake(const SyntheticOptions& options, const Take& take, const Subject& subject,
                   const SkeletonPtr& skeleton) {
  const Staging staging = Stage(options, take, subject);
  const FrameRate rate = FrameRate::FromHz(options.rate_hz);
  std::vector<Pose> poses;
  for (int f = 0; f < staging.frames; ++f) poses.push_back(PoseAt(take, subject, staging, rate.FrameTime(f)));
  return MoveBody(skeleton, subject.bone_length, rate, poses, {staging.place.x(), staging.floor, staging.place.z()});
}

}  // namespace mocurate
