#pragma once

#include <string>
#include <vector>

#include "ingest/synthetic/sequence_plan.h"

namespace mocurate {

/// BABEL's annotation of an action: processed label and categories.
struct BabelWords {
  std::string proc_label;
  std::vector<std::string> categories;
};

/// A long sequence with the labels of each of its actions.
struct AnnotatedSequence {
  PlannedSequence sequence;
  std::vector<BabelWords> words;  ///< of sequence.script.actions
};

/// Several short everyday actions one after the other, half of them without a pause between, with BABEL's labels
/// (twelve of MultiAct's 53 labels, and others). An action takes one to three seconds, as most of BABEL's do.
/// options.actions are those labels or the studio's names.
AnnotatedSequence PlanBabelSequence(const StudioOptions& options, int subject, int number, double rate_hz);

/// Error kConfig for an unknown name in options.actions, with the nearest.
Status CheckBabelWords(const std::vector<std::string>& wanted);

}  // namespace mocurate
