#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <set>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/sha256.h"
#include "core/pipeline/cache_layout.h"
#include "core/pipeline/content.h"
#include "core/pipeline/lock.h"
#include "core/pipeline/runner.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::time_t kTouchEvery_s = 3600;

/// Notes the use of a record for Prune, at most once an hour. Fails silently: a cache may be read-only.
void Touch(const fs::path& record) {
  struct stat now {};
  if (lstat(record.c_str(), &now) != 0 || std::time(nullptr) - now.st_mtim.tv_sec < kTouchEvery_s) return;
  utimensat(AT_FDCWD, record.c_str(), nullptr, AT_SYMLINK_NOFOLLOW);
}

/// Copies a file or folder to a name beside `target` that no other process uses, whole and on the disk.
Expected<fs::path> CopyBeside(const fs::path& from, const fs::path& target) {
  std::string folder = (target.parent_path() / ".copy-XXXXXX").native();
  std::error_code problem;
  if (mkdtemp(folder.data()) == nullptr) problem.assign(errno, std::generic_category());
  const fs::path copy = fs::path(folder) / target.filename();
  if (!problem) fs::copy(from, copy, fs::copy_options::recursive, problem);
  const Status synced = problem ? Status() : SyncContent(copy);
  if (!problem && synced) return copy;
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (!synced) return Forward(synced);
  return Fail(ErrorCode::kCannotWrite, "artifact cannot be copied into the cache: " + problem.message(),
              DisplayPath(target), "free some space or choose another cache with MOCURATE_CACHE");
}

/// Moves a file or folder to `target`, from another file system by way of a copy beside it. A folder that is there
/// already has the same content.
Status MoveTo(const fs::path& temporary, const fs::path& target) {
  std::error_code problem;
  if (fs::is_directory(temporary, problem) && fs::exists(target, problem)) {
    const Expected<Content> ours = ContentOf(temporary);
    const Expected<Content> there = ContentOf(target);
    if (ours && there && ours->sha256 == there->sha256) return {};
    fs::remove_all(target, problem);
  }
  fs::rename(temporary, target, problem);
  if (!problem) return {};
  if (problem == std::errc::cross_device_link) {
    const Expected<fs::path> copy = CopyBeside(temporary, target);
    if (!copy) return Forward(copy);
    problem.clear();
    fs::rename(*copy, target, problem);
    std::error_code ignored;
    fs::remove_all(copy->parent_path(), ignored);
    if (!problem) return {};
  }
  return Fail(ErrorCode::kCannotWrite, "artifact cannot be moved into the cache: " + problem.message(),
              DisplayPath(target));
}

/// Atomic, without fsync: a record that a power cut damages or loses is not served, and its item runs again. Waiting
/// for the disk here would stop all workers.
Status WriteRecord(const fs::path& file, const std::string& text) {
  Expected<PendingFile> record = PendingFile::Create(file);
  Status written = record ? record->Write(text) : Forward(record);
  if (written) written = record->PublishUnsynced();
  if (!written) written.error().hint = "free some space or choose another cache with MOCURATE_CACHE";
  return written;
}

/// Canonical text of one part, so that no two lists of parts read the same.
void AddPart(Sha256& hasher, const std::string& text) { hasher.Add(std::to_string(text.size()) + ":" + text + "\n"); }

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

Cache::Cache(fs::path folder) : folder_(std::move(folder)) {}

std::string Cache::Key(const StageDeclaration& stage, const ItemSpec& spec) {
  Sha256 hasher;
  AddPart(hasher, stage.name);
  AddPart(hasher, std::to_string(stage.version));
  AddPart(hasher, spec.item);
  AddPart(hasher, spec.options.Text());
  for (const StageInput& input : spec.inputs) {
    AddPart(hasher, input.role);
    AddPart(hasher, input.name);
    AddPart(hasher, input.sha256);
  }
  return hasher.Hex();
}

std::optional<Cache::Entry> Cache::Find(const std::string& key) const {
  const fs::path file = RecordPath(folder_, key);
  std::optional<CacheRecord> record = ReadRecord(file);
  if (!record || record->key != key) return std::nullopt;
  Entry entry{std::move(record->outcome), {}, record->sha256};
  if (!record->artifact.empty()) {
    entry.artifact = file.parent_path() / record->artifact;
    if (BytesOfArtifact(entry.artifact) != record->bytes) return std::nullopt;
  }
  Touch(file);
  return entry;
}

Expected<Cache::Entry> Cache::Put(const std::string& key, const fs::path& temporary, const StageOutcome& outcome) {
  const Expected<fs::path> place = FileBelow(folder_, RecordPath("", key));
  if (!place) return Forward(place);
  const fs::path& file = *place;
  CacheRecord record{key, outcome, {}, {}, 0};
  Entry entry{outcome, {}, {}};
  if (!temporary.empty()) {
    if (Status synced = SyncContent(temporary); !synced) return Forward(synced);
    const Expected<Content> content = ContentOf(temporary);
    if (!content) return Forward(content);
    record.artifact = ArtifactName(key, content->sha256, temporary);
    record.sha256 = entry.sha256 = content->sha256;
    record.bytes = content->bytes;
    entry.artifact = file.parent_path() / record.artifact;
    if (Status moved = MoveTo(temporary, entry.artifact); !moved) return Forward(moved);
  }
  // Artifact first, then the record that makes it visible.
  if (Status written = WriteRecord(file, RecordText(record)); !written) return Forward(written);
  return entry;
}

fs::path DefaultCacheFolder() {
  if (const char* chosen = std::getenv("MOCURATE_CACHE"); chosen != nullptr && *chosen != '\0') return chosen;
  if (const char* caches = std::getenv("XDG_CACHE_HOME"); caches != nullptr && *caches == '/') {
    return fs::path(caches) / "mocurate";
  }
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') {
    const passwd* user = getpwuid(getuid());
    home = user != nullptr ? user->pw_dir : "/";
  }
  return fs::path(home) / ".cache" / "mocurate";
}

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
