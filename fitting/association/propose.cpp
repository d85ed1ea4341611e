#include "fitting/association/propose.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

namespace mocurate {
namespace {

constexpr double kPairGate = 0.06;  ///< of the extent: median distance of the body from the rays of its pair
/// Of the extent: median distance of the body from the rays of further entries.
constexpr double kSupportGate = 0.12;
constexpr double kViewsAllPaired = 6;  ///< views up to which all pairs are tried (numerical)
constexpr int kLengthsToPropose = 3;   ///< fewest lengths for a test of proportions
/// Log ratio; largest mismatch of proportions at which two views alone count.
constexpr double kPlausibleMismatch = 0.35;
/// Factor between the size of a proposed body and the usual size, at most.
constexpr double kScaleRange = 2.2;

struct Proposal {
  std::vector<Sight> sights;  ///< the pair first
  BodyPoints body;
  double error = 0.0;     ///< of the pair, share of the extent
  double mismatch = 0.0;  ///< of the proportions
};

/// Pairs of positions in a list of views: all, or neighbours and some strides.
std::set<std::pair<std::size_t, std::size_t>> PairsOfViews(std::size_t count) {
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  std::set<std::size_t> strides;
  if (count <= kViewsAllPaired) {
    for (std::size_t s = 1; s < count; ++s) strides.insert(s);
  } else {
    strides = {1, 2, count / 8 + 1, count / 4, count / 3};
  }
  for (const std::size_t stride : strides) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = (i + stride) % count;
      if (i != j) pairs.insert({std::min(i, j), std::max(i, j)});
    }
  }
  return pairs;
}

int Shared(const std::vector<RigView>& rig, const Sight& a, const Sight& b) {
  const RigView& one = rig[static_cast<std::size_t>(a.view)];
  const RigView& other = rig[static_cast<std::size_t>(b.view)];
  const std::size_t at = one.Point(a.frame, a.person, 0);
  const std::size_t there = other.Point(b.frame, b.person, 0);
  int shared = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(one.keypoints); ++k) {
    shared += one.confidence[at + k] > 0.0 && other.confidence[there + k] > 0.0 ? 1 : 0;
  }
  return shared;
}

std::optional<Proposal> ProposePair(const std::vector<RigView>& rig, const Sight& a, const Sight& b,
                                    const std::vector<KnownLength>& lengths, double usual_scale) {
  const int shared = Shared(rig, a, b);
  if (shared < kLeastKeypoints) return {};
  Proposal proposal;
  proposal.sights = {a, b};
  proposal.body = NearestBody(rig, proposal.sights);
  const int known = proposal.body.KnownCount();
  if (known < kLeastKeypoints || 2 * known < shared) return {};
  for (const Sight& sight : proposal.sights) {
    const RigView& view = rig[static_cast<std::size_t>(sight.view)];
    const double distance = EntryDistance(view, sight.frame, sight.person, proposal.body, kLeastKeypoints);
    proposal.error = std::max(proposal.error, distance / proposal.body.extent);
  }
  if (!(proposal.error <= kPairGate)) return {};
  const ShapeMatch shape = CompareShape(proposal.body, lengths);
  if (shape.lengths >= kLengthsToPropose) proposal.mismatch = shape.mismatch;
  if (usual_scale > 0.0 && shape.lengths > 0 && std::abs(std::log(shape.scale / usual_scale)) > std::log(kScaleRange)) {
    return {};
  }
  return proposal;
}

using Entries = std::vector<std::vector<Sight>>;  ///< of each view that has any

/// Adds the nearest entry of every other view. Returns false when an entry of the pair is taken.
bool Support(const std::vector<RigView>& rig, const Entries& entries, const std::set<std::pair<int, int>>& taken,
             Proposal& proposal) {
  proposal.sights.resize(2);
  for (const Sight& sight : proposal.sights) {
    if (taken.count({sight.view, sight.person}) != 0) return false;
  }
  for (const std::vector<Sight>& of_view : entries) {
    const int v = of_view[0].view;
    if (v == proposal.sights[0].view || v == proposal.sights[1].view) continue;
    double nearest = kSupportGate * proposal.body.extent;
    const Sight* best = nullptr;
    for (const Sight& sight : of_view) {
      if (taken.count({v, sight.person}) != 0) continue;
      const double distance =
          EntryDistance(rig[static_cast<std::size_t>(v)], sight.frame, sight.person, proposal.body, kLeastKeypoints);
      if (distance > nearest) continue;
      nearest = distance;
      best = &sight;
    }
    if (best != nullptr) proposal.sights.push_back(*best);
  }
  return true;
}

}  // namespace

std::vector<std::vector<Sight>> ProposePeople(const std::vector<RigView>& rig, const std::vector<Sight>& entries,
                                              const std::vector<KnownLength>& lengths, double usual_scale) {
  Entries by_view;
  for (const Sight& sight : entries) {
    if (by_view.empty() || by_view.back()[0].view != sight.view) by_view.emplace_back();
    by_view.back().push_back(sight);
  }
  std::vector<Proposal> proposals;
  for (const auto& [i, j] : PairsOfViews(by_view.size())) {
    for (const Sight& a : by_view[i]) {
      for (const Sight& b : by_view[j]) {
        auto proposal = ProposePair(rig, a, b, lengths, usual_scale);
        if (proposal) proposals.push_back(std::move(*proposal));
      }
    }
  }
  std::vector<std::vector<Sight>> people;
  std::set<std::pair<int, int>> taken;
  while (true) {
    const Proposal* best = nullptr;
    double best_cost = 0.0;
    for (Proposal& proposal : proposals) {
      if (!Support(rig, by_view, taken, proposal)) continue;
      if (proposal.sights.size() == 2 && rig.size() > 2 && proposal.mismatch > kPlausibleMismatch) continue;
      const double cost = proposal.error / kPairGate + proposal.mismatch / kPlausibleMismatch;
      const std::size_t views = proposal.sights.size();
      if (best != nullptr && (views < best->sights.size() || (views == best->sights.size() && cost >= best_cost))) {
        continue;
      }
      best = &proposal;
      best_cost = cost;
    }
    if (best == nullptr) return people;
    people.push_back(best->sights);
    for (const Sight& sight : best->sights) taken.insert({sight.view, sight.person});
  }
}

}  // namespace mocurate
