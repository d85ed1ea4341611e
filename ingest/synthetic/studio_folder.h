#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "core/store/store.h"

namespace mocurate {

/// A folder that the studio writes: data files, and per subject truth/SUBJECT.h5 by clip id. May be used by several
/// threads; what is written does not depend on their number.
class StudioFolder {
 public:
  struct Counts {
    std::size_t files = 0;
    std::size_t images = 0;  ///< of the files
    std::size_t bytes = 0;
    std::size_t clips = 0;
    std::size_t frames = 0;
  };
  /// Told of what is written so far after every file, by one thread at a time.
  using Progress = std::function<void(const Counts&)>;

  StudioFolder(std::filesystem::path folder, int jobs, Progress progress = {})
      : folder_(std::move(folder)), jobs_(jobs), progress_(std::move(progress)) {}

  /// Written last: a folder without it is not whole.
  static constexpr const char* kWhole = "studio.json";

  /// A file below the folder; makes the folders on the way. Error kCannotWrite. Not flushed file by file: a folder may
  /// hold a hundred thousand images.
  Status Write(const std::string& name, std::string_view bytes);
  /// Takes what really happened in a clip: in its subject's own truth file, all with one skeleton.
  void AddTruth(const std::string& subject, const std::string& clip_id, Motion motion);
  /// Writes the truth, then studio.json.
  Status Finish(std::string_view studio_json);

  /// Calls `work` for 0 .. count-1 on several threads. The first error in the order of the items.
  Status ForEach(std::size_t count, const std::function<Status(std::size_t)>& work);

  Counts counts() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  int jobs_ = 1;
  Progress progress_;
  mutable std::mutex mutex_;
  Counts counts_;
  std::map<std::string, Truth> truth_;
};

}  // namespace mocurate
