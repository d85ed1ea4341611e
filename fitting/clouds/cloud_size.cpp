#include "fitting/clouds/cloud_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_start.h"
#include "fitting/stop_request.h"

namespace mocurate {
namespace {

constexpr std::size_t kClouds = 5;     ///< clouds in which bodies are posed, spread over all heights (numerical)
constexpr std::size_t kFewClouds = 3;  ///< up to this number of clouds, the person may squat or be partly visible in
                                       ///< all
/// Factors on the scale from the height, with several clouds: raised arms, standing, sitting (numerical).
constexpr std::array<double, 3> kStartFactors = {0.85, 1.0, 1.3};
/// Factor on the scale from the height, up to kFewClouds clouds (numerical).
constexpr std::array<double, 7> kFactorsOfFew = {0.85, 0.92, 1.0, 1.08, 1.16, 1.28, 1.45};
/// Factor on the rest skeleton: scales of adults (numerical).
constexpr std::array<double, 4> kUsualScales = {0.87, 0.95, 1.03, 1.11};
/// Scales with the lowest cost, refined by a limb search (numerical).
constexpr std::size_t kLimbsOfScales = 4;
/// Of these, scales that are refined: neighbours differ by less than what refining a scale and its radii gains
/// (numerical).
constexpr std::size_t kRefinedScales = 2;
/// Factors on the best scale of stances: with arms in front of the chest it was 3 to 9 % too large (`synthesize
/// --layout rendered_seq --seed 6001 --set subjects=24`, p13 and p16).
constexpr std::array<double, 3> kFactorsOfLimbs = {0.93, 1.0, 1.07};
/// Cost per point relative to the cloud with the lowest cost: its pose is started again.
constexpr double kMuchWorse = 1.3;
constexpr const char* kWork = "size of a person in depth views";
/// Fits of poses, with radii estimated in between (numerical).
constexpr int kRadiusFits = 3;
constexpr double kWideStep = 0.03;     ///< log scale; first step of the descent (numerical)
constexpr double kNarrowStep = 0.015;  ///< log scale; first step of the descent after the limb search (numerical)
constexpr int kSteps = 12;             ///< steps of the descent, at most (numerical)
constexpr double kHeldScale = 1e-4;    ///< of the logarithm of a scale that a fit of the shape keeps (numerical)
/// Share of thigh and shin: height of a hip above its ankle from which a leg is straight.
constexpr double kStraightLegs = 0.97;

/// A body size and the best poses in some clouds.
struct PosedSize {
  double scale = 1.0;
  double cost = 0.0;
  std::vector<std::vector<double>> poses;  ///< PoseState::FrameParameters in each cloud
};

/// Height of a cloud. Adds back the voxel size that thinning removes, half at each end.
double HeightOfPerson(const FusedCloud& cloud, double voxel_size) {
  return HeightOf(cloud.points).height() + voxel_size;
}

/// From crown to soles in the rest pose, metres.
double HeightOfRestBody(const SkeletonPtr& skeleton) {
  const CapsuleBody body = CapsuleBody::Make(skeleton, 1.0);
  PoseState rest(*skeleton, 1, skeleton->RestBoneLengths(), body.MovingJoints());
  rest.Update(0, 1, false);
  return HeightOf(body, rest, 0).height();
}

/// Scales of people, relative to the rest body.
struct ScaleRange {
  double least = 0.0;
  double most = 0.0;

  bool Has(double scale) const { return scale >= least && scale <= most; }
};

/// Scale from the median height of clouds relative to the rest body, assuming that people stand in most of them.
double ScaleFromHeight(double rest_height, const std::vector<FusedCloud>& clouds, const ScaleRange& people,
                       double voxel_size) {
  std::vector<double> heights;
  for (const FusedCloud& cloud : clouds) heights.push_back(HeightOfPerson(cloud, voxel_size));
  return std::clamp(MeanMedian(heights) / rest_height, people.least, people.most);
}

class SizeSearch {
 public:
  SizeSearch(SkeletonPtr skeleton, const std::vector<FusedCloud>& clouds, const PointCloudOptions& options)
      : skeleton_(std::move(skeleton)), clouds_(clouds), options_(options) {}

