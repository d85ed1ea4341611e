#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

inline constexpr double kNotMeasured = -1.0;

/// Outputs of a recogniser for a set of motions: N motions, D features, C classes, row-major. A set may hold several
/// passes, each over draws of its own; rows of pass p are [pass_begin[p], pass_begin[p + 1]).
struct FeatureSet {
  int feature_size = 0;              ///< D
  std::vector<float> features;       ///< (N,D)
  std::vector<float> logits;         ///< (N,C)
  std::vector<int> label;            ///< (N) class index of the extractor, or -1
  std::vector<std::string> clip;     ///< (N) clip ids
  std::vector<std::string> classes;  ///< (C)
  std::vector<std::int64_t> pass_begin;
  /// (N) each, by name: measures of the motions themselves, without the network ("foot_skate", "jerk", ...), 0 or more;
  /// kNotMeasured where it is undefined (limits without rotations, a floor without foot contact).
  std::map<std::string, std::vector<double>> quality;
  std::string about;  ///< JSON: extractor, weights, draws

  int count() const { return static_cast<int>(label.size()); }
  int class_count() const { return static_cast<int>(classes.size()); }
  int passes() const { return static_cast<int>(pass_begin.size()); }
  std::int64_t pass_end(int pass) const {
    return pass + 1 < passes() ? pass_begin[static_cast<std::size_t>(pass) + 1] : count();
  }
};

/// Schema "mocurate-features/1". Same content, same bytes. Errors kInconsistent (shapes), kCannotWrite.
Status WriteFeatures(const FeatureSet& set, const std::filesystem::path& path);
/// Errors of ReadDataset.
Expected<FeatureSet> ReadFeatures(const std::filesystem::path& path);

}  // namespace mocurate
