#include "ingest/synthetic/studio_layouts.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/file.h"
#include "core/base/version.h"
#include "core/formats/png.h"
#include "core/store/body_file.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/script.h"
#include "ingest/synthetic/sensors.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

struct LayoutRow {
  StudioLayout layout;
  std::int64_t subjects;  ///< of the real set
  Status (*write)(const StudioOptions&, const std::vector<Actor>&, StudioFolder&);
  std::vector<WrittenSource> sources;
};

const LayoutRow& RowOf(StudioLayout layout) {
  using L = StudioLayout;
  static const std::vector<LayoutRow> rows = {
      {L::kHumanAct12,
       kHumanAct12Subjects,
       WriteHumanAct12Layout,
       {{"humanact12_npy", "HumanAct12"}, {"humanact12_poses", "."}}},
      {L::kPhspd, kHumanAct12Subjects, WritePhspdLayout, {{"phspd", "phspd"}}},
      {L::kNtu, 40, WriteNtuLayout, {{"ntu", "nturgb+d_skeletons"}}},
      {L::kKard, 10, WriteKardLayout, {{"kard", "kard"}}},
      {L::kUestc, 118, WriteUestcLayout, {{"uestc", "uestc"}}},
      {L::kUestcVibe, 118, WriteUestcVibeLayout, {{"uestc_vibe", "uestc_vibe"}}},
      {L::kNtuVibe, 40, WriteNtuVibeLayout, {{"ntu13_vibe", "ntu13"}}},
      {L::kTracks, 2, WriteTracksLayout, {{"studio_tracks", "tracks"}}},
      {L::kOpenPose, 2, WriteOpenPoseLayout, {{"studio_keypoints", "openpose"}}},
      {L::kOpenPoseDepth, 2, WriteOpenPoseDepthLayout, {{"studio_keypoints_depth", "openpose_depth"}}},
      {L::kAmass, 4, WriteAmassLayout, {{"amass", "amass"}}},
      {L::kDepthSequence, 2, WriteDepthSequenceLayout, {{"rendered_seq", "rendered_seq"}}},
      {L::kCmu8, 8, WriteCmu8Layout, {{"cmu8", "cmu8"}}}};
  for (const LayoutRow& row : rows) {
    if (row.layout == layout) return row;
  }
  return rows.front();
}

Status CheckFolder(const std::filesystem::path& folder) {
  std::error_code unreadable;
  if (!std::filesystem::exists(folder, unreadable)) return {};
  if (!std::filesystem::is_directory(folder, unreadable)) {
    return Fail(ErrorCode::kCannotWrite, "this is a file, not a folder", DisplayPath(folder), "choose another with -o");
  }
  if (std::filesystem::is_empty(folder, unreadable)) return {};
  return Fail(ErrorCode::kCannotWrite, "the folder is not empty", DisplayPath(folder),
              std::filesystem::exists(folder / StudioFolder::kWhole, unreadable)
                  ? "choose another with -o, or remove it: the studio writes into empty folders only"
                  : "choose another with -o; without studio.json it is an interrupted run: remove it");
}

/// HumanAct12's classes for layouts that perform them by clip; other layouts check their own.
Status CheckStudioActions(const StudioOptions& options) {
  const bool by_variants = options.layout == StudioLayout::kHumanAct12 || options.layout == StudioLayout::kPhspd ||
                           options.layout == StudioLayout::kDepthSequence;
  if (!by_variants) return {};
  return CheckVariants(options.actions);
}

std::int64_t PeopleOf(const StudioOptions& options) {
  return options.subjects > 0 ? options.subjects : RowOf(options.layout).subjects;
}

/// `body` keeps the template, where there is one, alive for the actors.
Expected<std::vector<Actor>> ActorsFor(const StudioOptions& options, std::int64_t people,
                                       std::optional<BodyTemplate>& body) {
  if (!options.body.empty()) {
    Expected<BodyTemplate> read = ReadBodyTemplate(options.body);
    if (!read) return Forward(read);
    body = std::move(*read);
  }
  return ActorsOf(options, people, body ? &*body : nullptr);
}

