#include "ingest/files_check.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "core/base/text.h"
#include "ingest/sense/file_kind.h"

namespace mocurate {
namespace {

std::optional<std::pair<SourceFormat, const char*>> FormatOfKind(FileKind kind) {
  switch (kind) {
    case FileKind::kBvh:
      return std::pair(SourceFormat::kBvh, "bvh");
    case FileKind::kNpy:
      return std::pair(SourceFormat::kNpy, "npy");
    case FileKind::kNtuSkeleton:
      return std::pair(SourceFormat::kNtuSkeleton, "ntu_skeleton");
    case FileKind::kAmc:
      return std::pair(SourceFormat::kAsfAmc, "asf_amc");
    case FileKind::kNumbers:
      return std::pair(SourceFormat::kJointTable, "tables of numbers (joint_table, expmap, phspd)");
    default:
      return std::nullopt;
  }
}

bool IsTable(SourceFormat format) {
  return format == SourceFormat::kJointTable || format == SourceFormat::kExpmap || format == SourceFormat::kPhspd;
}

}  // namespace

Finding UnmatchedName(const std::string& option, const std::string& kind, const std::string& name,
                      const std::set<std::string>& known) {
  const auto near = Nearest(name, std::vector<std::string>(known.begin(), known.end()));
  Finding finding;
  finding.code = "name_unmatched";
  finding.message = option + ": there is no " + kind + " '" + name + "', so that it has no effect" +
                    (near ? "; did you mean '" + *near + "'?" : "");
  finding.action = FindingAction::kFlagged;
  return finding;
}

void NoteUnmatched(const SourceOptions& source, const std::set<std::string>& recordings,
                   std::vector<Finding>& findings) {
  for (const auto& [name, reason] : source.exclude) {
    if (recordings.count(name) != 0) continue;
    findings.push_back(UnmatchedName("ingest.source.exclude", "recording", name, recordings));
  }
}

bool EndsAsMotion(const SourceOptions& source, const std::string& name) {
  const std::string ending = std::filesystem::path(name).extension().string();
  return (source.format == SourceFormat::kNtuSkeleton && ending == ".skeleton") ||
         (source.format == SourceFormat::kBvh && ending == ".bvh") ||
         (source.format == SourceFormat::kAsfAmc && ending == ".amc") ||
         (source.format == SourceFormat::kPhspd && std::filesystem::path(name).filename() == "pose.txt");
}

void NotePassedOver(const SourceOptions& source, const std::vector<std::string>& names,
                    std::vector<Finding>& findings) {
  if (names.empty()) return;
  Finding finding;
  finding.code = "name_mismatch";
  finding.value = static_cast<double>(names.size());
  finding.message = Counted(static_cast<long long>(names.size()), "file") + " that could be of this source, e.g. '" +
                    names.front() + "': the pattern '" + source.files + "' does not match " +
                    (names.size() == 1 ? "it" : "them");
  finding.action = FindingAction::kLeftOut;
  findings.push_back(std::move(finding));
}

Status CheckFormat(const SourceOptions& source, const std::vector<ItemSpec>& items) {
  const char* other = nullptr;
  for (const std::size_t at : {std::size_t{0}, items.size() / 2, items.size() - 1}) {
    std::ifstream file(items[at].inputs[0].path, std::ios::binary);
    std::string head(kKindHead, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    const auto found = FormatOfKind(KindOf(head));
    const bool same = !found || found->first == source.format || (IsTable(found->first) && IsTable(source.format)) ||
                      (other != nullptr && other != found->second);
    if (same) return {};
    other = found->second;
  }
  return Fail(ErrorCode::kConfig,
              "the source is declared " + FormatName(source.format) + ", its files are " + other + ", e.g. '" +
                  items[0].inputs[0].name + "'",
              "ingest.source.format", "write what they are, or mend ingest.source.files or ingest.path");
}

}  // namespace mocurate
