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
  const fs::path probe = file.native() + ".now." + Host() + "." + std::to_string(getpid());
  const int descriptor = open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  struct stat made {};
  const bool known = descriptor >= 0 && write(descriptor, "1", 1) == 1 && fstat(descriptor, &made) == 0;
  if (descriptor >= 0) close(descriptor);
  unlink(probe.c_str());
  return known ? made.st_mtim.tv_sec : std::time(nullptr);
}

/// Whether the process that wrote a claim may still work.
bool Alive(const fs::path& file, const std::string& text) {
  std::istringstream words(text);
  std::string host;
  pid_t process = 0;
  words >> host >> process;
  if (host == Host() && process > 0 && kill(process, 0) != 0 && errno == ESRCH) return false;
  struct stat renewed {};
  return stat(file.c_str(), &renewed) == 0 && NowBeside(file) - renewed.st_mtim.tv_sec < kDead_s;
}

}  // namespace

Expected<std::unique_ptr<TaskClaim>> TaskClaim::Take(const fs::path& file) {
  if (Status made = MakeFolder(file.parent_path()); !made) return Forward(made);
  const std::string text = Host() + " " + std::to_string(getpid()) + "\n";
  for (int tries = 0; tries < kTries; ++tries) {
    const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      const bool written = write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
      const int problem = errno;
      close(descriptor);
      if (written) return std::unique_ptr<TaskClaim>(new TaskClaim(file));
      unlink(file.c_str());
      errno = problem;
    }
    if (descriptor >= 0 || errno != EEXIST) {
      return Fail(ErrorCode::kCannotWrite, std::string("the task cannot be claimed: ") + std::strerror(errno),
                  DisplayPath(file), "free some space or make the folder writable");
    }
    const std::string holder = ReadFile(file).value_or("");
    if (Alive(file, holder)) {
      return Fail(ErrorCode::kUsage, "another process works on this task: " + std::string(Trim(holder)),
                  DisplayPath(file), "wait for it to end; a claim that is not renewed for 90 s is taken over");
    }
    // Under a name of our own: of two that find it dead, one removes it.
    const fs::path away = file.native() + "." + std::to_string(getpid());
    if (rename(file.c_str(), away.c_str()) == 0) unlink(away.c_str());
  }
  return Fail(ErrorCode::kUsage, "other processes claim this task at the same time", DisplayPath(file),
              "start it again when they have ended");
}

TaskClaim::TaskClaim(fs::path file) : file_(std::move(file)) {
  renewal_ = std::thread([this] {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, kRenewal, [this] { return end_; })) utimensat(AT_FDCWD, file_.c_str(), nullptr, 0);
  });
}

TaskClaim::~TaskClaim() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  ended_.notify_all();
  renewal_.join();
  unlink(file_.c_str());
}

}  // namespace mocurate