  /// Poses of a body of this scale, without initial poses.
  Expected<PosedSize> StartAt(double scale, StartSearch search) const {
    PosedSize size{scale, 0.0, {}};
    const CapsuleBody body = BodyOf(scale);
    for (const FusedCloud& cloud : clouds_) {
      if (Status on = StopIfInterrupted(kWork); !on) return Forward(on);
      PoseState state = PosesOf(body, 1, scale);
      const auto start = FindStart(body, cloud, 0, options_, state, search);
      if (!start) return Forward(start);
      size.cost += start->cost;
      size.poses.push_back(state.FrameParameters(0));
    }
    return size;
  }

  /// A body of this scale with poses near those of another size, after a limb search.
  Expected<PosedSize> SearchLimbsAt(double scale, const PosedSize& near) const {
    PosedSize size{scale, 0.0, {}};
    const CapsuleBody body = BodyOf(scale);
    PoseState state = PosesOf(body, 1, scale);
    for (std::size_t c = 0; c < clouds_.size(); ++c) {
      if (Status on = StopIfInterrupted(kWork); !on) return Forward(on);
      if (const auto near_cost = CostNear(near.poses[c], body, clouds_[c], state); !near_cost)
        return Forward(near_cost);
      const auto cost = SearchLimbs(body, clouds_[c], 0, options_, state);
      if (!cost) return Forward(cost);
      size.cost += *cost;
      size.poses.push_back(state.FrameParameters(0));
    }
    return size;
  }

  /// Searches anew for the pose of clouds with a much higher cost than the others; keeps the cheaper pose.
  Expected<PosedSize> StartWorstAgain(PosedSize size) const {
    const CapsuleBody body = BodyOf(size.scale);
    PoseState state = PosesOf(body, 1, size.scale);
    std::vector<double> costs;
    double least = std::numeric_limits<double>::max();  // cost per point
    for (std::size_t c = 0; c < clouds_.size(); ++c) {
      const auto cost = CostNear(size.poses[c], body, clouds_[c], state);
      if (!cost) return Forward(cost);
      costs.push_back(*cost);
      least = std::min(least, *cost / clouds_[c].size());
    }
    size.cost = 0.0;
    for (std::size_t c = 0; c < clouds_.size(); ++c) {
      if (costs[c] > kMuchWorse * least * clouds_[c].size()) {
        if (Status on = StopIfInterrupted(kWork); !on) return Forward(on);
        const auto start = FindStart(body, clouds_[c], 0, options_, state, StartSearch::kUprightAndLimbs);
        if (!start) return Forward(start);
        if (start->cost < costs[c]) {
          costs[c] = start->cost;
          size.poses[c] = state.FrameParameters(0);
        }
      }
      size.cost += costs[c];
    }
    return size;
  }

  /// The scale at a local minimum near `from`: lowest point of a parabola through three steps of its logarithm.
  Expected<PosedSize> Downhill(const PosedSize& from, double step) const {
    std::array<PosedSize, 3> sizes;  // smaller, middle, larger scale
    const auto fit = [&](std::size_t which, double scale, const PosedSize& near) -> Status {
      Expected<PosedSize> fitted = Fitted(scale, near.poses);
      if (!fitted) return Forward(fitted);
      sizes[which] = std::move(*fitted);
      return {};
    };
    const double factor = std::exp(step);
    if (Status ok = fit(1, from.scale, from); !ok) return Forward(ok);
    if (Status ok = fit(0, sizes[1].scale / factor, sizes[1]); !ok) return Forward(ok);
    if (Status ok = fit(2, sizes[1].scale * factor, sizes[1]); !ok) return Forward(ok);
    for (int i = 0; i < kSteps && std::min(sizes[0].cost, sizes[2].cost) < sizes[1].cost; ++i) {
      const bool down = sizes[0].cost < sizes[2].cost;
      // Rotate so that the cheapest is in the middle, and fit the outer one anew.
      std::rotate(sizes.begin(), sizes.begin() + (down ? 2 : 1), sizes.end());
      const double next = down ? sizes[1].scale / factor : sizes[1].scale * factor;
      if (Status ok = fit(down ? 0 : 2, next, sizes[1]); !ok) return Forward(ok);
    }
    const double curvature = sizes[0].cost + sizes[2].cost - 2.0 * sizes[1].cost;
    if (!(curvature > 0.0)) return sizes[1];
    // Without a bracketed minimum, limit the extrapolation.
    const double lowest = std::clamp(0.5 * (sizes[0].cost - sizes[2].cost) / curvature, -1.0, 1.0);
    Expected<PosedSize> refined = Fitted(sizes[1].scale * std::exp(step * lowest), sizes[1].poses);
    return !refined || refined->cost < sizes[1].cost ? refined : sizes[1];
  }

