#include "core/pipeline/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <utility>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/pipeline/wire.h"

namespace mocurate {
namespace {

constexpr std::size_t kLongestLine = 16 << 20;

tl::unexpected<Error> CannotWrite(const std::filesystem::path& path, int problem) {
  return Fail(ErrorCode::kCannotWrite, std::string("journal cannot be written: ") + std::strerror(problem),
              DisplayPath(path), "free some space or make the folder writable, then run again to continue");
}

Status WriteWhole(int file, const std::filesystem::path& path, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = write(file, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return CannotWrite(path, count == 0 ? ENOSPC : errno);
    done += static_cast<std::size_t>(count);
  }
  return {};
}

}  // namespace

std::string TimeNow() {
  struct timespec now {};
  clock_gettime(CLOCK_REALTIME, &now);
  struct tm parts {};
  gmtime_r(&now.tv_sec, &parts);
  char date[32];
  char text[48];
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &parts);
  std::snprintf(text, sizeof text, "%s.%03ldZ", date, now.tv_nsec / 1000000);
  return text;
}

void ForEachLine(const std::filesystem::path& file, const std::function<void(const nlohmann::json& line)>& visit) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) return;
  std::string line;
  bool too_long = false;
  const auto end_line = [&] {
    const Expected<nlohmann::json> value = too_long ? nlohmann::json() : FromCanonicalText(line);
    if (value && value->is_object()) visit(*value);
    line.clear();
    too_long = false;
  };
  // Without one that can be read there is no line.
  static_cast<void>(ReadFileInParts(file, [&](std::string_view part) {
    for (std::size_t end = part.find('\n'); !part.empty(); end = part.find('\n')) {
      too_long = too_long || line.size() + std::min(end, part.size()) > kLongestLine;
      if (too_long) line.clear();
      if (!too_long) line.append(part.substr(0, end));
      if (end == std::string_view::npos) return;
      end_line();
      part.remove_prefix(end + 1);
    }
  }));
  if (!line.empty()) end_line();
}

std::string TextField(const nlohmann::json& line, const char* name, std::string otherwise) {
  const auto field = line.find(name);
  return field != line.end() && field->is_string() ? field->get<std::string>() : otherwise;
}

double NumberField(const nlohmann::json& line, const char* name, double otherwise) {
  const auto field = line.find(name);
  return field != line.end() && field->is_number() ? field->get<double>() : otherwise;
}

Journal::Journal(Journal&& other) noexcept : file_(std::exchange(other.file_, -1)), path_(std::move(other.path_)) {}

Journal& Journal::operator=(Journal&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(path_, other.path_);
  return *this;
}

Journal::~Journal() {
  if (file_ >= 0) close(file_);
}

Expected<Journal> Journal::Open(const std::filesystem::path& path) {
  Journal journal;
  journal.path_ = path;
  const Expected<int> file = OpenInPlace(path, O_APPEND);
  if (!file) return Forward(file);
  journal.file_ = *file;
  // A full disk may have cut the last line short: the next one starts anew.
  char last = '\n';
  const off_t end = lseek(journal.file_, 0, SEEK_END);
  if (end > 0 && pread(journal.file_, &last, 1, end - 1) == 1 && last != '\n') {
    if (Status completed = WriteWhole(journal.file_, path, "\n"); !completed) return Forward(completed);
  }
  return journal;
}

Status Journal::Add(nlohmann::json entry) {
  entry["time"] = TimeNow();
  return WriteWhole(file_, path_, CanonicalText(entry) + "\n");
}

}  // namespace mocurate
