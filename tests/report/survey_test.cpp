// A survey: drawing, page, saved answers and tally.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "core/motion/operations.h"
#include "report/stages.h"
#include "report/survey_tally.h"
#include "tests/report/browser.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Sources with this number of motions of each label.
std::vector<SurveySource> SourcesWith(const std::vector<std::string>& names, int motions) {
  std::vector<SurveySource> sources;
  for (const std::string& name : names) {
    SurveySource source{name, {{name + "/unlabelled", ""}}};
    for (const char* label : {"walk", "throw"}) {
      for (int i = 0; i < motions; ++i) source.motions.push_back({name + "/" + label + std::to_string(i), label});
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

TEST(SurveyDraw, EveryPairAndLabelIsAskedEquallyOftenAndNoMotionTwice) {
  const std::vector<SurveySource> sources = SourcesWith({"A", "B", "C"}, 4);
  const SurveyOptions options = OfKind(SurveyKind::kPreference, 24);
  const auto key = DrawSurvey(options, sources);
  ASSERT_TRUE(key) << key.error().Message();
  std::map<std::string, int> asked, left;
  std::set<std::string> shown;
  for (const SurveyQuestion& question : key->questions) {
    ASSERT_EQ(question.shown.size(), 2u);
    const std::string a = question.shown[0].source, b = question.shown[1].source;
    ++asked[std::min(a, b) + std::max(a, b) + question.label];
    ++left[std::min(a, b) + std::max(a, b) + " left " + a];
    for (const ShownMotion& one : question.shown) {
      EXPECT_THAT(one.clip, StartsWith(one.source + "/" + question.label));
      EXPECT_TRUE(shown.insert(std::min(a, b) + std::max(a, b) + one.clip).second) << one.clip;
    }
  }
  EXPECT_EQ(asked.size(), 6u);
  for (const auto& [what, count] : asked) EXPECT_EQ(count, 4) << what;
  EXPECT_EQ(left.size(), 6u);
  for (const auto& [what, count] : left) EXPECT_EQ(count, 4) << what;
  EXPECT_EQ(KeyToJson(*key), KeyToJson(*DrawSurvey(options, sources)));
  SurveyOptions other = options;
  other.seed = 2;
  EXPECT_NE(KeyToJson(*key).at("questions"), KeyToJson(*DrawSurvey(other, sources)).at("questions"));
}

TEST(SurveyDraw, WhatCannotBeAskedIsRefused) {
  const std::vector<SurveySource> sources = SourcesWith({"real", "B"}, 3);
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kRealOrFake), sources)->questions.size(), 12u);
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kRealOrFake, 13), sources).error().code, ErrorCode::kUsage);
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kPreference, 7), sources).error().code, ErrorCode::kUsage);
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kRealOrFake), SourcesWith({"A", "B"}, 3)).error().code, ErrorCode::kUsage)
      << "no source of recordings";
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kPreference), SourcesWith({"A"}, 3)).error().code, ErrorCode::kUsage);
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kPreference), SourcesWith({"A", "A"}, 3)).error().code, ErrorCode::kUsage);
  SurveyOptions options = OfKind(SurveyKind::kPreference);
  options.labels = {"wlak"};
  EXPECT_EQ(DrawSurvey(options, sources).error().code, ErrorCode::kUsage);
  std::vector<SurveySource> others = SourcesWith({"A", "B"}, 1);
  for (SurveySource::Motion& motion : others[1].motions) motion.label = motion.label.empty() ? "" : "jump";
  EXPECT_EQ(DrawSurvey(OfKind(SurveyKind::kPreference), others).error().code, ErrorCode::kInconsistent);
}

TEST(SurveyTally, WilsonIntervalsAreThoseOfTheBooks) {
  const auto eight = WilsonInterval(8, 10), none = WilsonInterval(0, 10), half = WilsonInterval(50, 100);
  EXPECT_NEAR(eight->low, 0.4901625, 1e-7);
  EXPECT_NEAR(eight->high, 0.9433178, 1e-7);
  EXPECT_EQ(none->low, 0.0);
  EXPECT_NEAR(none->high, 0.2775328, 1e-7);
  EXPECT_NEAR(half->low, 0.4038315, 1e-7);
  EXPECT_FALSE(WilsonInterval(0, 0));
}

/// Four questions about two sources, whose sides change.
SurveyKey KnownKey() {
  SurveyKey key;
  key.sources = {"A", "B"};
  key.labels = {"throw", "walk"};
  const auto ask = [&](const char* id, const char* label, const char* left, const char* right) {
    key.questions.push_back({id, label, {{left, "l", "f"}, {right, "r", "f"}}});
  };
  ask("q001", "walk", "A", "B");
  ask("q002", "walk", "B", "A");
  ask("q003", "throw", "B", "A");
  ask("q004", "walk", "A", "B");
  return key;
}

