#pragma once

#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <csignal>

#include "tests/app/program.h"

namespace mocurate::program {

/// A file system of a few bytes, like a full disk. It is in a mount namespace of a child process, and is reached
/// through /proc. Where mounting is not permitted, a limit on the size of files replaces it.
class TightDisk {
 public:
  TightDisk(const fs::path& place, std::size_t bytes, std::size_t largest_file)
      : place_(place), largest_file_(largest_file) {
    fs::create_directories(place);
    int asks[2], answers[2];
    if (pipe(asks) != 0 || pipe(answers) != 0) return;
    const pid_t parent = getpid();
    holder_ = fork();
    if (holder_ == 0) {
      close(asks[1]);
      close(answers[0]);
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() == parent) Hold(place, bytes, asks[0], answers[1]);
      _exit(0);
    }
    close(asks[0]);
    close(answers[1]);
    ask_ = asks[1];
    answer_ = answers[0];
    mounted_ = Answered();
  }
  ~TightDisk() {
    close(ask_);
    close(answer_);
    waitpid(holder_, nullptr, 0);
  }
  TightDisk(const TightDisk&) = delete;
  TightDisk& operator=(const TightDisk&) = delete;

  fs::path path() const {
    return mounted_ ? fs::path("/proc/" + std::to_string(holder_) + "/root" + place_.native()) : place_;
  }
  /// Runs before the start of a program that writes to it.
  std::function<void()> Limit() const {
    if (mounted_ || grown_) return {};
    return [bytes = largest_file_] {
      const rlimit limit{bytes, bytes};
      setrlimit(RLIMIT_FSIZE, &limit);
    };
  }
  /// Enlarges it.
  bool Grow() {
    grown_ = true;
    return !mounted_ || (write(ask_, "g", 1) == 1 && Answered());
  }

 private:
  static void Say(const std::string& file, const std::string& text) {
    const int descriptor = open(file.c_str(), O_WRONLY);
    if (descriptor < 0) return;
    [[maybe_unused]] const ssize_t written = write(descriptor, text.data(), text.size());
    close(descriptor);
  }

  static bool Mount(const fs::path& place, std::size_t bytes) {
    const std::string user = std::to_string(geteuid()), group = std::to_string(getegid());
    if (unshare(geteuid() == 0 ? CLONE_NEWNS : CLONE_NEWNS | CLONE_NEWUSER) != 0) return false;
    if (user != "0") {
      Say("/proc/self/setgroups", "deny");
      Say("/proc/self/uid_map", user + " " + user + " 1");
      Say("/proc/self/gid_map", group + " " + group + " 1");
    }
    const std::string size = "size=" + std::to_string(bytes);
    return mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
           mount("tmpfs", place.c_str(), "tmpfs", 0, size.c_str()) == 0;
  }

  static void Hold(const fs::path& place, std::size_t bytes, int asks, int answers) {
    bool fine = Mount(place, bytes);
    char question = 0;
    do {
      if (write(answers, fine ? "y" : "n", 1) != 1 || read(asks, &question, 1) != 1) return;
      fine = mount("tmpfs", place.c_str(), "tmpfs", MS_REMOUNT, "size=64m") == 0;
    } while (true);
  }

  bool Answered() const {
    char answer = 'n';
    return read(answer_, &answer, 1) == 1 && answer == 'y';
  }

  fs::path place_;
  std::size_t largest_file_;
  pid_t holder_ = -1;
  int ask_ = -1, answer_ = -1;
  bool mounted_ = false, grown_ = false;
};

}  // namespace mocurate::program
