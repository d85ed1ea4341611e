// The .skeleton files and masked depth maps of one performance, recorded by several Kinects.

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/people/merge_views.h"
#include "ingest/sources/frame_files.h"
#include "ingest/sources/ntu_people.h"

namespace mocurate {
namespace {

constexpr double kLeastCovered = 0.9;  // of the reference's frames: a camera that covers less does not shorten the clip
constexpr double kOtherFocal = 0.05;   // relative
constexpr long long kMostFirst = 1000000;  // of frames, of a declared first one
constexpr double kOtherCentre = 15.0;      // pixels

/// The data of one camera.
struct Sensor {
  const ViewFile* file = nullptr;
  NtuSkeleton skeleton;
  std::vector<const StageInput*> images;  ///< by frame, from 0; null: no image
};

/// The depth images of each camera by frame: MDepth-00000001.png is frame 0.
Status SortImages(const SourceFile& file, std::vector<Sensor>& sensors) {
  const Expected<NamePattern> pattern = NamePattern::Parse(file.source.depth_files, "ingest.source.depth_files");
  if (!pattern) return Forward(pattern);
  for (const StageInput& input : file.depth_files) {
    const std::optional<NameFields> fields = pattern->Match(input.name);
    const std::optional<long long> number =
        fields && fields->count("frame") > 0 ? ParseInteger(fields->at("frame")) : std::nullopt;
    if (!number) {
      return Fail(ErrorCode::kConfig, "'" + file.source.depth_files + "' gives no {frame} for " + input.name,
                  "ingest.source.depth_files", "e.g. '{name}/MDepth-{frame:8}.png'");
    }
    for (Sensor& sensor : sensors) {
      const bool own = std::all_of(fields->begin(), fields->end(), [&](const auto& field) {
        const auto same = sensor.file->fields.find(field.first);
        return same == sensor.file->fields.end() || same->second == field.second;
      });
      const auto frames = static_cast<long long>(sensor.skeleton.frames.size());
      if (!own || *number < 1 || *number > frames) continue;
      sensor.images.resize(static_cast<std::size_t>(frames), nullptr);
      sensor.images[static_cast<std::size_t>(*number - 1)] = &input;
    }
  }
  return {};
}

/// Frame of a camera that is nearest to a frame of the reference.
int FrameOfView(int frame, const ViewAlignment& alignment, double rate_hz) {
  return static_cast<int>(std::lround(frame - alignment.offset_s * rate_hz));
}

/// The frames of the reference that all cameras cover, with images where they have any.
struct SharedFrames {
  int begin = 0, end = 0;
};

bool HasImage(const Sensor& sensor, int frame) {
  return frame >= 0 && frame < static_cast<int>(sensor.images.size()) &&
         sensor.images[static_cast<std::size_t>(frame)] != nullptr;
}

SharedFrames Covered(const SharedFrames& span, const std::function<bool(int)>& has) {
  SharedFrames covered = span;
  while (covered.begin < covered.end && !has(covered.begin)) ++covered.begin;
  while (covered.begin < covered.end && !has(covered.end - 1)) --covered.end;
  return covered;
}

/// Intrinsics of a camera whose axes are x right, y down, z forward, and their source.
Camera SensorCamera(const Sensor& sensor, const SourceOptions& source, std::vector<Finding>& findings,
                    std::string& from) {
  Camera camera;
  camera.name = sensor.file->view;
  camera.width = static_cast<int>(source.views.image_size[0]);
  camera.height = static_cast<int>(source.views.image_size[1]);
  const std::vector<double>& nominal = source.views.intrinsics;
  camera.fx = nominal[0], camera.fy = nominal[1], camera.cx = nominal[2], camera.cy = nominal[3];
  const std::optional<std::array<double, 4>> measured = NtuIntrinsics(sensor.skeleton);
  from = "declared, nominal";
  if (!measured) return camera;
  from = "measured from the joints' positions and pixels";
  camera.fx = -(*measured)[0], camera.fy = (*measured)[1], camera.cx = (*measured)[2], camera.cy = (*measured)[3];
  const bool other = std::abs(camera.fx - nominal[0]) > kOtherFocal * std::abs(nominal[0]) ||
                     std::abs(camera.fy - nominal[1]) > kOtherFocal * std::abs(nominal[1]) ||
                     std::abs(camera.cx - nominal[2]) > kOtherCentre || std::abs(camera.cy - nominal[3]) > kOtherCentre;
  if (other) {
    findings.push_back(MakeFinding(
        "intrinsics_contradiction", Severity::kWarning, camera.fx,
        "the joints of " + camera.name + " project as in a camera with fx " + RoundedText(camera.fx, 5) + ", fy " +
            RoundedText(camera.fy, 5) + ", cx " + RoundedText(camera.cx, 5) + ", cy " + RoundedText(camera.cy, 5) +
            " px; declared are " + RoundedText(nominal[0], 5) + ", " + RoundedText(nominal[1], 5) + ", " +
            RoundedText(nominal[2], 5) + ", " + RoundedText(nominal[3], 5) + "; the measured ones are used",
        FindingAction::kKept));
  }
  return camera;
}

Expected<DepthView> ViewOf(const Sensor& sensor, Camera camera, const SourceFile& file, const ViewAlignment& alignment,
                           const Quaterniond& canonical_from_sensor, const SharedFrames& span, FrameRate rate) {
  DepthView view;
  // The sensor's axes are x to its left, y up, z away; the camera's x right, y down, z forward.
  const RigidTransform camera_from_sensor{Quaterniond(0.0, 0.0, 0.0, 1.0), Vector3d::Zero()};
  const RigidTransform canonical{canonical_from_sensor, Vector3d::Zero()};
  camera.camera_from_world = camera_from_sensor * Inverse(canonical) * Inverse(alignment.a_from_b);
  view.camera = std::move(camera);
  view.metres_per_unit = file.source.depth_unit;
  for (int f = span.begin; f < span.end; ++f) {
    const int own = FrameOfView(f, alignment, rate.hz());
    const double time_s = rate.FrameTime(own) + alignment.offset_s - rate.FrameTime(span.begin);
    Status added = AddDepthImage(*sensor.images[static_cast<std::size_t>(own)], time_s, view);
    if (!added) return Forward(added);
  }
  return view;
}

void NoteEstimates(const PlacedViews& placed, const std::vector<Sensor>& sensors, Clip& clip) {
  clip.provenance["view.reference"] = sensors[placed.reference].file->view;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const std::string key = "view." + sensors[i].file->view;
    const PlacedView& view = placed.views[i];
    clip.provenance[key] = view.used ? "used" : "excluded";
    if (!view.used || i == placed.reference) continue;
    const ViewAlignment& a = view.alignment;
    clip.provenance[key + ".offset_ms"] = RoundedText(1e3 * a.offset_s, 4);
    clip.provenance[key + ".offset_sigma_ms"] = a.offset_known ? RoundedText(1e3 * a.offset_sigma_s, 3) : "unknown";
    clip.provenance[key + ".disagreement_mm"] = RoundedText(1e3 * a.median, 4);
    clip.provenance[key + ".agreeing_share"] = RoundedText(a.share, 3);
    clip.provenance[key + ".joints_compared"] = std::to_string(a.pairs);
  }
}

/// The evidence of the clip: "tracks of 3 cameras, depth of 2", "tracks of 1 camera".
std::string EvidenceOf(long long tracks, long long depth) {
  return "tracks of " + Counted(tracks, "camera") + (depth > 0 ? ", depth of " + std::to_string(depth) : "");
}

Status AddDepth(const SourceFile& file, const std::vector<Sensor>& sensors, const PlacedViews& placed,
                const Quaterniond& canonical_from_sensor, const std::vector<char>& with_depth, const SharedFrames& span,
                IngestedClip& ingested) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (with_depth[i] == 0) continue;
    int missing = 0;
    for (int f = span.begin; f < span.end; ++f) {
      missing += HasImage(sensors[i], FrameOfView(f, placed.views[i].alignment, ingested.clip.rate.hz())) ? 0 : 1;
    }
    const std::string& name = sensors[i].file->view;
    if (missing > 0) {
      ingested.findings.push_back(MakeFinding("depth_excluded", Severity::kWarning, missing,
                                              name + " lacks the depth images of " + std::to_string(missing) + " of " +
                                                  Counted(span.end - span.begin, "frame"),
                                              FindingAction::kExcluded));
      continue;
    }
    std::string from;
    Camera camera = SensorCamera(sensors[i], file.source, ingested.findings, from);
    ingested.clip.provenance["view." + name + ".intrinsics"] = from;
    Expected<DepthView> view = ViewOf(sensors[i], std::move(camera), file, placed.views[i].alignment,
                                      canonical_from_sensor, span, ingested.clip.rate);
    if (!view) return Forward(view);
    ingested.clip.evidence.depth_views.push_back(std::move(*view));
  }
  return {};
}

