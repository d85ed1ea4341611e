#pragma once

#include <poll.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// One worker program and the pipes to it. Never blocks, except that the destructor gives it two seconds to end.
class WorkerProcess {
 public:
  /// Starts `program` with one thread per library and a neutral locale; it dies with the calling thread. Error
  /// kMissingOnHost (no process can be made).
  static Expected<std::unique_ptr<WorkerProcess>> Start(const std::filesystem::path& program);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  const std::filesystem::path& program() const { return program_; }
  pid_t pid() const { return pid_; }

  void Send(const nlohmann::json& message);
  /// No more requests: it ends by itself when it has answered.
  void CloseStdin() { Close(to_); }
  /// What to wait for.
  void AddPolls(std::vector<pollfd>& polls) const;
  /// Reads and writes without blocking.
  void Pump();
  /// Next message read. Error kMalformed: the worker talks nonsense.
  Expected<std::optional<nlohmann::json>> Receive();
  /// Complete lines of its stderr since the last call.
  std::vector<std::string> TakeLines();

  /// Its answers have ended: it is dead or dying.
  bool ended() const { return ended_; }
  /// Kills it if necessary and returns how it ended: "killed by SIGSEGV; last output line: ...".
  std::string Reap();
  /// Exit status after Reap; -1 when a signal killed it.
  int exit_status() const { return exit_status_; }
  void Signal(int signal) const;
  /// Resident memory now; 0 when unknown.
  std::uint64_t MemoryBytes() const;
  /// The largest resident memory so far; 0 when unknown.
  std::uint64_t PeakMemoryBytes() const;

 private:
  WorkerProcess() = default;
  void ReadStderr();
  void WriteStdin();
  void Close(int& file);

  std::filesystem::path program_;
  pid_t pid_ = -1;
  int to_ = -1, from_ = -1, words_ = -1;  // its stdin, stdout, stderr
  std::string outgoing_, incoming_, partial_line_, last_line_;
  std::vector<std::string> lines_;
  bool ended_ = false;
  int exit_status_ = -1;
};

}  // namespace mocurate
