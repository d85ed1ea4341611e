#include "core/pipeline/progress.h"

#include <unistd.h>
#include <cmath>

#include <algorithm>
#include <cstdio>

#include "core/base/terminal.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::chrono::milliseconds kDrawEvery{100};
constexpr std::size_t kWidest = 110;

std::string Duration(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole < 120) return std::to_string(whole) + " s";
  if (whole < 7200) return std::to_string(whole / 60) + " min";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

void Write(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

Progress::Progress(std::string stage, std::size_t items, bool wanted)
    : stage_(std::move(stage)), items_(items), shown_(wanted && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { Clear(); }

void Progress::Count(bool executed, bool failed) {
  finished_ += 1;
  executed_ += executed ? 1 : 0;
  failed_ += failed ? 1 : 0;
  detail_.clear();
}

void Progress::Detail(double fraction, const std::string& text) {
  detail_ = std::to_string(static_cast<int>(100.0 * std::clamp(fraction, 0.0, 1.0))) + " % " + text;
}

std::string Progress::Text() const {
  std::string text = std::to_string(finished_) + "/" + std::to_string(items_);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (executed_ > 0 && seconds > 0.0) {
    const double rate = static_cast<double>(executed_) / seconds;
    char rate_text[32];
    std::snprintf(rate_text, sizeof rate_text, ", %lld.%lld/s", static_cast<long long>(rate),
                  static_cast<long long>(rate * 10.0) % 10);
    text += rate_text;
    if (finished_ < items_) text += ", " + Duration(static_cast<double>(items_ - finished_) / rate) + " to go";
  }
  if (failed_ > 0) text += ", " + std::to_string(failed_) + " failed";
  if (!detail_.empty()) text += ", " + detail_;
  return text;
}

void Progress::Draw() {
  const auto now = std::chrono::steady_clock::now();
  if (!shown_ || now - last_draw_ < kDrawEvery) return;
  last_draw_ = now;
  drawn_ = true;
  std::string line = TerminalLine(stage_ + " " + Text());
  std::size_t length = 0;  // whole characters
  while (length < line.size()) {
    const std::size_t next = length + FirstCharacter(std::string_view(line).substr(length)).bytes;
    if (next > kWidest) break;
    length = next;
  }
  Write("\r\x1b[K" + line.substr(0, length));
}

void Progress::Clear() {
  if (drawn_) Write("\r\x1b[K");
  drawn_ = false;
}

}  // namespace mocurate
