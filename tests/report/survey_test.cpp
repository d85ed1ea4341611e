// A survey: drawing, page, saved answers and tally.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <regex>
#include <set>

#include "core/motion/operations.h"
#include "core/store/body_file.h"
#include "eval/survey/survey_tally.h"
#include "report/stages.h"
#include "report/survey.h"
#include "tests/report/browser.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Sources with this number of motions of each label.
std::vector<SurveySource> SourcesWith(const std::vector<std::string>& names, int motions, int labels = 2) {
  std::vector<SurveySource> sources;
  for (const std::string& name : names) {
    SurveySource source{name, {{name + "/unlabelled", ""}}};
    for (int k = 0; k < labels; ++k) {
      const std::string label = "label" + std::to_string(k);
      for (int i = 0; i < motions; ++i) source.motions.push_back({name + "/" + label + "-" + std::to_string(i), label});
    }
    sources.push_back(std::move(source));
  }
  return sources;
}

SurveyOptions OfKind(SurveyKind kind, std::int64_t questions = 0) {
  SurveyOptions options;
  options.kind = kind;
  options.questions = questions;
  return options;
}

/// Motions shown of each source; fails where a clip is shown twice or has another label than its question.
std::map<std::string, int> CountShown(const SurveyKey& key) {
  std::map<std::string, int> count;
  std::set<std::string> clips;
  for (const SurveyQuestion& question : key.questions) {
    for (const ShownMotion& one : question.shown) {
      ++count[one.source];
      EXPECT_TRUE(clips.insert(one.clip).second) << one.clip << " is shown twice";
      EXPECT_THAT(one.clip, StartsWith(one.source + "/" + question.label + "-"));
    }
  }
  return count;
}

TEST(SurveyDraw, ARankingShowsOneMotionOfEachSourceAndNoneTwice) {
  const std::vector<SurveySource> sources = SourcesWith({"A", "B", "C"}, 8, 3);
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kRanking), sources)->questions.size(), 3u) << "one for each label";
  const SurveyOptions options = OfKind(SurveyKind::kRanking, 24);
  const auto key = DrawSurvey(options, sources);
  ASSERT_TRUE(key) << key.error().Message();
  EXPECT_THAT(CountShown(*key), ElementsAre(std::pair("A", 24), std::pair("B", 24), std::pair("C", 24)));
  std::set<std::string> orders, labels;
  for (std::size_t q = 0; q < 24; ++q) {
    std::string order;
    for (const ShownMotion& one : key->questions[q].shown) order += one.source;
    orders.insert(order);
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, "ABC");
    if (q % 3 == 0) labels.clear();
    EXPECT_TRUE(labels.insert(key->questions[q].label).second) << "rounds over the labels";
  }
  EXPECT_EQ(orders.size(), 6u) << "every order of three is drawn";
  EXPECT_EQ(KeyToJson(*key), KeyToJson(*DrawSurvey(options, sources)));
  SurveyOptions other = options;
  other.seed = 2;
  EXPECT_NE(KeyToJson(*key).at("questions"), KeyToJson(*DrawSurvey(other, sources)).at("questions"));
}

TEST(SurveyDraw, HalfOfTheMotionsOfRealOrFakeAreReal) {
  const auto key = DrawSurvey(OfKind(SurveyKind::kRealOrFake), SourcesWith({"A", "real", "B", "C"}, 4, 12));
  ASSERT_TRUE(key) << key.error().Message();
  ASSERT_EQ(key->questions.size(), 12u);
  EXPECT_THAT(CountShown(*key),
              ElementsAre(std::pair("A", 12), std::pair("B", 12), std::pair("C", 12), std::pair("real", 36)));
  std::set<std::string> labels;
  std::set<std::ptrdiff_t> numbers;
  for (const SurveyQuestion& question : key->questions) {
    EXPECT_EQ(question.shown.size(), 6u);
    labels.insert(question.label);
    numbers.insert(std::count_if(question.shown.begin(), question.shown.end(),
                                 [](const ShownMotion& one) { return one.source == "real"; }));
  }
  EXPECT_EQ(labels.size(), 12u);
  EXPECT_THAT(numbers, ::testing::IsSubsetOf({2, 3, 4}));
  EXPECT_THAT(numbers.size(), Gt(1u));
}

