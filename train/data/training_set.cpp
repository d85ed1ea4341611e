#include "train/data/training_set.h"

#include "core/store/dataset_clips.h"

namespace mocurate {
namespace {

void Append(const Clip& clip, TrainingSet& set) {
  TrainingSet::Clip packed;
  packed.id = clip.id();
  packed.person = clip.identity.person;
  for (std::size_t i = 0; i < set.labels.size(); ++i) {
    if (set.labels[i] == clip.label) packed.label = static_cast<int>(i);
  }
  if (set.clips.empty()) set.rate = clip.motion ? clip.motion->rate : clip.rate;
  if (clip.motion) {
    const JointPositions& joints = clip.motion->joints;
    packed.first = set.joints.size() / (3 * static_cast<std::size_t>(set.skeleton->joint_count()));
    packed.frames = joints.frames;
    set.joints.insert(set.joints.end(), joints.xyz.begin(), joints.xyz.end());
  }
  set.clips.push_back(std::move(packed));
}

}  // namespace

JointPositions TrainingSet::Joints(std::size_t clip) const {
  const int J = skeleton->joint_count();
  JointPositions positions(clips[clip].frames, J);
  const std::size_t first = clips[clip].first * 3 * static_cast<std::size_t>(J);
  for (std::size_t i = 0; i < positions.xyz.size(); ++i) positions.xyz[i] = joints[first + i];
  return positions;
}

Expected<TrainingSet> ReadTrainingSet(const std::filesystem::path& path) {
  const Expected<DatasetClips> file = DatasetClips::Open(path, DatasetClips::Check::kHashes);
  if (!file) return Forward(file);
  TrainingSet set;
  set.skeleton = file->skeleton();
  set.labels = file->labels();
  set.splits = file->splits();
  for (std::size_t row = 0; row < file->size(); ++row) {
    const Expected<Clip> clip = file->Read(row);
    if (!clip) return Forward(clip);
    Append(*clip, set);
  }
  return set;
}

TrainingSet PackTrainingSet(const Dataset& dataset) {
  TrainingSet set;
  set.skeleton = dataset.skeleton;
  set.labels = dataset.labels;
  set.splits = dataset.splits;
  for (const Clip& clip : dataset.clips) Append(clip, set);
  return set;
}

}  // namespace mocurate
