#include "ingest/sense/inspect.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "core/base/file.h"
#include "core/formats/camera_files.h"
#include "core/formats/png.h"
#include "ingest/format_facts.h"
#include "ingest/sense/check_report.h"
#include "ingest/sense/clip_report.h"
#include "ingest/sense/comparison.h"
#include "ingest/sense/fault_codes.h"
#include "ingest/sense/file_kind.h"
#include "ingest/sense/inspect_annotations.h"
#include "ingest/sense/inspect_duplicates.h"
#include "ingest/sense/inspect_files.h"
#include "ingest/sense/inspect_groups.h"
#include "ingest/sense/reader_check.h"
#include "ingest/sense/scene_report.h"
#include "ingest/sources/pattern.h"
#include "ingest/sources/source_file.h"
#include "ingest/sources/table_rows.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30;

/// A fault that several files meet, as motions do their skeleton's, is told once.
void AddError(const Error& error, const std::string& file, const std::string& code, Json& findings) {
  Json finding = InspectionFinding(code, Severity::kError, error.where.empty() ? file : error.where, 0.0,
                                   error.what + (error.hint.empty() ? "" : " (" + error.hint + ")"));
  if (std::find(findings.begin(), findings.end(), finding) == findings.end()) findings.push_back(std::move(finding));
}

std::string CodeOf(const Error& error, FileKind kind) {
  if (kind == FileKind::kEmpty) return "empty_file";
  if (kind == FileKind::kUnknown) return "unknown_format";
  const char* format = kind == FileKind::kNumbers       ? "joint_table"
                       : kind == FileKind::kNtuSkeleton ? "ntu_skeleton"
                       : kind == FileKind::kNpy         ? "npy"
                                                        : "";
  return FaultCode(error, format);
}

/// What is being looked at, and what was found so far.
class Inspector {
 public:
  Inspector(const std::optional<SourceOptions>& source, bool folder, const VideoProbe& probe)
      : source_(source), folder_(folder), probe_(probe) {}

  void Look(const FileToInspect& file);
  /// Clips of several files, and what belongs to the whole.
  void Finish(const std::string& path);
  Json inspection = {{"path", ""},
                     {"format", "unknown"},
                     {"clips", Json::array()},
                     {"groups", Json::array()},
                     {"cameras", Json::array()},
                     {"clouds", Json::array()},
                     {"companions", Json::array()},
                     {"findings", Json::array()}};

 private:
  Status Read(const FileToInspect& file, FileKind kind);
  void Refuse(const FileToInspect& file, FileKind kind, const Error& error);
  Status AddStoragesBeside(const FileToInspect& file);
  bool IsDeclared(const FileToInspect& file) const;
  std::string DeclaredName(const FileToInspect& file) const;
  void AddSaidByRun(const FileBytes& file, FileKind kind, std::size_t before);
  void AddClips(const FileToInspect& file, bool declared, const std::vector<ObservedClip>& clips);
  void AddRest(const ObservedFile& file, const std::string& name);
  void AddSequence(const ObservedFile& file, const std::string& name);
  void AddVideos();
  Json& findings() { return inspection["findings"]; }

  const std::optional<SourceOptions>& source_;
  const std::optional<SourceOptions> none_;
  bool any_declared_ = false;
  bool folder_;
  const VideoProbe& probe_;
  std::vector<FileToInspect> videos_;
  ObservedSequences sequences_;
  SeenMotions motions_;
  std::vector<AnnotatedMotion> annotated_;
  /// Files that could not be read, which may be frames of a sequence.
  struct Refused {
    FileToInspect file;
    FileKind kind;
    Error error;
  };
  std::vector<Refused> refused_;
  std::vector<std::string> others_;
  std::map<std::string, std::vector<std::string>> reasons_;  ///< why others could not be read -> which
};

