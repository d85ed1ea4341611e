#include "core/pipeline/progress.h"

#include <unistd.h>
#include <cmath>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/journal.h"

namespace mocurate {
namespace {

constexpr std::chrono::milliseconds kDrawEvery{100};
constexpr std::chrono::seconds kLogEvery{60}, kWriteEvery{5};
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

Progress::Progress(std::string stage, std::size_t items, bool wanted, std::filesystem::path file)
    : stage_(std::move(stage)),
      items_(items),
      file_(std::move(file)),
      logged_(wanted),
      shown_(wanted && isatty(STDERR_FILENO) == 1) {
  RemoveRecord();  // of a run that was killed
}

Progress::~Progress() {
  Clear();
  RemoveRecord();
}

void Progress::RemoveRecord() const {
  std::error_code ignored;
  if (!file_.empty()) std::filesystem::remove(file_, ignored);
}

void Progress::Count(const std::string& item, bool executed, bool failed) {
  if (at_work_.erase(item) > 0) WriteRecord();
  finished_ += 1;
  executed_ += executed ? 1 : 0;
  failed_ += failed ? 1 : 0;
  detail_.clear();
}

void Progress::Detail(const std::string& name, double fraction, const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  Item& item = at_work_[name];
  item.share = std::clamp(fraction, 0.0, 1.0);
  item.text = text;
  detail_ = std::to_string(static_cast<int>(100.0 * item.share)) + " % " + text;
  if (logged_ && !shown_ && now - item.logged >= kLogEvery) {
    item.logged = now;
    LogInfo(stage_ + " " + DisplayPath(name) + ": " + detail_);
  }
  if (file_.empty()) return;
  item.time = TimeNow();
  if (now - last_written_ < kWriteEvery) return;
  last_written_ = now;
  WriteRecord();
}

void Progress::WriteRecord() {
  if (file_.empty()) return;
  nlohmann::json items = nlohmann::json::array();
  for (const auto& [name, item] : at_work_) {
    items.push_back({{"item", name}, {"share", item.share}, {"text", item.text}, {"time", item.time}});
  }
  const nlohmann::json record = {{"stage", stage_}, {"items", std::move(items)}};
  (void)WriteFile(file_, record.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
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
