#include "ingest/inspect/inspect.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "core/base/file.h"
#include "core/formats/camera_files.h"
#include "core/formats/png.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/chosen_clips.h"
#include "ingest/discover.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/clip_report.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/inspect/scene_report.h"
#include "ingest/item_facts.h"
#include "ingest/read_motions.h"
#include "ingest/relaxed_pattern.h"
#include "ingest/sources/pattern.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30;

/// A fault that several files meet, as motions do their skeleton's, is reported once.
void AddError(const Error& error, const std::string& file, const std::string& code, std::vector<Finding>& findings) {
  Finding finding = FindingAt(error.where.empty() ? file : error.where, code, Severity::kError, error.number,
                              error.what + (error.hint.empty() ? "" : " (" + error.hint + ")"));
  if (std::find(findings.begin(), findings.end(), finding) == findings.end()) findings.push_back(std::move(finding));
}

/// What is being looked at, and what was found so far.
class Inspector {
 public:
  Inspector(const std::optional<SourceOptions>& source, bool folder, const VideoProbe& probe)
      : source_(source), folder_(folder), probe_(probe) {}

  /// What a run of the source makes of the path. Files that it reads are not looked at again.
  void ReadDeclared(const std::filesystem::path& path);
  void Look(const FolderFile& file);
  /// Clips of several files, and what belongs to the whole.
  void Finish(const std::string& path);
  Inspection inspection;

 private:
  /// What a file is: its kind, and its format where a driver reads it.
  struct Content {
    FileKind kind = FileKind::kUnknown;
    const FormatDriver* format = nullptr;
    bool unknown() const { return kind == FileKind::kUnknown && format == nullptr; }
  };
  Status Read(const FolderFile& file, Content& content);
  void Refuse(const FolderFile& file, const Content& content, const Error& error);
  Status AddStoragesBeside(const FolderFile& file);
  std::string Below(const std::string& name) const;
  std::string PlaceOfClip(const ItemSpec& item) const;
  void AddItem(const ItemSpec& item);
  void AddExcluded(const std::filesystem::path& folder, const ItemResult& file);
  void Add(const RawFile& file, const std::string& name);
  void AddVideos();
  std::vector<Finding>& findings() { return inspection.findings; }

  const std::optional<SourceOptions>& source_;
  std::set<std::filesystem::path> read_, refused_by_run_;
  std::map<std::string, std::set<std::string>> recordings_;  ///< of clips of many files, by folder
  std::string below_;  ///< where a file is asked for: its folder, from that of the source on
  bool folder_;
  const VideoProbe& probe_;
  std::vector<FolderFile> videos_;
  RawSequences sequences_;
  InspectedMotions motions_;
  std::vector<AnnotatedMotion> annotated_;
  /// Files that could not be read, which may be frames of a sequence.
  struct Refused {
    FolderFile file;
    Content content;
    Error error;
  };
  std::vector<Refused> refused_;
  std::vector<std::string> others_;
  std::map<std::string, std::vector<std::string>> reasons_;  ///< why others could not be read -> which
};

std::filesystem::path WholePath(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::absolute(path, unknown).lexically_normal();
}

/// Into the sequences, or at once.
Status Inspector::Read(const FolderFile& file, Content& content) {
  const Expected<std::string> read = ReadFile(file.path);
  if (!read) return Forward(read);
  const FileBytes bytes{*read, file.name, file.path};
  content.kind = KindOf(*read);
  content.format = RecogniseFormat(bytes, content.kind);
  switch (content.kind) {
    case FileKind::kPng:
      if (Status whole = CheckPng(*read, file.name); !whole) return whole;
      sequences_.AddImage(bytes, true);
      return {};
    case FileKind::kOpenPose:
      return sequences_.AddOpenPose(bytes);
    case FileKind::kPanopticBodies:
      return sequences_.AddPanoptic(bytes);
    case FileKind::kOpenCvStorage:
      if (Status added = sequences_.AddOpenCv(bytes); !added) return added;
      return folder_ ? Status() : AddStoragesBeside(file);
    default:
      break;
  }
  const Expected<RawFile> observed = ReadRawFile(bytes, content.kind, content.format);
  if (!observed) return Forward(observed);
  Add(*observed, file.name);
  return {};
}