/// Into the sequences, or at once.
Status Inspector::Read(const FileToInspect& file, FileKind kind) {
  const Expected<std::string> bytes = ReadFile(file.path);
  if (!bytes) return Forward(bytes);
  const FileBytes content{*bytes, file.name, file.path};
  if (kind == FileKind::kPng) {
    if (Status whole = CheckPng(*bytes, file.name); !whole) return whole;
    sequences_.AddImage(content, true);
    return {};
  }
  const JsonKind json = kind == FileKind::kJson ? JsonKindOf(*bytes) : JsonKind::kOther;
  if (json == JsonKind::kOpenPose) return sequences_.AddOpenPose(content);
  if (json == JsonKind::kPanopticBodies) return sequences_.AddPanoptic(content);
  const bool storage = kind == FileKind::kXml && bytes->find("<opencv_storage") != std::string::npos;
  if (storage || kind == FileKind::kOpenCvYaml) {
    if (Status added = sequences_.AddOpenCv(content); !added) return added;
    return folder_ ? Status() : AddStoragesBeside(file);
  }
  const bool declared = IsDeclared(file);
  const Expected<ObservedFile> observed = ObserveFile(content, declared ? source_ : none_);
  if (!observed) return Forward(observed);
  const std::size_t before = findings().size();
  AddClips(file, declared, observed->clips);
  AddRest(*observed, file.name);
  if (declared) AddSaidByRun(content, kind, before);
  return {};
}

/// What a run says of the file, as far as no finding from `before` on says it.
void Inspector::AddSaidByRun(const FileBytes& file, FileKind kind, std::size_t before) {
  std::set<std::string> codes, severities;
  for (std::size_t i = before; i < findings().size(); ++i) {
    codes.insert(findings()[i].at("code").get<std::string>());
    severities.insert(findings()[i].at("severity").get<std::string>());
  }
  const auto said = SaidByRun(source_, DeclaredName({file.name, file.path, true}), file);
  if (!said) {
    if (severities.count("error") == 0) AddError(said.error(), file.name, CodeOf(said.error(), kind), findings());
    return;
  }
  for (const Finding& finding : *said) {
    if (finding.severity == Severity::kInfo || codes.count(finding.code) != 0) continue;
    findings().push_back(InspectionFinding(finding.code, finding.severity, PlaceOf(finding, file.name),
                                           FourDecimals(finding.value), finding.message));
  }
}

/// A rig is two storages, intri and extri: asked for one of them, the other is looked for where it lies.
Status Inspector::AddStoragesBeside(const FileToInspect& file) {
  std::vector<std::filesystem::path> beside;
  std::error_code error;
  const std::filesystem::path folder = file.path.has_parent_path() ? file.path.parent_path() : ".";
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->path().extension() == file.path.extension() && at->path().filename() != file.path.filename())
      beside.push_back(at->path());
  }
  std::sort(beside.begin(), beside.end());
  for (const std::filesystem::path& path : beside) {
    const Expected<std::string> head = ReadHead(path);
    if (!head || (KindOf(*head) != FileKind::kOpenCvYaml && head->find("<opencv_storage") == std::string::npos))
      continue;
    const Expected<std::string> bytes = ReadFile(path);
    if (!bytes) return Forward(bytes);
    sequences_.AddBeside({*bytes, DisplayPath(path.filename()), path});
  }
  return {};
}

/// The name below the source's folder. Of a file in a folder of the pattern, that folder may be the one asked for: then
/// its path says the rest.
std::string Inspector::DeclaredName(const FileToInspect& file) const {
  const auto pattern = NamePattern::Parse(source_->files, "ingest.source.files");
  if (!pattern || pattern->Match(file.name)) return file.name;
  std::error_code unknown;
  const std::filesystem::path whole = std::filesystem::absolute(file.path, unknown).lexically_normal();
  const std::vector<std::filesystem::path> parts(whole.begin(), whole.end());
  const auto own = static_cast<std::size_t>(std::count(file.name.begin(), file.name.end(), '/')) + 1;
  const auto most = static_cast<std::size_t>(pattern->depth()) + 1;
  for (std::size_t count = own + 1; count <= most && count < parts.size(); ++count) {
    std::filesystem::path tail;
    for (std::size_t i = parts.size() - count; i < parts.size(); ++i) tail /= parts[i];
    if (pattern->Match(DisplayPath(tail))) return DisplayPath(tail);
  }
  return file.name;
}

