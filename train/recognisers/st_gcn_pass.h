#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Adjacency of a tree of joints in three partitions, (3,V,V) row-major, columns divided by the number of neighbours:
/// itself; neighbours that are as far from joint 0 or farther; neighbours that are nearer. Distances beyond one bone
/// count as equal, as released (a2m_actor.md D.1, F33). `parents` (V), -1 where a joint has none.
std::vector<float> SpatialPartitions(const std::vector<int>& parents);

/// Parents of the tree without its root: joint v is joint v + 1 of the tree.
std::vector<int> WithoutRoot(std::vector<int> parents);

/// ST-GCN after training (a2m_actor.md D.1): norms folded into the layers before them. StGcn defines the layers.
class StGcnPass {
 public:
  /// `parents` of the whole tree; whether the root's rotation is read follows from the weights. Error kInconsistent
  /// where an array is missing or of another size.
  static Expected<StGcnPass> Make(const ParameterList& parameters, const std::vector<int>& parents,
                                  const std::string& where);

  int joints() const { return joints_; }
  int classes() const { return classes_; }
  int features() const { return features_; }

  /// One motion (frames, 6V), joint-major -> features (features()), logits (classes()).
  void Run(const float* motion, int frames, float* features, float* logits) const;

 private:
  struct Layer {
    int input = 0, output = 0, stride = 1;
    bool adds_input = false;
    std::vector<float> graph, graph_bias;        ///< (3 O,C), (3 O)
    std::vector<float> adjacency;                ///< (3,V,V) times the importance of edges
    std::vector<float> scale, shift;             ///< (O) of the first norm
    std::vector<float> time, time_bias;          ///< (O, C 9), (O), second norm folded in
    std::vector<float> residual, residual_bias;  ///< (O,C), (O), norm folded in; empty: none
  };
  int joints_ = 0, classes_ = 0, features_ = 0;
  std::vector<float> input_scale_, input_shift_;  ///< (6V)
  std::vector<Layer> layers_;
  std::vector<float> head_, head_bias_;
};

}  // namespace mocurate