TEST(SurveyDraw, WhatCannotBeAskedIsRefused) {
  const auto refused = [](SurveyOptions options, const std::vector<SurveySource>& sources, const char* what,
                          ErrorCode code = ErrorCode::kUsage) {
    const auto key = DrawSurvey(options, sources);
    ASSERT_FALSE(key) << what;
    EXPECT_EQ(key.error().code, code) << what;
    EXPECT_THAT(key.error().what, HasSubstr(what));
    EXPECT_FALSE(key.error().hint.empty());
  };
  const SurveyOptions ranking = OfKind(SurveyKind::kRanking), real = OfKind(SurveyKind::kRealOrFake);
  refused(OfKind(SurveyKind::kRanking, 7), SourcesWith({"A", "B"}, 3), "source 'A' has 3 motions of the label 'label");
  refused(real, SourcesWith({"real", "B"}, 3), " are needed, because none is shown twice");
  refused(real, SourcesWith({"A", "B"}, 3), "no source has the name 'real'");
  refused(ranking, SourcesWith({"A"}, 3), "1 source, a ranking has 2 to 9");
  refused(ranking, SourcesWith({"1", "2", "3", "4", "5", "6", "7", "8", "9", "A"}, 1), "10 sources");
  refused(ranking, SourcesWith({"A", "A"}, 3), "two sources have the name 'A'");
  SurveyOptions of_label = ranking;
  of_label.labels = {"label0", "lable1"};
  refused(of_label, SourcesWith({"A", "B"}, 3), "source 'A' has no motions of the label 'lable1'");
  std::vector<SurveySource> others = SourcesWith({"A", "B"}, 1);
  for (SurveySource::Motion& motion : others[1].motions) motion.label = motion.label.empty() ? "" : "jump";
  refused(ranking, others, "no label in common", ErrorCode::kInconsistent);
  for (SurveySource::Motion& motion : others[1].motions) motion.label = "";
  refused(ranking, others, "none of its 3 motions has a label", ErrorCode::kInconsistent);
}

using Tally = nlohmann::ordered_json;

TEST(SurveyTally, WilsonIntervalsAreThoseOfTheBooks) {
  const auto eight = WilsonInterval(8, 10), none = WilsonInterval(0, 10), half = WilsonInterval(50, 100);
  EXPECT_NEAR((*eight)[0], 0.4901625, 1e-7);
  EXPECT_NEAR((*eight)[1], 0.9433178, 1e-7);
  EXPECT_EQ((*none)[0], 0.0);
  EXPECT_NEAR((*none)[1], 0.2775328, 1e-7);
  EXPECT_NEAR((*half)[0], 0.4038315, 1e-7);
  EXPECT_FALSE(WilsonInterval(0, 0));
}

/// Two questions that rank three sources at changing places.
SurveyKey KnownKey() {
  SurveyKey key;
  key.sources = {"A", "B", "C"};
  key.labels = {"throw", "walk"};
  key.questions = {{"q001", "walk", {{"A", "a", "f"}, {"B", "b", "f"}, {"C", "c", "f"}}},
                   {"q002", "throw", {{"C", "c2", "f"}, {"B", "b2", "f"}, {"A", "a2", "f"}}}};
  return key;
}

/// The same questions as real or fake, A recorded.
SurveyKey JudgedKey() {
  SurveyKey key = KnownKey();
  key.kind = SurveyKind::kRealOrFake;
  key.real = "A";
  return key;
}

TEST(SurveyTally, RanksCountForTheSourceAtWhicheverPlaceItStands) {
  const Tally tally = TallySurvey(KnownKey(), {{"p1", {{1, 2, 3}, {3, 2, 1}}}, {"p2", {{1, 2, 3}, {1, 3, 2}}}});
  ASSERT_EQ(tally["rows"].size(), 9u) << "three sources with all labels and each of two";
  const Tally& a = tally["rows"][0];
  EXPECT_EQ(a["source"], "A");
  EXPECT_TRUE(a["label"].is_null());
  EXPECT_THAT(a["ranks"], ElementsAre(3, 1, 0));
  EXPECT_EQ(a["mean_rank"], 1.25);
  EXPECT_EQ(a["first"]["share"], 0.75);
  EXPECT_EQ(a["first_two"]["share"], 1.0);
  EXPECT_TRUE(a["first"]["bootstrap_95"]["low"].is_null()) << "two participants";
  EXPECT_THAT(tally["rows"][7]["ranks"], ElementsAre(1, 0, 1)) << "C in throw";
  EXPECT_THAT(TallyToCsv(tally["rows"]), HasSubstr("\nA,throw,2,1,1,0,1.5000,1,0.5000,0.0945,0.9055,,,2,1.0000,"));
  ASSERT_EQ(tally["differences"].size(), 3u);
  EXPECT_EQ(tally["differences"][1]["second"], "C");
  EXPECT_EQ(tally["differences"][1]["difference"], -1.25) << "of p1 -2, of p2 -0.5";
  EXPECT_EQ(tally["differences"][1]["p"], 0.5) << "2 of 4 sign patterns are as large";
  EXPECT_EQ(tally["differences"][1]["p_holm"], 1.0);
  EXPECT_THAT(TallyToCsv(tally["differences"]), HasSubstr("\nA,C,-1.2500,2,0.5000,1.0000\n"));
  EXPECT_THAT(TallyToMarkdown(tally), HasSubstr("With fewer than 6 participants no p is below 0.05."));
  EXPECT_TRUE(TallySurvey(KnownKey(), {{"p1", {{1, 2, 3}, {3, 2, 1}}}})["differences"][0]["p"].is_null())
      << "one participant";
}

