#include "job/report_run.h"

#include <algorithm>
#include <functional>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/action_parts.h"
#include "core/motion/request.h"
#include "core/store/dataset_clips.h"
#include "job/run_folder.h"
#include "job/stage_runs.h"
#include "job/viewer_files.h"
#include "report/stages.h"
#include "train/options.h"
#include "train/stages.h"

namespace mocurate {
namespace {

constexpr const char* kViewerPage = "viewer.html";
constexpr const char* kGeneratedPage = "generated.html";
constexpr int kDrawnFits = 5;        // best, worst and evenly between
constexpr int kSamples = 3;          // generated of each class
constexpr double kLongVideos = 5.0;  // seconds from which the time of videos is logged

/// The clips drawn in a report: best, worst and evenly between by residual, `count` in all.
std::vector<const ClipRecord*> ClipsToDraw(const std::vector<ClipRecord>& clips, int count) {
  std::vector<const ClipRecord*> fitted;
  for (const ClipRecord& clip : clips) {
    if (!clip.motion.artifact.empty()) fitted.push_back(&clip);
  }
  const auto residual = [](const ClipRecord* clip) { return clip->motion.summary.value("residual_rms_mm", 0.0); };
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

/// "clip_001.html" of the first.
std::string ClipFileName(std::size_t index, const char* extension) {
  return "clip_" + ZeroPadded(static_cast<int>(index) + 1, 3) + "." + extension;
}

ItemSpec ClipItem(const ClipRecord& clip, nlohmann::json options) {
  ItemSpec item{clip.item, std::move(options), {InputFrom("evidence", clip.evidence), InputFrom("fit", clip.motion)}};
  item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
  return item;
}

nlohmann::json ClipSummary(const ClipRecord& clip) {
  nlohmann::json summary = {{"item", clip.item},
                            {"kept", clip.kept()},
                            {"suspect", clip.suspect()},
                            {"ingest", clip.evidence.summary},
                            {"fitting", clip.motion.summary},
                            {"canon", clip.canonical.summary},
                            {"findings", clip.findings()}};
  if (clip.joint_error_mm) summary["joint_error_mm"] = *clip.joint_error_mm;
  if (const ItemResult* stage = clip.ended()) {
    summary[clip.failed() ? "failure" : "excluded"] = {
        {"stage", clip.ended_at()}, {"code", clip.reason()}, {"message", stage->outcome.error.Message()}};
  }
  return summary;
}

/// {"title", "rows": [cells, the heading first], "notes"} of a table; null where it has no rows.
nlohmann::json TableTexts(const Table& table) {
  if (table.rows.empty()) return nullptr;
  return {{"title", table.title}, {"rows", CellTexts(table)}, {"notes", LinesBelow(table)}};
}

/// Contents of the report, without anything that differs between equal runs (times, paths).
nlohmann::json RunSummary(const ReportedRun& reported, const JobResult& result) {
  const JobOptions& options = reported.options;
  nlohmann::json run = {{"name", options.name},
                        {"description", options.description},
                        {"takes", options.takes},
                        {"created_by", CreatedBy()},
                        {"audit", result.audit},
                        {"metrics", result.metrics},
                        {"training", result.training},
                        {"untrained", nlohmann::json::object()},
                        {"ungenerated", nlohmann::json::object()},
                        {"unevaluated", nullptr},
                        {"fit_error", result.fit_error},
                        {"pages", result.pages},
                        {"viewers", result.viewers},
                        {"table", TableTexts(result.table)},
                        {"recognition", TableTexts(result.recognition)},
                        {"findings", result.set_findings},
                        {"stages", nlohmann::json::array()},
                        {"clips", nlohmann::json::array()},
                        {"persons", nlohmann::json::object()}};
  for (const auto& [item, error] : result.untrained) {
    run["untrained"][item] = {{"code", Name(error.code)}, {"message", error.Message()}};
  }
  for (const auto& [network, error] : result.ungenerated) run["ungenerated"][network] = error.Message();
  if (const auto& error = result.unevaluated) {
    run["unevaluated"] = {{"code", Name(error->code)}, {"message", error->Message()}};
  }
  for (const StageCounts& stage : result.stages) run["stages"].push_back(StageSummary(stage));
  run["replaces_rotations"] =
      std::count_if(reported.clips.begin(), reported.clips.end(), std::mem_fn(&ClipRecord::replaces_rotations));
  for (const ClipRecord& clip : reported.clips) {
    if (!clip.folder()) run["clips"].push_back(ClipSummary(clip));
    if (clip.folder()) run["findings"].push_back(clip.evidence.outcome.findings.back());
  }
  for (const auto& [person, item] : reported.persons) run["persons"][person] = item.summary;
  return run;
}

Status WriteVideos(const std::vector<const ClipRecord*>& clips, StageRuns& runs, const std::filesystem::path& folder,
                   std::vector<ClipPageOptions>& pages) {
  std::vector<ItemSpec> items;
  for (const ClipRecord* clip : clips) items.push_back(ClipItem(*clip, nlohmann::json::object()));
  const auto report = runs.Run(ClipVideoDeclaration(), std::move(items));
  const bool no_encoder = !report && report.error().code == ErrorCode::kMissingOnHost;
  if (!report && !no_encoder) return Forward(report);
  if (no_encoder) LogWarning("no videos: " + report.error().Message());
  if (report && report->seconds > kLongVideos) {
    LogInfo("the videos took " + RoundedText(report->seconds, 2) +
            " s of this run; --set report.videos=false skips them");
  }
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!no_encoder && !report->items[i].artifact.empty()) {
      pages[i].video = ClipFileName(i, "mp4");
      Status copied = CopyWhole(report->items[i].artifact, folder / "report" / pages[i].video);
      if (!copied) return copied;
    } else {
      // A cause common to all pages is reported without the clip where it occurred first.
      pages[i].no_video = no_encoder ? report.error().what : report->items[i].outcome.error.Message();
    }
  }
  return {};
}

/// Videos come first, as a page lists its files. Without an encoder there are pages without videos.
Status WriteClipPages(const ReportedRun& run, StageRuns& runs, const std::filesystem::path& folder, JobResult& result) {
  const ReportOptions& options = run.options.report;
  const auto clips = ClipsToDraw(run.clips, static_cast<int>(options.pages));
  std::vector<ClipPageOptions> pages(clips.size());
  if (options.videos) {
    if (Status written = WriteVideos(clips, runs, folder, pages); !written) return written;
  }
  std::vector<ItemSpec> items;
  for (std::size_t i = 0; i < clips.size(); ++i) items.push_back(ClipItem(*clips[i], OptionsToJson(pages[i])));
  const auto report = runs.Run(ClipPageDeclaration(), std::move(items));
  if (!report) return Forward(report);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (report->items[i].artifact.empty()) continue;
    const std::string page = ClipFileName(i, "html");
    if (Status copied = CopyWhole(report->items[i].artifact, folder / "report" / page); !copied) return copied;
    result.pages[clips[i]->item] = {{"page", page}, {"video", pages[i].video}};
  }
  return {};
}

