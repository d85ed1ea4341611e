#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ingest/synthetic/script.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

constexpr int kHumanAct12Subjects = 12;

/// One of HumanAct12's 34 fine classes, with its counts and lengths in the real set.
struct HumanAct12Variant {
  const char* code;                            ///< "0102"; its first two characters are the coarse class, 01 to 12
  const char* label;                           ///< of the coarse class
  const char* action;                          ///< of the studio
  int group;                                   ///< of PHSPD's recordings that it was cut from
  double seated;                               ///< share of clips on a chair; inferred from its group
  std::array<int, 7> frames;                   ///< last - first + 1: least, 10, 25, 50, 75, 90 %, most
  std::array<int, kHumanAct12Subjects> clips;  ///< of subjects 1 to 12
};

/// Counted over the names of the set's 1,191 clips (index of HumanML3D).
const std::vector<HumanAct12Variant>& HumanAct12Variants();

/// Frames of a clip at the given share of the distribution, linear between its quantiles.
int SpanAt(const HumanAct12Variant& variant, double share);

/// A clip of a recording, frames first and last included.
struct CutClip {
  const HumanAct12Variant* variant = nullptr;
  int first = 0;
  int last = 0;
};

/// A recording of PHSPD: one subject's actions one after the other, and HumanAct12's clips of it.
struct PlannedRecording {
  int subject = 1;  ///< 1 to 12
  int group = 1;    ///< 1 to 3
  int time = 1;     ///< 1 to 4
  Script script;
  std::vector<CutClip> clips;
};

/// Recordings sorted by subject, group, time. Clips of each variant are distributed over the real set's lengths; the
/// whole set has the real numbers of each subject and variant. Of the options: seed, subjects, clips of each variant
/// and subject, actions (coarse labels, actions or codes).
std::vector<PlannedRecording> PlanHumanAct12(const StudioOptions& options);

/// Several actions of HumanAct12 one after the other, with pauses between, like BABEL's long sequences.
struct PlannedSequence {
  int subject = 1;
  int number = 1;
  Script script;
  std::vector<const HumanAct12Variant*> kinds;  ///< of script.actions

  std::string Key() const { return std::to_string(subject) + "/" + std::to_string(number); }
  std::string Person() const;  ///< "p01"
};

/// `least` to `most` actions, drawn from those in options.actions, each in its natural time.
PlannedSequence PlanSequence(const StudioOptions& options, int subject, int number, int least, int most,
                             double rate_hz);

/// The sequence of a person in layout rendered_seq: options.clips actions (0: 4) for cameras of kDepthSequenceHz. The
/// person roughly faces the first camera.
PlannedSequence PlanDepthSequence(const StudioOptions& options, int subject);
inline constexpr std::int64_t kDepthSequenceHz = 15;

/// Error kConfig for a name in options.actions that is no label, action or code of HumanAct12, with the nearest.
Status CheckVariants(const std::vector<std::string>& wanted);

}  // namespace mocurate
