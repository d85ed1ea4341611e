#include "fitting/audit/cameras_in_one_place.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

/// Rad, and metres per metre (and metre of distance from the origin): rounding error of a copied pose. Lenses of two
/// cameras are centimetres apart; thousandths of that when millimetres were read as kilometres (numerical).
constexpr double kSamePose = 1e-6;
/// Share of equal samples from which two views count as one: files of one sensor differ by a filter or a delay of a
/// frame. Synthetic depth views from different sides share up to 0.05, views of one camera a frame apart 0.66 to 0.94
/// (one jump 0.1). Source: synthetic depth views (0.05, and 0.66 to 0.94)
constexpr double kSameView = 0.6;

bool StandInOnePlace(const Camera& a, const Camera& b) {
  const RigidTransform &one = a.camera_from_world, &other = b.camera_from_world;
  return (one.translation - other.translation).norm() <= kSamePose * (1.0 + one.translation.norm()) &&
         one.rotation.angularDistance(other.rotation) <= kSamePose;
}

RigFault InOnePlace(const std::vector<Camera>& cameras, const std::vector<std::size_t>& group, double share) {
  RigFault fault;
  fault.code = kOnePlace;
  fault.value = share;
  fault.confidence = 1.0;
  fault.confidence_of = ConfidenceOf::kModel;
  for (const std::size_t v : group) fault.camera += (fault.camera.empty() ? "" : ", ") + cameras[v].name;
  fault.message = "cameras " + fault.camera + " stand in one place with one orientation by their calibrations, ";
  const std::string equal = RoundedText(100.0 * share, 2) + " % of their content is equal";
  if (share < 0.0) {
    fault.message += "and their views are empty: check whether one calibration was copied";
  } else if (share < kSameView) {
    fault.message += "but only " + equal + ": one camera's calibration was given for all of them";
  } else {
    fault.message += "and " + equal + ": one camera's files were given twice; exclude the copy";
  }
  return fault;
}

}  // namespace

std::vector<std::vector<std::size_t>> CamerasInOnePlace(const std::vector<Camera>& cameras) {
  std::vector<std::vector<std::size_t>> groups;
  std::vector<bool> taken(cameras.size(), false);
  for (std::size_t a = 0; a < cameras.size(); ++a) {
    if (taken[a]) continue;
    std::vector<std::size_t> group = {a};
    for (std::size_t b = a + 1; b < cameras.size(); ++b) {
      if (taken[b] || !StandInOnePlace(cameras[a], cameras[b])) continue;
      taken[b] = true;
      group.push_back(b);
    }
    if (group.size() > 1) groups.push_back(std::move(group));
  }
  return groups;
}

Expected<std::vector<RigFault>> FaultsOfSharedPlaces(const std::vector<Camera>& cameras, const Similarity& alike,
                                                     AuditAction action, const RigKind& kind) {
  std::vector<RigFault> faults;
  if (action == AuditAction::kOff) return faults;
  for (const std::vector<std::size_t>& group : CamerasInOnePlace(cameras)) {
    double least = 1.0;
    for (std::size_t i = 1; i < group.size(); ++i) {
      const Expected<double> share = alike(group[0], group[i]);
      if (!share) return Forward(share);
      least = std::min(least, *share);
    }
    RigFault fault = InOnePlace(cameras, group, least);
    if (action == AuditAction::kCorrect && least >= 0.0 && least < kSameView) {
      return Fail(ErrorCode::kInconsistent, fault.message, kind.views,
                  "give each camera its own calibration (is one file copied, or read for all cameras?), or set " +
                      kind.option + ": report to use them as given");
    }
    faults.push_back(std::move(fault));
  }
  return faults;
}

bool PlacesAreCopied(const std::vector<RigFault>& faults) {
  return std::any_of(faults.begin(), faults.end(), [](const RigFault& fault) {
    return fault.code == kOnePlace && fault.value >= 0.0 && fault.value < kSameView;
  });
}

}  // namespace mocurate
