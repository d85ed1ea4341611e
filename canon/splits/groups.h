#pragma once

#include <set>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/error.h"
#include "core/base/finding.h"

namespace mocurate {

/// Whether a split is by named groups: persons or styles.
bool NamesGroups(SplitBy by);

/// Name of the property that no two parts share: "person".
const char* NameOf(SplitBy by);

/// "p1, p2"
std::string JoinNames(const std::vector<std::string>& names);

/// A split with names that the set has.
struct ResolvedGroups {
  SplitOptions options;  ///< with names of the set only
  bool drawn = false;    ///< some names were drawn
};

/// Named groups go to their part; a name that the set lacks is a finding. Where a part has none of its named groups,
/// others that no part names are drawn: at least one, while one is left to train; a finding reports it. Error kConfig:
/// a name under two parts; all groups named for test or validation, so that none trains; an empty test part although
/// other named groups are in the set; with `absent: refuse`, a name that the set lacks.
Expected<ResolvedGroups> ResolveGroups(const SplitOptions& options, const std::set<std::string>& groups,
                                       std::vector<Finding>& findings);

}  // namespace mocurate