/// Whether the declaration speaks of the file. What is asked for by itself is compared whatever it is called.
bool Inspector::IsDeclared(const FileToInspect& file) const {
  if (!source_) return false;
  if (!folder_ || source_->files.empty()) return true;
  if (!source_->container.empty()) {
    const std::filesystem::path container(source_->container);
    return file.name == source_->container || file.name == DisplayPath(container.filename());
  }
  const auto pattern = NamePattern::Parse(source_->files, "ingest.source.files");
  return !pattern || pattern->Match(DeclaredName(file)).has_value();
}

void Inspector::AddClips(const FileToInspect& file, bool declared, const std::vector<ObservedClip>& clips) {
  const bool named = declared && source_->container.empty() && !source_->files.empty();
  const std::string name = named ? DeclaredName(file) : "";
  any_declared_ = any_declared_ || declared;
  for (const ObservedClip& clip : clips) {
    inspection["clips"].push_back(ClipReport(clip, file.name, declared ? source_ : none_, name, findings()));
    if (!source_ || declared) motions_.Add(clip, inspection["clips"].back());
  }
  if (!source_ || declared || clips.empty() || !source_->container.empty() || IsGathered(source_->format)) return;
  const auto pattern = NamePattern::Parse(source_->files, "ingest.source.files");
  // Of what lies deeper a run says nothing file by file.
  if (!pattern || std::count(file.name.begin(), file.name.end(), '/') > pattern->depth()) return;
  const auto read = ReadName(*source_, file.name);
  if (!read) TellUnread(*source_, file.name, read.error(), findings());
}

/// Clips of many files: the names of those are no names of clips.
void Inspector::AddSequence(const ObservedFile& file, const std::string& name) {
  for (const ObservedClip& clip : file.clips) {
    const bool declared = source_ && (!folder_ || source_->files.empty() || Reads(source_->format, clip.format));
    any_declared_ = any_declared_ || declared;
    inspection["clips"].push_back(ClipReport(clip, name, declared ? source_ : none_, "", findings()));
  }
  AddRest(file, name);
}

void Inspector::AddRest(const ObservedFile& file, const std::string& name) {
  for (const Calibration& calibration : file.calibrations) {
    ReportCameras(calibration, name, inspection["cameras"], findings());
  }
  for (const ObservedCloud& cloud : file.clouds) inspection["clouds"].push_back(CloudReport(cloud, name, findings()));
  for (const ObservedCompanion& companion : file.companions) {
    inspection["companions"].push_back(CompanionReport(companion));
  }
  annotated_.insert(annotated_.end(), file.annotated.begin(), file.annotated.end());
  for (const Remark& remark : file.remarks) {
    findings().push_back(InspectionFinding(remark.code, remark.severity, name, remark.value, remark.message));
  }
}

void Inspector::AddVideos() {
  std::vector<std::filesystem::path> paths;
  for (const FileToInspect& video : videos_) paths.push_back(video.path);
  const std::vector<Expected<VideoFacts>> answers = probe_ ? probe_(paths) : std::vector<Expected<VideoFacts>>();
  for (std::size_t i = 0; i < videos_.size(); ++i) {
    ObservedCompanion companion{videos_[i].name, "video", {}, {}};
    if (i < answers.size() && !answers[i]) {
      AddError(answers[i].error(), videos_[i].name,
               answers[i].error().code == ErrorCode::kMissingOnHost ? "unreadable" : "malformed", findings());
      continue;
    }
    if (i < answers.size()) {
      const VideoFacts& facts = *answers[i];
      if (!facts.codec.empty()) companion.texts.emplace_back("codec", facts.codec);
      companion.numbers = {{"frames", facts.frames},
                           {"rate_hz", facts.rate_hz},
                           {"width", facts.width},
                           {"height", facts.height},
                           {"duration_s", facts.frames / facts.rate_hz}};
    }
    inspection["companions"].push_back(CompanionReport(companion));
  }
}

