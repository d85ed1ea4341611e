#pragma once

#include <vector>

#include "fitting/association/body_shape.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

/// Proposes people from free entries of one moment: per person the entries, at most one per view. A pair of entries of
/// two views proposes a body where most of their rays meet; nearby entries of other views support it. Sorted by
/// support, then by distance to the rays and to a person's proportions. With two views alone, rays of different people
/// meet by chance, so that proportions must fit. `usual_scale` (0: unknown): scale of the known people relative to the
/// rest pose. Bodies of less than half or more than twice of it are dropped.
std::vector<std::vector<Sight>> ProposePeople(const std::vector<RigView>& rig, const std::vector<Sight>& entries,
                                              const std::vector<KnownLength>& lengths, double usual_scale);

}  // namespace mocurate
