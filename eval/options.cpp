#include "eval/options.h"

namespace mocurate {

void EvaluateOptions::Declare(OptionVisitor& v) {
  v.Integer("seed", seed, {}, "of every draw of the evaluation");
  v.Integer("repetitions", repetitions, {1.0, 1000.0}, "how often the whole evaluation is repeated");
  v.Integer("motions", motions, {10.0, 1e6}, "motions per set and repetition");
  v.Integer("diversity_pairs", diversity_pairs, {1.0, 1e6}, "pairs behind diversity");
  v.Integer("multimodality_quota", multimodality_quota, {1.0, 1e5}, "pairs per class behind multimodality");
  v.Choice("labels", labels, {{"uniform", LabelDraw::kUniform}, {"natural", LabelDraw::kNatural}},
           "frequencies of generated labels: uniform (Action2Motion) or those of the real set (ACTOR)");
  v.Choice("real", real, {{"all", RealPart::kAll}, {"train", RealPart::kTrain}, {"test", RealPart::kTest}},
           "which clips are the real motions: all (as published), or one part of the split");
  v.Text("split", split, "split whose test part scores the recogniser; empty takes the recogniser's, else the first");
  v.Bool("random_hidden", random_hidden, "start the recogniser from normal hidden states, as the released code does");
}

StageDeclaration EvaluateDeclaration() { return {"evaluate", 5, "mocurate-learn", WholeSetLimits()}; }
StageDeclaration FitErrorDeclaration() { return {"fit_error", 3, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