/// Files of unknown content are errors where they are asked for, and counted in a folder.
void Inspector::Look(const FileToInspect& file) {
  if (!file.regular) {
    findings().push_back(InspectionFinding("no_regular_file", folder_ ? Severity::kWarning : Severity::kError,
                                           file.name, 0.0, "is no regular file: not read"));
    return;
  }
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(file.path, unknown);
  const Expected<std::string> head = ReadHead(file.path);
  if (!head) return AddError(head.error(), file.name, "unreadable", findings());
  FileKind kind = IsUestcInfo(file.path) ? FileKind::kUestcInfo : KindOf(*head);
  const bool of_no_format = kind == FileKind::kUnknown || kind == FileKind::kNumbers;
  if (of_no_format && file.path.extension() == ".skeleton") kind = FileKind::kNtuSkeleton;
  const bool table = source_ && source_->format == SourceFormat::kJointTable && IsDeclared(file);
  if (folder_ && kind == FileKind::kUnknown && !table) {
    refused_.push_back({file, kind, {ErrorCode::kUnsupported, "is of no known format", file.name, "copy it again"}});
    return;
  }
  if (kind == FileKind::kVideo) return videos_.push_back(file);
  if (kind == FileKind::kJpeg) {
    if (!EndsAsJpeg(file.path)) {
      AddError({ErrorCode::kMalformed, "the image is cut off: its end marker is missing", file.name, "copy it again"},
               file.name, "malformed", findings());
    }
    return sequences_.AddImage({*head, file.name, file.path}, false);
  }
  if (size > kLargestFile) {
    return AddError({ErrorCode::kUnsupported, "the file is larger than 1 GiB", file.name, ""}, file.name, "too_large",
                    findings());
  }
  const Status read = Read(file, kind);
  if (read) return;
  if (folder_ && file.path.extension() == ".json")
    refused_.push_back({file, kind, read.error()});
  else
    Refuse(file, kind, read.error());
}

void Inspector::Refuse(const FileToInspect& file, FileKind kind, const Error& error) {
  const bool table = source_ && source_->format == SourceFormat::kJointTable && IsDeclared(file);
  if (kind == FileKind::kUnknown && table) {  // by its name it is one: what a run says of it
    const Expected<std::string> bytes = ReadFile(file.path);
    const Expected<JointRows> rows = bytes ? ReadTableRows(*source_, *bytes, file.name) : Forward(bytes);
    const Error& told = rows ? error : rows.error();
    return AddError(told, file.name, FaultCode(told, "joint_table"), findings());
  }
  if (folder_ && kind == FileKind::kUnknown) {
    others_.push_back(file.name);
    return;
  }
  const ErrorCode code = error.code;
  if (code == ErrorCode::kUnreadable || code == ErrorCode::kNotFound)
    return AddError(error, file.name, "unreadable", findings());
  // Text in brackets and XML may be anything, but not where it speaks of cameras or is BABEL's.
  bool common = kind == FileKind::kJson || kind == FileKind::kXml || kind == FileKind::kToml;
  if (common) {
    const Expected<std::string> bytes = ReadFile(file.path);
    const bool babel = bytes && kind == FileKind::kJson && JsonKindOf(*bytes) == JsonKind::kBabel;
    common = !bytes || (!babel && !SpeaksOfCameras(*bytes));
  }
  if (folder_ && (code == ErrorCode::kUnsupported || common) && error.reason != Reason::kUnsafePickle) {
    others_.push_back(file.name);
    if (code != ErrorCode::kUnsupported) reasons_[error.what].push_back(file.name);
    return;
  }
  const std::size_t before = findings().size();
  AddError(error, file.name, CodeOf(error, kind), findings());
  if (error.reason == Reason::kCount && findings().size() > before) findings().back()["value"] = error.number;
}

