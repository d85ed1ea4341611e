// The review page, driven by keys in a headless browser; canon reads its YAML.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "canon/review/review.h"
#include "core/motion/motion.h"
#include "report/stages.h"
#include "tests/report/browser.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A dataset of three clips with a suspect label and a pair with the same motion.
struct SmallReview {
  ScratchFolder folder;
  Dataset dataset;
  nlohmann::json decisions = nlohmann::json::array();
  nlohmann::json audit = {{"findings", nlohmann::json::array()}};

  SmallReview() {
    dataset.skeleton = Walker();
    dataset.labels = {"step", "wave </script>"};
    for (int i = 0; i < 3; ++i) {
      Clip clip;
      clip.identity = {"set", "p" + std::to_string(i), "r", "", "", "", 0, 40 + i};
      clip.label = "step";
      clip.rate = FrameRate{30, 1};
      clip.motion = Stepping(dataset.skeleton, 40 + i);
      dataset.clips.push_back(std::move(clip));
    }
    Add("label_suspect", 0, "wave </script>");
    Add("duplicate", 1, dataset.clips[2].id());
  }

  void Add(const char* code, std::size_t clip, const std::string& suggested) {
    audit["findings"].push_back({{"clip", dataset.clips[clip].id()},
                                 {"code", code},
                                 {"severity", "warning"},
                                 {"frame_begin", 10},
                                 {"frame_end", 20},
                                 {"value", 0.1},
                                 {"suggested", suggested},
                                 {"message", "a <b>message</b>"}});
  }

  Expected<StageOutcome> Make() {
    EXPECT_TRUE(WriteDataset(dataset, folder / "set.h5"));
    EXPECT_TRUE(WriteFile(folder / "audit.json", audit.dump()));
    EXPECT_TRUE(WriteFile(folder / "earlier.json", decisions.dump()));
    StageRequest request{"review", "review", OptionsToJson(ReviewOptions()), {}, folder / "index.html", {}};
    request.inputs = {{"dataset", "set.h5", folder / "set.h5", ""},
                      {"audit", "audit.json", folder / "audit.json", ""},
                      {"decisions", "earlier", folder / "earlier.json", ""}};
    return ReviewStage(request);
  }

  /// The decisions after keys were pressed, as the page would save them.
  Expected<Review> Press(const std::vector<std::string>& keys, int clips = 3) {
    std::string page = *ReadFile(folder / "index.html");
    const std::string script =
        "<script>window.addEventListener('load', () => { for (const key of " + nlohmann::json(keys).dump() +
        ") document.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true})); });</script></body>";
    page.replace(page.rfind("</body>"), 7, script);
    EXPECT_TRUE(WriteFile(folder / "index.html", page));
    EXPECT_EQ(Browse(folder, "--disable-3d-apis --virtual-time-budget=2000 --dump-dom"), 0);
    EXPECT_THAT(ReadFile(folder / "log.txt").value_or(""), Not(HasSubstr("CONSOLE")));
    const std::string document = *ReadFile(folder / "dom.html");
    EXPECT_THAT(document, HasSubstr("data-review=\"" + std::to_string(clips) + "\""));
    EXPECT_THAT(document, HasSubstr("data-stage=\"canvas\"")) << "the viewer, here without WebGL";
    std::smatch yaml;
    EXPECT_TRUE(std::regex_search(document, yaml, std::regex("<textarea[^>]*>([^<]*)</textarea>")));
    std::string text = yaml[1];
    for (const auto& [escaped, plain] : {std::pair("&lt;", "<"), std::pair("&gt;", ">"), std::pair("&amp;", "&")}) {
      text = std::regex_replace(text, std::regex(escaped), plain);
    }
    EXPECT_TRUE(WriteFile(folder / "decisions.yaml", text));
    return ReadReview(folder / "decisions.yaml");
  }
};

