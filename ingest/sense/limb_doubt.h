#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ingest/sense/observed_clip.h"

namespace mocurate {

/// Two points of one limb (left_knee and left_ankle, left_elbow and left_hand) that have changed their names: bones of
/// the limb are as long as those of the other side once they are exchanged, keep their length and have a body's
/// proportions better, and are not as they are named. Which two, and how far lengths differ; nothing of names without
/// sides.
std::optional<std::string> DoubtLimbs(const ObservedClip& clip, const std::vector<ObservedBone>& bones);

/// Limbs that are not as long on both sides, of points whose proportions are off besides (`score` of their bones in the
/// order of their names): another order's points. By how much; nothing of names without sides.
std::optional<std::string> DoubtSides(const ObservedClip& clip, const BodyScore& score);

}  // namespace mocurate
