#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/pickle.h"
#include "core/formats/vibe_pickle.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/people/uestc.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

/// Positions (frames, joints, 3) into a clip.
void SetPositions(const std::vector<double>& xyz, std::size_t frames, std::size_t joints, RawClip& clip) {
  clip.frames = static_cast<int>(frames);
  clip.joints = static_cast<int>(joints);
  if (xyz.size() != frames * joints * 3) return;
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.positions.xyz = xyz;
  clip.confidence.assign(frames * joints, 1.0);
}

Expected<RawFile> HumanAct12In(const FileBytes& file) {
  const auto archive = HumanAct12Archive::Open(file.bytes, file.name);
  if (!archive) return Forward(archive);
  RawFile observed;
  for (std::size_t i = 0; i < archive->size(); ++i) {
    const Expected<HumanAct12Clip> entry = archive->Clip(i);
    if (!entry) {  // costs a run one clip
      observed.remarks.push_back(MakeFinding(FaultCode(entry.error(), "humanact12_pickle"), Severity::kError,
                                             static_cast<double>(i), entry.error().Message()));
      continue;
    }
    observed.clips.push_back(ReadRawHumanAct12Clip(*entry));
    RawClip& clip = observed.clips.back();
    clip.id = "[" + std::to_string(i) + "]";
    if (const auto invalid_poses = CheckAngleUnits(*entry)) clip.remarks.push_back(*invalid_poses);
  }
  if (!observed.clips.empty() || archive->size() == 0) return observed;
  return Forward(archive->Clip(0));
}

/// The order of SPIN and VIBE (Kolotouros et al. 2019): 25 of OpenPose, then 24 of other data sets.
BodyLandmarks PointsOfSpin() {
  BodyLandmarks points;
  points.head = 43;
  points.hip[0] = 12, points.hip[1] = 9;
  points.knee[0] = 13, points.knee[1] = 10;
  points.ankle[0] = 14, points.ankle[1] = 11;
  points.toe[0] = 19, points.toe[1] = 22;
  points.shoulder[0] = 5, points.shoulder[1] = 2;
  points.wrist[0] = 7, points.wrist[1] = 4;
  return points;
}

/// What info/ beside `cache` says of its clips, if it is there: their names and classes as facts;
/// "count_contradiction" of a video, or of the file where it holds others than are named.
void CompareUestcInfo(const std::filesystem::path& cache, RawFile& observed) {
  std::error_code unknown;
  const std::filesystem::path folder = cache.has_parent_path() ? cache.parent_path() : ".";
  if (!std::filesystem::is_directory(folder / "info", unknown)) return;
  const Expected<UestcFolder> info = ReadUestcFolder(folder);
  if (!info) {
    observed.remarks.push_back(MakeFinding("malformed", Severity::kError, 0.0, info.error().Message()));
    return;
  }
  const std::size_t videos = info->videos.size();
  if (videos != observed.clips.size()) {
    observed.remarks.push_back(MakeFinding("count_contradiction", Severity::kError, static_cast<double>(videos),
                                           "info/names.txt names " + std::to_string(videos) +
                                               " videos, the cache holds " + std::to_string(observed.clips.size()) +
                                               ": which name is whose is not known; copy both from one place again"));
    return;
  }
  for (std::size_t i = 0; i < videos; ++i) {
    RawClip& clip = observed.clips[i];
    clip.facts.emplace_back("video", info->videos[i].Name());
    clip.facts.emplace_back("label", info->actions[static_cast<std::size_t>(info->videos[i].action)]);
    const auto doubt = CheckFrameCount(info->frames[i], static_cast<std::size_t>(clip.frames), static_cast<int>(i));
    if (doubt) clip.remarks.push_back(*doubt);
  }
}

Expected<RawFile> VibeCacheIn(const FileBytes& file) {
  const auto cache = VibeCache::Open(file.bytes, file.name);
  if (!cache) return Forward(cache);
  RawFile observed;
  for (std::size_t video = 0; video < cache->size(); ++video) {
    const auto track = cache->Track(video);
    if (!track) return Forward(track);
    observed.clips.push_back(ReadRawVibeTrack(*track, "vibe_cache"));
    observed.clips.back().id = "[" + std::to_string(video) + "]";
  }
  CompareUestcInfo(file.path, observed);
  return observed;
}

/// Where frames have no row: an ingest fills them.
void RemarkGaps(const VibeTrack& track, RawClip& clip) {
  for (std::size_t row = 1; row < track.frame_ids.size(); ++row) {
    const std::int64_t last = track.frame_ids[row - 1], next = track.frame_ids[row];
    if (next <= last + 1) continue;
    clip.remarks.push_back(MakeFinding("frames_filled", Severity::kInfo, static_cast<double>(next - last - 1),
                                       Counted(next - last - 1, "frame") +
                                           " without the person: " + std::to_string(last) + " is followed by " +
                                           std::to_string(next) + "; an ingest interpolates them"));
  }
}

Expected<RawFile> VibeTracksIn(const FileBytes& file) {
  const auto tracks = ParseVibeTracks(file.bytes, file.name);
  if (!tracks) return Forward(tracks);
  RawFile observed;
  for (const VibeTrack& track : *tracks) {
    observed.clips.push_back(ReadRawVibeTrack(track, "vibe_tracks"));
    observed.clips.back().id = "[" + std::to_string(track.id) + "]";
    RemarkGaps(track, observed.clips.back());
  }
  return observed;
}

