#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// Cameras with another camera's images.
struct FileExchange {
  std::vector<std::size_t> source;  ///< (V) camera v's images are in the files of camera source[v]
  double loss = 0.0;                ///< as given
  double exchanged = 0.0;           ///< after the exchange
  bool unique = true;               ///< no other exchange explains about as much; false for a symmetric rig
  double confidence = 0.0;          ///< that it is better than as given, and than any other exchange (HeldOutCosts)
};

/// The exchange of whole files between cameras of one image size that makes views agree. Tests all permutations of up
/// to five views, pairs of up to twelve. Empty where views agree as given, and without a clear improvement.
std::optional<FileExchange> FindFileExchange(const ObservedRig& rig, const std::vector<double>& losses);

std::vector<DepthView> WithExchangedFiles(const std::vector<DepthView>& views, const std::vector<std::size_t>& source);

/// The fault; the audit sets its correction.
RigFault ExchangedFiles(const std::vector<std::string>& cameras, const FileExchange& exchange);

}  // namespace mocurate
