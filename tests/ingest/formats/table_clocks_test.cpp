// Joint tables whose rows begin with a time or a number: frames are laid out by it, and none is invented.

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "core/base/text.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/inspect/source_declaration.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/smpl_people.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Frames of 30 Hz, of which 20 to 22 are lost.
std::vector<int> LostFrames(int frames) {
  std::vector<int> kept;
  for (int f = 0; f < frames; ++f) {
    if (f < 20 || f > 22) kept.push_back(f);
  }
  return kept;
}

/// A clock in units of `seconds`, whole ones where it has them.
double TimeOf(int frame, double seconds) {
  return seconds < 1.0 ? 8981000.0 + std::round(frame / 30.0 / seconds) : 8.5 + frame / 30.0;
}

/// Two joints in millimetres behind the text of each row.
std::string TwoJoints(const std::vector<std::string>& before) {
  std::string text;
  for (std::size_t i = 0; i < before.size(); ++i) {
    text += before[i];
    for (int j = 0; j < 2; ++j) text += ",100," + std::to_string(1000 + i) + "," + std::to_string(200 * j);
    text += "\n";
  }
  return text;
}

class TableClocks : public ::testing::Test {
 protected:
  TableClocks() : folder_(FreshFolder("table_clocks")), options_(SmallTable(folder_)) {
    options_.source.layout = "time_ms 2*(x y z)";
    options_.source.rate_hz.reset();
    options_.source.checks.IgnoreAll();
  }

  Ingested Run(const std::string& text) {
    Put(folder_ / "a01_s02.txt", text);
    const auto discovery = Discover(options_);
    if (!discovery) return {tl::unexpected<Error>(discovery.error()), {}, {}};
    return RunIngest(discovery->items.at(0), "table_clocks");
  }

  /// The code of a refused clip.
  std::string Refused(const std::string& text) {
    const Ingested ingested = Run(text);
    return ingested.outcome ? "" : FaultCode(ingested.outcome.error(), "joint_table");
  }

  static std::string Rows(double seconds, int frames = 60) {
    std::vector<std::string> before;
    for (const int f : LostFrames(frames)) before.push_back(FormatDouble(TimeOf(f, seconds)));
    return TwoJoints(before);
  }

  fs::path folder_;
  IngestOptions options_;
};

TEST_F(TableClocks, LayOutFramesInEveryUnit) {
  for (const auto& [word, seconds] :
       {std::pair{"time_s", 1.0}, {"time_ms", 1e-3}, {"time_us", 1e-6}, {"time_100ns", 1e-7}, {"time_ns", 1e-9}}) {
    options_.source.layout = std::string(word) + " 2*(x y z)";
    for (const std::optional<double> rate_hz : {std::optional<double>(), std::optional<double>(30.0)}) {
      options_.source.rate_hz = rate_hz;
      const Ingested ingested = Run(Rows(seconds));
      ASSERT_TRUE(ingested.outcome) << word << ingested.outcome.error().Message();
      EXPECT_EQ(ingested.clip.rate, (FrameRate{30, 1})) << word;
      const JointTracks& tracks = *ingested.clip.evidence.tracks;
      ASSERT_EQ(tracks.positions.frames, 60) << word;
      for (const int lost : {20, 21, 22}) EXPECT_EQ(tracks.confidence[static_cast<std::size_t>(2 * lost)], 0.0);
      EXPECT_EQ(tracks.confidence[2 * 23], 1.0);
      EXPECT_DOUBLE_EQ(tracks.time_s[23], 23 / 30.0);
      ASSERT_EQ(ingested.outcome->findings.size(), 1u);
      EXPECT_EQ(ingested.outcome->findings[0].code, "time_gap");
    }
  }
}

