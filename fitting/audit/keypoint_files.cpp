#include "fitting/audit/keypoint_files.h"

#include <cmath>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/exchanged_views.h"
#include "fitting/audit/view_readings.h"

namespace mocurate {
namespace {

std::string PercentText(double share) { return std::to_string(std::lround(100.0 * share)); }

void ReadViews(Evidence& evidence, const std::vector<KnownLength>& lengths, const KeypointFitOptions& options,
               std::vector<RigFault>& faults) {
  const auto reading =
      FindMisreadViews(evidence.keypoint_views, evidence.keypoint_names, lengths, options.triangulation.min_confidence);
  if (!reading || reading->confidence < options.audit.sure) return;
  RigFault fault;
  fault.code = reading->mirrored ? "view_mirrored" : "keypoint_scale";
  fault.value = reading->mirrored ? reading->read : reading->factor;
  fault.confidence = reading->confidence;
  fault.corrected = options.audit.exchanged == AuditAction::kCorrect;
  for (const std::size_t v : reading->views) {
    fault.camera += (fault.camera.empty() ? "" : ", ") + evidence.keypoint_views[v].camera.name;
  }
  fault.message =
      reading->mirrored
          ? "keypoints of camera " + fault.camera + " are of a mirrored image, x counts from the right" +
                std::string(reading->sides ? " and left is called right" : "")
          : "keypoints of camera " + fault.camera +
                " are of images of another size than the calibration: " + "their pixels must be multiplied by " +
                RoundedText(reading->factor, 3);
  fault.message += "; so " + PercentText(reading->read) + " % of the entries agree with others, as given " +
                   PercentText(reading->agreement) + " %";
  if (fault.corrected)
    evidence.keypoint_views = WithReading(std::move(evidence.keypoint_views), evidence.keypoint_names, *reading);
  faults.push_back(std::move(fault));
}

void ExchangeViews(Evidence& evidence, const std::vector<KnownLength>& lengths, const KeypointFitOptions& options,
                   std::vector<RigFault>& faults) {
  if (options.audit.exchanged == AuditAction::kOff) return;
  const auto keypoints = static_cast<int>(evidence.keypoint_names.size());
  const auto exchange =
      FindExchangedViews(evidence.keypoint_views, keypoints, lengths, options.triangulation.min_confidence);
  if (!exchange) return;
  RigFault fault;
  fault.code = "cameras_exchanged";
  fault.value = exchange->exchanged;
  fault.confidence = exchange->confidence;
  fault.corrected = options.audit.exchanged == AuditAction::kCorrect && exchange->confidence >= options.audit.sure;
  std::string pairs;
  for (std::size_t v = 0; v < exchange->source.size(); ++v) {
    if (exchange->source[v] == v) continue;
    const std::string& camera = evidence.keypoint_views[v].camera.name;
    fault.camera += (fault.camera.empty() ? "" : ", ") + camera;
    pairs += (pairs.empty() ? "" : ", ") + camera + " in those of " +
             evidence.keypoint_views[exchange->source[v]].camera.name;
  }
  fault.message = "what cameras see lies in each other's files: " + pairs + "; so " + PercentText(exchange->exchanged) +
                  " % of the entries agree with others, as the files are " + PercentText(exchange->agreement) + " %";
  if (fault.corrected) evidence.keypoint_views = WithExchangedViews(evidence.keypoint_views, exchange->source);
  faults.push_back(std::move(fault));
}

}  // namespace

void MendFiles(Evidence& evidence, const std::vector<KnownLength>& lengths, const KeypointFitOptions& options,
               std::vector<RigFault>& faults) {
  if (options.audit.exchanged == AuditAction::kOff) return;
  ReadViews(evidence, lengths, options, faults);
  if (faults.empty() || faults.back().corrected) ExchangeViews(evidence, lengths, options, faults);
}

}  // namespace mocurate
