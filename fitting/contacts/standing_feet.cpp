#include "fitting/contacts/standing_feet.h"

#include <algorithm>

#include "fitting/contacts/foot_contacts.h"

namespace mocurate {
namespace {
constexpr double kStanding = 0.3;  ///< m/s, apparent speed of a standing foot, at most: noise of the current pose
}

void HoldStandingFeet(const Motion& pose, const TrackWindow& window, ProcessNoiseScale& factors) {
  const auto legs = LegsOf(*pose.skeleton);
  if (!legs) return;
  ContactOptions contacts;
  contacts.speed = kStanding;
  const double largest = *window.options.contact_process_noise / window.options.velocity_process_noise;
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
