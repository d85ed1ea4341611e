#include "ingest/synthetic/tracker.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/formats/joint_table.h"

namespace mocurate {
namespace {

Vector3d RandomDirection(Random& random) {
  Vector3d direction;
  do {
    direction = Vector3d(random.Normal(), random.Normal(), random.Normal());
  } while (direction.norm() < 1e-6);
  return direction.normalized();
}

/// Joints in a state for several frames in a row: a two-state Markov chain with stationary share `share`.
std::vector<bool> Spells(int frames, std::size_t joints, double share, double mean_frames, Random& random) {
  std::vector<bool> in_state(static_cast<std::size_t>(frames) * joints, false);
  if (share <= 0.0) return in_state;
  const double leaves = 1.0 / mean_frames;
  const double enters = std::min(1.0, leaves * share / (1.0 - share));
  for (std::size_t k = 0; k < joints; ++k) {
    bool is_in = random.Uniform() < share;
    for (int f = 0; f < frames; ++f) {
      in_state[static_cast<std::size_t>(f) * joints + k] = is_in;
      is_in = is_in ? random.Uniform() >= leaves : random.Uniform() < enters;
    }
  }
  return in_state;
}

/// White noise of unit variance, smoothed twice over some frames: a joint's slow error, per axis.
class Wander {
 public:
  Wander(double frames, Random random) : keep_(std::exp(-1.0 / frames)), random_(std::move(random)) {
    for (int k = 0; k < 3; ++k) inner_[k] = random_.Normal();
    for (int warm = 0; warm < static_cast<int>(5.0 * frames); ++warm) Next();
  }
  Vector3d Next() {
    // The inner noise has variance 1, its smoothed version (1 + a^2) / (1 + a)^2.
    const double fresh = std::sqrt(1.0 - keep_ * keep_);
    const double scale = (1.0 + keep_) / std::sqrt(1.0 + keep_ * keep_);
    for (int k = 0; k < 3; ++k) {
      inner_[k] = keep_ * inner_[k] + fresh * random_.Normal();
      outer_[k] = keep_ * outer_[k] + (1.0 - keep_) * inner_[k];
    }
    return scale * outer_;
  }

 private:
  double keep_;
  Random random_;
  Vector3d inner_ = Vector3d::Zero();
  Vector3d outer_ = Vector3d::Zero();
};

/// Index in `names` of the same point on the other side; its own where there is none.
int PartnerPoint(const std::vector<std::string>& names, int point) {
  std::string other = names[point];
  for (const auto& [side, opposite] : {std::pair("left", "right"), std::pair("right", "left")}) {
    const std::size_t at = names[point].find(side);
    if (at != std::string::npos) other.replace(at, std::string(side).size(), opposite);
  }
  const auto found = std::find(names.begin(), names.end(), other);
  return found == names.end() ? point : static_cast<int>(found - names.begin());
}

/// Parts of limbs that are exchanged together, as bits.
enum LimbPart : unsigned { kForearm = 1, kLowerLeg = 2, kUpperArm = 4, kHip = 8 };

unsigned LimbPartOf(const std::string& name) {
  const auto has = [&](std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(),
                       [&](const char* word) { return name.find(word) != std::string::npos; });
  };
  if (has({"elbow", "wrist", "hand", "thumb"})) return kForearm;
  if (has({"knee", "ankle", "foot"})) return kLowerLeg;
  if (has({"shoulder", "collar"})) return kUpperArm;
  return has({"hip"}) ? kHip : 0u;
}

/// Arms, legs or both; of arms or legs all joints, or those from the elbow or knee down.
unsigned RandomParts(Random& random) {
  constexpr unsigned kArms = kForearm | kUpperArm, kLegs = kLowerLeg | kHip;
  const std::uint64_t limbs = random.Below(3);
  const bool outer = random.Uniform() < 0.5;
  if (limbs == 2) return kArms | kLegs;
  if (limbs == 1) return outer ? kLowerLeg : kLegs;
  return outer ? kForearm : kArms;
}

/// The point reported for each listed point in a frame: itself, or its partner while limbs are exchanged.
class Exchange {
 public:
  Exchange(const std::vector<std::string>& names, int frames, const TrackerOptions& options, Random& once,
           Random& again)
      : exchanged_(static_cast<std::size_t>(frames), 0u) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      part_.push_back(LimbPartOf(names[k]));
      partner_.push_back(PartnerPoint(names, static_cast<int>(k)));
    }
    const bool happens = once.Uniform() < options.swap_share;
    const auto begin = static_cast<int>(once.Below(static_cast<std::uint64_t>(std::max(1, frames))));
    const unsigned outer = once.Uniform() < 0.5 ? kForearm : kLowerLeg;
    const int end = happens ? std::min(frames, begin + static_cast<int>(options.swap_frames)) : begin;
    std::fill(exchanged_.begin() + begin, exchanged_.begin() + end, outer);
    const auto spells = Spells(frames, 1, options.swapped_share, static_cast<double>(options.swap_frames), again);
    unsigned parts = 0;
    for (std::size_t f = 0; f < spells.size(); ++f) {
      if (!spells[f]) continue;
      if (f == 0 || !spells[f - 1]) parts = RandomParts(again);
      exchanged_[f] |= parts;
    }
  }
  int Seen(int frame, int point) const {
    const auto k = static_cast<std::size_t>(point);
    return (exchanged_[static_cast<std::size_t>(frame)] & part_[k]) != 0 ? partner_[k] : point;
  }

 private:
  std::vector<unsigned> part_;
  std::vector<int> partner_;
  std::vector<unsigned> exchanged_;  ///< (F) parts
};

}  // namespace

