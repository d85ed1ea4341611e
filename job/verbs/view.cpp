#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/runner.h"
#include "ingest/stages.h"
#include "job/config_loading.h"
#include "job/motion_files.h"
#include "job/run_and_capture.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "report/options.h"
#include "report/stages.h"

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

/// Evidence of a run's recordings as inputs, where the cache still has it.
std::vector<StageInput> EvidenceOfRun(const fs::path& run, const std::string& source) {
  std::vector<StageInput> inputs;
  const Cache cache(DefaultCacheFolder());
  for (const auto& [item, entry] : JournalOf(run, IngestDeclaration().name)) {
    const auto found = cache.Find(entry.value("key", ""));
    if (found && !found->artifact.empty())
      inputs.push_back({"evidence of " + source, item, found->artifact, found->sha256});
  }
  return inputs;
}

/// The body of skins: the given one, else body_cc0.h5 where it is found. Pages are passed on: a body that may not be,
/// SMPL, is never taken without being asked for.
fs::path PassableBody(const fs::path& given) {
  if (!given.empty()) return given;
  const fs::path found = FindBody();
  return found.filename() == "body_cc0.h5" ? found : fs::path();
}

/// Opens a page where a desktop is. False: there is none.
bool OpenPage(const fs::path& page) {
  const bool desktop = std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
  if (!desktop) return false;
  for (const char* program : {"/usr/bin/xdg-open", "/usr/bin/open"}) {
    if (access(program, X_OK) != 0) continue;
    return RunAndCapture(program, {page.string()}, {true, 20.0}).exit_status == 0;
  }
  return false;
}

/// Puts a page and its parts where they are asked for.
Status CopyPage(const fs::path& made, const fs::path& page, const fs::path& beside, int parts) {
  if (const fs::path folder = page.parent_path(); !folder.empty()) {
    if (Status there = MakeFolder(folder); !there) return there;
  }
  if (parts > 0) {
    if (Status there = MakeFolder(beside); !there) return there;
  }
  for (int part = 0; part < parts; ++part) {
    const std::string name = "part_" + ZeroPadded(part, 4) + ".js";
    if (Status plain = CheckNotLink(beside / name); !plain) return plain;
    if (Status copied = CopyWhole(made / name, beside / name); !copied) return copied;
  }
  return CopyWhole(made / "index.html", page);
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
  const fs::path name = inputs.front().stem();
  if (!kept) {
    page = fs::temp_directory_path() / ("mocurate-view-" + std::to_string(getuid())) / (name.string() + ".html");
    if (Status plain = CheckNotLink(page.parent_path()); !plain) return plain;
  }
  const fs::path beside = page.parent_path() / (page.stem().string() + "_files");
  if (Status free = CheckOutputs({page}, inputs, arguments.force || !kept); !free) return free;
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);

  ViewerOptions options;
  options.title = arguments.title.empty() ? name.string() : arguments.title;
  options.clips = arguments.clips;
  options.beside = beside.filename().string();
  options.skin_if_it_fits = arguments.body.empty();
  ItemSpec item{"view", OptionsToJson(options), {}};
  std::set<std::string> taken;
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
    item.inputs.push_back(std::move(*motions));
    if (*path == named.path) continue;
    for (StageInput& evidence : EvidenceOfRun(named.path, named.name)) item.inputs.push_back(std::move(evidence));
  }
  if (const fs::path body = PassableBody(arguments.body); !body.empty()) {
    item.inputs.push_back({"body", body.filename().string(), body, ""});
  }
  const auto made = (*stages)->One(ViewDeclaration(), std::move(item));
  if (!made) return Forward(made);
  const int parts = made->summary.at("parts").get<int>();
  if (Status copied = CopyPage(made->artifact, page, beside, parts); !copied) return copied;
  for (const nlohmann::json& clip : made->summary.at("without_motion")) {
    LogWarning(clip.get<std::string>() + " has no motion: it is not shown");
  }
  const bool opened = !kept && !common.json && OpenPage(page);
  nlohmann::json answer = made->summary;
  answer["page"] = DisplayPath(page);
  if (!AnswersInText(common, answer)) return {};
  Print("%s in %s%s\n", Counted(answer.at("clips").get<long long>(), "clip").c_str(), DisplayPath(page).c_str(),
        opened ? "" : "; open it in a browser");
  if (parts > 0) Print("its motions are in %s: keep both together\n", DisplayPath(beside).c_str());
  return {};
}

}  // namespace mocurate
