#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// What a name is of: names of one kind are looked up among themselves.
enum class NameKind {
  kCode,     ///< of a finding; also a group of `ingest.source.checks`
  kOption,   ///< of a configuration, or of a checkpoint's JSON
  kChoice,   ///< value of an option
  kOutcome,  ///< of a stage's item, and the field or decision of that name in a run's files
  kAction,   ///< of a finding
  kField     ///< of the proportions that a run keeps
};

/// The present name of what a former version called `name`; empty where `name` was not renamed. `option` is the option
/// of a choice. Files of that version are still read, each with a warning that names the new word.
std::string_view NewNameOf(NameKind kind, std::string_view name, std::string_view option = {});

/// All former names of a kind.
std::vector<std::string_view> FormerNames(NameKind kind);

/// What former versions called `name`, in the order of the table.
std::vector<std::string_view> FormerNamesOf(NameKind kind, std::string_view name);

/// The other names of an option or of a group of checks: the present one for a former one, and the other way round.
std::vector<std::string_view> OtherNamesOfOption(std::string_view name);

/// "'FORMER' is called 'NOW' now": the message of that warning.
std::string RenamedText(std::string_view former, std::string_view now);

/// The present code of a finding, with that warning once a process for each former code; `code` where it was not
/// renamed.
std::string PresentCode(const std::string& code);

/// The same of an outcome of an item or a decision about a clip.
std::string PresentOutcome(const std::string& outcome);

/// Random stream of the studio's false tracks. It keeps its name, so that seeds give the recordings that they gave.
extern const char* const kFalseTrackStream;

}  // namespace mocurate
