#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "canon/exports/layout.h"
#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/motion/gaps.h"
#include "job/verbs/export_clips.h"
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

void PrintExported(CommonArguments& common, const ExportArguments& arguments, const std::string& representation,
                   const Exported& exported) {
  nlohmann::json refused = nlohmann::json::object();
  for (const RefusedClip& clip : exported.refused) refused[clip.item] = clip.error.Message();
  nlohmann::json answer = {
      {"layout", arguments.layout}, {"files", exported.files}, {"refused", refused}, {"notes", exported.notes}};
  if (!representation.empty()) answer["representation"] = representation;
  if (!AnswersInText(common, answer)) return;
  Print("%s as %s in %s\n", Counted(static_cast<long long>(exported.files.size()), "clip").c_str(),
        representation.empty() ? arguments.layout.c_str() : representation.c_str(),
        DisplayPath(arguments.output).c_str());
  for (const RefusedClip& clip : exported.refused) {
    Print("refused: %s: %s\n", clip.item.c_str(), clip.error.Message().c_str());
  }
  for (const std::string& note : exported.notes) Print("note: %s\n", TerminalLine(note).c_str());
}

}  // namespace

Status ExportVerb(CommonArguments& common, const ExportArguments& arguments) {
  if (arguments.output.extension() == ".safetensors") return ExportNetwork(common, arguments);
  const Layout& layout = *FindLayout(arguments.layout);
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
  if (Status written = ExportClips(*clips, layout, *place, arguments.keep_inferred, exported); !written) return written;
  const std::size_t others = place->file.empty() ? OtherFilesIn(place->folder, exported.written) : 0;
  if (others > 0) {
    exported.notes.push_back(Counted(static_cast<long long>(others), "other file") +
                             " remain in the folder; source.yaml also reads those named like clips");
  }
  PrintExported(common, arguments, representation, exported);
  if (exported.refused.empty()) return {};
  const auto& [name, error] = exported.refused.front();
  return Fail(ErrorCode::kTooManyFailures,
              Counted(static_cast<long long>(exported.refused.size()), "clip") + " could not be exported; " + name +
                  ": " + error.what,
              error.where, error.hint);
}

}  // namespace mocurate
