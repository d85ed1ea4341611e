#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/formats/npy.h"
#include "core/formats/pickle.h"

namespace mocurate {

/// `results.npy` of MDM's sample/generate.py: a dictionary in an array of objects, with `motion` (N, joints, 3, frames)
/// in metres, `text` (N labels or captions) and `lengths` (N frames that count). Other keys are not read. Nothing of
/// the file is executed.
class MdmResults {
 public:
  /// `bytes` must outlive the results. Errors of the formats; kMalformed names the key.
  static Expected<MdmResults> Open(std::string_view bytes, const std::string& name);

  std::size_t size() const { return labels_.size(); }
  std::size_t joints() const { return joints_; }
  /// `text` of a motion; empty where the file has none.
  const std::string& Label(std::size_t motion) const { return labels_[motion]; }
  /// (frames, joints, 3), cut to the frames that count. Error kMalformed.
  Expected<NpyArray> Motion(std::size_t motion) const;

 private:
  Pickle pickle_;
  int motions_ = -1;  ///< position of `motion` in the pickle
  std::size_t joints_ = 0;
  std::vector<std::string> labels_;
  std::vector<std::size_t> lengths_;
};

/// (joints, 3, frames) -> (frames, joints, 3), the first `frames` of them.
NpyArray FramesFirst(const NpyArray& array, std::size_t frames);

}  // namespace mocurate
