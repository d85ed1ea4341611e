// Datasets as values: conditions on clips, subsets, relabelled datasets.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "canon/values/relabel.h"
#include "canon/values/set_files.h"
#include "canon/values/subset.h"
#include "canon/values/where.h"
#include "core/base/file.h"
#include "tests/canon/moving_clips.h"
#include "tests/canon/value_sets.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using Rows = std::vector<std::size_t>;

Rows RowsWhere(const std::string& condition, const Dataset& dataset = SixClips()) {
  const auto parsed = Condition::Parse(condition);
  EXPECT_TRUE(parsed) << condition << ": " << parsed.error().Message();
  if (!parsed) return {};
  const auto holds = parsed->Holds(dataset);
  EXPECT_TRUE(holds) << condition << ": " << holds.error().Message();
  Rows rows;
  for (std::size_t row = 0; holds && row < holds->size(); ++row) {
    if ((*holds)[row]) rows.push_back(row);
  }
  return rows;
}

TEST(Where, HoldsForTheClipsThatAPersonWouldPick) {
  const std::string first = SixClips().clips[0].id();
  const std::pair<std::string, Rows> cases[] = {{"label == a", {0, 2, 4}},
                                                {"label != a", {1, 3, 5}},
                                                {"label == ''", {5}},
                                                {"label in [b, 'a']", {0, 1, 2, 3, 4}},
                                                {"label not in [b, \"a\"]", {5}},
                                                {"person == p1 or person == p2 and label == a", {0, 1, 2}},
                                                {"(person == p1 or person == p2) and label == a", {0, 2}},
                                                {"not person == p1 and label == a", {2, 4}},
                                                {"not (person == p1 and label == a)", {1, 2, 3, 4, 5}},
                                                {"not not person == p1", {0, 1}},
                                                {"frames >= 42 and frames < 44", {2, 3}},
                                                {"seconds > 1.46", {4}},
                                                {"rate == 60", {5}},
                                                {"rate == 60000/1000", {5}},
                                                {"rate in [30, 25]", {0, 1, 2, 3, 4}},
                                                {"id == " + first, {0}},
                                                {"id =~ '^test/p[23]/'", {2, 3, 4, 5}},
                                                {"(recording=~'4[01]_')and(person=~p1)", {0, 1}},
                                                {"view =~ 'front.view' and source == test", {0, 1, 2, 3, 4, 5}},
                                                {"part(persons) == train and role == train", {0, 1, 4, 5}},
                                                {"part('persons') in [test, validation]", {2, 3}},
                                                {"findings(position_jump) > 1", {0}},
                                                {"findings('position_jump') > 1", {0}},
                                                {"findings('position_jump') == 0", {1, 3, 4, 5}},
                                                {"segments(step) == 2", {2}},
                                                {"session == morning and provenance(style) == 'old man'", {1}},
                                                {"fine_label != ''", {0, 1}},
                                                {"  label==a\n\tand\tframes<=40 ", {0}}};
  for (const auto& [condition, rows] : cases) EXPECT_EQ(RowsWhere(condition), rows) << condition;
}

TEST(Where, NamesTheColumnOfWhatIsWrong) {
  std::string deep(2000, '(');
  const std::pair<std::string, int> cases[] = {{"", 1},
                                               {"labl == a", 1},
                                               {"label = a", 7},
                                               {"label == a and persn == p1", 16},
                                               {"label == 'ü' and persn == p1", 18},
                                               {"label == a && person == p1", 12},
                                               {"label == a person == p1", 12},
                                               {"label < a", 7},
                                               {"frames =~ 4", 8},
                                               {"frames > many", 10},
                                               {"frames > 1/0", 10},
                                               {"label in a", 10},
                                               {"label in [a b]", 13},
                                               {"label in []", 11},
                                               {"label not a", 11},
                                               {"label == 'a", 10},
                                               {"(label == a", 1},
                                               {"label == a)", 11},
                                               {"part == test", 6},
                                               {"part(persons) == tset", 18},
                                               {"label =~ '('", 10},
                                               {"label =~ [ab]", 10},
                                               {"label =~ a[ab]", 11},
                                               {"label =~ '(a)\\1'", 10},
                                               {"label =~ '((a{200}){200}){200}'", 10},
                                               {"label == a ; person == p1", 12},
                                               {deep, 102}};
  for (const auto& [condition, column] : cases) {
    const auto parsed = Condition::Parse(condition, "place");
    ASSERT_FALSE(parsed) << condition;
    EXPECT_EQ(parsed.error().code, ErrorCode::kUsage);
    EXPECT_EQ(parsed.error().where, "place:" + std::to_string(column)) << parsed.error().Message();
  }
  const auto absent = Condition::Parse("label == a and part(person) == test")->Holds(SixClips());
  ASSERT_FALSE(absent) << "the split is not there";
  EXPECT_EQ(absent.error().code, ErrorCode::kUsage);
  EXPECT_EQ(absent.error().where, "--where:16");
}

