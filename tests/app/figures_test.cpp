// What the papers' figures show: labels, rows and counts of every item's config, and of the pictures that a run makes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

/// The item `reproduce` of a figure's config.
nlohmann::json ItemOf(const std::string& id) {
  const ScratchFolder folder;
  const Result result = RunProgram(folder, {"config", "show", "papers/" + id, "--json"});
  EXPECT_EQ(result.exit_code, 0) << id << result.err;
  const nlohmann::json config = nlohmann::json::parse(result.out, nullptr, false);
  nlohmann::json item = config.is_object() ? config.at("reproduce") : nlohmann::json::object();
  item["networks"] = config.is_object() ? config.at("train").at("networks") : nlohmann::json::array();
  item["durations"] = config.is_object() ? config.at("evaluate").at("durations") : nlohmann::json::array();
  item["rows"] = config.is_object() ? config.at("evaluate").at("rows") : nlohmann::json::array();
  return item;
}

/// The motions that a figure shows, by its caption.
struct ShownMotions {
  const char* id;
  Texts rows, labels, scripts;
  int samples = 1, stills = 0;
};

const char* const kCatch = "throw,catch,throw,catch";
const char* const kRoam = "squat,walk,sit";
const char* const kPickUp = "pick up,run,place,stand";
const char* const kSquat = "squat,stand,jump,squat,jump";

TEST(Figures, MotionsHaveTheSourcesLabelsAndScriptsOfTheCaptions) {
  const ShownMotions figures[] = {
      {"a2m/figure1", {"Ours"}, {"throw", "warm_up"}, {}, 3},
      {"a2m/figure3", {"CondGRU zeros", "Two-stage GAN", "Act-MoCoGAN", "Ours w/o Lie", "Ours"}, {"warm_up"}, {}, 2},
      {"a2m/figure6", {"Ours"}, {"lift_dumbbell"}, {}, 1, 7},
      {"a2m/figure8", {"Ours w/o Lie", "Ours"}, {"walk"}, {}},
      {"actor/figure3", {"with", "without"}, {"left-stretching", "rope-skipping", "forward-lunging"}, {}},
      {"actor/figure5", {"ACTOR"}, {"throw"}, {}, 3, 20},
      {"multiact/figure1", {"MultiAct", "ACTOR"}, {}, {"bend down,pick up object,put down object,turn around"}},
      {"multiact/figure5", {"face-front", "zero-canonicalisation"}, {}, {"stand,bend down,stand,bend down,stand"}},
      {"multiact/figure7", {"MultiAct"}, {}, {kSquat, kCatch, kRoam, kPickUp}},
      {"multiact/figureA", {"MultiAct"}, {}, {"kick", "throw", "jump", "sit down", "squat", "turn around"}},
      {"multiact/figureB", {"MultiAct"}, {}, {kCatch, kRoam, kPickUp, kSquat}}};
  for (const ShownMotions& figure : figures) {
    const nlohmann::json item = ItemOf(figure.id);
    ASSERT_EQ(item.at("pictures").size(), 1U) << figure.id;
    const nlohmann::json& picture = item["pictures"][0];
    EXPECT_EQ(picture.at("rows").get<Texts>(), figure.rows) << figure.id;
    EXPECT_EQ(picture.at("labels").get<Texts>(), figure.labels) << figure.id;
    EXPECT_EQ(picture.at("scripts").get<Texts>(), figure.scripts) << figure.id;
    EXPECT_EQ(picture.at("samples"), figure.samples) << figure.id;
    if (figure.stills > 0) {
      EXPECT_EQ(picture.at("stills"), figure.stills) << figure.id;
    }
  }
  const nlohmann::json further = ItemOf("actor/figureA1").at("pictures");
  ASSERT_EQ(further.size(), 2U);
  EXPECT_EQ(further[0]["labels"].get<Texts>(), (Texts{"side_kick", "stand_up"}));
  EXPECT_EQ(further[1]["labels"].get<Texts>(), (Texts{"punching-and-knee-lifting", "spinal-stretching"}));
  for (const nlohmann::json& picture : further) EXPECT_EQ(picture["samples"], 3);
}

