#include "train/trainer/training_control.h"

#include "core/base/file.h"
#include "core/base/log.h"

namespace mocurate {
namespace {

std::filesystem::path StateFile(const TrainingControl& control) { return control.scratch / "training_state.h5"; }

}  // namespace

std::optional<Checkpoint> ResumeFrom(const TrainingControl& control, const std::string& kind,
                                     const nlohmann::json& options) {
  std::error_code ignored;
  if (control.scratch.empty() || !std::filesystem::exists(StateFile(control), ignored)) return std::nullopt;
  Expected<Checkpoint> state = ReadCheckpoint(StateFile(control), kind);
  if (!state) {
    LogWarning("training starts anew: " + state.error().Message());
    return std::nullopt;
  }
  if (state->options != options || state->dataset_sha256 != control.dataset_sha256) return std::nullopt;
  return std::move(*state);
}

Status SaveState(const TrainingControl& control, const Checkpoint& checkpoint) {
  if (control.scratch.empty()) return {};
  if (Status made = MakeFolder(control.scratch); !made) return made;
  return WriteCheckpoint(checkpoint, StateFile(control));
}

}  // namespace mocurate
