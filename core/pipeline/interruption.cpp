#include "core/pipeline/interruption.h"

#include <unistd.h>

#include "core/base/error.h"

namespace mocurate {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGUSR1, SIGPIPE, SIGXFSZ};
constexpr int kHandled = 3;  ///< the first; the others are ignored

volatile std::sig_atomic_t interruptions = 0;
volatile std::sig_atomic_t last_signal = 0;

void OnSignal(int signal) {
  last_signal = signal;
  interruptions = interruptions + 1;
  if (interruptions > 2) _exit(static_cast<int>(ExitCode::kInterrupted));
}

}  // namespace

Interruption::Interruption() {
  interruptions = 0;
  for (int i = 0; i < 5; ++i) {
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    action.sa_handler = i < kHandled ? OnSignal : SIG_IGN;  // no SA_RESTART: poll() shall return at once
    sigaction(kSignals[i], &action, &saved_[i]);
  }
}

Interruption::~Interruption() {
  for (int i = 0; i < 5; ++i) sigaction(kSignals[i], &saved_[i], nullptr);
}

int Interruption::Count() { return interruptions; }

const char* Interruption::SignalName() {
  if (last_signal == SIGUSR1) return "SIGUSR1";
  return last_signal == SIGTERM ? "SIGTERM" : "SIGINT";
}

bool Interruption::OutOfTime() { return last_signal == SIGUSR1; }

}  // namespace mocurate
