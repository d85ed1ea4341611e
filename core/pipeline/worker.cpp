#include "core/pipeline/worker.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>

#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/pipeline/wire.h"

namespace mocurate {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds kProgressEvery{100};

volatile std::sig_atomic_t stop_requested = 0;
void OnStop(int) { stop_requested = 1; }

/// The two ends of the conversation with the runner. Stages see /dev/null on stdin and stderr on stdout, so that
/// nothing a library prints or reads gets into it.
struct Channel {
  int in = -1;
  int out = -1;
  std::mutex writing;
  std::string buffer;
  std::chrono::steady_clock::time_point last_progress;

  bool Open() {
    in = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 10);
    out = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 10);
    const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    const bool opened = in >= 0 && out >= 0 && nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 &&
                        dup2(STDERR_FILENO, STDOUT_FILENO) >= 0;
    if (nothing > STDIN_FILENO) close(nothing);
    return opened;
  }

  bool Send(const json& message) {
    const std::string frame = Frame(message);
    const std::lock_guard<std::mutex> lock(writing);
    for (std::size_t done = 0; done < frame.size();) {
      const ssize_t count = write(out, frame.data() + done, frame.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }

  /// The next request; empty at the end of stdin. Error kMalformed.
  Expected<std::optional<json>> Receive() {
    while (true) {
      Expected<std::optional<json>> message = TakeMessage(buffer);
      if (!message || message->has_value()) return message;
      char bytes[65536];
      const ssize_t count = read(in, bytes, sizeof bytes);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return std::optional<json>();
      buffer.append(bytes, static_cast<std::size_t>(count));
    }
  }
};

Channel* open_channel = nullptr;

/// The kernel kills us when the runner ends, however it ends. False when it has ended already.
bool DieWithParent() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const char* runner = std::getenv("MOCURATE_RUNNER_PID");
  if (runner == nullptr) return true;
  return ParseInteger(runner) == static_cast<long long>(getppid());
}

void SetSignals() {
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  action.sa_handler = OnStop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = SIG_IGN;  // a size limit is an error of the write
  sigaction(SIGXFSZ, &action, nullptr);
}

bool EndsTheRun(ErrorCode code) {
  return code == ErrorCode::kCannotWrite || code == ErrorCode::kMissingOnHost || code == ErrorCode::kInterrupted ||
         code == ErrorCode::kInternal;
}

json Crashed(const StageRequest& request, const std::string& what) {
  const Error error{ErrorCode::kInternal, what, "stage " + request.stage + ", item " + request.item, {}};
  return {{"outcome", ToJson(StageOutcome{{OutcomeKind::kCrashed, {}, error}})}};
}

json Answer(const StageFunction& stage, const StageRequest& request) {
  try {
    const std::string where = "stage " + request.stage + ", item " + request.item;
    const Expected<StageOutcome> outcome = GuardJson(where, [&] { return stage(request); });
    if (outcome) return {{"outcome", ToJson(*outcome)}};
    if (EndsTheRun(outcome.error().code)) return {{"fatal", ToJson(outcome.error())}};
    return {{"outcome", ToJson(StageOutcome{{OutcomeKind::kRefused, {}, outcome.error()}})}};
  } catch (const std::bad_alloc&) {
    return Crashed(request, "memory ran out");
  } catch (const std::exception& exception) {
    return Crashed(request, std::string("unexpected exception: ") + exception.what());
  } catch (...) {
    return Crashed(request, "unexpected exception of unknown type");
  }
}

json AnswerTo(const std::map<std::string, StageFunction>& stages, json message) {
  const Expected<StageRequest> request = RequestFromJson(message);
  message = nullptr;  // the stage needs the memory: there may be 100,000 inputs
  if (!request) return {{"fatal", ToJson(Error{ErrorCode::kInternal, request.error().what, "worker", {}})}};
  const auto stage = stages.find(request->stage);
  if (stage == stages.end()) {
    return {{"fatal", ToJson(Error{ErrorCode::kInternal, "no stage '" + request->stage + "'", "worker", {}})}};
  }
  return Answer(stage->second, *request);
}

int Serve(Channel& channel, const std::map<std::string, StageFunction>& stages) {
  json names = json::array();
  for (const auto& stage : stages) names.push_back(stage.first);
  if (!channel.Send({{"hello", names}})) return static_cast<int>(ExitCode::kBug);
  while (true) {
    Expected<std::optional<json>> message = channel.Receive();
    if (!message) {
      Log(LogLevel::kError, message.error().Message());
      return static_cast<int>(ExitCodeOf(message.error().code));
    }
    if (!message->has_value()) return static_cast<int>(ExitCode::kDone);
    if (!channel.Send(AnswerTo(stages, **std::move(message)))) return static_cast<int>(ExitCode::kBug);
  }
}

}  // namespace

int RunWorker(const std::map<std::string, StageFunction>& stages) {
  if (!DieWithParent()) return static_cast<int>(ExitCode::kInterrupted);
  SetSignals();
  Channel channel;
  if (!channel.Open()) {
    Log(LogLevel::kError, std::string("worker has no pipes: ") + std::strerror(errno));
    return static_cast<int>(ExitCode::kBug);
  }
  open_channel = &channel;
  const int code = Serve(channel, stages);
  open_channel = nullptr;
  return code;
}

bool StopRequested() { return stop_requested != 0; }

void ReportProgress(double fraction, const std::string& text) {
  if (open_channel == nullptr) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - open_channel->last_progress < kProgressEvery) return;
  open_channel->last_progress = now;
  open_channel->Send({{"progress", fraction}, {"text", text}});
}

}  // namespace mocurate
