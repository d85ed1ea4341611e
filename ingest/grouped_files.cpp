#include "ingest/grouped_files.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "core/base/text.h"
#include "core/formats/openpose.h"
#include "ingest/chosen_clips.h"
#include "ingest/formats/driver.h"
#include "ingest/item_facts.h"
#include "ingest/sources/frame_files.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

NameFields OfClip(NameFields fields) {
  fields.erase("camera");
  fields.erase("frame");
  fields.erase("-");
  return fields;
}

NameFields Only(const std::vector<std::string>& names, const NameFields& fields) {
  NameFields kept;
  for (const std::string& name : names) {
    const auto found = fields.find(name);
    if (found != fields.end()) kept.insert(*found);
  }
  return kept;
}

}  // namespace

Status CheckGrouped(const SourceOptions& s) {
  const std::vector<std::string> fields = FieldsOf(s.files);
  const auto has = [](const std::vector<std::string>& list, const char* field) {
    return std::find(list.begin(), list.end(), field) != list.end();
  };
  const FormatDriver& driver = DriverOf(s.format);
  const bool views = has(driver.grouped_by, "camera");
  for (const std::string& field : driver.grouped_by) {
    if (has(fields, field.c_str())) continue;
    return Fail(
        ErrorCode::kConfig, "'" + s.files + "' does not declare which " + field + " a file is of",
        "ingest.source.files",
        views ? "e.g. '{recording}/{camera}_json/{camera}.{frame}.json'" : "e.g. '{recording}/body_{frame}.json'");
  }
  if (!views && has(fields, "camera")) {
    return Fail(
        ErrorCode::kConfig, "'" + s.files + "' names {camera}, but " + s.format + " files are of all cameras together",
        "ingest.source.files", "one file per frame; what else differs in their names is e.g. {recording}, or {-}");
  }
  const std::pair<const char*, const std::string*> texts[] = {{"recording", &s.recording}, {"person", &s.person},
                                                              {"label", &s.label},         {"session", &s.session},
                                                              {"view", &s.view},           {"style", &s.style}};
  for (const auto& [option, text] : texts) {
    for (const char* field : {"camera", "frame", "file"}) {
      if (!has(FieldsOf(*text), field)) continue;
      return Fail(ErrorCode::kConfig,
                  "'" + *text + "' names {" + field + "}, which differs between the files of one clip",
                  std::string("ingest.source.") + option,
                  "name what the files of a clip have in common, e.g. {recording}, or write a fixed name");
    }
  }
  if (views && s.calibration.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not declare the camera poses",
                "ingest.source.calibration", "e.g. 'Calib.toml', or [intri.yml, extri.yml]");
  }
  if (Status first = CheckFirstFrames(s); !first) return first;
  const Expected<NamePattern> depth = NamePattern::Parse(s.depth_files, "ingest.source.depth_files");
  if (!depth) return Forward(depth);
  const std::vector<std::string> of_depth = depth->FieldNames();
  if (HasDepthBeside(s) && (!has(of_depth, "camera") || !has(of_depth, "frame"))) {
    return Fail(ErrorCode::kConfig,
                "'" + s.depth_files + "' does not declare which camera and which frame an image is of",
                "ingest.source.depth_files", "e.g. '{recording}/depth/{camera}_{frame}.png'");
  }
  bool known = s.keypoints == "measured";
  std::string names;
  for (const KeypointLayout& layout : KeypointLayouts()) {
    known = known || layout.name == s.keypoints;
    names += layout.name + ", ";
  }
  if (!known) {
    return Fail(ErrorCode::kConfig, "'" + s.keypoints + "' is no known layout of keypoints", "ingest.source.keypoints",
                "known are " + names + "and measured");
  }
  return CheckBodies(s);
}

int GroupedFiles::Depth(const SourceOptions& source) {
  int depth = std::max(DepthOf(source.mask_files), DepthOf(source.depth_files));
  for (const std::string& file : source.calibration) depth = std::max(depth, DepthOf(file));
  return depth;
}