TEST(ReviewInABrowser, KeysDecideAndCanonReadsWhatIsSaved) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  SmallReview set;
  Decision earlier;
  earlier.clip = set.dataset.clips[1].id();
  earlier.finding = "frozen_frames";
  earlier.verdict = Verdict::kKeep;
  set.decisions.push_back(OptionsToJson(earlier));
  ASSERT_TRUE(set.Make());
  // Relabel the first, keep the second, undo that, begin of the second at the viewer's frame (10), cut; drop the third,
  // replace that by a cut without frames, then drop it again.
  const auto review = set.Press({"r", "j", "k", "u", "[", "c", "j", "c", "d"});
  ASSERT_TRUE(review) << review.error().Message();
  ASSERT_EQ(review->decisions.size(), 4u);
  EXPECT_EQ(review->decisions[0].finding, "frozen_frames");
  EXPECT_EQ(review->decisions[1].verdict, Verdict::kRelabel);
  EXPECT_EQ(review->decisions[1].label, "wave </script>");
  EXPECT_EQ(review->decisions[1].content, MotionFingerprint(*set.dataset.clips[0].motion));
  EXPECT_EQ(review->decisions[2].verdict, Verdict::kCut);
  EXPECT_EQ(review->decisions[2].begin, 10);
  EXPECT_EQ(review->decisions[2].end, 41);
  EXPECT_EQ(review->decisions[3].verdict, Verdict::kDrop);
  EXPECT_EQ(review->decisions[3].clip, set.dataset.clips[2].id());
  EXPECT_EQ(review->decisions[3].other, set.dataset.clips[1].id());
  const auto applied = ApplyReview(*review, set.dataset);
  ASSERT_TRUE(applied) << applied.error().Message();
  EXPECT_EQ(set.dataset.clips.size(), 2u);
}

TEST(ReviewInABrowser, APairAloneIsShownAndNoClassIsNoLabel) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  SmallReview set;
  set.audit["findings"].erase(0);
  set.dataset.clips[1].label = "";
  ASSERT_TRUE(set.Make());
  const auto review = set.Press({"r", "j", "d"}, 2);
  ASSERT_TRUE(review) << review.error().Message();
  ASSERT_EQ(review->decisions.size(), 1u) << "a clip without a class is not relabelled before one is chosen";
  EXPECT_EQ(review->decisions[0].clip, set.dataset.clips[2].id());
}

TEST(ReviewPage, AuditsOfOtherDatasetsAreRefusedAndTheSameInputGivesTheSameBytes) {
  SmallReview set;
  ASSERT_TRUE(set.Make());
  const std::string page = *ReadFile(set.folder / "index.html");
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"http")));
  EXPECT_THAT(page, Not(HasSubstr("a <b>message")));
  ASSERT_TRUE(set.Make());
  EXPECT_EQ(*ReadFile(set.folder / "index.html"), page);
  for (nlohmann::json& finding : set.audit["findings"]) finding["clip"] = "";
  const auto of_set = set.Make();
  ASSERT_TRUE(of_set) << "findings about the set have no clip";
  EXPECT_EQ(of_set->summary.at("shown"), 0);
  for (nlohmann::json& finding : set.audit["findings"]) finding["clip"] = "other/p/r#0-4";
  EXPECT_EQ(set.Make().error().code, ErrorCode::kInconsistent);
  set.audit = {1, 2};
  EXPECT_EQ(set.Make().error().code, ErrorCode::kMalformed);
}

TEST(ReviewPage, FindingsOfOtherTypesAreRefusedWithTheirPlace) {
  for (const char* change : {"7", "{}", R"({"clip": 1})", R"({"code": []})", R"({"message": null})"}) {
    SmallReview set;
    nlohmann::json& finding = set.audit["findings"][1];
    const nlohmann::json other = nlohmann::json::parse(change);
    if (other.is_object() && !other.empty()) {
      finding.update(other);
    } else {
      finding = other;
    }
    const auto page = set.Make();
    ASSERT_FALSE(page) << change;
    EXPECT_EQ(page.error().code, ErrorCode::kMalformed) << change;
    EXPECT_EQ(page.error().where, "audit.json: /findings/1") << change;
  }
}

}  // namespace
}  // namespace mocurate::test
