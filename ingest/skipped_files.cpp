#include "ingest/skipped_files.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "ingest/folder_listing.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

/// "12 .skeleton, 3 .txt": the most frequent first, three of them.
std::string EndingsOf(const std::vector<std::string>& names) {
  std::map<std::string, int> counts;
  for (const std::string& name : names) {
    const std::string ending = std::filesystem::path(name).extension().string();
    ++counts[ending.empty() ? "without an ending" : ending];
  }
  std::vector<std::pair<int, std::string>> order;
  order.reserve(counts.size());
  for (const auto& [ending, count] : counts) order.emplace_back(-count, ending);
  std::sort(order.begin(), order.end());
  std::string text;
  for (std::size_t i = 0; i < order.size() && i < 3; ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(-order[i].first) + " " + order[i].second;
  return text + (order.size() > 3 ? " and others" : "");
}

/// The folder above from which the pattern names what this one holds; empty where there is none.
std::filesystem::path FolderMeant(const IngestOptions& options, const std::vector<std::string>& found) {
  const Expected<NamePattern> pattern = NamePattern::Parse(options.source.files, "ingest.source.files");
  std::filesystem::path folder = std::filesystem::absolute(options.path / "").lexically_normal().parent_path();
  std::string above;
  for (int level = 0; pattern && level < pattern->depth() && folder.has_filename(); ++level) {
    above = folder.filename().string() + "/" + above;
    folder = folder.parent_path();
    const auto named = [&](const std::string& name) { return pattern->Match(above + name).has_value(); };
    if (std::any_of(found.begin(), found.end(), named)) return folder;
  }
  return {};
}

/// A file that gives no clip: why, as an error and as a finding.
ItemResult WithoutClip(const std::string& item, bool failed, Error error, Finding finding) {
  finding.clip = item;
  finding.action = FindingAction::kExcluded;
  ItemResult result;
  result.item = item;
  result.outcome.kind = failed ? OutcomeKind::kRefused : OutcomeKind::kExcluded;
  result.outcome.error = std::move(error);
  result.outcome.findings.push_back(std::move(finding));
  return result;
}

}  // namespace

ItemResult SkippedFile(const std::string& name, const SourceOptions& source, bool matches, const Error& why) {
  const bool by_rule = matches && source.other_labels == OtherLabels::kLeaveOut;
  const bool failed =
      !by_rule && (source.other_files == OtherFiles::kError || (matches && source.other_files != OtherFiles::kIgnore));
  const std::string hint = by_rule ? "as ingest.source.other_labels asks" : why.hint;
  return WithoutClip(name, failed, {ErrorCode::kInconsistent, why.what, name, hint},
                     MakeFinding(by_rule   ? "label_excluded"
                                 : matches ? "label_unknown"
                                           : "name_mismatch",
                                 failed    ? Severity::kError
                                 : by_rule ? Severity::kInfo
                                           : Severity::kWarning,
                                 0.0, why.what + (why.hint.empty() || by_rule ? "" : " (" + why.hint + ")")));
}

ItemResult ExcludedFile(const std::string& item, const std::string& file, const char* code, const std::string& why,
                        const std::string& hint) {
  return WithoutClip(item, false, {ErrorCode::kInconsistent, why, file, hint},
                     MakeFinding(code, Severity::kInfo, 0.0, why));
}

ItemResult RefusedFile(const std::string& item, const char* code, const Error& why) {
  return WithoutClip(item, true, why, MakeFinding(code, Severity::kError, 0.0, why.what));
}

void AddSourceHash(const std::filesystem::path& file, ItemResult& result) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return;
  if (const Expected<std::string> sha256 = Sha256OfFile(file)) result.summary.Set("source_sha256", *sha256);
}

ItemResult SkippedFolder(const std::string& folder, std::size_t files, bool named_so, const SourceOptions& source) {
  const bool failed = source.other_files == OtherFiles::kError;
  const std::string count =
      files > kMostCounted ? "more than " + std::to_string(kMostCounted) + " files" : Counted(files, "file");
  const std::string message = "not looked at: " + count + "; the pattern '" + source.files + "' names files" +
                              (named_so ? ", this is a folder" : " in another place");
  return WithoutClip(
      folder, failed,
      {ErrorCode::kInconsistent, message, folder,
       "links to folders are not followed; correct ingest.source.files, or set other_files"},
      MakeFinding(kFolderNotRead, failed ? Severity::kError : Severity::kWarning, static_cast<double>(files), message));
}