TEST_F(TableClocks, RefuseTimesOfAnotherRateThanDeclared) {
  options_.source.rate_hz = 60.0;
  EXPECT_EQ(Refused(Rows(1e-3)), "rate_contradiction");
  options_.source.rate_hz = 30.0;
  options_.source.layout = "time_s 2*(x y z)";
  EXPECT_EQ(Refused(Rows(1e-3)), "rate_contradiction") << "milliseconds, declared as seconds";
  options_.source.rate_hz.reset();
  const Ingested seconds = Run(Rows(1e-3));
  ASSERT_FALSE(seconds.outcome);
  options_.source.layout = "skip 2*(x y z)";
  options_.source.rate_hz = 60.0;
  EXPECT_TRUE(Run(Rows(1e-3)).outcome) << "a column that is skipped says nothing";
}

TEST_F(TableClocks, RefuseAClockThatIsDeclaredToCountFrames) {
  options_.source.layout = "frame 2*(x y z)";
  options_.source.rate_hz = 30.0;
  for (const double seconds : {1e-3, 1e-6, 1e-7, 1e-9}) EXPECT_EQ(Refused(Rows(seconds)), "layout_contradiction");
  std::vector<std::string> equal, every_second;
  for (int f = 0; f < 30; ++f) equal.push_back(std::to_string(33 * f)), every_second.push_back(std::to_string(2 * f));
  EXPECT_EQ(Refused(TwoJoints(equal)), "layout_contradiction");
  EXPECT_NE(Refused(TwoJoints(every_second)), "layout_contradiction");
  options_.source.layout = "time_ms 2*(x y z)";
  options_.source.rate_hz.reset();
  const Ingested declared = Run(TwoJoints(equal));
  ASSERT_TRUE(declared.outcome) << declared.outcome.error().Message();
  EXPECT_EQ(declared.clip.evidence.tracks->positions.frames, 30) << "what is declared is believed";
}

TEST_F(TableClocks, RefuseTimesThatFall) {
  EXPECT_EQ(Refused(TwoJoints({"0", "33", "67", "0", "33"})), "layout_contradiction");
  const Ingested still = Run(TwoJoints({"0", "33", "67", "67", "100"}));
  ASSERT_TRUE(still.outcome) << still.outcome.error().Message();
  EXPECT_EQ(still.clip.evidence.tracks->positions.frames, 4);
  EXPECT_EQ(still.outcome->findings.at(0).code, "frame_number");
}

TEST_F(TableClocks, AreReadWhereEachJointHasARow) {
  options_.source.layout.clear();
  options_.source.columns = {"time_ms", "x", "y", "z"};
  std::string text;
  for (const int time : {0, 33, 67, 167, 200}) {
    for (int j = 0; j < 2; ++j) text += std::to_string(time) + " 100 1000 " + std::to_string(200 * j) + "\n";
  }
  const Ingested ingested = Run(text);
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.evidence.tracks->positions.frames, 7);
}

TEST_F(TableClocks, NeedARateWithoutTimes) {
  options_.source.layout = "frame 2*(x y z)";
  Put(folder_ / "a01_s02.txt", TwoJoints({"1", "2"}));
  ExpectError(Discover(options_), ErrorCode::kConfig, "ingest.source.rate");
  options_.source.rate_hz = 30.0;
  options_.source.layout = "FILL_IN 2*(x y z)";
  ExpectError(Discover(options_), ErrorCode::kConfig, "ingest.source.layout");
}

/// Tables of a person, inspected and declared.
class PersonTables : public ::testing::Test {
 protected:
  PersonTables() : folder_(FreshFolder("person_tables")) {}

  /// SMPL's joints of a person behind the text of each row, a row a frame or a joint.
  std::string Table(const std::vector<std::string>& before, const std::string& header = "") const {
    const std::vector<double> places = Places(MovingPerson(static_cast<int>(before.size()), 1), kHalfTurn);
    std::string text = header;
    for (std::size_t f = 0; f < before.size(); ++f) {
      text += before[f];
      for (std::size_t i = 0; i < 72; ++i)
        text += (i == 0 && before[f].empty() ? "" : ",") + RoundedText(places[f * 72 + i], 6);
      text += "\n";
    }
    return text;
  }

  static std::string Header(const std::string& first) {
    std::string header = first;
    for (int j = 0; j < 24; ++j) {
      for (const char* axis : {"x", "y", "z"}) header += ",j" + std::to_string(j) + "_" + axis;
    }
    return header + "\n";
  }

