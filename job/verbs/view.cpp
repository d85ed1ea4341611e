#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "canon/options.h"
#include "canon/stages.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/runner.h"
#include "ingest/stages.h"
#include "job/motion_files.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "job/viewer_files.h"
#include "report/options.h"
#include "report/stages.h"
#include "train/items.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// The motions of a path: those of a run are in its dataset.
Expected<fs::path> MotionsOf(const fs::path& path) {
  std::error_code unknown;
  if (!fs::exists(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(path),
                "give FILE, a run's folder, or NAME=FILE");
  }
  if (!fs::is_directory(path, unknown) || !fs::exists(path / "run.json", unknown)) return path;
  const fs::path dataset = path / "dataset.h5";
  if (!fs::exists(dataset, unknown)) {
    return Fail(ErrorCode::kNotFound, "the run has no dataset yet", DisplayPath(path),
                "go on with `mocurate run`, at least --to assemble");
  }
  return dataset;
}

/// What a stage of a run made as inputs of that role, where the cache still has it; `lost` counts what it has not.
void AddOfRun(const fs::path& run, const StageDeclaration& stage, const std::string& role, ItemSpec& item,
              long long& lost) {
  const Cache cache(DefaultCacheFolder());
  for (const auto& [made, entry] : JournalOf(run, stage.name)) {
    const auto found = cache.Find(entry.value("key", ""));
    if (found && !found->artifact.empty())
      item.inputs.push_back({role, made, found->artifact, found->sha256});
    else if (!found)
      ++lost;
  }
}

/// Opens a page where a desktop is, without waiting for the browser. False: there is none.
bool OpenPage(const fs::path& page) {
  constexpr const char* kOpener = "/usr/bin/xdg-open";
  const bool desktop = std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
  if (!desktop || access(kOpener, X_OK) != 0) return false;
  const pid_t child = fork();
  if (child != 0) return child > 0;
  setsid();
  if (const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC); nowhere >= 0) {
    for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
  }
  execl(kOpener, kOpener, page.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

/// A page in a folder of its own that only its owner can write; it stays until temporary files are cleared.
Expected<fs::path> TemporaryPage(const std::string& name) {
  std::error_code unknown;
  std::string folder = (fs::temp_directory_path(unknown) / "mocurate-view-XXXXXX").string();
  if (unknown || mkdtemp(folder.data()) == nullptr) {
    return Fail(ErrorCode::kCannotWrite, "no temporary folder for the page", folder, "name the page with -o");
  }
  return fs::path(folder) / (name + ".html");
}

}  // namespace

Status ViewVerb(CommonArguments& common, const ViewArguments& arguments) {
  if (Status known = CheckTolerated(arguments.tolerate); !known) return known;
  std::vector<fs::path> inputs;
  for (const std::string& text : arguments.motions) inputs.push_back(NamedPathOf(text).path);
  const bool kept = !arguments.output.empty();
  fs::path page = arguments.output;
  if (kept && page.extension() != ".html") {
    return Fail(ErrorCode::kUsage, "the output is not a page (.html)", DisplayPath(page), "name e.g. -o walk.html");
  }
  const std::string name = NamedPathOf(arguments.motions.front()).name;
  if (Status free = CheckOutputs({page}, inputs, arguments.force); !free) return free;
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);

  if (!kept) {
    auto temporary = TemporaryPage(FileNameOf(name));
    if (!temporary) return Forward(temporary);
    page = *temporary;
  }
  ViewerOptions options;
  options.title = arguments.title.empty() ? name : arguments.title;
  options.clips = arguments.clips;
  options.beside = FolderBeside(page);
  options.skin_if_it_fits = arguments.body.empty();
  ItemSpec item{"view", OptionsToJson(options), {}};
  std::set<std::string> taken;
  long long lost = 0;
  for (const std::string& text : arguments.motions) {
    const NamedPath named = NamedRow(text, taken);
    const auto path = MotionsOf(named.path);
    if (!path) return Forward(path);
    MotionFiles files{*path, arguments.source, {}, {}};
    files.rules = {common.allow_include};
    files.tolerate = arguments.tolerate;
    auto motions =
        MotionsInput(named.name, files, {}, "declare them with --source FILE (docs/adding_a_source.md)", **stages);
    if (!motions) return Forward(motions);
    if (arguments.audit) {
      StageInput audited = *motions;
      audited.role = "dataset";
      const auto audit =
          (*stages)->One(AuditDeclaration(), {named.name, OptionsToJson(AuditOptions()), {std::move(audited)}});
      if (!audit) return Forward(audit);
      const std::string role = "audit of " + named.name;
      item.inputs.push_back(InputFrom(role.c_str(), *audit));
    }
    item.inputs.push_back(std::move(*motions));
    if (*path == named.path) continue;
    AddOfRun(named.path, IngestDeclaration(), "evidence of " + named.name, item, lost);
    AddOfRun(named.path, TruthDeclaration(), "truth of " + named.name, item, lost);
    if (!arguments.audit) AddOfRun(named.path, AuditDeclaration(), "audit of " + named.name, item, lost);
  }
  if (const fs::path body = arguments.body.empty() ? PassableBody() : arguments.body; !body.empty()) {
    item.inputs.push_back({"body", body.filename().string(), body, ""});
  }
  const auto made = (*stages)->One(ViewDeclaration(), std::move(item));
  if (!made) return Forward(made);
  if (Status copied = CopyViewer(*made, page); !copied) return copied;
  for (const nlohmann::json& clip : made->summary.at("without_motion")) {
    LogWarning(clip.get<std::string>() + " has no motion: it is not shown");
  }
  const bool opened = !kept && !common.json && OpenPage(page);
  nlohmann::json answer = made->summary;
  answer["page"] = DisplayPath(page);
  answer["not_cached"] = lost;
  if (lost > 0) {
    LogWarning("the cache no longer has " + Counted(lost, "result") +
               " of the run: its evidence, audit or truth is not shown; run again");
  }
  if (!AnswersInText(common, answer)) return {};
  Print("%s in %s%s\n", Counted(answer.at("clips").get<long long>(), "clip").c_str(), DisplayPath(page).c_str(),
        opened ? "" : "; open it in a browser");
  if (answer.at("parts") > 0) {
    Print("its motions are in %s: keep both together\n", DisplayPath(page.parent_path() / FolderBeside(page)).c_str());
  }
  return {};
}

}  // namespace mocurate
