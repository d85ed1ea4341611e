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

/// A folder that the studio writes: data files, and per subject truth/SUBJECT.h5 by clip id. Thread-safe; the output
/// does not depend on the number of threads.
class StudioFolder {
 public:
  struct Counts {
    std::size_t files = 0;
    std::size_t images = 0;  ///< of the files
    std::size_t bytes = 0;
    std::size_t clips = 0;
    std::size_t frames = 0;
  };
  /// Called after every file with the counts so far, by one thread at a time.
  using Progress = std::function<void(const Counts&)>;

  StudioFolder(std::filesystem::path folder, int jobs, Progress progress = {})
      : folder_(std::move(folder)), jobs_(jobs), progress_(std::move(progress)) {}

  /// Written last: a folder without it is incomplete.
  static constexpr const char* kWhole = "studio.json";

  /// Writes a file below the folder and creates its parent folders. Error kCannotWrite. Not flushed per file: a folder
  /// may contain a hundred thousand images.
  Status Write(const std::string& name, std::string_view bytes);
  /// Writes a .png likewise. Errors of EncodePng too.
  Status WriteImage(const std::string& name, const DepthImage& image);
  /// Adds the true motion of the clip of `item` ("source/person/recording") to its subject's truth file; all have one
  /// skeleton.
  void AddTruth(const std::string& subject, const std::string& item, Motion motion);
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
