#pragma once

#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// Which frequencies generated labels follow: A2M draws them uniformly, ACTOR copies the real set's (F6).
enum class LabelDraw { kUniform, kNatural };

/// Which clips are the real motions of the table. The papers use the whole set for training and scoring (F10).
enum class RealPart { kAll, kTrain, kTest };

struct EvaluateOptions {
  std::int64_t seed = 1;
  std::int64_t repetitions = 20;
  std::int64_t motions = 3000;
  std::int64_t diversity_pairs = 200;
  std::int64_t multimodality_quota = 20;
  LabelDraw labels = LabelDraw::kUniform;
  RealPart real = RealPart::kAll;
  std::string split;           ///< whose parts are meant; empty: the first one
  bool random_hidden = false;  ///< recogniser starts from normal hidden states, as released (F5)

  void Declare(OptionVisitor& v);
};

StageDeclaration EvaluateDeclaration();
StageDeclaration FitErrorDeclaration();

}  // namespace mocurate
