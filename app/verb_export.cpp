#include <algorithm>
#include <cctype>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "app/motion_files.h"
#include "app/verbs.h"
#include "canon/exports/motion_arrays.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/store/store.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Clips whose id is a name, or ends with it; all without names. Error of the first name that no clip has.
Expected<std::vector<const Clip*>> Choose(const Dataset& dataset, const ExportArguments& arguments) {
  std::set<std::string> found;
  std::vector<const Clip*> chosen;
  for (const Clip& clip : dataset.clips) {
    bool wanted = arguments.clips.empty();
    for (const std::string& name : arguments.clips) {
      if (clip.id() != name && !EndsWith(clip.id(), name)) continue;
      found.insert(name);
      wanted = true;
    }
    if (wanted) chosen.push_back(&clip);
  }
  for (const std::string& name : arguments.clips) {
    if (found.count(name) != 0) continue;
    const std::string example = dataset.clips.empty() ? "" : ", e.g. --clip '" + dataset.clips.front().id() + "'";
    return Fail(ErrorCode::kUsage, "no clip is called '" + name + "'", DisplayPath(arguments.path),
                "`mocurate inspect` lists them" + example);
  }
  if (chosen.empty()) return Fail(ErrorCode::kInconsistent, "the file holds no clips", DisplayPath(arguments.path));
  return chosen;
}

/// A clip's id as a path below a folder: parts of the id are folders; what a file system may refuse becomes '_'.
fs::path PathOfId(const std::string& id) {
  std::string safe;
  for (const char c : id) {
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                      std::string_view("._#-+/").find(c) != std::string_view::npos;
    safe += kept ? c : '_';
  }
  fs::path path;
  for (const fs::path& part : fs::path(safe).relative_path()) {
    if (!part.empty()) path /= part == "." || part == ".." ? fs::path("_") : part;
  }
  return path += ".npz";
}

/// A file for each clip. Error kUsage for one that is there already.
Expected<std::vector<fs::path>> PathsFor(const std::vector<const Clip*>& clips, const ExportArguments& arguments) {
  std::vector<fs::path> paths;
  std::set<fs::path> taken;
  if (arguments.output.extension() == ".npz") {
    if (clips.size() > 1) {
      return Fail(ErrorCode::kUsage,
                  Counted(static_cast<long long>(clips.size()), "clip") + " do not fit one .npz file",
                  DisplayPath(arguments.output),
                  "name a folder, or choose one with --clip, e.g. --clip '" + clips.front()->id() + "'");
    }
    paths.push_back(arguments.output);
  } else {
    for (const Clip* clip : clips) {
      fs::path path = arguments.output / PathOfId(clip->id());
      const fs::path stem = path.parent_path() / path.stem();
      for (int copy = 2; !taken.insert(path).second; ++copy) {
        path = stem;
        path += "~" + std::to_string(copy) + ".npz";
      }
      paths.push_back(path);
    }
  }
  for (const fs::path& path : paths) {
    std::error_code unknown;
    if (!arguments.force && fs::exists(path, unknown)) {
      return Fail(ErrorCode::kUsage, "the file is there already", DisplayPath(path),
                  "--force overwrites it, -o names another");
    }
  }
  return paths;
}

/// A dataset of ours as it stands; other files by their declaration.
Expected<ReadMotions> MotionsOf(const ExportArguments& arguments) {
  if (arguments.source.empty() && IsMotionStore(arguments.path)) {
    Expected<Dataset> dataset = ReadDataset(arguments.path);
    if (!dataset) return Forward(dataset);
    ReadMotions read;
    read.set = std::move(*dataset);
    return read;
  }
  Expected<DeclaredMotions> declared = DeclareMotions(arguments.path, arguments.source);
  if (!declared) return Forward(declared);
  Expected<ReadMotions> read = ReadAllMotions({declared->ingest, {}});
  if (!read) return Forward(read);
  for (RefusedClip& refused : declared->unreadable) read->refused.push_back(std::move(refused));
  return read;
}

/// The weights of a checkpoint for other programs.
Status ExportNetwork(CommonArguments& common, const ExportArguments& arguments) {
  std::error_code unknown;
  if (!arguments.force && fs::exists(arguments.output, unknown)) {
    return Fail(ErrorCode::kUsage, "the file is there already", DisplayPath(arguments.output),
                "--force overwrites it, -o names another");
  }
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(arguments.path);
  if (!checkpoint) return Forward(checkpoint);
  if (Status written = ExportSafetensors(*checkpoint, arguments.output); !written) return written;
  common.answered = common.json;
  if (common.json) {
    std::printf("%s\n", nlohmann::json({{"path", DisplayPath(arguments.output)},
                                        {"network", checkpoint->kind},
                                        {"tensors", checkpoint->parameters.size()}})
                            .dump(1)
                            .c_str());
  } else {
    std::printf("%s of %s in %s\n", Counted(static_cast<long long>(checkpoint->parameters.size()), "tensor").c_str(),
                checkpoint->kind.c_str(), DisplayPath(arguments.output).c_str());
  }
  return {};
}

}  // namespace

Status ExportVerb(CommonArguments& common, const ExportArguments& arguments) {
  if (arguments.output.extension() == ".safetensors") return ExportNetwork(common, arguments);
  const Expected<ReadMotions> read = MotionsOf(arguments);
  if (!read) return Forward(read);
  const Expected<std::vector<const Clip*>> clips = Choose(read->set, arguments);
  if (!clips) return Forward(clips);
  const Expected<std::vector<fs::path>> paths = PathsFor(*clips, arguments);
  if (!paths) return Forward(paths);
  const auto* rotations =
      std::find_if(kRotationArraysNames.begin(), kRotationArraysNames.end(),
                   [&](const RotationArraysName& name) { return name.name == arguments.rotations; });
  nlohmann::json files = nlohmann::json::array();
  for (std::size_t i = 0; i < clips->size(); ++i) {
    const Expected<Npz> arrays = ArraysOfMotion(*(*clips)[i], rotations->value);
    if (!arrays) return Forward(arrays);
    const Expected<std::string> bytes = EncodeNpz(*arrays, DisplayPath((*paths)[i]));
    if (!bytes) return Forward(bytes);
    if (Status made = MakeFolder((*paths)[i].parent_path().empty() ? fs::path(".") : (*paths)[i].parent_path());
        !made) {
      return made;
    }
    if (Status written = WriteFile((*paths)[i], *bytes); !written) return written;
    files.push_back({{"clip", (*clips)[i]->id()}, {"path", DisplayPath((*paths)[i])}});
  }
  common.answered = common.json;
  if (common.json) {
    nlohmann::json refused = nlohmann::json::object();
    for (const RefusedClip& clip : read->refused) refused[clip.item] = clip.error.Message();
    std::printf("%s\n",
                nlohmann::json({{"representation", arguments.rotations}, {"files", files}, {"refused", refused}})
                    .dump(1)
                    .c_str());
  } else {
    std::printf("%s as %s in %s\n", Counted(static_cast<long long>(clips->size()), "clip").c_str(),
                arguments.rotations.c_str(), DisplayPath(arguments.output).c_str());
  }
  if (read->refused.empty()) return {};
  const auto& [name, error] = read->refused.front();
  return Fail(
      ErrorCode::kTooManyFailures,
      Counted(static_cast<long long>(read->refused.size()), "clip") + " could not be read; " + name + ": " + error.what,
      error.where, error.hint);
}

}  // namespace mocurate