/// A rig is two storages, intri and extri: asked for one of them, the other is looked for where it lies.
Status Inspector::AddStoragesBeside(const FolderFile& file) {
  for (const std::filesystem::path& path : EntriesOf(file.path.has_parent_path() ? file.path.parent_path() : ".")) {
    if (path.extension() != file.path.extension() || path.filename() == file.path.filename()) continue;
    const Expected<std::string> head = ReadHead(path);
    if (!head || KindOf(*head) != FileKind::kOpenCvStorage) continue;
    const Expected<std::string> bytes = ReadFile(path);
    if (!bytes) return Forward(bytes);
    sequences_.AddBeside({*bytes, DisplayPath(path.filename()), path});
  }
  return {};
}

/// The place of a clip: its file, and where it stands in a file of several. Of a clip of many files their folder; its
/// recording too where that is the folder asked for or holds other recordings.
std::string Inspector::PlaceOfClip(const ItemSpec& item) const {
  std::string name = item.inputs.front().name;
  if (DriverOf(source_->format).gathered()) {
    name = FolderOf(name);
    const auto others = recordings_.find(name);
    const bool shared = others != recordings_.end() && others->second.size() > 1;
    if (name.empty() || shared) name += (name.empty() ? "" : "/") + RecordingOf(item);
  }
  return name + FactsOf(item).Place();
}

/// The name of a file in the folder asked for, of one below the source's.
std::string Inspector::Below(const std::string& name) const {
  return name.rfind(below_, 0) == 0 ? name.substr(below_.size()) : name;
}

void Inspector::AddItem(const ItemSpec& item) {
  StageRequest request;
  request.stage = "ingest";
  request.item = item.item;
  request.options = item.options.Whole();
  request.inputs = item.inputs;
  for (StageInput& input : request.inputs) {
    if (input.role == "depth") input.sha256 = "not read";  // an inspection reports nothing about images
  }
  const std::string where = Below(PlaceOfClip(item));
  const Expected<ReadItem> read = ReadSourceItem(request);
  const bool kept = read && (read->clip.motion || !read->clip.evidence.empty());
  const bool read_clouds = EvidenceKindOf(*source_) == EvidenceKind::kPointClouds;
  for (const StageInput& input : request.inputs) {
    if (input.role == "source" || read_clouds) (kept ? read_ : refused_by_run_).insert(WholePath(input.path));
  }
  const auto refuse = [&](Error error) {
    error.where = Below(error.where);
    AddError(error, where, FaultCode(error, source_->format), findings());
  };
  if (!read) return refuse(read.error());
  for (const Finding& finding : read->outcome.findings) {
    findings().push_back(FindingAt(PlaceOf(finding, where), Rounded(finding)));
  }
  if (read->outcome.kind == OutcomeKind::kRefused && read->outcome.findings.empty()) refuse(read->outcome.error);
  if (!kept) return;
  RawClip clip = ReadRawClip(*source_, read->clip);
  clip.format = DriverOf(source_->format).clip_format();
  const std::string file = Below(item.inputs.front().name);
  clip.id = where.size() > file.size() ? where.substr(file.size()) : "";
  InspectedClip report =
      DeclaredReport(clip, DriverOf(source_->format).gathered() ? where : file, *source_, findings());
  report.item = item.item;
  report.person = AsDeclared(read->clip.identity.person, "the source");
  report.label = AsDeclared(read->clip.label, "the source");
  motions_.Add(clip, report);
  inspection.clips.push_back(std::move(report));
}

/// What a rule leaves out is not looked at.
void Inspector::AddExcluded(const std::filesystem::path& folder, const ItemResult& file) {
  const std::string code = file.outcome.findings.empty() ? std::string() : file.outcome.findings.front().code;
  if (code == "excluded" || code == "known_issue") read_.insert(WholePath(folder / file.outcome.error.where));
  for (const Finding& finding : file.outcome.findings) findings().push_back(FindingAt(Below(file.item), finding));
}

