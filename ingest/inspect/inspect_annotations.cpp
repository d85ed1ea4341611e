#include "ingest/inspect/inspect_annotations.h"

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "core/base/text.h"
#include "ingest/inspect/file_names.h"
#include "ingest/sources/babel_segments.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostMissing = 20;
constexpr std::string_view kEnding = ".npz";

/// Motions by every ending of their path.
struct Motions {
  std::map<std::string, const InspectedClip*> files;  ///< null: cannot be read, which is reported of the file
  std::set<std::string> folders;

  explicit Motions(const Inspection& inspection) {
    for (const InspectedClip& clip : inspection.clips) {
      if (clip.format == "amass") Add(clip.file, &clip);
    }
    if (files.empty()) return;
    for (const Finding& finding : inspection.findings) {  // a file that cannot be read is there
      const std::size_t end = finding.clip.find(kEnding);
      if (finding.severity == Severity::kError && end != std::string::npos)
        Add(finding.clip.substr(0, end + kEnding.size()), nullptr);
    }
  }

  void Add(const std::string& path, const InspectedClip* clip) {
    for (std::size_t at = 0;; ++at) {
      files.emplace(path.substr(at), clip);
      if (const std::string folder = FolderOf(path.substr(at)); !folder.empty()) folders.insert(folder);
      at = path.find('/', at);
      if (at == std::string::npos) break;
    }
  }
};

void CompareDuration(const AnnotatedMotion& motion, const InspectedClip& clip, std::vector<Finding>& findings) {
  if (!clip.rate_hz.value || !(*clip.rate_hz.value > 0.0)) return;
  const auto doubt = CheckDuration(motion.duration_s, *clip.frames.value / *clip.rate_hz.value);
  if (!doubt) return;
  findings.push_back(FindingAt(motion.file + ":" + motion.key, doubt->code, doubt->severity, doubt->value,
                               clip.id + ": " + doubt->message));
}

}  // namespace

void CompareAnnotations(const std::vector<AnnotatedMotion>& annotated, Inspection& inspection) {
  const Motions motions(inspection);
  std::vector<Finding>& findings = inspection.findings;
  if (motions.files.empty()) return;
  std::size_t reported = 0, elsewhere = 0;
  for (const AnnotatedMotion& motion : annotated) {
    const InspectedClip* clip = nullptr;
    bool folder_is_here = false, is_here = false;
    for (const std::string& name : AmassNames(motion.feat_p)) {
      const auto found = motions.files.find(name);
      if (found != motions.files.end()) is_here = true;
      if (found != motions.files.end() && found->second != nullptr) clip = found->second;
      folder_is_here = folder_is_here || motions.folders.count(FolderOf(name)) > 0;
    }
    if (clip != nullptr) {
      CompareDuration(motion, *clip, findings);
    } else if (is_here) {
      continue;
    } else if (folder_is_here && reported < kMostMissing) {
      ++reported;
      findings.push_back(FindingAt(
          motion.file + ":" + motion.key, "motion_missing", Severity::kWarning, 0.0,
          "feat_p '" + motion.feat_p +
              "' names a motion that is missing in its folder: correct feat_p, or download that file of AMASS"));
    } else {
      ++elsewhere;
    }
  }
  if (elsewhere == 0) return;
  findings.push_back(
      FindingAt(annotated.front().file, "motion_missing", Severity::kInfo, static_cast<double>(elsewhere),
                Counted(static_cast<long long>(elsewhere), "annotated motion") + " of " +
                    std::to_string(annotated.size()) + (elsewhere == 1 ? " lies" : " lie") +
                    " in folders that are missing here: AMASS is downloaded in parts. Download those that you need"));
}

}  // namespace mocurate
