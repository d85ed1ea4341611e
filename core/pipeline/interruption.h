#pragma once

#include <csignal>

namespace mocurate {

/// While it lives, SIGINT, SIGTERM and SIGUSR1 (a batch system's warning that time is nearly up) are counted instead of
/// ending the program (the third ends it at once), and a closed pipe or a file size limit is an error of the write, not
/// a death. One at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  static int Count();
  static const char* SignalName();
  /// The last signal was the batch system's warning.
  static bool OutOfTime();

 private:
  struct sigaction saved_[5];
};

}  // namespace mocurate