TEST(Where, FindsAnyValueOfAList) {
  const Dataset six = SixClips();
  const std::string list = "id in [z, " + six.clips[4].id() + ", b, " + six.clips[1].id() + ", a]";
  EXPECT_THAT(RowsWhere(list), ElementsAre(1, 4));
  EXPECT_THAT(RowsWhere("not " + list), ElementsAre(0, 2, 3, 5));
}

TEST(Where, LimitsTheComparisonsOfACondition) {
  std::string condition = "label == a";
  for (int i = 1; i < 10000; ++i) condition += " and label == a";
  EXPECT_TRUE(Condition::Parse(condition));
  const auto more = Condition::Parse(condition + " and label == a");
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, ErrorCode::kUsage);
}

TEST(Where, KnowsValuesThatNoClipHas) {
  const auto unknown = Condition::Parse("label in [a, bb, c] or view != 'front veiw'")->FindUnknownValues(SixClips());
  ASSERT_THAT(unknown, SizeIs(3));
  EXPECT_EQ(unknown[0].value, "bb");
  EXPECT_EQ(unknown[2].field, "view");
  EXPECT_EQ(unknown[2].nearest, "front view");
}

TEST(Subset, KeepsPartsLabelsAndFindingsOfTheClipsThatStay) {
  const auto subset = SubsetOf(SixClips(), *Condition::Parse("person in [p1, p3] and label != ''"), "six.h5");
  ASSERT_TRUE(subset) << subset.error().Message();
  EXPECT_THAT(subset->rows, ElementsAre(0, 1, 4));
  const Dataset& dataset = subset->dataset;
  EXPECT_THAT(dataset.labels, ElementsAre("a", "b", "c")) << "indices do not move";
  EXPECT_THAT(dataset.splits[0].train, ElementsAre(0, 1, 2));
  EXPECT_THAT(dataset.splits[0].test, IsEmpty());
  EXPECT_THAT(CodesOfFindings(subset->findings), ElementsAre("empty_part", "empty_part"));
  EXPECT_THAT(CodesOfFindings(dataset.findings),
              ElementsAre("position_jump", "position_jump", "empty_part", "empty_part"));
  EXPECT_THAT(dataset.fine_labels, SizeIs(2));

  const auto closed = SubsetOf(SixClips(), *Condition::Parse("label == b"), "six.h5", true);
  ASSERT_TRUE(closed);
  EXPECT_THAT(closed->dataset.labels, ElementsAre("b"));
  ASSERT_THAT(closed->dataset.fine_labels, SizeIs(1));
  EXPECT_EQ(closed->dataset.fine_labels[0].parent, 0);

  const auto none = SubsetOf(SixClips(), *Condition::Parse("label == a and frames > 100"), "six.h5");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kInconsistent);
  const auto counts = Condition::Parse("label == a and frames > 100")->CountTests(SixClips());
  EXPECT_THAT(*counts, ElementsAre(std::make_pair("label == a", 3), std::make_pair("frames > 100", 0)));
}

class Relabelling : public ::testing::Test {
 protected:
  Expected<RelabelledDataset> By(const std::string& yaml, const Dataset& dataset = SixClips()) const {
    EXPECT_TRUE(WriteFile(folder_ / "map.yaml", yaml));
    const auto map = ReadRelabelMap(folder_ / "map.yaml");
    return map ? Relabel(dataset, *map) : tl::unexpected<Error>(map.error());
  }

