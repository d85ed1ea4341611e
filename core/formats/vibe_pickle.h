#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/formats/pickle.h"

namespace mocurate {

/// One person track of VIBE, SPIN and related methods. Root-relative joints, y down, facing -z. Absent fields are
/// empty.
struct VibeTrack {
  std::int64_t id = 0;  ///< key of the track; position of the video in a cache
  std::size_t frames = 0;
  std::size_t joints = 0;                ///< 49 of VIBE
  std::vector<double> pose;              ///< frames x 72, axis-angle, radians
  std::vector<double> joints3d;          ///< frames x joints x 3
  std::vector<double> betas;             ///< frames x 10
  std::vector<double> original_camera;   ///< frames x 4: sx, sy, tx, ty
  std::vector<double> predicted_camera;  ///< frames x 3: s, tx, ty
  std::vector<double> boxes;             ///< frames x 4: centre x, centre y, width, height, pixels
  std::vector<std::int64_t> frame_ids;   ///< rising
};

/// A dictionary of tracks (joblib or plain pickle), in the file's order. Errors kMalformed name the track and field.
Expected<std::vector<VibeTrack>> ParseVibeTracks(std::string_view bytes, const std::string& name);

/// UESTC's `vibe_cache_refined.pkl`: a dictionary of lists with one array per video. Videos are decoded one by one.
class VibeCache {
 public:
  /// `bytes` must outlive the cache. Error kMalformed when the lists are of different lengths.
  static Expected<VibeCache> Open(std::string_view bytes, const std::string& name);
  std::size_t size() const { return size_; }
  Expected<VibeTrack> Track(std::size_t video) const;

 private:
  Pickle pickle_;
  std::size_t size_ = 0;
};

/// Pickles of protocol 2, arrays in double. Error kInconsistent: sizes that do not fit.
Expected<std::string> EncodeVibeTracks(const std::vector<VibeTrack>& tracks, const std::string& name);
Expected<std::string> EncodeVibeCache(const std::vector<VibeTrack>& videos, const std::string& name);

}  // namespace mocurate
