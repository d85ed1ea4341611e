#include "job/task_claim.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <sstream>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kRenewal{20};
constexpr std::time_t kDead_s = 90;
constexpr int kTries = 3;

std::string Host() {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return host;
}

/// Now, by the clock that gives files in this folder their times; that of the file server, which may differ from ours.
std::time_t NowBeside(const fs::path& file) {
  Expected<PendingFile> probe = PendingFile::Create(file.parent_path() / "now");
  struct stat made {};
  const bool known = probe && probe->Write("1") && fstat(probe->descriptor(), &made) == 0;
  return known ? made.st_mtim.tv_sec : std::time(nullptr);
}

/// Whether the process that wrote a claim may still work.
bool Alive(const fs::path& file, const std::string& text) {
  std::istringstream words(text);
  std::string host;
  pid_t process = 0;
  words >> host >> process;
  // In a container that started again, the number is our own.
  const bool here = host == Host() && process > 0;
  if (here && (process == getpid() || (kill(process, 0) != 0 && errno == ESRCH))) return false;
  struct stat renewed {};
  return stat(file.c_str(), &renewed) == 0 && NowBeside(file) - renewed.st_mtim.tv_sec < kDead_s;
}

}  // namespace

Expected<std::unique_ptr<TaskClaim>> TaskClaim::Take(const fs::path& file) {
  const fs::path folder = file.parent_path();
  const Expected<fs::path> place = FileBelow(folder.parent_path(), folder.filename() / file.filename());
  if (!place) return Forward(place);
  const std::string text = Host() + " " + std::to_string(getpid()) + "\n";
  for (int tries = 0; tries < kTries; ++tries) {
    const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      const bool written = write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
      const int problem = errno;
      if (written) return std::unique_ptr<TaskClaim>(new TaskClaim(file, descriptor));
      close(descriptor);
      unlink(file.c_str());
      errno = problem;
    }
    if (descriptor >= 0 || errno != EEXIST) {
      return Fail(ErrorCode::kCannotWrite, std::string("the task cannot be claimed: ") + std::strerror(errno),
                  DisplayPath(file), "free some space or make the folder writable");
    }
    struct stat judged {};
    if (stat(file.c_str(), &judged) != 0) continue;  // just given up
    const std::string holder = ReadFile(file).value_or("");
    if (Alive(file, holder)) {
      return Fail(ErrorCode::kUsage, "another process works on this task: " + std::string(Trim(holder)),
                  DisplayPath(file), "wait for it to end; a claim that is not renewed for 90 s is taken over");
    }
    // Another process that found it dead as well may have claimed the task since: its claim is put back.
    const fs::path away = file.native() + "." + Host() + "." + std::to_string(getpid());
    if (rename(file.c_str(), away.c_str()) != 0) continue;
    struct stat taken {};
    if (lstat(away.c_str(), &taken) == 0 && taken.st_ino != judged.st_ino && link(away.c_str(), file.c_str()) != 0) {
      return Fail(ErrorCode::kUsage, "other processes claim this task at the same time", DisplayPath(file),
                  "start it again when they have ended");
    }
    unlink(away.c_str());
  }
  return Fail(ErrorCode::kUsage, "other processes claim this task at the same time", DisplayPath(file),
              "start it again when they have ended");
}

bool TaskClaim::Held(const fs::path& file) {
  if (!CheckNotLink(file)) return false;
  const auto holder = ReadFile(file);
  return holder && Alive(file, *holder);
}

TaskClaim::TaskClaim(fs::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {
  renewal_ = std::thread([this] {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, kRenewal, [this] { return end_; })) futimens(descriptor_, nullptr);
  });
}

TaskClaim::~TaskClaim() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  ended_.notify_all();
  renewal_.join();
  // A process that was suspended may have lost its claim.
  struct stat ours {};
  struct stat there {};
  if (fstat(descriptor_, &ours) == 0 && stat(file_.c_str(), &there) == 0 && ours.st_ino == there.st_ino)
    unlink(file_.c_str());
  close(descriptor_);
}

}  // namespace mocurate
