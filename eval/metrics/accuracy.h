#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace mocurate {

/// Counts (C, C): rows are true classes, columns predicted ones. Motions without a class (-1) are ignored.
Eigen::MatrixXi ConfusionMatrix(const std::vector<int>& truth, const std::vector<int>& predicted, int classes);

/// Position of the largest of `classes` logits.
int LargestLogit(const float* logits, int classes);

/// Predictions accepted for each true class; empty: the class alone. Directional. [multiact.md A.4]
using EquivalentClasses = std::vector<std::vector<int>>;

/// Of a table class -> classes accepted for it, separated by ','; itself included. Empty without a table. `unknown`:
/// names in it that are not classes.
EquivalentClasses EquivalentOf(const std::map<std::string, std::string>& table, const std::vector<std::string>& classes,
                               std::set<std::string>& unknown);

/// Share of the motions with a class whose largest logit, or any of whose `top` largest logits, is accepted.
/// `logits` (N, C) row-major; 0 where no motion has a class. [a2m_actor.md D.4]
double AcceptedShare(const std::vector<int>& truth, const float* logits, int classes, int top,
                     const EquivalentClasses& equivalent = {});

}  // namespace mocurate
