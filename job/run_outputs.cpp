#include "job/run_outputs.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/pipeline/journal.h"
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
    {JobStage::kCanon, "", "curation_log.jsonl"},    {JobStage::kAssemble, "", "dataset.h5"},
    {JobStage::kAssemble, "", kSetFindings},         {JobStage::kTable, "", "metrics.json"},
    {JobStage::kTable, "tables", "table.md"},        {JobStage::kTable, "tables", "table.csv"},
    {JobStage::kTable, "tables", "table.tex"},       {JobStage::kTable, "tables", "table.json"},
    {JobStage::kTable, "tables", "recognition.md"},  {JobStage::kTable, "tables", "recognition.csv"},
    {JobStage::kTable, "tables", "recognition.tex"}, {JobStage::kTable, "tables", "recognition.json"},
    {JobStage::kReport, "", "report_input.json"},    {JobStage::kReport, "report", "index.html"},
    {JobStage::kReport, "report", "clip_*.html"},    {JobStage::kReport, "report", "clip_*.mp4"},
    {JobStage::kReport, "report", "clip.png"},       {JobStage::kReport, "report", "overlay.png"},
    {JobStage::kReport, "report", "cloud.png"}};

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

/// Adds the outputs in `folder`/`below`; the names begin with `below`.
void AddOutputs(const fs::path& folder, const fs::path& below, std::map<std::string, OutputFile>& outputs) {
  const auto add = [&](JobStage stage, const fs::path& name) {
    std::error_code gone, unknown;
    const fs::file_status status = fs::symlink_status(folder / name, gone);
    if (!fs::is_regular_file(status) && !fs::is_symlink(status)) return;
    OutputFile& output = outputs[name.native()];
    output = {stage, fs::file_size(folder / name, unknown), fs::last_write_time(folder / name, gone)};
  };
  for (const Output& output : kOutputs) {
    std::error_code missing;
    for (fs::directory_iterator entry(folder / below / output.folder, missing), end; entry != end;
         entry.increment(missing)) {
      const fs::path file = entry->path().filename();
      if (Matches(output.name, file.native())) add(output.stage, below / output.folder / file);
    }
  }
  for (const auto& entry : JournalOf(folder / below, TrainDeclaration().name)) {
    add(JobStage::kTrain, below / "checkpoints" / (FileNameOf(entry.first) + ".h5"));
  }
}

}  // namespace

std::map<std::string, OutputFile> OutputsIn(const fs::path& folder) {
  std::map<std::string, OutputFile> outputs;
  AddOutputs(folder, "", outputs);
  std::error_code missing;
  for (fs::directory_iterator set(folder / "data", missing), end; !missing && set != end; set.increment(missing)) {
    std::error_code unknown;  // a set has a journal; a substitute's files beside it are inputs
    if (!fs::exists(set->path() / "journal.jsonl", unknown)) continue;
    AddOutputs(folder, fs::path("data") / set->path().filename(), outputs);
  }
  return outputs;
}

std::vector<std::string> RunFilesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& [name, output] : OutputsIn(folder)) names.insert(name);
  std::error_code missing;
  for (fs::directory_iterator entry(folder / "checkpoints", missing), end; entry != end; entry.increment(missing)) {
    if (entry->path().extension() == ".h5") names.insert("checkpoints/" + entry->path().filename().native());
  }
  for (const char* name : kRecords) {
    std::error_code unknown;
    const fs::file_status status = fs::symlink_status(folder / name, unknown);
    if (fs::exists(status) && !fs::is_directory(status)) names.emplace(name);
  }
  return {names.begin(), names.end()};
}

std::map<std::string, nlohmann::json> JournalOf(const fs::path& folder, const std::string& stage) {
  std::map<std::string, nlohmann::json> entries;
  ForEachLine(folder / "journal.jsonl", [&](const nlohmann::json& entry) {
    if (TextField(entry, "stage") != stage) return;
    nlohmann::json& known = entries[TextField(entry, "item")];
    if (known.is_null() || TextField(known, "key") != TextField(entry, "key")) {
      known = entry;
      return;
    }
    // A continued run adds to its previous time.
    const auto both = [&](const char* what, auto&& join) {
      const double before = NumberField(known, what), now = NumberField(entry, what);
      if (before > 0.0 || now > 0.0) known[what] = join(before, now);
    };
    if (const auto cached = entry.find("from_cache"); cached != entry.end() && *cached == true) return;
    both("seconds", [](double a, double b) { return a + b; });
    both("peak_memory_bytes", [](double a, double b) { return std::max(a, b); });
    known["from_cache"] = false;
  });
  return entries;
}

Status CopyWhole(const std::filesystem::path& from, const std::filesystem::path& to) {
  Expected<PendingFile> copy = PendingFile::CreateOutput(to);
  if (!copy) return Forward(copy);
  Status written;
  const Status read = ReadFileInParts(from, [&](std::string_view part) {
    if (written) written = copy->Write(part);
  });
  if (!read) return read;
  return written ? copy->Publish() : written;
}

}  // namespace mocurate
