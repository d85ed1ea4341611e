#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/geometry/camera.h"
#include "fitting/options.h"

namespace mocurate {

/// Fewest views of an audited rig: of two that disagree, the wrong one is ambiguous (numerical).
inline constexpr std::size_t kLeastViewsAudited = 3;
/// Most views for clocks, moves and exchanged files: the time of a search grows with their square. With more views, the
/// others outvote two (numerical).
inline constexpr std::size_t kMostViewsAudited = 12;
/// m at the person; smaller moves of a camera are not reported.
inline constexpr double kLeastMove = 0.008;

/// Views that contradict others; corrected: they are excluded.
inline constexpr const char* kContradictingView = "views_disagree";

/// Samples whose variation gives a confidence.
enum class ConfidenceOf {
  kSpansOfOneTake,  ///< spans of one take: of errors that last for the whole take it knows nothing
  kTakes,           ///< several takes of one rig
  kModel,           ///< none: a likelihood under a model of the fault, or a comparison that is exact
};
/// "spans_of_one_take", "takes", "model".
std::string_view Name(ConfidenceOf of);

/// A problem of a rig, its calibration or its files.
struct RigFault {
  std::string code;  ///< "camera_clock_off", "camera_moved", "cameras_exchanged", "calibration_unit", "keypoint_order",
                     ///< "view_swaps_sides", "views_swap_sides", "views_disagree", "view_mirrored", "keypoint_scale",
                     ///< "cameras_in_one_place"
  std::string camera;   ///< name; empty: the rig
  std::string limb;     ///< affected limb; empty: none
  int frame_begin = 0;  ///< [begin, end) of the take; both 0: all of it
  int frame_end = 0;
  double value = 0.0;       ///< of the code: ms, mm, share of entries that agree, factor, mean departure, margin
  double confidence = 0.0;  ///< [0, 1]; 1 - confidence bounds the probability that the fault does not exist
  ConfidenceOf confidence_of = ConfidenceOf::kSpansOfOneTake;
  bool corrected = false;
  bool guessed = false;  ///< likely, but below the required confidence: reported without effect
  std::string message;
};

/// Of a camera, or of the rig (empty). The audit sets confidence and correction.
RigFault MakeFault(std::string code, std::string camera, double value, std::string message);
Finding FindingOf(const RigFault& fault);

/// A confidence to four digits, rounded down.
double RoundedConfidence(double confidence);
/// "confidence 99.92 % within this take", "confidence 99.92 %".
std::string ConfidenceText(double confidence, ConfidenceOf of);

/// Code of the finding that clocks, poses or files could not be audited.
inline constexpr const char* kRigNotAudited = "rig_not_audited";
/// Code of a fault that a take's own audit finds although the take uses an audited rig (RigFile).
inline constexpr const char* kRigContradicted = "rig_contradicted";
/// The finding of such a fault.
Finding ContradictionOfRig(const RigFault& fault);

/// Whether a problem is certain and was not corrected. Excludes "views_disagree": keypoint views are excluded only
/// where they disagree.
bool IsAmbiguous(const RigFault& fault);

/// [{"code", "camera", "frames", "value", "confidence", "confidence_of", "corrected"}], one line: a clip's provenance
/// entry.
inline constexpr const char* kRigAudit = "rig_audit";
nlohmann::json FaultsJson(const std::vector<RigFault>& faults);
std::string FaultsText(const std::vector<RigFault>& faults);

/// Exchanges of whole files among cameras: the camera whose files each one has. All permutations of up to five views,
/// of more those of two.
std::vector<std::vector<std::size_t>> FileExchanges(std::size_t views);

// Faults of cameras with code, camera, frames, value and message. The audit sets confidence and correction.

/// `later_s`: clock offset of the camera relative to the others, seconds; its standard deviation, if known; `worse`:
/// relative increase of the cost without the offset.
RigFault ClockOff(const std::string& camera, double later_s, std::optional<double> sigma_s, double worse);

/// A camera that lists left as right in all frames of a take. `margin`: log-likelihood ratio.
RigFault SidesExchanged(const std::string& camera, int frames, double margin);

/// A camera whose pose differs from that of `reference` ("its calibration"), in frames [begin, end) of a take of
/// `frames`.
RigFault CameraMoved(const Camera& was, const Camera& is, const std::string& reference, int begin, int end, int frames);

/// Moments of a take that are compared, at most (numerical).
inline constexpr std::size_t kMomentsOfTake = 64;
/// Fewest parts of a take for a standard error.
inline constexpr std::size_t kFewestSpans = 5;

/// Confidence that costs `better` are lower than `worse`, in [0, 1]: that their differences, as shares of their sums,
/// are above 0 in the mean, by Student's t. Samples are in order of time, and neighbours may be correlated. So the
/// standard error is also estimated from the means of ever longer spans (down to kFewestSpans of a take), and the
/// lowest confidence counts. What was fitted to the samples, or chosen by them, always seems better: compare held-out
/// costs.
double Confidence(const std::vector<double>& worse, const std::vector<double>& better);

/// Confidence for independent samples.
double ConfidenceOfSeparate(const std::vector<double>& worse, const std::vector<double>& better);

/// Confidence that the mean of independent numbers is above 0.
double ConfidenceAboveZero(const std::vector<double>& numbers);

/// Confidence that a number `sigmas` standard errors from 0 is not 0, with the standard error from `spans` spans.
double SpanConfidence(double sigmas, std::size_t spans);

/// Half (0, 1) to which each of `count` samples of one or several takes belongs: alternate spans, kFewestSpans of a
/// take in each half.
std::vector<int> HalvesOf(std::size_t count);

/// The first half of them, then the second: what is chosen by one is judged by samples farther away in time.
std::vector<int> FirstAndSecondHalf(std::size_t count);

/// Costs of the samples, each half under the candidate of the lowest mean cost over the other half. `candidates`: costs
/// of all samples under each, negative where there is none; `halves`: 0 or 1 per sample.
std::vector<double> HeldOutCosts(const std::vector<std::vector<double>>& candidates, const std::vector<int>& halves);

/// Tests of each view of a rig: clock, pose, and sides (depths, of a depth camera).
inline constexpr std::size_t kTestsOfView = 3;

/// Confidence of one of several tests, so that 1 - confidence bounds the probability that any of them errs
/// (Bonferroni).
double ConfidenceOfTests(double confidence, std::size_t tests);

/// Cumulative standard normal distribution.
double NormalShare(double z);

/// Text for messages: "depth views", and the option for wrong files.
struct RigWords {
  std::string views;
  std::string option;
};

/// Share [0, 1] of the samples of views `a` and `b` that are equal; negative when neither has any.
using Similarity = std::function<Expected<double>(std::size_t a, std::size_t b)>;

/// Groups of two and more cameras with one pose in their calibrations, whatever their lenses: indices, increasing.
std::vector<std::vector<std::size_t>> CamerasInOnePlace(const std::vector<Camera>& cameras);

/// Code of cameras with one pose in their calibrations.
inline constexpr const char* kOnePlace = "cameras_in_one_place";

/// One "cameras_in_one_place" per group (value: share of equal samples), not corrected. Views of a group that are equal
/// are one view given twice. Error kInconsistent where views of a group differ and `action` is kCorrect, because
/// different images cannot come from one pose. Errors of `alike`.
Expected<std::vector<RigFault>> FaultsOfSharedPlaces(const std::vector<Camera>& cameras, const Similarity& alike,
                                                     AuditAction action, const RigWords& kind);

/// Whether one of the faults reports different views with one pose.
bool PlacesAreCopied(const std::vector<RigFault>& faults);

}  // namespace mocurate