TEST(SurveyTally, JudgementsCountForEachSourceAndForAllGenerated) {
  const Tally tally = TallySurvey(JudgedKey(), {{"p1", {{1, 1, 2}, {2, 2, 1}}}, {"p2", {{1, 2, 2}, {2, 1, 2}}}});
  ASSERT_EQ(tally["rows"].size(), 12u);
  EXPECT_EQ(tally["rows"][0]["judged_real"]["share"], 0.75) << "A";
  EXPECT_EQ(tally["rows"][9]["source"], kAllGenerated);
  EXPECT_EQ(tally["rows"][9]["votes"], 8);
  EXPECT_EQ(tally["rows"][9]["judged_real"]["share"], 0.25);
  ASSERT_EQ(tally["differences"].size(), 4u) << "three pairs, and real with all generated";
  EXPECT_EQ(tally["differences"][2]["second"], kAllGenerated);
  EXPECT_EQ(tally["differences"][2]["difference"], 0.5);
}

TEST(SurveyTally, ParticipantsWhoAlwaysAgreeWithThemselvesWidenTheBootstrapBeyondWilson) {
  SurveyKey key = KnownKey();
  std::vector<SurveyAnswers> answers(6);
  for (int i = 0; i < 6; ++i) answers[static_cast<std::size_t>(i)].participant = "p" + std::to_string(i);
  for (int q = 0; q < 4; ++q) key.questions.push_back(key.questions[0]);
  for (std::size_t i = 0; i < 6; ++i) {
    for (const SurveyQuestion& question : key.questions) {
      std::vector<int> ranks;
      for (const ShownMotion& one : question.shown)
        ranks.push_back(one.source == "B" ? 2 : (one.source == "A") == (i % 2 == 0) ? 1 : 3);
      answers[i].values.push_back(ranks);
    }
  }
  const Tally tally = TallySurvey(key, answers);
  const Tally& first = tally["rows"][0]["first"];
  const auto width = [&](const char* name) {
    return first[name]["high"].get<double>() - first[name]["low"].get<double>();
  };
  EXPECT_EQ(first["share"], 0.5);
  EXPECT_GT(width("bootstrap_95"), 1.4 * width("wilson_95"));
  EXPECT_EQ(tally, TallySurvey(key, answers));
}

/// Answers of people who see `quality` of each source with noise of their own: ranks, or real with this probability.
std::vector<SurveyAnswers> Simulated(const SurveyKey& key, const std::map<std::string, double>& quality, int people) {
  std::vector<SurveyAnswers> answers;
  for (int person = 0; person < people; ++person) {
    SurveyAnswers one{"p" + std::to_string(person), {}};
    Random random(5, "answers", one.participant);
    for (const SurveyQuestion& question : key.questions) {
      std::vector<double> seen;
      for (const ShownMotion& shown : question.shown) {
        const double own = quality.at(shown.source);
        seen.push_back(key.kind == SurveyKind::kRanking ? own + random.Normal() : random.Uniform() < own ? 1.0 : 2.0);
      }
      std::vector<int> values;
      for (const double value : seen) {
        const auto better = std::count_if(seen.begin(), seen.end(), [&](double other) { return other > value; });
        values.push_back(static_cast<int>(key.kind == SurveyKind::kRanking ? better + 1.0 : value));
      }
      one.values.push_back(std::move(values));
    }
    answers.push_back(std::move(one));
  }
  return answers;
}

const Tally& DifferenceOf(const Tally& tally, const std::string& first, const std::string& second) {
  return *std::find_if(tally["differences"].begin(), tally["differences"].end(),
                       [&](const Tally& one) { return one["first"] == first && one["second"] == second; });
}