  std::vector<std::string> LabelsBy(const std::string& yaml) const {
    const auto relabelled = By(yaml);
    EXPECT_TRUE(relabelled) << yaml << ": " << relabelled.error().Message();
    std::vector<std::string> labels;
    for (std::size_t i = 0; relabelled && i < relabelled->rows.size(); ++i) {
      labels.push_back(relabelled->dataset.clips[i].label);
    }
    return labels;
  }

  const ScratchFolder folder_;
};

TEST_F(Relabelling, RenamesClipsSegmentsAndClassesAtTheIndexOfTheirFirstLabel) {
  const auto relabelled = By("c: x\nb: y\nstep: stride\n");
  ASSERT_TRUE(relabelled) << relabelled.error().Message();
  EXPECT_THAT(relabelled->dataset.labels, ElementsAre("a", "y", "x"));
  EXPECT_EQ(relabelled->dataset.clips[1].label, "y");
  EXPECT_EQ(relabelled->dataset.clips[1].fine_label, "b at once") << "its class has another name, no other clips";
  EXPECT_EQ(relabelled->dataset.clips[2].segments[1].label, "stride");
  EXPECT_EQ(relabelled->segments, 7u);
  EXPECT_EQ(relabelled->changes.at({"b", "y"}), 2u);
  EXPECT_EQ(relabelled->dataset.splits[0].train, SixClips().splits[0].train);
  EXPECT_THAT(By("b: a")->dataset.labels, ElementsAre("a", "c")) << "two become one";
  EXPECT_THAT(By("a: c")->dataset.labels, ElementsAre("c", "b"));
  EXPECT_EQ(By("b: a")->dataset.fine_labels[1].parent, 0);
}

TEST_F(Relabelling, DropsOrdersAndDecidesByRulesAndTables) {
  EXPECT_THAT(LabelsBy("drop: [a]\nlabels: {b: a}"), ElementsAre("a", "a", ""));
  const auto dropped = By("drop: [b]");
  EXPECT_THAT(dropped->rows, ElementsAre(0, 2, 4, 5));
  EXPECT_THAT(dropped->dataset.labels, ElementsAre("a", "c"));
  EXPECT_THAT(dropped->dataset.splits[0].train, ElementsAre(0, 2, 3));
  EXPECT_THAT(CodesOfFindings(dropped->findings), ElementsAre("dropped", "empty_part"));
  EXPECT_EQ(dropped->dataset.findings.back().code, "empty_part");
  EXPECT_THAT(dropped->dataset.fine_labels, SizeIs(1));
  EXPECT_THAT(By("classes: [c, b, a]")->dataset.labels, ElementsAre("c", "b", "a"));

  ASSERT_TRUE(WriteFile(folder_ / "clips.csv", "frames,label,clip\n40,\"d, e\"," + SixClips().clips[0].id() + "\n"));
  const std::string rules =
      "labels: {a: b}\nclips: clips.csv\nrules:\n  - {where: person == p1, label: q}\n  - {where: person =~ p, label: "
      "r}\n";
  EXPECT_THAT(LabelsBy(rules), ElementsAre("d, e", "q", "r", "r", "r", "r"));
  EXPECT_THAT(By(rules)->dataset.labels, ElementsAre("b", "c", "q", "r", "d, e"));
  EXPECT_EQ(By(rules)->dataset.clips[0].fine_label, "") << "it was of class a";

  ASSERT_TRUE(WriteFile(folder_ / "clips.csv", "clip,label\n" + SixClips().clips[0].id() + ",'=1\n"));
  EXPECT_EQ(LabelsBy(rules).front(), "=1") << "as exports write it";
}

