#include <algorithm>
#include <map>

#include "core/base/file.h"
#include "core/quality/duplicates.h"
#include "core/store/store.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/stages.h"

namespace mocurate {
namespace {

struct Compared {
  std::string item, clip, sha256;
  MotionSignature signature;
};

Expected<Compared> ReadCompared(const StageInput& input) {
  const auto clip = ReadEvidence(input.path);
  if (!clip) return Forward(clip);
  Compared compared{input.name, clip->id(), clip->evidence_sha256, {}};
  // Clips of several people of one recording have the same keypoints.
  if (clip->evidence.subject > 0) compared.sha256 += "/" + std::to_string(clip->evidence.subject);
  const ClipPoints points(*clip, nullptr);
  if (!points.empty()) compared.signature = SignatureOf(points.view());
  return compared;
}

/// Clips without joints, by their source's bytes.
void CompareContent(const std::vector<Compared>& clips, std::vector<std::pair<std::size_t, Finding>>& found) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (clips[i].signature.points > 0 || clips[i].sha256.empty()) continue;
    const auto [at, fresh] = first.emplace(clips[i].sha256, i);
    if (fresh) continue;
    Finding finding =
        FrameFinding("duplicate", 0, 0, "", 0.0, "the same bytes as '" + clips[at->second].item + "' (0 m apart)");
    finding.clip = clips[i].clip;
    found.emplace_back(i, std::move(finding));
  }
}

}  // namespace

Expected<StageOutcome> DuplicatesStage(const StageRequest& request) {
  const auto options = OptionsFromJson<CheckOptions>(request.options, "checks");
  if (!options) return Forward(options);
  std::vector<Compared> clips;
  std::vector<MotionSignature> signatures;
  for (const StageInput& input : request.inputs) {
    auto read = ReadCompared(input);
    if (!read) return Forward(read);
    clips.push_back(*std::move(read));
  }
  std::sort(clips.begin(), clips.end(), [](const Compared& a, const Compared& b) { return a.item < b.item; });
  for (Compared& clip : clips) signatures.push_back(std::move(clip.signature));
  const DuplicateLimits limits = DuplicateLimitsOf(*options);
  const std::vector<Duplicate> pairs = FindDuplicates(signatures, limits);
  for (std::size_t i = 0; i < clips.size(); ++i) clips[i].signature = std::move(signatures[i]);
  std::vector<std::pair<std::size_t, Finding>> found;
  for (const Duplicate& pair : pairs) {
    const Compared &first = clips[pair.first], &second = clips[pair.second];
    Finding finding = DuplicateFinding(pair, first.item, first.signature, second.signature);
    finding.clip = second.clip;
    found.emplace_back(pair.second, std::move(finding));
  }
  CompareContent(clips, found);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  StageOutcome outcome;
  outcome.summary = {
      {"clips", clips.size()}, {"items", nlohmann::json::array()}, {"dropped", nlohmann::json::object()}};
  for (auto& [clip, finding] : found) {
    const OnFinding action = options->ActionFor(finding.code);
    if (action == OnFinding::kIgnore) continue;
    if (action == OnFinding::kDrop) {
      finding.action = FindingAction::kDropped;
      outcome.summary["dropped"].emplace(clips[clip].item,
                                         finding.code == "shared_frames" ? limits.shared_frames : limits.distance);
    }
    outcome.summary["items"].push_back(clips[clip].item);
    outcome.findings.push_back(std::move(finding));
  }
  if (Status written = WriteFile(request.output, nlohmann::json(outcome.findings).dump(1) + "\n"); !written) {
    return Forward(written);
  }
  return outcome;
}

}  // namespace mocurate
