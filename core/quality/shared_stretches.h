#pragma once

#include "core/quality/duplicates.h"

namespace mocurate {

constexpr double kLeastStretch_s = 0.6;  ///< length of a stretch

/// The longest shared stretch of every two of `count` motions that have one. Joints are compared by their distances
/// from all other joints, which do not depend on place, heading, axes or camera: at most `distance` metres apart, root
/// mean square over the stretch, of the joint that differs most. Windows of kLeastStretch_s are looked up in a k-d tree
/// of their principal components, then compared over the whole overlap at the best shift in time; at least 0.8 of the
/// overlap must be shared, as takes of one person agree in parts. Joints are smoothed by a Gaussian of 0.08 s, so that
/// interpolation and noise of millimetres do not hide a copy. Motions of one skeleton whose frames lie at most
/// kMaxGap_s apart, others match none.
std::vector<Duplicate> FindSharedStretches(std::size_t count, const MotionAt& motion, double distance);

}  // namespace mocurate
