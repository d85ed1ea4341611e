#include "train/data/batches.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>
#include <utility>

#include "core/motion/kinematics.h"
#include "core/motion/preparation.h"
#include "train/recognisers/recogniser_input.h"

namespace mocurate {
namespace {

Expected<const Split*> FindTrainingSplit(const TrainingSet& set, const std::string& name) {
  if (name.empty()) return set.splits.empty() ? nullptr : &set.splits.front();
  std::string known;
  for (const Split& split : set.splits) {
    if (split.name == name) return &split;
    known += (known.empty() ? "" : ", ") + split.name;
  }
  return Fail(ErrorCode::kConfig, "the dataset has no split '" + name + "'", "split",
              known.empty() ? "it has none" : "it has: " + known);
}

Status CheckRows(const TrainingSet& set, const std::vector<int>& rows) {
  for (const int row : rows) {
    const TrainingSet::Clip& clip = set.clips.at(static_cast<std::size_t>(row));
    if (clip.frames < 1 || clip.label < 0) {
      return Fail(ErrorCode::kInconsistent, "the clip has no motion or no label of the dataset", clip.id,
                  "remove it from the split, or label it");
    }
  }
  return {};
}

// Moves the held-out clips of a training part to its validation part.
void HoldOut(const TrainingSet& set, std::uint64_t seed, double fraction, TrainingRows& rows) {
  const auto person = [&](int row) { return set.clips[static_cast<std::size_t>(row)].person; };
  std::set<std::string> persons;
  for (const int row : rows.train) persons.insert(person(row));
  Random random(seed, "train.validation");
  std::vector<int> kept;
  if (persons.size() >= 3) {
    const std::string chosen = *std::next(persons.begin(), static_cast<std::ptrdiff_t>(random.Below(persons.size())));
    rows.validation_rule = "all clips of the training person '" + chosen + "'";
    for (const int row : rows.train) (person(row) == chosen ? rows.validation : kept).push_back(row);
  } else {
    const int count = static_cast<int>(rows.train.size());
    const int held = std::max(1, static_cast<int>(fraction * count));
    const std::vector<int> order = ShuffledOrder(count, random);
    const std::set<int> chosen(order.begin(), order.begin() + std::min(held, count - 1));
    rows.validation_rule = std::to_string(chosen.size()) + " training clips drawn at random";
    for (int i = 0; i < count; ++i) (chosen.count(i) > 0 ? rows.validation : kept).push_back(rows.train[i]);
  }
  rows.train = std::move(kept);
}

// The first clips of each class in an order independent of options, so that smaller fractions are subsets of larger
// ones.
std::vector<int> FractionOf(const TrainingSet& set, const std::vector<int>& rows, double fraction) {
  if (fraction >= 1.0) return rows;
  std::vector<std::vector<int>> by_class(set.labels.size());
  for (const int row : rows)
    by_class[static_cast<std::size_t>(set.clips[static_cast<std::size_t>(row)].label)].push_back(row);
  std::vector<int> chosen;
  for (std::size_t c = 0; c < by_class.size(); ++c) {
    const int count = static_cast<int>(by_class[c].size());
    const std::vector<int> order = ShuffledOrder(count, Random(0, "train.fraction", set.labels[c]));
    const auto take = static_cast<std::size_t>(std::ceil(fraction * count));
    for (std::size_t i = 0; i < take; ++i) chosen.push_back(by_class[c][static_cast<std::size_t>(order[i])]);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<float> WindowOf(const Motion& motion, const TrainingDataOptions& options, Random& random) {
  const int T = static_cast<int>(options.frames);
  if (options.input != RecogniserInputKind::kCrop) return RecogniserInput(motion, options.input, T, random);
  const LastStart last = options.include_last_start ? LastStart::kIncluded : LastStart::kExcluded;
  const std::vector<double> values =
      PrepareWindow(motion.joints, DrawWindow(motion.joints.frames, T, last, random), T, true);
  return std::vector<float>(values.begin(), values.end());
}

/// Length of a window: `frames` by Action2Motion's rule, or a random one up to `longest_frames` by ACTOR's
/// (a2m_actor.md A.7, C.7).
std::vector<int> WindowFrames(int frame_count, const TrainingDataOptions& options, Random& random) {
  const int T = static_cast<int>(options.frames);
  if (options.input == RecogniserInputKind::kWhole) {
    std::vector<int> whole(static_cast<std::size_t>(std::min(T, frame_count)));
    std::iota(whole.begin(), whole.end(), 0);
    return whole;
  }
  if (options.longest_frames > 0) return SampleFrames(T, static_cast<int>(options.longest_frames), frame_count, random);
  const LastStart last = options.include_last_start ? LastStart::kIncluded : LastStart::kExcluded;
  const int start = DrawWindow(frame_count, T, last, random).start;
  std::vector<int> frames;
  for (int t = 0; t < T; ++t) frames.push_back(std::min(start + t, frame_count - 1));
  return frames;
}

/// Windows with rotations; shorter ones end in zeros.
MotionRows RowsWithRotations(const TrainingSet& set, const TrainingDataOptions& options, const std::vector<int>& rows,
                             std::uint64_t seed, const std::string& key) {
  const std::size_t B = rows.size(), J = static_cast<std::size_t>(set.skeleton->joint_count());
  std::vector<std::vector<int>> windows;
  std::size_t T = 0;
  for (std::size_t b = 0; b < B; ++b) {
    Random random(seed, "train.window", key + "/" + std::to_string(b));
    windows.push_back(WindowFrames(set.clips[static_cast<std::size_t>(rows[b])].frames, options, random));
    T = std::max(T, windows.back().size());
  }
  MotionRows batch;
  batch.frames = static_cast<int>(T);
  batch.motion.assign(T * B * 3 * J, 0.0f);
  batch.rotation.assign(T * B * 9 * J, 0.0f);
  for (std::size_t b = 0; b < B; ++b) {
    const TrainingSet::Clip& clip = set.clips[static_cast<std::size_t>(rows[b])];
    batch.label.push_back(clip.label);
    batch.length.push_back(static_cast<int>(windows[b].size()));
    const float* root = set.joints.data() + (clip.first + static_cast<std::size_t>(windows[b][0])) * 3 * J;
    for (std::size_t t = 0; t < windows[b].size(); ++t) {
      const std::size_t frame = clip.first + static_cast<std::size_t>(windows[b][t]);
      const float* joints = set.joints.data() + frame * 3 * J;
      const float* rotation = set.rotation.data() + frame * 4 * J;
      float* motion = batch.motion.data() + (t * B + b) * 3 * J;
      for (std::size_t k = 0; k < 3 * J; ++k) motion[k] = joints[k] - root[k % 3];
      for (std::size_t j = 0; j < J; ++j) {
        const float* q = rotation + 4 * j;
        Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> matrix(batch.rotation.data() +
                                                                       ((t * B + b) * J + j) * 9);
        matrix = Eigen::Quaternionf(q[0], q[1], q[2], q[3]).toRotationMatrix();
      }
    }
  }
  const bool whole =
      std::all_of(batch.length.begin(), batch.length.end(), [&](int length) { return length == batch.frames; });
  if (whole) batch.length.clear();
  return batch;
}

/// Number of recorded clips in a mixed batch, for `rows` recorded clips.
std::int64_t RecordedOf(std::int64_t batch, double made_share, std::size_t rows) {
  const auto made = std::clamp<std::int64_t>(std::lround(made_share * static_cast<double>(batch)), 1,
                                             std::max<std::int64_t>(1, batch - 1));
  return std::clamp<std::int64_t>(batch - made, 1, std::max<std::int64_t>(1, static_cast<std::int64_t>(rows)));
}

}  // namespace

std::vector<int> ShuffledOrder(int count, Random random) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  for (int i = count - 1; i > 0; --i) {
    std::swap(order[i], order[static_cast<std::size_t>(random.Below(static_cast<std::uint64_t>(i) + 1))]);
  }
  return order;
}

Expected<TrainingRows> SelectTrainingRows(const TrainingSet& set, const TrainingDataOptions& options, bool held_out,
                                          std::uint64_t seed, double smallest_validation) {
  const Expected<const Split*> found = FindTrainingSplit(set, options.split);
  if (!found) return Forward(found);
  const Split* split = options.all_clips ? nullptr : *found;
  TrainingRows rows;
  rows.train.resize(set.clips.size() - set.made.size());
  std::iota(rows.train.begin(), rows.train.end(), 0);
  if (split != nullptr) {
    rows.train = split->train;
    rows.split = split->name;
  }
  if (Status whole = CheckRows(set, rows.train); !whole) return Forward(whole);
  rows.train =
      FractionOf(set, rows.train, options.fraction);  // before clips are held out, because a refit uses those again
  if (held_out && split != nullptr && !split->validation.empty()) {
    if (Status whole = CheckRows(set, split->validation); !whole) return Forward(whole);
    rows.validation = FractionOf(set, split->validation, options.fraction);
    rows.validation_rule = "validation part of split '" + rows.split + "'";
  } else if (held_out && rows.train.size() >= 2) {
    HoldOut(set, seed, smallest_validation, rows);
  }
  if (rows.train.size() >= 2 || (held_out && !rows.train.empty() && !rows.validation.empty())) return rows;
  return Fail(ErrorCode::kInconsistent, std::to_string(rows.train.size()) + " training clips; at least 2 are required",
              rows.split.empty() ? "dataset" : "split '" + rows.split + "'");
}

BatchOrder::BatchOrder(const TrainingSet& set, const TrainingDataOptions& options, std::vector<int> rows,
                       std::int64_t batch, bool keep_last, std::uint64_t seed, std::string purpose)
    : rows_(std::move(rows)), seed_(seed), purpose_(std::move(purpose)) {
  const auto count = static_cast<std::int64_t>(rows_.size());
  batch_ = std::min(batch, count);
  per_pass_ = keep_last ? (count + batch_ - 1) / batch_ : count / batch_;
  if (!options.balance) return;
  std::vector<std::vector<int>> by_class(set.labels.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    by_class[static_cast<std::size_t>(set.clips[static_cast<std::size_t>(rows_[i])].label)].push_back(
        static_cast<int>(i));
  }
  for (std::vector<int>& positions : by_class) {
    if (!positions.empty()) by_class_.push_back(std::move(positions));
  }
}

std::vector<int> BatchOrder::PassOf(std::int64_t pass) const {
  const int count = static_cast<int>(rows_.size());
  const std::vector<int> order = ShuffledOrder(count, Random(seed_, purpose_, std::to_string(pass)));
  if (by_class_.empty()) return order;
  std::vector<std::vector<int>> shuffled;
  for (std::size_t c = 0; c < by_class_.size(); ++c) {
    const std::string key = std::to_string(pass) + "/" + std::to_string(c);
    std::vector<int> positions;
    for (const int i : ShuffledOrder(static_cast<int>(by_class_[c].size()), Random(seed_, "train.balance", key))) {
      positions.push_back(by_class_[c][static_cast<std::size_t>(i)]);
    }
    shuffled.push_back(std::move(positions));
  }
  std::vector<int> balanced(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::vector<int>& positions = shuffled[k % shuffled.size()];
    balanced[static_cast<std::size_t>(order[k])] = positions[k / shuffled.size() % positions.size()];
  }
  return balanced;
}

std::vector<int> BatchOrder::RowsOf(std::int64_t step) const {
  if (const std::int64_t pass = step / per_pass_; pass != pass_) {
    order_ = PassOf(pass);
    pass_ = pass;
  }
  const auto begin = static_cast<std::size_t>((step % per_pass_) * batch_);
  std::vector<int> rows;
  for (std::size_t i = begin; i < std::min(order_.size(), begin + static_cast<std::size_t>(batch_)); ++i) {
    rows.push_back(rows_[static_cast<std::size_t>(order_[i])]);
  }
  return rows;
}

std::vector<int> MadeWithout(const TrainingSet& set, const std::vector<int>& held_out) {
  const auto recording = [&](int row) { return RecordingOf(set.clips[static_cast<std::size_t>(row)].id); };
  std::set<std::string> held;
  for (const int row : held_out) held.insert(recording(row));
  std::vector<int> made;
  std::copy_if(set.made.begin(), set.made.end(), std::back_inserter(made),
               [&](int row) { return held.count(recording(row)) == 0; });
  return made;
}

MixedOrder::MixedOrder(const TrainingSet& set, const TrainingDataOptions& options, std::vector<int> rows,
                       std::vector<int> made, std::int64_t batch, bool keep_last, double made_share, std::uint64_t seed)
    : recorded_(set, options, rows, made.empty() ? batch : RecordedOf(batch, made_share, rows.size()),
                keep_last && made.empty(), seed) {
  if (made.empty()) return;
  const auto recorded = static_cast<double>(RecordedOf(batch, made_share, rows.size()));
  const auto count = std::max<std::int64_t>(1, std::lround(recorded * made_share / (1.0 - made_share)));
  made_.emplace(set, options, std::move(made), std::min(count, std::max<std::int64_t>(1, batch - 1)), false, seed,
                "train.order.made");
}

std::vector<int> MixedOrder::RowsOf(std::int64_t step) const {
  std::vector<int> rows = recorded_.RowsOf(step);
  if (!made_) return rows;
  const std::vector<int> made = made_->RowsOf(step);
  rows.insert(rows.end(), made.begin(), made.end());
  return rows;
}

MotionRows MakeMotionRows(const TrainingSet& set, const TrainingDataOptions& options, const std::vector<int>& rows,
                          std::uint64_t seed, const std::string& key, bool augment) {
  if (!set.rotation.empty()) return RowsWithRotations(set, options, rows, seed, key);
  const std::size_t T = static_cast<std::size_t>(options.frames), B = rows.size();
  const std::size_t D = 3 * static_cast<std::size_t>(set.skeleton->joint_count());
  MotionRows batch;
  batch.frames = static_cast<int>(T);
  batch.motion.resize(T * B * D);
  for (std::size_t b = 0; b < B; ++b) {
    const auto row = static_cast<std::size_t>(rows[b]);
    Random random(seed, "train.window", key + "/" + std::to_string(b));
    JointPositions joints = set.Joints(row);
    if (augment) joints = AugmentTime(options.augmentation, joints, random);
    std::vector<float> window = WindowOf(MakeJointsOnly(set.skeleton, set.rate, std::move(joints)), options, random);
    if (augment) AugmentSpace(options.augmentation, *set.skeleton, static_cast<int>(T), random, window);
    for (std::size_t t = 0; t < T; ++t) {
      std::copy_n(window.begin() + static_cast<std::ptrdiff_t>(t * D), D,
                  batch.motion.begin() + static_cast<std::ptrdiff_t>((t * B + b) * D));
    }
    batch.label.push_back(set.clips[row].label);
    if (options.input == RecogniserInputKind::kWhole) {
      batch.length.push_back(std::min(set.clips[row].frames, static_cast<int>(T)));
    }
  }
  return batch;
}

LieChains ChainsOf(const Skeleton& skeleton) {
  if (skeleton.lie) return *skeleton.lie;
  LieChains chains;
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<std::pair<int, int>> starts;  // where a chain starts, and its first joint
  for (const int child : children[0]) starts.emplace_back(0, child);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    std::vector<int> chain = {starts[i].first};
    for (int joint = starts[i].second; joint >= 0;) {
      chain.push_back(joint);
      const std::vector<int>& next = children[static_cast<std::size_t>(joint)];
      for (std::size_t k = 1; k < next.size(); ++k) starts.emplace_back(joint, next[k]);
      joint = next.empty() ? -1 : next.front();
    }
    chains.chains.push_back(std::move(chain));
  }
  for (const Joint& joint : skeleton.joints) {
    const double length = joint.rest_offset.norm();
    chains.raw_offsets.push_back(joint.parent < 0 ? Vector3d(0, 0, 0)
                                 : length > 1e-9  ? Vector3d(joint.rest_offset / length)
                                                  : Vector3d(0, 1, 0));
  }
  return chains;
}

}  // namespace mocurate
