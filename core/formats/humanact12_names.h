#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/formats/phspd_text.h"

namespace mocurate {

/// An action code of HumanAct12, as the paper's Table 5 names it (a2m_actor.md A.1; 0802 is the left hand and 0803 the
/// pie: an enumerator in the published code exchanges the two).
struct HumanAct12Code {
  const char* code;   ///< four digits: coarse, fine
  const char* label;  ///< of the coarse class
  const char* fine_label;
};

/// Null for an unknown code.
const HumanAct12Code* FindHumanAct12Code(std::string_view code);

/// A clip's name: what it was cut from, first and last frame (both included), action.
struct HumanAct12Name {
  PhspdRecording recording;
  int first = 0;
  int last = 0;
  std::string code;
};

/// "P01G01R01F0001T0064A0101", with or without ".npy", or its digits alone, "0111000100640101" (group and repetition
/// without their leading 0). Empty where the text is not such a name.
std::optional<HumanAct12Name> ParseHumanAct12Name(std::string_view text);

}  // namespace mocurate
