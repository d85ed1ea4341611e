#include "core/formats/babel.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using nlohmann::ordered_json;

const char* const kDense = R"({"7692": {"babel_sid": 7692, "url": "https://x/007692.mp4",
 "feat_p": "CMU/CMU/141/a b_poses.npz", "dur": 3.83,
 "seq_ann": {"babel_lid": "l1", "anntr_id": "a1", "mul_act": true, "labels": [
   {"raw_label": "walks", "proc_label": "walk", "act_cat": ["walk"], "seg_id": "s1"}]},
 "frame_ann": {"babel_lid": "l2", "anntr_id": "a2", "mul_act": false, "labels": [
   {"raw_label": "turn", "proc_label": "turn", "act_cat": ["turn", "step"], "seg_id": "s2", "start_t": 2, "end_t": 3.834},
   {"raw_label": "walks", "proc_label": "walk", "act_cat": [], "seg_id": "s3", "start_t": 0, "end_t": 2.5},
   {"raw_label": null, "proc_label": null, "act_cat": null, "seg_id": "s4", "start_t": 2.5, "end_t": 2.5}]}},
 "12": {"babel_sid": 12, "url": "u", "feat_p": "f", "dur": 1, "seq_ann": null, "frame_ann": null}})";

const char* const kExtra = R"({"3": {"babel_sid": 3, "url": "u", "feat_p": "f", "dur": 2.5,
 "seq_anns": [{"babel_lid": "l", "anntr_id": "a", "mul_act": null, "labels": []}],
 "frame_anns": [{"babel_lid": "m", "anntr_id": "b", "mul_act": true, "labels": [
   {"raw_label": "r", "proc_label": "p", "act_cat": ["c"], "seg_id": "s", "start_t": 0.5, "end_t": 1}]},
   {"babel_lid": "n", "anntr_id": "c", "mul_act": true, "labels": []}]}})";

TEST(Babel, ReadsEveryFieldInFileOrder) {
  const auto babel = ParseBabel(kDense, "train.json");
  ASSERT_TRUE(babel) << babel.error().Message();
  ASSERT_EQ(babel->size(), 2u);
  const BabelSequence& first = (*babel)[0];
  EXPECT_EQ(first.key, "7692");
  EXPECT_EQ(first.babel_sid, 7692);
  EXPECT_EQ(first.feat_p, "CMU/CMU/141/a b_poses.npz");
  EXPECT_EQ(first.dur, 3.83);
  EXPECT_FALSE(first.extra);
  ASSERT_EQ(first.seq_anns.size(), 1u);
  EXPECT_EQ(first.seq_anns[0].mul_act, true);
  EXPECT_FALSE(first.seq_anns[0].labels[0].start_t);
  ASSERT_EQ(first.frame_anns.size(), 1u);
  const std::vector<BabelLabel>& labels = first.frame_anns[0].labels;
  ASSERT_EQ(labels.size(), 3u);
  EXPECT_EQ(labels[0].start_t, 2.0) << "labels keep the order of the file";
  EXPECT_EQ(labels[0].end_t, 3.834) << "past the duration";
  EXPECT_EQ(labels[0].act_cat->size(), 2u);
  EXPECT_EQ(labels[1].start_t, 0.0);
  EXPECT_TRUE(labels[1].act_cat->empty());
  EXPECT_FALSE(labels[2].act_cat);
  EXPECT_FALSE(labels[2].proc_label);
  EXPECT_TRUE((*babel)[1].frame_anns.empty());
}

TEST(Babel, ReadsSeveralAnnotatorsFromExtraFiles) {
  const auto babel = ParseBabel(kExtra, "extra_train.json");
  ASSERT_TRUE(babel) << babel.error().Message();
  EXPECT_TRUE((*babel)[0].extra);
  EXPECT_EQ((*babel)[0].frame_anns.size(), 2u);
  EXPECT_FALSE((*babel)[0].seq_anns[0].mul_act);
}

TEST(Babel, RoundTripsThroughTheWriter) {
  for (const char* text : {kDense, kExtra}) {
    const auto babel = ParseBabel(text, "b.json");
    ASSERT_TRUE(babel);
    const std::string bytes = EncodeBabel(*babel);
    EXPECT_EQ(nlohmann::json::parse(bytes), nlohmann::json::parse(text));
    EXPECT_EQ(EncodeBabel(ParseBabel(bytes, "b.json").value()), bytes);
  }
}

TEST(Babel, AllowsMissingBabelIdentifiers) {
  ordered_json without = ordered_json::parse(kDense);
  ordered_json& sequence = without["7692"];
  sequence.erase("url");
  for (const char* annotation : {"seq_ann", "frame_ann"}) {
    sequence[annotation].erase("babel_lid");
    sequence[annotation]["anntr_id"] = nullptr;
    for (ordered_json& label : sequence[annotation]["labels"]) label.erase("seg_id");
  }
  const auto babel = ParseBabel(without.dump(), "train.json");
  ASSERT_TRUE(babel) << babel.error().Message();
  EXPECT_EQ((*babel)[0].frame_anns[0].labels[1].proc_label, "walk");
  EXPECT_EQ((*babel)[0].frame_anns[0].babel_lid, "");
  const ordered_json again = ordered_json::parse(EncodeBabel(*babel));
  EXPECT_FALSE(again["7692"].contains("url"));
  EXPECT_FALSE(again["7692"]["frame_ann"]["labels"][0].contains("seg_id"));
  EXPECT_EQ(again["12"]["url"], "u");
}

TEST(Babel, ListsImpossibleTimesWithoutRejectingTheFile) {
  const auto babel = ParseBabel(kDense, "train.json");
  const std::vector<BabelProblem> problems = FindBabelProblems((*babel)[0]);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].where, "7692/frame_ann/labels/2");
  BabelSequence shorter = (*babel)[0];
  shorter.dur = 1.0;
  EXPECT_GT(FindBabelProblems(shorter).size(), 1u);
}

TEST(Babel, NamesEveryFieldOfAWrongType) {
  const ordered_json good = ordered_json::parse(kDense);
  const char* const paths[] = {"/7692",
                               "/7692/babel_sid",
                               "/7692/url",
                               "/7692/feat_p",
                               "/7692/dur",
                               "/7692/seq_ann",
                               "/7692/frame_ann",
                               "/7692/seq_ann/babel_lid",
                               "/7692/seq_ann/anntr_id",
                               "/7692/seq_ann/mul_act",
                               "/7692/seq_ann/labels",
                               "/7692/frame_ann/labels/1",
                               "/7692/frame_ann/labels/1/raw_label",
                               "/7692/frame_ann/labels/1/proc_label",
                               "/7692/frame_ann/labels/1/seg_id",
                               "/7692/frame_ann/labels/1/act_cat",
                               "/7692/frame_ann/labels/0/act_cat/1",
                               "/7692/frame_ann/labels/1/start_t",
                               "/7692/frame_ann/labels/1/end_t"};
  for (const std::string path : paths) {
    ordered_json bad = good;
    ordered_json& value = bad[ordered_json::json_pointer(path)];
    value = value.is_number() ? ordered_json("x") : ordered_json(-1.5);
    ExpectMalformed(ParseBabel(bad.dump(), "train.json"), "train.json:" + path);
  }
  ExpectMalformed(ParseBabel("{", "b.json"), "b.json:1:2");
  ExpectMalformed(ParseBabel("[1]", "b.json"), "b.json");
}

}  // namespace
}  // namespace mocurate
