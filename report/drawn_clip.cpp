#include "report/drawn_clip.h"

#include <map>

#include "core/store/store.h"

namespace mocurate {

Expected<DrawnClip> ReadDrawnClip(const StageRequest& request, std::vector<Finding>* findings) {
  std::map<std::string, std::filesystem::path> depth_files;
  const StageInput* evidence_input = nullptr;
  const StageInput* fit_input = nullptr;
  for (const StageInput& input : request.inputs) {
    if (input.role == "depth") depth_files[input.name] = input.path;
    if (input.role == "evidence") evidence_input = &input;
    if (input.role == "fit") fit_input = &input;
  }
  if (evidence_input == nullptr) return Fail(ErrorCode::kInternal, "a picture needs evidence", request.item);
  if (fit_input == nullptr) return Fail(ErrorCode::kInternal, "a picture needs a fit", request.item);
  auto evidence = ReadEvidence(evidence_input->path);
  if (!evidence) return Forward(evidence);
  auto fit = ReadDataset(fit_input->path);
  if (!fit) return Forward(fit);
  if (fit->clips.empty()) return Fail(ErrorCode::kInconsistent, "the fit has no clip", request.item);
  DrawnClip drawn;
  drawn.item = fit_input->name;
  drawn.evidence = std::move(*evidence);
  ResolveDepthFiles(depth_files, drawn.evidence.evidence);
  drawn.fitted = std::move(fit->clips.front());
  if (findings != nullptr) *findings = std::move(fit->findings);
  return drawn;
}

}  // namespace mocurate
