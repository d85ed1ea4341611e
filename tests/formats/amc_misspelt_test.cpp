// AMC files with misspelt bone names.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/formats/amc.h"
#include "tests/formats/corruption.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

const char* const kAsf =
    ":version 1.10\n:name arm\n:units\n  mass 1\n  length 0.45\n  angle deg\n:root\n  order TX TY TZ RX RY RZ\n"
    "  axis XYZ\n  position 0 0 0\n  orientation 0 0 0\n:bonedata\n"
    "  begin\n    id 1\n    name upper\n    direction 1 0 0\n    length 2\n    axis 0 0 90 XYZ\n    dof rx rz\n  end\n"
    "  begin\n    id 3\n    name lower\n    direction 0 0 2\n    length 3\n    axis 0 0 0 XYZ\n    dof ry\n  end\n"
    ":hierarchy\n  begin\n    root upper\n    upper lower\n  end\n";

Expected<Amc> ReadArm(const std::string& text, const Asf& asf, DamagedRows damaged = DamagedRows::kRefuse) {
  return ParseAmc(text, {&asf, damaged}, "wave.amc");
}

std::string FiveSpelt() {
  std::string text = ":FULLY-SPECIFIED\n:DEGREES\n";
  for (int frame = 1; frame <= 5; ++frame)
    text += std::to_string(frame) + "\nroot 1 2 3 0 0 0\nupper 0 90\nlower " + std::to_string(10 * frame) + "\n";
  return text;
}

TEST(AmcMisspelt, DropsTheFrameOfAMisspeltBone) {
  const Asf asf = ParseAsf(kAsf, "arm.asf").value();
  const std::string text = FiveSpelt();
  for (const char* bone : {"root", "upper", "lower"}) {
    for (int frame = 0; frame < 5; ++frame) {
      std::string damaged = text;
      std::size_t at = text.find("\n" + std::to_string(frame + 1) + "\n");
      at = damaged.find(bone, at);
      damaged.replace(at, std::string(bone).size(), std::string(bone) + "r");
      const auto amc = ReadArm(damaged, asf, DamagedRows::kReport);
      ASSERT_TRUE(amc) << bone << frame << amc.error().Message();
      EXPECT_EQ(amc->frames, 5) << bone << frame;
      EXPECT_THAT(amc->damaged, ElementsAre(frame)) << bone;
      ASSERT_EQ(amc->findings.size(), 1u) << bone << frame;
      EXPECT_EQ(amc->findings[0].code, "bone_unknown");
      EXPECT_EQ(amc->findings[0].frame_begin, frame);
      EXPECT_EQ(amc->findings[0].joint, std::string(bone) + "r");
      const auto line = std::count(damaged.begin(), damaged.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
      ExpectMalformed(ReadArm(damaged, asf), "wave.amc:" + std::to_string(line));
    }
  }
}

TEST(AmcMisspelt, RejectsABoneThatIsMisspeltInMostFrames) {
  const Asf asf = ParseAsf(kAsf, "arm.asf").value();
  std::string text = FiveSpelt();
  // In the first frame only, and similar to no bone of the skeleton.
  ExpectMalformed(ReadArm(Replaced(text, "upper 0 90\n", "thigh 0 90\n"), asf, DamagedRows::kReport), "wave.amc:5");
  for (std::size_t at = 0; (at = text.find("upper", at)) != std::string::npos; at += 6) text.insert(at + 5, "r");
  ExpectMalformed(ReadArm(text, asf, DamagedRows::kReport), "wave.amc:5");
}

}  // namespace
}  // namespace mocurate
