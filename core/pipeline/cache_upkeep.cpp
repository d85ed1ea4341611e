#include <sys/stat.h>
#include <unistd.h>

#include <ctime>
#include <set>

#include "core/base/file.h"
#include "core/pipeline/cache_layout.h"
#include "core/pipeline/content.h"
#include "core/pipeline/lock.h"
#include "core/pipeline/runner.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr double kSecondsPerDay = 86400.0;

bool UnusedFor(const fs::path& path, double days) {
  struct stat now {};
  if (lstat(path.c_str(), &now) != 0) return false;
  struct timespec clock {};
  clock_gettime(CLOCK_REALTIME, &clock);
  const double age_s = static_cast<double>(clock.tv_sec - now.st_mtim.tv_sec) +
                       1e-9 * static_cast<double>(clock.tv_nsec - now.st_mtim.tv_nsec);
  return age_s >= days * kSecondsPerDay;
}

/// A record is `<digits>.json`; artifacts have a dash after the digits.
bool IsRecord(const fs::path& entry) {
  return entry.extension() == ".json" && entry.filename().native().find('-') == std::string::npos;
}

void PruneScratch(const fs::path& cache, double days) {
  std::error_code problem;
  if (fs::is_symlink(cache / "scratch", problem)) return;
  for (fs::directory_iterator it(cache / "scratch", problem), end; !problem && it != end; it.increment(problem)) {
    if (it->is_symlink(problem) || !it->is_directory(problem) || !UnusedFor(it->path(), days)) continue;
    const Expected<std::optional<FileLock>> lock = FileLock::TryTake(it->path() / ".lock");
    std::error_code ignored;
    if (lock && lock->has_value()) fs::remove_all(it->path(), ignored);
  }
}

}  // namespace

std::string Cache::OthersWhoWrite() const {
  struct stat facts {};
  if (stat(folder_.c_str(), &facts) != 0) return {};
  const char* who = facts.st_uid != geteuid() && facts.st_uid != 0 ? "belongs to another user"
                    : (facts.st_mode & S_IWOTH) != 0               ? "may be changed by every user of this machine"
                                                                   : nullptr;
  if (who == nullptr) return {};
  return DisplayPath(folder_) + ": this cache " + who +
         ", who decides what is served from it; MOCURATE_CACHE names another";
}

Cache::Statistics Cache::Stat() const {
  Statistics statistics;
  ForEachObject(folder_, [&](const fs::path& entry) {
    statistics.objects += IsRecord(entry) ? 1 : 0;
    statistics.bytes += BytesOf(entry);
  });
  return statistics;
}

std::vector<std::string> Cache::Verify() const {
  std::vector<std::string> wrong;
  ForEachObject(folder_, [&](const fs::path& entry) {
    if (!IsRecord(entry)) return;
    const std::optional<CacheRecord> record = ReadRecord(entry);
    bool agrees = record && record->key == KeyOfRecord(entry);
    if (agrees && !record->artifact.empty()) {
      const fs::path artifact = entry.parent_path() / record->artifact;
      const Expected<Content> content =
          BytesOfArtifact(artifact) ? ContentOf(artifact) : Fail(ErrorCode::kUnreadable, "not an artifact");
      agrees = content && content->sha256 == record->sha256 && content->bytes == record->bytes;
    }
    if (!agrees) wrong.push_back(KeyOfRecord(entry));
  });
  return wrong;
}

Cache::Statistics Cache::Prune(double days, bool dry_run) {
  Statistics removed;
  std::set<fs::path> kept;
  std::vector<fs::path> artifacts;
  std::error_code ignored;
  ForEachObject(folder_, [&](const fs::path& entry) {
    if (!IsRecord(entry)) {
      artifacts.push_back(entry);
    } else if (UnusedFor(entry, days)) {
      removed.objects += 1;
      removed.bytes += BytesOf(entry);
      if (!dry_run) fs::remove(entry, ignored);
    } else if (const std::optional<CacheRecord> record = ReadRecord(entry)) {
      kept.insert(entry.parent_path() / record->artifact);
    }
  });
  // Records first: visible entries stay complete. An artifact without a record may just be written; its age decides.
  for (const fs::path& artifact : artifacts) {
    if (kept.count(artifact) > 0 || !UnusedFor(artifact, days)) continue;
    removed.bytes += BytesOf(artifact);
    if (!dry_run) fs::remove_all(artifact, ignored);
  }
  if (!dry_run) PruneScratch(folder_, days);
  return removed;
}

}  // namespace mocurate
