#include "ingest/files_check.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/base/text.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/inspect_files.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {

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
    const FormatDriver* found = head ? RecogniseFormat({*head, input.name, input.path}) : nullptr;
    // What the first bytes tell; tables of numbers may be of any format whose first bytes tell nothing.
    if (found == nullptr || found->kind == FileKind::kUnknown || found->kind == declared.kind) return {};
    if (found->kind == FileKind::kNumbers && declared.kind == FileKind::kUnknown) return {};
    if (other != nullptr && other != found) return {};
    other = found;
  }
  return Fail(ErrorCode::kConfig,
              "the source is declared " + source.format + ", its files are " + other->name + ", e.g. '" +
                  items[0].inputs[0].name + "'",
              "ingest.source.format", "write what they are, or correct ingest.source.files or ingest.path");
}

}  // namespace mocurate
