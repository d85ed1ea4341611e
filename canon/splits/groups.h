#pragma once

#include <set>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/error.h"
#include "core/base/finding.h"

namespace mocurate {

/// Whether a split goes by groups that its options name: persons or styles.
bool NamesGroups(SplitBy by);

/// What two parts must not share, in words: "person".
const char* NameOf(SplitBy by);

/// "p1, p2"
std::string JoinNames(const std::vector<std::string>& names);

/// A split as a set can meet it.
struct MetGroups {
  SplitOptions options;  ///< with names that are in the set only
  bool drawn = false;    ///< some of them
};

/// Who is named for a part plays it, and a name that the set lacks is a finding. Where nobody of those named for a part
/// is there, others are drawn, of those that are not named, at least one while one is left to train; a finding says so.
/// Error kConfig: a name under two parts; everybody named to test or select, so that nobody trains; nobody to test
/// although others that are named are there; with `absent: refuse`, a name that the set lacks.
Expected<MetGroups> MeetGroups(const SplitOptions& options, const std::set<std::string>& groups,
                               std::vector<Finding>& findings);

}  // namespace mocurate