/// Whether a file that is asked for by itself is one of the source: by its name, or, of sources whose clips are single
/// files, whatever it is called.
bool IsOfSource(const std::filesystem::path& path, IngestOptions& options, std::vector<Finding>& findings) {
  if (!options.source.container.empty()) {
    return path.filename() == std::filesystem::path(options.source.container).filename();
  }
  if (const auto relaxed = RelaxFilePattern(options))
    findings.push_back(FindingAt(DisplayPath(path.filename()), "name_mismatch", Severity::kInfo, 0.0, *relaxed));
  const auto pattern = NamePattern::Parse(options.source.files, "ingest.source.files");
  return !pattern || pattern->Match(NameInSource(path, *pattern));  // the declaration's error is reported
}

void Inspector::ReadDeclared(const std::filesystem::path& path) {
  IngestOptions options;
  options.path = path;
  options.source = *source_;
  const std::string name = DisplayPath(path.filename());
  if (!folder_ && !IsOfSource(path, options, findings())) {
    findings().push_back(FindingAt(name, "name_mismatch", Severity::kWarning, 0.0,
                                   "the file is not what the source declares, '" +
                                       (source_->container.empty() ? source_->files : source_->container) +
                                       "': looked at without the source"));
    return;
  }
  const Expected<Discovery> found = Discover(options);
  if (!found) {
    const Error& error = found.error();
    const auto about = [&](const char* option) { return error.where == std::string("ingest.source.") + option; };
    const char* code = about("format")     ? "format_contradiction"
                       : about("units")    ? "units_unknown"
                       : about("skeleton") ? "unknown_skeleton"
                                           : nullptr;
    if (code == nullptr && error.code == ErrorCode::kNotFound) {
      findings().push_back(FindingAt(name, "name_mismatch", Severity::kWarning, 0.0, error.Message()));
    } else {
      AddError(error, name, code != nullptr ? code : std::string(Name(error.code)), findings());
    }
    return;
  }
  for (const Finding& finding : found->findings) findings().push_back(FindingAt(name, finding));
  if (!folder_ && source_->container.empty() && !found->items.empty())
    below_ = FolderOf(found->items[0].inputs[0].name);
  if (!folder_ && !below_.empty()) below_ += "/";
  for (const ItemResult& file : found->excluded) AddExcluded(options.path, file);
  for (const ItemSpec& item : found->items) recordings_[FolderOf(item.inputs.front().name)].insert(RecordingOf(item));
  for (const ItemSpec& item : found->items) AddItem(item);
}

void Inspector::Add(const RawFile& file, const std::string& name) {
  for (const RawClip& clip : file.clips) {
    inspection.clips.push_back(ClipReport(clip, name, findings()));
    if (!source_) motions_.Add(clip, inspection.clips.back());
  }
  for (const Calibration& calibration : file.calibrations) ReportCameras(calibration, name, inspection);
  for (const RawCloud& cloud : file.clouds) ReportCloud(cloud, name, inspection);
  inspection.companions.insert(inspection.companions.end(), file.companions.begin(), file.companions.end());
  annotated_.insert(annotated_.end(), file.annotated.begin(), file.annotated.end());
  for (const Finding& remark : file.remarks) findings().push_back(FindingAt(name, remark));
}

void Inspector::AddVideos() {
  std::vector<std::filesystem::path> paths;
  for (const FolderFile& video : videos_) paths.push_back(video.path);
  const std::vector<Expected<VideoFacts>> answers = probe_ ? probe_(paths) : std::vector<Expected<VideoFacts>>();
  for (std::size_t i = 0; i < videos_.size(); ++i) {
    RawCompanion companion{videos_[i].name, "video", {}, {}};
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
    inspection.companions.push_back(std::move(companion));
  }
}

