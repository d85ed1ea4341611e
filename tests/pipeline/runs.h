#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/pipeline/runner.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {

inline StageDeclaration Stage(const std::string& name, int version = 1) {
  return {name, version, "mocurate-test-worker"};
}

inline void Pause(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// A source folder, a cache and a run folder.
class Runs : public ::testing::Test {
 protected:
  Runs() {
    SetLogLevel(LogLevel::kError);
    options.run_folder = folder / "run";
    options.cache_folder = folder / "cache";
    options.jobs = 2;
  }

  std::filesystem::path Source(const std::string& name, const std::string& bytes) {
    const std::filesystem::path file = folder / name;
    EXPECT_TRUE(WriteFile(file, bytes));
    return file;
  }

  static ItemSpec Item(const std::string& item, const nlohmann::json& item_options = nlohmann::json::object()) {
    return {item, item_options, {}};
  }

  static ItemSpec Over(const std::string& item, const std::filesystem::path& file,
                       const nlohmann::json& item_options = nlohmann::json::object()) {
    return {item, item_options, {{"source", item, file, {}}}};
  }

  static std::vector<ItemSpec> Many(int count, const nlohmann::json& item_options) {
    std::vector<ItemSpec> items;
    for (int i = 0; i < count; ++i) items.push_back(Item("clip" + std::to_string(100 + i), item_options));
    return items;
  }

  Expected<StageReport> Run(const StageDeclaration& stage, const std::vector<ItemSpec>& items) {
    const Expected<std::unique_ptr<Runner>> runner = Runner::Make(options);
    if (!runner) return Forward(runner);
    return (*runner)->Run(stage, items);
  }

  static std::string Bytes(const ItemResult& result) {
    return ReadFile(result.artifact).value_or("unreadable: " + result.artifact.native());
  }

  std::vector<nlohmann::json> Journal() const {
    std::vector<nlohmann::json> lines;
    const std::string text = ReadFile(options.run_folder / "journal.jsonl").value_or("");
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      lines.push_back(nlohmann::json::parse(text.substr(at, end - at)));
      at = end + 1;
    }
    return lines;
  }

  /// Runs `work` in a process of its own; its return value is the exit status.
  static pid_t Fork(const std::function<int()>& work) {
    const pid_t pid = fork();
    if (pid == 0) _exit(work());
    return pid;
  }

  /// Exit status; minus the signal when one killed it.
  static int Wait(pid_t pid) {
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) continue;
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

  /// As the program ends: 0, or the exit code of the error.
  int ExitOf(const StageDeclaration& stage, const std::vector<ItemSpec>& items) {
    const Expected<StageReport> report = Run(stage, items);
    return report ? 0 : static_cast<int>(ExitCodeOf(report.error().code));
  }

  static bool Eventually(const std::function<bool()>& holds, double seconds = 10.0) {
    for (double waited = 0.0; waited < seconds; waited += 0.005) {
      if (holds()) return true;
      Pause(0.005);
    }
    return false;
  }

  /// False for a process that has ended or is a zombie.
  static bool Alive(pid_t pid) {
    const std::string stat = ReadFile("/proc/" + std::to_string(pid) + "/stat").value_or("");
    const std::size_t name_end = stat.rfind(')');
    return name_end != std::string::npos && stat[name_end + 2] != 'Z' && stat[name_end + 2] != 'X';
  }

  ScratchFolder folder;
  RunnerOptions options;
};

}  // namespace mocurate
