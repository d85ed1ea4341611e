#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"

namespace mocurate {

/// What two parts of a split share although they must not.
struct Leaks {
  std::vector<std::string> groups;  ///< persons, styles, performances; sorted
  std::size_t repeated = 0;         ///< contents that clips of two parts have

  bool empty() const { return groups.empty() && repeated == 0; }
};

/// `parts`, `groups` and `contents` are of each clip; clips whose part is negative are in none.
Leaks FindLeaks(const std::vector<int>& parts, const std::vector<std::string>& groups,
                const std::vector<std::string>& contents);

/// Text of Split::leak_check: "ok: no person and no equal clip in two parts", or what leaks. `what` names
/// the groups, or is empty.
std::string LeakText(const std::string& what, const Leaks& leaks);

/// The group of one performance, with all its cameras and spans. With `sessions_together`, a person's session.
std::string PerformanceOf(const Clip& clip, bool sessions_together);

/// Identity of the clip's source data, with its span; empty where it is unknown.
std::string SourceContentOf(const Clip& clip);

}  // namespace mocurate