/// Files of unknown content are errors where they are asked for, and counted in a folder.
void Inspector::Look(const FolderFile& file) {
  if (read_.count(WholePath(file.path)) != 0) return;
  if (!file.problem.empty()) {
    findings().push_back(FindingAt(file.name, "no_regular_file", folder_ ? Severity::kWarning : Severity::kError, 0.0,
                                   "is no regular file: not read"));
    return;
  }
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(file.path, unknown);
  const Expected<std::string> head = ReadHead(file.path);
  if (!head) return AddError(head.error(), file.name, "unreadable", findings());
  Content content{KindOf(*head), nullptr};
  content.format = RecogniseFormat({*head, file.name, file.path}, content.kind);
  if (folder_ && content.unknown()) {
    refused_.push_back({file, content, {ErrorCode::kUnsupported, "is of no known format", file.name, "copy it again"}});
    return;
  }
  if (content.kind == FileKind::kVideo) return videos_.push_back(file);
  if (content.kind == FileKind::kJpeg) {
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
  const Status read = Read(file, content);
  if (read) return;
  if (folder_ && file.path.extension() == ".json")
    refused_.push_back({file, content, read.error()});
  else
    Refuse(file, content, read.error());
}

void Inspector::Refuse(const FolderFile& file, const Content& content, const Error& error) {
  if (refused_by_run_.count(WholePath(file.path)) != 0) return;
  if (folder_ && content.unknown()) {
    others_.push_back(file.name);
    return;
  }
  const ErrorCode code = error.code;
  if (code == ErrorCode::kUnreadable || code == ErrorCode::kNotFound)
    return AddError(error, file.name, "unreadable", findings());
  // Text in brackets and XML may be anything, but not where it speaks of cameras or is BABEL's.
  const FileKind kind = content.kind;
  bool common = kind == FileKind::kXml || kind == FileKind::kToml || (IsJson(kind) && kind != FileKind::kBabel);
  if (common) {
    const Expected<std::string> bytes = ReadFile(file.path);
    common = !bytes || !LooksLikeCalibration(*bytes);
  }
  if (folder_ && (code == ErrorCode::kUnsupported || common) && error.reason != Reason::kUnsafePickle) {
    others_.push_back(file.name);
    if (code != ErrorCode::kUnsupported || IsJson(kind)) reasons_[error.what].push_back(file.name);
    return;
  }
  const char* format = content.format != nullptr ? content.format->name : "";
  const std::string code_of = kind == FileKind::kEmpty ? "empty_file"
                              : content.unknown()      ? "unknown_format"
                                                       : FaultCode(error, format);
  AddError(error, file.name, code_of, findings());
}

/// What stands beside clips does not make them mixed.
std::string FormatOf(const Inspection& inspection) {
  std::set<std::string> formats;
  const auto add = [&](const auto& entries) {
    if (!formats.empty()) return;
    for (const auto& entry : entries) formats.insert(entry.format);
  };
  add(inspection.clips);
  add(inspection.cameras);
  add(inspection.clouds);
  add(inspection.companions);
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
    if (!sequences_.Claim(refused.file.name, refused.error)) Refuse(refused.file, refused.content, refused.error);
  }
  for (const auto& [folder, file] : sequences_.Finish(folder_)) Add(file, folder.empty() ? path : folder);
  AddVideos();
  if (!others_.empty()) {
    findings().push_back(FindingAt(others_.front(), "other_files", Severity::kInfo, static_cast<double>(others_.size()),
                                   std::to_string(others_.size()) + (others_.size() == 1 ? " file is" : " files are") +
                                       " of no known format" + CommonReason(reasons_)));
  }
  CompareGroups(inspection);
  CompareAnnotations(annotated_, inspection);
  motions_.Compare(source_ ? source_->checks : CheckOptions(), findings());
  inspection.format = FormatOf(inspection);
  if (folder_ && inspection.format == "unknown") {
    findings().push_back(
        FindingAt(path, "no_clips", Severity::kError, 0.0, "no file of the folder holds motion in a known format"));
  }
}

}  // namespace

Inspection InspectPath(const std::filesystem::path& path, const std::optional<SourceOptions>& source,
                       const VideoProbe& videos, const InspectProgress& progress) {
  std::error_code unknown;
  Inspector inspector(source, std::filesystem::is_directory(path, unknown), videos);
  inspector.inspection.path = DisplayPath(path);
  if (!std::filesystem::exists(path, unknown)) {
    AddError({ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(path), ""}, "", "not_found",
             inspector.inspection.findings);
    return inspector.inspection;
  }
  const Expected<std::vector<FolderFile>> files = FilesToInspect(path);
  if (!files) {
    AddError(files.error(), "", "unreadable", inspector.inspection.findings);
    return inspector.inspection;
  }
  if (source) inspector.ReadDeclared(path);
  for (std::size_t i = 0; i < files->size(); ++i) {
    inspector.Look((*files)[i]);
    if (progress) progress(i + 1, files->size());
  }
  inspector.Finish(DisplayPath(path.filename().empty() ? path.parent_path().filename() : path.filename()));
  return inspector.inspection;
}

}  // namespace mocurate
