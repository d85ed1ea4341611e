// Our rows compared with the published ones.

#include "eval/tables/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace mocurate {
namespace {

nlohmann::json Row(const std::string& name, double fid, double accuracy, bool real = false) {
  return {{"name", name},
          {"real", real},
          {"metrics",
           {{"FID_train", {{"value", fid}, {"interval", {fid - 0.5, fid + 0.5}}, {"interval_kind", "student_95"}}},
            {"accuracy", {{"value", accuracy}, {"interval", nullptr}}},
            {"KID", {{"value", 0.1}, {"interval", nullptr}}}}}};
}

nlohmann::json Published(const std::string& method, const std::string& metric, double value) {
  return {{"method", method}, {"metric", metric},        {"value", value},
          {"pm", 0.1},        {"pm_kind", "student_95"}, {"source", "a paper, Table 1"}};
}

nlohmann::json SmallResult() {
  return {{"published_features", true},
          {"rows", {Row("Real", 0.1, 0.99, true), Row("A", 2.0, 0.9), Row("B/2", 8.0, 0.7), Row("C", 4.0, 0.8)}},
          {"published",
           {Published("Real motions", "FID_train", 0.05), Published("A", "FID_train", 1.0),
            Published("B", "FID_train", 2.0), Published("C", "FID_train", 3.0), Published("A", "accuracy", 0.5),
            Published("C", "accuracy", 0.6), Published("D", "FID_train", 9.0)}}};
}

const nlohmann::json& RowOf(const Comparison& comparison, const std::string& method) {
  const auto found = std::find_if(comparison.rows.begin(), comparison.rows.end(),
                                  [&](const nlohmann::json& row) { return row.at("method") == method; });
  EXPECT_NE(found, comparison.rows.end()) << method;
  return *found;
}

TEST(Comparison, RowIsPairedWithItsMethodRatioAndInterval) {
  const Comparison comparison = ComparePublished(SmallResult(), {"toy", "small", {}});
  const nlohmann::json fid = RowOf(comparison, "A").at("metrics").at("FID_train");
  EXPECT_EQ(fid.at("value"), 2.0);
  EXPECT_EQ(fid.at("published"), 1.0);
  EXPECT_EQ(fid.at("ratio"), 2.0);
  EXPECT_EQ(fid.at("ratio_interval"), nlohmann::json({1.5, 2.5}));
  EXPECT_EQ(RowOf(comparison, "A").at("profile"), "small");
  EXPECT_EQ(RowOf(comparison, "B/2").at("published_as"), "B") << "a row of a seed belongs to its network";
  EXPECT_EQ(RowOf(comparison, "Real").at("published_as"), "Real motions");
  EXPECT_TRUE(RowOf(comparison, "B/2").at("metrics").at("accuracy").at("published").is_null());
  EXPECT_FALSE(RowOf(comparison, "A").at("metrics").contains("KID")) << "no published value";
}

TEST(Comparison, MethodWithoutOurRowIsShownAlone) {
  const Comparison comparison = ComparePublished(SmallResult(), {"toy", "small", {}});
  const nlohmann::json& alone = RowOf(comparison, "D");
  EXPECT_EQ(alone.at("metrics").at("FID_train").at("published"), 9.0);
  EXPECT_TRUE(alone.at("metrics").at("FID_train").at("value").is_null());
  EXPECT_TRUE(alone.at("profile").is_null());
}

TEST(Comparison, OrderCountsPairsOfGeneratedMotionsOnly) {
  const Comparison comparison = ComparePublished(SmallResult(), {"toy", "small", {}});
  ASSERT_EQ(comparison.order.size(), 2U);
  EXPECT_EQ(comparison.order[0],
            nlohmann::json({{"metric", "FID_train"}, {"pairs", 3}, {"as_published", 2}, {"equal", 0}, {"p", 0.5}}))
      << "A < B and A < C as published, not C < B; 3 of 6 orders have two such pairs or more";
  EXPECT_EQ(comparison.order[1],
            nlohmann::json({{"metric", "accuracy"}, {"pairs", 1}, {"as_published", 0}, {"equal", 0}, {"p", 1.0}}));
}

/// Kendall's tables: of five rows 29 of 120 orders have seven pairs or more.
TEST(Comparison, ChanceOfAnOrderIsExactAlsoWithEqualPublishedNumbers) {
  const auto order = [](const std::vector<double>& ours, const std::vector<double>& published) {
    nlohmann::json result = {{"rows", nlohmann::json::array()}, {"published", nlohmann::json::array()}};
    for (std::size_t i = 0; i < ours.size(); ++i) {
      const std::string name(1, static_cast<char>('A' + static_cast<int>(i)));
      result["rows"].push_back(Row(name, ours[i], 0.5));
      result["published"].push_back(Published(name, "FID_train", published[i]));
    }
    return ComparePublished(result, {"toy", "", {}}).order.at(0);
  };
  const nlohmann::json five = order({1, 2, 5, 4, 3}, {1, 2, 3, 4, 5});
  EXPECT_EQ(five["as_published"], 7);
  EXPECT_NEAR(five["p"].get<double>(), 29.0 / 120.0, 1e-12);
  const nlohmann::json tied = order({1, 2, 3}, {1, 1, 2});  // orders of {a, a, b}: 2, 1, 0 pairs
  EXPECT_EQ(tied["pairs"], 2);
  EXPECT_NEAR(tied["p"].get<double>(), 1.0 / 3.0, 1e-12);
}

TEST(Comparison, NumbersOfAnotherRecogniserHaveNoRatio) {
  nlohmann::json result = SmallResult();
  result.erase("published_features");
  result["rows"][1]["metrics"]["parameters"] = {{"value", 10.0}, {"interval", nullptr}};
  result["published"].push_back(Published("A", "parameters", 5.0));
  const Comparison comparison = ComparePublished(result, {"toy", "small", {}});
  const nlohmann::json& metrics = RowOf(comparison, "A").at("metrics");
  EXPECT_TRUE(metrics.at("FID_train").at("ratio").is_null());
  EXPECT_EQ(metrics.at("FID_train").at("why_no_ratio"), "other_features");
  EXPECT_EQ(metrics.at("parameters").at("ratio"), 2.0) << "no recogniser is asked";
  EXPECT_EQ(comparison.order.size(), 2U) << "orders are within one recogniser";
}

TEST(Comparison, TheSampledIntervalIsARatiosWhereThePaperHasNone) {
  nlohmann::json result = SmallResult();
  nlohmann::json& fid = result["rows"][1]["metrics"]["FID_train"];
  fid["interval_kind"] = "actor_1.96_variance";
  const Comparison none = ComparePublished(result, {"toy", "small", {}});
  EXPECT_TRUE(RowOf(none, "A").at("metrics").at("FID_train").at("ratio_interval").is_null());
  fid["sampled"] = {{"interval", {1.0, 4.0}}, {"kind", "motions_95"}};
  const Comparison resampled = ComparePublished(result, {"toy", "small", {}});
  EXPECT_EQ(RowOf(resampled, "A").at("metrics").at("FID_train").at("ratio_interval"), nlohmann::json({1.0, 4.0}));
}

TEST(Comparison, LongFormHasOneLinePerNumberWithTheSameFields) {
  const std::string csv = ComparisonCsv("toy", ComparePublished(SmallResult(), {"toy", "small", {}}));
  EXPECT_NE(
      csv.find("\"toy\",\"A\",\"A\",\"small\",FID_train,2,1.5,2.5,\"student_95\",1,0.1,\"student_95\",2,1.5,2.5\n"),
      std::string::npos)
      << csv;
  const auto fields = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  std::size_t begin = 0;
  while (begin < csv.size()) {
    const std::size_t end = csv.find('\n', begin);
    EXPECT_EQ(fields(csv.substr(begin, end - begin)), fields(ComparisonCsvHead()));
    begin = end + 1;
  }
}

TEST(Comparison, RowCanBePairedWithAMethodOfAnotherNameOrNone) {
  const Comparison comparison = ComparePublished(SmallResult(), {"toy", "", {{"A", ""}, {"C", "A"}}});
  EXPECT_TRUE(RowOf(comparison, "A").at("published_as").is_null());
  EXPECT_EQ(RowOf(comparison, "C").at("metrics").at("FID_train").at("ratio"), 4.0);
}

TEST(Comparison, WithoutPublishedNumbersOursAreShownAlone) {
  nlohmann::json result = SmallResult();
  result["published"] = nlohmann::json::array();
  const Comparison comparison = ComparePublished(result, {"toy", "smoke", {}});
  EXPECT_EQ(comparison.rows.size(), 4U);
  EXPECT_EQ(comparison.table.columns.size(), 3U) << "FID, accuracy, KID";
  EXPECT_TRUE(comparison.order.empty());
}

}  // namespace
}  // namespace mocurate
