// Curves of how networks learned.

#include <gtest/gtest.h>

#include <cmath>

#include "report/charts.h"

namespace mocurate::test {
namespace {

nlohmann::json Row(const std::string& name, nlohmann::json steps, double fid, double accuracy, int motions = 100) {
  return {{"name", name},
          {"ours", {{"steps", std::move(steps)}}},
          {"metrics",
           {{"FID_equal", {{"value", fid}, {"real", 0.5}, {"real_sd", 0.1}, {"motions", motions}}},
            {"accuracy", {{"value", accuracy}, {"interval", {accuracy - 0.1, accuracy + 0.1}}}}}}};
}

nlohmann::json Of(const char* key, nlohmann::json value, nlohmann::json row) {
  row[key] = std::move(value);
  return row;
}

const PlotCurve* Curve(const Plot& plot, const std::string& name) {
  for (const PlotCurve& curve : plot.curves) {
    if (curve.name == name) return &curve;
  }
  return nullptr;
}

TEST(LearningSheet, EachSeedIsACurveOverItsStepsBesideTheLevelsOfRealMotions) {
  const nlohmann::json rows = {
      Of("real", true, Row("Real", nullptr, 9.0, 0.99)),
      Of("real", true, Row("Real-test", nullptr, 0.3, 0.95, 60)),
      Of("given", "motions", Row("Retrieval", nullptr, 0.4, 0.98)),
      Of("seeds", {Row("A/1@1000", 1000, 8.0, 0.5), Row("A/2@1000", 1000, 6.0, 0.4)}, Row("A@1000", 1000, 7.0, 0.45)),
      Of("seeds", {Row("A/1", 3000, 2.0, 0.9), Row("A/2", 3000, 1.0, 0.8)}, Row("A", 3000, 1.5, 0.85)),
      Row("B, 8 frames", 500, 3.0, 0.7)};
  const auto sheet = LearningSheet(rows, "learned");
  ASSERT_TRUE(sheet);
  ASSERT_EQ(sheet->plots.size(), 2U) << "no row has KID or movement";
  const Plot& fid = sheet->plots[0];
  const PlotCurve* first = Curve(fid, "A/1");
  ASSERT_NE(first, nullptr);
  ASSERT_EQ(first->points.size(), 2U);
  EXPECT_EQ(first->points[0].x, 1000.0);
  EXPECT_EQ(first->points[0].y, 8.0);
  EXPECT_EQ(first->points[1].x, 3000.0);
  EXPECT_EQ(first->points[1].y, 2.0);
  EXPECT_EQ(Curve(fid, "A"), nullptr) << "its seeds are drawn";
  EXPECT_EQ(Curve(fid, "B, 8 frames"), nullptr) << "one sample is no curve";
  EXPECT_EQ(Curve(fid, "Real"), nullptr) << "of another number of motions";
  const PlotCurve* real = Curve(fid, "Real ± sd");
  ASSERT_NE(real, nullptr);
  EXPECT_EQ(real->points.back().x, 3000.0);
  EXPECT_EQ(real->points.back().y, 0.5);
  EXPECT_NEAR(real->points.back().high.value_or(NAN), 0.6, 1e-12);
  EXPECT_EQ(Curve(fid, "Real-test"), nullptr) << "of another number of motions";
  const PlotCurve* retrieval = Curve(fid, "Retrieval");
  ASSERT_NE(retrieval, nullptr);
  EXPECT_EQ(retrieval->points.front().y, 0.4);
  const PlotCurve* level = Curve(sheet->plots[1], "Real");
  ASSERT_NE(level, nullptr);
  EXPECT_EQ(level->points.front().y, 0.99);
  EXPECT_TRUE(level->points.front().low);
  const PlotCurve* others = Curve(sheet->plots[1], "Real-test");
  ASSERT_NE(others, nullptr);
  EXPECT_FALSE(others->points.front().low) << "one band";
  EXPECT_EQ(Curve(sheet->plots[1], "Retrieval")->colour, retrieval->colour) << "though other curves are before it";
  EXPECT_EQ(level->colour, real->colour);
}

TEST(LearningSheet, OneSampleIsNoSheet) {
  EXPECT_FALSE(LearningSheet({Row("A", 3000, 1.0, 0.9), Of("real", true, Row("Real", nullptr, 1.0, 0.9))}, ""));
  EXPECT_FALSE(LearningSheet(nlohmann::json::array(), ""));
}

TEST(LearningSheet, DurationsOfASampleAreCurvesOfTheirOwn) {
  const auto sheet = LearningSheet({Row("A@1000, 40 frames", 1000, 8.0, 0.5), Row("A@1000, 60 frames", 1000, 7.0, 0.5),
                                    Row("A, 40 frames", 2000, 4.0, 0.6), Row("A, 60 frames", 2000, 3.0, 0.6)},
                                   "");
  ASSERT_TRUE(sheet);
  const PlotCurve* longer = Curve(sheet->plots[0], "A, 60 frames");
  ASSERT_NE(longer, nullptr);
  ASSERT_EQ(longer->points.size(), 2U);
  EXPECT_EQ(longer->points[1].y, 3.0);
}

}  // namespace
}  // namespace mocurate::test
