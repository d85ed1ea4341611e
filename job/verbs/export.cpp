#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "canon/exports/layout.h"
#include "canon/splits/leaks.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/motion/gaps.h"
#include "core/store/dataset_clips.h"
#include "ingest/checks/finding_table.h"
#include "ingest/read_motions.h"
#include "job/extractor_folder.h"
#include "job/motion_files.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// The weights of a checkpoint for other programs.
Status ExportNetwork(CommonArguments& common, const ExportArguments& arguments) {
  if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(arguments.path);
  if (!checkpoint) return Forward(checkpoint);
  if (Status written = ExportSafetensors(*checkpoint, arguments.output); !written) return written;
  if (AnswersInText(common, {{"path", DisplayPath(arguments.output)},
                             {"network", checkpoint->kind},
                             {"tensors", checkpoint->parameters.size()}})) {
    Print("%s of %s in %s\n", Counted(static_cast<long long>(checkpoint->parameters.size()), "tensor").c_str(),
          checkpoint->kind.c_str(), DisplayPath(arguments.output).c_str());
  }
  return {};
}

/// A recogniser for others to score with.
Status ExportExtractor(CommonArguments& common, const ExportArguments& arguments) {
  const std::vector<fs::path> files = {arguments.output / "weights.safetensors", arguments.output / "extractor.yaml",
                                       arguments.output / "manifest.json"};
  if (Status free = CheckOutputs(files, {arguments.path}, arguments.force); !free) return free;
  for (const fs::path& file : files) {
    if (Status plain = CheckNotLink(file); !plain) return plain;
  }
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(arguments.path);
  if (!checkpoint) return Forward(checkpoint);
  const std::string name = arguments.output.filename().string();
  if (Status written = WriteExtractorFolder(*checkpoint, name, arguments.output); !written) return written;
  if (AnswersInText(
          common,
          {{"path", DisplayPath(arguments.output)}, {"network", checkpoint->kind}, {"labels", checkpoint->labels}})) {
    Print("extractor of %s in %s\n", Counted(static_cast<long long>(checkpoint->labels.size()), "label").c_str(),
          DisplayPath(arguments.output).c_str());
  }
  return {};
}

/// Clips selected for an export, read one at a time.
struct ClipsToExport {
  ExportSet set;                                    ///< of the chosen clips; no folder yet
  std::function<Expected<Clip>(std::size_t)> read;  ///< by the position in set.ids
  std::vector<RefusedClip> refused;                 ///< clips of the files that could not be read
  std::vector<Finding> findings;                    ///< about the clips
};

/// Rows of the clips that --clip names; all without names. Error for the first name without a clip, or with several
/// where it has no span.
Expected<std::vector<std::size_t>> ChosenRows(const std::vector<std::string>& ids, const std::vector<Clip>& clips,
                                              const ExportArguments& arguments) {
  std::set<std::size_t> chosen;
  for (std::size_t row = 0; row < ids.size() && arguments.clips.empty(); ++row) chosen.insert(row);
  for (const std::string& name : arguments.clips) {
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < ids.size(); ++row) {
      if (ids[row] == name) rows = {row};
      if (ids[row] == name) break;
      if (clips.empty() ? IsCalled(ids[row], name) : IsCalled(clips[row], name)) rows.push_back(row);
    }
    if (rows.empty()) {
      const std::string example = ids.empty() ? "" : ", e.g. --clip '" + ids.front() + "'";
      return Fail(ErrorCode::kUsage, "no clip has the id '" + name + "'", DisplayPath(arguments.path),
                  "`mocurate inspect` lists the ids" + example);
    }
    if (rows.size() > 1 && name.find('#') == std::string::npos) {
      return Fail(ErrorCode::kUsage, std::to_string(rows.size()) + " clips are '" + name + "'",
                  DisplayPath(arguments.path), "give the whole id, e.g. --clip '" + ids[rows.front()] + "'");
    }
    chosen.insert(rows.begin(), rows.end());
  }
  const std::vector<std::size_t> rows(chosen.begin(), chosen.end());
  if (rows.empty()) return Fail(ErrorCode::kInconsistent, "the file has no clips", DisplayPath(arguments.path));
  return rows;
}

/// The split of --split; without it all.
Expected<std::vector<Split>> ChosenSplits(const std::vector<Split>& splits, const ExportArguments& arguments) {
  if (arguments.split.empty()) return splits;
  std::vector<std::string> names;
  for (const Split& split : splits) {
    names.push_back(split.name);
    if (split.name == arguments.split) return std::vector<Split>{split};
  }
  return Fail(ErrorCode::kUsage, "there is no split '" + arguments.split + "'", DisplayPath(arguments.path),
              names.empty() ? "it has no split: remove --split" : "the splits are " + JoinTexts(names));
}

