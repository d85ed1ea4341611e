#include "core/pipeline/worker_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fstream>
#include <limits>
#include <map>

#include "core/pipeline/wire.h"

namespace mocurate {
namespace {

constexpr int kGrace_ms = 2000;
constexpr std::size_t kLongestOutput = 65536;

struct Pipe {
  int read = -1, write = -1;
  bool Open() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return false;
    read = ends[0];
    write = ends[1];
    return true;
  }
  void Close() {
    if (read >= 0) close(read);
    if (write >= 0) close(write);
  }
};

/// Our environment with one thread per library (parallelism is over items and processes) and a neutral locale: these
/// must be set before the libraries load.
std::vector<std::string> WorkerEnvironment() {
  std::map<std::string, std::string> values;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::size_t equals = text.find('=');
    if (equals != std::string::npos) values[text.substr(0, equals)] = text.substr(equals + 1);
  }
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"}) values[name] = "1";
  values["GLOG_minloglevel"] = "2";
  values["LC_ALL"] = "C";
  values["HDF5_USE_FILE_LOCKING"] = "FALSE";  // files of the cache are complete when they appear; NFS may have no locks
  values["MOCURATE_RUNNER_PID"] = std::to_string(getpid());
  std::vector<std::string> entries;
  for (const auto& [name, value] : values) entries.push_back(name + "=" + value);
  return entries;
}

/// In the child, between fork and exec: only calls that are safe there.
[[noreturn]] void Become(const char* program, char* const* arguments, char* const* environment, const Pipe& in,
                         const Pipe& out, const Pipe& words, pid_t runner) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != runner) _exit(static_cast<int>(ExitCode::kInterrupted));
  // Ctrl-C reaches the whole process group; the worker installs its own handlers once it runs.
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_IGN);
  signal(SIGUSR1, SIG_IGN);  // a batch system's warning is the runner's
  signal(SIGPIPE, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  dup2(in.read, STDIN_FILENO);
  dup2(out.write, STDOUT_FILENO);
  dup2(words.write, STDERR_FILENO);
  execve(program, arguments, environment);
  _exit(127);
}

void SetNonBlocking(int file) { fcntl(file, F_SETFL, fcntl(file, F_GETFL) | O_NONBLOCK); }

std::string SignalText(int signal) {
  const char* name = sigabbrev_np(signal);
  return name != nullptr ? std::string("SIG") + name : "signal " + std::to_string(signal);
}

}  // namespace

Expected<std::unique_ptr<WorkerProcess>> WorkerProcess::Start(const std::filesystem::path& program) {
  std::vector<std::string> environment = WorkerEnvironment();
  std::vector<char*> environment_pointers;
  for (std::string& entry : environment) environment_pointers.push_back(entry.data());
  environment_pointers.push_back(nullptr);
  std::string name = program.native();
  char* arguments[] = {name.data(), nullptr};

  Pipe in, out, words;
  const pid_t runner = getpid();
  const pid_t pid = in.Open() && out.Open() && words.Open() ? fork() : -1;
  if (pid == 0) Become(name.c_str(), arguments, environment_pointers.data(), in, out, words, runner);
  if (pid < 0) {
    const std::string reason = std::strerror(errno);
    for (Pipe* pipe : {&in, &out, &words}) pipe->Close();
    return Fail(ErrorCode::kMissingOnHost, "no process can be started: " + reason, name,
                "raise the limits of processes and open files (ulimit -u, ulimit -n) or use fewer jobs");
  }
  close(in.read);
  close(out.write);
  close(words.write);
  for (const int file : {in.write, out.read, words.read}) SetNonBlocking(file);
  std::unique_ptr<WorkerProcess> worker(new WorkerProcess());
  worker->program_ = program;
  worker->pid_ = pid;
  worker->to_ = in.write;
  worker->from_ = out.read;
  worker->words_ = words.read;
  return worker;
}

WorkerProcess::~WorkerProcess() {
  Close(to_);
  const struct timespec step { 0, 2000000 };
  for (int waited_ms = 0; pid_ > 0 && waited_ms < kGrace_ms; waited_ms += 2) {
    Pump();
    const pid_t reaped = waitpid(pid_, nullptr, WNOHANG);
    if (reaped == pid_ || (reaped < 0 && errno != EINTR)) pid_ = -1;
    if (pid_ > 0) nanosleep(&step, nullptr);
  }
  Reap();
}

