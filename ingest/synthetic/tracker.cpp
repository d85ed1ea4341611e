#include "ingest/synthetic/tracker.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/formats/joint_table.h"

namespace mocurate {
namespace {

constexpr double kMillimetres = 1000.0;
constexpr double kLostFrames = 4.0;       // mean length of a gap
constexpr double kNearestOutlier = 0.15;  // metres
constexpr double kFarthestOutlier = 0.50;
constexpr double kSwapsPerOutlierShare = 10.0;  // chance of a clip that limbs are exchanged once
constexpr int kSwapFrames = 2;

/// Rounded to a tenth of a millimetre, never -0.
double Written(double metres) { return std::round(metres * kMillimetres * 10.0) / 10.0 + 0.0; }

Vector3d RandomDirection(Random& random) {
  Vector3d direction;
  do {
    direction = Vector3d(random.Normal(), random.Normal(), random.Normal());
  } while (direction.norm() < 1e-6);
  return direction.normalized();
}

/// Joints lost for some frames on end: a two-state chain whose long-run share is `share`.
std::vector<bool> LostSamples(int frames, std::size_t joints, double share, Random& random) {
  std::vector<bool> lost(static_cast<std::size_t>(frames) * joints, false);
  if (share <= 0.0) return lost;
  const double found_again = 1.0 / kLostFrames;
  const double gets_lost = std::min(1.0, found_again * share / (1.0 - share));
  for (std::size_t k = 0; k < joints; ++k) {
    bool is_lost = random.Uniform() < share;
    for (int f = 0; f < frames; ++f) {
      lost[static_cast<std::size_t>(f) * joints + k] = is_lost;
      is_lost = is_lost ? random.Uniform() >= found_again : random.Uniform() < gets_lost;
    }
  }
  return lost;
}

/// Which joint each listed joint is taken for in a frame: itself, or its partner while limbs are exchanged.
class Exchange {
 public:
  Exchange(const Skeleton& skeleton, int frames, double chance, Random& random) : skeleton_(skeleton) {
    const bool happens = random.Uniform() < chance;
    begin_ = static_cast<int>(random.Below(static_cast<std::uint64_t>(frames)));
    arms_ = random.Uniform() < 0.5;
    end_ = happens ? begin_ + kSwapFrames : begin_;
  }
  int Seen(int frame, int joint) const {
    if (frame < begin_ || frame >= end_ || skeleton_.joints[joint].mirror < 0) return joint;
    const std::string& name = skeleton_.joints[joint].name;
    const auto has = [&](const char* word) { return name.find(word) != std::string::npos; };
    const bool exchanged =
        arms_ ? has("elbow") || has("wrist") || has("hand") : has("knee") || has("ankle") || has("foot");
    return exchanged ? skeleton_.joints[joint].mirror : joint;
  }

 private:
  const Skeleton& skeleton_;
  int begin_ = 0;
  int end_ = 0;
  bool arms_ = false;
};

}  // namespace

const std::vector<std::string>& TrackedJoints() {
  static const std::vector<std::string> joints = {
      "head",        "shoulder_center", "spine",      "hip_center", "right_shoulder", "right_elbow", "right_wrist",
      "right_hand",  "left_shoulder",   "left_elbow", "left_wrist", "left_hand",      "right_hip",   "right_knee",
      "right_ankle", "right_foot",      "left_hip",   "left_knee",  "left_ankle",     "left_foot"};
  return joints;
}

std::string TrackText(const Motion& truth, const SyntheticOptions& options, const std::string& item) {
  const Skeleton& skeleton = *truth.skeleton;
  const std::vector<std::string>& names = TrackedJoints();
  const auto seed = static_cast<std::uint64_t>(options.seed);
  Random noise(seed, "studio.noise", item);
  Random gross(seed, "studio.outlier", item);
  Random hidden(seed, "studio.dropout", item);
  Random swap(seed, "studio.swap", item);
  const double per_axis = options.noise / std::sqrt(3.0);
  const std::vector<bool> lost = LostSamples(truth.frame_count(), names.size(), options.dropout_share, hidden);
  const Exchange exchange(skeleton, truth.frame_count(), kSwapsPerOutlierShare * options.outlier_share, swap);

  JointTable table;
  table.frames = truth.frame_count();
  table.rows_per_frame = static_cast<int>(names.size());
  table.columns = 4;
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      const int joint = exchange.Seen(f, skeleton.FindJoint(names[k]).value_or(0));
      Vector3d position = truth.joints.at(f, joint);
      position += per_axis * Vector3d(noise.Normal(), noise.Normal(), noise.Normal());
      const bool wrong = gross.Uniform() < options.outlier_share;
      const Vector3d error = gross.Uniform(kNearestOutlier, kFarthestOutlier) * RandomDirection(gross);
      if (wrong) position += error;
      if (lost[static_cast<std::size_t>(f) * names.size() + k]) {
        table.values.insert(table.values.end(), 4, 0.0);
        continue;
      }
      table.values.insert(table.values.end(),
                          {Written(position.x()), Written(position.y()), Written(-position.z()), 1.0});
    }
  }
  return WriteJointTable(table);
}

}  // namespace mocurate
