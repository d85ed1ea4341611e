#include "core/pipeline/stage.h"

namespace mocurate {

std::string_view Name(OutcomeKind kind) {
  switch (kind) {
    case OutcomeKind::kDone:
      return "done";
    case OutcomeKind::kDoubtful:
      return "doubtful";
    case OutcomeKind::kLeftOut:
      return "left_out";
    case OutcomeKind::kRefused:
      return "refused";
    case OutcomeKind::kCrashed:
      return "crashed";
  }
  return "crashed";
}

}  // namespace mocurate
