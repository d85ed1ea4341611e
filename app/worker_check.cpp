#include "app/worker_check.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/text.h"

namespace mocurate {
namespace {

struct LibraryPackage {
  std::string_view library;  ///< beginning of the file's name
  std::string_view package;
};

constexpr LibraryPackage kPackages[] = {{"libtorch", "libtorch1.13"},
                                        {"libc10", "libtorch1.13"},
                                        {"libOpen3D", "libopen3d0.16"},
                                        {"libceres", "libceres3"},
                                        {"libglog", "libgoogle-glog0v6"},
                                        {"libgflags", "libgflags2.2"},
                                        {"libcholmod", "libcholmod3"},
                                        {"libcxsparse", "libcxsparse3"},
                                        {"libopenblas", "libopenblas0-pthread"},
                                        {"libblas", "libopenblas0-pthread"},
                                        {"liblapack", "libopenblas0-pthread"},
                                        {"libgomp", "libgomp1"},
                                        {"libyaml-cpp", "libyaml-cpp0.7"},
                                        {"libopencv_core", "libopencv-core406"},
                                        {"libopencv_imgproc", "libopencv-imgproc406"},
                                        {"libopencv_imgcodecs", "libopencv-imgcodecs406"},
                                        {"libhdf5_serial", "libhdf5-103-1"},
                                        {"libcrypto", "libssl3"},
                                        {"libstdc++", "libstdc++6"},
                                        {"libgcc_s", "libgcc-s1"}};

struct Answer {
  int exit_status = -1;  ///< -1: a signal ended it, or it could not be started
  std::string text;      ///< stdout and stderr
};

/// Starts `program` with our environment and `setting`, and reads all it says.
Answer Ask(const std::filesystem::path& program, const char* argument, const char* setting) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return {-1, std::strerror(errno)};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  std::string name = program.native();
  std::string word = argument;
  std::string assignment = setting;
  std::vector<char*> arguments = {name.data(), word.data(), nullptr};
  std::vector<char*> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) environment.push_back(*entry);
  environment.push_back(assignment.data());
  environment.push_back(nullptr);
  pid_t pid = -1;
  const int failed = posix_spawn(&pid, name.c_str(), &actions, nullptr, arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  Answer answer;
  if (failed != 0) answer.text = std::strerror(failed);
  char bytes[4096];
  for (ssize_t count = 1; failed == 0 && count != 0;) {
    count = read(ends[0], bytes, sizeof bytes);
    if (count < 0 && errno != EINTR) break;
    if (count > 0) answer.text.append(bytes, static_cast<std::size_t>(count));
  }
  close(ends[0]);
  int status = 0;
  if (failed == 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status)) answer.exit_status = WEXITSTATUS(status);
  return answer;
}

std::string LastLine(const std::string& text) {
  std::string last;
  for (const std::string_view line : SplitText(text, '\n')) {
    if (!Trim(line).empty()) last = std::string(Trim(line));
  }
  return last;
}

}  // namespace

std::string PackageOfLibrary(const std::string& library) {
  for (const LibraryPackage& known : kPackages) {
    if (library.compare(0, known.library.size(), known.library) == 0) return std::string(known.package);
  }
  return {};
}

WorkerCheck CheckWorkerProgram(const std::filesystem::path& program) {
  WorkerCheck check;
  // With this variable the dynamic linker lists what it would load ("libx.so.1 => not found") and starts nothing.
  const std::string listed = Ask(program, "--version", "LD_TRACE_LOADED_OBJECTS=1").text;
  for (const std::string_view line : SplitText(listed, '\n')) {
    const std::size_t arrow = line.find(" => not found");
    if (arrow == std::string_view::npos) continue;
    const std::string name(Trim(line.substr(0, arrow)));
    check.missing.push_back({name, PackageOfLibrary(name)});
  }
  const Answer answer = Ask(program, "--version", "LC_ALL=C");
  check.starts = answer.exit_status == 0 && check.missing.empty();
  (check.starts ? check.version : check.last_words) = LastLine(answer.text);
  return check;
}

}  // namespace mocurate
