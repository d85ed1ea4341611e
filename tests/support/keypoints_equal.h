#pragma once

#include "core/formats/openpose.h"

namespace mocurate {

inline bool operator==(const DetectedKeypoint& a, const DetectedKeypoint& b) {
  return a.u_px == b.u_px && a.v_px == b.v_px && a.confidence == b.confidence;
}

inline bool operator==(const OpenPosePerson& a, const OpenPosePerson& b) { return a.pose == b.pose; }

}  // namespace mocurate
