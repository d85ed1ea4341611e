// 3,000 motions of 60 frames from the full-size prior and Lie decoder, kinematics included: one JSON line. Arguments:
// [repeats [threads]].

#include <cstdlib>
#include <filesystem>

#include "tests/benchmarks/json_line.h"
#include "tests/benchmarks/made_networks.h"
#include "train/generators/motion_generator.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "mocurate_a2m_generate.h5";
  if (!WriteCheckpoint(benchmarks::RandomCheckpoint(NetworkOptions(NetworkKind::kAction2Motion)), path)) return 1;
  const auto generator = MotionGenerator::Load(path);
  std::filesystem::remove(path);
  if (!generator) {
    std::fprintf(stderr, "%s\n", generator.error().Message().c_str());
    return 1;
  }
  std::vector<MotionRequest> requests(3000);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    requests[i].label = static_cast<int>(i % 12);
    requests[i].seed = i;
  }
  const int threads = argc > 2 ? std::atoi(argv[2]) : 1;
  benchmarks::Report(
      "a2m_generate_lie", 3000, "motions", argc > 1 ? std::atoi(argv[1]) : 3,
      [&] { (void)(*generator)->Joints(requests, threads); }, threads);
  return 0;
}