TEST(SurveyTally, TwentySimulatedPeopleGiveBackTheirPreferences) {
  const std::map<std::string, double> quality = {{"good", 2.0}, {"fair", 1.0}, {"same", 1.0}, {"poor", 0.0}};
  const SurveyKey key = *DrawSurvey(OfKind(SurveyKind::kRanking), SourcesWith({"good", "fair", "same", "poor"}, 1, 10));
  const Tally tally = TallySurvey(key, Simulated(key, quality, 20));
  const std::vector<SurveyAnswers> many = Simulated(key, quality, 1000);
  for (std::size_t row = 0; row < tally["rows"].size(); row += 11) {  // over all labels
    for (int k = 0; k < 2; ++k) {
      double share = 0.0;
      for (const SurveyAnswers& one : many) {
        for (std::size_t q = 0; q < 10; ++q) {
          for (std::size_t i = 0; i < 4; ++i) {
            if (key.questions[q].shown[i].source == tally["rows"][row]["source"] && one.values[q][i] <= k + 1)
              share += 1e-4;
          }
        }
      }
      const Tally& own = tally["rows"][row][k == 0 ? "first" : "first_two"]["bootstrap_95"];
      EXPECT_LE(own["low"], share) << row << " " << k;
      EXPECT_GE(own["high"], share) << row << " " << k;
    }
  }
  EXPECT_LT(tally["rows"][0]["mean_rank"], tally["rows"][11]["mean_rank"]);
  EXPECT_LT(tally["rows"][22]["mean_rank"], tally["rows"][33]["mean_rank"]);
  EXPECT_LT(DifferenceOf(tally, "good", "fair")["p_holm"], 0.001);
  EXPECT_LT(DifferenceOf(tally, "same", "poor")["p_holm"], 0.001);
  EXPECT_GT(DifferenceOf(tally, "fair", "same")["p"], 0.05);
}

TEST(SurveyTally, TwentySimulatedPeopleGiveBackWhatTheyTakeForReal) {
  const std::map<std::string, double> quality = {{"real", 0.9}, {"ours", 0.6}, {"other", 0.6}};
  const SurveyKey key = *DrawSurvey(OfKind(SurveyKind::kRealOrFake), SourcesWith({"real", "ours", "other"}, 4, 12));
  const Tally tally = TallySurvey(key, Simulated(key, quality, 20));
  ASSERT_EQ(tally["rows"].size(), 52u);
  for (const auto& [row, share] : {std::pair(0, 0.9), std::pair(13, 0.6), std::pair(26, 0.6), std::pair(39, 0.6)}) {
    const Tally& one = tally["rows"][static_cast<std::size_t>(row)];
    for (const char* interval : {"wilson_95", "bootstrap_95"}) {
      EXPECT_LE(one["judged_real"][interval]["low"], share) << one["source"];
      EXPECT_GE(one["judged_real"][interval]["high"], share) << one["source"];
    }
  }
  EXPECT_LT(DifferenceOf(tally, "real", "ours")["p_holm"], 0.001);
  EXPECT_LT(DifferenceOf(tally, "real", kAllGenerated)["p_holm"], 0.001);
  EXPECT_GT(DifferenceOf(tally, "ours", "other")["p"], 0.05);
}

TEST(SurveyTally, WithoutAnswersFilesSayThatThereAreNone) {
  for (const SurveyKey& key : {KnownKey(), JudgedKey()}) {
    const Tally tally = TallySurvey(key, {});
    EXPECT_EQ(tally["rows"][0]["votes"], 0);
    EXPECT_TRUE(tally["differences"][0]["difference"].is_null());
    EXPECT_THAT(TallyToSvg(tally), HasSubstr("no answers"));
    EXPECT_THAT(TallyToMarkdown(tally), HasSubstr("no answers"));
  }
}

TEST(SurveyTally, NamesAreNeitherMarkupNorFormulas) {
  SurveyKey key = KnownKey();
  key.labels[0] = key.questions[1].label = "=1+1";
  key.sources[0] = key.questions[0].shown[0].source = key.questions[1].shown[2].source = "<b>A</b>";
  const Tally tally = TallySurvey(key, {{"p", {{1, 2, 3}, {3, 2, 1}}}});
  EXPECT_THAT(TallyToCsv(tally["rows"]), HasSubstr("\nB,'=1+1,"));
  EXPECT_THAT(TallyToSvg(tally), Not(HasSubstr("<b>")));
  EXPECT_THAT(TallyToMarkdown(tally), Not(HasSubstr("| <b>")));
  EXPECT_THAT(TallyToMarkdown(tally), HasSubstr("| &lt;b>A&lt;/b> | \\=1+1 |"));
}

