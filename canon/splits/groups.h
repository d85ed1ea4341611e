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

/// A split with names that the set has.
struct ResolvedGroups {
  SplitOptions options;  ///< with names of the set only
  bool drawn = false;    ///< some names were drawn
};

/// What a split states without looking at clips. Error kConfig: a name under two parts; names in a split by fraction or
/// by role, which has none.
Status CheckSplit(const SplitOptions& options);

/// About names that the split, or the option `where`, gives to persons or styles and that no clip has; `there`: those
/// that clips have. With `absent: refuse` an error kConfig with the nearest name; with `absent: draw` a finding.
Status CheckAbsent(const SplitOptions& options, const std::string& where, const std::vector<std::string>& absent,
                   const std::set<std::string>& there, std::vector<Finding>& findings);

/// Named groups go to their part. With `absent: refuse` a name that the set lacks is an error kConfig. With `absent:
/// draw` it is a finding, and where a part has none of its named groups, others that no part names are drawn: at least
/// one, while one is left to train; a finding reports it. Other errors kConfig: those of CheckSplit; all groups named
/// for test or validation, so that none trains; an empty test part although other named groups are in the set.
Expected<ResolvedGroups> ResolveGroups(const SplitOptions& options, const std::set<std::string>& groups,
                                       std::vector<Finding>& findings);

}  // namespace mocurate