  /// Ratios of cloud height and body height, for clouds whose pose has a straight and upright leg.
  std::vector<double> HeightRatios(const PosedSize& size) const;

 private:
  CapsuleBody BodyOf(double scale) const { return CapsuleBody::Make(skeleton_, scale); }

  PoseState PosesOf(const CapsuleBody& body, int frames, double scale) const {
    std::vector<double> lengths = skeleton_->RestBoneLengths();
    for (double& length : lengths) length *= scale;
    return PoseState(*skeleton_, frames, lengths, body.MovingJoints());
  }

  /// Fits one cloud near a given pose, in the state's only frame; returns its cost.
  Expected<double> CostNear(const std::vector<double>& pose, const CapsuleBody& body, const FusedCloud& cloud,
                            PoseState& state) const {
    state.SetFrameParameters(0, pose);
    const FrameFit fit = ComparedFit(0, options_.iterations);
    const auto fitted = FitCloudFrame(body, cloud, fit, state, options_);
    if (!fitted) return Forward(fitted);
    return PoseCost(body, cloud, fit, state, options_);
  }

  /// Fits near the given poses, with radii estimated in between.
  Expected<PosedSize> Fitted(double scale, const std::vector<std::vector<double>>& poses) const {
    CapsuleBody body = BodyOf(scale);
    const auto frames = static_cast<int>(clouds_.size());
    PoseState state = PosesOf(body, frames, scale);
    for (int f = 0; f < frames; ++f) state.SetFrameParameters(f, poses[f]);
    for (int round = 0; round < kRadiusFits; ++round) {
      if (Status on = StopIfInterrupted(kWork); !on) return Forward(on);
      if (round > 0) CalibrateRadii(clouds_, state, 0, frames, options_.max_distance, body);
      for (int f = 0; f < frames; ++f) {
        const FrameFit fit = ComparedFit(f, options_.iterations);
        const auto fitted = FitCloudFrame(body, clouds_[f], fit, state, options_);
        if (!fitted) return Forward(fitted);
      }
    }
    PosedSize size{scale, 0.0, {}};
    for (int f = 0; f < frames; ++f) {
      size.cost += PoseCost(body, clouds_[f], ComparedFit(f, options_.iterations), state, options_);
      size.poses.push_back(state.FrameParameters(f));
    }
    return size;
  }

