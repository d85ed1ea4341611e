// Datasets made of datasets stay themselves: class order, fine labels, segments, splits, findings, and fields that the
// format does not name follow their rows through every verb that makes one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/app/program.h"
#include "tests/support/other_fields.h"
#include "tests/support/swinging_clips.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// Labels that are not in the order of the alphabet, one without a clip; three splits, one that places two clips only.
Dataset RichSet() {
  Dataset set = SwingingSet("smpl24", 0.1);
  set.fine_labels = {{"push up", 1}, {"stroll", 0}, {"amble", 0}};
  set.clips[0].fine_label = "stroll";
  set.clips[0].identity.session = "evening";
  set.clips[3].role = "test";
  set.clips[3].fit_rms = 0.02;
  set.splits.push_back({"cross view", {1}, {}, {3}, "front | side", "leaks: in two parts: anna"});
  for (const std::size_t row : {std::size_t{0}, std::size_t{2}}) {
    Finding finding = MakeFinding("position_jump", Severity::kWarning, 1.0, "jumps", FindingAction::kKept);
    finding.clip = set.clips[row].id();
    finding.frame_begin = 8;
    finding.frame_end = 10;
    set.findings.push_back(finding);
  }
  set.findings.push_back(MakeFinding("mixed_rates", Severity::kWarning, 2.0, "of the whole set"));
  set.recipe = "a rich set";
  return set;
}

std::string PartOf(const Split& split, std::size_t row) {
  const auto has = [&](const std::vector<int>& rows) {
    return std::find(rows.begin(), rows.end(), static_cast<int>(row)) != rows.end();
  };
  return has(split.train) ? "train" : has(split.validation) ? "validation" : has(split.test) ? "test" : "";
}

/// What a verb is expected to change.
struct Changes {
  std::map<std::string, std::pair<std::size_t, int>> origins;  ///< id -> row before, first frame; as before without
  std::map<std::string, std::string> labels;                   ///< id -> label
  std::vector<std::string> classes;                            ///< empty: as before
  std::set<std::string> dropped;                               ///< fields
  std::size_t clips = 4;
};