  static std::vector<std::string> Numbers(const std::function<double(int)>& of_frame) {
    std::vector<std::string> numbers;
    for (const int f : LostFrames(60)) numbers.push_back(FormatDouble(of_frame(f)));
    return numbers;
  }

  nlohmann::json Inspect(const std::string& text) {
    Put(folder_ / "walk.csv", text);
    return InspectPath(folder_, std::nullopt);
  }

  WrittenDeclaration Declare() {
    auto written = DeclareSource(InspectPath(folder_, std::nullopt), folder_, "mine");
    EXPECT_TRUE(written) << written.error().Message();
    return written ? *std::move(written) : WrittenDeclaration();
  }

  fs::path folder_;
};

TEST_F(PersonTables, DeclareAClockByItsSteps) {
  for (const auto& [word, seconds] :
       {std::pair{"time_s", 1.0}, {"time_ms", 1e-3}, {"time_us", 1e-6}, {"time_100ns", 1e-7}, {"time_ns", 1e-9}}) {
    const nlohmann::json inspection = Inspect(Table(Numbers([s = seconds](int f) { return TimeOf(f, s); })));
    ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
    const nlohmann::json& clip = inspection.at("clips")[0];
    EXPECT_EQ(clip.at("facts").at("layout"), std::string(word) + " 24*(x y z)");
    EXPECT_EQ(Value(clip, "rate_hz"), 30.0);
    EXPECT_EQ(clip.at("rate_hz").at("from"), "measured");
    EXPECT_EQ(FindingsOf(inspection, "time_gap").at(0).at("value"), 3);
    const WrittenDeclaration written = Declare();
    EXPECT_THAT(written.yaml, HasSubstr("rate: 30 Hz"));
    EXPECT_THAT(written.unknown, Not(Contains("layout")));
  }
}

TEST_F(PersonTables, LeaveAnAmbiguousColumnToFillIn) {
  for (const int step : {5, 33}) {
    const nlohmann::json inspection = Inspect(Table(Numbers([s = step](int f) { return 1.0 * s * f; })));
    EXPECT_EQ(FindingsOf(inspection, "layout_ambiguous").at(0).at("value"), step);
    const WrittenDeclaration written = Declare();
    EXPECT_THAT(written.unknown, Contains("layout"));
    EXPECT_THAT(written.yaml, HasSubstr("layout: \"FILL_IN 24*(x y z)\""));
  }
}

TEST_F(PersonTables, FollowTheHeader) {
  const auto equal = Numbers([](int f) { return 33.0 * f; });
  const auto layout = [&](const std::string& name, const std::vector<std::string>& before) {
    return Inspect(Table(before, Header(name))).at("clips").at(0).at("facts").at("layout");
  };
  EXPECT_EQ(layout("timestamp", equal), "time_ms 24*(x y z)");
  EXPECT_EQ(layout("frame", equal), "frame 24*(x y z)");
  auto both = Numbers([](int f) { return 33.0 * f; });
  for (std::size_t i = 0; i < both.size(); ++i) both[i] = std::to_string(i) + "," + both[i];
  EXPECT_EQ(layout("index,time_ms", both), "skip time_ms 24*(x y z)");
}

TEST_F(PersonTables, CountFramesAndPassOverOtherNumbers) {
  const nlohmann::json counted = Inspect(Table(Numbers([](int f) { return f + 7.0; })));
  EXPECT_EQ(counted.at("clips")[0].at("facts").at("layout"), "frame 24*(x y z)");
  EXPECT_EQ(FindingsOf(counted, "time_gap").size(), 1u);
  const nlohmann::json constant = Inspect(Table(Numbers([](int) { return 2.0; })));
  EXPECT_EQ(constant.at("clips")[0].at("facts").at("layout"), "skip 24*(x y z)");
  EXPECT_THAT(FindingsOf(constant, "layout_ambiguous"), IsEmpty());
}

}  // namespace
}  // namespace mocurate
