#pragma once

#include <optional>
#include <string>

#include "ingest/inspect/raw_clip.h"

namespace mocurate {

/// One thing measured: empty value when the data do not tell.
struct Measured {
  std::string value;
  double confidence = 0.0;
  std::string evidence;
};

/// What the data of a clip say about the frame they stand in.
struct ClipMeasures {
  Measured units;                 ///< "m", "cm", "mm", "inch", "2.2222222222222 inch" (the CMU database's unit)
  Measured up;                    ///< "+y": where a person's head is, in file axes
  Measured handedness;            ///< "right", "left"
  Measured facing;                ///< "-z": where the person faces, in file axes
  Measured axes;                  ///< AxisConvention text that brings these to the canonical world
  double body = 0.0;              ///< head to foot along trunk and leg, file units; 0: not measured
  std::optional<RootScale> root;  ///< of the path against the body, in the unit that is declared
  double missing_share = 0.0;
};

ClipMeasures Measure(const RawClip& clip);

/// Head to foot along trunk and leg (the joints, without soles and crown) of people who are no small children, metres.
inline constexpr double kShortestBody = 1.0;
inline constexpr double kTallestBody = 1.95;

}  // namespace mocurate