std::string FormatTold(const Json& inspection) {
  std::set<std::string> formats;
  for (const char* list : {"clips", "cameras", "clouds", "companions"}) {
    if (!formats.empty()) break;  // what stands beside clips does not make them mixed
    for (const Json& entry : inspection.at(list)) formats.insert(entry.at("format").get<std::string>());
  }
  if (formats.empty()) return "unknown";
  return formats.size() == 1 ? *formats.begin() : "mixed";
}

/// What most files that could not be read have in common, and the first of these; nothing where there is no reason.
std::string CommonReason(const std::map<std::string, std::vector<std::string>>& reasons) {
  const auto most = std::max_element(reasons.begin(), reasons.end(),
                                     [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  if (most == reasons.end()) return "";
  return "; of " + std::to_string(most->second.size()) + " the reason is: " + most->first + " (first " +
         most->second.front() + ")";
}

void Inspector::Finish(const std::string& path) {
  for (const Refused& refused : refused_) {
    if (!sequences_.Claim(refused.file.name, refused.error)) Refuse(refused.file, refused.kind, refused.error);
  }
  for (const auto& [folder, file] : sequences_.Finish(folder_)) AddSequence(file, folder.empty() ? path : folder);
  AddVideos();
  if (!others_.empty()) {
    findings().push_back(
        InspectionFinding("other_files", Severity::kInfo, others_.front(), static_cast<double>(others_.size()),
                          std::to_string(others_.size()) + (others_.size() == 1 ? " file is" : " files are") +
                              " of no known format" + CommonReason(reasons_)));
  }
  if (source_ && folder_ && !any_declared_ && !inspection["clips"].empty()) {
    const std::string wanted =
        source_->container.empty() ? "the pattern '" + source_->files + "'" : "'" + source_->container + "'";
    findings().push_back(InspectionFinding("name_mismatch", Severity::kWarning, path, 0.0,
                                           "no file with motion is what the source declares, " + wanted +
                                               ": mend ingest.source.files, or inspect the source's own folder"));
  }
  TellByGroup(inspection["clips"], findings());
  TellCutMeshes(inspection["clouds"], findings());
  TellAnnotations(annotated_, inspection["clips"], findings());
  motions_.Tell(source_ ? source_->checks : CheckOptions(), findings());
  const bool nothing = inspection["clips"].empty() && inspection["cameras"].empty() && inspection["clouds"].empty() &&
                       inspection["companions"].empty();
  if (folder_ && nothing) {
    findings().push_back(InspectionFinding("no_clips", Severity::kError, path, 0.0,
                                           "no file of the folder holds motion in a known format"));
  }
  inspection["format"] = FormatTold(inspection);
  inspection["groups"] = GroupsOf(inspection["clips"]);
}

}  // namespace

Json InspectPath(const std::filesystem::path& path, const std::optional<SourceOptions>& source,
                 const VideoProbe& videos, const InspectProgress& progress) {
  std::error_code unknown;
  Inspector inspector(source, std::filesystem::is_directory(path, unknown), videos);
  inspector.inspection["path"] = DisplayPath(path);
  if (!std::filesystem::exists(path, unknown)) {
    AddError({ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(path), ""}, "", "not_found",
             inspector.inspection["findings"]);
    return inspector.inspection;
  }
  std::vector<FileToInspect> files;
  if (Status listed = ListFiles(path, files); !listed) {
    AddError(listed.error(), "", "unreadable", inspector.inspection["findings"]);
    return inspector.inspection;
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    inspector.Look(files[i]);
    if (progress) progress(i + 1, files.size());
  }
  inspector.Finish(DisplayPath(path.filename().empty() ? path.parent_path().filename() : path.filename()));
  return inspector.inspection;
}

}  // namespace mocurate