/// `clips`: those of the ids, where they are in memory.
Status Choose(const std::vector<std::string>& ids, const std::vector<Clip>& clips, const std::vector<Split>& splits,
              const ExportArguments& arguments, std::vector<std::size_t>& rows, ExportSet& set) {
  Expected<std::vector<std::size_t>> chosen = ChosenRows(ids, clips, arguments);
  if (!chosen) return Forward(chosen);
  rows = std::move(*chosen);
  Expected<std::vector<Split>> of_set = ChosenSplits(splits, arguments);
  if (!of_set) return Forward(of_set);
  set.splits = std::move(*of_set);
  std::vector<int> positions(ids.size(), -1);  // of each row among the chosen
  for (const std::size_t row : rows) {
    positions[row] = static_cast<int>(set.ids.size());
    set.ids.push_back(ids[row]);
  }
  for (Split& split : set.splits) MoveRows(positions, split);
  return {};
}

Expected<ClipsToExport> OpenDataset(const ExportArguments& arguments) {
  Expected<DatasetClips> opened = DatasetClips::Open(arguments.path, DatasetClips::Check::kHashes);
  if (!opened) return Forward(opened);
  if (!(opened->axes() == AxisConvention())) {
    return Fail(ErrorCode::kUnsupported, "the axes of the file are '" + opened->axes().Text() + "', not '+x +y +z'",
                DisplayPath(arguments.path), "convert the file to right-handed axes, y up, facing +z");
  }
  const auto clips = std::make_shared<const DatasetClips>(std::move(*opened));
  std::vector<std::string> ids;
  for (std::size_t row = 0; row < clips->size(); ++row) ids.push_back(clips->Id(row));
  ClipsToExport open;
  std::vector<std::size_t> rows;
  if (Status known = Choose(ids, {}, clips->splits(), arguments, rows, open.set); !known) return Forward(known);
  open.set.skeleton = clips->skeleton();
  open.set.joints_only = !HasStoredRotations(arguments.path);
  const auto outline = clips->Outline();
  if (!outline) return Forward(outline);
  open.set.labels = outline->labels;
  open.set.fine_labels = outline->fine_labels;
  open.read = [clips, rows](std::size_t position) { return clips->Read(rows[position]); };
  return open;
}

/// One line for each reason for which files gave no clip.
void LogExcludedFiles(const std::vector<Finding>& excluded) {
  std::map<std::string, std::vector<const Finding*>> of_code;
  for (const Finding& finding : excluded) {
    if (finding.action == FindingAction::kExcluded) of_code[finding.code].push_back(&finding);
  }
  for (const auto& [code, findings] : of_code) {
    const Finding& first = *findings.front();
    Log(first.severity == Severity::kInfo ? LogLevel::kInfo : LogLevel::kWarning,
        Counted(static_cast<long long>(findings.size()), "file") + " not exported (" + code +
            "), the first: " + first.clip + ": " + first.message);
  }
}

Expected<ClipsToExport> ReadFiles(const ExportArguments& arguments, const ConfigRules& rules) {
  Expected<DeclaredMotions> declared = DeclareMotions(arguments.path, arguments.source, rules);
  if (!declared) return Forward(declared);
  Expected<ReadMotions> read = ReadAllMotions({declared->ingest, {}, PaddingAction::kNone, arguments.tolerate});
  if (!read) return Forward(read);
  for (const Finding& finding : read->set.findings) {
    if (finding.severity == Severity::kError)
      LogWarning((finding.clip.empty() ? "" : finding.clip + ": ") + finding.message + " (" + finding.code + ")");
  }
  LogExcludedFiles(read->excluded);
  const auto set = std::make_shared<const Dataset>(std::move(read->set));
  std::vector<std::string> ids;
  for (const Clip& clip : set->clips) ids.push_back(clip.id());
  ClipsToExport open;
  std::vector<std::size_t> rows;
  if (Status known = Choose(ids, set->clips, set->splits, arguments, rows, open.set); !known) return Forward(known);
  open.set.skeleton = set->skeleton;
  open.set.joints_only = set->joints_only;
  open.set.labels = set->labels;
  open.set.fine_labels = set->fine_labels;
  open.read = [set, rows](std::size_t position) { return Expected<Clip>(set->clips[rows[position]]); };
  const std::set<std::string> chosen(open.set.ids.begin(), open.set.ids.end());
  std::copy_if(set->findings.begin(), set->findings.end(), std::back_inserter(open.findings),
               [&](const Finding& finding) { return finding.clip.empty() || chosen.count(finding.clip) != 0; });
  open.findings.insert(open.findings.end(), read->excluded.begin(), read->excluded.end());
  open.refused = std::move(read->refused);
  for (RefusedClip& refused : declared->unreadable) open.refused.push_back(std::move(refused));
  return open;
}

