// A worker program with stages that behave and misbehave on purpose.

#include <fcntl.h>
#include <unistd.h>

#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/base/file.h"
#include "core/pipeline/worker.h"

namespace mocurate {
namespace {

void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

Expected<StageOutcome> Written(const StageRequest& request, const std::string& bytes) {
  if (Status written = WriteFile(request.output, bytes); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary["bytes"] = bytes.size();
  return outcome;
}

/// Input in upper case, then the option "suffix".
Expected<StageOutcome> Upper(const StageRequest& request) {
  const Expected<std::string> text = ReadFile(request.inputs.at(0).path);
  if (!text) return Forward(text);
  std::string upper;
  for (const char c : *text) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return Written(request, upper + request.options.value("suffix", ""));
}

/// Sum of the bytes of all inputs, times the option "factor".
Expected<StageOutcome> Sum(const StageRequest& request) {
  long long sum = 0;
  for (const StageInput& input : request.inputs) {
    const Expected<std::string> text = ReadFile(input.path);
    if (!text) return Forward(text);
    sum = std::accumulate(text->begin(), text->end(), sum);
  }
  return Written(request, std::to_string(sum * request.options.value("factor", 1)));
}

Expected<StageOutcome> Pid(const StageRequest& request) {
  if (Status written = WriteFile(request.options.at("pid_file").get<std::string>(), std::to_string(getpid()));
      !written) {
    return Forward(written);
  }
  Sleep(request.options.at("seconds").get<double>());
  return Written(request, request.item);
}

Expected<StageOutcome> SleepStage(const StageRequest& request) {
  Sleep(request.options.at("seconds").get<double>());
  return Written(request, "slept " + request.item);
}

/// Counts to a hundred in its scratch folder; stops early on request and keeps its state.
Expected<StageOutcome> Patient(const StageRequest& request) {
  const auto saved = request.scratch / "count";
  int count = std::atoi(ReadFile(saved).value_or("0").c_str());
  const int begin = count;
  for (; count < 100; ++count) {
    if (StopRequested()) {
      if (Status written = WriteFile(saved, std::to_string(count)); !written) return Forward(written);
      return Fail(ErrorCode::kInterrupted, "stopped at " + std::to_string(count));
    }
    Sleep(0.01);
  }
  Expected<StageOutcome> outcome = Written(request, "100");
  if (outcome) outcome->summary["begin"] = begin;
  return outcome;
}

Expected<StageOutcome> Refuse(const StageRequest& request) {
  if (request.options.value("keeps", false)) {
    if (Status written = WriteFile(request.scratch / "evidence", "why"); !written) return Forward(written);
  }
  return Fail(ErrorCode::kMalformed, "not a motion", request.item + ":3", "look at line 3");
}

/// Like canon with a clip that a rule of its options excludes.
Expected<StageOutcome> Exclude(const StageRequest& request) {
  StageOutcome outcome;
  outcome.kind = OutcomeKind::kExcluded;
  Finding finding;
  finding.clip = request.item;
  finding.code = "too_short";
  finding.message = "0.1 s, the least is 0.5 s";
  outcome.findings = {finding};
  outcome.error = {ErrorCode::kInconsistent, finding.message, request.item, {}};
  return outcome;
}

Expected<StageOutcome> Missing(const StageRequest&) { return Fail(ErrorCode::kNotFound, "no such cloud"); }

Expected<StageOutcome> Abort(const StageRequest& request) {
  if (request.options.value("only", request.item) != request.item) return Written(request, request.item);
  std::fputs("about to fail\nterminate called: bad joint\n", stderr);
  std::abort();
}

Expected<StageOutcome> Hang(const StageRequest& request) {
  if (request.options.value("only", request.item) == request.item) Sleep(3600.0);
  return Written(request, request.item);
}

Expected<StageOutcome> Hog(const StageRequest& request) {
  std::vector<char> memory(std::size_t{1} << 28, 1);
  Sleep(5.0);
  return Written(request, std::string(1, memory[request.item.size()]));
}

Expected<StageOutcome> Throw(const StageRequest&) { throw std::runtime_error("joint 99 of 24"); }

Expected<StageOutcome> WriteFail(const StageRequest&) {
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  const bool written = write(full, "x", 1) == 1;
  close(full);
  if (written) return StageOutcome{};
  return Fail(ErrorCode::kCannotWrite, "No space left on device", "/dev/full", "free some space");
}

Expected<StageOutcome> StdoutNoise(const StageRequest& request) {
  std::printf("a library prints what it likes\n");
  std::fflush(stdout);
  if (write(STDOUT_FILENO, "\x01\x00\x00\x00{", 5) != 5) return Fail(ErrorCode::kInternal, "stdout is closed");
  const bool silence = std::getchar() == EOF;
  return Written(request, silence ? "nothing on stdin" : "something on stdin");
}

Expected<StageOutcome> ProgressStage(const StageRequest& request) {
  for (int i = 0; i < 50; ++i) ReportProgress(i / 50.0, "step " + std::to_string(i));
  return Written(request, request.item);
}

/// A folder as artifact.
Expected<StageOutcome> Folder(const StageRequest& request) {
  for (const char* name : {"a", "sub/b"}) {
    const auto file = request.output / name;
    if (Status made = MakeFolder(file.parent_path()); !made) return Forward(made);
    if (Status written = WriteFile(file, request.item + name); !written) return Forward(written);
  }
  return StageOutcome{};
}

Expected<StageOutcome> Environment(const StageRequest& request) {
  std::string text;
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "GLOG_minloglevel", "LC_ALL"}) {
    const char* value = std::getenv(name);
    text += std::string(name) + "=" + (value != nullptr ? value : "") + "\n";
  }
  return Written(request, text);
}

}  // namespace
}  // namespace mocurate

int main() {
  using namespace mocurate;
  return RunWorker({{"upper", Upper},
                    {"sum", Sum},
                    {"pid", Pid},
                    {"sleep", SleepStage},
                    {"patient", Patient},
                    {"refuse", Refuse},
                    {"exclude", Exclude},
                    {"missing", Missing},
                    {"abort", Abort},
                    {"hang", Hang},
                    {"hog", Hog},
                    {"throw", Throw},
                    {"silent", [](const StageRequest&) { return StageOutcome{}; }},
                    {"large", [](const StageRequest& r) { return Written(r, std::string(1 << 20, 'x')); }},
                    {"write_fail", WriteFail},
                    {"stdout_noise", StdoutNoise},
                    {"progress", ProgressStage},
                    {"folder", Folder},
                    {"environment", Environment}});
}
