#include "app/job_items.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

#include "app/main_job.h"
#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/sha256.h"
#include "core/base/version.h"
#include "eval/tables/table.h"

namespace mocurate {
namespace {

bool HasArtifact(const ItemResult& item) { return !item.artifact.empty(); }

bool Failed(const ItemResult& item) {
  return !HasArtifact(item) &&
         (item.outcome.kind == OutcomeKind::kRefused || item.outcome.kind == OutcomeKind::kCrashed);
}

nlohmann::json StageSummary(const StageReport& stage) {
  return {{"stage", stage.stage},       {"items", stage.items.size()}, {"done", stage.done},
          {"doubtful", stage.doubtful}, {"refused", stage.refused},    {"crashed", stage.crashed}};
}

nlohmann::json ClipSummary(const ClipRecord& clip) {
  nlohmann::json summary = {{"item", clip.item},
                            {"kept", clip.kept()},
                            {"ingest", clip.evidence.outcome.summary},
                            {"fitting", clip.motion.outcome.summary},
                            {"canon", clip.canonical.outcome.summary},
                            {"findings", nlohmann::json::array()}};
  for (const ItemResult* item : {&clip.evidence, &clip.motion, &clip.canonical}) {
    if (item == &clip.motion && clip.motion.sha256 == clip.evidence.sha256) continue;
    for (const Finding& finding : item->outcome.findings) summary["findings"].push_back(finding);
  }
  if (const Error* error = clip.failure()) {
    summary["failure"] = {{"stage", clip.failed_stage()}, {"code", Name(error->code)}, {"message", error->Message()}};
  }
  return summary;
}

/// A row of the table from {"fid": [...], ...}.
Table::Row RowOf(const std::string& name, const nlohmann::json& metrics, const std::vector<std::string>& keys) {
  Table::Row row;
  row.name = name;
  for (const std::string& key : keys) row.cells.push_back({metrics.value(key, std::vector<double>())});
  return row;
}

}  // namespace

const Error* ClipRecord::failure() const {
  for (const ItemResult* stage : {&evidence, &motion, &canonical}) {
    if (Failed(*stage)) return &stage->outcome.error;
  }
  return nullptr;
}

std::string ClipRecord::failed_stage() const {
  if (Failed(evidence)) return "ingest";
  if (Failed(motion)) return "fitting";
  return Failed(canonical) ? "canon" : "";
}

StageInput InputFrom(const char* role, const ItemResult& item) { return {role, item.item, item.artifact, item.sha256}; }

StageInput SkeletonInput(const std::string& name_or_path) {
  std::string content;
  if (const auto resource = FindResource("skeletons/" + name_or_path + ".yaml")) {
    content = std::string(*resource);
  } else if (const auto file = ReadFile(name_or_path)) {
    content = *file;
  }
  return {"skeleton", name_or_path, name_or_path, Sha256Hex(content)};
}

std::vector<ItemSpec> ProportionItems(const std::vector<ClipRecord>& clips, const nlohmann::json& options) {
  std::map<std::string, std::map<std::string, const ClipRecord*>> persons;
  for (const ClipRecord& clip : clips) {
    if (HasArtifact(clip.evidence)) persons[clip.person()][clip.item] = &clip;
  }
  std::vector<ItemSpec> items;
  for (const auto& [person, members] : persons) {
    std::vector<std::string> ids;
    for (const auto& [id, clip] : members) ids.push_back(id);
    ItemSpec item{person, options, {}};
    for (const std::string& id : ChooseProportionClips(ids)) {
      const ClipRecord& clip = *members.at(id);
      item.inputs.push_back(InputFrom("evidence", clip.evidence));
      item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
    }
    items.push_back(std::move(item));
  }
  return items;
}

std::vector<const ClipRecord*> ClipsToDraw(const std::vector<ClipRecord>& clips, int count) {
  std::vector<const ClipRecord*> fitted;
  for (const ClipRecord& clip : clips) {
    if (HasArtifact(clip.motion)) fitted.push_back(&clip);
  }
  const auto residual = [](const ClipRecord* clip) {
    return clip->motion.outcome.summary.value("residual_rms_mm", 0.0);
  };
  std::sort(fitted.begin(), fitted.end(), [&](const ClipRecord* a, const ClipRecord* b) {
    return residual(a) != residual(b) ? residual(a) < residual(b) : a->item < b->item;
  });
  std::vector<const ClipRecord*> chosen;
  const std::size_t wanted = std::min(fitted.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < wanted; ++i) {
    chosen.push_back(fitted[wanted == 1 ? 0 : i * (fitted.size() - 1) / (wanted - 1)]);
  }
  return chosen;
}

Status CopyWhole(const std::filesystem::path& from, const std::filesystem::path& to) {
  return WriteFileWith(to, [&](const std::filesystem::path& temporary) -> Status {
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    int problem = file < 0 ? errno : 0;
    const Status read = ReadFileInParts(from, [&](std::string_view part) {
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

Status UnpackCapture(const std::filesystem::path& artifact, const std::filesystem::path& folder) {
  const auto text = ReadFile(artifact);
  if (!text) return Forward(text);
  if (Status made = MakeFolder(folder); !made) return made;
  const nlohmann::json capture = nlohmann::json::parse(*text);
  std::set<std::string> names;
  for (const auto& [name, content] : capture.at("files").items()) {
    names.insert(name);
    const std::string bytes = content.get<std::string>();
    if (const auto present = ReadFile(folder / name); present && *present == bytes) continue;
    if (Status written = WriteFile(folder / name, bytes); !written) return written;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (names.count(entry.path().filename().string()) == 0) std::filesystem::remove(entry.path());
  }
  return {};
}

Expected<WrittenTables> WriteTables(const nlohmann::json& metrics, const std::string& title,
                                    const std::filesystem::path& folder) {
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  const std::vector<std::string> keys = {"fid", "accuracy", "diversity", "multimodality"};
  Table table;
  table.title = title;
  table.columns = {"FID ↓", "Accuracy ↑", "Diversity →", "Multimodality →"};
  table.digits = {3, 3, 3, 3};
  for (const auto& [name, row] : metrics.at("rows").items()) {
    if (name == "Real")
      table.rows.insert(table.rows.begin(), RowOf("Real", row, keys));
    else
      table.rows.push_back(RowOf(name, row, keys));
  }
  table.notes = metrics.value("notes", std::vector<std::string>());
  WrittenTables written;
  written.markdown = ToMarkdown(table, IntervalKind::kStudent);
  const std::pair<const char*, std::string> files[] = {
      {"table.md", written.markdown + "\n" + ToMarkdown(table, IntervalKind::kAction2Motion)},
      {"table.csv", ToCsv(table)},
      {"table.tex", ToLatex(table, IntervalKind::kStudent)},
      {"table.json", metrics.at("rows").dump(1) + "\n"}};
  for (const auto& [name, text] : files) {
    if (Status done = WriteFile(folder / name, text); !done) return Forward(done);
    written.files.push_back(folder / name);
  }
  return written;
}

nlohmann::json RunSummary(const JobOptions& options, const std::vector<ClipRecord>& clips,
                          const std::map<std::string, ItemResult>& persons, const JobResult& result) {
  nlohmann::json run = {{"name", options.name},
                        {"description", options.description},
                        {"takes", options.takes},
                        {"created_by", CreatedBy()},
                        {"audit", result.audit},
                        {"metrics", result.metrics},
                        {"training", result.training},
                        {"fit_error", result.fit_error},
                        {"table_markdown", result.table},
                        {"stages", nlohmann::json::array()},
                        {"clips", nlohmann::json::array()},
                        {"persons", nlohmann::json::object()}};
  for (const StageReport& stage : result.stages) run["stages"].push_back(StageSummary(stage));
  for (const ClipRecord& clip : clips) run["clips"].push_back(ClipSummary(clip));
  for (const auto& [person, item] : persons) run["persons"][person] = item.outcome.summary;
  return run;
}

}  // namespace mocurate
