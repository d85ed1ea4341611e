#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// The present name of an option, a choice or a finding code that a former version called `name`; empty where `name`
/// was not renamed. Files of that version are still read, each with a warning that names the new word.
std::string_view NewNameOf(std::string_view name);

/// What former versions called `name`, in the order of the table.
std::vector<std::string_view> FormerNamesOf(std::string_view name);

/// "'FORMER' is called 'NOW' now": the message of that warning.
std::string RenamedText(std::string_view former, std::string_view now);

/// The present code of a finding, with that warning once a process for each former code; `code` where it was not
/// renamed.
std::string PresentCode(const std::string& code);

/// Random stream of the studio's false tracks. It keeps its name, so that seeds give the recordings that they gave.
extern const char* const kFalseTrackStream;

}  // namespace mocurate
