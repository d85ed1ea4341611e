#pragma once

#include <optional>
#include <vector>

#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// Cameras whose images are another camera's.
struct FileExchange {
  std::vector<std::size_t> source;  ///< (V) camera v's images lie in the files of camera source[v]
  double loss = 0.0;                ///< as the files say
  double exchanged = 0.0;           ///< and after the exchange
  bool unique = true;       ///< no other exchange explains about as well: the rig looks the same from no other side
  double confidence = 0.0;  ///< that it is better than as the files say, and than any other exchange
};

/// The exchange of whole files between cameras of one image size after which views agree much better: all permutations
/// of up to five views, pairs of up to twelve. Empty where views agree as they are, and where no exchange agrees much
/// better.
std::optional<FileExchange> FindFileExchange(const ObservedRig& rig, const std::vector<double>& losses);

std::vector<DepthView> WithExchangedFiles(const std::vector<DepthView>& views, const std::vector<std::size_t>& source);

}  // namespace mocurate