/// Checks that would exclude clips or joints at ingest are only reported, and a first root at the origin is ignored.
std::map<std::string, std::string> ActionsOfChecks() {
  std::map<std::string, std::string> actions = {{"zero_joint", "{action: ignore}"}};
  for (const std::string& code : CheckCodes()) {
    if (CheckOptions().ActionFor(code) != OnFinding::kReport) actions[code] = "{action: report}";
  }
  return actions;
}

/// A dataset of mocurate is streamed; other files are read by their declaration, all at once. Errors of reading; kUsage
/// for an unknown --clip or --split.
Expected<ClipsToExport> OpenClipsToExport(const ExportArguments& arguments, const ConfigRules& rules) {
  const bool ours = arguments.source.empty() && IsMotionStore(arguments.path);
  Expected<ClipsToExport> open = ours ? OpenDataset(arguments) : ReadFiles(arguments, rules);
  if (open) open->set.checks = ActionsOfChecks();
  return open;
}

/// The one that is asked for; else the first whose files have the ending of the output, else the first.
const Layout& LayoutOf(const ExportArguments& arguments) {
  if (!arguments.layout.empty()) return *FindLayout(arguments.layout);
  const std::string ending = arguments.output.extension().string();
  const auto of_ending = std::find_if(Layouts().begin(), Layouts().end(), [&](const Layout& layout) {
    return !layout.ending.empty() && layout.ending == ending;
  });
  return of_ending == Layouts().end() ? Layouts().front() : *of_ending;
}

/// Destination of an export.
struct ExportPlace {
  fs::path folder;        ///< for the files
  std::string file;       ///< the single file of -o FILE.ending; empty: a folder is given
  bool one_clip = false;  ///< the file contains a single clip
};

Expected<ExportPlace> PlaceOf(const ExportArguments& arguments, const Layout& layout) {
  const std::string ending = arguments.output.extension().string();
  for (const Layout& other : Layouts()) {
    if (ending.empty() || other.ending != ending || other.ending == layout.ending) continue;
    return Fail(ErrorCode::kUsage, "'" + ending + "' is the ending of --layout " + std::string(other.name),
                DisplayPath(arguments.output),
                "--layout " + std::string(layout.name) + " writes a folder" +
                    (layout.ending.empty() ? "" : ", or a file that ends in " + std::string(layout.ending)));
  }
  if (layout.ending.empty() || ending != layout.ending) return ExportPlace{arguments.output, "", false};
  const fs::path parent = arguments.output.parent_path();
  return ExportPlace{parent.empty() ? fs::path(".") : parent, arguments.output.filename().string(),
                     !layout.Is(LayoutTrait::kAllInOneFile)};
}

/// Checks the command line's options against the layout.
Status CheckLayoutArguments(const ExportArguments& arguments, const Layout& layout, const ExportPlace& place) {
  if (!arguments.rotations.empty() && !layout.Is(LayoutTrait::kRepresentations)) {
    return Fail(ErrorCode::kUsage, "layout " + std::string(layout.name) + " has only one representation", "--as",
                "remove --as, which is for --layout npz");
  }
  if (!arguments.split.empty() && place.one_clip) {
    return Fail(ErrorCode::kUsage, "a file of one clip has no split", "--split",
                "remove --split, or name a folder with -o");
  }
  return {};
}

/// Without --force no file is overwritten, and no folder with other files is used.
Status CheckExportPlace(const ExportArguments& arguments, const ExportPlace& place) {
  std::error_code unknown;
  const fs::path& output = arguments.output;
  if (Status apart = CheckOutputs({place.file.empty() ? fs::path() : output}, {arguments.path}, true); !apart) {
    return apart;
  }
  if (fs::is_directory(output, unknown) && fs::exists(output / "run.json", unknown)) {
    return Fail(ErrorCode::kUsage, "the folder is a run folder", DisplayPath(output), "name another folder with -o");
  }
  if (arguments.force || !fs::exists(output, unknown)) return {};
  if (!place.file.empty() || !fs::is_directory(output, unknown)) {
    return Fail(ErrorCode::kUsage, "the file exists", DisplayPath(output),
                "use --force to overwrite it, or -o for another file");
  }
  if (fs::is_empty(output, unknown)) return {};
  return Fail(ErrorCode::kUsage, "the folder exists and is not empty", DisplayPath(output),
              "use -o for another folder, or --force to overwrite files of the same names and keep the others");
}

