// 3,000 motions of 60 frames from the full-size prior and Lie decoder, kinematics included: one JSON line.

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "tests/benchmarks/json_line.h"
#include "tests/train/chains.h"
#include "train/checkpoint/checkpoint.h"
#include "train/generators/motion_generator.h"
#include "train/trainer/generator_rules.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  const LieChains chains = HumanAct12Chains();
  const LieLayer layer(chains, LieExp::kReleased);
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "humanact12";
  skeleton->lie = chains;
  for (int j = 0; j < 24; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j == 0 ? -1 : layer.parents()[static_cast<std::size_t>(j)];
    joint.rest_offset = 0.2 * chains.raw_offsets[static_cast<std::size_t>(j)];
    joint.mirror = j;
    skeleton->joints.push_back(joint);
  }
  const GeneratorOptions options;
  Checkpoint checkpoint;
  checkpoint.kind = kAction2MotionKind;
  checkpoint.options = OptionsToJson(options);
  checkpoint.facts = {{"rate", "15"}};
  checkpoint.labels.assign(12, "label");
  checkpoint.skeleton = skeleton;
  checkpoint.parameters = Action2MotionParameters(ConfigOf(options, *skeleton, 12));
  Random random(0, "benchmark");
  Initialise(checkpoint.parameters, random);
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "mocurate_a2m_generate.h5";
  if (!WriteCheckpoint(checkpoint, path)) return 1;
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
  benchmarks::Report("a2m_generate_lie", 3000, "motions", argc > 1 ? std::atoi(argv[1]) : 3,
                     [&] { (void)(*generator)->Joints(requests); });
  return 0;
}
