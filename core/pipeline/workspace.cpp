#include "core/pipeline/workspace.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/file.h"
#include "core/base/links.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockName = ".lock";
constexpr int kTries = 100;

std::string HostName() {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return host[0] != '\0' ? host : "host";
}

/// Whether a runner of this user made this folder: its name is a process and six characters (mkdtemp).
bool IsOfRunner(const fs::path& path) {
  const std::string& name = path.filename().native();
  const std::size_t digits = name.find_first_not_of("0123456789");
  struct stat facts {};
  return digits != std::string::npos && digits > 0 && name[digits] == '-' && name.size() == digits + 7 &&
         lstat(path.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) && facts.st_uid == geteuid();
}

/// Removes the folders of runners that are gone. Call with the lock of `tmp` held.
void Sweep(const fs::path& tmp) {
  std::error_code problem;
  for (fs::directory_iterator it(tmp, problem), end; !problem && it != end; it.increment(problem)) {
    std::error_code ignored;
    if (!IsOfRunner(it->path())) continue;
    const Expected<std::optional<FileLock>> lock = FileLock::TryTake(it->path() / kLockName);
    if (lock && lock->has_value()) fs::remove_all(it->path(), ignored);
  }
}

}  // namespace

Expected<Workspace> Workspace::Make(const fs::path& cache_folder, const fs::path& node_folder) {
  // No lock and no removal where other nodes write. A folder of the node may be shared by users, as /tmp.
  const Expected<fs::path> tmp = node_folder.empty()
                                     ? FolderBelow(cache_folder, fs::path("tmp") / HostName())
                                     : FolderBelow(node_folder, "mocurate-" + std::to_string(geteuid()));
  if (!tmp) return Forward(tmp);
  struct stat facts {};
  if (!node_folder.empty() && (lstat(tmp->c_str(), &facts) != 0 || facts.st_uid != geteuid())) {
    return Fail(ErrorCode::kCannotWrite, "the folder belongs to another user", DisplayPath(*tmp),
                "name a folder of your own with --scratch");
  }
  const Expected<FileLock> sweeping = FileLock::Take(*tmp / kLockName);
  if (!sweeping) return Forward(sweeping);
  Sweep(*tmp);
  std::string pattern = (*tmp / (std::to_string(getpid()) + "-XXXXXX")).native();
  if (mkdtemp(pattern.data()) == nullptr) {
    return Fail(ErrorCode::kCannotWrite, std::string("no folder can be made: ") + std::strerror(errno),
                DisplayPath(*tmp));
  }
  Expected<FileLock> own = FileLock::Take(fs::path(pattern) / kLockName);
  if (!own) return Forward(own);
  return Workspace(cache_folder, pattern, *std::move(own));
}

Workspace::~Workspace() {
  std::error_code ignored;
  if (lock_.has_value() && !own_.empty()) fs::remove_all(own_, ignored);
}

Expected<fs::path> Workspace::NewFolder() {
  const fs::path folder = own_ / std::to_string(next_++);
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  return folder;
}

bool Workspace::Scratch::HoldsFiles() const {
  std::error_code missing;
  for (fs::directory_iterator entry(folder, missing), end; entry != end; entry.increment(missing)) {
    if (entry->path().filename() != kLockName) return true;
  }
  return false;
}

Expected<Workspace::Scratch> Workspace::ScratchOf(const std::string& key) {
  // Another runner may take the folder away between any two steps; only a failure that stays is one.
  for (int tries_left = kTries;; --tries_left) {
    const Expected<fs::path> made = FolderBelow(cache_, fs::path("scratch") / key);
    if (!made && tries_left == 0) return Forward(made);
    if (!made) continue;
    Expected<std::optional<FileLock>> lock = FileLock::TryTake(*made / kLockName);
    if (!lock && tries_left > 0) continue;
    if (lock && lock->has_value()) {
      Scratch scratch{*made, std::move(*lock)};
      if (CheckNoLinks(scratch.folder)) return scratch;
      Discard(scratch);  // a cache of others: what a worker writes must stay in it
      if (tries_left > 0) continue;
    }
    const Expected<fs::path> other = NewFolder();
    if (!other) return Forward(other);
    return Scratch{*other, std::nullopt};
  }
}

void Workspace::Discard(const Scratch& scratch) {
  // Renamed before its files are removed: otherwise its lock could be taken again during the removal.
  const fs::path away = own_ / std::to_string(next_++);
  std::error_code ignored;
  std::error_code problem;
  fs::rename(scratch.folder, away, problem);
  fs::remove_all(problem ? scratch.folder : away, ignored);
}

}  // namespace mocurate
