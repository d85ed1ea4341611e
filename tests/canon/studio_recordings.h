#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/motion/clip.h"

namespace mocurate {

/// A recording of several actions and where they are.
struct LongRecording {
  std::string name;
  Motion motion;
  std::vector<double> truth_s;    ///< boundaries, sorted, without the ends of the recording
  std::vector<double> ways_s;     ///< ends of the transitions between actions that change the seat or rotate the person
  std::vector<Segment> segments;  ///< the actions, in order
};

/// Times that lie within the recording, sorted, each once.
std::vector<double> InnerTimes(std::vector<double> times, double duration_s);

/// The studio's long sequences, as in layout `amass`: three to six of HumanAct12's actions, with pauses and the
/// transitions between them. True boundaries are the begin and the end of each action. Segments have the studio's
/// action and, as category, the part that joints alone determine (a cup is a bottle, left after right is right after
/// left).
std::vector<LongRecording> StudioRecordings(std::int64_t seed, int subjects, int sequences,
                                            FrameRate rate = FrameRate{120, 1});

/// One of the studio's people (0 to 3) performs an action `cycles` times, between two pauses of 0.2 to 1 s; 0: a
/// natural number, or once.
LongRecording StudioExercise(std::int64_t seed, const std::string& action, int person, int cycles,
                             FrameRate rate = FrameRate{30, 1});

}  // namespace mocurate
