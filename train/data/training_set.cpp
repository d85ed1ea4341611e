#include "train/data/training_set.h"

#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/base/median.h"
#include "core/base/text.h"
#include "core/motion/gaps.h"
#include "core/motion/operations.h"
#include "core/store/dataset_clips.h"

namespace mocurate {
namespace {

void AppendRotations(const Motion& motion, TrainingSet& set) {
  for (const Quaterniond& q : motion.rotation) {
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) set.rotation.push_back(static_cast<float>(value));
  }
}

/// Index of a word, which is appended where it is new.
int WordOf(const std::string& word, std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) words.push_back(word);
  return static_cast<int>(found == words.end() ? words.size() - 1 : static_cast<std::size_t>(found - words.begin()));
}

/// Sorts the words after the classes and "transition" by name, so that the order of clips does not matter.
void SortWords(TrainingSet& set) {
  const std::size_t fixed = set.labels.size() + 1;
  if (set.words.size() <= fixed) return;
  const std::vector<std::string> unsorted = set.words;
  std::sort(set.words.begin() + static_cast<std::ptrdiff_t>(fixed), set.words.end());
  for (TrainingSet::Clip& clip : set.clips) {
    for (int& word : clip.word) {
      if (word >= static_cast<int>(fixed)) word = WordOf(unsorted[static_cast<std::size_t>(word)], set.words);
    }
  }
}

/// Collects the clips of a set one by one.
class Packing {
 public:
  Packing(const TrainingSetNeeds& needs, TrainingSet& set) : needs_(needs), set_(set) {
    if (!needs.parts) return;
    set.words = set.labels;
    set.words.emplace_back("transition");
  }

  /// `where`: the file, for errors.
  Status Add(const Clip& given, const std::string& where) {
    if (!needs_.whole && given.motion && IsAllInferred(*given.motion)) {
      ++set_.inferred.skipped;
      set_.inferred.frames += given.motion->frame_count();
      new_row_.push_back(-1);
      return {};
    }
    new_row_.push_back(static_cast<int>(set_.clips.size()));
    const auto shorter = needs_.whole ? Expected<std::optional<Clip>>(std::nullopt) : WithoutInferred(given);
    if (!shorter) return Forward(shorter);
    const Clip& clip = *shorter ? **shorter : given;
    if (*shorter) {
      ++set_.inferred.shortened;
      set_.inferred.frames += given.motion->frame_count() - clip.motion->frame_count();
    }
    TrainingSet::Clip packed;
    packed.id = given.id();
    packed.person = clip.identity.person;
    for (std::size_t i = 0; i < set_.labels.size(); ++i) {
      if (set_.labels[i] == clip.label) packed.label = static_cast<int>(i);
    }
    packed.canonical_from_source = clip.canonical_from_source;
    if (set_.clips.empty()) set_.rate = clip.motion ? clip.motion->rate : clip.rate;
    if (!clip.motion) {
      set_.clips.push_back(std::move(packed));
      return {};
    }
    if (needs_.rotations && clip.motion->joints_only()) {
      return Fail(ErrorCode::kInconsistent, "clip '" + clip.id() + "' has joints only, the network needs rotations",
                  where, "fit the clips (fitting.method), or choose a network of joints (actor: pose: joints)");
    }
    if (needs_.parts || needs_.part != ClipPart::kWhole) {
      const auto parts = PartsOf(clip);
      if (!parts) return Forward(parts);
      if (needs_.parts && parts->frames[0] < 1) {
        return Fail(ErrorCode::kInconsistent, "the sample has no previous action", clip.id(),
                    "use samples of canon.trim.rule: triples");
      }
      packed.parts = parts->frames;
      if (needs_.parts) {  // the transition is always the same word
        packed.word = {WordOf(parts->label[0], set_.words), static_cast<int>(set_.labels.size()),
                       WordOf(parts->label[2], set_.words)};
      }
    }
    const Expected<Motion> motion = TakePart(clip, needs_.part);
    if (!motion) return Forward(motion);
    packed.first = set_.joints.size() / (3 * set_.skeleton->joints.size());
    packed.frames = motion->joints.frames;
    if (needs_.rotations) {
      for (const Joint& joint : motion->skeleton->joints) packed.rest_offset.push_back(joint.rest_offset);
    }
    set_.joints.insert(set_.joints.end(), motion->joints.xyz.begin(), motion->joints.xyz.end());
    set_.clips.push_back(std::move(packed));
    if (needs_.rotations) AppendRotations(*motion, set_);
    return {};
  }

  void Finish() {
    SortWords(set_);
    if (set_.inferred.skipped > 0) RenumberRows(new_row_, set_.splits);
  }

 private:
  const TrainingSetNeeds& needs_;
  TrainingSet& set_;
  std::vector<int> new_row_;  ///< of each clip of the dataset
};

}  // namespace

std::optional<Finding> InferredLoss::About() const {
  if (frames == 0) return std::nullopt;
  std::string message = Counted(frames, "frame") + " of " + Counted(shortened + skipped, "clip") +
                        " are left out: the longest stretch between gaps without an observation is trained on";
  if (skipped > 0) message += "; " + Counted(skipped, "clip") + " without any are skipped";
  return MakeFinding("inferred_frames", Severity::kWarning, frames, std::move(message), FindingAction::kDropped);
}

void RenumberRows(const std::vector<int>& new_row, std::vector<Split>& splits) {
  for (Split& split : splits) {
    for (std::vector<int>* part : {&split.train, &split.validation, &split.test}) {
      std::vector<int> kept;
      for (const int row : *part) {
        const int moved = new_row.at(static_cast<std::size_t>(row));
        if (moved >= 0) kept.push_back(moved);
      }
      *part = std::move(kept);
    }
  }
}

