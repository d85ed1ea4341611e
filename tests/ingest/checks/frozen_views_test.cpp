// A frozen camera view is reported with its name, first frame and length while another view changes.

#include "ingest/checks/frozen_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ingest/inspect/inspect.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> FrozenSpans(const std::vector<ViewTrace>& views) {
  std::vector<std::string> spans;
  for (const FrozenView& view : FindFrozenViews(views))
    spans.push_back(view.camera + " " + std::to_string(view.begin) + "-" + std::to_string(view.end));
  return spans;
}

TEST(FrozenViews, AreViewsThatRepeatWhileAnotherChanges) {
  const ViewTrace moves{"moves", {"a", "b", "c", "d", "e", "f"}};
  EXPECT_THAT(FrozenSpans({moves, {"hangs", {"a", "b", "b", "b", "e", "f"}}}), ElementsAre("hangs 1-4"));
  EXPECT_THAT(FrozenSpans({moves, {"to the end", {"a", "b", "c", "c", "c", "c"}}}), ElementsAre("to the end 2-6"));
}

TEST(FrozenViews, ExcludeAStandingPersonASlowerCameraAndAnEmptyView) {
  const ViewTrace moves{"moves", {"a", "b", "c", "d", "e", "f"}};
  const ViewTrace stands{"stands", {"a", "a", "a", "a", "a", "a"}};
  EXPECT_THAT(FrozenSpans({stands, {"too", {"b", "b", "b", "b", "b", "b"}}}), ElementsAre());
  EXPECT_THAT(FrozenSpans({moves, {"half the rate", {"a", "a", "c", "c", "e", "e"}}}), ElementsAre());
  EXPECT_THAT(FrozenSpans({moves, {"no person", {"", "", "", "", "", ""}}}), ElementsAre());
  EXPECT_THAT(FrozenSpans({{"alone", {"a", "b", "b", "b", "b", "c"}}}), ElementsAre());
}

TEST(FrozenViews, OfKeypointsAreReportedInRunAndInspect) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  IngestOptions options = Declared("pose2sim_single");
  const std::filesystem::path from = options.path, folder = FreshFolder("frozen_view");
  std::filesystem::copy_file(from / "Calib.qca.txt", folder / "Calib.qca.txt");
  for (const std::string camera : {"cam01", "cam02", "cam03", "cam04"}) {
    const std::string view = "single/" + camera + "_json/";
    std::filesystem::create_directories(folder / view);
    for (int f = 0; f < 5; ++f) {
      const int shown = camera == "cam02" ? std::min(f, 1) : f;
      const auto name = [&](int number) { return view + camera + ".000" + std::to_string(number) + ".json"; };
      std::filesystem::copy_file(from / name(shown), folder / name(f));
    }
  }
  options.path = folder;
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "frozen_view");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  ASSERT_EQ(ingested.outcome->findings.size(), 1u);
  const Finding& reported = ingested.outcome->findings[0];
  EXPECT_EQ(reported.code, "frozen_view");
  EXPECT_EQ(reported.frame_begin, 1);
  EXPECT_EQ(reported.value, 4.0);
  EXPECT_THAT(reported.message, HasSubstr("'cam_02'"));
  std::vector<std::string> places;
  const nlohmann::json inspection = InspectPath(folder, std::nullopt);
  for (const nlohmann::json& finding : inspection.at("findings")) {
    if (finding.at("code") == "frozen_view") places.push_back(finding.at("where"));
  }
  EXPECT_THAT(places, ElementsAre("single/cam02_json"));
}

}  // namespace
}  // namespace mocurate
