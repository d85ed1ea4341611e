#include "job/run_outputs.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "train/items.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// One output, or with `*` in its name one per clip.
struct Output {
  JobStage stage;
  const char* folder;
  std::string_view name;
};

constexpr Output kOutputs[] = {
    {JobStage::kCanon, "", "curation_log.jsonl"},     {JobStage::kAssemble, "", "dataset.h5"},
    {JobStage::kTable, "", "metrics.json"},           {JobStage::kTable, "tables", "table.md"},
    {JobStage::kTable, "tables", "table.csv"},        {JobStage::kTable, "tables", "table.tex"},
    {JobStage::kTable, "tables", "table.json"},       {JobStage::kTable, "tables", "recognition.md"},
    {JobStage::kTable, "tables", "recognition.csv"},  {JobStage::kTable, "tables", "recognition.tex"},
    {JobStage::kTable, "tables", "recognition.json"}, {JobStage::kReport, "", "report_input.json"},
    {JobStage::kReport, "report", "index.html"},      {JobStage::kReport, "report", "clip_*.html"},
    {JobStage::kReport, "report", "clip_*.mp4"},      {JobStage::kReport, "report", "clip.png"},
    {JobStage::kReport, "report", "overlay.png"},     {JobStage::kReport, "report", "cloud.png"}};

constexpr const char* kRecords[] = {"capture.json", "journal.jsonl", "lock", "run.json"};

/// `*` stands for the digits of a clip.
bool Matches(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  const std::string_view head = pattern.substr(0, star);
  const std::string_view tail = pattern.substr(star + 1);
  if (name.size() <= head.size() + tail.size()) return false;
  const std::string_view seed = name.substr(star, name.size() - head.size() - tail.size());
  return name.substr(0, star) == head && name.substr(name.size() - tail.size()) == tail &&
         std::all_of(seed.begin(), seed.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

fs::path RunOutputs::Place(const std::string& name) {
  placed_.insert(name);
  return folder_ / name;
}

std::vector<std::string> RunOutputs::Leftovers(JobStage first, JobStage last) const {
  std::set<std::string> found;
  for (const Output& output : kOutputs) {
    if (output.stage < first || output.stage > last) continue;
    std::error_code missing;
    for (fs::directory_iterator entry(folder_ / output.folder, missing), end; entry != end; entry.increment(missing)) {
      std::error_code gone;
      const fs::file_status status = entry->symlink_status(gone);
      const std::string name = (fs::path(output.folder) / entry->path().filename()).native();
      if (!Matches(output.name, entry->path().filename().native()) || placed_.count(name) != 0) continue;
      if (fs::is_regular_file(status) || fs::is_symlink(status)) found.insert(name);
    }
  }
  if (first > JobStage::kTrain || last < JobStage::kTrain) return {found.begin(), found.end()};
  for (const auto& entry : JournalOf(folder_, TrainDeclaration().name)) {
    const std::string name = "checkpoints/" + FileNameOf(entry.first) + ".h5";
    std::error_code gone;
    const fs::file_status status = fs::symlink_status(folder_ / name, gone);
    if (placed_.count(name) == 0 && (fs::is_regular_file(status) || fs::is_symlink(status))) found.insert(name);
  }
  return {found.begin(), found.end()};
}

Status RunOutputs::RemoveLeftovers(JobStage first, JobStage last) const {
  for (const std::string& name : Leftovers(first, last)) {
    std::error_code problem;
    fs::remove(folder_ / name, problem);
    if (problem) {
      return Fail(ErrorCode::kCannotWrite, "a file of an earlier run cannot be removed: " + problem.message(),
                  DisplayPath(folder_ / name), "remove it or choose another -o");
    }
    std::error_code not_empty;
    if (name.find('/') != std::string::npos) fs::remove((folder_ / name).parent_path(), not_empty);
  }
  return {};
}

void RunOutputs::WarnOfLeftovers() const {
  std::string names;
  for (const std::string& name : Leftovers(JobStage::kIngest, JobStage::kReport)) {
    names += (names.empty() ? "" : ", ") + name;
  }
  if (!names.empty()) LogWarning("files of an earlier run remain in the run folder: " + names);
}

std::vector<std::string> RunFilesIn(const fs::path& folder) {
  std::vector<std::string> names = RunOutputs(folder).Leftovers(JobStage::kIngest, JobStage::kReport);
  std::error_code missing;
  for (fs::directory_iterator entry(folder / "checkpoints", missing), end; entry != end; entry.increment(missing)) {
    const std::string name = "checkpoints/" + entry->path().filename().native();
    const bool listed = std::find(names.begin(), names.end(), name) != names.end();
    if (entry->path().extension() == ".h5" && !listed) names.push_back(name);
  }
  for (const char* name : kRecords) {
    std::error_code unknown;
    const fs::file_status status = fs::symlink_status(folder / name, unknown);
    if (fs::exists(status) && !fs::is_directory(status)) names.emplace_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::map<std::string, nlohmann::json> JournalOf(const fs::path& folder, const std::string& stage) {
  std::map<std::string, nlohmann::json> entries;
  const auto journal = ReadFile(folder / "journal.jsonl");
  if (!journal) return entries;
  for (const std::string_view line : SplitText(*journal, '\n')) {
    nlohmann::json entry = nlohmann::json::parse(line, nullptr, false);
    if (!entry.is_object() || entry.value("stage", nlohmann::json()) != stage) continue;
    nlohmann::json& known = entries[entry.value("item", std::string())];
    const bool same = !known.is_null() && known.value("key", nlohmann::json()) == entry.value("key", nlohmann::json());
    if (same) {  // a continued run adds to its previous time
      const auto both = [&](const char* what, auto&& join) {
        const double before = known.value(what, 0.0), now = entry.value(what, 0.0);
        if (before > 0.0 || now > 0.0) known[what] = join(before, now);
      };
      if (!entry.value("from_cache", false)) {
        both("seconds", [](double a, double b) { return a + b; });
        both("peak_memory_bytes", [](double a, double b) { return std::max(a, b); });
        known["from_cache"] = false;
      }
      continue;
    }
    known = std::move(entry);
  }
  return entries;
}

Status CopyWhole(const std::filesystem::path& from, const std::filesystem::path& to) {
  return WriteFileWith(to, [&](const std::filesystem::path& temporary) -> Status {
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    int problem = file < 0 ? errno : 0;
    Status read = ReadFileInParts(from, [&](std::string_view part) {
      while (problem == 0 && !part.empty()) {
        const ssize_t count = write(file, part.data(), part.size());
        if (count > 0) part.remove_prefix(static_cast<std::size_t>(count));
        if (count < 0 && errno != EINTR) problem = errno;
      }
    });
    if (file >= 0 && close(file) != 0 && problem == 0) problem = errno;
    if (!read) return read;
    if (problem == 0) return {};
    return Fail(ErrorCode::kCannotWrite, std::string("cannot be written: ") + std::strerror(problem), DisplayPath(to),
                "free space or choose another -o");
  });
}

}  // namespace mocurate