Expected<GroupedFiles> GroupedFiles::Of(const SourceOptions& source, const NamePattern& pattern,
                                        const std::vector<FolderFile>& files) {
  GroupedFiles gathered;
  if (!DriverOf(source.format).gathered()) return gathered;
  gathered.source_ = &source;
  gathered.files_ = &files;
  for (const std::string& text : source.calibration) {
    Expected<NamePattern> calibration = NamePattern::Parse(text, "ingest.source.calibration");
    if (!calibration) return Forward(calibration);
    gathered.calibrations_.push_back(std::move(*calibration));
  }
  if (!source.mask_files.empty()) {
    Expected<NamePattern> masks = NamePattern::Parse(source.mask_files, "ingest.source.mask_files");
    if (!masks) return Forward(masks);
    gathered.masks_.push_back(std::move(*masks));
  }
  std::optional<NamePattern> depth;
  if (HasDepthBeside(source)) {
    const Expected<NamePattern> parsed = NamePattern::Parse(source.depth_files, "ingest.source.depth_files");
    if (!parsed) return Forward(parsed);
    depth = *parsed;
    const std::vector<std::string> own = depth->FieldNames();
    for (const std::string& field : pattern.FieldNames()) {
      const bool of_clip = field != "camera" && field != "frame" && field != "-";
      if (of_clip && std::find(own.begin(), own.end(), field) != own.end()) gathered.depth_fields_.push_back(field);
    }
  }
  std::map<NameFields, std::string> first;
  std::set<std::string> cameras;
  for (const FolderFile& file : files) {
    const auto matches = [&](const NamePattern& companion) { return companion.Match(file.name).has_value(); };
    if (std::any_of(gathered.calibrations_.begin(), gathered.calibrations_.end(), matches) ||
        std::any_of(gathered.masks_.begin(), gathered.masks_.end(), matches)) {
      gathered.others_.insert(file.name);
      continue;
    }
    if (const auto of_depth = depth ? depth->Match(file.name) : std::nullopt) {
      cameras.insert(of_depth->at("camera"));
      gathered.depth_[Only(gathered.depth_fields_, *of_depth)].push_back(&file);
      gathered.others_.insert(file.name);
      continue;
    }
    const std::optional<NameFields> fields = pattern.Match(file.name);
    if (!fields) continue;
    if (const auto camera = fields->find("camera"); camera != fields->end()) cameras.insert(camera->second);
    const auto [clip, fresh] = first.emplace(OfClip(*fields), file.name);
    if (!fresh) gathered.others_.insert(file.name);
    gathered.clips_[clip->second].push_back(&file);
  }
  if (gathered.clips_.empty()) return gathered;
  if (Status known = CheckFirstFrames(source, cameras); !known) return Forward(known);
  return gathered;
}

bool GroupedFiles::BelongsToOtherClip(const std::string& name) const { return others_.count(name) != 0; }

std::vector<std::string> GroupedFiles::NamesOf(const std::string& first) const {
  const auto clip = clips_.find(first);
  if (clip == clips_.end()) return {first};
  std::vector<std::string> names;
  for (const FolderFile* file : clip->second) names.push_back(file->name);
  return names;
}

std::vector<const FolderFile*> GroupedFiles::Companions(const NamePattern& pattern, const NameFields& fields) const {
  std::vector<const FolderFile*> found;
  const NameFields clip = OfClip(fields);
  for (const FolderFile& file : *files_) {
    const std::optional<NameFields> own = pattern.Match(file.name);
    if (!own) continue;
    const bool same = std::all_of(own->begin(), own->end(), [&](const auto& field) {
      const auto wanted = clip.find(field.first);
      return wanted == clip.end() || wanted->second == field.second;
    });
    if (same) found.push_back(&file);
  }
  return found;
}

Status GroupedFiles::AddInputs(const std::string& first, const NameFields& fields, ItemSpec& item) const {
  const auto clip = clips_.find(first);
  if (clip == clips_.end()) return {};
  item.inputs.clear();
  const EvidenceKind gives = DriverOf(source_->format).gives;
  const char* role = gives == EvidenceKind::kDepthViews || gives == EvidenceKind::kPointClouds ? "depth" : "source";
  for (const FolderFile* file : clip->second) {
    if (file->problem.empty()) item.inputs.push_back({role, file->name, file->path, ""});
  }
  if (item.inputs.empty()) {
    const FolderFile& unreadable = *clip->second.front();
    return Fail(
        ErrorCode::kUnreadable,
        Counted(clip->second.size(), "file") + " of the clip, none can be read; the first " + unreadable.problem,
        unreadable.name, "correct or remove them");
  }
  if (const auto depth = depth_.find(Only(depth_fields_, fields)); depth != depth_.end()) {
    for (const FolderFile* file : depth->second) {
      if (file->problem.empty()) item.inputs.push_back({"depth", file->name, file->path, ""});
    }
  }
  for (const NamePattern& pattern : masks_) {
    for (const FolderFile* file : Companions(pattern, fields)) {
      if (file->problem.empty()) item.inputs.push_back({"depth", file->name, file->path, ""});
    }
  }
  for (const NamePattern& pattern : calibrations_) {
    const std::vector<const FolderFile*> found = Companions(pattern, fields);
    if (found.empty()) {
      return Fail(ErrorCode::kNotFound,
                  "its calibration '" + FillFields(pattern.text(), OfClip(fields)) + "' is not in the folder", first,
                  "put it there, or correct ingest.source.calibration");
    }
    for (const FolderFile* file : found) {
      if (!file->problem.empty()) return Fail(ErrorCode::kUnreadable, file->problem, file->name);
      item.inputs.push_back({"calibration", file->name, file->path, ""});
    }
  }
  return {};
}

