#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/motion/clip.h"
#include "core/store/feature_file.h"
#include "eval/features/motion_input.h"
#include "train/recognisers/recogniser.h"

namespace mocurate {

/// A recogniser and the conversion of motions to its input.
struct Extractor {
  InputRules rules;
  std::unique_ptr<Recogniser> recogniser;

  /// From a checkpoint of mocurate, which contains all options, or from published weights with `options`. `weights` is
  /// the file. Errors of Recogniser::Load; kInconsistent where the network has another number of inputs or classes than
  /// declared; kUnsupported for a network or values that are not built in.
  static Expected<Extractor> Open(const ExtractorOptions& options, const std::filesystem::path& weights);
};

/// The class of that name, whose case, spaces, '_', '-' and '/' do not matter; nothing where there is none.
std::optional<int> ClassOfName(const std::vector<std::string>& classes, const std::string& label);

/// Class index of a label for an extractor: by name (ignoring case, blanks, '_' and '-'), else a whole number is the
/// index itself; empty for a label that the extractor lacks.
std::optional<int> ClassOf(const std::vector<std::string>& classes, const std::string& label);

/// Options of one pass over a set of motions.
struct PassOptions {
  RootRule root = RootRule::kAsGiven;
  double yaw_rad = 0.0;  ///< rotation of the motions about the vertical
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

/// Refuses a set that is clearly in another frame or unit than declared. In the median over its motions, the head
/// (neck, else the highest trunk joint) must not lie below the feet, and bones must be within a factor `largest_scale`
/// of the rest pose's. Error kInconsistent with value, rule and remedy.
Status CheckFrameOfSet(const std::vector<const Motion*>& motions, double largest_scale = 1.5);

}  // namespace mocurate
