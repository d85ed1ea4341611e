// Body ids of a tracker that changed places are told, and given back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/ntu_skeleton.h"
#include "ingest/sense/inspect.h"
#include "ingest/sources/ntu_exchanged_ids.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two people who stand `apart` metres from each other and sway, 60 frames.
NtuSkeleton TwoPeople(double apart) {
  NtuSkeleton skeleton;
  for (int f = 0; f < 60; ++f) {
    std::vector<NtuBody> bodies(2);
    for (int p = 0; p < 2; ++p) {
      NtuBody& body = bodies[static_cast<std::size_t>(p)];
      body.id = static_cast<std::uint64_t>(11 + p);
      for (std::size_t j = 0; j < body.joints.size(); ++j) {
        const double angle = 0.2 * f + p + 0.3 * static_cast<double>(j);
        body.joints[j].x_m = p * apart + 0.05 * std::sin(angle);
        body.joints[j].y_m = 0.07 * static_cast<double>(j) - 0.8;
        body.joints[j].z_m = 3.0 + 0.05 * std::cos(angle);
        body.joints[j].tracking = 2;
      }
    }
    skeleton.frames.push_back(bodies);
  }
  return skeleton;
}

void ExchangeIn(NtuSkeleton& skeleton, std::size_t begin, std::size_t end) {
  for (std::size_t f = begin; f < end; ++f) {
    if (skeleton.frames[f].size() > 1) std::swap(skeleton.frames[f][0].id, skeleton.frames[f][1].id);
  }
}

TEST(ExchangedIds, AreToldWithBothBodiesAndTheirFramesAndGivenBack) {
  for (const auto& [begin, end] : {std::pair<int, int>{25, 60}, {25, 40}, {30, 31}}) {
    const NtuSkeleton sound = TwoPeople(0.8);
    NtuSkeleton skeleton = sound;
    ExchangeIn(skeleton, static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
    NtuSkeleton left = skeleton;
    NoteExchangedIds(true, skeleton);
    EXPECT_EQ(skeleton, sound);
    ASSERT_EQ(skeleton.findings.size(), 1u);
    const Finding& told = skeleton.findings[0];
    EXPECT_EQ(told.code, "ids_exchanged");
    EXPECT_EQ(told.frame_begin, begin);
    EXPECT_EQ(told.frame_end, end);
    EXPECT_NEAR(told.value, 0.8, 0.05);
    EXPECT_EQ(told.action, FindingAction::kRepaired);
    EXPECT_THAT(told.message, HasSubstr("body ids 11 and 12 are exchanged"));
    const NtuSkeleton as_written = left;
    NoteExchangedIds(false, left);
    EXPECT_EQ(left, as_written) << "nothing is done by the official rule";
    ASSERT_EQ(left.findings.size(), 1u);
    EXPECT_EQ(left.findings[0].action, FindingAction::kFlagged);
  }
}

TEST(ExchangedIds, AreToldOverFramesInWhichBothWereLostButNotWherePeopleCouldWalk) {
  for (const int gap : {3, 20}) {
    NtuSkeleton skeleton = TwoPeople(0.9);
    for (int f = 20; f < 20 + gap; ++f) skeleton.frames[static_cast<std::size_t>(f)].clear();
    ExchangeIn(skeleton, 20, 60);
    NoteExchangedIds(true, skeleton);
    EXPECT_EQ(skeleton.findings.size(), gap == 3 ? 1u : 0u) << gap;
  }
}

TEST(ExchangedIds, OneWhoJumpsAndTwoWhoStandInOneAnotherExchangeNothing) {
  NtuSkeleton skeleton = TwoPeople(0.8);
  for (std::size_t f = 30; f < 60; ++f) {
    for (NtuJoint& joint : skeleton.frames[f][0].joints) joint.x_m += 0.8;
  }
  NoteExchangedIds(true, skeleton);
  EXPECT_TRUE(skeleton.findings.empty());
  skeleton = TwoPeople(0.05);
  ExchangeIn(skeleton, 30, 60);
  NoteExchangedIds(true, skeleton);
  EXPECT_TRUE(skeleton.findings.empty()) << "nothing tells a ghost in a body from it";
}

TEST(ExchangedIds, AreGivenBackByARunAndToldByAnInspectionOfRecordedPeople) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const char* const name = "S001C003P008R002A058.skeleton";
  const auto recorded = ParseNtuSkeleton(*ReadFile(TestData() + "/ntu/" + name), name);
  ASSERT_TRUE(recorded);
  NtuSkeleton exchanged = *recorded;
  ExchangeIn(exchanged, 35, exchanged.frames.size());
  std::vector<std::vector<double>> places;
  for (const NtuSkeleton& written : {*recorded, exchanged}) {
    const std::filesystem::path folder = FreshFolder("exchanged_ids");
    Put(folder / name, WriteNtuSkeleton(written));
    const IngestOptions ntu = Declared("ntu", {"ingest.path=" + folder.string()});
    const bool planted = !(written == *recorded);
    const auto discovery = Discover(ntu);
    ASSERT_TRUE(discovery) << discovery.error().Message();
    for (const ItemSpec& item : discovery->items) {
      const Ingested ingested = RunIngest(item, "exchanged");
      ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
      places.push_back(ingested.clip.evidence.tracks->positions.xyz);
      int told = 0;
      for (const Finding& finding : ingested.outcome->findings) {
        EXPECT_NE(finding.code, "teleport");
        told += finding.code == "ids_exchanged" && finding.frame_begin == 35 ? 1 : 0;
      }
      EXPECT_EQ(told, planted ? 1 : 0);
    }
    const std::string inspection = InspectPath(folder / name, std::nullopt).at("findings").dump();
    if (planted)
      EXPECT_THAT(inspection, HasSubstr("ids_exchanged"));
    else
      EXPECT_THAT(inspection, Not(HasSubstr("ids_exchanged")));
  }
  ASSERT_EQ(places.size(), 4u);
  EXPECT_EQ(places[0], places[2]);
  EXPECT_EQ(places[1], places[3]);
}

}  // namespace
}  // namespace mocurate
