#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/store/store.h"

namespace mocurate {

/// Accuracy of recognisers (one checkpoint per seed) on the test clips of a split (empty: the first), or on all clips
/// when it has none: {"test_accuracy": [...], "mean", "test_clips", "scored": on what, in words, "confusion": (C,C)
/// summed over seeds, "labels"}. A split that leaves no clip to test gives "test_clips": 0 and no figure.
/// Errors of Recogniser::Load; kInconsistent when the skeleton is another one.
Expected<nlohmann::json> ScoreRecognisers(const std::vector<std::filesystem::path>& checkpoints, const Dataset& dataset,
                                          const std::string& split = {});

}  // namespace mocurate
