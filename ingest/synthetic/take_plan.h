#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "ingest/synthetic/script.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// A class of a set, and the studio's action for it: the same or the nearest.
struct SetClass {
  int id = 0;
  const char* label = "";
  const char* action = "";
  double seated = 0.0;  ///< share of takes on a chair
};

/// KARD's 18 activities. Stand-ins: the throws, catches and drawings are waves, throws and fists.
const std::vector<SetClass>& KardClasses();
/// The actions of NTU RGB+D that the studio can perform, NTU-13 among them.
const std::vector<SetClass>& NtuClasses();
/// NTU-13, in the order of Action2Motion's classes.
const std::vector<SetClass>& Ntu13Classes();
/// UESTC's 40 exercises, each performed as the nearest one.
const std::vector<SetClass>& UestcClasses();
/// CMU-8 of Action2Motion. Stand-ins: washing is a wave, animals squat, dancing leans and climbing presses overhead.
const std::vector<SetClass>& Cmu8Classes();

inline constexpr std::int64_t kVariantRateHz = 30;

struct PlannedTake {
  const SetClass* kind = nullptr;
  int subject = 1;
  int repetition = 1;
  Script script;

  std::string Key() const;
};

/// Rules for the takes of a set: subjects and repetitions where the options leave them open, and the standing time
/// before.
struct TakeRules {
  std::int64_t subjects = 2;
  std::int64_t repetitions = 2;
  double rate_hz = 30.0;
  double least_rest_s = 0.1;
  double most_rest_s = 0.4;
};

/// Sorted by class, subject, repetition. Every action takes its natural time, faster or slower by the take. Error
/// kConfig: options.actions names none of the classes.
Expected<std::vector<PlannedTake>> PlanTakes(const StudioOptions& options, const std::vector<SetClass>& classes,
                                             const TakeRules& rules);

/// The takes of layout ntu, 30 Hz.
Expected<std::vector<PlannedTake>> PlanNtuTakes(const StudioOptions& options);

/// One class per variant of HumanAct12: the takes of layouts tracks, openpose and openpose_depth, kVariantRateHz.
Expected<std::vector<PlannedTake>> PlanVariantTakes(const StudioOptions& options);

/// The manner of one performance of an action, and its seconds.
Manner NaturalManner(const std::string& action, double seated_share, Random& random);

/// Whether one of these names is requested; all are where the list is empty.
bool IsWanted(const std::vector<std::string>& wanted, std::initializer_list<const char*> names);

/// Error kConfig for a requested action that is not in `known`, with the nearest.
Status CheckWanted(const std::vector<std::string>& wanted, const std::vector<std::string>& known);

}  // namespace mocurate
