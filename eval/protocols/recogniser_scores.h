#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/store/store.h"

namespace mocurate {

/// Accuracy of recognisers (one checkpoint per seed) on the test clips of a split (empty: the first), or on all clips
/// when it has none: {"test_accuracy": [...], "mean", "test_clips", "confusion": (C,C) summed over seeds, "labels"}.
/// Errors of Recogniser::Load; kInconsistent when the skeleton is another one.
Expected<nlohmann::json> ScoreRecognisers(const std::vector<std::filesystem::path>& checkpoints, const Dataset& dataset,
                                          const std::string& split = {});

}  // namespace mocurate
