#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/options.h"

namespace mocurate {

/// One thing that others have found wrong with clips of a data set.
struct KnownIssue {
  std::string kind;                ///< "missing_skeletons", "false_track", ...
  std::string source;              ///< where it is said
  std::string note;                ///< what is said
  std::vector<std::string> clips;  ///< names of recordings; "*" stands for any characters

  void Declare(OptionVisitor& v);
};

/// Lists of known issues, configs/known_issues/NAME.yaml or files of the same form.
class KnownIssues {
 public:
  /// By name of a built-in list, or by path. Error kNotFound naming those that there are, or what is wrong in the file.
  static Expected<KnownIssues> Load(const std::vector<std::string>& names);

  /// The first issue about a recording: its name, or the part behind its last '.', is as listed.
  std::optional<KnownIssue> Find(const std::string& recording) const;
  std::size_t size() const { return issues_.size(); }

 private:
  std::vector<KnownIssue> issues_;
};

/// Whether `text` is `pattern`, in which each "*" stands for any characters.
bool MatchesWildcard(const std::string& pattern, const std::string& text);

}  // namespace mocurate
