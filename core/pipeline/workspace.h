#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/pipeline/lock.h"

namespace mocurate {

/// Where one runner lets workers write. Outputs lie in `tmp/<host>/<runner>/<n>/` of the cache, from where a finished
/// artifact moves in by a rename, or below a folder of the node. They are gone with the runner; what killed runners of
/// this host left is removed at the start. `scratch/<key>/` of the cache is for what shall survive kills.
class Workspace {
 public:
  /// Error kCannotWrite.
  /// `node_folder`: for outputs, on a disk of this node; empty: in the cache.
  static Expected<Workspace> Make(const std::filesystem::path& cache_folder, const std::filesystem::path& node_folder);
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
  /// The scratch folder of a key. When another process works on the same key, or the file system has no locks, a
  /// private folder instead.
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
