// Depth images per second of one core: capsules and the skinned body, Kinect v2's image, with and without the sensor's
// errors and PNG. The skinned body needs MOCURATE_DATA. Usage: bench_depth_rendering [REPEATS]

#include <cstdlib>
#include <optional>

#include "core/formats/png.h"
#include "core/store/body_file.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/script.h"
#include "ingest/synthetic/sensors.h"
#include "tests/benchmarks/json_line.h"

namespace mocurate {
namespace {

constexpr int kFrames = 30;

Motion Walk(const Actor& actor) {
  Script script;
  Manner manner;
  manner.active_s = 2.0;
  script.actions = {{"walk", 0, kFrames, manner}};
  script.frames = kFrames;
  return PerformScript(script, actor.subject, actor.skeleton, FrameRate{15, 1});
}

void Measure(const char* name, const Actor& actor, bool with_sensor, int repeats) {
  const Camera camera = PhspdRig(1)[2];
  const std::vector<Vector2d> rays = PixelRays(camera);
  const std::vector<float> room = RoomDepth(camera, rays, 1.6);
  const Motion motion = Walk(actor);
  const BodyView body(actor);
  const DepthSensorOptions options;
  std::size_t bytes = 0;
  benchmarks::Report(name, kFrames, "frames", repeats, [&] {
    for (int f = 0; f < kFrames; ++f) {
      const std::vector<float> depth = body.Depth(motion, f, camera, rays);
      bytes += depth.size();
      if (with_sensor)
        bytes += EncodePng(SimulateDepth(depth, room, camera, rays, options, 1, std::to_string(f)))->size();
    }
  });
  if (bytes == 0) std::printf("no pixels were rendered\n");
}

int Run(int repeats) {
  StudioOptions options;
  const auto capsules = ActorsOf(options, 1, nullptr);
  if (!capsules) return std::fprintf(stderr, "%s\n", capsules.error().Message().c_str()), 1;
  Measure("capsules", capsules->front(), false, repeats);
  Measure("capsules, sensor, PNG", capsules->front(), true, repeats);
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) return 0;
  const auto body = ReadBodyTemplate(std::filesystem::path(data) / "body_cc0/body_cc0.h5");
  if (!body) return std::fprintf(stderr, "%s\n", body.error().Message().c_str()), 1;
  const auto skinned = ActorsOf(options, 1, &*body);
  if (!skinned) return std::fprintf(stderr, "%s\n", skinned.error().Message().c_str()), 1;
  Measure("skinned", skinned->front(), false, repeats);
  Measure("skinned, sensor, PNG", skinned->front(), true, repeats);
  return 0;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) { return mocurate::Run(argc > 1 ? std::atoi(argv[1]) : 5); }