Status GroupViews(const SourceOptions& source, std::vector<ItemSpec>& items) {
  std::map<std::string, std::map<std::string, ItemSpec>> captures;  // by item, then by view
  std::set<std::string> cameras;
  for (ItemSpec& item : items) {
    const Expected<NamedFile> named = ReadName(source, item.inputs[0].name);
    if (!named) return Forward(named);
    cameras.insert(named->identity.view);
    std::map<std::string, ItemSpec>& views = captures[item.item];
    const auto [at, added] = views.emplace(named->identity.view, item);
    if (added) continue;
    return Fail(ErrorCode::kConfig,
                "'" + at->second.inputs[0].name + "' and '" + item.inputs[0].name + "' are both '" + item.item +
                    "' seen by '" + named->identity.view + "'",
                "ingest.source.recording", "use more fields of the name in `recording` or `view`");
  }
  if (Status known = CheckFirstFrames(source, cameras); !known) return known;
  items.clear();
  for (auto& [name, views] : captures) {
    ItemSpec together = views.begin()->second;
    std::vector<StageInput> depth(together.inputs.begin() + 1, together.inputs.end());
    together.inputs.resize(1);
    for (auto view = std::next(views.begin()); view != views.end(); ++view) {
      const std::vector<StageInput>& inputs = view->second.inputs;
      together.inputs.push_back(inputs.front());
      depth.insert(depth.end(), inputs.begin() + 1, inputs.end());
      ItemFacts facts = FactsOf(together);
      if (facts.known_issue.empty()) facts.known_issue = FactsOf(view->second).known_issue;
      SetFacts(facts, together);
    }
    together.inputs.insert(together.inputs.end(), depth.begin(), depth.end());
    items.push_back(std::move(together));
  }
  return {};
}

DepthFiles::DepthFiles(const std::vector<FolderFile>& files, const NamePattern& pattern, const NamePattern& source) {
  const std::vector<std::string> own = source.FieldNames();
  for (const std::string& field : pattern.FieldNames()) {
    if (std::find(own.begin(), own.end(), field) != own.end()) common_.push_back(field);
  }
  for (const FolderFile& file : files) {
    if (const std::optional<NameFields> fields = pattern.Match(file.name)) of_[Key(*fields)].push_back(&file);
  }
}

void DepthFiles::AddTo(const NameFields& fields, ItemSpec& item) const {
  const auto found = of_.find(Key(fields));
  if (found == of_.end()) return;
  for (const FolderFile* file : found->second) item.inputs.push_back({"depth", file->name, file->path, ""});
}

std::vector<std::string> DepthFiles::Key(const NameFields& fields) const {
  std::vector<std::string> key;
  for (const std::string& field : common_) key.push_back(fields.count(field) > 0 ? fields.at(field) : "");
  return key;
}

Status CheckOwnImages(const SourceOptions& source, const std::vector<ItemSpec>& items) {
  const Expected<NamePattern> pattern = NamePattern::Parse(source.depth_files, "ingest.source.depth_files");
  if (!pattern || source.depth_files.empty()) return {};
  std::map<std::string, const ItemSpec*> taken;
  for (const ItemSpec& item : items) {
    for (const StageInput& input : item.inputs) {
      if (input.role != "depth" || !pattern->Match(input.name)) continue;
      const ItemSpec& first = *taken.emplace(input.name, &item).first->second;
      if (first.inputs[0].name == item.inputs[0].name) continue;
      if (HasDepthBeside(source) && RecordingOf(first) == RecordingOf(item)) continue;
      return Fail(
          ErrorCode::kConfig,
          "the depth image '" + input.name + "' would be one of '" + first.inputs[0].name + "' and of '" +
              item.inputs[0].name + "'",
          "ingest.source.depth_files",
          "images are of the clip whose name has the same fields: write those fields of ingest.source.files ('" +
              source.files + "') that tell clips apart into '" + source.depth_files + "'");
    }
  }
  return {};
}

}  // namespace mocurate
