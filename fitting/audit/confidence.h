#pragma once

#include <vector>

namespace mocurate {

/// How sure it is that `better` is better than `worse`, in [0, 1]: that the mean of the differences is above 0, by
/// Student's t. The samples are in the order of time: those that follow each other may err alike, so that the standard
/// error is also read from the means of ever longer spans (down to five), and the least sure of the answers counts.
double Confidence(const std::vector<double>& worse, const std::vector<double>& better);

/// The same of samples that do not depend on each other.
double ConfidenceOfSeparate(const std::vector<double>& worse, const std::vector<double>& better);

/// Parts of a take, at least, that a standard error is read from.
inline constexpr std::size_t kFewestSpans = 5;

/// How sure it is that a number is not 0 that is `sigmas` standard errors off, these read from kFewestSpans spans.
double SpanConfidence(double sigmas);

/// Share of a normal distribution below z.
double NormalShare(double z);

}  // namespace mocurate