Status CheckRotations(const ClipsToExport& clips, const Layout& layout, const ExportArguments& arguments) {
  const bool wanted = layout.Is(LayoutTrait::kNeedsRotations) ||
                      (layout.Is(LayoutTrait::kRepresentations) && clips.set.rotations != RotationArrays::kNone);
  if (!wanted || !clips.set.joints_only) return {};
  return Fail(ErrorCode::kInconsistent,
              "the motions have no rotations, which layout " + std::string(layout.name) + " needs",
              DisplayPath(arguments.path),
              "add rotations with `mocurate fit`, or use --layout npz --as joints, csv or humanact12");
}

/// Results of the export by clip.
struct Exported {
  nlohmann::json files = nlohmann::json::array();  ///< {clip, path}
  std::set<fs::path> written;
  std::vector<RefusedClip> refused;
  std::vector<Finding> findings;
  std::vector<std::string> notes;
};

Status WriteFiles(const std::vector<ExportedFile>& files, const ExportPlace& place, Exported& exported) {
  if (Status made = MakeFolder(place.folder); !made) return made;
  for (const ExportedFile& file : files) {
    const bool named = file.path == place.file;  // by the user, who may name a link
    const Expected<fs::path> path = named ? place.folder / place.file : FileBelow(place.folder, fs::path(file.path));
    if (!path) return Forward(path);
    if (Status written = WriteFile(*path, file.bytes); !written) return written;
    exported.written.insert(path->lexically_normal());
  }
  return {};
}

/// A layout without states does not show which frames lack an observation. Error kInconsistent.
Status CheckInferred(const Clip& clip, const Layout& layout, bool keep) {
  if (keep || layout.Carries(ClipContent::kStates)) return {};
  const std::vector<FrameRun> runs = RunsWhere(InferredFrames(*clip.motion), true);
  if (runs.empty()) return {};
  int frames = 0;
  for (const FrameRun& run : runs) frames += run.frames();
  return Fail(ErrorCode::kInconsistent,
              Counted(frames, "frame") + " of " + std::to_string(clip.motion->frame_count()) + ", from frame " +
                  std::to_string(runs.front().begin) + ", lie in gaps without an observation, which layout " +
                  std::string(layout.name) + " cannot mark",
              clip.id(), "use --inferred keep, or --layout npz, which holds the states of frames");
}

/// Exports clip by clip; a clip that cannot be read, exported or written is refused and does not stop the others.
/// Errors: no clip was exported, or of writing the tables.
Status ExportClips(const ClipsToExport& clips, const Layout& layout, const ExportPlace& place, bool keep_inferred,
                   Exported& exported) {
  const std::unique_ptr<LayoutWriter> writer = layout.make(clips.set);
  NotCarried lost(layout);
  for (std::size_t position = 0; position < clips.set.ids.size(); ++position) {
    const std::string& id = clips.set.ids[position];
    const Expected<Clip> clip = clips.read(position);
    const Status marked = clip ? CheckInferred(*clip, layout, keep_inferred) : Status();
    Expected<std::vector<ExportedFile>> files = !clip    ? Forward(clip)
                                                : marked ? writer->Add(position, *clip)
                                                         : Forward(marked);
    if (!files) {
      exported.refused.push_back({id, files.error()});
      continue;
    }
    if (place.one_clip) files->front().path = place.file;
    if (Status written = WriteFiles(*files, place, exported); !written) {
      writer->RemoveLast();
      exported.refused.push_back({id, written.error()});
      continue;
    }
    lost.Count(*clip);
    if (WithoutControls(id + clip->label + clip->fine_label) != id + clip->label + clip->fine_label) {
      exported.notes.push_back("clip '" + WithoutControls(id) + "', label '" + WithoutControls(clip->label) +
                               "': '_' stands for control characters and bytes that are not UTF-8");
    }
    exported.files.push_back({{"clip", id}, {"path", files->empty() ? "" : files->front().path}});
  }
  if (exported.files.empty()) return tl::unexpected<Error>(exported.refused.front().error);
  const std::string note = lost.Note();
  if (!note.empty()) exported.notes.push_back(note);
  std::vector<ExportedFile> beside;
  if (!place.one_clip) {
    Expected<std::vector<ExportedFile>> tables = writer->Finish(exported.notes);
    if (!tables) return Forward(tables);
    beside = std::move(*tables);
  }
  for (nlohmann::json& file : exported.files) {
    std::string path = file["path"].get<std::string>();
    if (path.empty()) path = beside.front().path;
    file["path"] = DisplayPath(place.folder / path);
  }
  return WriteFiles(beside, place, exported);
}

