#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/quality/checks.h"
#include "tests/quality/people.h"

namespace mocurate::test {

inline constexpr std::uint64_t kSeeds = 24;

/// A person of random size, speed and style, as recorded by a tracker of random rate.
inline TakeOptions RecordedPerson(std::uint64_t seed) {
  Random random(seed, "person", "");
  TakeOptions options;
  options.frames = 60 + static_cast<int>(60.0 * random.Uniform());
  options.rate_hz = seed % 3 == 0 ? 120.0 : seed % 3 == 1 ? 30.0 : 15.0;
  options.stature = 0.6 + 0.6 * random.Uniform();
  options.noise = 0.001 + 0.02 * random.Uniform();
  options.walk = 2.0 * random.Uniform();
  return options;
}

/// The only findings of the take, or a failure that lists the others.
inline std::vector<Finding> Only(const std::string& code, const Take& take, double rate_hz) {
  std::vector<Finding> found;
  for (const Finding& finding : CheckPoints(take.view(), rate_hz)) {
    if (finding.code == code) {
      found.push_back(finding);
    } else {
      ADD_FAILURE() << finding.code << " in " << finding.frame_begin << "-" << finding.frame_end << " " << finding.joint
                    << ": " << finding.message;
    }
  }
  return found;
}

}  // namespace mocurate::test
