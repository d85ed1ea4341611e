// Rows of several trainings, and orders between methods by their trainings.

#include "eval/tables/seeds.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/holm.h"

namespace mocurate {
namespace {

nlohmann::json RowOfSeed(const std::string& name, double fid) {
  return {{"name", name},
          {"network", name},
          {"metrics", {{"FID_train", {{"value", fid}, {"interval", {fid - 0.1, fid + 0.1}}}}}},
          {"ours", {{"checkpoint", name + ".h5"}}}};
}

TEST(Seeds, RowsOfOneNetworkBecomeItsMeanWithItsRange) {
  nlohmann::json rows = {{{"name", "Real"}, {"metrics", nlohmann::json::object()}},
                         RowOfSeed("A/1", 2.0),
                         RowOfSeed("B", 7.0),
                         RowOfSeed("A/2@100", 9.0),
                         RowOfSeed("A/2", 3.0),
                         RowOfSeed("A/7", 7.0)};
  rows[4]["unconverged"] = "3 of 5 steps";
  MergeSeeds(rows);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1]["name"], "A");
  EXPECT_EQ(rows[1]["network"], "A");
  const nlohmann::json& fid = rows[1]["metrics"]["FID_train"];
  EXPECT_EQ(fid["value"], 4.0);
  EXPECT_EQ(fid["interval"], nlohmann::json({2.0, 7.0}));
  EXPECT_EQ(fid["interval_kind"], kRangeOfSeeds);
  EXPECT_EQ(rows[1]["seeds"].size(), 3U);
  EXPECT_EQ(rows[1]["seeds"][1]["ours"]["checkpoint"], "A/2.h5");
  EXPECT_EQ(rows[1]["unconverged"], "3 of 5 steps");
  EXPECT_EQ(rows[2]["name"], "B");
  EXPECT_EQ(rows[3]["name"], "A/2@100") << "a sample of training is no training of its own";
}

TEST(Seeds, ChanceOfAnOrderIsOneOfAllAssignments) {
  EXPECT_NEAR(ChanceOfLess({1, 2}, {3, 4}), 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(ChanceOfLess({1, 2, 3}, {4, 5, 6}), 1.0 / 20.0, 1e-12);
  EXPECT_NEAR(ChanceOfLess({1, 2, 3, 4}, {5, 6, 7, 8}), 1.0 / 70.0, 1e-12);
  EXPECT_NEAR(ChanceOfLess({1, 2, 4}, {3, 5, 6}), 2.0 / 20.0, 1e-12);
  EXPECT_EQ(ChanceOfLess({1, 1}, {1, 1}), 1.0);
  EXPECT_EQ(ChanceOfLess({5, 6}, {1, 2}), 1.0);
}

TEST(Seeds, OrdersAreCorrectedForAllPairs) {
  nlohmann::json rows = nlohmann::json::array();
  const std::vector<std::vector<double>> fids = {{1.0, 1.1, 1.2}, {2.0, 2.1, 2.2}, {2.05, 2.15, 3.0}};
  for (std::size_t n = 0; n < fids.size(); ++n) {
    for (std::size_t s = 0; s < 3; ++s) {
      rows.push_back(RowOfSeed(std::string(1, "ABC"[n]) + "/" + std::to_string(s + 1), fids[n][s]));
    }
  }
  MergeSeeds(rows);
  const nlohmann::json orders = OrdersOfSeeds(rows);
  ASSERT_EQ(orders.size(), 3U);
  EXPECT_EQ(orders[0]["better"], "A");
  EXPECT_EQ(orders[0]["worse"], "B");
  EXPECT_NEAR(orders[0]["p"].get<double>(), 0.05, 1e-12);
  EXPECT_NEAR(orders[0]["p_holm"].get<double>(), 0.15, 1e-12);
  EXPECT_GT(orders[2]["p"].get<double>(), 0.05);
  EXPECT_TRUE(OrdersOfSeeds(nlohmann::json::array({RowOfSeed("A", 1.0), RowOfSeed("B", 2.0)})).empty())
      << "one training of each says nothing of methods";
}

TEST(Holm, MultipliesTheSmallestByTheNumberOfTests) {
  EXPECT_EQ(HolmCorrected({0.01, 0.04, 0.03}), (std::vector<double>{0.03, 0.06, 0.06}));
  EXPECT_TRUE(HolmCorrected({}).empty());
}

}  // namespace
}  // namespace mocurate
