#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/formats/pickle.h"

namespace mocurate {

/// One clip of `humanact12poses.pkl`.
struct HumanAct12Clip {
  std::size_t frames = 0;
  std::vector<double> poses;   ///< frames x 72: SMPL axis-angle, radians, in the axes of the joints
  std::vector<double> joints;  ///< frames x 24 x 3, metres, camera axes (y down)
  int label = 0;               ///< 0 to 11, or one of the classes that the file lists under `labels`
};

/// `humanact12poses.pkl`: lists `poses`, `joints3D`, `y` with one entry per clip; `oldposes` is not data. A list
/// `labels` names the classes; the published file does not have it. Errors kMalformed name list and clip.
class HumanAct12Archive {
 public:
  /// `bytes` must outlive the archive.
  static Expected<HumanAct12Archive> Open(std::string_view bytes, const std::string& name);
  std::size_t size() const { return size_; }
  Expected<int> Label(std::size_t clip) const;
  Expected<HumanAct12Clip> Clip(std::size_t clip) const;

 private:
  Pickle pickle_;
  std::size_t size_ = 0;
  int classes_ = 12;
};

/// Protocol 2. Error kInconsistent: sizes that do not fit.
Expected<std::string> EncodeHumanAct12Pickle(const std::vector<HumanAct12Clip>& clips, const std::string& name);

}  // namespace mocurate
