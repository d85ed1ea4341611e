#include "train/data/training_clips.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "core/motion/kinematics.h"
#include "core/motion/preparation.h"
#include "train/recognisers/recogniser_input.h"

namespace mocurate {
namespace {

Expected<const Split*> FindTrainingSplit(const Dataset& dataset, const std::string& name) {
  if (name.empty()) return dataset.splits.empty() ? nullptr : &dataset.splits.front();
  if (const Split* split = dataset.FindSplit(name); split != nullptr) return split;
  std::string known;
  for (const Split& split : dataset.splits) known += (known.empty() ? "" : ", ") + split.name;
  return Fail(ErrorCode::kConfig, "the dataset has no split '" + name + "'", "split",
              known.empty() ? "it has none" : "it has: " + known);
}

Expected<std::vector<TrainingClip>> Take(const Dataset& dataset, const std::vector<int>& rows) {
  std::vector<TrainingClip> clips;
  for (const int row : rows) {
    const Clip& clip = dataset.clips.at(static_cast<std::size_t>(row));
    const int label = dataset.LabelIndex(clip.label);
    if (!clip.motion || clip.motion->frame_count() < 1 || label < 0) {
      return Fail(ErrorCode::kInconsistent, "the clip has no motion or no label of the dataset", clip.id(),
                  "leave it out of the split or label it");
    }
    clips.push_back({&clip, label});
  }
  return clips;
}

// Moves the held-out clips of a training part to its validation part.
void HoldOut(std::uint64_t seed, double fraction, TrainingClips& clips) {
  std::set<std::string> persons;
  for (const TrainingClip& clip : clips.train) persons.insert(clip.clip->identity.person);
  Random random(seed, "train.validation");
  std::vector<TrainingClip> kept;
  if (persons.size() >= 3) {
    const std::string chosen = *std::next(persons.begin(), static_cast<std::ptrdiff_t>(random.Below(persons.size())));
    clips.validation_rule = "all clips of the training person '" + chosen + "'";
    for (const TrainingClip& clip : clips.train) {
      (clip.clip->identity.person == chosen ? clips.validation : kept).push_back(clip);
    }
  } else {
    const int count = static_cast<int>(clips.train.size());
    const int held = std::max(1, static_cast<int>(fraction * count));
    const std::vector<int> order = ShuffledOrder(count, random);
    const std::set<int> chosen(order.begin(), order.begin() + std::min(held, count - 1));
    clips.validation_rule = std::to_string(chosen.size()) + " training clips drawn at random";
    for (int i = 0; i < count; ++i) (chosen.count(i) > 0 ? clips.validation : kept).push_back(clips.train[i]);
  }
  clips.train = std::move(kept);
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

Expected<TrainingClips> SelectTrainingClips(const Dataset& dataset, const std::string& split, bool all, bool held_out,
                                            std::uint64_t seed, double smallest_validation) {
  const Expected<const Split*> found = FindTrainingSplit(dataset, split);
  if (!found) return Forward(found);
  TrainingClips clips;
  std::vector<int> rows(dataset.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (!all && *found != nullptr) {
    rows = (*found)->train;
    clips.split = (*found)->name;
  }
  Expected<std::vector<TrainingClip>> train = Take(dataset, rows);
  if (!train) return Forward(train);
  clips.train = std::move(*train);
  if (clips.train.size() < 2) {
    return Fail(ErrorCode::kInconsistent, std::to_string(clips.train.size()) + " training clips; at least 2 are needed",
                clips.split.empty() ? "dataset" : "split '" + clips.split + "'");
  }
  if (held_out && !all && *found != nullptr && !(*found)->validation.empty()) {
    Expected<std::vector<TrainingClip>> validation = Take(dataset, (*found)->validation);
    if (!validation) return Forward(validation);
    clips.validation = std::move(*validation);
    clips.validation_rule = "validation part of split '" + clips.split + "'";
  } else if (held_out) {
    HoldOut(seed, smallest_validation, clips);
  }
  return clips;
}

GruRecogniserBatch MakeRecogniserBatch(const RecogniserOptions& options, const std::vector<TrainingClip>& clips,
                                       const std::vector<int>& rows, std::int64_t pass, bool augment) {
  const int T = static_cast<int>(options.frames), B = static_cast<int>(rows.size());
  GruRecogniserBatch batch;
  batch.batch = B;
  batch.frames = T;
  for (int b = 0; b < B; ++b) {
    const TrainingClip& item = clips[static_cast<std::size_t>(rows[b])];
    const Motion& motion = *item.clip->motion;
    const int dim = 3 * motion.joint_count();
    Random random(static_cast<std::uint64_t>(options.seed), augment ? "recogniser.clip" : "recogniser.validation",
                  item.clip->id() + "/" + std::to_string(pass));
    std::vector<float> input;
    if (augment) {
      Motion bent;
      bent.skeleton = motion.skeleton;
      bent.rate = motion.rate;
      bent.joints = AugmentTime(options.augmentation, motion.joints, random);
      input = RecogniserInput(bent, options.input, T, random);
      AugmentSpace(options.augmentation, *motion.skeleton, T, random, input);
    } else {
      input = RecogniserInput(motion, options.input, T, random);
    }
    if (batch.motion.empty()) batch.motion.resize(static_cast<std::size_t>(T) * B * dim);
    for (int t = 0; t < T; ++t) {
      std::copy(input.begin() + static_cast<std::ptrdiff_t>(t) * dim,
                input.begin() + static_cast<std::ptrdiff_t>(t + 1) * dim,
                batch.motion.begin() + (static_cast<std::ptrdiff_t>(t) * B + b) * dim);
    }
  }
  return batch;
}

Action2MotionBatch MakeGeneratorBatch(const GeneratorOptions& options, const Action2MotionConfig& config,
                                      double self_feed_probability, const std::vector<TrainingClip>& clips,
                                      const std::vector<int>& rows, std::int64_t iteration) {
  const int T = static_cast<int>(options.frames), B = static_cast<int>(rows.size()), D = config.pose();
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  const LastStart last = options.include_last_start ? LastStart::kIncluded : LastStart::kExcluded;
  Action2MotionBatch batch;
  batch.batch = B;
  batch.frames = T;
  batch.motion.resize(static_cast<std::size_t>(T) * B * D);
  Random random(seed, "generator.step", std::to_string(iteration));
  batch.self_feed = random.Uniform() < self_feed_probability;
  for (int b = 0; b < B; ++b) {
    const TrainingClip& item = clips[static_cast<std::size_t>(rows[b])];
    const JointPositions bent = AugmentTime(options.augmentation, item.clip->motion->joints, random);
    std::vector<float> input;
    if (options.input == RecogniserInputKind::kResample) {
      const Motion& motion = *item.clip->motion;
      input = RecogniserInput(MakeJointsOnly(motion.skeleton, motion.rate, bent), options.input, T, random);
    } else {
      const Window window = DrawWindow(bent.frames, T, last, random);
      const std::vector<double> values = PrepareWindow(bent, window, T, true);
      input.assign(values.begin(), values.end());
    }
    AugmentSpace(options.augmentation, *item.clip->motion->skeleton, T, random, input);
    for (int t = 0; t < T; ++t) {
      std::copy(input.begin() + static_cast<std::ptrdiff_t>(t) * D,
                input.begin() + static_cast<std::ptrdiff_t>(t + 1) * D,
                batch.motion.begin() + (static_cast<std::ptrdiff_t>(t) * B + b) * D);
    }
    batch.label.push_back(item.label);
  }
  batch.noise.resize(static_cast<std::size_t>(T) * B * config.latent);
  for (float& value : batch.noise) value = static_cast<float>(random.Normal());
  return batch;
}

LieChains ChainsOf(const Skeleton& skeleton) {
  if (skeleton.lie) return *skeleton.lie;
  LieChains chains;
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<std::pair<int, int>> starts;  // where a chain leaves, and its first joint
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