TEST(SurveyFiles, WhatWasEditedIsRefusedWithItsPlace) {
  const auto good_answers = [](const SurveyKey& key, const nlohmann::json& answer) {
    nlohmann::json good = {{"survey", SurveyId(key)}, {"participant", "p-1"}, {"missing", nlohmann::json::array()}};
    for (const SurveyQuestion& question : key.questions) {
      good["answers"].push_back({{"question", question.id}, {"answer", answer}});
    }
    return good;
  };
  const SurveyKey key = KnownKey(), judged = JudgedKey();
  const nlohmann::json good = good_answers(key, {3, 1, 2});
  const auto read = ReadSurveyAnswers(good.dump(), "a.json", key);
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_THAT(read->values[1], ElementsAre(3, 1, 2));
  const nlohmann::json words = good_answers(judged, {"real", "generated", "generated"});
  EXPECT_THAT(ReadSurveyAnswers(words.dump(), "a.json", judged)->values[1], ElementsAre(1, 2, 2));
  EXPECT_EQ(ReadSurveyAnswers(words.dump(), "a.json", key).error().where, "a.json: /survey") << "of another survey";

  const auto refused = [&](const nlohmann::json& patch, ErrorCode code, const std::string& place) {
    const auto edited = ReadSurveyAnswers(good.patch(patch).dump(), "a.json", key);
    ASSERT_FALSE(edited) << patch;
    EXPECT_EQ(edited.error().code, code) << patch;
    EXPECT_EQ(edited.error().where, "a.json: " + place) << patch;
    EXPECT_FALSE(edited.error().hint.empty());
  };
  const auto replace = [](const char* path, const nlohmann::json& value) {
    return nlohmann::json::array({{{"op", "replace"}, {"path", path}, {"value", value}}});
  };
  const auto remove = [](const char* path) { return nlohmann::json::array({{{"op", "remove"}, {"path", path}}}); };
  refused(replace("/participant", "../p"), ErrorCode::kMalformed, "/participant");
  refused(replace("/answers/1/question", "q009"), ErrorCode::kMalformed, "/answers/1/question");
  refused(replace("/answers/1/question", "q001"), ErrorCode::kMalformed, "/answers/1/question");
  for (const nlohmann::json& answer :
       {nlohmann::json(1), nlohmann::json({1, 2}), nlohmann::json({1, 2, 2}), nlohmann::json({0, 1, 2}),
        nlohmann::json({1, 2, 4}), nlohmann::json({1, 2, nullptr}), nlohmann::json({1.5, 2, 3}),
        nlohmann::json({"real", "real", "real"}), nlohmann::json({1, 2, 18446744073709551615ULL})}) {
    refused(replace("/answers/1/answer", answer), ErrorCode::kMalformed, "/answers/1/answer");
  }
  refused(replace("/answers/1", "left"), ErrorCode::kMalformed, "/answers/1");
  refused(remove("/answers/1"), ErrorCode::kInconsistent, "/answers");
  refused(remove("/missing"), ErrorCode::kMalformed, "/");
  refused(nlohmann::json::array({{{"op", "add"}, {"path", "/weight"}, {"value", 2}}}), ErrorCode::kMalformed, "/");
  const std::string text = good.dump(1);
  EXPECT_EQ(ReadSurveyAnswers(text.substr(0, text.size() - 2), "a.json", key).error().code, ErrorCode::kMalformed);
  EXPECT_EQ(ReadSurveyAnswers("{\n \"survey\": x}", "a.json", key).error().where, "a.json:2:12");
  EXPECT_EQ(
      ReadSurveyAnswers(std::regex_replace(good.dump(), std::regex("\"answer\":"), "\"answer\":[],$&"), "a.json", key)
          .error()
          .code,
      ErrorCode::kMalformed)
      << "a repeated key";

  for (const SurveyKey& one : {key, judged}) {
    const std::string written = KeyToJson(one).dump();
    ASSERT_TRUE(ReadSurveyKey(written, "key.json"));
    EXPECT_EQ(SurveyId(*ReadSurveyKey(written, "key.json")), SurveyId(one));
    EXPECT_EQ(ReadSurveyKey(std::regex_replace(written, std::regex("\"source\":\"A\""), "\"source\":\"B\""), "key.json")
                  .error()
                  .code,
              ErrorCode::kInconsistent);
  }
}

constexpr const char* kOurs = "Zwölfkämpfer-VAE";
constexpr const char* kTheirs = "quartz_baseline";

/// The joints of a rigged body as a skeleton.
SkeletonPtr SkeletonOfBody(const BodyTemplate& body) {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "body";
  for (int j = 0; j < body.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    Joint joint;
    joint.name = body.joint_names[at];
    joint.parent = body.parents[at];
    if (j > 0) joint.rest_offset = body.rest.joints[at] - body.rest.joints[static_cast<std::size_t>(joint.parent)];
    std::string partner = joint.name;
    if (partner.rfind("left_", 0) == 0)
      partner = "right_" + partner.substr(5);
    else if (partner.rfind("right_", 0) == 0)
      partner = "left_" + partner.substr(6);
    joint.mirror = static_cast<int>(std::find(body.joint_names.begin(), body.joint_names.end(), partner) -
                                    body.joint_names.begin());
    skeleton->joints.push_back(std::move(joint));
  }
  return skeleton;
}

