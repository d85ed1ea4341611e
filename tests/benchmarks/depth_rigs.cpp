// bench_depth_rigs [CLIPS [FRAMES [SEED [FOLDER [OPTION=NUMBER ...]]]]]: recall of the audit of depth views for a fault
// in the rig. Uses the clips of bench_fit_clouds, and its images if FOLDER has them. Without options there is no fault.
// moved=0.03 (metres) and turned=2 (degrees) move one camera of each clip. late=1 makes its images one frame late.
// exchanged=1 exchanges its files with the next camera's. all=1 moves every camera but the first. depths=1.1 scales the
// depths of all cameras; mirrored=1 mirrors all images (a refusal is correct). rig=1: rendered_seq; rig=2: rgbd100, 80
// views of one moment. Prints recall, other reports, camera errors before and after (at the person and at the camera),
// and seconds per clip.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>

#include "core/base/median.h"
#include "core/base/random.h"
#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/view_registration.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/given_takes.h"
#include "tests/benchmarks/options_without.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/depth_rig_faults.h"

namespace mocurate {
namespace {

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct RigTake {
  std::string name;
  std::vector<DepthView> views;
  Vector3d centre = Vector3d(0.0, 0.9, 0.0);
};

std::vector<RigTake> TakesOf(int rig, CloudTakeOptions wanted, const std::filesystem::path& folder) {
  std::vector<RigTake> takes;
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) return takes;
  if (rig == 1) {
    for (int begin = 0; begin + wanted.frames <= 48; begin += wanted.frames) {
      auto read = ReadRenderedSequence(std::filesystem::path(data) / "clouds" / "rendered_seq", 48);
      RigTake take{"rendered_seq from " + std::to_string(begin), read->clip.evidence.depth_views};
      take.centre = Vector3d::Zero();
      for (DepthView& view : take.views) {
        view.files.assign(view.files.begin() + begin, view.files.begin() + begin + wanted.frames);
        view.time_s.resize(view.files.size());
      }
      for (int j = 0; j < read->truth.joints; ++j) take.centre += read->truth.at(begin, j) / read->truth.joints;
      takes.push_back(std::move(take));
    }
    return takes;
  }
  if (rig == 2) {
    const auto views = TurntableViews(std::filesystem::path(data) / "rgbd100" / "views");
    if (!views) return takes;
    for (int i = 0; i < wanted.clips; ++i)
      takes.push_back({"turntable " + std::to_string(i), *views, Vector3d::Zero()});
    return takes;
  }
  for (CloudTake& take : CloudTakes(wanted, folder)) {
    Vector3d centre = Vector3d::Zero();
    for (int j = 0; j < take.clip.truth.joint_count(); ++j) {
      centre += Vector3d(take.clip.truth.joints.at(0, j)) / take.clip.truth.joint_count();
    }
    takes.push_back({take.clip.name, take.evidence.depth_views, centre});
  }
  return takes;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  CloudTakeOptions wanted;
  wanted.frames = 15;
  wanted.seed = 907;
  const std::filesystem::path folder = GivenTakes(argc, argv, "/tmp/bench_fit_clouds", wanted);
  std::map<std::string, double> given = GivenNumbers(argc, argv, 5);
  const std::vector<RigTake> takes = TakesOf(static_cast<int>(given["rig"]), wanted, folder);
  if (takes.empty()) return std::fprintf(stderr, "no clips: set MOCURATE_DATA\n"), 2;
  benchmarks::ClipLines lines(argc, argv);
  double seconds = 0.0;
  int found = 0, wrong = 0, faulty = 0, audited_clips = 0, refused = 0;
  std::vector<double> before_mm, after_mm, before_deg, after_deg, loss, loss_after;
  for (std::size_t i = 0; i < takes.size(); ++i) {
    const RigTake& take = takes[i];
    std::vector<DepthView> views = take.views;
    Random random(wanted.seed, "rig fault", take.name);
    const std::size_t bad = random.Below(views.size());
    std::vector<bool> is_bad(views.size(), false);
    std::string code;
    if (given.count("moved") + given.count("turned") != 0) {
      code = "camera_moved";
      for (std::size_t v = 0; v < views.size(); ++v) {
        is_bad[v] = given["all"] != 0.0 ? v > 0 : v == bad;
        if (is_bad[v]) views[v].camera = Knocked(views[v].camera, given["moved"], given["turned"], random);
      }
    }
    if (given["late"] != 0.0) {
      code = "camera_clock_off";
      is_bad[bad] = true;
      views = WithClockOffset(std::move(views), bad, static_cast<int>(given["late"]));
    }
    if (given["exchanged"] != 0.0) {
      code = "cameras_exchanged";
      is_bad[bad] = true;
      ExchangeFiles(views[bad], views[(bad + 1) % views.size()]);
    }
    if (given["depths"] > 0.0) {
      code = "camera_depths_off";
      is_bad.assign(views.size(), true);
      for (DepthView& view : views) view.metres_per_unit *= given["depths"];
    }
    if (given["mirrored"] != 0.0) views = *WithMirroredImages(std::move(views), folder / "mirrored");
    PointCloudOptions options = benchmarks::OptionsWithout().point_clouds;
    if (given.count("sure") != 0) options.audit.sure = given["sure"];
    const double begin = CpuSeconds();
    const auto audited = AuditDepthRig(views, options.audit);
    seconds += CpuSeconds() - begin;
    if (!audited) {
      std::fprintf(stderr, "%s: %s\n", take.name.c_str(), audited.error().Message().c_str());
      ++refused;
      lines.Add(take.name, take.name, "rig", {{"refused", 1}});
      continue;
    }
    const int found_before = found, wrong_before = wrong;
    const std::size_t moved_before = after_mm.size();
    if (audited->report.not_audited.empty()) ++audited_clips;
    std::fprintf(stderr, "%-24s", take.name.c_str());
    for (std::size_t v = 0; v < std::min<std::size_t>(views.size(), 4); ++v) {
      std::fprintf(stderr, " %.3f>%.3f", audited->report.loss[v], audited->report.loss_after[v]);
    }
    loss.insert(loss.end(), audited->report.loss.begin(), audited->report.loss.end());
    loss_after.insert(loss_after.end(), audited->report.loss_after.begin(), audited->report.loss_after.end());
    std::fprintf(stderr, " of %s\n", code.empty() ? "nothing" : views[bad].camera.name.c_str());
    for (const RigFault& fault : audited->report.faults) {
      std::fprintf(stderr, "    %s: %s; %.4f\n", fault.code.c_str(), fault.message.c_str(), fault.confidence);
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
      bool is_reported = false, other = false;
      for (const RigFault& fault : audited->report.faults) {
        const bool names = fault.camera.find(views[v].camera.name) != std::string::npos;
        is_reported = is_reported || (names && fault.code == code);
        other = other || (names && fault.code != code);
      }
      faulty += is_bad[v] ? 1 : 0;
      found += is_bad[v] && is_reported ? 1 : 0;
      wrong += (!is_bad[v] && is_reported) || other ? 1 : 0;
      if (!is_bad[v] && audited->report.faults.empty()) continue;
      // Relative to the first camera without a fault: only relative poses are observed.
      const std::size_t still = given["all"] != 0.0 ? 0 : (bad + 1) % views.size();
      const auto off = [&](const std::vector<DepthView>& rig) {
        Camera is = rig[v].camera, was = take.views[v].camera;
        is.camera_from_world = is.camera_from_world * Inverse(rig[still].camera.camera_from_world);
        was.camera_from_world = was.camera_from_world * Inverse(take.views[still].camera.camera_from_world);
        return MoveBetween(was, is, take.views[still].camera.camera_from_world * take.centre);
      };
      const CameraMoveAt before = off(views), after = off(audited->views);
      if (!is_bad[v] && given["all"] != 0.0) continue;
      if (!is_bad[v]) continue;
      before_mm.push_back(1e3 * before.shift), after_mm.push_back(1e3 * after.shift);
      before_deg.push_back(57.2957795 * before.turn), after_deg.push_back(57.2957795 * after.turn);
    }
    nlohmann::json figures = {{"refused", 0},
                              {"found", found - found_before},
                              {"others_reported", wrong - wrong_before},
                              {"loss_after", MeanMedian(audited->report.loss_after)}};
    if (after_mm.size() > moved_before) {
      figures["camera_mm"] = MeanMedian(std::vector<double>(after_mm.begin() + moved_before, after_mm.end()));
    }
    lines.Add(take.name, take.name, "rig", figures, benchmarks::OutcomeOf(audited->report.faults));
  }
  const auto worst = [](const std::vector<double>& values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  };
  std::printf(
      "{\"name\": \"depth_rigs\", \"clips\": %zu, \"refused\": %d, \"audited\": %d, \"faulty\": %d, \"found\": %d, "
      "\"others_reported\": %d, "
      "\"loss\": %.4f, \"loss_after\": %.4f, \"person_off_mm\": %.1f, \"after_mm\": %.1f, \"worst_after_mm\": %.1f, "
      "\"turned_deg\": %.2f, \"after_deg\": %.2f, \"worst_after_deg\": %.2f, \"seconds_per_clip\": %.4f}\n",
      takes.size(), refused, audited_clips, faulty, found, wrong, MeanMedian(loss), MeanMedian(loss_after),
      MeanMedian(before_mm), MeanMedian(after_mm), worst(after_mm), MeanMedian(before_deg), MeanMedian(after_deg),
      worst(after_deg), seconds / static_cast<double>(takes.size()));
}
