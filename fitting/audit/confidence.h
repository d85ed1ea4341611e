#pragma once

#include <vector>

namespace mocurate {

/// Confidence that `better` is lower than `worse`, in [0, 1]: that the mean of the differences is above 0, by Student's
/// t. Samples are in order of time, and neighbours may be correlated. So the standard error is also estimated from the
/// means of ever longer spans (down to five), and the lowest confidence counts.
double Confidence(const std::vector<double>& worse, const std::vector<double>& better);

/// Confidence for independent samples.
double ConfidenceOfSeparate(const std::vector<double>& worse, const std::vector<double>& better);

/// Fewest parts of a take for a standard error.
inline constexpr std::size_t kFewestSpans = 5;

/// Confidence that a number `sigmas` standard errors from 0 is not 0, with the standard error from kFewestSpans spans.
double SpanConfidence(double sigmas);

/// Cumulative standard normal distribution.
double NormalShare(double z);

}  // namespace mocurate