TEST(Figures, WhatTellsTheirRowsApartIsThatOfTheCaptions) {
  const nlohmann::json skeletons = ItemOf("a2m/figure6")["pictures"][0]["skeletons"];
  Texts scales;
  for (const nlohmann::json& skeleton : skeletons) scales.push_back(skeleton["scale"]);
  EXPECT_THAT(scales, ElementsAre("", "", "legs=1.25", "arms=1.25", "all=1.25"));
  EXPECT_NE(skeletons[0]["person"], skeletons[1]["person"]);
  for (int k = 2; k < 5; ++k) EXPECT_EQ(skeletons[k]["person"], skeletons[1]["person"]);

  const nlohmann::json training = ItemOf("a2m/figure8");
  EXPECT_EQ(training["pictures"][0]["over_training"], true);
  for (const nlohmann::json& network : training["networks"]) {
    const bool lie = network["name"] == "Ours";
    if (!lie && network["name"] != "Ours w/o Lie") continue;
    EXPECT_EQ(network["samples_at"], lie ? nlohmann::json({5000, 10000}) : nlohmann::json({10000, 100000}));
    EXPECT_EQ(network["iterations"], lie ? 40000 : 500000);
  }
  int without = 0;
  const nlohmann::json paths = ItemOf("actor/figure3");
  for (const nlohmann::json& network : paths["networks"]) {
    EXPECT_EQ(network["translation"], network["name"] == "with");
    without += network["name"] == "without" ? 1 : 0;
  }
  EXPECT_EQ(without, 1);
  const nlohmann::json long_one = ItemOf("multiact/figure1")["pictures"][0];
  EXPECT_TRUE(long_one["absent"].contains("MOJO"));
  EXPECT_EQ(long_one["words"]["pick up object"], "grab and lift");
  const nlohmann::json drift = ItemOf("multiact/figure5")["pictures"][0];
  EXPECT_EQ(drift["colours"], nlohmann::json({{"face-front", "red"}, {"zero-canonicalisation", "blue"}}));
  EXPECT_EQ(drift["world"], true);
  EXPECT_EQ(ItemOf("multiact/figureA")["pictures"][0]["continues"], true);
  EXPECT_EQ(ItemOf("multiact/figureB")["pictures"][0]["themes"].size(), 4U);
  EXPECT_EQ(ItemOf("multiact/figure7")["pictures"][0]["themes"].size(), 4U);
  const nlohmann::json placed = ItemOf("multiact/figure4");
  EXPECT_EQ(placed["pictures"][0]["canonicalisation"], true);
  EXPECT_EQ(placed["networks"].size(), 0U) << "no network";
}

TEST(Figures, CurvesAndStudiesAreThoseOfTheCaptions) {
  const nlohmann::json durations = ItemOf("actor/figure4");
  ASSERT_EQ(durations["durations"].size(), 17U);
  EXPECT_EQ(durations["durations"][1], 45);
  ASSERT_EQ(durations["plots"].size(), 2U);
  EXPECT_EQ(durations["plots"][0]["solid"], nlohmann::json({60, 60}));
  EXPECT_EQ(durations["plots"][1]["solid"], nlohmann::json({60, 100}));
  EXPECT_EQ(ItemOf("actor/figure6")["plots"].size(), 1U);
  EXPECT_EQ(ItemOf("actor/figure6")["plots"][0]["curves"].size(), 2U);
  const nlohmann::json steps = ItemOf("multiact/figure6");
  ASSERT_EQ(steps["plots"].size(), 2U);
  EXPECT_EQ(steps["plots"][0]["curves"].size(), 2U);
  EXPECT_EQ(steps["plots"][1]["curves"].size(), 4U);
  for (const nlohmann::json& row : steps["rows"]) EXPECT_EQ(row["steps"], 20);

  const nlohmann::json ranked = ItemOf("a2m/figure4")["surveys"], judged = ItemOf("a2m/figure5")["surveys"];
  EXPECT_EQ(ranked[0]["kind"], "ranking");
  EXPECT_THAT(ranked[0]["rows"].get<Texts>(),
              UnorderedElementsAre("Real", "Ours", "Ours w/o Lie", "Act-MoCoGAN", "Two-stage GAN", "CondGRU zeros"));
  EXPECT_EQ(judged[0]["kind"], "real_or_fake");
  EXPECT_EQ(judged[0]["rows"].get<Texts>(), (Texts{"Real", "Ours"}));
  EXPECT_EQ(judged[0]["skeleton"], "smpl24") << "skinned bodies";
  const nlohmann::json screens = ItemOf("a2m/figure9");
  EXPECT_EQ(screens["surveys"].size(), 2U);
  EXPECT_EQ(screens["screens"], true);
}

