#include "fitting/contacts/standing_feet.h"

#include <algorithm>

#include "fitting/contacts/foot_contacts.h"

namespace mocurate {
namespace {
constexpr double kStanding = 0.3;  ///< m/s that a foot which stands seems to have, at most: noise of the pose so far
}

void HoldStandingFeet(const Motion& pose, const TrackWindow& window, WalkFactors& factors) {
  const auto legs = LegsOf(*pose.skeleton);
  if (!legs) return;
  ContactOptions contacts;
  contacts.speed = kStanding;
  const double largest = *window.options.contact_walk / window.options.velocity_walk;
  for (const Leg& leg : *legs) {
    for (const int joint : {leg.ankle, leg.toe}) {
      if (joint < 0) continue;
      const std::vector<bool> stands = JointContacts(pose, joint, LimitsOf(contacts));
      for (int f = 0; f + 1 < window.end; ++f) {
        if (!stands[f] || !stands[f + 1]) continue;
        double& factor = factors.position[window.Index(f, joint)];
        factor = std::min(factor, largest);
      }
    }
  }
}

}  // namespace mocurate