  SkeletonPtr skeleton_;
  const std::vector<FusedCloud>& clouds_;
  const PointCloudOptions& options_;
};

/// Height of a hip above its ankle as a share of thigh and shin, of the straighter leg. 0 for a skeleton without legs.
double StraightnessOfLegs(const Skeleton& skeleton, const PoseState& state, int frame) {
  const auto hips = LegsOfBody(skeleton);
  if (!hips) return 0.0;
  const auto children = skeleton.Children();
  double straightest = 0.0;
  for (const int hip : *hips) {
    const int knee = OnlyChild(children, hip);
    const int ankle = knee < 0 ? -1 : OnlyChild(children, knee);
    if (ankle < 0) continue;
    const double height = state.position(frame, hip).y() - state.position(frame, ankle).y();
    straightest = std::max(straightest, height / (*state.bone(knee) + *state.bone(ankle)));
  }
  return straightest;
}

std::vector<double> SizeSearch::HeightRatios(const PosedSize& size) const {
  const CapsuleBody body = BodyOf(size.scale);
  PoseState state = PosesOf(body, 1, size.scale);
  std::vector<double> ratios;
  for (std::size_t c = 0; c < clouds_.size(); ++c) {
    state.SetFrameParameters(0, size.poses[c]);
    state.Update(0, 1, false);
    if (StraightnessOfLegs(*skeleton_, state, 0) < kStraightLegs) continue;
    ratios.push_back(HeightOfPerson(clouds_[c], options_.voxel_size) / HeightOf(body, state, 0).height());
  }
  return ratios;
}

/// At most `count` clouds, spread over all heights.
std::vector<FusedCloud> OfAllHeights(std::vector<FusedCloud> clouds, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> order;  // height, cloud index
  for (std::size_t i = 0; i < clouds.size(); ++i) order.emplace_back(HeightOf(clouds[i].points).height(), i);
  std::sort(order.begin(), order.end());
  std::vector<FusedCloud> chosen;
  count = std::min(count, clouds.size());
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(std::move(clouds[order[(2 * i + 1) * clouds.size() / (2 * count)].second]));
  }
  return chosen;
}

/// Replaces each size by `improve` of it, sorts by cost and keeps at most `count`.
template <typename Improve>
Status ImproveEach(std::vector<PosedSize>& sizes, std::size_t count, const Improve& improve) {
  for (PosedSize& size : sizes) {
    Expected<PosedSize> better = improve(size);
    if (!better) return Forward(better);
    size = std::move(*better);
  }
  std::stable_sort(sizes.begin(), sizes.end(), [](const PosedSize& a, const PosedSize& b) { return a.cost < b.cost; });
  sizes.resize(std::min(sizes.size(), count));
  return {};
}

template <typename Factors>
std::vector<PosedSize> Scales(const Factors& factors, double from_height) {
  std::vector<PosedSize> sizes;
  for (const double factor : factors) sizes.push_back({factor * from_height, 0.0, {}});
  return sizes;
}

/// For many clouds, of which some show a pose that determines the size. With stances alone, arms in front of the chest
/// look like a larger body, so limbs are searched at sizes around the best.
Expected<PosedSize> BestOfMany(const SizeSearch& search, double from_height) {
  std::vector<PosedSize> sizes = Scales(kStartFactors, from_height);
  const auto stances = [&](const PosedSize& size) -> Expected<PosedSize> {
    const Expected<PosedSize> start = search.StartAt(size.scale, StartSearch::kUpright);
    return start ? search.Downhill(*start, kWideStep) : start;
  };
  if (Status ok = ImproveEach(sizes, 1, stances); !ok) return Forward(ok);
  std::vector<PosedSize> with_limbs = Scales(kFactorsOfLimbs, sizes[0].scale);
  const auto limbs = [&](const PosedSize& size) -> Expected<PosedSize> {
    Expected<PosedSize> found = search.SearchLimbsAt(size.scale, sizes[0]);
    return found ? search.Downhill(*found, kWideStep) : found;
  };
  if (Status ok = ImproveEach(with_limbs, 1, limbs); !ok) return Forward(ok);
  Expected<PosedSize> found = search.Downhill(with_limbs[0], kNarrowStep);
  if (!found) return found;
  Expected<PosedSize> started = search.StartWorstAgain(*found);
  if (!started) return started;
  Expected<PosedSize> again = search.Downhill(*started, kNarrowStep);
  return !again || again->cost < found->cost ? again : found;
}

/// For few clouds, in which the person may squat or be partly visible. Tries more sizes and searches limbs. The first
/// pose (TrackClouds) is later searched at this size with the same method, so the result of that search scores each
/// size. A refined size with the orientation reversed is rejected.
Expected<PosedSize> BestOfFew(const SizeSearch& search, double from_height) {
  std::vector<PosedSize> sizes = Scales(kFactorsOfFew, from_height);
  for (const double usual : kUsualScales) {
    if (usual > kFactorsOfFew.back() * from_height) sizes.push_back({usual, 0.0, {}});
  }
  const auto start = [&](const PosedSize& size) { return search.StartAt(size.scale, StartSearch::kUpright); };
  const auto limbs = [&](const PosedSize& size) { return search.StartAt(size.scale, StartSearch::kUprightAndLimbs); };
  if (Status ok = ImproveEach(sizes, kLimbsOfScales, start); !ok) return Forward(ok);
  if (Status ok = ImproveEach(sizes, kRefinedScales, limbs); !ok) return Forward(ok);
  const auto refine = [&](const PosedSize& size) -> Expected<PosedSize> {
    const Expected<PosedSize> refined = search.Downhill(size, kNarrowStep);
    if (!refined) return refined;
    Expected<PosedSize> found = limbs(*refined);
    if (!found) return found;
    if (found->cost >= size.cost) return size;
    found->cost = refined->cost;
    return found;
  };
  if (Status ok = ImproveEach(sizes, 1, refine); !ok) return Forward(ok);
  return sizes[0];
}

/// Costs of all points of a person's clouds, one after the other.
std::vector<double> CostsOfPoints(const ShapedPerson& person, const std::vector<FusedCloud>& clouds,
                                  const SkeletonPtr& skeleton, const PointCloudOptions& options) {
  const SkeletonPtr own = WithShape(skeleton, person.shape);
  const CapsuleBody body = CapsuleBody::Make(own, person.scale);
  std::vector<double> lengths = own->RestBoneLengths();
  for (double& length : lengths) length *= person.scale;
  PoseState state(*own, 1, lengths, body.MovingJoints());
  std::vector<double> costs;
  for (std::size_t c = 0; c < clouds.size(); ++c) {
    state.SetFrameParameters(0, person.poses[c]);
    state.Update(0, 1, false);
    const std::vector<double> of_cloud =
        PointCosts(body, clouds[c], ComparedFit(0, options.iterations), state, options);
    costs.insert(costs.end(), of_cloud.begin(), of_cloud.end());
  }
  return costs;
}

/// How much worse a person of a possible size explains the clouds than one of an impossible size.
CostDifference WorseBy(const ShapedPerson& possible, const ShapedPerson& impossible,
                       const std::vector<FusedCloud>& clouds, const SkeletonPtr& skeleton,
                       const PointCloudOptions& options) {
  const std::vector<double> costs = CostsOfPoints(possible, clouds, skeleton, options);
  const std::vector<double> others = CostsOfPoints(impossible, clouds, skeleton, options);
  CostDifference worse;
  auto from = static_cast<std::ptrdiff_t>(0);
  for (const FusedCloud& cloud : clouds) {
    const std::ptrdiff_t to = from + cloud.size();
    worse += Compare(cloud, {costs.begin() + from, costs.begin() + to}, {others.begin() + from, others.begin() + to});
    from = to;
  }
  return worse;
}

/// `sigma`: m, of the height; none: not known.
tl::unexpected<Error> NoPerson(double height, std::optional<double> sigma, const PointCloudOptions& options) {
  return Fail(ErrorCode::kInconsistent,
              "the person measures " + RoundedText(height, 3) + " m" +
                  (sigma ? " (standard deviation " + RoundedText(*sigma, 2) + " m)" : "") + ", people have " +
                  RoundedText(options.shortest, 3) + " to " + RoundedText(options.tallest, 3) + " m",
              "depth views",
              "check depth_unit and cameras, give the height (fitting.point_clouds.height), or change "
              "fitting.point_clouds.shortest and tallest");
}

/// The cheapest size of people among those found from the sizes of adults; empty: there is none. They may lie or
/// be bent over. Where a search leaves the sizes of people, it is its first size.
Expected<std::optional<PosedSize>> AmongAdults(const SizeSearch& search, const ScaleRange& people) {
  std::optional<PosedSize> best;
  for (const double usual : kUsualScales) {
    if (!people.Has(usual)) continue;
    const Expected<PosedSize> start = search.StartAt(usual, StartSearch::kStancesAndLimbs);
    if (!start) return Forward(start);
    Expected<PosedSize> found = search.Downhill(*start, kNarrowStep);
    if (!found) return Forward(found);
    if (!people.Has(found->scale)) found = *start;
    if (!best || found->cost < best->cost) best = *found;
  }
  return best;
}

/// Error where a person of an impossible size explains the clouds better than the possible one, and that size is
/// kClearlyWorse standard deviations beyond the sizes of people: it has the standard deviation at which the difference
/// between both sizes would be as certain as that of their costs.
Status RefuseImpossible(const ShapedPerson& impossible, const ShapedPerson& possible,
                        const std::vector<FusedCloud>& clouds, const SkeletonPtr& skeleton, const ScaleRange& people,
                        double rest_height, const PointCloudOptions& options) {
  const CostDifference worse = WorseBy(possible, impossible, clouds, skeleton, options);
  if (worse.sum <= 0.0) return {};
  const double sigma = std::abs(impossible.scale - possible.scale) * worse.sigma() / worse.sum;
  const double beyond = std::max(people.least - impossible.scale, impossible.scale - people.most);
  if (beyond < kClearlyWorse * sigma) return {};
  return NoPerson(impossible.scale * rest_height, sigma * rest_height, options);
}

}  // namespace

