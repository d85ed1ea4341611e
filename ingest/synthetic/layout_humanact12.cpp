#include <algorithm>

#include "core/formats/humanact12_pickle.h"
#include "core/formats/npy.h"
#include "core/formats/phspd_text.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/phspd_annotation.h"
#include "ingest/synthetic/rigs.h"

namespace mocurate {
namespace {

std::string HumanAct12Name(const PlannedRecording& recording, const CutClip& cut) {
  return "P" + Digits(recording.subject, 2) + "G" + Digits(recording.group, 2) + "R" + Digits(recording.time, 2) + "F" +
         Digits(cut.first, 4) + "T" + Digits(cut.last, 4) + "A" + cut.variant->code;
}

HumanAct12Clip HumanAct12ClipOf(const Motion& motion, const CutClip& cut) {
  HumanAct12Clip clip;
  clip.frames = static_cast<std::size_t>(motion.frame_count());
  clip.joints = motion.joints.xyz;
  clip.label = std::stoi(std::string(cut.variant->code).substr(0, 2)) - 1;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const std::vector<double> pose = RotationVectors(motion, f);
    clip.poses.insert(clip.poses.end(), pose.begin(), pose.end());
  }
  return clip;
}

}  // namespace

Status WriteHumanAct12Clips(const StudioOptions& options, const PlannedRecording& recording, const Motion& motion,
                            const std::string& folder_name, StudioFolder& folder,
                            std::vector<std::pair<std::string, HumanAct12Clip>>& published) {
  const Camera colour = PhspdRig(recording.subject)[5];
  const std::vector<int> annotated = AnnotatedFrames(options, recording);
  const std::string person = "P" + Digits(recording.subject, 2);
  for (const CutClip& cut : recording.clips) {
    std::vector<int> frames;
    for (const int f : annotated) {
      if (f >= cut.first && f <= cut.last) frames.push_back(f);
    }
    if (frames.empty()) continue;
    const std::string name = HumanAct12Name(recording, cut);
    const Motion seen = SelectFrames(motion, frames, colour.camera_from_world);
    HumanAct12Clip clip = HumanAct12ClipOf(seen, cut);
    const std::string npy = WriteNpy({{clip.frames, kPhspdJoints, 3}, "<f8", clip.joints, {}});
    if (Status written = folder.Write(folder_name + "/" + name + ".npy", npy); !written) return written;
    ClipIdentity identity;
    identity.source = "humanact12";
    identity.person = person;
    identity.recording = name;
    identity.end_frame = static_cast<int>(frames.size());
    folder.AddTruth(person, identity.id(), SelectFrames(seen, HalfRotationAboutX()));
    published.emplace_back(name, std::move(clip));
  }
  return {};
}

Status WriteHumanAct12Layout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const std::vector<PlannedRecording> recordings =
      PlanHumanAct12({options.seed, options.subjects, options.clips, options.actions});
  std::vector<std::vector<std::pair<std::string, HumanAct12Clip>>> published(recordings.size());
  Status done = folder.ForEach(recordings.size(), [&](std::size_t i) {
    const Motion motion = PerformRecording(recordings[i], actors);
    return WriteHumanAct12Clips(options, recordings[i], motion, "HumanAct12", folder, published[i]);
  });
  if (!done) return done;
  std::vector<std::pair<std::string, HumanAct12Clip>> all;
  for (auto& part : published) std::move(part.begin(), part.end(), std::back_inserter(all));
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<HumanAct12Clip> clips;
  for (auto& [name, clip] : all) clips.push_back(std::move(clip));
  const Expected<std::string> pickle = EncodeHumanAct12Pickle(clips, "humanact12poses.pkl");
  if (!pickle) return Forward(pickle);
  return folder.Write("humanact12poses.pkl", *pickle);
}

}  // namespace mocurate
