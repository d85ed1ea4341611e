#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/folders.h"
#include "tests/support/scratch_folder.h"

namespace mocurate::program {

namespace fs = std::filesystem;

inline std::string ReadText(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline void WriteText(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

struct Result {
  int exit_code = -1;  ///< 128 + signal when killed
  std::string out;
  std::string err;
  mutable std::shared_ptr<nlohmann::json> json = {};

  /// The output, parsed once: parts of it live as long as the result.
  nlohmann::json& Json() const {
    if (json == nullptr) json = std::make_shared<nlohmann::json>(nlohmann::json::parse(out));
    return *json;
  }
};

/// Environment of a started program.
struct Surroundings {
  std::string cache = "cache";              ///< below the folder of the test, unless absolute
  std::function<void()> before_start = {};  ///< runs in the child: limits, environment, terminals
  fs::path program = fs::path(kBinaryFolder) / "mocurate";
};

/// A started program; output goes to files of the folder.
class Started {
 public:
  Started(const ScratchFolder& folder, const std::vector<std::string>& arguments, const Surroundings& surroundings)
      : out_(folder / "out.txt"), err_(folder / "err.txt") {
    pid_ = fork();
    if (pid_ != 0) return;
    dup2(open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    dup2(open(err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    setenv("MOCURATE_CACHE", (folder / surroundings.cache).c_str(), 1);
    if (surroundings.before_start) surroundings.before_start();
    const std::string program = surroundings.program.native();
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  Started(const ScratchFolder& folder, const std::vector<std::string>& arguments, const std::string& cache = "cache")
      : Started(folder, arguments, Surroundings{cache}) {}

  pid_t pid() const { return pid_; }
  void Signal(int signal) const { kill(pid_, signal); }
  bool Running() {
    if (done_) return false;
    done_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return !done_;
  }
  Result Wait() {
    if (!done_) waitpid(pid_, &status_, 0);
    done_ = true;
    return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_), ReadText(out_), ReadText(err_)};
  }

 private:
  fs::path out_, err_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool done_ = false;
};

inline Result RunProgram(const ScratchFolder& folder, const std::vector<std::string>& arguments,
                         const std::string& cache = "cache") {
  return Started(folder, arguments, cache).Wait();
}

inline Result RunProgram(const ScratchFolder& folder, const std::vector<std::string>& arguments,
                         const Surroundings& surroundings) {
  return Started(folder, arguments, surroundings).Wait();
}

/// One cache for all cases of a process: what they share is made once.
inline std::string SharedCache() {
  static const ScratchFolder cache;
  return cache.path().native();
}

/// A small synthetic job up to the dataset: a few clips, seconds; fitted by the faster solver. One worker: to start
/// one takes longer than what it does here.
inline std::vector<std::string> SmallJob(const ScratchFolder& folder, const std::string& output,
                                         const std::string& jobs = "1") {
  return {"run",
          "-o",
          (folder / output).string(),
          "--to",
          "assemble",
          "--jobs",
          jobs,
          "--set",
          "ingest.synthetic.actions=[clap, kick, squat, walk, wave]",
          "--set",
          "ingest.synthetic.subjects=3",
          "--set",
          "ingest.synthetic.repetitions=1",
          "--set",
          "ingest.synthetic.duration=1.5 s",
          "--set",
          "fitting.solver=banded",
          "--set",
          "assemble.splits=[]"};
}

/// Items that the stages of a run took from the cache.
inline int FromCache(const nlohmann::json& document) {
  int count = 0;
  for (const auto& stage : document["stages"]) count += stage["from_cache"].get<int>();
  return count;
}

}  // namespace mocurate::program