class DatasetsOfDatasets : public ::testing::Test {
 protected:
  void SetUp() override {
    const Status written = test::WriteWithOtherFields(set_, folder_ / "set.h5");
    ASSERT_TRUE(written) << written.error().Message();
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  Result Run(std::vector<std::string> arguments, int exit_code = 0) const {
    const Result result = RunProgram(folder_, arguments);
    EXPECT_EQ(result.exit_code, exit_code) << ::testing::PrintToString(arguments) << result.err;
    return result;
  }

  std::pair<std::size_t, int> OriginOf(const std::string& id, const Changes& changes) const {
    const auto changed = changes.origins.find(id);
    if (changed != changes.origins.end()) return changed->second;
    for (std::size_t row = 0; row < set_.clips.size(); ++row) {
      if (set_.clips[row].id() == id) return {row, 0};
    }
    ADD_FAILURE() << "a clip of another id: " << id;
    return {0, 0};
  }

  void ExpectClip(const Dataset& made, std::size_t row, const Changes& changes) const {
    const Clip& clip = made.clips[row];
    const auto [before_row, begin] = OriginOf(clip.id(), changes);
    const Clip& before = set_.clips[before_row];
    SCOPED_TRACE(clip.id());
    const auto label = changes.labels.find(clip.id());
    if (label == changes.labels.end()) {
      EXPECT_EQ(clip.fine_label, before.fine_label);
    }
    EXPECT_EQ(clip.label, label == changes.labels.end() ? before.label : label->second);
    EXPECT_EQ(clip.identity.session, before.identity.session);
    EXPECT_EQ(clip.identity.licence, before.identity.licence);
    EXPECT_EQ(clip.role, before.role);
    EXPECT_EQ(clip.segments.size(), before.segments.size());
    for (std::size_t i = 0; i < clip.segments.size(); ++i) {
      EXPECT_EQ(clip.segments[i].category, before.segments[i].category);
      EXPECT_NEAR(clip.segments[i].end_s, before.segments[i].end_s, 1e-9);
    }
    ASSERT_EQ(made.splits.size(), set_.splits.size());
    for (const Split& split : made.splits) {
      EXPECT_EQ(PartOf(split, row), PartOf(*set_.FindSplit(split.name), before_row)) << split.name;
    }
    for (const Finding& finding : set_.findings) {
      if (!finding.clip.empty() && finding.clip != before.id()) continue;
      const bool kept = std::any_of(made.findings.begin(), made.findings.end(), [&](const Finding& one) {
        return one.code == finding.code && (one.clip.empty() || one.clip == clip.id());
      });
      EXPECT_TRUE(kept) << finding.code;
    }
  }

  /// Whether what the file holds is what the set held.
  void ExpectKept(const std::string& name, const Changes& changes = {}) const {
    SCOPED_TRACE(name);
    const auto made = ReadDataset(folder_ / name);
    ASSERT_TRUE(made) << made.error().Message();
    EXPECT_EQ(made->labels, changes.classes.empty() ? set_.labels : changes.classes);
    ASSERT_EQ(made->fine_labels.size(), set_.fine_labels.size());
    for (std::size_t i = 0; i < made->fine_labels.size(); ++i) {
      EXPECT_EQ(made->fine_labels[i].name, set_.fine_labels[i].name);
      EXPECT_EQ(made->fine_labels[i].parent, set_.fine_labels[i].parent);
    }
    EXPECT_EQ(made->clips.size(), changes.clips);
    for (std::size_t row = 0; row < made->clips.size(); ++row) ExpectClip(*made, row, changes);
    ExpectFields(*made, name, changes);
  }

  void ExpectFields(const Dataset& made, const std::string& name, const Changes& changes) const {
    std::set<std::string> dropped;
    for (const Finding& finding : made.findings) {
      if (finding.code == "field_dropped") dropped.insert(finding.message.substr(0, finding.message.find(':')));
    }
    EXPECT_EQ(dropped, changes.dropped);
    const auto clips = DatasetClips::Open(folder_ / name, DatasetClips::Check::kHashes);
    ASSERT_TRUE(clips) << clips.error().Message();
    const OtherFields others = clips->ReadOtherFields();
    const auto has = [&](const std::string& path) { return changes.dropped.count(path) == 0; };
    EXPECT_EQ(others.of_clips.count("/clips/score") > 0, has("/clips/score"));
    EXPECT_EQ(others.of_set.count("/clips/score/@unit") > 0, has("/clips/score"));
    EXPECT_EQ(others.of_set.count("/about_it") > 0, has("/about_it"));
    EXPECT_EQ(others.of_set.count("/@doi") > 0, has("/@doi"));
    for (const auto& [path, width] : {std::pair("/frames/mark", 1), std::pair("/frames/joint_mark", 24)}) {
      ASSERT_EQ(others.of_frames.count(path) > 0, has(path)) << path;
      for (std::size_t row = 0; has(path) && row < made.clips.size(); ++row) {
        const auto [before, begin] = OriginOf(made.clips[row].id(), changes);
        const int frames = made.clips[row].motion->frame_count();
        const auto rows = clips->ReadOtherFrames(path, row, 0, frames);
        ASSERT_TRUE(rows) << rows.error().Message();
        EXPECT_EQ(*rows, test::MarkedFrames(before, begin + frames, width)
                             .Rows(static_cast<std::uint64_t>(begin), static_cast<std::uint64_t>(begin + frames)))
            << path << " of " << made.clips[row].id();
      }
    }
    for (std::size_t row = 0; has("/clips/score") && row < made.clips.size(); ++row) {
      const auto [before, begin] = OriginOf(made.clips[row].id(), changes);
      EXPECT_THAT(test::ValuesOf(others.of_clips.at("/clips/score").Rows(row, row + 1)),
                  ElementsAre(test::MarkOf(before, 0)));
      EXPECT_EQ(others.of_clips.at("/clips/note").texts.at(row), "note of " + set_.clips[before].id());
    }
  }

  /// Fits on other skeletons may be suspect, which exit code 1 says; they are written all the same.
  Result Fit(const std::string& name, std::vector<std::string> more, const std::string& to) const {
    std::vector<std::string> words = {"fit", Path(name), "-o", Path(to), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Result result = RunProgram(folder_, words);
    EXPECT_LE(result.exit_code, 1) << ::testing::PrintToString(words) << result.err;
    return result;
  }

  /// They name classes by their indices.
  std::vector<std::string> ExportedNames(const std::string& name) const {
    Run({"export", Path(name), "-o", Path(name + "_npy"), "--layout", "humanact12"});
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / (name + "_npy"))) {
      if (entry.path().extension() == ".npy") names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  const Dataset set_ = RichSet();
  ScratchFolder folder_;
};

/// A fast fit, of each recording alone.
std::vector<std::string> FitTo(const std::string& skeleton) {
  return {"--skeleton", skeleton,
          "--set",      "fitting.joint_tracks.uncertainty=false",
          "--set",      "fitting.solver=banded",
          "--set",      "proportions.body_of=recording"};
}

std::vector<std::string> CodesOf(const Result& result) {
  std::vector<std::string> codes;
  for (const nlohmann::json& finding : result.Json()["findings"]) codes.push_back(finding["code"]);
  return codes;
}

TEST_F(DatasetsOfDatasets, StayThemselvesThroughEveryVerb) {
  ExpectKept("set.h5");
  const std::string set = Path("set.h5");
  Run({"dataset", "subset", set, "--where", "label == walk", "-o", Path("walk.h5")});
  Changes three;
  three.clips = 3;
  ExpectKept("walk.h5", three);
  Run({"dataset", "subset", set, "--where", "label != walk or person == bob", "-o", Path("rest.h5")});
  const Result merged = Run({"dataset", "merge", Path("rest.h5"), Path("walk.h5"), "-o", Path("merged.h5"), "--json"});
  EXPECT_THAT(CodesOf(merged), ::testing::Not(Contains("field_dropped")));
  ExpectKept("merged.h5");

  WriteText(folder_ / "map.yaml", "walk: gait\n");
  Run({"dataset", "relabel", set, Path("map.yaml"), "-o", Path("relabelled.h5")});
  Changes relabelled;
  relabelled.classes = {"gait", "exercise/training, hard", "never"};
  for (const std::size_t row : {0, 2, 3}) relabelled.labels[set_.clips[row].id()] = "gait";
  ExpectKept("relabelled.h5", relabelled);

  const std::string cut = set_.clips[0].id(), dropped = set_.clips[1].id(), other = set_.clips[2].id();
  WriteText(folder_ / "decisions.yaml", "decisions:\n  - {clip: '" + cut + "', decision: cut, begin: 5, end: 25}\n" +
                                            "  - {clip: '" + dropped + "', decision: drop}\n" + "  - {clip: '" + other +
                                            "', decision: relabel, label: never}\n");
  Run({"dataset", "apply", set, Path("decisions.yaml"), "-o", Path("reviewed.h5"), "--excluded", Path("excluded.h5")});
  Changes reviewed;
  reviewed.origins["studio/anna/take 1#5-25"] = {0, 5};
  reviewed.labels[other] = "never";
  reviewed.clips = 3;
  ExpectKept("reviewed.h5", reviewed);
  Changes one;
  one.clips = 1;
  ExpectKept("excluded.h5", one);

  Run({"audit", set, "--with-findings", Path("audited.h5")});
  ExpectKept("audited.h5");
}

TEST_F(DatasetsOfDatasets, StayThemselvesWhenTheyAreFittedAgain) {
  const std::string set = Path("set.h5");
  const std::vector<std::string> names = ExportedNames("set.h5");
  EXPECT_EQ(names.size(), 4u);
  Fit("set.h5", {"--contacts"}, "standing.h5");
  ExpectKept("standing.h5");
  EXPECT_EQ(ReadDataset(folder_ / "standing.h5")->clips[3].fit_rms, 0.02);
  EXPECT_EQ(ExportedNames("standing.h5"), names);

  Fit("set.h5", FitTo("smpl24"), "again.h5");
  ExpectKept("again.h5");
  const Result fitted = Fit("set.h5", FitTo("openni15"), "other.h5");
  EXPECT_THAT(CodesOf(fitted), ElementsAre("field_dropped"));
  Changes other;
  other.dropped = {"/frames/joint_mark"};
  ExpectKept("other.h5", other);
  EXPECT_EQ(ReadDataset(folder_ / "other.h5")->skeleton->name, "openni15");
  const Dataset refitted = *ReadDataset(folder_ / "other.h5");
  for (const Clip& clip : refitted.clips) {
    const auto before = std::find_if(set_.clips.begin(), set_.clips.end(),
                                     [&](const Clip& candidate) { return candidate.id() == clip.id(); });
    ASSERT_NE(before, set_.clips.end());
    EXPECT_EQ(clip.evidence_sha256, before->evidence_sha256) << "of its recording, or unknown";
  }
  EXPECT_EQ(ExportedNames("other.h5"), names);

  const nlohmann::json diff = Run({"dataset", "diff", set, Path("other.h5"), "--json"}).Json();
  EXPECT_EQ(diff["equal"], 0);
  EXPECT_EQ(diff["refitted"].size(), 4u);
  EXPECT_TRUE(diff["refitted"][0]["joint_mm"].is_null());
  EXPECT_THAT(diff["splits_removed"], IsEmpty());
  EXPECT_THAT(diff["moved"], IsEmpty());
  EXPECT_THAT(diff["changed"], IsEmpty());
  std::vector<std::string> fields;
  for (const nlohmann::json& one : diff["dataset"]) fields.push_back(one["field"]);
  EXPECT_THAT(fields, UnorderedElementsAre("skeleton", "recipe", "other_fields"));

  Fit("set.h5", {"--contacts", "--clip", set_.clips[2].id()}, "one.h5");
  Changes one;
  one.clips = 1;
  ExpectKept("one.h5", one);
}

/// Joints in one plane cannot be fitted; the other clips keep all.
TEST_F(DatasetsOfDatasets, LoseTheClipThatCannotBeFittedAlone) {
  Dataset joints = set_;
  joints.joints_only = true;
  for (Clip& clip : joints.clips) {
    JointPositions positions = clip.motion->joints;
    for (std::size_t i = 2; clip.id() == set_.clips[1].id() && i < positions.xyz.size(); i += 3) positions.xyz[i] = 0.5;
    clip.motion = MakeJointsOnly(joints.skeleton, clip.rate, positions);
  }
  ASSERT_TRUE(test::WriteWithOtherFields(joints, folder_ / "joints.h5"));
  std::vector<std::string> more = FitTo("smpl24");
  more.insert(more.end(), {"--set", "ingest.source.checks.not_joint_positions.action=report"});
  const Result fitted = Fit("joints.h5", more, "fitted.h5");
  EXPECT_EQ(fitted.exit_code, 1);
  EXPECT_THAT(CodesOf(fitted), UnorderedElementsAre("clip_not_fitted", "empty_part", "empty_part"));
  EXPECT_EQ(fitted.Json()["findings"][0]["clip"], set_.clips[1].id());
  Changes three;
  three.clips = 3;
  ExpectKept("fitted.h5", three);
  EXPECT_THAT(ReadDataset(folder_ / "fitted.h5")->FindSplit("persons")->test, ElementsAre(1, 2));
}

TEST_F(DatasetsOfDatasets, LoseWhatTheirFilesDoNotShareWithAFinding) {
  const auto with_person = [&](const std::string& person) {
    Dataset others = set_;
    for (Clip& clip : others.clips) clip.identity.person = person + clip.identity.person;
    others.findings.clear();
    for (Clip& clip : others.clips) clip.motion->joints.at(0, 0) += Vector3d(0.0, 0.0, 1e-5);
    return others;
  };
  ASSERT_TRUE(WriteDataset(with_person("plain "), folder_ / "plain.h5"));
  const Result plain = Run({"dataset", "merge", Path("set.h5"), Path("plain.h5"), "-o", Path("a.h5"), "--json"});
  const std::set<std::string> all = {"/clips/score",       "/clips/note", "/frames/mark",
                                     "/frames/joint_mark", "/about_it",   "/@doi"};
  const auto dropped = [&](const std::string& name) {
    std::set<std::string> fields;
    const auto made = ReadDataset(folder_ / name);
    EXPECT_TRUE(made) << made.error().Message();
    for (const Finding& finding : made->findings) {
      if (finding.code == "field_dropped") fields.insert(finding.message.substr(0, finding.message.find(':')));
    }
    return fields;
  };
  EXPECT_EQ(dropped("a.h5"), all);
  EXPECT_THAT(CodesOf(plain), Contains("field_dropped").Times(static_cast<int>(all.size())));

  ASSERT_TRUE(test::WriteWithOtherFields(with_person("other "), folder_ / "other.h5"));
  Run({"dataset", "merge", Path("set.h5"), Path("other.h5"), "-o", Path("b.h5")});
  EXPECT_THAT(dropped("b.h5"), IsEmpty());
  const auto clips = DatasetClips::Open(folder_ / "b.h5", DatasetClips::Check::kHashes);
  ASSERT_TRUE(clips) << clips.error().Message();
  EXPECT_EQ(clips->ReadOtherFields().of_clips.at("/clips/note").texts.size(), 8u);

  // The same clips with other marks: the first file's are not taken for both.
  Dataset last = set_;
  last.clips.erase(last.clips.begin());
  for (Split& split : last.splits) split = {split.name, {0}, {}, {1}, split.rule, "ok"};
  last.findings.clear();
  ASSERT_TRUE(test::WriteWithOtherFields(last, folder_ / "last.h5"));
  Run({"dataset", "merge", Path("set.h5"), Path("last.h5"), "-o", Path("c.h5")});
  EXPECT_EQ(dropped("c.h5"), (std::set<std::string>{"/clips/score", "/frames/mark", "/frames/joint_mark"}));
}

}  // namespace
}  // namespace mocurate