/// Requests to a network that continues motions: for each class one sample, then transition and action again.
Expected<std::vector<MotionRequest>> ContinuedSamples(const ItemResult& dataset) {
  const auto clips = DatasetClips::Open(dataset.artifact, DatasetClips::Check::kNone);
  if (!clips) return Forward(clips);
  std::vector<MotionRequest> requests;
  for (std::size_t label = 0; label < clips->labels().size(); ++label) {
    for (std::size_t row = 0; row < clips->size(); ++row) {
      if (clips->Label(row) != clips->labels()[label]) continue;
      const auto clip = clips->Read(row);
      if (!clip) return Forward(clip);
      const auto parts = PartsOf(*clip);
      if (!parts) return Forward(parts);
      MotionRequest request;
      request.frames = parts->frames[0];
      request.seed = label + 1;
      request.script = {{static_cast<int>(label), parts->frames[1], parts->frames[2]}};
      request.previous_clip = clip->id();
      requests.push_back(std::move(request));
      break;
    }
  }
  return requests;
}

/// Motions of each class by the first seed of each generator. One that fails is missing.
Expected<std::vector<StageInput>> GeneratedMotions(const ReportedRun& run, StageRuns& runs, JobResult& result) {
  const TemporaryFolder scratch;
  if (scratch.path().empty()) return Forward(scratch.Missing());
  std::vector<ItemSpec> items;
  std::vector<std::string> names;
  for (const TrainedNetwork& network : run.networks) {
    const NetworkOptions& options = run.options.train.networks[network.network];
    const bool seen = std::find(names.begin(), names.end(), options.name) != names.end();
    if (!GeneratesMotions(options.kind) || options.kind == NetworkKind::kSsmct || network.IsSample() || seen) continue;
    std::vector<MotionRequest> requests;
    const bool continues = options.kind == NetworkKind::kMacvae;
    if (continues) {
      auto asked = ContinuedSamples(run.dataset);
      if (!asked) {
        result.ungenerated[options.name] = asked.error();
        continue;
      }
      requests = std::move(*asked);
    }
    const int classes = result.training.at(network.checkpoint.name).at("classes").get<int>();
    for (int i = 0; !continues && i < kSamples * classes; ++i) {
      MotionRequest request;
      request.label = i % classes;
      request.frames = static_cast<int>(options.data.frames);
      request.seed = static_cast<std::uint64_t>(i) + 1;
      requests.push_back(std::move(request));
    }
    const auto file = scratch.path() / ("requests_" + std::to_string(network.network) + ".json");
    if (Status written = WriteRequests(requests, file); !written) return Forward(written);
    StageInput generator = network.checkpoint;
    generator.role = "generator";
    items.push_back({"generated/" + options.name, nlohmann::json::object(), {generator}});
    items.back().inputs.push_back({"requests", "requests", file, ""});
    if (continues) items.back().inputs.push_back(InputFrom("previous", run.dataset));
    names.push_back(options.name);
  }
  std::vector<StageInput> generated;
  if (items.empty()) return generated;
  const auto motions = runs.Run(GenerateDeclaration(), std::move(items));
  if (!motions) return Forward(motions);
  for (std::size_t i = 0; i < motions->items.size(); ++i) {
    if (motions->items[i].artifact.empty()) {
      result.ungenerated[names[i]] = motions->items[i].outcome.error;
      continue;
    }
    generated.push_back(InputFrom("motions", motions->items[i]));
    generated.back().name = names[i];
  }
  return generated;
}

