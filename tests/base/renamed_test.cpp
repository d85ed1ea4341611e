#include "core/base/renamed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/finding.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

struct RepairLikeOptions {
  bool position_jumps = true;
  double rotation_process_noise = 0.5;
  int clocks = 0;
  std::string profile;

  void Declare(OptionVisitor& v) {
    v.Bool("position_jumps", position_jumps, "");
    v.Number("rotation_process_noise", rotation_process_noise, Unit::kNone, {0.0, 10.0}, "");
    v.Choice("clocks", clocks, {{"off", 0}, {"report", 1}, {"exclude", 2}}, "");
    v.Text("profile", profile, "");
  }
};

Expected<RepairLikeOptions> ReadText(const std::string& text) {
  Expected<ConfigNode> node = LoadConfig(ConfigSource{text, "old.yaml", {}});
  if (!node) return Forward(node);
  return OptionsFromConfig<RepairLikeOptions>(*node);
}

TEST(Renamed, FormerNamesOfOptionsAndChoicesAreRead) {
  const auto read = ReadText("teleports: false\nrotation_walk: 2\nclocks: tell\n");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_FALSE(read->position_jumps);
  EXPECT_EQ(read->rotation_process_noise, 2.0);
  EXPECT_EQ(read->clocks, 1);
}

TEST(Renamed, AFormerNameBesideTheNewOneIsRefused) {
  const auto read = ReadText("position_jumps: true\nteleports: false\n");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kConfig);
  EXPECT_NE(read.error().Message().find("old.yaml:2:1"), std::string::npos) << read.error().Message();
}

TEST(Renamed, AFormerNameIsUnknownWhereItsOptionIsNot) { EXPECT_FALSE(ReadText("together: true\n")); }

TEST(Renamed, OptionsOfACheckpointAreReadByTheirFormerNames) {
  const nlohmann::json stored = {{"teleports", false}, {"rotation_walk", 3.0}, {"clocks", "leave_out"}};
  const auto read = OptionsFromJson<RepairLikeOptions>(stored, "checkpoint");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_FALSE(read->position_jumps);
  EXPECT_EQ(read->rotation_process_noise, 3.0);
  EXPECT_EQ(read->clocks, 2);
}

TEST(Renamed, ACheckpointWithBothNamesIsRefused) {
  const nlohmann::json stored = {{"teleports", false}, {"position_jumps", true}};
  EXPECT_FALSE(OptionsFromJson<RepairLikeOptions>(stored, ""));
}

TEST(Renamed, ALaterLayerOverridesAnOptionByEitherName) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "former.yaml", "teleports: false\nrotation_walk: 1\n"));
  ASSERT_TRUE(WriteFile(folder / "now.yaml", "position_jumps: false\nrotation_process_noise: 1\n"));
  const auto read = [&](const std::string& text, const std::vector<std::string>& assignments) {
    Expected<ConfigNode> node = LoadConfig(ConfigSource{text, (folder / "own.yaml").native(), folder}, assignments);
    if (!node) return Expected<RepairLikeOptions>(tl::unexpected(node.error()));
    return OptionsFromConfig<RepairLikeOptions>(*node);
  };
  for (const std::string lower : {"former", "now"}) {
    for (const std::string jumps : {"teleports", "position_jumps"}) {
      for (const std::string noise : {"rotation_walk", "rotation_process_noise"}) {
        SCOPED_TRACE(lower + " " + jumps + " " + noise);
        const std::string include = "include: " + lower + ".yaml\n";
        const auto own = read(include + jumps + ": true\n" + noise + ": 3\n", {});
        ASSERT_TRUE(own) << own.error().Message();
        EXPECT_TRUE(own->position_jumps);
        EXPECT_EQ(own->rotation_process_noise, 3.0);
        const auto set = read(include, {jumps + "=true", noise + "=3"});
        ASSERT_TRUE(set) << set.error().Message();
        EXPECT_TRUE(set->position_jumps);
        EXPECT_EQ(set->rotation_process_noise, 3.0);
        const auto profile = read(include + "profile: a\nprofiles: {a: {" + jumps + ": true}}\n", {});
        ASSERT_TRUE(profile) << profile.error().Message();
        EXPECT_TRUE(profile->position_jumps);
      }
    }
    EXPECT_FALSE(read("include: " + lower + ".yaml\nteleports: true\nposition_jumps: true\n", {}));
  }
}

TEST(Renamed, ReferencesFollowEitherName) {
  Expected<ConfigNode> node =
      LoadConfig(ConfigSource{"a: {rotation_walk: 2}\nb: ${a.rotation_process_noise}\n", "old.yaml", {}});
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_EQ(node->Find("b")->scalar, "2");
}

struct OtherKindsOptions {
  bool coincident_limbs = true;
  int unit = 0, rows = 0;

  void Declare(OptionVisitor& v) {
    v.Bool("coincident_limbs", coincident_limbs, "");
    v.Choice("unit", unit, {{"off", 0}, {"report", 1}}, "");
    v.Choice("rows", rows, {{"off", 0}, {"report", 1}, {"suspect", 2}, {"excluded", 3}}, "");
  }
};

TEST(Renamed, ANameOfAnotherKindIsUnknown) {
  const auto reads = [](const std::string& text, const nlohmann::json& stored) {
    const auto node = LoadConfig(ConfigSource{text, "old.yaml", {}});
    const bool from_config = static_cast<bool>(OptionsFromConfig<OtherKindsOptions>(*node));
    EXPECT_EQ(from_config, static_cast<bool>(OptionsFromJson<OtherKindsOptions>(stored, "checkpoint"))) << text;
    return from_config;
  };
  EXPECT_TRUE(reads("merged: false", {{"merged", false}}));
  EXPECT_TRUE(reads("unit: tell", {{"unit", "tell"}}));
  EXPECT_FALSE(reads("limbs_in_one_place: false", {{"limbs_in_one_place", false}}));  // a code
  EXPECT_FALSE(reads("rows: tell", {{"rows", "tell"}}));                              // `rows` never had it
  EXPECT_FALSE(reads("rows: doubtful", {{"rows", "doubtful"}}));                      // an outcome
  EXPECT_FALSE(reads("rows: left out", {{"rows", "left out"}}));                      // an action
}

TEST(Renamed, FindingsOfADatasetHaveTheirNewCodes) {
  nlohmann::json stored = MakeFinding("position_jump", Severity::kError, 1.0, "");
  stored["code"] = "teleport";
  EXPECT_EQ(stored.get<Finding>().code, "position_jump");
}

TEST(Renamed, NoNewNameIsAFormerOne) {
  for (const NameKind kind : {NameKind::kCode, NameKind::kOption, NameKind::kChoice, NameKind::kOutcome,
                              NameKind::kAction, NameKind::kField}) {
    const auto& formers = FormerNames(kind);
    EXPECT_FALSE(formers.empty());
    for (const std::string_view former : formers) {
      std::string_view now = NewNameOf(kind, former);
      if (now.empty()) now = NewNameOf(kind, former, "unit");
      ASSERT_FALSE(now.empty()) << former;
      EXPECT_TRUE(NewNameOf(kind, now).empty()) << now;
      const auto all = FormerNamesOf(kind, now);
      EXPECT_NE(std::find(all.begin(), all.end(), former), all.end()) << now;
    }
  }
}

}  // namespace
}  // namespace mocurate