JointPositions TrainingSet::Joints(std::size_t clip) const {
  const int J = skeleton->joint_count();
  JointPositions positions(clips[clip].frames, J);
  const std::size_t first = clips[clip].first * 3 * static_cast<std::size_t>(J);
  for (std::size_t i = 0; i < positions.xyz.size(); ++i) positions.xyz[i] = joints[first + i];
  return positions;
}

std::vector<Vector3d> MedianRestOffsets(const TrainingSet& set, const std::vector<int>& rows) {
  std::vector<Vector3d> offsets(static_cast<std::size_t>(set.skeleton->joint_count()), Vector3d::Zero());
  for (std::size_t j = 1; j < offsets.size(); ++j) {
    for (int k = 0; k < 3; ++k) {
      std::vector<double> values;
      for (const int row : rows) {
        const TrainingSet::Clip& clip = set.clips[static_cast<std::size_t>(row)];
        if (!clip.rest_offset.empty()) values.push_back(clip.rest_offset[j][k]);
      }
      if (!values.empty()) offsets[j][k] = Median(std::move(values));
    }
  }
  return offsets;
}

std::vector<double> MedianBoneLengths(const TrainingSet& set, const std::vector<int>& rows) {
  const std::vector<int> parents = set.skeleton->lie ? set.skeleton->LieParents() : std::vector<int>();
  std::vector<double> lengths(static_cast<std::size_t>(set.skeleton->joint_count()), 0.0);
  for (std::size_t j = 1; j < lengths.size(); ++j) {
    const int parent = parents.empty() ? set.skeleton->joints[j].parent : parents[j];
    std::vector<double> values;
    for (const int row : rows) {
      const TrainingSet::Clip& clip = set.clips[static_cast<std::size_t>(row)];
      if (clip.frames == 0) continue;
      const float* frame = set.joints.data() + clip.first * 3 * lengths.size();
      const float *a = frame + 3 * j, *b = frame + 3 * static_cast<std::size_t>(parent);
      values.push_back(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    }
    if (values.empty()) continue;
    lengths[j] = Median(std::move(values));
  }
  return lengths;
}

std::vector<std::vector<double>> FirstPoses(const TrainingSet& set, const std::vector<int>& rows) {
  std::vector<std::vector<double>> poses(set.labels.size());
  const std::size_t width = 3 * static_cast<std::size_t>(set.skeleton->joint_count());
  for (const int row : rows) {
    const TrainingSet::Clip& clip = set.clips[static_cast<std::size_t>(row)];
    if (clip.frames == 0 || clip.label < 0 || !poses[static_cast<std::size_t>(clip.label)].empty()) continue;
    const float* frame = set.joints.data() + clip.first * width;
    std::vector<double>& pose = poses[static_cast<std::size_t>(clip.label)];
    for (std::size_t k = 0; k < width; ++k) pose.push_back(static_cast<double>(frame[k]) - frame[k % 3]);
  }
  return poses;
}

TrainingSetNeeds NeedsOf(const NetworkOptions& options) {
  return {options.NeedsRotations(), options.NeedsParts(), options.data.part};
}

Expected<TrainingSet> ReadTrainingSet(const std::filesystem::path& path, const TrainingSetNeeds& needs) {
  const Expected<DatasetClips> file = DatasetClips::Open(path, DatasetClips::Check::kHashes);
  if (!file) return Forward(file);
  TrainingSet set;
  set.skeleton = file->skeleton();
  set.labels = file->labels();
  set.splits = file->splits();
  Packing packing(needs, set);
  for (std::size_t row = 0; row < file->size(); ++row) {
    const Expected<Clip> clip = file->Read(row);
    if (!clip) return Forward(clip);
    if (Status added = packing.Add(*clip, DisplayPath(path)); !added) return Forward(added);
  }
  packing.Finish();
  return set;
}

Status AddMade(const TrainingSet& made, TrainingSet& set) {
  if (made.splits.empty() || made.labels != set.labels || !SameTree(*made.skeleton, *set.skeleton) ||
      made.rotation.empty() != set.rotation.empty()) {
    return Fail(ErrorCode::kInconsistent, "motions generated for another set cannot be mixed with this one", "made",
                "use a generator trained on the same set");
  }
  const std::size_t joints = set.skeleton->joints.size();
  const auto append = [](const std::vector<float>& from, std::size_t begin, std::size_t count, std::vector<float>& to) {
    const auto first = from.begin() + static_cast<std::ptrdiff_t>(begin);
    to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(count));
  };
  for (const int row : made.splits.front().train) {
    TrainingSet::Clip clip = made.clips[static_cast<std::size_t>(row)];
    const auto frames = static_cast<std::size_t>(clip.frames);
    const std::size_t first = set.joints.size() / (3 * joints);
    append(made.joints, 3 * joints * clip.first, 3 * joints * frames, set.joints);
    if (!made.rotation.empty()) append(made.rotation, 4 * joints * clip.first, 4 * joints * frames, set.rotation);
    clip.first = first;
    set.made.push_back(static_cast<int>(set.clips.size()));
    set.clips.push_back(std::move(clip));
  }
  return {};
}

Expected<TrainingSet> PackTrainingSet(const Dataset& dataset, const TrainingSetNeeds& needs) {
  TrainingSet set;
  set.skeleton = dataset.skeleton;
  set.labels = dataset.labels;
  set.splits = dataset.splits;
  Packing packing(needs, set);
  for (const Clip& clip : dataset.clips) {
    if (Status added = packing.Add(clip, "dataset"); !added) return Forward(added);
  }
  packing.Finish();
  return set;
}

}  // namespace mocurate
