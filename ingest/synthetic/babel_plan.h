#pragma once

#include <string>
#include <vector>

#include "ingest/synthetic/sequence_plan.h"

namespace mocurate {

/// What BABEL's annotators write for an action: processed label and categories.
struct BabelWords {
  std::string proc_label;
  std::vector<std::string> categories;
};

/// A long sequence and the words of each of its actions.
struct AnnotatedSequence {
  PlannedSequence sequence;
  std::vector<BabelWords> words;  ///< of sequence.script.actions
};

/// Several short actions of everyday life one after the other, half of them without a rest in between, in the words
/// that BABEL has for them (twelve of MultiAct's 53 labels, and some more); an action takes one to three seconds, as
/// most of BABEL's do. options.actions are those words or the studio's names.
AnnotatedSequence PlanBabelSequence(const StudioOptions& options, int subject, int number, double rate_hz);

/// Error kConfig for a wanted name that is none of them, with the nearest.
Status CheckBabelWords(const std::vector<std::string>& wanted);

}  // namespace mocurate
