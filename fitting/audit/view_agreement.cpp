#include "fitting/audit/view_agreement.h"

#include <algorithm>

#include "fitting/association/propose.h"

namespace mocurate {
namespace {

constexpr std::size_t kMomentsCompared = 24;  ///< moments, evenly spread over the take (numerical)
constexpr double kFarOff = 0.1;  ///< of a person's extent: distance from the rays at which an entry has the full cost

/// A view's frames nearest to the moments.
KeypointView FramesAt(const KeypointView& view, const std::vector<double>& moments, int keypoints) {
  KeypointView some;
  some.camera = view.camera;
  some.people = view.people;
  const std::size_t numbers = static_cast<std::size_t>(view.people) * static_cast<std::size_t>(keypoints) * 3;
  for (const double moment : moments) {
    const auto next = std::lower_bound(view.time_s.begin(), view.time_s.end(), moment);
    auto at = static_cast<std::size_t>(next - view.time_s.begin());
    if (at == view.time_s.size() || (at > 0 && moment - view.time_s[at - 1] < view.time_s[at] - moment)) --at;
    some.time_s.push_back(view.time_s[at]);
    const auto first = view.values.begin() + static_cast<std::ptrdiff_t>(at * numbers);
    some.values.insert(some.values.end(), first, first + static_cast<std::ptrdiff_t>(numbers));
  }
  return some;
}

}  // namespace

std::vector<KeypointView> AtSomeMoments(const std::vector<KeypointView>& views, int keypoints) {
  const std::vector<double>& time = views[0].time_s;
  const std::size_t count = std::min(kMomentsCompared, time.size());
  std::vector<double> moments;
  for (std::size_t i = 0; i < count; ++i) moments.push_back(time[i * time.size() / count]);
  std::vector<KeypointView> some;
  for (const KeypointView& view : views) {
    if (view.time_s.empty()) return {};
    some.push_back(FramesAt(view, moments, keypoints));
  }
  return some;
}

double CostOfAgreement(const std::vector<RigView>& rig, int frame, const std::vector<KnownLength>& lengths,
                       double& share) {
  std::vector<Sight> entries;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    for (int p = 0; p < rig[v].people; ++p) {
      if (rig[v].seen[rig[v].Entry(frame, p)] >= kLeastKeypoints) entries.push_back({static_cast<int>(v), frame, p});
    }
  }
  if (entries.empty()) return 0.0;
  double cost = static_cast<double>(entries.size());
  for (const std::vector<Sight>& sights : ProposePeople(rig, entries, lengths, 0.0)) {
    if (sights.size() < 3 && rig.size() > 3) continue;  // two views agree on a person by chance
    const BodyPoints body = NearestBody(rig, sights);
    for (const Sight& sight : sights) {
      const double off =
          EntryDistance(rig[static_cast<std::size_t>(sight.view)], sight.frame, sight.person, body, kLeastKeypoints) /
          body.extent;
      cost -= std::max(0.0, 1.0 - off / kFarOff);
      share += 1.0 / static_cast<double>(entries.size());
    }
  }
  return cost / static_cast<double>(entries.size());
}

}  // namespace mocurate
