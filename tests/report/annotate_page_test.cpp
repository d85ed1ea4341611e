// The page on which a person marks spans, driven in a headless browser; its CSV is what canon cuts by.

#include "report/annotate_page.h"
#include "core/motion/operations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "canon/recipes/spans_file.h"
#include "report/stages.h"
#include "tests/report/browser.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Helpers for the scripts below: key('[', {shiftKey: true}), drag(card, from, to) as shares of the timeline's width,
/// type(card, field, text), click(card, selector), and note(name, value), which Driven::Noted returns.
/// timeline's width, type(card, field, text), click(card, selector), and note(name, value), which Driven::Noted gives.
constexpr const char* kHands = R"js(
  const cards = [...document.querySelectorAll('.annotated')];
  HTMLAnchorElement.prototype.click = () => {};  // the browser does not end while a file is being saved
  const key = (k, more) => document.dispatchEvent(
    new KeyboardEvent('keydown', {key: k, bubbles: true, cancelable: true, ...more}));
  const times = (n, f) => { for (let i = 0; i < n; ++i) f(); };
  const ahead = n => {
    times(Math.floor(n / 10), () => key('ArrowRight', {shiftKey: true}));
    times(n % 10, () => key('ArrowRight'));
  };
  const drag = (card, from, to) => {
    const track = cards[card].querySelector('.track'), box = track.getBoundingClientRect();
    const at = (type, share, target) => target.dispatchEvent(new PointerEvent(
      type, {clientX: box.left + share * box.width, clientY: box.bottom - 20, bubbles: true}));
    at('pointerdown', from, track); at('pointermove', to, document); at('pointerup', to, document);
  };
  const dragEnd = (card, i, to) => {
    const button = cards[card].querySelectorAll('.span')[i];
    const box = cards[card].querySelector('.track').getBoundingClientRect();
    const at = (type, x, target) => target.dispatchEvent(new PointerEvent(type, {clientX: x, bubbles: true}));
    at('pointerdown', button.getBoundingClientRect().right - 2, button);
    at('pointermove', box.left + to * box.width, document); at('pointerup', box.left + to * box.width, document);
  };
  const type = (card, field, text) => {
    const input = cards[card].querySelector(field);
    input.value = text;
    for (const event of ['input', 'change']) input.dispatchEvent(new Event(event, {bubbles: true}));
  };
  const click = (card, selector) => cards[card].querySelector(selector).click();
  const note = (name, value) => document.documentElement.setAttribute('data-note-' + name, value);
  const spans = card => cards[card].querySelectorAll('.span').length;
  const visible = () => cards.filter(card => card.getClientRects().length > 0).length;
)js";

/// A page after a person worked on it.
struct Driven {
  std::string document;
  std::string csv;  ///< as saved

  std::string Noted(const std::string& name) const {
    std::smatch found;
    return std::regex_search(document, found, std::regex("data-note-" + name + "=\"([^\"]*)\"")) ? found[1].str() : "";
  }
};

/// A dataset of four clips of three seconds: one empty, one with segments, one with a label, and one that begins two
/// seconds into its recording.
struct Recordings {
  ScratchFolder folder;
  Dataset dataset;
  AnnotateOptions options;
  std::string session;  ///< a table of spans, or empty

  Recordings() {
    dataset.skeleton = Walker();
    dataset.labels = {"step", "wave \"x\" </script>"};
    for (int i = 0; i < 4; ++i) {
      Clip clip;
      clip.identity = {"set", "p" + std::to_string(i), "r", "", "", "", i == 3 ? 60 : 0, i == 3 ? 150 : 90};
      clip.label = i == 2 ? "step" : "";
      clip.rate = FrameRate{30, 1};
      clip.motion = Stepping(dataset.skeleton, 90);
      dataset.clips.push_back(std::move(clip));
    }
    dataset.clips[1].segments = {
        {0.5, 1.0, "step", "", "annotated"}, {1.0, 2.0, "", "", "proposed"}, {2.0, 2.9, "turn", "", "proposed"}};
  }