/// Number of files of the folder that this export did not write.
std::size_t OtherFilesIn(const fs::path& folder, const std::set<fs::path>& written) {
  std::size_t others = 0;
  std::error_code problem;
  for (fs::recursive_directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    std::error_code unknown;
    if (at->is_directory(unknown)) continue;
    others += written.count(at->path().lexically_normal()) == 0 ? 1 : 0;
  }
  return others;
}

void PrintExported(CommonArguments& common, const ExportArguments& arguments, const Layout& layout,
                   const std::string& representation, const Exported& exported) {
  nlohmann::json refused = nlohmann::json::object();
  for (const RefusedClip& clip : exported.refused) refused[clip.item] = clip.error.Message();
  nlohmann::json answer = {{"layout", layout.name},
                           {"files", exported.files},
                           {"refused", refused},
                           {"notes", exported.notes},
                           {"findings", exported.findings}};
  if (!representation.empty()) answer["representation"] = representation;
  if (!AnswersInText(common, answer)) return;
  Print("%s as %s in %s\n", Counted(static_cast<long long>(exported.files.size()), "clip").c_str(),
        representation.empty() ? std::string(layout.name).c_str() : representation.c_str(),
        DisplayPath(arguments.output).c_str());
  for (const RefusedClip& clip : exported.refused) {
    Print("refused: %s: %s\n", clip.item.c_str(), clip.error.Message().c_str());
  }
  for (const std::string& note : exported.notes) Print("note: %s\n", TerminalLine(note).c_str());
}

}  // namespace

Status ExportVerb(CommonArguments& common, const ExportArguments& arguments) {
  if (arguments.layout == kExtractorLayout) return ExportExtractor(common, arguments);
  if (arguments.output.extension() == ".safetensors") return ExportNetwork(common, arguments);
  if (Status known = CheckTolerated(arguments.tolerate); !known) return known;
  const Layout& layout = LayoutOf(arguments);
  const Expected<ExportPlace> place = PlaceOf(arguments, layout);
  if (!place) return Forward(place);
  if (Status fits = CheckLayoutArguments(arguments, layout, *place); !fits) return fits;
  if (Status free = CheckExportPlace(arguments, *place); !free) return free;
  Expected<ClipsToExport> clips = OpenClipsToExport(arguments, {common.allow_include});
  if (!clips) return Forward(clips);
  if (place->one_clip && clips->set.ids.size() > 1) {
    return Fail(ErrorCode::kUsage,
                Counted(static_cast<long long>(clips->set.ids.size()), "clip") + " do not fit one " +
                    std::string(layout.ending) + " file",
                DisplayPath(arguments.output),
                "name a folder, or choose one clip, e.g. --clip '" + clips->set.ids.front() + "'");
  }
  std::error_code unknown;
  clips->set.folder = fs::absolute(place->folder, unknown).lexically_normal();
  clips->set.file = place->one_clip ? "" : place->file;
  std::string representation;
  if (layout.Is(LayoutTrait::kRepresentations)) {
    representation = arguments.rotations.empty() ? kRotationArraysNames.front().name : arguments.rotations;
    clips->set.rotations =
        std::find_if(kRotationArraysNames.begin(), kRotationArraysNames.end(), [&](const RotationArraysName& name) {
          return name.name == representation;
        })->value;
  }
  if (Status rotations = CheckRotations(*clips, layout, arguments); !rotations) return rotations;
  Exported exported;
  exported.refused = std::move(clips->refused);
  exported.findings = std::move(clips->findings);
  if (Status written = ExportClips(*clips, layout, *place, arguments.keep_inferred, exported); !written) return written;
  const std::size_t others = place->file.empty() ? OtherFilesIn(place->folder, exported.written) : 0;
  if (others > 0) {
    exported.notes.push_back(Counted(static_cast<long long>(others), "other file") +
                             " remain in the folder; source.yaml also reads those named like clips");
  }
  PrintExported(common, arguments, layout, representation, exported);
  if (exported.refused.empty()) return {};
  const auto& [name, error] = exported.refused.front();
  return Fail(ErrorCode::kTooManyFailures,
              Counted(static_cast<long long>(exported.refused.size()), "clip") + " could not be exported; " + name +
                  ": " + error.what,
              error.where, error.hint);
}

}  // namespace mocurate
