#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/store/dataset_clips.h"
#include "report/html.h"
#include "report/options.h"
#include "report/stages.h"
#include "report/viewer_data.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Part of each clip in the first split, by its row.
std::map<int, std::string> PartsOf(const Dataset& outline) {
  std::map<int, std::string> parts;
  if (outline.splits.empty()) return parts;
  const Split& split = outline.splits.front();
  for (const int row : split.train) parts[row] = "train";
  for (const int row : split.validation) parts[row] = "validation";
  for (const int row : split.test) parts[row] = "test";
  return parts;
}

/// Whether the clip is one of those that are asked for.
bool IsAsked(const Clip& clip, const ViewerOptions& options) {
  return options.clips.empty() || std::any_of(options.clips.begin(), options.clips.end(),
                                              [&](const std::string& name) { return IsCalled(clip, name); });
}

/// The evidence of a clip's recording, brought into the clip's world.
struct ClipEvidence {
  std::optional<JointTracks> tracks;
  std::vector<Camera> cameras;
};

/// Errors of reading. `files`: evidence by recording.
Expected<ClipEvidence> EvidenceOf(const Clip& clip, const std::map<std::string, fs::path>& files) {
  ClipEvidence seen;
  const auto file = files.find(RecordingOf(clip.id()));
  if (file == files.end()) return seen;
  const auto recorded = ReadEvidence(file->second);
  if (!recorded) return Forward(recorded);
  const Evidence& evidence = recorded->evidence;
  if (evidence.tracks) seen.tracks = TracksOfClip(clip, *evidence.tracks);
  for (const DepthView& view : evidence.depth_views) seen.cameras.push_back(view.camera);
  for (const KeypointView& view : evidence.keypoint_views) seen.cameras.push_back(view.camera);
  for (Camera& camera : seen.cameras) {
    camera.camera_from_world = camera.camera_from_world * Inverse(clip.canonical_from_source);
  }
  return seen;
}

/// Clips of a set, one at a time. `without`: clips that have no motion.
Status AddSet(const StageInput& input, const ViewerOptions& options, const StageInput* body,
              const std::map<std::string, fs::path>& evidence, ViewerData& data, std::vector<std::string>& without) {
  const auto clips = DatasetClips::Open(input.path, DatasetClips::Check::kHashes);
  if (!clips) return Forward(clips);
  const auto outline = clips->Outline();
  if (!outline) return Forward(outline);
  const int source = data.AddSource(input.name);
  const std::map<int, std::string> parts = PartsOf(*outline);
  std::map<std::string, std::vector<Finding>> findings;
  for (const Finding& finding : outline->findings) findings[finding.clip].push_back(finding);
  int skin_number = -1;
  if (body != nullptr && !outline->joints_only && outline->skeleton) {
    const auto skin = ReadSkin(body->path, *outline->skeleton);
    if (!skin && !options.skin_if_it_fits) return Forward(skin);
    if (skin) skin_number = data.AddSkin(*skin, *outline->skeleton);
  }
  std::map<std::string, std::int64_t> shown;  // of each label
  for (std::size_t row = 0; row < clips->size(); ++row) {
    if (!IsAsked(outline->clips[row], options)) continue;
    if (options.per_label > 0 && ++shown[clips->Label(row)] > options.per_label) continue;
    const auto clip = clips->Read(row);
    if (!clip) return Forward(clip);
    if (!clip->motion || clip->motion->frame_count() == 0) {
      without.push_back(clip->id());
      continue;
    }
    const auto part = parts.find(static_cast<int>(row));
    const auto seen = EvidenceOf(*clip, evidence);
    if (!seen) return Forward(seen);
    const std::string group = options.per_label == 0 ? "" : clip->label.empty() ? "no label" : clip->label;
    const ViewedClip viewed{*clip,
                            FindingsOf(*clip, findings),
                            part == parts.end() ? "" : part->second,
                            group,
                            seen->tracks ? &*seen->tracks : nullptr,
                            seen->cameras,
                            skin_number};
    if (Status added = data.Add(source, viewed); !added) return added;
  }
  return {};
}

std::string PartName(int part) { return "part_" + ZeroPadded(part, 4); }

}  // namespace

Expected<StageOutcome> ViewStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ViewerOptions>(request.options, "view");
  if (!options) return Forward(options);
  if (Status made = MakeFolder(request.output); !made) return Forward(made);
  Sha256 digest;  // of the parts: those of another page are refused
  ViewerData data([&](int part, const std::string& bytes) {
    const std::string text = Base64(bytes);
    digest.Add(text);
    return WriteFile(request.output / PartName(part), text);
  });
  const StageInput* body = FindInput(request, "body");
  std::vector<std::string> without;
  for (const StageInput& input : request.inputs) {
    if (input.role != "motions") continue;
    std::map<std::string, fs::path> evidence;
    for (const StageInput& other : request.inputs) {
      if (other.role == "evidence of " + input.name) evidence[other.name] = other.path;
    }
    if (Status added = AddSet(input, *options, body, evidence, data, without); !added) return Forward(added);
  }
  if (Status finished = data.Finish(); !finished) return Forward(finished);
  if (data.clips() == 0) {
    const bool named = !options->clips.empty() && without.empty();
    return Fail(named ? ErrorCode::kNotFound : ErrorCode::kInconsistent,
                named ? "no clip is called '" + options->clips.front() + "'" : "there is no clip with a motion",
                request.inputs.front().name, named ? "`mocurate inspect` lists the clips" : "give files of motions");
  }
  nlohmann::json index = data.Index();
  index["page"] = true;  // the address and keys of the browser's window are the viewer's
  const bool whole = data.bytes() * 4 / 3 <= static_cast<std::size_t>(options->page_bytes);
  const std::string set = digest.Hex().substr(0, 16);
  if (!whole) index["beside"] = {{"folder", options->beside}, {"set", set}};
  std::vector<std::string> parts;
  for (int part = 0; part < data.parts(); ++part) {
    const fs::path file = request.output / PartName(part);
    auto text = ReadFile(file);
    if (!text) return Forward(text);
    std::error_code problem;
    fs::remove(file, problem);
    if (whole) {
      parts.push_back(std::move(*text));
      continue;
    }
    const std::string call = "mocurateParts.take(" + std::to_string(kViewerSchema) + "," + nlohmann::json(set).dump() +
                             "," + std::to_string(part) + ",\"" + *text + "\");\n";
    if (Status written = WriteFile(request.output / (PartName(part) + ".js"), call); !written) return Forward(written);
  }
  const std::string page = ViewerPage(options->title, index, parts);
  if (Status written = WriteFile(request.output / "index.html", page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"clips", data.clips()},
                     {"parts", whole ? 0 : data.parts()},
                     {"bytes", page.size()},
                     {"without_motion", without},
                     {"sources", index["sources"].size()}};
  return outcome;
}

}  // namespace mocurate
