#include "fitting/clouds/rig_exchange.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {
namespace {

constexpr double kWrongLoss = 0.2;            ///< loss of all views as given, at least
constexpr double kMuchBetterExchanged = 0.6;  ///< of the loss as given
constexpr double kEqualLossRatio = 1.15;      ///< ratio of two losses that count as equal

using Source = std::vector<std::size_t>;

bool MayBe(const Source& source, const ObservedRig& rig) {
  for (std::size_t v = 0; v < source.size(); ++v) {
    const Camera &camera = rig.views[v].camera, &other = rig.views[source[v]].camera;
    if (camera.width != other.width || camera.height != other.height) return false;
  }
  return true;
}

/// The surface of a camera whose images are those of another one's file.
ViewSurface SurfaceFor(const Camera& camera, const Camera& other, const ViewSurface& surface) {
  ViewSurface seen = surface;
  for (Eigen::Index i = 0; i < seen.points.cols(); ++i) {
    if (const auto pixel = other.Project(seen.points.col(i))) {
      seen.points.col(i) = camera.Unproject(*pixel, seen.points(2, i));
    }
  }
  return seen;
}

/// The rig with each camera's images from another one's files. Caches surfaces.
class ExchangedRigs {
 public:
  explicit ExchangedRigs(const ObservedRig& rig) : rig_(rig) {}

  ObservedRig With(const Source& source) {
    ObservedRig exchanged = rig_;
    for (std::size_t m = 0; m < rig_.moments.size(); ++m) {
      for (std::size_t v = 0; v < source.size(); ++v) exchanged.moments[m][v] = At(m, v, source[v]);
    }
    return exchanged;
  }

 private:
  const ViewSurface* At(std::size_t moment, std::size_t view, std::size_t source) {
    const ViewSurface* given = rig_.moments[moment][source];
    if (given == nullptr || view == source) return given;
    std::unique_ptr<ViewSurface>& made = made_[{moment, view, source}];
    if (made == nullptr) {
      made = std::make_unique<ViewSurface>(SurfaceFor(rig_.views[view].camera, rig_.views[source].camera, *given));
    }
    return made.get();
  }

  const ObservedRig& rig_;
  std::map<std::array<std::size_t, 3>, std::unique_ptr<ViewSurface>> made_;
};

}  // namespace

std::optional<FileExchange> FindFileExchange(const ObservedRig& rig, const std::vector<double>& losses) {
  const double given = MeanLoss(losses);
  if (given < kWrongLoss || rig.views.size() > kMostViewsAudited) return {};
  std::optional<FileExchange> best;
  std::vector<std::vector<double>> all;
  std::size_t chosen = 0;
  const std::vector<Camera> cameras = CamerasOf(rig.views);
  ExchangedRigs exchanged(rig);
  for (const Source& source : FileExchanges(rig.views.size())) {
    if (!MayBe(source, rig)) continue;
    all.push_back(LossOfSamples(exchanged.With(source), cameras));
    const double loss = MeanLoss(all.back());
    if (loss > kMuchBetterExchanged * given || (best && loss >= best->exchanged)) continue;
    best = FileExchange{source, given, loss, true, 0.0};
    chosen = all.size() - 1;
  }
  if (!best) return {};
  const std::vector<double> held_out = HeldOutCosts(all, HalvesOfSamples(rig));
  best->confidence = ConfidenceOfLosses(rig, losses, held_out);
  for (std::size_t i = 0; i < all.size(); ++i) {
    best->unique = best->unique && (i == chosen || MeanLoss(all[i]) > kEqualLossRatio * best->exchanged);
    if (i != chosen) best->confidence = std::min(best->confidence, ConfidenceOfLosses(rig, all[i], held_out));
  }
  return best;
}

std::vector<DepthView> WithExchangedFiles(const std::vector<DepthView>& views, const std::vector<std::size_t>& source) {
  std::vector<DepthView> exchanged = views;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const DepthView& from = views[source[v]];
    exchanged[v].files = from.files;
    exchanged[v].sha256 = from.sha256;
    exchanged[v].masks = from.masks;
    exchanged[v].mask_sha256 = from.mask_sha256;
    exchanged[v].time_s = from.time_s;
    exchanged[v].metres_per_unit = from.metres_per_unit;
  }
  return exchanged;
}

RigFault ExchangedFiles(const std::vector<std::string>& cameras, const FileExchange& exchange) {
  RigFault fault = MakeFault("cameras_exchanged", "", exchange.exchanged, "");
  fault.confidence = exchange.confidence;
  std::string pairs;
  for (std::size_t v = 0; v < exchange.source.size(); ++v) {
    if (exchange.source[v] == v) continue;
    fault.camera += (fault.camera.empty() ? "" : ", ") + cameras[v];
    pairs += (pairs.empty() ? "" : ", ") + cameras[v] + " in those of " + cameras[exchange.source[v]];
  }
  fault.message =
      exchange.unique
          ? "the files of depth cameras are exchanged: images of " + pairs + "; so " +
                RoundedText(100.0 * exchange.exchanged, 2) + " % of their points contradict the others, as given " +
                RoundedText(100.0 * exchange.loss, 2) + " %"
          : "the files of depth cameras are exchanged, but which ones is ambiguous: the rig is symmetric, and "
            "more than one exchange explains the views";
  return fault;
}

}  // namespace mocurate