// The lists that lie in info/ beside UESTC's cache, and what they say of its videos.

constexpr const char* kNamesFile = "names.txt";
constexpr const char* kCountsFile = "num_frames_min.txt";
constexpr const char* kActionsFile = "action_classes.txt";

bool LooksLikeVideoInfo(std::string_view head) {
  const std::vector<std::string_view> lines = SplitText(head, '\n');
  return std::any_of(lines.begin(), lines.end(),
                     [](std::string_view line) { return ParseUestcName(Trim(line), kNamesFile).has_value(); });
}

}  // namespace

RawClip ReadRawHumanAct12Clip(const HumanAct12Clip& source) {
  RawClip clip;
  clip.format = "humanact12_pickle";
  SetPositions(source.joints, source.frames, 24, clip);
  clip.layout_evidence = "list joints3D of the file";
  clip.facts.emplace_back("label", std::to_string(source.label));
  clip.units = "m";
  FollowFormat("smpl24", {std::begin(kSmplJointNames), std::end(kSmplJointNames)}, "24 joints of SMPL", clip);
  return clip;
}

RawClip ReadRawVibeTrack(const VibeTrack& track, const std::string& format) {
  RawClip clip;
  clip.format = format;
  SetPositions(track.joints3d, track.frames, track.joints, clip);
  clip.layout_evidence = "arrays of the file";
  clip.units = "m";
  clip.facts.emplace_back("track", std::to_string(track.id));
  if (const std::optional<Finding> invalid_poses = CheckAngleUnits(track)) clip.remarks.push_back(*invalid_poses);
  if (const auto places = CameraPlaces(track.original_camera); !places) {
    clip.remarks.push_back(MakeFinding("malformed", Severity::kError, 0.0, places.error().Message()));
  }
  if (track.joints == 49) {
    clip.skeleton = AsDeclared("spin49", "49 joints of VIBE and SPIN");
    clip.points = PointsOfSpin();
  }
  if (track.joints != 49 && track.joints != 0) {
    clip.remarks.push_back(MakeFinding("layout_unknown", Severity::kWarning, static_cast<double>(track.joints),
                                       "joints3d has " + Counted(static_cast<long long>(track.joints), "joint") +
                                           " a frame, VIBE and SPIN write 49: name them in their order under "
                                           "ingest.source.joints, or write the file anew"));
  }
  if (track.joints == 0) {
    clip.joints = static_cast<int>(track.pose.size() / std::max<std::size_t>(1, track.frames) / 3);
    clip.silence = "rotations of a body model that is not in the file";
    clip.missing_share = 0.0;
  }
  clip.people_evidence = "tracks of one person each";
  return clip;
}

Expected<RawFile> ReadRawPickle(const FileBytes& file) {
  const Expected<Pickle> pickle = ParsePickle(file.bytes, file.name);
  if (!pickle) return Forward(pickle);
  const PickleRef top = pickle->top();
  if (top.Find("joints3D") && top.Find("y")) return HumanAct12In(file);
  if (top.Find("v_template")) return RawFile::Of(RawCompanion{file.name, "body_model", {}, {}});
  if (top.Find("param_p") && top.Find("d1p")) return ReadRawCalibration(file);
  const std::optional<PickleRef> joints = top.Find("joints3d");
  const std::optional<PickleRef> pose = joints ? joints : top.Find("pose");
  if (pose && (pose->kind() == PickleKind::kList)) return VibeCacheIn(file);
  if (top.kind() == PickleKind::kDict && top.size() > 0 && top.ValueAt(0).kind() == PickleKind::kDict) {
    const PickleRef first = top.ValueAt(0);
    if (first.Find("joints3d") || first.Find("pose")) return VibeTracksIn(file);
  }
  return Fail(ErrorCode::kUnsupported, "the pickle holds " + std::string(KindName(top.kind())) + " of no known layout",
              file.name, "known are humanact12poses.pkl, tracks and caches of VIBE, rigs of PHSPD, and body models");
}

bool IsUestcInfo(const std::filesystem::path& path) {
  const std::filesystem::path file = path.filename();
  if (file != kNamesFile && file != kCountsFile && file != kActionsFile) return false;
  const Expected<std::string> head = ReadHead(path.parent_path() / kNamesFile);
  return head && LooksLikeVideoInfo(*head);
}

Expected<RawFile> ReadRawUestcInfo(const FileBytes& file) {
  RawCompanion companion{file.name, "uestc_info", {}, {}};
  const std::filesystem::path list = file.path.filename();
  if (list == kNamesFile) {
    const auto videos = ParseUestcNames(file.bytes, file.name);
    if (!videos) return Forward(videos);
    companion.numbers = {{"videos", static_cast<double>(videos->size())}};
  } else if (list == kCountsFile) {
    const auto frames = ParseUestcFrameCounts(file.bytes, file.name);
    if (!frames) return Forward(frames);
    double sum = 0.0;
    for (const int count : *frames) sum += count;
    companion.numbers = {{"videos", static_cast<double>(frames->size())}, {"frames", sum}};
  } else {
    const auto actions = ParseUestcActions(file.bytes, file.name);
    if (!actions) return Forward(actions);
    companion.numbers = {{"classes", static_cast<double>(actions->size())}};
  }
  return RawFile::Of(std::move(companion));
}

}  // namespace mocurate