/// A page of the viewer beside the report.
Status WriteViewer(ItemSpec item, ViewerOptions options, const std::filesystem::path& page, StageRuns& runs) {
  options.beside = FolderBeside(page);
  options.skin_if_it_fits = true;
  item.options = OptionsToJson(options);
  if (const auto body = PassableBody(); !body.empty())
    item.inputs.push_back({"body", body.filename().string(), body, ""});
  const auto made = runs.One(ViewDeclaration(), std::move(item));
  if (!made) return Forward(made);
  if (const auto lost = made->summary.value("frames_without_cloud", 0LL); lost > 0) {
    LogWarning("the images or clouds of " + Counted(lost, "frame") + " cannot be read: the viewer does not show them");
  }
  return made->artifact.empty() ? Status() : CopyViewer(*made, page);
}

/// A page with all clips of the dataset, their evidence, audit and truth.
Status WriteClipsViewer(const ReportedRun& run, StageRuns& runs, const std::filesystem::path& folder) {
  StageInput dataset = InputFrom("motions", run.dataset);
  dataset.name = "dataset";
  ItemSpec item{"viewer", {}, {dataset}};
  for (const ClipRecord& clip : run.clips) {
    if (!clip.kept()) continue;
    item.inputs.push_back(InputFrom("evidence of dataset", clip.evidence));
    for (StageInput depth : run.options.report.clouds ? clip.depth : std::vector<StageInput>()) {
      depth.role = "depth of dataset";
      item.inputs.push_back(std::move(depth));
    }
  }
  if (!run.audit.artifact.empty()) item.inputs.push_back(InputFrom("audit of dataset", run.audit));
  for (StageInput truth : run.truth) {
    truth.role = "truth of dataset";
    item.inputs.push_back(std::move(truth));
  }
  ViewerOptions options;
  options.title = run.options.name;
  options.clouds = run.options.report.clouds;
  return WriteViewer(std::move(item), options, folder / "report" / kViewerPage, runs);
}