/// Two sources of motions as files, and the page that the stage makes of them.
struct AskedSurvey {
  ScratchFolder folder;
  SurveyOptions options;
  std::filesystem::path body;

  explicit AskedSurvey(SurveyOptions asked, const SkeletonPtr& skeleton = Walker()) : options(std::move(asked)) {
    options.real = kTheirs;
    for (const char* name : {kOurs, kTheirs}) {
      Dataset dataset;
      dataset.skeleton = skeleton;
      dataset.labels = {"walk", "a </script> throw"};
      for (int i = 0; i < 8; ++i) {
        Clip clip;
        clip.identity = {name, "person" + std::to_string(i), "take", "", "", "", 0, 45};
        clip.label = dataset.labels[static_cast<std::size_t>(i % 2)];
        clip.rate = FrameRate{30, 1};
        clip.motion = Stepping(dataset.skeleton, name == kOurs ? 45 : 40 + i);
        dataset.clips.push_back(name == kOurs ? clip : Mirror(clip));
      }
      const auto written = WriteDataset(dataset, folder / (std::string(name) + ".h5"));
      EXPECT_TRUE(written) << written.error().Message();
    }
  }

  Expected<StageOutcome> Make() const {
    StageRequest request{"survey", "survey", OptionsToJson(options), {}, folder / "index.html", {}};
    for (const char* name : {kOurs, kTheirs}) {
      request.inputs.push_back({"motions", name, folder / (std::string(name) + ".h5"), ""});
    }
    if (!body.empty()) request.inputs.push_back({"body", "body", body, ""});
    return SurveyStage(request);
  }

  /// What the page asks ("survey-data") and shows ("viewer-index").
  nlohmann::json Data(const char* id) const {
    const std::string page = *ReadFile(folder / "index.html"), head = "id=\"" + std::string(id) + "\">";
    const std::size_t begin = page.find(head) + head.size();
    return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  }

  /// Opens the page in a browser, where `script` then runs; the document.
  std::string Open(const std::string& script, const std::string& flags = "") const {
    std::string page = *ReadFile(folder / "index.html");
    page.replace(
        page.rfind("</body>"), 7,
        "<script>window.addEventListener('load', () => {" + std::string(kHelpers) + script + "});</script></body>");
    EXPECT_TRUE(WriteFile(folder / "index.html", page));
    EXPECT_EQ(Browse(folder, "--virtual-time-budget=3000 --dump-dom " + flags), 0);
    // Without a graphics card Chromium reports that copying from WebGL waits.
    const std::string log = ReadFile(folder / "log.txt").value_or("");
    EXPECT_THAT(std::regex_replace(log, std::regex(".*GPU stall.*"), ""), Not(HasSubstr("CONSOLE")));
    return ReadFile(folder / "dom.html").value_or("");
  }

  static constexpr const char* kHelpers = R"js(
    const key = k => document.activeElement.dispatchEvent(
      new KeyboardEvent('keydown', {key: k, bubbles: true, cancelable: true}));
    const here = () => [...document.querySelectorAll('.question')].find(one => !one.hidden);
    const number = () => here() ? Number(here().querySelector('p').textContent.split(' ')[1]) : 0;
    const tap = button => {
      for (const type of ['pointerdown', 'pointerup'])
        button.dispatchEvent(new PointerEvent(type, {pointerType: 'touch', bubbles: true}));
      button.click();
    };
    const note = (name, value) => document.documentElement.setAttribute('data-note-' + name, value);
    // The browser does not end while a file is being saved: the file's name is noted instead.
    HTMLAnchorElement.prototype.click = function() { note('file', this.download); };
  )js";
};

/// The answers that a page has saved.
Expected<SurveyAnswers> SavedIn(const std::string& document, const SurveyKey& key) {
  std::smatch saved;
  EXPECT_TRUE(std::regex_search(document, saved, std::regex("<textarea id=\"answers\"[^>]*>([^<]*)</textarea>")));
  return ReadSurveyAnswers(saved[1].str(), "answers.json", key);
}