void NoteMissing(const SourceOptions& source, const std::vector<Sensor>& sensors, std::vector<Finding>& findings) {
  for (const std::string& camera : source.views.cameras) {
    const bool there =
        std::any_of(sensors.begin(), sensors.end(), [&](const Sensor& sensor) { return sensor.file->view == camera; });
    if (there) continue;
    findings.push_back(MakeFinding("camera_missing", Severity::kWarning, static_cast<double>(sensors.size()),
                                   "there is no file of " + camera, FindingAction::kFlagged));
  }
}

}  // namespace

Expected<IngestedClip> ReadNtuViewsClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<Quaterniond> axes = RotationOfAxes(source.axes);
  if (!axes) return Forward(axes);
  IngestedClip ingested;
  Clip& clip = ingested.clip;
  clip.rate = FrameRate::FromHz(*source.rate_hz);
  const double rate_hz = clip.rate.hz();
  const auto wanted = static_cast<std::size_t>(std::max(1, file.named.bodies));
  std::vector<Sensor> sensors;
  std::vector<CameraPeople> cameras;
  for (const ViewFile& view : file.views) {
    Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(view.bytes, view.name, source.damaged_rows);
    if (!skeleton) return Forward(skeleton);
    Expected<People> people = NtuPeople(*skeleton, source, wanted);
    if (!people) return Forward(people);
    for (std::vector<Finding>* findings : {&skeleton->findings, &people->findings}) {
      for (Finding& finding : *findings) finding.message = view.view + ": " + finding.message;
      ingested.findings.insert(ingested.findings.end(), findings->begin(), findings->end());
    }
    cameras.push_back({view.view, static_cast<int>(skeleton->frames.size()), std::move(people->chosen)});
    if (const std::optional<long long> first = FirstFrameOf(source, view.view)) {
      cameras.back().first = static_cast<int>(std::clamp(*first - 1, -kMostFirst, kMostFirst));
      cameras.back().declared = true;
    }
    sensors.push_back({&view, std::move(*skeleton), {}});
  }
  NoteMissing(source, sensors, ingested.findings);
  const Expected<PlacedViews> placed = PlaceViews(cameras, source.views, rate_hz, file.name);
  if (!placed) return Forward(placed);
  ingested.findings.insert(ingested.findings.end(), placed->findings.begin(), placed->findings.end());
  if (Status sorted = SortImages(file, sensors); !sorted) return Forward(sorted);

  const SharedFrames whole{0, cameras[placed->reference].frames};
  SharedFrames span = whole;
  std::vector<char> with_depth(sensors.size(), 0);
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const PlacedView& view = placed->views[i];
    if (!view.used) continue;
    with_depth[i] = !sensors[i].images.empty();
    const auto shorten = [&](const std::function<bool(int)>& has) {
      const SharedFrames covered = Covered(span, has);
      if (covered.end - covered.begin >= kLeastCovered * whole.end) span = covered;
    };
    shorten([&](int f) {
      const int own = FrameOfView(f, view.alignment, rate_hz);
      return own >= 0 && own < cameras[i].frames;
    });
    if (with_depth[i] != 0)
      shorten([&](int f) { return HasImage(sensors[i], FrameOfView(f, view.alignment, rate_hz)); });
  }

  const auto slot = static_cast<std::size_t>(std::max(1, file.named.body)) - 1;
  JointTracks tracks;
  std::string ids;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const PlacedView& view = placed->views[i];
    if (!view.used || slot >= view.slots.size() || view.slots[slot] < 0) continue;
    ids += (ids.empty() ? "" : " ") + cameras[i].view + ":" +
           cameras[i].people[static_cast<std::size_t>(view.slots[slot])].Name();
  }
  if (ids.empty()) {
    return Fail(
        ErrorCode::kInconsistent,
        "body " + std::to_string(slot + 1) + " of " + std::to_string(wanted) + " is in none of the cameras used",
        file.name, "the trackers lost the person: remove the capture, or correct ingest.source.bodies");
  }
  tracks = MergePerson(cameras, *placed, slot, span.begin, span.end, rate_hz);
  tracks.names = NtuJointNames();
  if (std::all_of(tracks.confidence.begin(), tracks.confidence.end(), [](double c) { return c == 0.0; })) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(span.end - span.begin, "frame"),
                file.name, "the trackers lost the person: remove the capture", Reason::kNoValidSamples);
  }
  NoteEmptyFrames(tracks, ingested.findings);
  clip.evidence.tracks = std::move(tracks);
  clip.provenance["body_id"] = ids;
  if (span.begin > 0) clip.provenance["view.first_frame"] = std::to_string(span.begin);
  NoteEstimates(*placed, sensors, clip);
  Status depth = AddDepth(file, sensors, *placed, *axes, with_depth, span, ingested);
  if (!depth) return Forward(depth);
  const auto used =
      std::count_if(placed->views.begin(), placed->views.end(), [](const PlacedView& v) { return v.used; });
  clip.provenance["evidence"] = EvidenceOf(used, static_cast<long long>(clip.evidence.depth_views.size()));
  return ingested;
}

}  // namespace mocurate
