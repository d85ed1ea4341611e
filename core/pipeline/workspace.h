#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/pipeline/lock.h"

namespace mocurate {

/// Where one runner lets workers write, inside the cache so that a finished artifact moves in by a rename:
/// `tmp/<runner>/<n>/` for outputs (gone with the runner; what killed runners left is removed at the start) and
/// `scratch/<key>/` for what shall survive kills.
class Workspace {
 public:
  /// Error kCannotWrite.
  static Expected<Workspace> Make(const std::filesystem::path& cache_folder);
  Workspace(Workspace&&) = default;
  Workspace& operator=(Workspace&&) = default;
  ~Workspace();

  /// A new, empty folder for the output of one item. Error kCannotWrite.
  Expected<std::filesystem::path> NewFolder();

  struct Scratch {
    std::filesystem::path folder;
    std::optional<FileLock> lock;
    /// Whether an item left files in it.
    bool HoldsFiles() const;
  };
  /// The scratch folder of a key. When another process works on the same key, a private folder instead.
  Expected<Scratch> ScratchOf(const std::string& key);
  /// Removes it, while its lock is still held.
  void Discard(const Scratch& scratch);

 private:
  Workspace(std::filesystem::path cache, std::filesystem::path own, FileLock lock)
      : cache_(std::move(cache)), own_(std::move(own)), lock_(std::move(lock)) {}

  std::filesystem::path cache_;
  std::filesystem::path own_;
  std::optional<FileLock> lock_;
  std::uint64_t next_ = 0;
};

}  // namespace mocurate
