#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/golden.h"
#include "tests/train/chains.h"
#include "tests/train/trace.h"

namespace mocurate {

/// Largest differences allowed, relative where noted (goldens/README.md, tolerances).
struct ParityTolerance {
  double outputs = 5e-6;
  double gradients = 1e-5;  ///< of the largest value of an array
  double weights = 5e-6;    ///< after an optimiser's step
};

inline double WorstDifference(const std::vector<float>& got, const std::vector<float>& want) {
  if (got.size() != want.size()) return 1e300;
  double worst = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double difference = std::fabs(static_cast<double>(got[i]) - want[i]);
    worst = difference <= worst ? worst : difference;  // a NaN stays
  }
  return worst;
}

inline double LargestValue(const std::vector<float>& values) {
  double largest = 1e-30;
  for (const float value : values) largest = std::max(largest, std::fabs(static_cast<double>(value)));
  return largest;
}

inline Parameter GoldenArray(const Golden& file, const std::string& path, const std::string& name) {
  const auto array = file.Floats(path);
  return {name, std::vector<std::int64_t>(array.shape.begin(), array.shape.end()), array.values};
}

/// Arrays of a golden group, read by the names that `names` maps to names of the file.
inline ParameterList GoldenWeights(const Golden& file, const std::string& group,
                                   const std::vector<std::pair<std::string, std::string>>& names) {
  ParameterList weights;
  for (const auto& [name, stored] : names) weights.push_back(GoldenArray(file, group + "/" + stored, name));
  return weights;
}

inline std::vector<int> GoldenClasses(const Golden& file, const std::string& path) {
  std::vector<int> classes;
  for (const std::int64_t label : file.Integers(path).values) classes.push_back(static_cast<int>(label));
  return classes;
}

/// (B,T,D) -> (T,B,D)
inline std::vector<float> FrameMajor(const std::vector<float>& values, int batch, int frames) {
  const std::size_t width = values.size() / static_cast<std::size_t>(batch * frames);
  std::vector<float> result(values.size());
  for (std::size_t b = 0; b < static_cast<std::size_t>(batch); ++b) {
    for (std::size_t t = 0; t < static_cast<std::size_t>(frames); ++t) {
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>((b * static_cast<std::size_t>(frames) + t) * width),
                  width,
                  result.begin() + static_cast<std::ptrdiff_t>((t * static_cast<std::size_t>(batch) + b) * width));
    }
  }
  return result;
}

inline void ExpectNear(const TraceValues& got, const std::string& name, const std::vector<float>& want,
                       double tolerance, const std::string& where) {
  ASSERT_TRUE(got.count(name) > 0) << where << ": no " << name;
  EXPECT_LE(WorstDifference(got.at(name).value, want), tolerance) << where << "/" << name;
}

/// A trace against one branch of a golden file, in this order: terms, outputs, gradients, weights after steps.
struct GoldenStep {
  std::vector<std::pair<std::string, std::string>> outputs;  ///< of the trace -> dataset
  std::string gradients;                                     ///< group of datasets named after parameters
  std::vector<std::pair<std::size_t, std::string>> after;    ///< step (from 0) -> group
};

inline void ExpectParity(const Golden& file, const std::string& branch, const StepTrace& trace,
                         const GoldenStep& golden, const std::vector<std::pair<std::string, std::string>>& names,
                         const ParityTolerance& tolerance = {}) {
  for (const auto& [name, dataset] : golden.outputs) {
    ExpectNear(trace.outputs, name, file.Floats(branch + "/" + dataset).values, tolerance.outputs, branch);
  }
  for (const auto& [name, stored] : names) {
    const std::vector<float> want = file.Floats(branch + "/" + golden.gradients + "/" + stored).values;
    ExpectNear(trace.gradients, name, want, tolerance.gradients * LargestValue(want), branch + "/gradient");
  }
  for (const auto& [step, group] : golden.after) {
    ASSERT_LT(step, trace.after.size());
    for (const auto& [name, stored] : names) {
      const int at = FindParameter(trace.after[step], name);
      ASSERT_GE(at, 0) << name;
      EXPECT_LE(WorstDifference(trace.after[step][static_cast<std::size_t>(at)].value,
                                file.Floats(branch + "/" + group + "/" + stored).values),
                tolerance.weights)
          << branch << "/" << group << "/" << stored;
    }
  }
}

}  // namespace mocurate