TEST(SurveyTally, VotesCountForTheSourceOnWhicheverSideItStands) {
  const SurveyKey key = KnownKey();
  const SurveyTally tally = TallySurvey(key, {{"for-A", {0, 1, 1, 0}}, {"but-q003", {0, 1, 0, 0}}});
  ASSERT_EQ(tally.rows.size(), 3u);
  const auto votes = [](const TallyRow& row) { return std::make_tuple(row.label, row.chosen, row.votes); };
  EXPECT_EQ(votes(tally.rows[0]), std::make_tuple("", 7, 8));
  EXPECT_EQ(votes(tally.rows[1]), std::make_tuple("throw", 1, 2));
  EXPECT_EQ(votes(tally.rows[2]), std::make_tuple("walk", 6, 6));
  EXPECT_FALSE(tally.rows[0].bootstrap) << "two participants";
  EXPECT_THAT(TallyToCsv(tally), HasSubstr("A,B,throw,1,2,0.5000,0.0945,0.9055,,\n"));

  SurveyKey judged = key;
  judged.kind = SurveyKind::kRealOrFake;
  judged.real = "A";
  for (SurveyQuestion& question : judged.questions) question.shown.pop_back();
  const SurveyTally real = TallySurvey(judged, {{"p", {0, 1, 0, 1}}});
  ASSERT_EQ(real.rows.size(), 6u);
  EXPECT_EQ(votes(real.rows[0]), std::make_tuple("", 1, 2)) << "A in q001 real, in q004 generated";
  EXPECT_EQ(votes(real.rows[3]), std::make_tuple("", 1, 2)) << "B in q003 real";
  EXPECT_EQ(votes(real.rows[1]), std::make_tuple("throw", 0, 0));
  EXPECT_FALSE(real.rows[1].wilson);
}

TEST(SurveyTally, ParticipantsWhoAlwaysAgreeWithThemselvesWidenTheBootstrapBeyondWilson) {
  std::vector<SurveyAnswers> answers;
  for (int i = 0; i < 6; ++i) {
    const int side = i % 2;  // for A or for B in all questions
    answers.push_back({"p" + std::to_string(i), {side, 1 - side, 1 - side, side}});
  }
  const SurveyTally tally = TallySurvey(KnownKey(), answers);
  const TallyRow& all = tally.rows[0];
  EXPECT_EQ(all.share(), 0.5);
  ASSERT_TRUE(all.bootstrap);
  EXPECT_GT(all.bootstrap->high - all.bootstrap->low, 1.5 * (all.wilson->high - all.wilson->low));
  EXPECT_EQ(TallyToJson(tally), TallyToJson(TallySurvey(KnownKey(), answers)));
}

TEST(SurveyTally, WithoutAnswersFilesSayThatThereAreNone) {
  const SurveyTally tally = TallySurvey(KnownKey(), {});
  EXPECT_EQ(TallyToJson(tally).at("rows")[0].at("votes"), 0);
  EXPECT_TRUE(TallyToJson(tally).at("rows")[0].at("share").is_null());
  EXPECT_THAT(TallyToSvg(tally), Not(HasSubstr("class=\"first\"")));
  EXPECT_THAT(TallyToSvg(tally), HasSubstr("no answers"));
  EXPECT_THAT(TallyToMarkdown(tally), HasSubstr("no answers"));
}

TEST(SurveyTally, NamesAreNeitherMarkupNorFormulas) {
  SurveyKey key = KnownKey();
  key.labels[0] = key.questions[2].label = "=1+1";
  key.sources[0] = "<b>A</b>";
  for (SurveyQuestion& question : key.questions) {
    for (ShownMotion& shown : question.shown) shown.source = shown.source == "A" ? key.sources[0] : shown.source;
  }
  const SurveyTally tally = TallySurvey(key, {{"p", {0, 1, 1, 0}}});
  EXPECT_THAT(TallyToCsv(tally), HasSubstr(",B,'=1+1,"));
  EXPECT_THAT(TallyToMarkdown(tally), Not(HasSubstr("| <b>")));
  EXPECT_THAT(TallyToMarkdown(tally), HasSubstr("| &lt;b>A&lt;/b> | B | \\=1+1 |"));
}