TEST(SurveyPage, NothingTellsTheSource) {
  AskedSurvey survey(OfKind(SurveyKind::kRanking, 6));
  const auto made = survey.Make();
  ASSERT_TRUE(made) << made.error().Message();
  const std::string page = *ReadFile(survey.folder / "index.html");
  for (const char* hint :
       {kOurs, kTheirs, "Zw", "quartz", "person0", "person1", "/take", "http://", "https://", "</script> throw"}) {
    EXPECT_THAT(page, Not(HasSubstr(hint)));
  }
  EXPECT_EQ(made->summary.at("motions"), 12);
  EXPECT_TRUE(made->summary.at("notes").empty());
  const auto key = ReadSurveyKey(made->summary.at("key").dump(), "key");
  ASSERT_TRUE(key) << key.error().Message();
  EXPECT_THAT(page, HasSubstr(SurveyId(*key)));
  std::set<std::size_t> lengths;
  const nlohmann::json data = survey.Data("survey-data");
  for (const nlohmann::json& question : data.at("questions")) {
    std::set<std::size_t> own;
    for (const nlohmann::json& motion : question.at("motions"))
      own.insert(survey.Data("viewer-index").at("clips").at(motion.get<std::size_t>()).at("frames").get<std::size_t>());
    EXPECT_EQ(own.size(), 1u) << "motions of a question last equally long";
    lengths.insert(own.begin(), own.end());
  }
  EXPECT_THAT(lengths.size(), Gt(1u)) << "as long as the shortest of the question";
  for (const SurveyQuestion& question : key->questions) {
    for (const ShownMotion& shown : question.shown) EXPECT_EQ(shown.fingerprint.size(), 16u);
  }
  ASSERT_TRUE(survey.Make());
  EXPECT_EQ(*ReadFile(survey.folder / "index.html"), page);
  survey.options.seconds = 0.5;
  EXPECT_EQ(survey.Make()->summary.at("notes").size(), 1u) << "shorter than a second";
  EXPECT_EQ(survey.Data("viewer-index").at("clips")[0].at("frames"), 15);
}

TEST(SurveyPage, MotionsOfOneLengthAreWindowsAtRandomPlaces) {
  AskedSurvey survey(OfKind(SurveyKind::kRanking, 8));
  survey.options.seconds = 0.2;
  const auto made = survey.Make();
  ASSERT_TRUE(made) << made.error().Message();
  std::set<std::string> windows;  // all motions of kOurs are equal
  for (const nlohmann::json& question : made->summary.at("key").at("questions")) {
    for (const nlohmann::json& shown : question.at("shown")) {
      if (shown.at("source") == kOurs) windows.insert(shown.at("motion").get<std::string>());
    }
  }
  EXPECT_THAT(windows.size(), Gt(4u));
}

TEST(SurveyInABrowser, RankingsByKeysAndByTouchAreKeptSavedAndCounted) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  AskedSurvey survey(OfKind(SurveyKind::kRanking, 4));
  const auto made = survey.Make();
  ASSERT_TRUE(made) << made.error().Message();
  const SurveyKey key = *ReadSurveyKey(made->summary.at("key").dump(), "key");
  nlohmann::json best = nlohmann::json::array();  // place of kOurs
  for (const SurveyQuestion& question : key.questions) best.push_back(question.shown[0].source == kOurs ? 0 : 1);
  // kOurs is first in all questions but the third. The second is ranked wrongly, then corrected on the way back; a half
  // ranking is no answer; a file with open questions is not saved at once; the last is answered after a reload.
  const std::string document = survey.Open("const best = " + best.dump() + R"js(;
    const press = i => tap(here().querySelectorAll('.answer')[i]);
    const text = () => document.getElementById('answers').value;
    const enter = () => document.activeElement === document.getElementById('next') ? tap(document.activeElement) : key('Enter');
    if (!sessionStorage.again) {
      key(String(best[0] + 1)); key('Enter'); const stays = number();
      key(String(2 - best[0])); enter();
      press(1 - best[1]); press(best[1]); enter(); key('b');
      press(1 - best[1]); press(1 - best[1]);
      key('n'); key(String(2 - best[2])); key(String(best[2] + 1)); enter();
      key(String(best[3] + 1));
      key('s');
      sessionStorage.refused = text() === '' && stays === 1;
      sessionStorage.again = 'yes';
      const field = document.getElementById('participant');
      field.value = 'reader_1';
      field.dispatchEvent(new Event('input', {bubbles: true}));
      for (let i = 0; i < 3e8; ++i);  // the browser's store takes its time, which the virtual clock does not give
      location.reload();
    } else {
      note('refused', sessionStorage.refused);
      note('here', number());
      note('half', here().querySelectorAll('.shown[data-rank]').length);
      key('s'); key('s');
      note('missing', JSON.parse(text()).missing.join());
      note('small', [...document.querySelectorAll('button')].filter(
        one => one.offsetHeight > 0 && one.offsetHeight < 44).length);
      press(1 - best[3]); enter();
      note('end', !document.getElementById('end').hidden);
      key('s');
    }
  )js");
  for (const char* expected :
       {"survey=\"4\"", "note-refused=\"true\"", "note-here=\"4\"", "note-half=\"1\"", "note-missing=\"q004\"",
        "note-small=\"0\"", "note-end=\"true\"", "note-file=\"answers_reader_1.json\""}) {
    EXPECT_THAT(document, HasSubstr(std::string("data-") + expected));
  }
  const auto answers = SavedIn(document, key);
  ASSERT_TRUE(answers) << answers.error().Message();
  EXPECT_EQ(answers->participant, "reader_1");
  const Tally tally = TallySurvey(key, {*answers});
  EXPECT_EQ(tally["rows"][0]["source"], kOurs);
  EXPECT_THAT(tally["rows"][0]["ranks"], ElementsAre(3, 1));
}

