#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/motion/operations.h"
#include "core/store/dataset_clips.h"
#include "core/store/truth_motions.h"
#include "report/html.h"
#include "report/options.h"
#include "report/run_facts.h"
#include "report/stages.h"
#include "report/viewer_data.h"
#include "report/viewer_evidence.h"

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

/// What an audit says about the clips of a set, by id.
struct SetAudit {
  std::map<std::string, nlohmann::json> clips;  ///< its lines: "map_x", "map_y", "nearest"
  std::map<std::string, std::vector<Finding>> findings;
};

/// Errors of reading, and kMalformed for another file.
Status AddAudit(const StageInput& input, SetAudit& audit) {
  const auto file = ReadJson(input.path);
  if (!file) return Forward(file);
  return GuardJson(input.name, [&] {
    for (const nlohmann::json& line : file->at("clips")) audit.clips[line.at("clip").get<std::string>()] = line;
    for (const nlohmann::json& found : file->at("findings")) {
      nlohmann::json whole = {{"joint", ""}, {"action", Name(FindingAction::kAudited)}};  // not in older files
      whole.update(found);
      audit.findings[found.at("clip").get<std::string>()].push_back(whole.get<Finding>());
    }
  });
}

/// What stands beside a set of motions: inputs "ROLE of NAME".
std::vector<const StageInput*> Beside(const StageRequest& request, const std::string& role, const std::string& name) {
  std::vector<const StageInput*> found;
  for (const StageInput& input : request.inputs) {
    if (input.role == role + " of " + name) found.push_back(&input);
  }
  return found;
}

/// Clips of a set, one at a time. `without`: clips that have no motion; `lost`: frames whose cloud cannot be read.
Status AddSet(const StageRequest& request, const StageInput& input, const ViewerOptions& options, ViewerData& data,
              std::vector<std::string>& without, std::size_t& lost) {
  const auto clips = DatasetClips::Open(input.path, DatasetClips::Check::kHashes);
  if (!clips) return Forward(clips);
  const auto outline = clips->Outline();
  if (!outline) return Forward(outline);
  RecordedEvidence evidence(request, input.name, options.clouds);
  SetAudit audit;
  for (const StageInput* file : Beside(request, "audit", input.name)) {
    if (Status added = AddAudit(*file, audit); !added) return added;
  }
  TruthMotions truth;
  for (const StageInput* file : Beside(request, "truth", input.name)) {
    if (Status added = truth.Add(file->path); !added) return added;
  }
  const int source = data.AddSource(input.name);
  int truth_source = -1;
  const std::map<int, std::string> parts = PartsOf(*outline);
  std::map<std::string, std::vector<Finding>> findings = std::move(audit.findings);
  std::set<std::string> ids;
  for (const Clip& clip : outline->clips) ids.insert(clip.id());
  for (Finding finding : outline->findings) {
    if (finding.action == FindingAction::kAudited && !audit.clips.empty()) continue;  // the audit has it
    if (ids.count(finding.clip) == 0) {  // of the recording, before it was cut
      const int begin = finding.frame_end > finding.frame_begin ? BeginFrameOf(finding.clip) : 0;
      finding.frame_begin += begin;
      finding.frame_end += begin;
      finding.clip = RecordingOf(finding.clip);
    }
    findings[finding.clip].push_back(finding);
  }
  int skin_number = -1;
  const StageInput* body = FindInput(request, "body");
  if (body != nullptr && !outline->joints_only && outline->skeleton) {
    const auto skin = ReadSkin(body->path, *outline->skeleton);
    const auto added = skin ? data.AddSkin(*skin, *outline->skeleton) : Forward(skin);
    if (!added && !options.skin_if_it_fits) return Forward(added);
    if (added) skin_number = *added;
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
    const auto seen = evidence.Of(*clip);
    if (!seen) return Forward(seen);
    lost += seen->lost;
    const std::string group = options.per_label == 0 ? "" : clip->label.empty() ? "no label" : clip->label;
    ViewedClip viewed{*clip,
                      FindingsOf(*clip, findings),
                      part == parts.end() ? "" : part->second,
                      group,
                      seen->tracks ? &*seen->tracks : nullptr,
                      seen->cameras,
                      seen->clouds,
                      skin_number};
    const nlohmann::json& line = audit.clips[clip->id()];
    if (Field(line, "map_x").is_number()) viewed.place = {line["map_x"], line["map_y"]};
    viewed.nearest = Field(line, "nearest");
    if (Status added = data.Add(source, viewed); !added) return added;
    auto real = truth.Of(*clip);
    if (!real) continue;
    if (truth_source < 0) truth_source = data.AddSource("truth");
    Clip true_clip;
    true_clip.identity = clip->identity;
    true_clip.label = clip->label;
    true_clip.rate = clip->rate;
    true_clip.motion = std::move(*real);
    if (const std::string origin = clip->Noted(kHeightOrigin); !origin.empty())
      true_clip.provenance[kHeightOrigin] = origin;
    Transform(clip->canonical_from_source, true_clip);
    ViewedClip true_viewed{true_clip, {}, viewed.part, group};
    const bool same =
        !true_clip.motion->joints_only() && SameTree(*true_clip.motion->skeleton, *clip->motion->skeleton);
    true_viewed.skin = same ? skin_number : -1;
    if (Status added = data.Add(truth_source, true_viewed); !added) return added;
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
  std::vector<std::string> without;
  std::size_t lost = 0;
  for (const StageInput& input : request.inputs) {
    if (input.role != "motions") continue;
    if (Status added = AddSet(request, input, *options, data, without, lost); !added) return Forward(added);
  }
  if (Status finished = data.Finish(); !finished) return Forward(finished);
  if (data.clips() == 0) {
    const bool named = !options->clips.empty() && without.empty();
    return Fail(named ? ErrorCode::kNotFound : ErrorCode::kInconsistent,
                named ? "no clip is called '" + options->clips.front() + "'" : "there is no clip with a motion",
                request.inputs.front().name, named ? "`mocurate inspect` lists the clips" : "give files of motions");
  }
  nlohmann::json index = data.Index();
  index["notes"] = nlohmann::json::array();  // said on the page: what it does not show
  if (!without.empty()) {
    index["notes"].push_back(Counted(static_cast<long long>(without.size()), "clip") +
                             " without a motion not shown, the first: " + without.front());
  }
  if (lost > 0) {
    index["notes"].push_back("The images or clouds of " + Counted(static_cast<long long>(lost), "frame") +
                             " cannot be read: they are not shown");
  }
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
  outcome.summary = {{"clips", data.clips()},        {"parts", whole ? 0 : data.parts()},
                     {"bytes", page.size()},         {"without_motion", without},
                     {"frames_without_cloud", lost}, {"sources", index["sources"].size()}};
  return outcome;
}

}  // namespace mocurate
