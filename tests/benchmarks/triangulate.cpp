#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "fitting/triangulation/robust_triangulation.h"
#include "tests/benchmarks/json_line.h"

// Points per second of one core: bench_triangulate [CAMERAS [WRONG [FRAMES [REPEATS]]]]. 25 joints per frame, 4 px of
// noise, WRONG cameras 400 px off per joint; the time includes the undistortion of every detection. One JSON line.
namespace mocurate {
namespace {

Camera OnARing(int index, int count) {
  const double angle = 2.0 * 3.14159265358979 * index / count;
  const Vector3d centre(4.0 * std::sin(angle), 1.5 + 0.3 * (index % 3), 4.0 * std::cos(angle));
  const Vector3d forward = (Vector3d(0, 1, 0) - centre).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
  Matrix3d rows;
  rows << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  Camera camera;
  camera.width = 1920;
  camera.height = 1080;
  camera.fx = camera.fy = 1400;
  camera.cx = 960;
  camera.cy = 540;
  camera.distortion = {-0.1, 0.03, 0.001, -0.0005, 0.0};
  camera.camera_from_world.rotation = Quaterniond(rows);
  camera.camera_from_world.translation = -(camera.camera_from_world.rotation * centre);
  return camera;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  const auto argument = [&](int place, int otherwise) { return argc > place ? std::atoi(argv[place]) : otherwise; };
  const int cameras = argument(1, 4);
  const int wrong = argument(2, 0);
  const int frames = argument(3, 400);
  constexpr int kJoints = 25;
  Random random(7, "triangulate");
  std::vector<ViewKeypoints> views(cameras);
  for (int c = 0; c < cameras; ++c) views[c].camera = OnARing(c, cameras);
  std::vector<Vector3d> truth;
  for (int i = 0; i < frames * kJoints; ++i) {
    truth.emplace_back(random.Uniform(-0.5, 0.5), random.Uniform(0.2, 1.8), random.Uniform(-0.5, 0.5));
    const int first = static_cast<int>(random.Uniform(0, cameras));
    for (int c = 0; c < cameras; ++c) {
      Vector2d pixel = *views[c].camera.ProjectWorld(truth.back()) + 4.0 * Vector2d(random.Normal(), random.Normal());
      const bool off = (c - first + cameras) % cameras < wrong;
      const double angle = random.Uniform(0.0, 6.28);
      if (off) pixel += 400.0 * Vector2d(std::cos(angle), std::sin(angle));
      views[c].normalised.emplace_back(views[c].camera.Unproject(pixel, 1.0).head<2>());
      views[c].confidence.push_back(1.0);
    }
  }
  TriangulatedTracks tracks;
  const auto work = [&] { tracks = TriangulateViews(views, frames, kJoints, {}); };
  benchmarks::Report("triangulate", frames * kJoints, "points", argument(4, 5), work);
  std::vector<double> errors;
  for (int i = 0; i < frames * kJoints; ++i) {
    if (tracks.confidence[i] > 0.0) errors.push_back((tracks.positions.at(i / kJoints, i % kJoints) - truth[i]).norm());
  }
  std::sort(errors.begin(), errors.end());
  std::fprintf(stderr, "%d cameras, %d wrong: found %.4f, median %.1f mm, 95 %% %.1f mm\n", cameras, wrong,
               static_cast<double>(errors.size()) / (frames * kJoints), 1e3 * errors[errors.size() / 2],
               1e3 * errors[errors.size() * 95 / 100]);
}