  Expected<StageOutcome> Make() {
    EXPECT_TRUE(WriteDataset(dataset, folder / "set.h5"));
    StageRequest request{"annotate", "annotate", OptionsToJson(options), {}, folder / "index.html", {}};
    request.inputs = {{"dataset", "set.h5", folder / "set.h5", ""}};
    if (!session.empty()) {
      EXPECT_TRUE(WriteFile(folder / "spans.csv", session));
      request.inputs.push_back({"spans", "spans.csv", folder / "spans.csv", ""});
    }
    return AnnotateStage(request);
  }

  /// Runs a script on the page that was made, then saves.
  Driven Work(const std::string& script) {
    std::string page = *ReadFile(folder / "index.html");
    page.replace(
        page.rfind("</body>"), 7,
        std::string("<script>window.addEventListener('load', () => {") + kHands + script + "});</script></body>");
    EXPECT_TRUE(WriteFile(folder / "index.html", page));
    EXPECT_EQ(Browse(folder, "--virtual-time-budget=20000 --dump-dom"), 0);
    EXPECT_THAT(ReadFile(folder / "log.txt").value_or(""), Not(HasSubstr("CONSOLE")));
    Driven driven{ReadFile(folder / "dom.html").value_or(""), ""};
    std::smatch text;
    EXPECT_TRUE(std::regex_search(driven.document, text, std::regex("<textarea[^>]*>([^<]*)</textarea>")));
    driven.csv = text[1];
    for (const auto& [escaped, plain] : {std::pair("&lt;", "<"), std::pair("&gt;", ">"), std::pair("&amp;", "&")}) {
      driven.csv = std::regex_replace(driven.csv, std::regex(escaped), plain);
    }
    return driven;
  }
};

TEST(AnnotatingInABrowser, SpansThatAreMarkedByKeysAndDragsAreSavedKeptAndReadByCanon) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  Recordings set;
  ASSERT_TRUE(set.Make());
  // Frames 10 to 30; then, from the end to the begin, 30 back to 20; one frame is no span; a backwards drag whose end
  // is dragged further; a new label needs confirmation. Afterwards the page is reloaded.
  const Driven driven = set.Work(R"js(
    const before = sessionStorage;
    if (before.again) {
      note('spans', spans(0));
      for (const name of ['unmade', 'refused']) note(name, before[name]);
      return key('s');
    }
    ahead(10); key('['); ahead(20); key(']'); key('1');
    key(']'); key('ArrowLeft', {shiftKey: true}); key('['); key('2');
    key('['); key(']'); before.unmade = spans(0);
    drag(0, 2.5 / 3, 1.5 / 3); type(0, '.label', 'skip, hop');
    key('s'); before.refused = document.getElementById('csv').value === '';
    click(0, '.add'); dragEnd(0, 2, 2.7 / 3); key('s');
    before.again = 'yes';
    location.reload();
  )js");
  EXPECT_THAT(driven.document, HasSubstr("data-annotate=\"3\"")) << "clips with a label are not shown";
  EXPECT_EQ(driven.Noted("unmade"), "2");
  EXPECT_EQ(driven.Noted("refused"), "true") << "nothing is saved while a span has no label";
  EXPECT_EQ(driven.Noted("spans"), "3");
  EXPECT_EQ(driven.csv,
            "clip,begin_s,end_s,label\n"
            "set/p0/r,0.333,1.033,step\n"
            "set/p0/r,0.667,1.033,\"wave \"\"x\"\" </script>\"\n"
            "set/p0/r,1.500,2.700,\"skip, hop\"\n"
            "set/p1/r,0.500,1.000,step\n");
  ASSERT_TRUE(WriteFile(set.folder / "spans.csv", driven.csv));
  const auto read = ReadSpans(set.folder / "spans.csv");
  ASSERT_TRUE(read) << read.error().Message();
  std::vector<Finding> findings;
  Clip clip = set.dataset.clips[0];
  ApplySpans(*read, clip, findings);
  ASSERT_EQ(clip.segments.size(), 3u);
  EXPECT_EQ(clip.segments[1].label, "wave \"x\" </script>");
  EXPECT_NEAR(clip.segments[2].end_s, 2.7, 1e-9);
  EXPECT_TRUE(findings.empty());
}

