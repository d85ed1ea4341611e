#pragma once

#include <vector>

#include "fitting/association/body_shape.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

/// People among entries of one moment without an owner: per person the entries, at most one per view. A pair of entries
/// of two views proposes a body where most of their rays meet; entries of other views near it support it. Most
/// supported first, then nearest to its rays and to a person's proportions. With two views alone, where upright people
/// meet the rays of others by chance, proportions must fit. `usual_scale` (0: unknown): of the people known so far
/// against the rest pose; bodies of less than half or more than twice of it are chance.
std::vector<std::vector<Sight>> ProposePeople(const std::vector<RigView>& rig, const std::vector<Sight>& entries,
                                              const std::vector<KnownLength>& lengths, double usual_scale);

}  // namespace mocurate
