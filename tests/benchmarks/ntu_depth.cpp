// bench_ntu_depth [PEOPLE [SEED [FOLDER]]]: the studio's NTU folder (three Kinects v2 with their errors, masked depth,
// clocks up to 100 ms off). Ingest groups its views by the sensors' joint tracks; the audit then uses the depth images.
// Prints for each clip the camera errors (at the person, and in degrees) before and after the audit. Prints the fit of
// joints and clouds with both camera poses.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "core/base/median.h"
#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/clouds/view_registration.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/rigs.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

const Motion* TruthOfView(const std::map<std::string, Motion>& truth, const std::string& recording,
                          const std::string& camera) {
  for (const auto& [id, motion] : truth) {
    // S001C002P001R001A007 of the capture S001P001R001A007.
    if (id.find(recording.substr(0, 4) + camera + recording.substr(4)) != std::string::npos) return &motion;
  }
  return nullptr;
}

/// Error of the fit's joints against the truth in the reference camera's world, mm.
double ErrorOf(const Motion& fit, const Motion& truth, int begin) {
  const JointPositions places = PlacesOf(truth, Kinect25Places());
  const std::vector<std::string> names = NamesOf(Kinect25Places());
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < places.joints; ++k) {
    const auto joint = fit.skeleton->FindJoint(names[static_cast<std::size_t>(k)]);
    if (!joint) continue;
    for (int f = 0; f < std::min(fit.frame_count(), places.frames - begin); ++f, ++count) {
      sum += (fit.joints.at(f, *joint) - places.at(begin + f, k)).norm();
    }
  }
  return 1e3 * sum / count;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  StudioOptions studio;
  studio.layout = StudioLayout::kNtu;
  studio.subjects = argc > 1 ? std::atoi(argv[1]) : 2;
  studio.seed = argc > 2 ? std::atoi(argv[2]) : 5;
  studio.actions = {"throw", "sit_down", "hand_waving", "kick_something"};
  studio.tracker = KinectTracker();
  studio.rig.clock_offset_s = 0.1;
  if (const char* data = std::getenv("MOCURATE_DATA")) studio.body = fs::path(data) / "body_cc0" / "body_cc0.h5";
  const fs::path folder = argc > 3 ? argv[3] : "/tmp/bench_ntu_depth";
  if (!fs::exists(folder)) {
    if (!WriteStudioLayout(studio, folder / "set", 1)) return 1;
    StudioOptions still = studio;
    still.rig.clock_offset_s = 0.0;
    still.depth.enabled = false;
    if (!WriteStudioLayout(still, folder / "places", 1)) return 1;
  }
  const std::map<std::string, Motion> truth = TruthOf(folder / "set"), places = TruthOf(folder / "places");
  const IngestOptions ingest = Declared("ntu_views", {"ingest.path=" + (folder / "set").string()});
  const auto discovery = Discover(ingest);
  if (!discovery) return std::fprintf(stderr, "%s\n", discovery.error().Message().c_str()), 1;
  const SkeletonPtr skeleton = *LoadSkeleton("ntu25");
  const Quaterniond camera_from_canonical(0.0, 1.0, 0.0, 0.0);
  std::vector<double> before_mm, after_mm, before_deg, after_deg, tracks_mm, given_mm, audited_mm;
  int moved = 0, clocks = 0, others = 0;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "bench");
    if (!ingested.outcome) {
      std::fprintf(stderr, "%s: %s\n", item.item.c_str(), ingested.outcome.error().Message().c_str());
      continue;
    }
    Clip clip = ingested.clip;
    std::map<std::string, fs::path> files;
    for (const StageInput& input : item.inputs) {
      if (input.role == "depth") files[input.name] = input.path;
    }
    ResolveDepthFiles(files, clip.evidence);
    const std::string reference = clip.provenance["view.reference"];
    const std::vector<DepthView>& views = clip.evidence.depth_views;
    const auto audited = AuditDepthRig(views, {});
    if (!audited) {
      std::fprintf(stderr, "%s\n", audited.error().Message().c_str());
      continue;
    }
    std::fprintf(stderr, "%s, %zu views\n", clip.id().c_str(), views.size());
    for (const RigFault& fault : audited->report.faults) {
      std::fprintf(stderr, "    %s: %s\n", fault.code.c_str(), fault.message.c_str());
      ++(fault.code == "camera_moved" ? moved : fault.code == "camera_clock_off" ? clocks : others);
    }
    const std::string recording = clip.identity.recording;
    const Motion* world = TruthOfView(places, recording, reference);
    std::size_t still = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (views[v].camera.name.find(reference) != std::string::npos) still = v;
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (v == still) continue;
      const Motion* in_view = TruthOfView(places, recording, "C00" + std::to_string(v + 1));
      if (in_view == nullptr || world == nullptr) continue;
      const auto points = [](const Motion& motion) {
        return Eigen::Matrix3Xd(Eigen::Map<const Eigen::Matrix3Xd>(motion.joints.xyz.data(), 3, motion.joints.frames));
      };
      const RigidTransform world_from_view =
          AlignPoints(points(*in_view), points(*world), Eigen::VectorXd::Ones(points(*in_view).cols()));
      const auto off = [&](const std::vector<DepthView>& rig) {
        Camera is = rig[v].camera, was = rig[v].camera;
        const RigidTransform to_world =
            Inverse(rig[still].camera.camera_from_world) * RigidTransform{camera_from_canonical, Vector3d::Zero()};
        is.camera_from_world = is.camera_from_world * to_world;
        was.camera_from_world = RigidTransform{camera_from_canonical, Vector3d::Zero()} * Inverse(world_from_view);
        return MoveBetween(was, is, points(*world).rowwise().mean());
      };
      const CameraMoveAt before = off(views), after = off(audited->views);
      before_mm.push_back(1e3 * before.shift), after_mm.push_back(1e3 * after.shift);
      before_deg.push_back(57.2957795 * before.turn), after_deg.push_back(57.2957795 * after.turn);
      std::fprintf(stderr, "    %s: %.1f mm %.2f deg before, %.1f mm %.2f deg after, loss %.3f before, %.3f after\n",
                   views[v].camera.name.c_str(), before_mm.back(), before_deg.back(), after_mm.back(), after_deg.back(),
                   audited->report.loss[v], audited->report.loss_after[v]);
    }
    FittingOptions options;
    options.joint_tracks.solver = options.point_clouds.solver = PoseSolver::kBanded;
    options.joint_tracks.poses = true;
    const auto given_tracks = TracksOfClip(clip, skeleton, OtherJoints::kRefuse);
    if (!given_tracks) {
      std::fprintf(stderr, "    %s\n", given_tracks.error().Message().c_str());
      continue;
    }
    const auto person_bones = EstimateProportions({*given_tracks}, skeleton, ProportionsOptions{});
    const auto tracks = FitTracksOfClip(clip, person_bones.skeleton, person_bones.bone_length, options);
    if (!tracks) {
      std::fprintf(stderr, "    %s\n", tracks.error().Message().c_str());
      continue;
    }
    const Motion* person = TruthOfView(truth, recording, reference);
    const auto first = clip.provenance.find("view.first_frame");
    const int begin = first == clip.provenance.end() ? 0 : std::stoi(first->second);
    const auto both = [&](const std::vector<DepthView>& rig) {
      Clip given_rig = clip;
      given_rig.evidence.depth_views = rig;
      const auto clouds = FuseClip(given_rig, options.point_clouds);
      const auto fit = clouds ? FitTracksAndClouds(*tracks, *clouds, options.point_clouds)
                              : Expected<FitResult>(tl::unexpected<Error>(clouds.error()));
      if (!fit) std::fprintf(stderr, "    %s\n", fit.error().Message().c_str());
      return fit ? ErrorOf(fit->motion, *person, begin) : -1.0;
    };
    const double given = both(views), after = both(audited->views);
    if (given < 0.0 || after < 0.0) continue;
    tracks_mm.push_back(ErrorOf(tracks->motion, *person, begin));
    given_mm.push_back(given), audited_mm.push_back(after);
    std::fprintf(stderr, "    joints: tracks %.1f mm, with clouds as ingested %.1f, as audited %.1f\n",
                 tracks_mm.back(), given, after);
  }
  const auto mean = [](const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
  };
  std::printf(
      "{\"name\": \"ntu_depth\", \"clips\": %zu, \"camera_mm\": %.1f, \"after_mm\": %.1f, \"camera_deg\": %.2f, "
      "\"after_deg\": %.2f, \"median_mm\": %.1f, \"median_after_mm\": %.1f, \"moved_reported\": %d, "
      "\"clocks_reported\": %d, "
      "\"others_reported\": %d, \"tracks_mm\": %.1f, \"both_as_ingested_mm\": %.1f, \"both_audited_mm\": %.1f}\n",
      discovery->items.size(), mean(before_mm), mean(after_mm), mean(before_deg), mean(after_deg),
      MeanMedian(before_mm), MeanMedian(after_mm), moved, clocks, others, mean(tracks_mm), mean(given_mm),
      mean(audited_mm));
}
