#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/rigid.h"
#include "core/motion/action_parts.h"
#include "core/store/store.h"
#include "train/options.h"

namespace mocurate {

/// The clips of a dataset as networks read them: the joints of all frames packed as float32, one clip after the other.
struct TrainingSet {
  struct Clip {
    std::string id, person;
    int label = -1;              ///< class; -1: none
    std::size_t first = 0;       ///< its first frame in `joints`
    int frames = 0;              ///< 0: no motion
    std::array<int, 3> parts{};  ///< frames of previous action, transition, action; where parts, or one, are read
    std::array<int, 3> word{};   ///< their labels in `words`
    RigidTransform canonical_from_source;
  };
  SkeletonPtr skeleton;
  FrameRate rate;  ///< of the first clip
  std::vector<std::string> labels;
  std::vector<Split> splits;
  std::vector<Clip> clips;
  std::vector<float> joints;          ///< (frames of all clips, J, 3) metres
  std::vector<float> rotation;        ///< (frames of all clips, J, 4) parent_from_joint, w first; empty: not read
  std::vector<Vector3d> rest_offset;  ///< (J) of a usual person: the median over the clips; empty without rotations
  std::vector<std::string> words;     ///< labels of parts: the classes, "transition", the others by name
  std::vector<int> made;              ///< the last clips, which a network made: each batch has a share of them

  JointPositions Joints(std::size_t clip) const;
};

/// Median length of each bone in the first frames of the clips, along the chains of the skeleton (J): what motions are
/// laid out with when a request names no bones.
std::vector<double> MedianBoneLengths(const TrainingSet& set);

/// First frame of the first clip of each class, root at the origin: (3J) each, empty for a class without clips.
std::vector<std::vector<double>> FirstPoses(const TrainingSet& set);

/// What a network reads of a dataset.
struct TrainingSetNeeds {
  bool rotations = false;
  bool parts = false;                ///< the three parts of samples
  ClipPart part = ClipPart::kWhole;  ///< or one of them, as if it were the clip
};
TrainingSetNeeds NeedsOf(const NetworkOptions& options);

/// Reads the file clip by clip and checks its hashes. Errors of ReadDataset; kInconsistent naming a clip without
/// rotations or parts where they are asked for.
Expected<TrainingSet> ReadTrainingSet(const std::filesystem::path& path, const TrainingSetNeeds& needs = {});

/// The same of a dataset in memory.
Expected<TrainingSet> PackTrainingSet(const Dataset& dataset, const TrainingSetNeeds& needs = {});

/// Adds the training clips that a network made of a set's, to be mixed with it. Error kInconsistent for clips on
/// another skeleton or with other labels.
Status AddMade(const TrainingSet& made, TrainingSet& set);

}  // namespace mocurate