Expected<ShapedPerson> PersonFromClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                        const PointCloudOptions& options) {
  ShapedPerson person;
  if (options.height) {
    person.scale = *options.height / HeightOfRestBody(skeleton);
    return person;
  }
  const double rest_height = HeightOfRestBody(skeleton);
  const ScaleRange people{options.shortest / rest_height, options.tallest / rest_height};
  clouds.erase(std::remove_if(clouds.begin(), clouds.end(),
                              [](const FusedCloud& cloud) { return cloud.size() < kFewestPoints; }),
               clouds.end());
  if (clouds.empty()) return person;
  const double from_height = ScaleFromHeight(rest_height, clouds, people, options.voxel_size);
  const bool few = clouds.size() <= kFewClouds;
  const std::vector<FusedCloud> chosen = OfAllHeights(std::move(clouds), kClouds);
  const SizeSearch search(skeleton, chosen, options);
  Expected<PosedSize> best = few ? BestOfFew(search, from_height) : BestOfMany(search, from_height);
  if (!best) return Forward(best);
  person.scale = best->scale;
  person.poses = best->poses;
  std::optional<ShapedPerson> impossible;
  if (!people.Has(best->scale)) {
    Expected<std::optional<PosedSize>> adult = AmongAdults(search, people);
    if (!adult) return Forward(adult);
    if (!*adult) return NoPerson(best->scale * rest_height, {}, options);
    impossible = person;
    *best = **std::move(adult);
    person.scale = best->scale;
    person.poses = best->poses;
  }
  const bool has_shape = HasTemplateShape(*skeleton);
  if (has_shape) {
    const auto shaped = [&](const ShapedPerson& from) { return FitShape(chosen, skeleton, from, options); };
    Expected<ShapedPerson> found = shaped(person);
    if (!found) return found;
    if (impossible) {
      const Expected<ShapedPerson> other = shaped(*impossible);
      if (!other) return other;
      impossible = *other;
    }
    if (!people.Has(found->scale)) {
      if (!impossible) impossible = *found;
      person.scale_sigma = kHeldScale;
      found = shaped(person);
      if (!found) return found;
    }
    person = *std::move(found);
  }
  if (impossible && people.Has(impossible->scale)) {  // with its own shape
    if (WorseBy(person, *impossible, chosen, skeleton, options).sum > 0.0) person = *impossible;
    impossible.reset();
  }
  if (impossible) {
    if (Status kept = RefuseImpossible(*impossible, person, chosen, skeleton, people, rest_height, options); !kept)
      return Forward(kept);
  }
  if (has_shape) return person;
  if (few) return person;
  std::vector<double> ratios = search.HeightRatios(*best);
  if (!ratios.empty()) person.scale *= MeanMedian(ratios);
  return person;
}

}  // namespace mocurate
