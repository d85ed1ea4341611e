#include <gtest/gtest.h>

#include "core/base/random.h"
#include "tests/fuzz/fuzz_config.cpp"

namespace mocurate {
namespace {

const std::vector<std::string>& Corpus() {
  static const std::vector<std::string> corpus = {
      "seed: 12\nheight: 180 cm\ntitle: \"a ${seed}\"\nlabels: {a01: walk}\ntrim:\n  enabled: false\n",
      "joints: [{name: x}, {name: '2', weight: 5}]\npeople: &p [a, b]\nlabels: {x: y}\n",
      "angle: 30 deg\nstep: 1/30 s\nrate: 25 fps\noffsets:\n- 10 cm\n- -0.5\n# remark\nloss: huber\n",
      "title: |\n  two\n  lines\npath: ${title}/x\nsize: 10 MB\nlimit: null\n",
      std::string("trim: {still_speed: 1}\0trim.still_speed=2 m/s", 46),
      "include: [none.yaml, resource:none.yaml]\n<<: *x\n? [a]\n: b\n--- !!tag &a x\n",
  };
  return corpus;
}

std::string Mutated(Random& random) {
  std::string text = Corpus()[random.Below(Corpus().size())];
  const std::uint64_t count = 1 + random.Below(6);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::size_t place = random.Below(text.size() + 1);
    switch (random.Below(5)) {
      case 0:
        text.insert(place, 1, static_cast<char>(random.Below(256)));
        break;
      case 1:
        text.erase(place, random.Below(8));
        break;
      case 2:
        text.insert(place, text.substr(random.Below(text.size() + 1), random.Below(20)));
        break;
      case 3:
        text.insert(place, 1, "{}[]:-#&*!|>'\"%@`,?\n \t$.0"[random.Below(25)]);
        break;
      default: {
        const std::string& other = Corpus()[random.Below(Corpus().size())];
        text.insert(place, other.substr(random.Below(other.size()), random.Below(30)));
      }
    }
  }
  return text;
}

TEST(ConfigFuzz, NoInputBreaksTheReader) {
  for (int i = 0; i < 15000; ++i) {
    Random random(1, "config fuzz", std::to_string(i));
    const std::string text = Mutated(random);
    SCOPED_TRACE("input " + std::to_string(i));
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }
}

}  // namespace
}  // namespace mocurate