Error NothingFound(const IngestOptions& options, const Discovery& discovery, const std::vector<std::string>& found) {
  const std::string where = DisplayPath(options.path);
  const std::string none = "no file matches the pattern '" + options.source.files + "'";
  const auto failed = std::find_if(discovery.excluded.begin(), discovery.excluded.end(), [](const ItemResult& file) {
    const std::vector<Finding>& findings = file.outcome.findings;
    return file.outcome.kind == OutcomeKind::kRefused &&
           (file.outcome.error.code != ErrorCode::kInconsistent ||
            (!findings.empty() &&
             (findings.front().code == "label_unknown" || findings.front().code == kNameAmbiguous)));
  });
  if (failed != discovery.excluded.end()) {
    return {ErrorCode::kNotFound, "no file can be read; the first: " + failed->outcome.error.Message(), where, ""};
  }
  const auto by_rule = [](const ItemResult& file) {
    return file.outcome.kind == OutcomeKind::kExcluded && !file.outcome.findings.empty() &&
           file.outcome.findings.front().code != "name_mismatch" &&
           file.outcome.findings.front().code != kFolderNotRead;
  };
  const auto ruled = std::find_if(discovery.excluded.begin(), discovery.excluded.end(), by_rule);
  if (ruled != discovery.excluded.end() && ruled->outcome.findings.front().code == kOtherJoints) {
    return ruled->outcome.error;
  }
  if (ruled != discovery.excluded.end()) {
    const auto count = std::count_if(discovery.excluded.begin(), discovery.excluded.end(), by_rule);
    return {
        ErrorCode::kNotFound,
        (count == 1 ? std::string("the one file that matches the pattern is excluded by rule: ")
                    : "all " + Counted(count, "file") + " that match the pattern are excluded by rule; the first: ") +
            ruled->outcome.error.Message(),
        where, "remove the rule, or choose other files"};
  }
  const std::filesystem::path meant = FolderMeant(options, found);
  if (!meant.empty()) {
    return {ErrorCode::kNotFound, none, where,
            "from the folder above it does: give " + DisplayPath(meant) + " (ingest.path)"};
  }
  const std::string files = found.empty() ? "" : "the folder holds " + EndingsOf(found) + "; ";
  if (discovery.excluded.empty()) return {ErrorCode::kNotFound, none, where, files + "is it the right folder?"};
  return {ErrorCode::kNotFound, none, where,
          files + "e.g. '" + discovery.excluded.front().item +
              "' does not match; correct ingest.source.files or ingest.path"};
}

ItemResult WithoutMotion(const BabelIndex& babel, const std::vector<std::string>& files) {
  const std::vector<std::string> unused = babel.Unused();
  const std::string message = std::to_string(unused.size()) + " of " + std::to_string(babel.size()) +
                              " annotated motions are not in the folder, e.g. '" + unused.front() + "'";
  return WithoutClip(files.front(), false,
                     {ErrorCode::kNotFound, message, files.front(),
                      "AMASS comes in parts; names are matched as ingest/sources/babel_segments.h describes"},
                     MakeFinding("motion_missing", Severity::kWarning, static_cast<double>(unused.size()), message));
}

Finding UnmatchedName(const std::string& option, const std::string& kind, const std::string& name,
                      const std::set<std::string>& known) {
  const auto near = Nearest(name, std::vector<std::string>(known.begin(), known.end()));
  return MakeFinding("name_unmatched", Severity::kWarning, 0.0,
                     option + ": there is no " + kind + " '" + name + "', so that it has no effect" +
                         (near ? "; did you mean '" + *near + "'?" : ""));
}

void NoteUnmatched(const SourceOptions& source, const std::set<std::string>& recordings,
                   std::vector<Finding>& findings) {
  for (const auto& [name, reason] : source.exclude) {
    if (recordings.count(name) != 0) continue;
    findings.push_back(UnmatchedName("ingest.source.exclude", "recording", name, recordings));
  }
}

bool EndsAsMotion(const SourceOptions& source, const std::string& name) {
  const std::string ending = DriverOf(source.format).ending;
  const std::filesystem::path path(name);
  return !ending.empty() && (path.extension() == ending || path.filename() == ending);
}

void NotePassedOver(const SourceOptions& source, const std::vector<std::string>& names,
                    std::vector<Finding>& findings) {
  if (names.empty()) return;
  findings.push_back(MakeFinding("name_mismatch", Severity::kWarning, static_cast<double>(names.size()),
                                 Counted(static_cast<long long>(names.size()), "file") +
                                     " that could be of this source, e.g. '" + names.front() + "': the pattern '" +
                                     source.files + "' does not match " + (names.size() == 1 ? "it" : "them"),
                                 FindingAction::kExcluded));
}

Status CheckFormat(const SourceOptions& source, const std::vector<ItemSpec>& items) {
  const FormatDriver& declared = DriverOf(source.format);
  const FormatDriver* other = nullptr;
  for (const std::size_t at : {std::size_t{0}, items.size() / 2, items.size() - 1}) {
    const StageInput& input = items[at].inputs[0];
    const Expected<std::string> head = ReadHead(input.path);
    const FileKind kind = KindOf(head.value_or(""));
    const FormatDriver* found = head ? RecogniseFormat({*head, input.name, input.path}, kind) : nullptr;
    // What the content tells; tables of numbers may be of any format whose content tells nothing.
    if (found == nullptr || found == &declared || found->kinds.empty() || declared.IsOf(kind)) return {};
    if (declared.kinds.empty() && (kind == FileKind::kNumbers || IsJson(kind))) return {};
    if (other != nullptr && other != found) return {};
    other = found;
  }
  return Fail(ErrorCode::kConfig,
              "the source is declared " + source.format + ", its files are " + other->name + ", e.g. '" +
                  items[0].inputs[0].name + "'",
              "ingest.source.format", "write what they are, or correct ingest.source.files or ingest.path");
}

}  // namespace mocurate
