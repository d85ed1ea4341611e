#include "ingest/synthetic/sequence_plan.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "ingest/synthetic/action_parts.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {

std::string PlannedSequence::Person() const { return "p" + Digits(subject, 2); }

PlannedSequence PlanSequence(const StudioOptions& options, int subject, int number, int least, int most,
                             double rate_hz) {
  PlannedSequence sequence{subject, number, {}, {}};
  Random random(static_cast<std::uint64_t>(options.seed), "studio.sequence", sequence.Key());
  std::vector<const HumanAct12Variant*> choice;
  for (const HumanAct12Variant& variant : HumanAct12Variants()) {
    const auto& only = options.actions;
    const bool wanted = only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& name) {
                          return name == variant.label || name == variant.action || name == variant.code;
                        });
    if (wanted) choice.push_back(&variant);
  }
  int frame = static_cast<int>(random.Uniform(0.3, 1.5) * rate_hz);
  const int actions = least + static_cast<int>(random.Below(static_cast<std::uint64_t>(most - least + 1)));
  for (int k = 0; k < actions; ++k) {
    const HumanAct12Variant* variant = choice[random.Below(choice.size())];
    const Manner manner = NaturalManner(variant->action, variant->seated, random);
    const int end = frame + std::max(2, static_cast<int>(std::lround(manner.active_s * rate_hz)));
    sequence.script.actions.push_back({variant->action, frame, end, manner});
    sequence.kinds.push_back(variant);
    frame = end + static_cast<int>(random.Uniform(0.6, 2.2) * rate_hz);
  }
  sequence.script.frames = frame;
  sequence.script.sway_phase = random.Uniform(0.0, 2.0 * kPi);
  sequence.script.heading = random.Uniform(-kPi, kPi);
  return sequence;
}

PlannedSequence PlanDepthSequence(const StudioOptions& options, int subject) {
  constexpr int kActions = 4;
  const int actions = options.clips > 0 ? static_cast<int>(options.clips) : kActions;
  PlannedSequence sequence = PlanSequence(options, subject, 1, actions, actions, kDepthSequenceHz);
  sequence.script.heading = 0.1 * sequence.script.heading;
  return sequence;
}

Status CheckVariants(const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const HumanAct12Variant& variant : HumanAct12Variants()) {
    known.insert(known.end(), {variant.label, variant.action, variant.code});
  }
  return CheckWanted(wanted, known);
}

}  // namespace mocurate
