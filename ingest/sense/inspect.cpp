#include "ingest/sense/inspect.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "core/base/file.h"
#include "ingest/sense/clip_report.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 6;  // folders below the one that is asked for
constexpr std::size_t kHeadBytes = 8192;
constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30;

struct FileToInspect {
  std::string name;
  std::filesystem::path path;
};

Status ListFiles(const std::filesystem::path& path, std::vector<FileToInspect>& files) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    files.push_back({DisplayPath(path.filename()), path});
    return {};
  }
  fs::recursive_directory_iterator at(path, fs::directory_options::skip_permission_denied, error);
  if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(path), "check its permissions");
  for (const fs::recursive_directory_iterator end; at != end;) {
    std::error_code unknown;
    if (at->is_directory(unknown) && at.depth() >= kDeepest) at.disable_recursion_pending();
    if (at->is_regular_file(unknown)) files.push_back({DisplayPath(at->path().lexically_relative(path)), at->path()});
    at.increment(error);
    if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(path), "check its permissions");
  }
  std::sort(files.begin(), files.end(), [](const FileToInspect& a, const FileToInspect& b) { return a.name < b.name; });
  return {};
}

void AddError(const Error& error, const std::string& file, const char* code, Json& findings) {
  findings.push_back(InspectionFinding(code, Severity::kError, error.where.empty() ? file : error.where, 0.0,
                                       error.what + (error.hint.empty() ? "" : " (" + error.hint + ")")));
}