void WorkerProcess::Close(int& file) {
  if (file >= 0) close(file);
  file = -1;
}

void WorkerProcess::Send(const nlohmann::json& message) {
  std::string frame = Frame(message);
  if (outgoing_.empty()) {
    outgoing_ = std::move(frame);
  } else {
    outgoing_ += frame;
  }
  WriteStdin();
}

void WorkerProcess::AddPolls(std::vector<pollfd>& polls) const {
  if (from_ >= 0) polls.push_back({from_, POLLIN, 0});
  if (words_ >= 0) polls.push_back({words_, POLLIN, 0});
  if (to_ >= 0 && !outgoing_.empty()) polls.push_back({to_, POLLOUT, 0});
}

void WorkerProcess::WriteStdin() {
  while (to_ >= 0 && !outgoing_.empty()) {
    const ssize_t count = write(to_, outgoing_.data(), outgoing_.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno != EAGAIN) Close(to_);  // the worker has ended; its stdout will close
    if (count <= 0) return;
    outgoing_.erase(0, static_cast<std::size_t>(count));
  }
  if (outgoing_.empty()) outgoing_.shrink_to_fit();  // a request over a whole set is tens of megabytes
}

void WorkerProcess::ReadStderr() {
  char bytes[16384];
  while (words_ >= 0) {
    const ssize_t count = read(words_, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count == 0 || (count < 0 && errno != EAGAIN)) Close(words_);
    if (count <= 0) break;
    partial_line_.append(bytes, static_cast<std::size_t>(count));
  }
  if (partial_line_.size() > kLongestOutput) partial_line_ += '\n';
  std::size_t end = partial_line_.find('\n');
  while (end != std::string::npos) {
    std::string line = partial_line_.substr(0, end);
    partial_line_.erase(0, end + 1);
    if (!line.empty()) last_line_ = line;
    lines_.push_back(std::move(line));
    end = partial_line_.find('\n');
  }
}

void WorkerProcess::Pump() {
  WriteStdin();
  char bytes[16384];
  while (from_ >= 0) {
    const ssize_t count = read(from_, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) break;
    if (count <= 0) {
      Close(from_);
      ended_ = true;
      break;
    }
    incoming_.append(bytes, static_cast<std::size_t>(count));
  }
  ReadStderr();
}

Expected<std::optional<nlohmann::json>> WorkerProcess::Receive() { return TakeMessage(incoming_); }

std::vector<std::string> WorkerProcess::TakeLines() { return std::exchange(lines_, {}); }

std::string WorkerProcess::Reap() {
  std::string how = "ended";
  if (pid_ > 0) {
    // One that closed its pipes by dying has an exit status of its own; a moment for it to appear, then force.
    int status = 0;
    pid_t reaped = 0;
    const struct timespec step { 0, 2000000 };
    for (int i = 0; ended_ && reaped == 0 && i < 100; ++i) {
      reaped = waitpid(pid_, &status, WNOHANG);
      if (reaped == 0) nanosleep(&step, nullptr);
    }
    if (reaped == 0) {
      kill(pid_, SIGKILL);
      while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) continue;
    }
    pid_ = -1;
    if (WIFEXITED(status)) exit_status_ = WEXITSTATUS(status);
    how = WIFSIGNALED(status) ? "killed by " + SignalText(WTERMSIG(status))
                              : "ended with exit status " + std::to_string(exit_status_);
  }
  ReadStderr();
  if (!partial_line_.empty()) {
    last_line_ = partial_line_;
    lines_.push_back(std::exchange(partial_line_, {}));
  }
  for (int* file : {&to_, &from_, &words_}) Close(*file);
  ended_ = true;
  return last_line_.empty() ? how : how + "; last output line: " + last_line_;
}

void WorkerProcess::Signal(int signal) const {
  if (pid_ > 0) kill(pid_, signal);
}

std::uint64_t WorkerProcess::MemoryBytes() const {
  std::ifstream statm("/proc/" + std::to_string(pid_) + "/statm");
  std::uint64_t pages = 0, resident = 0;
  if (!(statm >> pages >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t WorkerProcess::PeakMemoryBytes() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  std::string key;
  std::uint64_t kilobytes = 0;
  while (status >> key) {
    if (key == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

}  // namespace mocurate
