#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/motion/clip.h"
#include "core/store/feature_file.h"
#include "eval/features/motion_input.h"
#include "train/recognisers/recogniser.h"

namespace mocurate {

/// A recogniser and how motions become what it reads.
struct Extractor {
  ExtractorOptions options;
  InputRules rules;
  std::unique_ptr<Recogniser> recogniser;

  /// Of a checkpoint of ours, which says everything itself, or of published weights as `options` declare them.
  /// `weights` is the file. Errors of Recogniser::Load; kInconsistent where the network reads another number of joints
  /// or has another number of classes than declared; kUnsupported for a network or values that are not built in.
  static Expected<Extractor> Open(const ExtractorOptions& options, const std::filesystem::path& weights);
};

/// Class index of a label for an extractor: by name (case, blanks, '_' and '-' do not count), else a whole number is
/// the index itself; empty for a label that the extractor lacks.
std::optional<int> ClassOf(const std::vector<std::string>& classes, const std::string& label);

/// How a set of motions is read in one pass.
struct PassOptions {
  RootRule root = RootRule::kAsGiven;
  double yaw_rad = 0.0;  ///< by which motions are turned about the vertical
  CropStart start = CropStart::kFirst;
  InitialHidden hidden = InitialHidden::kZero;
  std::uint64_t seed = 0;  ///< of crops and hidden states, by the position of the motion
  int threads = 1;
};

/// Features and logits of motions in one pass, appended to `set` as a pass of its own. `labels` are class indices.
/// Errors of JointsFor; kInconsistent naming the clip whose joints are not finite.
Status AppendFeatures(const Extractor& extractor, const std::vector<const Motion*>& motions,
                      const std::vector<int>& labels, const std::vector<std::string>& clips, const PassOptions& pass,
                      FeatureSet& set);

/// Refuses a set that is plainly in another frame or unit than declared: where, in the median of its motions, the head
/// (neck, else the highest of the trunk) lies below the feet, or bones are more than `largest_scale` times as long or
/// as short as the rest pose's. Error kInconsistent with value, rule and way out.
Status CheckFrameOfSet(const std::vector<const Motion*>& motions, double largest_scale = 1.5);

}  // namespace mocurate
