#include "job/run_and_capture.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/text.h"

namespace mocurate {
namespace {

char kPlainMessages[] = "LC_ALL=C";

/// Our environment with messages in English.
std::vector<char*> PlainEnvironment() {
  std::vector<char*> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (std::strncmp(*entry, "LC_ALL=", 7) != 0) environment.push_back(*entry);  // the first of two would count
  }
  environment.push_back(kPlainMessages);
  environment.push_back(nullptr);
  return environment;
}

/// Reads until the other end is closed. False after `silence_s` without data (0: no limit).
bool ReadAll(int end, double silence_s, std::string& text) {
  char bytes[4096];
  while (true) {
    pollfd waited{end, POLLIN, 0};
    const int ready = poll(&waited, 1, silence_s > 0.0 ? static_cast<int>(1e3 * silence_s) : -1);
    if (ready == 0) return false;
    const ssize_t count = ready > 0 ? read(end, bytes, sizeof bytes) : -1;
    if (count == 0 || (count < 0 && errno != EINTR)) return true;
    if (count > 0) text.append(bytes, static_cast<std::size_t>(count));
  }
}

}  // namespace

ProgramAnswer RunAndCapture(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                            const CaptureOptions& listening) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return {-1, std::strerror(errno)};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  if (listening.errors) {
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  }
  std::vector<std::string> words = {program.native()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::vector<char*> environment = PlainEnvironment();
  pid_t pid = -1;
  const int failed = posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  ProgramAnswer answer;
  if (failed != 0) answer.text = std::strerror(failed);
  if (failed == 0) answer.timed_out = !ReadAll(ends[0], listening.silence_s, answer.text);
  if (answer.timed_out) kill(pid, SIGKILL);
  close(ends[0]);
  int status = 0;
  if (failed == 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status)) answer.exit_status = WEXITSTATUS(status);
  return answer;
}

std::string LastLine(std::string_view text) {
  std::string_view last;
  for (const std::string_view line : SplitText(text, '\n')) {
    if (!Trim(line).empty()) last = Trim(line);
  }
  return std::string(last);
}

}  // namespace mocurate