TEST(AnnotatingInABrowser, ProposedSpansAreAcceptedAdjustedRemovedAndUndone) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  Recordings set;
  ASSERT_TRUE(set.Make());
  // The proposal without a label gets one and another end; the other is accepted with the clip; the segment of the
  // dataset is removed, which is taken back and done again. The last clip's times are those of its recording.
  const Driven driven = set.Work(R"js(
    note('unconfirmed', document.getElementById('labels').children.length);
    key('j'); key('.'); key('.'); key('2'); ahead(20); key('}');
    key(','); key('Delete'); note('removed', spans(1)); key('z', {ctrlKey: true}); note('back', spans(1));
    key('y', {ctrlKey: true}); key('f'); key('d');
    note('visible', visible()); note('count', document.getElementById('progress').value);
    ahead(15); key('b'); ahead(15); key('e'); key('1'); type(2, '.end', '4'); type(2, '.begin', ''); key('s');
  )js");
  EXPECT_EQ(driven.Noted("unconfirmed"), "3") << "the label of a span is in the list";
  EXPECT_EQ(driven.Noted("removed"), "2");
  EXPECT_EQ(driven.Noted("back"), "3");
  EXPECT_EQ(driven.Noted("visible"), "2");
  EXPECT_EQ(driven.Noted("count"), "1");
  EXPECT_EQ(driven.csv,
            "clip,begin_s,end_s,label\n"
            "set/p1/r,1.000,1.700,\"wave \"\"x\"\" </script>\"\n"
            "set/p1/r,2.000,2.900,turn\n"
            "set/p3/r,2.500,4.000,step\n");
}

TEST(AnnotatingInABrowser, AnEarlierSessionGoesOnAndSpansOfOtherClipsAreSavedAgain) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  Recordings set;
  set.session =
      "clip,begin_s,end_s,label,fine_label\n"
      "set/p1/r#0-90,1,2,step,slow\n"
      "set/p3/r,2.5,3.5,turn,\n"
      "set/p3/r,0.5,1.5,before,\n"
      "other/p/r,0,1,else,\n";
  const auto made = set.Make();
  ASSERT_TRUE(made) << made.error().Message();
  EXPECT_EQ(made->summary.at("spans"), 2);
  EXPECT_EQ(made->summary.at("not_shown"), 2);
  EXPECT_EQ(made->summary.at("unknown"), 1);
  const Driven driven = set.Work("note('count', document.getElementById('progress').value); key('s');");
  EXPECT_EQ(driven.Noted("count"), "2") << "clips with spans of the session are done";
  EXPECT_EQ(driven.csv,
            "clip,begin_s,end_s,label,fine_label\n"
            "other/p/r,0.000,1.000,else,\n"
            "set/p1/r,1.000,2.000,step,slow\n"
            "set/p3/r,0.500,1.500,before,\n"
            "set/p3/r,2.500,3.500,turn,\n");
  set.session = "clip,begin_frame,end_frame,label\nset/p1/r,30,60,step\nother/p/r,0,30,else\n";
  const auto in_frames = set.Make();
  ASSERT_TRUE(in_frames) << in_frames.error().Message();
  EXPECT_EQ(in_frames->summary.at("excluded"), 1) << "of an unknown rate";
  EXPECT_THAT(*ReadFile(set.folder / "index.html"), HasSubstr(R"("begin_s":1.0,"end_s":2.0,"label":"step")"));
}

TEST(AnnotatingInABrowser, OnlyCardsNearTheWindowHoldPlayers) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  Recordings set;
  for (int i = 0; i < 36; ++i) {
    set.dataset.clips.push_back(set.dataset.clips[0]);
    set.dataset.clips.back().identity.person = "q" + std::to_string(10 + i);
  }
  // A timeline that was never drawn has the width of HTML, a released one has none.
  const char* script = R"js(
    const drawn = () => cards.filter(card => ![0, 300].includes(card.querySelector('.track canvas').width));
    const when = (ready, then, tries = 350) =>
      ready() || tries === 0 ? then() : setTimeout(() => when(ready, then, tries - 1), 50);
    key(' ');
    when(() => cards[0].querySelector('input[type=range]').value > 0 && drawn().includes(cards[0]), () => {
      note('first', drawn().length < 12 && drawn().includes(cards[0]));
      note('played', cards[0].querySelector('input[type=range]').value > 0);
      times(38, () => key('j'));
      when(() => drawn().includes(cards[38]) && !drawn().includes(cards[0]), () => {
        note('last', drawn().length < 12 && drawn().includes(cards[38]) && !drawn().includes(cards[0]));
      });
    });
  )js";
  // The browser's virtual time does not wait for pictures: where the machine is busy it may end before they are drawn.
  Driven driven;
  const auto drawn = [&driven] {
    return driven.Noted("played") == "true" && driven.Noted("first") == "true" && driven.Noted("last") == "true";
  };
  for (int attempt = 0; attempt < 5 && !drawn(); ++attempt) {
    ASSERT_TRUE(set.Make());
    driven = set.Work(script);
  }
  EXPECT_EQ(driven.Noted("played"), "true");
  EXPECT_EQ(driven.Noted("first"), "true");
  EXPECT_EQ(driven.Noted("last"), "true");
}

