// Files that a library reads (AMASS's .npz, through libzip), damaged in many ways, through the program and its workers:
// each fails alone, with a reason in the curation log, and the valid ones give the same result as without them.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/base/random.h"
#include "core/formats/amass.h"
#include "tests/app/program.h"
#include "tests/support/mutation.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;

constexpr int kDamaged = 40;
constexpr const char* kJob = R"(name: damaged
tolerated_failures: 1.0
fitting: {method: none}
ingest:
  path: data
  source:
    name: amass
    format: amass
    files: "{person}/{take}_poses.npz"
    axes: "+x -z +y"
    skeleton: smpl24
    person: "{person}"
    label: "{take}"
)";

std::string Walk() {
  Amass amass;
  amass.rate_hz = 60.0;
  amass.gender = "female";
  amass.frames = 30;
  amass.pose_columns = 156;
  for (std::size_t f = 0; f < amass.frames; ++f) {
    for (std::size_t c = 0; c < amass.pose_columns; ++c) {
      const double phase = 0.2 * static_cast<double>(f) + static_cast<double>(c);
      amass.poses.push_back(c == 0 ? 1.57 : c < 3 ? 0.0 : 0.1 * std::sin(phase));
    }
    for (const double x : {0.01 * static_cast<double>(f), 0.0, 0.9}) amass.translation_m.push_back(x);
  }
  amass.betas.assign(16, 0.0);
  return EncodeAmass(amass, "walk").value();
}

std::string Damaged(const std::string& whole, int copy, Random& random) {
  if (copy % 3 == 0) return whole.substr(0, random.Below(whole.size()));
  if (copy % 3 == 1) return test::Mutated(whole, random);
  std::string flipped = whole;
  flipped[random.Below(flipped.size())] ^= static_cast<char>(1 << random.Below(8));
  return flipped;
}

TEST(DamagedArchives, DoNotAffectOtherFiles) {
  const ScratchFolder folder;
  const std::string whole = Walk();
  Random random(3, "damaged archives");
  WriteText(folder / "data/p1/sound1_poses.npz", whole);
  WriteText(folder / "data/p2/sound2_poses.npz", whole);
  for (int i = 0; i < kDamaged; ++i) {
    WriteText(folder / ("data/p1/bad" + std::to_string(i) + "_poses.npz"), Damaged(whole, i, random));
  }
  WriteText(folder / "job.yaml", kJob);
  const Result result =
      RunProgram(folder, {"run", (folder / "job.yaml").string(), "-o", (folder / "run").string(), "--to", "ingest"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::ifstream log(folder / "run/curation_log.jsonl");
  int lines = 0, dropped = 0;
  std::set<std::string> sound;
  for (std::string line; std::getline(log, line); ++lines) {
    const nlohmann::json clip = nlohmann::json::parse(line);
    const std::string name = clip["clip"];
    if (name.find("sound") != std::string::npos) {
      ASSERT_TRUE(clip.contains("evidence_sha256")) << line;
      sound.insert(clip["source_sha256"].get<std::string>());
      continue;
    }
    if (clip["decision"] != "dropped") continue;
    ++dropped;
    EXPECT_FALSE(clip["reason"].get<std::string>().empty()) << line;
    EXPECT_NE(clip["rule"], "internal") << line;
  }
  EXPECT_EQ(lines, kDamaged + 2);
  EXPECT_EQ(sound.size(), 1u) << "the two sound ones hold the same";
  EXPECT_GT(dropped, kDamaged / 2);
}

}  // namespace
}  // namespace mocurate
