#include "core/base/renamed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/config.h"
#include "core/base/finding.h"

namespace mocurate {
namespace {

struct RepairLikeOptions {
  bool position_jumps = true;
  double rotation_process_noise = 0.5;
  int action = 0;

  void Declare(OptionVisitor& v) {
    v.Bool("position_jumps", position_jumps, "");
    v.Number("rotation_process_noise", rotation_process_noise, Unit::kNone, {0.0, 10.0}, "");
    v.Choice("action", action, {{"off", 0}, {"report", 1}, {"exclude", 2}}, "");
  }
};

Expected<RepairLikeOptions> ReadText(const std::string& text) {
  Expected<ConfigNode> node = LoadConfig(ConfigSource{text, "old.yaml", {}});
  if (!node) return Forward(node);
  return OptionsFromConfig<RepairLikeOptions>(*node);
}

TEST(Renamed, FormerNamesOfOptionsAndChoicesAreRead) {
  const auto read = ReadText("teleports: false\nrotation_walk: 2\naction: tell\n");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_FALSE(read->position_jumps);
  EXPECT_EQ(read->rotation_process_noise, 2.0);
  EXPECT_EQ(read->action, 1);
}

TEST(Renamed, AFormerNameBesideTheNewOneIsRefused) {
  const auto read = ReadText("position_jumps: true\nteleports: false\n");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kConfig);
  EXPECT_NE(read.error().Message().find("old.yaml:2:1"), std::string::npos) << read.error().Message();
}

TEST(Renamed, AFormerNameIsUnknownWhereItsOptionIsNot) { EXPECT_FALSE(ReadText("together: true\n")); }

TEST(Renamed, OptionsOfACheckpointAreReadByTheirFormerNames) {
  const nlohmann::json stored = {{"teleports", false}, {"rotation_walk", 3.0}, {"action", "leave_out"}};
  const auto read = OptionsFromJson<RepairLikeOptions>(stored, "checkpoint");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_FALSE(read->position_jumps);
  EXPECT_EQ(read->rotation_process_noise, 3.0);
  EXPECT_EQ(read->action, 2);
}

TEST(Renamed, FindingsOfADatasetHaveTheirNewCodes) {
  nlohmann::json stored = MakeFinding("position_jump", Severity::kError, 1.0, "");
  stored["code"] = "teleport";
  EXPECT_EQ(stored.get<Finding>().code, "position_jump");
}

TEST(Renamed, NoNewNameIsAFormerOne) {
  for (const std::string_view former : {"teleport", "held_joint", "together", "tell", "left_out"}) {
    const std::string_view now = NewNameOf(former);
    ASSERT_FALSE(now.empty()) << former;
    EXPECT_TRUE(NewNameOf(now).empty()) << now;
    const auto all = FormerNamesOf(now);
    EXPECT_NE(std::find(all.begin(), all.end(), former), all.end()) << now;
  }
}

}  // namespace
}  // namespace mocurate