TEST(AnnotatePage, ItsSizeIsBoundedItLoadsNothingAndTheSameInputGivesTheSameBytes) {
  Recordings set;
  set.options.all = true;
  ASSERT_EQ(set.Make()->summary.at("poses_per_second"), 15.0);
  const std::string page = *ReadFile(set.folder / "index.html");
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
  EXPECT_EQ(page.find("x\" </script>\""), std::string::npos) << "a label cannot end the script";
  ASSERT_TRUE(set.Make());
  EXPECT_EQ(*ReadFile(set.folder / "index.html"), page);
  set.options.poses_bytes = 2000.0;
  const auto thin = set.Make();
  EXPECT_EQ(thin->summary.at("clips"), 4);
  EXPECT_LT(thin->summary.at("poses_per_second"), 5.0);
  EXPECT_LT(thin->summary.at("bytes").get<std::size_t>(), page.size());
}

TEST(AnnotatePage, ClipsAreChosenAndWhatFitsNothingIsRefused) {
  Recordings set;
  set.options.clips = {"p2/r", "#0-90"};
  EXPECT_EQ(set.Make()->summary.at("clips"), 3);
  set.options.clips = {"unknown"};
  EXPECT_EQ(set.Make().error().code, ErrorCode::kUsage);
  set.options.clips.clear();
  set.session = "clip,begin_s,end_s,label\nanother/p/r,0,1,x\n";
  EXPECT_EQ(set.Make().error().code, ErrorCode::kInconsistent) << "spans of another dataset";
  set.session.clear();
  for (Clip& clip : set.dataset.clips) clip.label = "step";
  EXPECT_EQ(set.Make().error().code, ErrorCode::kInconsistent) << "every clip has a label";
}

TEST(AnnotatePage, SpeedsShowWhereMovementBegins) {
  Motion motion = Stepping(Walker(), 90);
  for (int f = 0; f < 90; ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      motion.joints.at(f, j) = motion.joints.at(0, j) + Vector3d(std::max(0, f - 45) / 30.0, 0.0, 0.0);
    }
  }
  const std::vector<double> speeds = FastestJointSpeeds(motion);
  EXPECT_NEAR(speeds[40], 0.0, 1e-12);
  EXPECT_NEAR(speeds[80], 1.0, 1e-9) << "m/s";
  const PackedSpeeds curve = PackSpeeds(speeds, 30);
  EXPECT_EQ(curve.values.size(), 30u);
  EXPECT_EQ(curve.values[0], 0);
  EXPECT_EQ(static_cast<unsigned char>(curve.values[28]), 255);
}

TEST(AnnotatePage, TimesCountFromTheFirstFrameOfTheRecording) {
  Clip clip;
  clip.motion = Stepping(Walker(), 30);
  clip.identity.begin_frame = 300;
  clip.identity.end_frame = 330;
  EXPECT_DOUBLE_EQ(BeginInRecording(clip), 10.0);
  clip.provenance["first_frame"] = "30";
  EXPECT_DOUBLE_EQ(BeginInRecording(clip), 11.0);
  clip.provenance.clear();
  clip.motion->rate = clip.rate = FrameRate{250, 1};
  clip.identity.begin_frame = 2500;
  EXPECT_DOUBLE_EQ(BeginInRecording(Resample(clip, FrameRate{20, 1})), 10.0);
}

}  // namespace
}  // namespace mocurate::test
