#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/rotation.h"
#include "core/motion/skeleton.h"

/// How well stated standard deviations agree with errors against ground truth (docs/uncertainty.md). Nothing is drawn
/// or binned: the same samples give the same numbers. A measure that is undefined is empty.
namespace mocurate {

/// Joint errors above are large: the threshold of arXiv:2603.26844, which states a ROC-AUC for them.
inline constexpr double kLargeErrorMm = 50.0;
/// A ROC-AUC of fewer large or fewer other errors is not stated: chosen, its standard error is 0.1 and more.
inline constexpr std::int64_t kFewestOfClass = 10;

/// The stated standard deviation and the size of one error, in one unit.
struct SigmaAndError {
  float sigma = 0.0F;
  float error = 0.0F;
};

/// Numbers of errors that lie within multiples of their stated standard deviation.
struct Calibration {
  /// Nominal probabilities of central intervals of the normal distribution.
  static constexpr std::array<double, 10> kLevels = {0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95};

  std::int64_t components = 0;
  std::array<std::int64_t, 12> within_quarters{};  ///< within 0.25, 0.5, ..., 3 standard deviations
  std::array<std::int64_t, 10> within_levels{};    ///< inside the intervals of kLevels

  /// An error divided by its standard deviation.
  void Add(double standardised);
  void Append(const Calibration& other);

  /// Shares in [0, 1]; 0.683 and 0.954 if calibrated.
  std::optional<double> within_one_sigma() const;
  std::optional<double> within_two_sigma() const;
  /// Expected calibration error in [0, 1]: the mean over kLevels of |share inside the interval - nominal probability|.
  /// The levels are those of Kuleshov et al., ICML 2018, for central intervals and with absolute differences:
  /// `mean_absolute_calibration_error` with `prop_type="interval"` of Uncertainty Toolbox, on its own levels.
  std::optional<double> ece() const;
};

/// Errors with their stated uncertainty.
struct SigmaSamples {
  Calibration calibration;           ///< of the components: three of a position, one of a rotation axis
  std::vector<SigmaAndError> pairs;  ///< one of a position, one of a rotation axis

  /// A position's error, metres, and its covariance, m^2. The components are whitened by the Cholesky factor. The pair
  /// is sqrt(trace / 3) and the length of the error, millimetres. Nothing is added unless the covariance is positive
  /// definite.
  void AddPosition(const Vector3d& error, const Matrix3d& covariance);
  /// The error about one axis and its standard deviation, radians. Nothing is added unless sigma is positive.
  void AddAxis(double error, double sigma);
  void Append(const SigmaSamples& other);
};

/// Spearman's rank correlation of sigma and error in [-1, 1]; equal values share their mean rank. Empty where sigma or
/// error has fewer than two values.
std::optional<double> SpearmanOf(const std::vector<SigmaAndError>& samples);

/// Area under the receiver operating characteristic in [0, 1] of sigma as the score for an error above `large`: the
/// probability that such an error has the larger sigma of two, equal ones counted as one half. Empty where fewer than
/// kFewestOfClass samples are of one class.
std::optional<double> RocAucOf(const std::vector<SigmaAndError>& samples, double large);

/// Mean error of the share of samples that is kept, those with the smallest sigma first (Geifman et al., ICLR 2019). Of
/// equal sigma all count as their mean, as in a random order. Unit of the error.
struct RiskCoverage {
  std::array<double, 10> risk{};  ///< of 10, 20, ..., 100 % kept
  double area = 0.0;              ///< mean over all numbers of kept samples (AURC)
};
std::optional<RiskCoverage> RiskCoverageOf(std::vector<SigmaAndError> samples);
/// The same with the smallest errors first: no order has less risk.
std::optional<RiskCoverage> IdealRiskCoverageOf(std::vector<SigmaAndError> samples);

/// Parts of the body: arms from the shoulders, legs from the hips, the head with what hangs from the lowest common
/// ancestor of both arms and leads to no limb, the trunk with collars and all else.
enum class BodyPart { kTrunk, kHead, kArms, kLegs };
inline constexpr std::size_t kBodyParts = 4;

/// (J)
std::vector<BodyPart> BodyPartsOf(const Skeleton& skeleton);

/// Errors of a fit's positions (pairs in millimetres) and rotations (radians).
struct FitSamples {
  SigmaSamples positions, rotations;

  void Append(const FitSamples& other);
};

/// Samples of fits by part of the body, and by whether the joint was observed in the frame (also as the other side:
/// states observed and repaired).
class SigmaByPart {
 public:
  FitSamples& At(BodyPart part, bool observed) { return cells_[static_cast<std::size_t>(part)][observed ? 1 : 0]; }
  void Append(const SigmaByPart& other);

  /// Groups of samples, by position: all, the parts, and of all parts the joints that were not observed.
  static constexpr std::array<const char*, kBodyParts + 2> kGroups = {"all",  "trunk", "head",
                                                                      "arms", "legs",  "not_observed"};
  FitSamples Group(std::size_t group) const;
  FitSamples All() const { return Group(0); }

 private:
  std::array<std::array<FitSamples, 2>, kBodyParts> cells_;
};

}  // namespace mocurate
