#include "core/store/truth_motions.h"

#include <cmath>

#include "core/motion/operations.h"
#include "core/store/store.h"

namespace mocurate {

void UndoCanonical(Clip& clip) {
  const RigidTransform& moved = clip.canonical_from_source;
  if (moved.translation.isZero(0.0) && moved.rotation.coeffs() == Quaterniond::Identity().coeffs()) return;
  Transform(Inverse(moved), clip);
}

Status TruthMotions::Add(const std::filesystem::path& path) {
  auto truth = ReadTruth(path);
  if (truth) {
    motions_.merge(truth->motion);
    return {};
  }
  auto dataset = ReadDataset(path);
  if (!dataset) return Forward(truth);
  for (Clip& clip : dataset->clips) {
    UndoCanonical(clip);
    motions_.emplace(clip.id(), *std::move(clip.motion));
  }
  return {};
}

std::optional<Motion> TruthMotions::Of(const Clip& fitted) const {
  const std::string id = fitted.id();
  const bool resampled = fitted.provenance.count(kRecordedRate) > 0;
  const auto at_rate = [&](const Motion& motion) {
    Clip clip;
    clip.motion = motion;
    return resampled ? Resample(clip, fitted.motion->rate) : clip;
  };
  if (const auto same = motions_.find(id); same != motions_.end()) return at_rate(same->second).motion;
  const std::string recording = id.substr(0, id.rfind('#') + 1) + "0-";
  const auto whole = motions_.lower_bound(recording);
  if (whole == motions_.end() || whole->first.compare(0, recording.size(), recording) != 0) return std::nullopt;
  int begin = fitted.identity.begin_frame, end = fitted.identity.end_frame;
  if (resampled) {
    begin = static_cast<int>(std::lround(begin * fitted.motion->rate.hz() / whole->second.rate.hz()));
    end = begin + fitted.motion->frame_count();
  }
  const Expected<Clip> cut = Cut(at_rate(whole->second), begin, end);
  return cut ? cut->motion : std::nullopt;
}

std::string TruthMotions::FirstId() const { return motions_.empty() ? "none" : "'" + motions_.begin()->first + "'"; }

}  // namespace mocurate