TEST_F(Relabelling, ReportsWhatFitsNothingAndRefusesWhatCannotBe) {
  const auto relabelled = By("labels: {aa: x, b: y}\n");
  ASSERT_TRUE(relabelled);
  EXPECT_EQ(relabelled->findings.at(0).code, "unknown_label");
  EXPECT_EQ(relabelled->findings.at(0).severity, Severity::kWarning);
  const std::pair<const char*, ErrorCode> wrong[] = {
      {"aa: x", ErrorCode::kConfig},                                      // nothing fits
      {"classes: [a, x]", ErrorCode::kConfig},                            // b is not listed
      {"classes: [a, b, b]", ErrorCode::kConfig},                         // twice
      {"drop: [a]\nlabels: {a: b}", ErrorCode::kConfig},                  // both
      {"rules: [{where: 'persn == p1', label: x}]", ErrorCode::kConfig},  // no field
      {"rules: [{where: 'person == p1'}]", ErrorCode::kConfig},           // no label
      {"labels: {a: ''}", ErrorCode::kConfig},                            // becomes nothing
      {"lables: {a: b}", ErrorCode::kConfig},                             // no such option
      {"clips: nowhere.csv", ErrorCode::kNotFound},                       //
      {"{}", ErrorCode::kConfig},                                         //
      {"drop: [a, b]\nrules: [{where: 'label != \"\"', label: a}]", ErrorCode::kInternal}};
  for (const auto& [yaml, code] : wrong) {
    const auto refused = By(yaml);
    if (code == ErrorCode::kInternal) {
      EXPECT_TRUE(refused) << "rules decide before labels that are dropped: " << refused.error().Message();
      continue;
    }
    ASSERT_FALSE(refused) << yaml;
    EXPECT_EQ(refused.error().code, code) << yaml << ": " << refused.error().Message();
  }
  std::string rule = "label == z";
  for (int i = 1; i < 6000; ++i) rule += " or label == z";
  const auto many = By("rules: [{where: '" + rule + "', label: x}, {where: '" + rule + "', label: y}]");
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().code, ErrorCode::kConfig);
  Dataset labelled = SixClips();
  labelled.clips.pop_back();
  labelled.splits.clear();
  const auto none = By("drop: [a, b]", labelled);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kInconsistent);
  ASSERT_TRUE(WriteFile(folder_ / "clips.csv", "clip\n" + labelled.clips[0].id() + "\n"));
  const auto table = By("clips: clips.csv");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().code, ErrorCode::kConfig);
}

TEST_F(Relabelling, AListOfManyClassesTakesTimeInProportion) {
  std::string names;
  for (int i = 0; i < 90000; ++i) names += ", c" + std::to_string(i);
  const auto ordered = By("classes: [a, b" + names + "]");
  ASSERT_TRUE(ordered) << ordered.error().Message();
  EXPECT_EQ(ordered->dataset.labels.size(), 90002u);
}

TEST(SetFiles, AreDistinguishedByTheEndsOfTheirPaths) {
  EXPECT_THAT(NamesOfFiles({"runs/a/dataset.h5", "b.h5"}), ElementsAre("a/dataset.h5", "b.h5"));
  EXPECT_THAT(NamesOfFiles({"x/a/set.h5", "y/a/set.h5"}), ElementsAre("x/a/set.h5", "y/a/set.h5"));
  EXPECT_THAT(NamesOfFiles({"set.h5", "set.h5"}), ElementsAre("set.h5", "set.h5"));
}

TEST(Subset, KnowsTheFindingsOfTheRecordingsThatClipsWereCutFrom) {
  Clip first = ClipMoving("p1", "a", 90, 5, 30, 1), second = first, other = ClipMoving("p2", "a", 90, 5, 30, 1);
  first.identity.end_frame = 40;
  second.identity.begin_frame = 50;
  Dataset dataset = SetOf({first, second, other});
  Finding finding;
  finding.clip = "test/p1/a90_5#0-90";
  finding.code = "position_jump";
  finding.frame_begin = 60;
  finding.frame_end = 70;
  dataset.findings = {finding};
  EXPECT_FALSE(IsAbout(finding, first));
  EXPECT_TRUE(IsAbout(finding, second));
  EXPECT_FALSE(IsAbout(finding, other));
  Dataset without = dataset;
  KeepRows({false, false, true}, without);
  EXPECT_TRUE(without.findings.empty());
  KeepRows({true, false, true}, dataset);
  EXPECT_EQ(dataset.findings.size(), 1u);
}

}  // namespace
}  // namespace mocurate