/// The first bytes, enough to tell the format.
Expected<std::string> ReadHead(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return Fail(ErrorCode::kUnreadable, "the file cannot be opened", DisplayPath(path), "check its permissions");
  std::string head(kHeadBytes, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

const char* CodeOf(ErrorCode error, FileKind kind, bool declared) {
  if (kind == FileKind::kEmpty) return "empty_file";
  if (kind == FileKind::kUnknown) return "unknown_format";
  if (error == ErrorCode::kUnsupported) return "no_motion";
  if (error == ErrorCode::kInconsistent) return declared ? "layout_contradiction" : "no_joint_seen";
  return "malformed";
}

/// One file. `in_folder`: files of unknown content are counted instead of being errors.
void InspectFile(const FileToInspect& file, const std::optional<SourceOptions>& source, bool in_folder,
                 Json& inspection, std::vector<std::string>& others) {
  Json& findings = inspection["findings"];
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(file.path, unknown);
  const Expected<std::string> head = ReadHead(file.path);
  if (!head) return AddError(head.error(), file.name, "unreadable", findings);
  const FileKind kind = KindOf(*head);
  if (in_folder && kind == FileKind::kUnknown) {
    others.push_back(file.name);
    return;
  }
  if (size > kLargestFile) {
    return AddError({ErrorCode::kUnsupported, "the file is larger than 1 GiB", file.name, ""}, file.name, "too_large",
                    findings);
  }
  const Expected<std::string> bytes = ReadFile(file.path);
  if (!bytes) return AddError(bytes.error(), file.name, "unreadable", findings);
  const auto clips = ObserveFile(*bytes, file.name, source);
  if (!clips) {
    const bool no_motion = clips.error().code == ErrorCode::kUnsupported;
    if (in_folder && (no_motion || kind == FileKind::kJson)) {
      others.push_back(file.name);
      return;
    }
    const char* code = CodeOf(clips.error().code, kind, source.has_value());
    return AddError(clips.error(), file.name, code, findings);
  }
  for (const ObservedClip& clip : *clips) inspection["clips"].push_back(ClipReport(clip, file.name, source, findings));
}

std::string FormatOf(const Json& clips) {
  std::set<std::string> formats;
  for (const Json& clip : clips) formats.insert(clip.at("format").get<std::string>());
  if (formats.empty()) return "unknown";
  return formats.size() == 1 ? *formats.begin() : "mixed";
}

/// What most clips of a group say, weighted by confidence.
Json Pooled(const std::vector<const Json*>& clips, const char* key) {
  std::map<std::string, std::pair<double, Json>> votes;
  double all = 0.0;
  for (const Json* clip : clips) {
    const Json& field = clip->at(key);
    if (field.at("value").is_null()) continue;
    const double weight = std::max(1e-6, field.at("confidence").get<double>());
    auto& vote = votes[field.at("value").dump()];
    vote.first += weight;
    vote.second = field;
    all += weight;
  }
  Json best = {{"value", nullptr}, {"from", "unknown"}, {"share", 0.0}};
  double most = 0.0;
  for (const auto& [text, vote] : votes) {
    if (vote.first <= most) continue;
    most = vote.first;
    best = {{"value", vote.second.at("value")},
            {"from", vote.second.at("from")},
            {"share", std::round(1e4 * most / all) / 1e4}};
  }
  return best;
}

/// Clips of one format and skeleton together: what one clip cannot tell, the others may.
Json GroupsOf(const Json& clips) {
  std::map<std::string, std::vector<const Json*>> members;
  for (const Json& clip : clips) {
    const std::string folder = clip.at("file").get<std::string>();
    const std::size_t slash = folder.rfind('/');
    members[(slash == std::string::npos ? "" : folder.substr(0, slash)) + "\n" + clip.at("format").get<std::string>() +
            "\n" + clip.at("joints").at("value").dump()]
        .push_back(&clip);
  }
  Json groups = Json::array();
  for (const auto& [key, group] : members) {
    Json json = {{"folder", key.substr(0, key.find('\n'))},
                 {"format", group[0]->at("format")},
                 {"joints", group[0]->at("joints").at("value")},
                 {"clips", group.size()}};
    std::int64_t frames = 0, fewest = group[0]->at("frames").at("value"), most = fewest;
    for (const Json* clip : group) {
      const std::int64_t count = clip->at("frames").at("value");
      frames += count;
      fewest = std::min(fewest, count);
      most = std::max(most, count);
    }
    json["frames"] = {{"sum", frames}, {"min", fewest}, {"max", most}};
    for (const char* field : {"skeleton", "units", "up", "handedness", "facing", "axes", "rate_hz"}) {
      json[field] = Pooled(group, field);
    }
    groups.push_back(std::move(json));
  }
  return groups;
}

}  // namespace

Json InspectPath(const std::filesystem::path& path, const std::optional<SourceOptions>& source) {
  Json inspection = {{"path", DisplayPath(path)},
                     {"format", "unknown"},
                     {"clips", Json::array()},
                     {"groups", Json::array()},
                     {"findings", Json::array()}};
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) {
    AddError({ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(path), ""}, "", "not_found",
             inspection["findings"]);
    return inspection;
  }
  const bool folder = std::filesystem::is_directory(path, unknown);
  std::vector<FileToInspect> files;
  if (Status listed = ListFiles(path, files); !listed) {
    AddError(listed.error(), "", "unreadable", inspection["findings"]);
    return inspection;
  }
  std::vector<std::string> others;
  for (const FileToInspect& file : files) InspectFile(file, source, folder, inspection, others);
  if (!others.empty()) {
    inspection["findings"].push_back(
        InspectionFinding("other_files", Severity::kInfo, others.front(), static_cast<double>(others.size()),
                          std::to_string(others.size()) + (others.size() == 1 ? " file is" : " files are") +
                              " of no known motion format"));
  }
  if (folder && inspection["clips"].empty()) {
    inspection["findings"].push_back(InspectionFinding("no_clips", Severity::kError, DisplayPath(path), 0.0,
                                                       "no file of the folder holds motion in a known format"));
  }
  inspection["format"] = FormatOf(inspection["clips"]);
  inspection["groups"] = GroupsOf(inspection["clips"]);
  return inspection;
}

}  // namespace mocurate
