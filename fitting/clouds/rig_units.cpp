#include "fitting/clouds/rig_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// Factor on all lengths for each wrong unit (numerical).
constexpr std::array<double, 6> kDepthUnitFactors = {1000.0, 100.0, 10.0, 0.1, 0.01, 0.001};
/// m; height of the visible part of a person, for the choice of a unit.
constexpr double kUsualHeight = 1.6;
constexpr double kLowestObserved = 0.3;   ///< m, smallest height of the visible part of a person
constexpr double kTallestObserved = 2.8;  ///< m; largest height of the visible part of a person
constexpr double kOverlapShare = 0.2;     ///< of a view's points in the images of the others; with fewer, views do not
                                          ///< overlap
/// Share of a view's points in the images of the others that another unit must give.
constexpr double kCorrectedShare = 0.5;
constexpr double kCorrectedLoss = 0.35;  ///< loss that another unit may leave, at most

/// Median height of the person's points over views; 0 without a person.
double HeightIn(const ObservedRig& rig) {
  std::vector<double> heights;
  for (const ObservedMoment& moment : rig.moments) {
    for (std::size_t v = 0; v < moment.size(); ++v) {
      if (moment[v] == nullptr) continue;
      const Vector3d up = rig.views[v].camera.camera_from_world.rotation * Vector3d::UnitY();
      const Eigen::RowVectorXd height = up.transpose() * moment[v]->points;
      heights.push_back(height.maxCoeff() - height.minCoeff());
    }
  }
  return heights.empty() ? 0.0 : MeanMedian(heights);
}

bool HasHeightOfPerson(double height) { return height > kLowestObserved && height < kTallestObserved; }

/// Share of the points in the images of other views, and the loss there.
std::pair<double, double> OverlapWithOthers(const ObservedRig& rig, double places) {
  double points = 0.0, looked_at = 0.0, loss = 0.0;
  std::vector<Camera> cameras = CamerasOf(rig.views);
  for (Camera& camera : cameras) camera.camera_from_world.translation /= places;
  for (const ObservedMoment& moment : rig.moments) {
    for (const auto& [a, b] : rig.pairs) {
      if (moment[a] == nullptr || moment[b] == nullptr) continue;
      for (const auto& [of, in] : {std::pair(a, b), std::pair(b, a)}) {
        const Agreement agreement = Compare({*moment[of], rig.views[of], cameras[of]},
                                            {*moment[in], rig.views[in], cameras[in]}, rig.centre, 0.05);
        points += agreement.points;
        looked_at += agreement.looked_at;
        loss += agreement.loss;
      }
    }
  }
  return {points > 0.0 ? looked_at / points : 1.0, looked_at > 0.0 ? loss / looked_at : 1.0};
}

std::string Times(double factor, const char* what) {
  std::string words = std::string(what) + " " + RoundedText(std::max(factor, 1.0 / factor), 4) + " times too " +
                      (factor > 1.0 ? "long" : "short");
  if (factor == 1000.0) words += " (millimetres read as metres)";
  if (factor == 100.0) words += " (centimetres read as metres)";
  if (factor == 0.001) words += " (metres read as millimetres)";
  return words;
}

}  // namespace

Expected<std::optional<MisreadLengths>> FindMisreadLengths(DepthRigSampler& sampler) {
  const std::vector<int> as_given(sampler.views().size(), 0);
  Expected<ObservedRig> rig = sampler.Seen(as_given);
  if (!rig) return Forward(rig);
  MisreadLengths misread;
  std::optional<DepthRigSampler> other;
  if (!HasHeightOfPerson(HeightIn(*rig))) {
    double nearest = std::numeric_limits<double>::max();
    for (const double factor : kDepthUnitFactors) {
      DepthRigSampler scaled(WithLengths(sampler.views(), {factor, 1.0}));
      Expected<ObservedRig> seen = scaled.Seen(as_given);
      if (!seen) return Forward(seen);
      const double height = HeightIn(*seen);
      const double off = height > 0.0 ? std::abs(std::log(height / kUsualHeight)) : nearest;
      if (!HasHeightOfPerson(height) || off >= nearest) continue;
      nearest = off;
      misread.depth = factor;
      other = std::move(scaled);
    }
    if (misread.depth == 1.0) return std::optional<MisreadLengths>();
    rig = other->Seen(as_given);
  }
  if (OverlapWithOthers(*rig, 1.0).first < kOverlapShare) {
    double least = kCorrectedLoss;
    for (const double factor : kDepthUnitFactors) {
      const auto [share, loss] = OverlapWithOthers(*rig, factor);
      if (share < kCorrectedShare || loss >= least) continue;
      least = loss;
      misread.places = factor;
    }
  }
  if (misread.depth == 1.0 && misread.places == 1.0) return std::optional<MisreadLengths>();
  return std::optional<MisreadLengths>(misread);
}

std::vector<DepthView> WithLengths(std::vector<DepthView> views, const MisreadLengths& misread) {
  for (DepthView& view : views) {
    view.metres_per_unit /= misread.depth;
    view.camera.camera_from_world.translation /= misread.places;
  }
  return views;
}

std::string WordsOf(const MisreadLengths& misread) {
  std::string words;
  if (misread.depth != 1.0) words = Times(misread.depth, "depths are");
  if (misread.places == 1.0) return words;
  return words + (words.empty() ? "" : ", ") + Times(misread.places, "places of cameras are");
}

}  // namespace mocurate
