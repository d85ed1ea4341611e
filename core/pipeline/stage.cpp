#include "core/pipeline/stage.h"

namespace mocurate {

std::string_view Name(OutcomeKind kind) {
  switch (kind) {
    case OutcomeKind::kDone:
      return "done";
    case OutcomeKind::kSuspect:
      return "suspect";
    case OutcomeKind::kExcluded:
      return "excluded";
    case OutcomeKind::kRefused:
      return "refused";
    case OutcomeKind::kCrashed:
      return "crashed";
  }
  return "crashed";
}

}  // namespace mocurate
