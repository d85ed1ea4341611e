#include "ingest/sense/inspect_annotations.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

#include "core/base/text.h"
#include "ingest/sense/clip_report.h"
#include "ingest/sense/file_names.h"
#include "ingest/sources/babel_segments.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostMissing = 20;
constexpr std::string_view kEnding = ".npz";

/// Motions by every ending of their path.
struct Motions {
  std::map<std::string, const Json*> files;  ///< null: cannot be read, which is told of the file
  std::set<std::string> folders;

  Motions(const Json& clips, const Json& findings) {
    for (const Json& clip : clips) {
      if (clip.at("format") == "amass") Add(clip.at("file").get<std::string>(), &clip);
    }
    if (files.empty()) return;
    for (const Json& finding : findings) {  // a file that cannot be read is there
      const std::string where = finding.at("where");
      const std::size_t end = where.find(kEnding);
      if (finding.at("severity") == "error" && end != std::string::npos)
        Add(where.substr(0, end + kEnding.size()), nullptr);
    }
  }

  void Add(const std::string& path, const Json* clip) {
    for (std::size_t at = 0;; ++at) {
      files.emplace(path.substr(at), clip);
      if (const std::string folder = FolderOf(path.substr(at)); !folder.empty()) folders.insert(folder);
      at = path.find('/', at);
      if (at == std::string::npos) break;
    }
  }
};

void TellDuration(const AnnotatedMotion& motion, const Json& clip, Json& findings) {
  const Json &frames = clip.at("frames").at("value"), &rate = clip.at("rate_hz").at("value");
  if (!frames.is_number() || !rate.is_number() || !(rate.get<double>() > 0.0)) return;
  const auto doubt = DoubtDuration(motion.duration_s, frames.get<double>() / rate.get<double>());
  if (!doubt) return;
  findings.push_back(InspectionFinding(doubt->code, doubt->severity, motion.file + ":" + motion.key, doubt->value,
                                       clip.at("id").get<std::string>() + ": " + doubt->message));
}

}  // namespace

void TellAnnotations(const std::vector<AnnotatedMotion>& annotated, const Json& clips, Json& findings) {
  const Motions motions(clips, findings);
  if (motions.files.empty()) return;
  std::size_t told = 0, elsewhere = 0;
  for (const AnnotatedMotion& motion : annotated) {
    const Json* clip = nullptr;
    bool folder_is_here = false, is_here = false;
    for (const std::string& name : AmassNames(motion.feat_p)) {
      const auto found = motions.files.find(name);
      if (found != motions.files.end()) is_here = true;
      if (found != motions.files.end() && found->second != nullptr) clip = found->second;
      folder_is_here = folder_is_here || motions.folders.count(FolderOf(name)) > 0;
    }
    if (clip != nullptr) {
      TellDuration(motion, *clip, findings);
    } else if (is_here) {
      continue;
    } else if (folder_is_here && told < kMostMissing) {
      ++told;
      findings.push_back(InspectionFinding("motion_missing", Severity::kWarning, motion.file + ":" + motion.key, 0.0,
                                           "feat_p '" + motion.feat_p +
                                               "' names no motion of its folder, which is here: mend it, or "
                                               "fetch that file of AMASS"));
    } else {
      ++elsewhere;
    }
  }
  if (elsewhere == 0) return;
  findings.push_back(InspectionFinding(
      "motion_missing", Severity::kInfo, annotated.front().file, static_cast<double>(elsewhere),
      Counted(static_cast<long long>(elsewhere), "annotated motion") + " of " + std::to_string(annotated.size()) +
          (elsewhere == 1 ? " lies" : " lie") + " in folders that are not here: AMASS comes in parts"));
}

}  // namespace mocurate
