#include <cmath>

#include "core/base/random.h"
#include "core/formats/uestc_info.h"
#include "ingest/synthetic/action_parts.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"
#include "ingest/synthetic/vibe_track.h"

namespace mocurate {
namespace {

constexpr std::int64_t kRateHz = 30;
constexpr int kViews = 8;  // of UESTC's second camera; the ninth moves

/// Before a level camera at `height` metres, `away` metres off, that sees the subject turned by `turned` about the
/// vertical. Camera axes: x right, y down, z forward.
RigidTransform CameraFromWorld(double height, double away, double turned) {
  const RigidTransform turn{Quaterniond(Eigen::AngleAxisd(turned, Vector3d::UnitY())), Vector3d::Zero()};
  const RigidTransform shift{Quaterniond::Identity(), Vector3d(0.0, -height, -away)};
  return HalfTurnAboutX() * shift * turn;
}

ClipIdentity IdentityOf(const std::string& source, const std::string& person, const std::string& recording,
                        int frames) {
  ClipIdentity identity;
  identity.source = source;
  identity.person = person;
  identity.recording = recording;
  identity.end_frame = frames;
  return identity;
}

/// A video of UESTC: both cameras see each take, the second from one of eight sides.
struct Video {
  UestcVideo name;
  const PlannedTake* take = nullptr;
};

}  // namespace

Status WriteUestcLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = PlanTakes(options, UestcClasses(), {118, 2, static_cast<double>(kRateHz), 0.3, 0.8});
  if (!takes) return Forward(takes);
  std::vector<Video> videos;
  for (const PlannedTake& take : *takes) {
    const int view = (take.subject + take.repetition + take.kind->id) % kViews;
    videos.push_back({{take.kind->id, view, take.subject, 1}, &take});
    videos.push_back({{take.kind->id, view, take.subject, 2}, &take});
  }
  std::vector<VibeTrack> tracks(videos.size());
  std::vector<int> frames(videos.size());
  Status done = folder.ForEach(videos.size(), [&](std::size_t i) -> Status {
    const Video& video = videos[i];
    const Actor& actor = actors[static_cast<std::size_t>(video.take->subject - 1)];
    const Motion motion = PerformScript(video.take->script, actor.subject, actor.skeleton, FrameRate{kRateHz, 1});
    // The set's own reading turns side 2 back by -view * 45 degrees about the image's y, which points down.
    const double turned = video.name.side == 1 ? 0.0 : -0.25 * kPi * video.name.view;
    const Motion seen = Seen(motion, CameraFromWorld(1.1, 3.6, turned));
    tracks[i] = VibeTrackOf(seen, options.tracker, options.seed, video.name.Name());
    frames[i] = motion.frame_count();
    const std::string person = "p" + Digits(video.name.subject, 3);
    std::string recording = video.name.Name();
    recording = recording.substr(0, recording.rfind("_color"));
    folder.AddTruth(person, IdentityOf("uestc", person, recording, frames[i]).id(), Seen(seen, HalfTurnAboutX()));
    return {};
  });
  if (!done) return done;
  std::vector<UestcVideo> names;
  for (const Video& video : videos) names.push_back(video.name);
  const Expected<std::string> cache = EncodeVibeCache(tracks, "vibe_cache_refined.pkl");
  if (!cache) return Forward(cache);
  std::string classes;
  for (const SetClass& kind : UestcClasses()) classes += std::string(kind.label) + "\n";
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>("info/names.txt", WriteUestcNames(names)),
                                    {"info/num_frames_min.txt", WriteUestcFrameCounts(frames)},
                                    {"info/action_classes.txt", classes},
                                    {"vibe_cache_refined.pkl", *cache}}) {
    if (Status written = folder.Write("uestc/" + name, bytes); !written) return written;
  }
  return {};
}

Status WriteNtuVibeLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = PlanTakes(options, Ntu13Classes(), {40, 2, static_cast<double>(kRateHz), 0.2, 0.6});
  if (!takes) return Forward(takes);
  std::vector<std::string> names(takes->size());
  Status done = folder.ForEach(takes->size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i];
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    const std::string person = "P" + Digits(take.subject, 3);
    const std::string recording =
        "S001C001" + person + "R" + Digits(take.repetition, 3) + "A" + Digits(take.kind->id, 3);
    const Motion motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kRateHz, 1});
    const Motion seen = Seen(motion, CameraFromWorld(1.2, 3.4, 0.0));
    const VibeTrack track = VibeTrackOf(seen, options.tracker, options.seed, recording);
    names[i] = recording + ".pkl";
    const Expected<std::string> bytes = EncodeVibeTracks({track}, names[i]);
    if (!bytes) return Forward(bytes);
    if (Status written = folder.Write("ntu13/" + names[i], *bytes); !written) return written;
    folder.AddTruth(person, IdentityOf("ntu13", person, recording, motion.frame_count()).id(),
                    Seen(seen, HalfTurnAboutX()));
    return {};
  });
  if (!done) return done;
  std::string list;
  for (const std::string& name : names) list += name + "\n";
  return folder.Write("ntu13/ntu_vibe_list.txt", list);
}

}  // namespace mocurate
