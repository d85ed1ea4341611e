#pragma once

#include <string>
#include <vector>

#include "core/geometry/axes.h"
#include "ingest/sense/measure.h"

namespace mocurate {

/// What is said of a clip without looking at its numbers; empty: nothing.
struct Statements {
  std::string units, up, handedness, facing, axes, who;
};

/// What the clip's format says, and over it what the source declares.
Statements StatementsOf(const ObservedClip& clip, const std::optional<SourceOptions>& source);

/// One thing that is declared and that the clip shows.
struct Comparison {
  std::string code;  ///< of the finding where they differ: "up_contradiction"
  std::string declared;
  std::string measured;
  double value = 0.0;   ///< behind the message: how sure, or metres
  double weight = 0.0;  ///< how much the clip tells, 0 to 1
  bool contradicts = false;
  std::string message;
};

/// Units, up and handedness: those that are declared and that the clip shows. Nothing of what it does not show.
std::vector<Comparison> CompareFrame(const Statements& said, const ClipMeasures& measures);

/// Clips of one source or folder that tell, before the others are told by them, and the least share of their votes.
inline constexpr std::size_t kFewestVotes = 5;
inline constexpr double kAgreement = 0.95;

}  // namespace mocurate