TEST(SurveyFiles, WhatWasEditedIsRefusedWithItsPlace) {
  const SurveyKey key = KnownKey();
  nlohmann::json good = {{"survey", SurveyId(key)}, {"participant", "p-1"}, {"missing", nlohmann::json::array()}};
  for (const SurveyQuestion& question : key.questions) {
    good["answers"].push_back({{"question", question.id}, {"answer", "left"}});
  }
  const auto read = ReadSurveyAnswers(good.dump(), "a.json", key);
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_THAT(read->choice, ElementsAre(0, 0, 0, 0));
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
  refused(replace("/survey", "0123456789abcdef"), ErrorCode::kInconsistent, "/survey");
  refused(replace("/participant", "../p"), ErrorCode::kMalformed, "/participant");
  refused(replace("/answers/2/question", "q009"), ErrorCode::kMalformed, "/answers/2/question");
  refused(replace("/answers/2/question", "q001"), ErrorCode::kMalformed, "/answers/2/question");
  refused(replace("/answers/1/answer", "real"), ErrorCode::kMalformed, "/answers/1/answer");
  refused(replace("/answers/1/answer", 1), ErrorCode::kMalformed, "/answers/1/answer");
  refused(replace("/answers/1", "left"), ErrorCode::kMalformed, "/answers/1");
  refused(replace("/missing", {"q002"}), ErrorCode::kMalformed, "/missing");
  refused(remove("/answers/3"), ErrorCode::kInconsistent, "/answers");
  refused(remove("/missing"), ErrorCode::kMalformed, "/");
  refused(nlohmann::json::array({{{"op", "add"}, {"path", "/weight"}, {"value", 2}}}), ErrorCode::kMalformed, "/");
  const std::string text = good.dump(1);
  EXPECT_EQ(ReadSurveyAnswers(text.substr(0, text.size() - 2), "a.json", key).error().code, ErrorCode::kMalformed);
  EXPECT_EQ(ReadSurveyAnswers("{\n \"survey\": x}", "a.json", key).error().where, "a.json:2:12");
  EXPECT_EQ(ReadSurveyAnswers(std::regex_replace(good.dump(), std::regex("\"answer\":"), "\"answer\":\"right\",$&"),
                              "a.json", key)
                .error()
                .code,
            ErrorCode::kMalformed)
      << "a repeated key";

  const std::string written = KeyToJson(key).dump();
  ASSERT_TRUE(ReadSurveyKey(written, "key.json"));
  EXPECT_EQ(SurveyId(*ReadSurveyKey(written, "key.json")), SurveyId(key));
  EXPECT_EQ(ReadSurveyKey(std::regex_replace(written, std::regex("\"source\":\"A\""), "\"source\":\"B\""), "key.json")
                .error()
                .code,
            ErrorCode::kInconsistent);
}

constexpr const char* kOurs = "Zwölfkämpfer-VAE";
constexpr const char* kTheirs = "quartz_baseline";

/// Two sources of motions as files, and the page that the stage makes of them.
struct AskedSurvey {
  ScratchFolder folder;
  SurveyOptions options = OfKind(SurveyKind::kPreference, 6);

  AskedSurvey() {
    for (const char* name : {kOurs, kTheirs}) {
      Dataset dataset;
      dataset.skeleton = Walker();
      dataset.labels = {"walk", "a </script> throw"};
      for (int i = 0; i < 8; ++i) {
        Clip clip;
        clip.identity = {name, "person" + std::to_string(i), "take", "", "", "", 0, 45};
        clip.label = dataset.labels[static_cast<std::size_t>(i % 2)];
        clip.rate = FrameRate{30, 1};
        clip.motion = Stepping(dataset.skeleton, name == kOurs ? 45 : 40 + i);
        dataset.clips.push_back(name == kOurs ? clip : Mirror(clip));
      }
      EXPECT_TRUE(WriteDataset(dataset, folder / (std::string(name) + ".h5")));
    }
  }

  Expected<StageOutcome> Make() const {
    StageRequest request{"survey", "survey", OptionsToJson(options), {}, folder / "index.html", {}};
    for (const char* name : {kOurs, kTheirs}) {
      request.inputs.push_back({"motions", name, folder / (std::string(name) + ".h5"), ""});
    }
    return SurveyStage(request);
  }
};

TEST(SurveyPage, ItReportsNoSourceLoadsNothingAndHasTheSameBytesAgain) {
  AskedSurvey survey;
  const auto made = survey.Make();
  ASSERT_TRUE(made) << made.error().Message();
  const std::string page = *ReadFile(survey.folder / "index.html");
  for (const char* hint :
       {kOurs, kTheirs, "Zw", "quartz", "person0", "person1", "/take", "http://", "https://", "</script> throw"}) {
    EXPECT_THAT(page, Not(HasSubstr(hint)));
  }
  EXPECT_EQ(made->summary.at("motions"), 12);
  EXPECT_EQ(made->summary.at("notes").size(), 1u) << "motions of different length";
  const auto key = ReadSurveyKey(made->summary.at("key").dump(), "key");
  ASSERT_TRUE(key) << key.error().Message();
  EXPECT_THAT(page, HasSubstr(SurveyId(*key)));
  for (const SurveyQuestion& question : key->questions) {
    for (const ShownMotion& shown : question.shown) EXPECT_EQ(shown.fingerprint.size(), 16u);
  }
  ASSERT_TRUE(survey.Make());
  EXPECT_EQ(*ReadFile(survey.folder / "index.html"), page);
  survey.options.seconds = 1.0;
  EXPECT_TRUE(survey.Make()->summary.at("notes").empty());
  survey.options.kind = SurveyKind::kRealOrFake;
  survey.options.real = kTheirs;
  ASSERT_TRUE(survey.Make());
  EXPECT_THAT(*ReadFile(survey.folder / "index.html"), Not(HasSubstr("quartz")));
}

