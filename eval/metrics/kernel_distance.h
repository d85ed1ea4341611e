#pragma once

#include "core/base/random.h"
#include "eval/metrics/fid.h"

namespace mocurate {

/// Kernel distance (KID): the unbiased estimate of the squared maximum mean discrepancy with the kernel (x.y / D +
/// 1)^3, the mean over `subsets` random subsets of at most `size` motions of each set. Unlike FID it is unbiased for
/// few motions. [Binkowski et al. 2018, section 4]. Error kInconsistent for fewer than two motions in a set.
Expected<double> KernelDistance(const Features& a, const Features& b, int subsets, int size, Random& random);

}  // namespace mocurate