TEST(SurveyInABrowser, SkinnedBodiesAreJudgedByKeysAndByTouch) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  SurveyOptions options = OfKind(SurveyKind::kRealOrFake, 2);
  options.clips = 4;
  const std::filesystem::path file = std::filesystem::path(data) / "body_cc0/body_cc0.h5";
  const auto body = ReadBodyTemplate(file);
  ASSERT_TRUE(body) << body.error().Message();
  AskedSurvey survey(options, SkeletonOfBody(*body));
  survey.body = file;
  const auto made = survey.Make();
  ASSERT_TRUE(made) << made.error().Message();
  EXPECT_THAT(*ReadFile(survey.folder / "index.html"), Not(HasSubstr("quartz")));
  const SurveyKey key = *ReadSurveyKey(made->summary.at("key").dump(), "key");
  nlohmann::json real = nlohmann::json::array();
  for (const SurveyQuestion& question : key.questions) {
    real.push_back(nlohmann::json::array());
    for (const ShownMotion& one : question.shown) real.back().push_back(one.source == kTheirs);
  }
  // The recordings are judged real, and the first motion too. A blue pixel is one of a body.
  const std::string document =
      survey.Open("const real = " + real.dump() + R"js(;
    const blues = [...here().querySelectorAll('canvas')].map(canvas => {
      const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      let blue = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i + 2] - data[i] > 30) ++blue;
      return blue / (canvas.width * canvas.height);
    });
    note('bodies', blues.filter(share => share > 0.004 && share < 0.4).length);
    for (const is of real[0]) key(is ? 'r' : 'g');
    key('1'); key('r');
    key('n');
    here().querySelectorAll('.shown').forEach((one, i) => tap(one.querySelectorAll('.answer')[real[1][i] ? 0 : 1]));
    note('pressed', here().querySelectorAll('.answer[aria-pressed=true]').length);
    tap(document.activeElement);
    key('s');
  )js",
                  "--use-angle=swiftshader --enable-unsafe-swiftshader --virtual-time-budget=300");
  EXPECT_THAT(document, HasSubstr("data-note-bodies=\"4\""));
  EXPECT_THAT(document, HasSubstr("data-note-pressed=\"4\""));
  const auto answers = SavedIn(document, key);
  ASSERT_TRUE(answers) << answers.error().Message();
  const int first_is_real = key.questions[0].shown[0].source == kTheirs ? 1 : 0;
  const Tally tally = TallySurvey(key, {*answers});
  EXPECT_EQ(tally["rows"][3]["source"], kTheirs);
  EXPECT_EQ(tally["rows"][3]["judged_real"]["share"], 1.0);
  EXPECT_EQ(tally["rows"][0]["judged_real"]["votes"], 1 - first_is_real);

  ASSERT_TRUE(survey.Make());
  const std::string without =
      survey.Open("note('said', !document.getElementById('no-webgl').hidden);", "--disable-3d-apis");
  EXPECT_THAT(without, HasSubstr("data-note-said=\"true\""));
}

TEST(SurveyPage, MotionsWithoutRotationsHaveNoSkin) {
  AskedSurvey survey(OfKind(SurveyKind::kRanking));
  for (const char* name : {kOurs, kTheirs}) {
    Dataset dataset = *ReadDataset(survey.folder / (std::string(name) + ".h5"));
    dataset.joints_only = true;
    for (Clip& clip : dataset.clips) clip.motion = MakeJointsOnly(dataset.skeleton, clip.rate, clip.motion->joints);
    ASSERT_TRUE(WriteDataset(dataset, survey.folder / (std::string(name) + ".h5")));
  }
  ASSERT_TRUE(survey.Make());
  survey.body = "body.h5";
  const auto made = survey.Make();
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(made.error().hint, HasSubstr("mocurate fit FILE --skeleton smpl24"));
}

}  // namespace
}  // namespace mocurate::test
