#include "fitting/clouds/rig_common_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {
namespace {

/// Loss as given from which common faults are tested. For 30 correct synthetic takes it is 0.07 to 0.09. With all
/// depths 1.1 times too long it is 0.44 to 0.54, with 0.92 times 0.61 to 0.82, with all images mirrored 0.59 to 0.68.
/// After correction it is 0.06 to 0.10 (bench_depth_rigs 30 15 907).
constexpr double kContradictingLoss = 0.12;
/// Share of that loss; after correction 0.1 to 0.2 remain. Source: bench_depth_rigs 30 15 907
constexpr double kMuchBetterInCommon = 0.6;
constexpr double kLongestFactor = 1.4;   ///< factor on all depths; beyond, a unit is wrong (FindMisreadLengths)
constexpr double kShortestFactor = 0.7;  ///< factor, likewise
constexpr double kCoarseStep = 0.05;     ///< step of the factor in the first search (numerical)
constexpr double kFinestStep = 0.003;    ///< step of the factor in the last search (numerical)
constexpr double kLeastOff = 0.02;       ///< factor; smallest difference from 1 that is reported

/// A rig with modified surfaces.
struct ChangedRig {
  ObservedRig rig;
  std::deque<ViewSurface> surfaces;
};

template <typename Change>
ChangedRig Changed(const ObservedRig& given, const Change& change) {
  ChangedRig changed{given, {}};
  for (ObservedMoment& moment : changed.rig.moments) {
    for (std::size_t v = 0; v < moment.size(); ++v) {
      if (moment[v] == nullptr) continue;
      changed.surfaces.push_back(*moment[v]);
      change(given.views[v], changed.surfaces.back());
      moment[v] = &changed.surfaces.back();
    }
  }
  return changed;
}

ChangedRig Scaled(const ObservedRig& given, double factor) {
  ChangedRig scaled = Changed(given, [&](const DepthView&, ViewSurface& surface) { surface.points *= factor; });
  for (DepthView& view : scaled.rig.views) view.metres_per_unit *= factor;
  return scaled;
}

/// Mirrors a view's surface as if its image were mirrored.
void MirrorSurface(const DepthView& view, ViewSurface& surface) {
  DepthImage image = *surface.image;
  for (int y = 0; y < image.height; ++y) {
    const auto row = image.values.begin() + static_cast<std::ptrdiff_t>(y) * image.width;
    std::reverse(row, row + image.width);
  }
  for (Eigen::Index i = 0; i < surface.points.cols(); ++i) {
    const auto pixel = view.camera.Project(surface.points.col(i));
    if (!pixel) continue;
    const Vector2d reflected(image.width - 1 - pixel->x(), pixel->y());
    surface.points.col(i) = view.camera.Unproject(reflected, surface.points(2, i));
  }
  surface.normals.row(0) *= -1.0;
  surface.left = image.width - (surface.left + kOutlineCell * surface.columns);
  for (int row = 0; row < surface.rows; ++row) {
    const auto first = surface.nearest.begin() + static_cast<std::ptrdiff_t>(row) * surface.columns;
    std::reverse(first, first + surface.columns);
  }
  for (std::int32_t& nearest : surface.nearest) {
    if (nearest < 0) continue;
    nearest += surface.columns - 1 - 2 * (nearest % surface.columns);
  }
  surface.image = std::make_shared<const DepthImage>(std::move(image));
}

}  // namespace

std::vector<DepthView> WithAllDepths(std::vector<DepthView> views, double factor) {
  for (DepthView& view : views) view.metres_per_unit *= factor;
  return views;
}

std::optional<CommonFault> FindCommonFault(const ObservedRig& rig, const std::vector<double>& losses) {
  if (rig.views.size() < kLeastViewsAudited || rig.views.size() > kMostViewsAudited) return {};
  CommonFault found;
  found.loss = found.loss_after = MeanLoss(losses);
  if (found.loss < kContradictingLoss) return {};
  const std::vector<Camera> cameras = CamerasOf(rig.views);
  std::vector<std::vector<double>> candidates{losses};
  const auto improves = [&](const ChangedRig& changed) {
    candidates.push_back(LossOfSamples(changed.rig, cameras));
    const double loss = MeanLoss(candidates.back());
    if (loss >= found.loss_after) return false;
    found.loss_after = loss;
    return true;
  };
  for (double factor = kShortestFactor; factor <= kLongestFactor; factor += kCoarseStep) {
    if (improves(Scaled(rig, factor))) found.factor = factor;
  }
  for (double step = 0.5 * kCoarseStep; step >= kFinestStep; step *= 0.5) {
    const double middle = found.factor;
    for (const double factor : {middle - step, middle + step}) {
      if (improves(Scaled(rig, factor))) found.factor = factor;
    }
  }
  if (improves(Changed(rig, MirrorSurface))) found.mirrored = true, found.factor = 1.0;
  const bool off = found.mirrored || std::abs(found.factor - 1.0) >= kLeastOff;
  if (!off || found.loss_after > kMuchBetterInCommon * found.loss) return {};
  found.confidence = ConfidenceOfLosses(rig, losses, HeldOutCosts(candidates, HalvesOfSamples(rig)));
  return found;
}

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

RigFault LengthsMisread(const MisreadLengths& misread) {
  RigFault fault =
      MakeFault("calibration_unit", "", misread.depth != 1.0 ? misread.depth : misread.places, WordsOf(misread));
  fault.confidence = 1.0;
  fault.confidence_of = ConfidenceOf::kModel;
  fault.corrected = true;
  return fault;
}

RigFault FaultOfAll(const std::vector<std::string>& cameras, const CommonFault& common, const ObservedRig& rig) {
  const std::string loss = "; after a correction, " + RoundedText(100.0 * common.loss_after, 2) +
                           " % of their points contradict the others, as given " + RoundedText(100.0 * common.loss, 2) +
                           " %";
  if (common.mirrored)
    return MakeFault("view_mirrored", JoinTexts(cameras), common.loss_after,
                     "images of all depth cameras are mirrored (x counts from the right)" + loss);
  double distance = 0.0;
  for (const DepthView& view : rig.views)
    distance += (rig.centre - view.camera.Centre()).norm() / static_cast<double>(rig.views.size());
  const double off_mm = 1e3 * distance * (1.0 - common.factor);
  return MakeFault("camera_depths_off", JoinTexts(cameras), off_mm,
                   "depths of all cameras are too " + std::string(common.factor < 1.0 ? "long" : "short") +
                       " by a factor of " + RoundedText(1.0 / common.factor, 3) + ", " +
                       RoundedText(std::abs(off_mm), 2) + " mm at the person" + loss);
}

}  // namespace mocurate