/// A page with the motions of `generated` beside real ones.
Status WriteGeneratedViewer(const ReportedRun& run, const std::vector<StageInput>& generated, StageRuns& runs,
                            const std::filesystem::path& folder) {
  StageInput dataset = InputFrom("motions", run.dataset);
  dataset.name = "Real";
  ItemSpec item{"generated_viewer", {}, {dataset}};
  item.inputs.insert(item.inputs.end(), generated.begin(), generated.end());
  ViewerOptions options;
  options.title = run.options.name + ": generated motions";
  options.per_label = kSamples;
  return WriteViewer(std::move(item), options, folder / "report" / kGeneratedPage, runs);
}

}  // namespace

nlohmann::json StageSummary(const StageCounts& stage) {
  return {{"stage", stage.stage},     {"branch", stage.branch},   {"items", stage.total},
          {"done", stage.done},       {"suspect", stage.suspect}, {"excluded", stage.excluded},
          {"refused", stage.refused}, {"crashed", stage.crashed}};
}

Status WriteReport(const ReportedRun& run, StageRuns& runs, const std::filesystem::path& folder, JobResult& result) {
  if (run.fits) {
    if (Status paged = WriteClipPages(run, runs, folder, result); !paged) return paged;
  }
  const auto input = folder / "report_input.json";
  ItemSpec item{"report", OptionsToJson(run.options.report), {}};
  item.inputs.push_back({"run", "run.json", input, ""});
  item.inputs.push_back(InputFrom("dataset", run.dataset));
  for (const ClipRecord* clip : ClipsToDraw(run.clips, kDrawnFits)) {
    item.inputs.push_back(InputFrom("evidence", clip->evidence));
    if (run.fits) item.inputs.push_back(InputFrom("fit", clip->motion));
  }
  if (run.options.report.viewer) {
    const auto generated = GeneratedMotions(run, runs, result);
    if (!generated) return Forward(generated);
    const auto note = [&](const char* name, const char* page, const Status& written) {
      if (written)
        result.viewers[name] = page;
      else
        result.viewers["failed"][name] = written.error().Message();
      if (!written) LogWarning("the report has no page " + std::string(page) + ": " + written.error().Message());
      return written || written.error().code != ErrorCode::kInterrupted;
    };
    const Status clips = WriteClipsViewer(run, runs, folder);
    if (!note("clips", kViewerPage, clips)) return clips;
    if (!generated->empty()) {
      const Status beside = WriteGeneratedViewer(run, *generated, runs, folder);
      if (!note("generated", kGeneratedPage, beside)) return beside;
    }
  }
  if (Status written = WriteFile(input, RunSummary(run, result).dump(1) + "\n"); !written) return written;
  const auto page = runs.One(ReportDeclaration(), std::move(item));
  if (!page) return Forward(page);
  if (page->artifact.empty()) return {};
  result.report = folder / "report/index.html";
  return CopyWhole(page->artifact, result.report);
}

}  // namespace mocurate
