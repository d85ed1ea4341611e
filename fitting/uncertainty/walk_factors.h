#pragma once

#include "core/base/error.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// How much more (or less) a person moves each joint, and when, than the random walks of the options assume: the
/// squares of the steps that the solved fit shows, over what the walks let expect of them. A fit shows the share of a
/// walk's variance that the evidence decided: what the walks alone say of a step (all of them together: they share what
/// they say of a body that moves as a whole) less what stays open (MacKay 1992, evidence maximisation, one step). Both
/// are summed over the joint's steps nearby in time and drawn towards the joint's over the clip, those towards all
/// joints'. Steps across gaps keep what they had. `window` is the whole clip at its solution, with the factors it was
/// solved with. Error kInconsistent if the matrix cannot be factored.
Expected<WalkFactors> RefitWalks(const TrackWindow& window);

}  // namespace mocurate
