#pragma once

#include <cmath>
#include <string>

#include "core/base/random.h"
#include "eval/metrics/sampling.h"

namespace mocurate {

/// Features of a known distribution, as of a recogniser: normal with the spectrum 1/k and trace 25, or bent by tanh,
/// which is not normal. The same trial and purpose, the same features.
class KnownFeatures {
 public:
  KnownFeatures(int size, bool bent, int trial) : bent_(bent), trial_(std::to_string(trial)), deviation_(size) {
    double sum = 0.0;
    for (int k = 1; k <= size; ++k) sum += 1.0 / k;
    for (int k = 1; k <= size; ++k) deviation_(k - 1) = std::sqrt(25.0 / sum / k);
  }

  /// Independent motions, their mean moved by `shift` (along the first feature): without tanh, FID to motions without
  /// a shift is shift^2.
  FeatureSample Motions(int count, const std::string& purpose, double shift = 0.0) const {
    return Persons(count, 1, purpose, shift, 0.0);
  }

  /// `each` motions of `persons`, of the same distribution; a share of the variance is between persons.
  FeatureSample Persons(int persons, int each, const std::string& purpose, double shift = 0.0,
                        double between = 0.4) const {
    Random random(11, purpose, trial_);
    FeatureSample sample;
    const Eigen::Index size = deviation_.size();
    sample.features.resize(static_cast<Eigen::Index>(persons) * each, size);
    sample.units = persons;
    sample.persons = each > 1;
    for (int p = 0; p < persons; ++p) {
      Eigen::VectorXd person(size);
      for (double& value : person) value = random.Normal();
      for (int i = 0; i < each; ++i) {
        const Eigen::Index row = static_cast<Eigen::Index>(p) * each + i;
        for (Eigen::Index k = 0; k < size; ++k) {
          const double own = std::sqrt(between) * person(k) + std::sqrt(1.0 - between) * random.Normal();
          const double value = deviation_(k) * own + (k == 0 ? shift : 0.0);
          sample.features(row, k) = bent_ ? std::tanh(value) : value;
        }
        sample.label.push_back(0);
        sample.unit.push_back(p);
      }
    }
    return sample;
  }

 private:
  bool bent_;
  std::string trial_;
  Eigen::VectorXd deviation_;
};

}  // namespace mocurate