const std::vector<std::string>& TrackedJoints() {
  static const std::vector<std::string> joints = {
      "head",        "shoulder_center", "spine",      "hip_center", "right_shoulder", "right_elbow", "right_wrist",
      "right_hand",  "left_shoulder",   "left_elbow", "left_wrist", "left_hand",      "right_hip",   "right_knee",
      "right_ankle", "right_foot",      "left_hip",   "left_knee",  "left_ankle",     "left_foot"};
  return joints;
}

JointPositions PointsOf(const Motion& motion, const std::vector<std::string>& names) {
  JointPositions points(motion.frame_count(), static_cast<int>(names.size()));
  for (int k = 0; k < points.joints; ++k) {
    const int joint = motion.skeleton->FindJoint(names[k]).value_or(0);
    for (int f = 0; f < points.frames; ++f) points.at(f, k) = motion.joints.at(f, joint);
  }
  return points;
}

TrackedTake Track(const JointPositions& truth, const std::vector<std::string>& names, const TrackerOptions& options,
                  std::int64_t options_seed, const std::string& item) {
  const auto seed = static_cast<std::uint64_t>(options_seed);
  const std::size_t count = names.size();
  Random noise(seed, "studio.noise", item);
  Random gross(seed, "studio.outlier", item);
  Random hidden(seed, "studio.dropout", item);
  Random still(seed, "studio.frozen", item);
  Random swap(seed, "studio.swap", item);
  Random swapped(seed, "studio.swapped", item);
  const double per_axis = options.noise / std::sqrt(3.0);
  const double farthest = std::max(options.outlier_nearest, options.outlier_farthest);
  const auto lost = Spells(truth.frames, count, options.dropout_share, options.dropout_frames, hidden);
  const auto frozen = Spells(truth.frames, count, options.frozen_share, options.frozen_frames, still);
  const Exchange exchange(names, truth.frames, options, swap, swapped);
  std::vector<Vector3d> bias(count, Vector3d::Zero());
  for (std::size_t k = 0; k < count && options.bias > 0.0; ++k) {
    Random offset(seed, "studio.bias", names[k]);
    bias[k] = options.bias / std::sqrt(3.0) * Vector3d(offset.Normal(), offset.Normal(), offset.Normal());
  }

  std::vector<Wander> wander;
  for (std::size_t k = 0; k < count && options.wander > 0.0; ++k) {
    wander.emplace_back(options.wander_frames, Random(seed, "studio.wander", item + "/" + std::to_string(k)));
  }

  TrackedTake tracked{JointPositions(truth.frames, truth.joints), {}, {}};
  for (int f = 0; f < truth.frames; ++f) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto point = static_cast<int>(k);
      const std::size_t sample = static_cast<std::size_t>(f) * count + k;
      Vector3d position = truth.at(f, exchange.Seen(f, point));
      position += per_axis * Vector3d(noise.Normal(), noise.Normal(), noise.Normal());
      position += bias[k];
      if (!wander.empty()) position += options.wander / std::sqrt(3.0) * wander[k].Next();
      const bool wrong = gross.Uniform() < options.outlier_share;
      const Vector3d error = gross.Uniform(options.outlier_nearest, farthest) * RandomDirection(gross);
      if (wrong) position += error;
      const bool repeats = frozen[sample] && f > 0;
      if (repeats) position = tracked.positions.at(f - 1, point);
      tracked.positions.at(f, point) = position;
      tracked.seen.push_back(lost[sample] ? 0 : 1);
      tracked.frozen.push_back(repeats ? 1 : 0);
    }
  }
  return tracked;
}

void ExtrapolateMissing(const TrackerOptions& options, std::int64_t seed, const std::string& item,
                        TrackedTake& tracked) {
  Random tremble(static_cast<std::uint64_t>(seed), "studio.guess", item);
  const double per_axis = options.noise / std::sqrt(3.0);
  const auto count = static_cast<std::size_t>(tracked.positions.joints);
  const auto seen = [&](int f, int k) {
    return tracked.seen[static_cast<std::size_t>(f) * count + static_cast<std::size_t>(k)] != 0;
  };
  for (int f = 1; f < tracked.positions.frames; ++f) {
    Vector3d step = Vector3d::Zero();
    int steps = 0;
    for (int k = 0; k < tracked.positions.joints; ++k) {
      if (!seen(f, k) || !seen(f - 1, k)) continue;
      step += Vector3d(tracked.positions.at(f, k)) - Vector3d(tracked.positions.at(f - 1, k));
      ++steps;
    }
    if (steps > 0) step /= steps;
    for (int k = 0; k < tracked.positions.joints; ++k) {
      if (seen(f, k)) continue;
      const Vector3d error(tremble.Normal(), tremble.Normal(), tremble.Normal());
      tracked.positions.at(f, k) = Vector3d(tracked.positions.at(f - 1, k)) + step + per_axis * error;
    }
  }
}

std::string TrackText(const TrackedTake& tracked, const Vector3d& units_per_metre, double steps) {
  JointTable table;
  table.frames = tracked.positions.frames;
  table.rows_per_frame = tracked.positions.joints;
  table.columns = 4;
  for (int f = 0; f < table.frames; ++f) {
    for (int k = 0; k < table.rows_per_frame; ++k) {
      const bool seen = tracked.seen[static_cast<std::size_t>(f) * table.rows_per_frame + k] != 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double value = seen ? tracked.positions.at(f, k)[axis] * units_per_metre[axis] : 0.0;
        table.values.push_back(std::round(value * steps) / steps + 0.0);  // never -0
      }
      table.values.push_back(seen ? 1.0 : 0.0);
    }
  }
  return WriteJointTable(table);
}

}  // namespace mocurate
