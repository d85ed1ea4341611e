// One Action2Motion training step (forward, backward, Adam), batch 128, 60 frames, HumanAct12 sizes: prints one JSON
// line of the form that the Python reference prints. Arguments: lie | plain [repeats].

#include <cstdlib>
#include <string>

#include "tests/benchmarks/json_line.h"
#include "tests/train/chains.h"
#include "train/checkpoint/adam.h"
#include "train/networks/action2motion.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  const bool lie = argc < 2 || std::string(argv[1]) == "lie";
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 5;
  Action2MotionConfig config;
  if (lie) config.lie = HumanAct12Chains();
  ParameterList parameters = Action2MotionParameters(config);
  Random random(0, "benchmark");
  Initialise(parameters, random);
  Action2MotionBatch batch;
  batch.batch = 128;
  batch.frames = 60;
  batch.motion.resize(static_cast<std::size_t>(128) * 60 * 72);
  for (float& value : batch.motion) value = static_cast<float>(random.Uniform(-0.5, 0.5));
  for (int b = 0; b < 128; ++b) batch.label.push_back(b % 12);
  batch.noise.resize(static_cast<std::size_t>(128) * 60 * 30);
  for (float& value : batch.noise) value = static_cast<float>(random.Normal());
  Adam adam;
  AdamOptions options;
  options.learning_rate = 2e-4;
  options.weight_decay = 1e-5;
  benchmarks::Report(lie ? "a2m_step_lie" : "a2m_step_plain", 128, "sequences", repeats, [&] {
    Action2MotionStep(config, batch, parameters);
    adam.Step(options, parameters);
  });
  return 0;
}