/// Number of images of the layout's depth cameras.
std::size_t DepthImagesOf(const StudioOptions& options, std::int64_t people) {
  std::size_t frames = 0, cameras = 3;
  const auto add = [&](int count, std::int64_t every) {
    frames += static_cast<std::size_t>((count + every - 1) / every);
  };
  if (options.layout == StudioLayout::kDepthSequence) {
    cameras = RigOf(options.rig, SensorKind::kDepth).size();
    for (int person = 1; person <= people; ++person) add(PlanDepthSequence(options, person).script.frames, 1);
  } else if (options.layout == StudioLayout::kPhspd && options.depth.enabled) {
    for (const PlannedRecording& recording : PlanHumanAct12(options)) {
      add(recording.script.frames, options.depth.every);
    }
  } else if (options.depth.enabled &&
             (options.layout == StudioLayout::kOpenPoseDepth || options.layout == StudioLayout::kNtu)) {
    const auto takes = options.layout == StudioLayout::kNtu ? PlanNtuTakes(options) : PlanVariantTakes(options);
    if (!takes) return 0;  // writing reports the error
    for (const PlannedTake& take : *takes) add(take.script.frames, options.depth.every);
  }
  return frames * cameras;
}

/// Bytes of one image of a person before the first camera.
Expected<std::size_t> SampleImage(const StudioOptions& options, const Actor& actor) {
  const bool ring = options.layout == StudioLayout::kDepthSequence;
  const Camera camera = ring ? RigOf(options.rig, SensorKind::kDepth).front() : PhspdRig(1)[1];
  Script standing;
  standing.frames = 2;
  const Motion motion = PerformScript(standing, actor.subject, actor.skeleton, FrameRate{15, 1});
  const std::vector<Vector2d> rays = PixelRays(camera);
  const std::vector<float> body = BodyView(actor).Depth(motion, 0, camera, rays);
  const bool room = options.layout == StudioLayout::kPhspd && options.depth.room;
  const std::vector<float> background = room ? RoomDepth(camera, rays, 1.6) : std::vector<float>();
  const DepthImage image = SimulateDepth(body, background, camera, rays, options.depth, options.seed, "estimate");
  const Expected<std::string> png = EncodePng(image);
  if (!png) return Forward(png);
  return png->size();
}

}  // namespace

Expected<StudioEstimate> EstimateStudioLayout(const StudioOptions& options, int jobs) {
  if (Status known = CheckStudioActions(options); !known) return Forward(known);
  const std::size_t images = DepthImagesOf(options, PeopleOf(options));
  if (images == 0) return StudioEstimate();
  std::optional<BodyTemplate> body;
  const auto actors = ActorsFor(options, 1, body);
  if (!actors) return Forward(actors);
  const auto begin = std::chrono::steady_clock::now();
  const Expected<std::size_t> bytes = SampleImage(options, actors->front());
  if (!bytes) return Forward(bytes);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto count = static_cast<double>(images);
  return StudioEstimate{images, count * static_cast<double>(*bytes), count * seconds / std::max(1, jobs)};
}

std::vector<WrittenSource> SourcesOf(StudioLayout layout, bool with_depth) {
  std::vector<WrittenSource> sources = RowOf(layout).sources;
  if (layout == StudioLayout::kNtu && with_depth) sources.push_back({"ntu_views", "."});
  return sources;
}

Expected<StudioFolder::Counts> WriteStudioLayout(const StudioOptions& options, const std::filesystem::path& folder,
                                                 int jobs, const StudioFolder::Progress& progress) {
  if (Status free = CheckFolder(folder); !free) return Forward(free);
  if (Status known = CheckStudioActions(options); !known) return Forward(known);
  std::optional<BodyTemplate> body;
  const auto actors = ActorsFor(options, PeopleOf(options), body);
  if (!actors) return Forward(actors);
  const LayoutRow& row = RowOf(options.layout);
  StudioFolder files(folder, std::max(1, jobs), progress);
  if (Status written = row.write(options, *actors, files); !written) return Forward(written);
  StudioOptions stated = options;
  stated.body = options.body.filename();  // its folder does not matter
  const StudioFolder::Counts counts = files.counts();
  const nlohmann::json made = {{"created_by", CreatedBy()},
                               {"options", OptionsToJson(stated)},
                               {"clips", counts.clips},
                               {"frames", counts.frames}};
  if (Status whole = files.Finish(made.dump(1) + "\n"); !whole) return Forward(whole);
  return files.counts();
}

}  // namespace mocurate