/// A figure in profile smoke: what its picture NAME shows.
nlohmann::json Drawn(const ScratchFolder& folder, const std::string& id, const std::string& name) {
  const std::string place = folder / id.substr(id.find('/') + 1);
  const Result result =
      RunProgram(folder, {"reproduce", id, "--profile", "smoke", "--json", "-o", place, "--jobs", "1"});
  EXPECT_EQ(result.exit_code, 0) << id << ": " << result.err;
  for (const char* ending : {".svg", ".png"}) {
    EXPECT_GT(fs::file_size(fs::path(place) / "pictures" / (name + ending)), 5000U) << id;
  }
  return nlohmann::json::parse(ReadText(fs::path(place) / "pictures" / (name + ".json")), nullptr, false);
}

Texts SourcesOf(const nlohmann::json& picture) {
  Texts sources;
  for (const nlohmann::json& row : picture.at("rows")) sources.push_back(row.at("source"));
  return sources;
}

TEST(Figures, PicturesShowOneMotionOnFiveSkeletonsAndTheStepsOfTraining) {
  const ScratchFolder folder;
  const nlohmann::json skeletons = Drawn(folder, "a2m/figure6", "skeletons");
  ASSERT_EQ(skeletons.at("rows").size(), 5U);
  EXPECT_EQ(skeletons["corner"], "profile smoke; humanact12: stand-in by the studio");
  for (const nlohmann::json& row : skeletons["rows"]) {
    EXPECT_EQ(row["label"], "lift_dumbbell");
    EXPECT_EQ(row["frames"], nlohmann::json({{0, 9, 19, 29, 39, 49, 59}})) << "1, 10, 20 to 60, counted from 1";
  }
  const auto bones = [&](int row) { return skeletons["rows"][row]["clips"][0]["bones_m"].get<double>(); };
  EXPECT_NEAR(bones(4) / bones(1), 1.25, 1e-3) << "all bones";
  for (const int row : {2, 3}) {
    EXPECT_GT(bones(row), 1.02 * bones(1)) << "legs or arms alone";
    EXPECT_LT(bones(row), 1.2 * bones(1));
  }
  const nlohmann::json training = Drawn(folder, "a2m/figure8", "training");
  EXPECT_THAT(SourcesOf(training), ElementsAre("Ours w/o Lie, 1 iteration", "Ours w/o Lie, 2 iterations",
                                               "Ours, 1 iteration", "Ours, 2 iterations"));
  EXPECT_EQ(training["rows"][0]["column"], "Ours w/o Lie");
}

TEST(Figures, LongMotionsHaveTheirPartsAndARowForWhatIsMissing) {
  const ScratchFolder folder;
  const nlohmann::json long_one = Drawn(folder, "multiact/figure1", "long");
  EXPECT_THAT(SourcesOf(long_one), ElementsAre("MultiAct", "ACTOR", "MOJO"));
  EXPECT_EQ(long_one["rows"][0]["segments"].size(), 7U) << "four actions, three transitions";
  EXPECT_EQ(long_one["rows"][0]["segments"][2]["label"], "grab and lift");
  EXPECT_EQ(long_one["rows"][1]["clips"].size(), 4U) << "single actions";
  EXPECT_EQ(long_one["rows"][2]["absent"], "no code in this project");
  const nlohmann::json steps = Drawn(folder, "multiact/figureA", "steps");
  ASSERT_EQ(steps["rows"].size(), 6U);
  for (const nlohmann::json& row : steps["rows"]) {
    ASSERT_EQ(row["segments"].size(), 3U);
    EXPECT_EQ(row["segments"][0]["origin"], "recorded");
    EXPECT_EQ(row["segments"][1]["label"], "transition");
  }
  const nlohmann::json themes = Drawn(folder, "multiact/figureB", "themes");
  ASSERT_EQ(themes["rows"].size(), 4U);
  EXPECT_EQ(themes["rows"][1]["theme"], "roam and sit");
  const nlohmann::json placed = Drawn(folder, "multiact/figure4", "canonicalisation");
  EXPECT_THAT(SourcesOf(placed), ElementsAre("before", "face-front", "face-front", "zero"));
}

}  // namespace
}  // namespace mocurate
