#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "core/base/error.h"

namespace mocurate {

/// A file that says which process works on a task, on file systems without locks. Its time is renewed every 20 s; a
/// claim that is 90 s old, or of a process of this host that is gone, counts as left by a dead one.
class TaskClaim {
 public:
  /// Error kUsage where another process holds it, kCannotWrite.
  static Expected<std::unique_ptr<TaskClaim>> Take(const std::filesystem::path& file);
  /// Whether a file is a claim of a process that may still work.
  static bool Held(const std::filesystem::path& file);
  ~TaskClaim();
  TaskClaim(const TaskClaim&) = delete;
  TaskClaim& operator=(const TaskClaim&) = delete;

 private:
  TaskClaim(std::filesystem::path file, int descriptor);

  std::filesystem::path file_;
  int descriptor_ = -1;  ///< of the claim
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread renewal_;
};

}  // namespace mocurate