TEST(SurveyInABrowser, AnswersByKeysAndClicksAreKeptSavedAndCounted) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  AskedSurvey survey;
  const auto made = survey.Make();
  ASSERT_TRUE(made) << made.error().Message();
  const SurveyKey key = *ReadSurveyKey(made->summary.at("key").dump(), "key");
  nlohmann::json ours = nlohmann::json::array();  // the side of kOurs
  for (const SurveyQuestion& question : key.questions) ours.push_back(question.shown[0].source == kOurs ? 0 : 1);
  // For kOurs in all questions but the fourth. The second is answered wrongly, then corrected on the way back; a file
  // with questions left open is not saved at once; the last two are answered after the page was loaded again.
  const std::string script = "const ours = " + ours.dump() + R"js(;
    const key = k => document.activeElement.dispatchEvent(
      new KeyboardEvent('keydown', {key: k, bubbles: true, cancelable: true}));
    const here = () => [...document.querySelectorAll('.question')].findIndex(one => !one.hidden);
    const press = side => document.querySelectorAll('.question')[here()].querySelectorAll('.answer')[side].click();
    const note = (name, value) => document.documentElement.setAttribute('data-note-' + name, value);
    const text = () => document.getElementById('answers').value;
    // The browser does not end while a file is being saved: the file's name is noted instead.
    HTMLAnchorElement.prototype.click = function() { note('file', this.download); };
    if (!sessionStorage.again) {
      key(String(ours[0] + 1)); press(1 - ours[1]); key('b'); press(ours[1]); press(ours[2]); key(String(2 - ours[3]));
      key('s');
      sessionStorage.refused = text() === '';
      sessionStorage.again = 'yes';
      const field = document.getElementById('participant');
      field.value = 'reader_1';
      field.dispatchEvent(new Event('input', {bubbles: true}));
      location.reload();
    } else {
      note('refused', sessionStorage.refused);
      note('here', here());
      note('bar', document.getElementById('progress').value);
      key(String(ours[4] + 1));
      key(' ');
      document.getElementById('save').click(); document.getElementById('save').click();
      note('missing', JSON.parse(text()).missing.join());
      key(String(ours[5] + 1));
      note('end', !document.getElementById('end').hidden);
      key('s');
      document.getElementById('forget').click();
    }
  )js";
  std::string page = *ReadFile(survey.folder / "index.html");
  page.replace(page.rfind("</body>"), 7,
               "<script>window.addEventListener('load', () => {" + script + "});</script></body>");
  ASSERT_TRUE(WriteFile(survey.folder / "index.html", page));
  ASSERT_EQ(Browse(survey.folder, "--virtual-time-budget=3000 --dump-dom"), 0);
  EXPECT_THAT(ReadFile(survey.folder / "log.txt").value_or(""), Not(HasSubstr("CONSOLE")));
  const std::string document = ReadFile(survey.folder / "dom.html").value_or("");
  EXPECT_THAT(document, HasSubstr("data-survey=\"6\""));
  EXPECT_THAT(document, HasSubstr("data-note-refused=\"true\""));
  EXPECT_THAT(document, HasSubstr("data-note-here=\"4\"")) << "continues at the first open question";
  EXPECT_THAT(document, HasSubstr("data-note-bar=\"4\""));
  EXPECT_THAT(document, HasSubstr("data-note-missing=\"q006\""));
  EXPECT_THAT(document, HasSubstr("data-note-end=\"true\""));
  EXPECT_THAT(document, HasSubstr("data-note-file=\"answers_reader_1.json\""));
  std::smatch saved;
  ASSERT_TRUE(std::regex_search(document, saved, std::regex("<textarea id=\"answers\"[^>]*>([^<]*)</textarea>")));
  const auto answers = ReadSurveyAnswers(saved[1].str(), "answers_reader_1.json", key);
  ASSERT_TRUE(answers) << answers.error().Message();
  EXPECT_EQ(answers->participant, "reader_1");
  const SurveyTally tally = TallySurvey(key, {*answers});
  EXPECT_EQ(tally.rows[0].first, kOurs);
  EXPECT_EQ(tally.rows[0].chosen, 5);
  EXPECT_EQ(tally.rows[0].votes, 6);
}

}  // namespace
}  // namespace mocurate::test
