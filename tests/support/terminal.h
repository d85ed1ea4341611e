#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <string>

namespace mocurate::test {

/// A pseudo-terminal: what a program writes to `name` is read from `ours`.
class Terminal {
 public:
  static constexpr const char* kMissing = "no pseudo-terminal: mount /dev/pts (mount -t devpts devpts /dev/pts)";

  Terminal() : ours_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    if (ours_ < 0 || grantpt(ours_) != 0 || unlockpt(ours_) != 0) return;
    const char* name = ptsname(ours_);
    if (name != nullptr && access(name, R_OK | W_OK) == 0) name_ = name;
  }
  ~Terminal() {
    if (ours_ >= 0) close(ours_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// False where the machine has none: /dev/pts is not mounted.
  bool exists() const { return !name_.empty(); }
  int ours() const { return ours_; }
  const std::string& name() const { return name_; }

 private:
  int ours_ = -1;
  std::string name_;
};

}  // namespace mocurate::test
