// The viewer: what its pages hold, and what they do in a browser.

#include "report/viewer_data.h"
#include "report/viewer_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "core/base/pi.h"
#include "report/html.h"
#include "report/posed_body.h"
#include "tests/report/browser.h"
#include "tests/report/builders.h"
#include "tests/support/folders.h"

namespace mocurate::test {
namespace {

using ::testing::HasSubstr;

Clip ClipOf(const std::string& source, const std::string& recording, Motion motion) {
  Clip clip;
  clip.identity = {source, "p1", recording, "", "", "", 0, motion.frame_count()};
  clip.rate = motion.rate;
  clip.motion = std::move(motion);
  return clip;
}

/// Random rotations, places, states, deviations and contacts.
Motion Tumbling(int frames, Random& random) {
  Motion motion = Stepping(Walker(), frames);
  for (Vector3d& root : motion.root_translation)
    root = Vector3d(random.Uniform(-50, 50), random.Uniform(0, 2), random.Uniform(-9, 9));
  for (Quaterniond& turn : motion.rotation) {
    turn = ExpQuaternion(kPi * Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)));
  }
  motion = MakeMotion(motion.skeleton, motion.rate, motion.root_translation, motion.rotation, motion.bone_length);
  const auto cells = static_cast<std::size_t>(frames) * motion.joint_count();
  for (std::size_t i = 0; i < cells; ++i) {
    motion.state.push_back(static_cast<JointState>(i % 4));
    for (const float c : {1e-4F, 0.0F, 0.0F, 4e-4F, 0.0F, 1e-4F}) motion.position_cov.push_back(c);
  }
  for (int f = 0; f < 2 * frames; ++f) motion.contact.push_back(f % 3 == 0 ? 1 : 0);
  return motion;
}

template <class T>
std::vector<T> Next(const std::string& bytes, std::size_t& at, std::size_t count) {
  std::vector<T> values(count);
  std::memcpy(values.data(), bytes.data() + at, count * sizeof(T));
  at += (count * sizeof(T) + 3) / 4 * 4;
  return values;
}

TEST(ViewerData, AMotionComesBackWithinItsSteps) {
  Random random(7, "viewer");
  for (const int frames : {1, 2, 31}) {
    Motion motion = Tumbling(frames, random);
    const int joints = motion.joint_count();
    std::string bytes;
    ViewerData data([&](int, const std::string& part) {
      bytes = part;
      return Status();
    });
    const Clip clip = ClipOf("a", "r", motion);
    ViewedClip viewed{clip};
    viewed.clouds.resize(static_cast<std::size_t>(frames));
    for (int f = 0; f < frames; f += 2) viewed.clouds[f].assign(3, motion.joints.at(f, 0) + Vector3d(0.1, -0.2, 0.3));
    ASSERT_TRUE(data.Add(data.AddSource("a"), viewed));
    ASSERT_TRUE(data.Finish());
    const nlohmann::json index = data.Index(), &entry = index["clips"][0];
    EXPECT_EQ(entry["has"], (nlohmann::json{"rotations", "state", "sigma", "contact", "clouds"}));
    std::size_t at = 0;
    const auto cells = static_cast<std::size_t>(frames) * joints;
    const auto root = Next<float>(bytes, at, 3 * static_cast<std::size_t>(frames));
    const auto places = Next<std::int16_t>(bytes, at, 3 * cells), turns = Next<std::int16_t>(bytes, at, 3 * cells);
    const auto states = Next<std::uint8_t>(bytes, at, cells), sigmas = Next<std::uint8_t>(bytes, at, cells);
    const auto contacts = Next<std::uint8_t>(bytes, at, static_cast<std::size_t>(frames));
    const auto sizes = Next<std::uint16_t>(bytes, at, static_cast<std::size_t>(frames));
    const auto measured = Next<std::int16_t>(bytes, at, 9 * static_cast<std::size_t>((frames + 1) / 2));
    EXPECT_EQ(at, bytes.size());
    for (int f = 0; f < frames; ++f) EXPECT_EQ(sizes[f], f % 2 == 0 ? 3 : 0);
    EXPECT_NEAR(measured[measured.size() - 2], -2000, 1);
    const double step = 1e-4 * entry["unit"].get<int>();
    EXPECT_LE(step, 1e-4) << "a person is within 3.2 m of the root";
    for (int f = 0; f < frames; ++f) {
      EXPECT_EQ(contacts[f], (motion.contact[2 * f] != 0 ? 1 : 0) + (motion.contact[2 * f + 1] != 0 ? 2 : 0));
      for (int j = 0; j < joints; ++j) {
        const std::size_t cell = static_cast<std::size_t>(f) * joints + j;
        Vector3d place, turn;
        for (int i = 0; i < 3; ++i) {
          place[i] = root[3 * f + i] + step * places[3 * cell + i];
          turn[i] = kPi / 32767.0 * turns[3 * cell + i];
        }
        EXPECT_LT((place - motion.joints.at(f, j)).cwiseAbs().maxCoeff(), 0.51 * step);
        EXPECT_LT(ExpQuaternion(turn).angularDistance(motion.rotation[cell]), 1.5e-4);
        EXPECT_EQ(states[cell], static_cast<int>(motion.state[cell]));
        const double sigma = 1e-4 * (std::pow(2.0, sigmas[cell] / 16.0) - 1.0);
        EXPECT_NEAR(sigma, std::sqrt(2e-4), 0.03 * std::sqrt(2e-4));
      }
    }
  }
}

TEST(ViewerData, MissingJointsAreGapsAndFarOnesWidenTheStep) {
  Motion motion = Stepping(Walker(), 3);
  motion.rotation.clear();
  motion.root_translation.clear();
  motion.bone_length.clear();
  motion.joints.at(1, 4) = Vector3d::Constant(std::nan(""));
  motion.joints.at(2, 5) = Vector3d(0.0, 0.95, 3.0 + 20.0);
  motion.state.assign(27, JointState::kObserved);
  motion.state[0] = motion.state[3] = JointState::kInferred;  // a root is drawn nevertheless
  std::string bytes;
  ViewerData data([&](int, const std::string& part) {
    bytes = part;
    return Status();
  });
  const Clip clip = ClipOf("a", "r", motion);
  ASSERT_TRUE(data.Add(data.AddSource("a"), {clip}));
  ASSERT_TRUE(data.Finish());
  const nlohmann::json entry = data.Index()["clips"][0];
  EXPECT_EQ(entry["has"], (nlohmann::json{"state"}));
  EXPECT_EQ(entry["unit"], 7);
  std::size_t at = 36;
  const auto places = Next<std::int16_t>(bytes, at, 81);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(places[i], 0);
    for (const int missing : {3, 9 + 4}) EXPECT_EQ(places[3 * missing + i], -32768);
  }
  EXPECT_NEAR(places[3 * (18 + 5) + 2] * 7e-4, 20.0, 4e-4);
}

TEST(ViewerData, TracksOfARecordingAreBroughtToTheFramesAndTheWorldOfAClip) {
  JointTracks recorded;  // 30 Hz from 5 s on, one sample missing; the point moves 1 m/s along x
  recorded.names = {"left_knee"};
  for (int i = 0; i < 90; ++i) {
    if (i != 64) recorded.time_s.push_back(5.0 + i / 30.0);
  }
  recorded.positions = JointPositions(89, 1);
  for (int i = 0; i < 89; ++i) recorded.positions.at(i, 0) = Vector3d(recorded.time_s[i] - 5.0, 1.0, 0.0);
  recorded.confidence.assign(89, 0.5);
  Clip clip = ClipOf("a", "r", Stepping(Walker(), 10));
  clip.identity.begin_frame = 60;
  clip.identity.end_frame = 80;
  clip.motion->rate = clip.rate = FrameRate{15, 1};
  clip.provenance[kRecordedRate] = "30";
  clip.canonical_from_source = {ExpQuaternion(Vector3d(0.0, kPi / 2.0, 0.0)), Vector3d(0.0, 0.0, 4.0)};
  Clip recording = ClipOf("a", "r", Stepping(Walker(), 90));
  recording.motion.reset();
  recording.evidence.tracks = recorded;
  Clip cut = recording;  // without its first twelve frames, times from 0 on
  cut.identity.begin_frame = 12;
  JointTracks& left = *cut.evidence.tracks;
  left.time_s.erase(left.time_s.begin(), left.time_s.begin() + 12);
  for (double& time : left.time_s) time -= 5.4;
  left.positions = JointPositions(77, 1);
  for (int i = 0; i < 77; ++i) left.positions.at(i, 0) = recorded.positions.at(i + 12, 0);
  left.confidence.resize(77);
  Clip opened = clip;  // of a recording whose first frames are not in the file
  opened.provenance["first_frame"] = "30";
  Clip late = recording;
  late.provenance["first_frame"] = "30";
  for (const auto& [of, from] : {std::pair(&clip, &recording), {&clip, &cut}, {&opened, &late}}) {
    const JointTracks tracks = TracksOfClip(*of, *from);
    ASSERT_EQ(tracks.positions.frames, 10);
    for (int f = 0; f < 10; ++f) {
      EXPECT_EQ(tracks.confidence[f], f == 2 ? 0.0 : 0.5) << "sample 64 is missing";
      if (f == 2) continue;
      EXPECT_LT((tracks.positions.at(f, 0) - Vector3d(0.0, 1.0, 4.0 - (60 + 2 * f) / 30.0)).norm(), 1e-9);
    }
  }
}

TEST(ViewerData, FindingsOfARecordingAreBroughtToTheTimeOfAClip) {
  Clip clip = ClipOf("a", "r", Stepping(Walker(), 20));
  clip.identity.begin_frame = 60;
  clip.identity.end_frame = 100;
  clip.motion->rate = clip.rate = FrameRate{15, 1};
  clip.provenance[kRecordedRate] = "30";
  const auto about = [](const char* code, int begin, int end) {
    return FindingOfFrames(code, begin, end, 1.0, "text", FindingAction::kFlagged);
  };
  const auto found =
      FindingsOf(clip, {{clip.id(), {about("own", 3, 6)}},
                        {RecordingOf(clip.id()),
                         {about("before", 0, 60), about("in", 75, 90), about("over", 50, 61), about("whole", 0, 0)}},
                        {"a/p1/other", {about("other", 0, 9)}}});
  ASSERT_EQ(found.size(), 4U);
  const std::vector<std::array<double, 2>> seconds = {{0.2, 0.4}, {0.5, 1.0}, {0.0, 1.0 / 30.0}, {0.0, 0.0}};
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].begin_s, seconds[i][0], 1e-9) << found[i].finding.code;
    EXPECT_NEAR(found[i].end_s, seconds[i][1], 1e-9) << found[i].finding.code;
  }
}

/// Datasets, and the page that the stage makes of them.
struct Viewed {
  ScratchFolder folder;
  ViewerOptions options;
  std::vector<Dataset> sets = std::vector<Dataset>(2);
  bool with_evidence = false;
  bool with_audit = false;

  Viewed() {
    for (std::size_t s = 0; s < sets.size(); ++s) {
      Dataset& set = sets[s];
      set.skeleton = Walker();
      set.labels = {"step", "wave \"x\" </script><b>"};
      for (int i = 0; i < 3; ++i) {
        set.clips.push_back(
            ClipOf(s == 0 ? "raw" : "fit", "r" + std::to_string(i), Stepping(set.skeleton, 40 + 10 * i)));
        set.clips.back().label = set.labels[i == 2 ? 1 : 0];
        set.clips.back().segments = {{0.2, 0.7, "lift <i>", "", "annotated"}};
      }
      set.findings = {FindingOfFrames("speed_spike", 10, 14, 20.0, "a <b> is fast", FindingAction::kFlagged)};
      set.findings[0].clip = set.clips[1].id();
    }
    options.title = "one & \"two\"";
  }

  Expected<StageOutcome> Make() {
    std::error_code none;
    std::filesystem::remove_all(folder / "page", none);
    StageRequest request{"view", "view", OptionsToJson(options), {}, folder / "page", {}};
    for (std::size_t s = 0; s < sets.size(); ++s) {
      const std::string name = "set" + std::to_string(s);
      EXPECT_TRUE(WriteDataset(sets[s], folder / (name + ".h5")));
      request.inputs.push_back({"motions", name + " <u>", folder / (name + ".h5"), ""});
    }
    if (with_evidence) request.inputs.push_back(EvidenceOfFirst());
    if (with_audit) request.inputs.push_back(AuditOfFirst());
    return ViewStage(request);
  }

  std::string Html() const { return ReadFile(folder / "page/index.html").value_or(""); }

  /// The first clip's recording, observed by a tracker and a camera, as the stage's input.
  StageInput EvidenceOfFirst() const {
    Clip recorded = sets[0].clips[0];
    recorded.evidence.tracks = NoisyTracks(*recorded.motion);
    recorded.evidence.depth_views.resize(1);
    recorded.evidence.depth_views[0].camera = FrontCamera();
    recorded.motion.reset();
    EXPECT_TRUE(WriteEvidence(recorded, folder / "evidence.h5"));
    return {"evidence of set0 <u>", RecordingOf(sets[0].clips[0].id()), folder / "evidence.h5", ""};
  }

  /// An audit of the first set: its clips on a line, the first and the last near each other, a finding about the last.
  StageInput AuditOfFirst() const {
    nlohmann::json audit = {{"clips", nlohmann::json::array()}, {"findings", nlohmann::json::array()}};
    const std::vector<Clip>& clips = sets[0].clips;
    for (std::size_t i = 0; i < clips.size(); ++i) {
      audit["clips"].push_back({{"clip", clips[i].id()}, {"map_x", 0.1 * static_cast<double>(i)}, {"map_y", 0.0}});
      audit["clips"].back()["nearest"] = nlohmann::json::array({clips[clips.size() - 1 - i].id()});
    }
    Finding found = FindingOfFrames("outlier", 3, 9, 1.0, "unlike its class", FindingAction::kFlagged);
    found.clip = clips.back().id();
    audit["findings"].push_back(found);
    EXPECT_TRUE(WriteFile(folder / "audit.json", audit.dump()));
    return {"audit of set0 <u>", "audit", folder / "audit.json", ""};
  }

  /// The index of the page.
  nlohmann::json Index() const {
    const std::string page = Html(), begin = "id=\"viewer-index\">";
    const std::size_t at = page.find(begin) + begin.size();
    return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
  }

  /// What tests/report/drive_viewer.py saw.
  nlohmann::json Drive(const std::string& how, const std::vector<std::string>& pages = {"page"}) const {
    std::string command = "LC_ALL=C timeout 240 /usr/bin/python3 '" + std::string(kSourceFolder) +
                          "/tests/report/drive_viewer.py' '" + (folder / "profile").string() + "' " + how;
    for (const std::string& page : pages) command += " '" + (folder / page).string() + "/index.html'";
    command += " > '" + (folder / "seen.json").string() + "' 2> '" + (folder / "log.txt").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << ReadFile(folder / "log.txt").value_or("");
    return nlohmann::json::parse(ReadFile(folder / "seen.json").value_or("{}"), nullptr, false);
  }
};

TEST(Viewer, ItsPageLoadsNothingEscapesTextsAndHasTheSameBytesAgain) {
  Viewed viewed;
  const auto made = viewed.Make();
  ASSERT_TRUE(made) << made.error().Message();
  EXPECT_EQ(made->summary["clips"], 6);
  EXPECT_EQ(made->summary["parts"], 0);
  const std::string page = viewed.Html();
  EXPECT_THAT(page, HasSubstr("<title>one &amp; &quot;two&quot;</title>"));
  for (const char* unsafe : {"</script><b>", "<script src", "@import", "url(", "src=\"http"}) {
    EXPECT_EQ(page.find(unsafe), std::string::npos) << unsafe;
  }
  ASSERT_TRUE(viewed.Make());
  EXPECT_TRUE(viewed.Html() == page);
}

TEST(Viewer, ClipsAreChosenAndWhatShowsNothingIsRefused) {
  Viewed viewed;
  viewed.options.clips = {"r1"};
  EXPECT_EQ(viewed.Make()->summary["clips"], 2);
  viewed.options.clips = {"unknown"};
  EXPECT_EQ(viewed.Make().error().code, ErrorCode::kNotFound);
  viewed.options.clips = {};
  for (Dataset& set : viewed.sets) set.clips.clear();
  for (Dataset& set : viewed.sets) set.findings.clear();
  EXPECT_EQ(viewed.Make().error().code, ErrorCode::kInconsistent);
}

TEST(Viewer, EvidenceOfARunStandsBesideItsMotion) {
  Viewed viewed;
  viewed.with_evidence = true;
  const auto made = viewed.Make();
  ASSERT_TRUE(made) << made.error().Message();
  const nlohmann::json index = viewed.Index();
  const nlohmann::json& first = index["clips"][0];
  EXPECT_EQ(first["points"]["joints"].size(), first["points"]["names"].size());
  EXPECT_EQ(first["cameras"].size(), 1U);
  EXPECT_EQ(first["cameras"][0].size(), 15U);
  EXPECT_FALSE(index["clips"][1].contains("points"));
}

TEST(Viewer, AnAuditGivesTheMapTheNearestClipsAndFindings) {
  Viewed viewed;
  viewed.with_audit = true;
  Finding before = FindingOfFrames("gap", 10, 14, 1.0, "before the clip was cut", FindingAction::kFlagged);
  before.clip = "raw/p1/r1#5-99";
  viewed.sets[0].findings.push_back(before);
  ASSERT_TRUE(viewed.Make());
  const nlohmann::json index = viewed.Index(), &first = index["clips"][0], &last = index["clips"][2];
  EXPECT_EQ(first["map"], (nlohmann::json{0.0, 0.0}));
  EXPECT_EQ(first["nearest"], nlohmann::json::array({last["id"]}));
  EXPECT_EQ(last["findings"].back()["code"], "outlier");
  EXPECT_NEAR(last["findings"].back()["begin_s"], 0.1, 1e-9);
  EXPECT_FALSE(index["clips"][3].contains("map")) << "of a set without an audit";
  EXPECT_EQ(index["clips"][1]["findings"].back()["code"], "gap");
  EXPECT_NEAR(index["clips"][1]["findings"].back()["begin_s"], 0.5, 1e-9) << "frame 15 of the recording";
}

TEST(Viewer, CloudsAreMeasuredPointsNearTheBodyAndAnUnreadableImageLosesItsFrames) {
  SmallRun run;
  const Clip fitted = ReadDataset(run.folder / "fit_c.h5")->clips.front();
  StageRequest request;
  request.inputs = {{"evidence of set", RecordingOf(fitted.id()), run.folder / "evidence_c.h5", ""},
                    {"depth of set", "depth/c.png", run.folder / "depth.png", ""}};
  EXPECT_TRUE(RecordedEvidence(request, "set", false).Of(fitted)->clouds.empty()) << "not asked for";
  const auto seen = RecordedEvidence(request, "set", true).Of(fitted);
  ASSERT_TRUE(seen) << seen.error().Message();
  EXPECT_EQ(seen->lost, 0U);
  ASSERT_EQ(seen->clouds.size(), static_cast<std::size_t>(fitted.motion->frame_count()));
  std::size_t points = 0;
  for (std::size_t f = 0; f < seen->clouds.size(); ++f) {
    const PosedBody body = BodyOf(fitted, static_cast<int>(f));
    for (const Vector3d& place : seen->clouds[f]) {
      EXPECT_LT(ClosestOnBody(body.capsules, body.points.data(), place)->on_capsule.distance, 0.3);
      ++points;
    }
  }
  EXPECT_GT(points, 10U * seen->clouds.size());
  EXPECT_LE(points, 300U * seen->clouds.size());
  ASSERT_TRUE(WriteFile(run.folder / "depth.png", "no picture"));
  const auto unreadable = RecordedEvidence(request, "set", true).Of(fitted);
  ASSERT_TRUE(unreadable) << unreadable.error().Message();
  EXPECT_EQ(unreadable->lost, seen->clouds.size());
  EXPECT_TRUE(unreadable->clouds.empty());
  ViewerOptions options;
  options.clouds = true;
  request.stage = request.item = "view";
  request.options = OptionsToJson(options);
  request.output = run.folder / "page";
  request.inputs.push_back({"motions", "set", run.folder / "fit_c.h5", ""});
  const auto made = ViewStage(request);
  ASSERT_TRUE(made) << made.error().Message();
  EXPECT_EQ(made->summary["frames_without_cloud"], seen->clouds.size());
  const std::string page = *ReadFile(run.folder / "page/index.html"), begin = "id=\"viewer-index\">";
  const std::size_t at = page.find(begin) + begin.size();
  const auto index = nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
  EXPECT_EQ(index["notes"].size(), 1U) << "said on the page";
}

TEST(ViewerInABrowser, KeysClicksAndDragsDoWhatTheySay) {
  if (!HasDrivenBrowser()) GTEST_SKIP() << "chromium, its driver or selenium is missing";
  Viewed viewed;
  viewed.with_evidence = viewed.with_audit = true;
  ASSERT_TRUE(viewed.Make());
  const nlohmann::json seen = viewed.Drive("whole");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["console"], nlohmann::json::array());
  EXPECT_EQ(seen["stage"], "webgl");
  EXPECT_GT(seen["coloured"], 3000) << "pixels of two persons";
  EXPECT_EQ(seen["nameless"], nlohmann::json::array()) << "controls without a name, or out of reach of the keyboard";
  EXPECT_EQ(seen["clip"], "raw/p1/r0#0-40");
  EXPECT_THAT(seen["rows"].get<std::string>(), HasSubstr("segments"));
  EXPECT_THAT(seen["rows"].get<std::string>(), HasSubstr("residual"));
  EXPECT_EQ(seen["after_right"], "0.033");
  EXPECT_EQ(seen["after_end"], "1.300");
  EXPECT_EQ(seen["playing"], "true");
  EXPECT_EQ(seen["paused"], "false");
  EXPECT_THAT(seen["hash"].get<std::string>(), HasSubstr("#clip=raw%2Fp1%2Fr0"));
  EXPECT_NEAR(seen["turned"], -1.0, 0.05);
  EXPECT_NEAR(seen["turned_by_keys"], -0.15, 1e-6);
  EXPECT_NEAR(seen["front"], 0.0, 1e-3) << "the person faces +z";
  EXPECT_EQ(seen["path_by_space"], (nlohmann::json{false, "false"})) << "the box, and whether the motion plays";
  EXPECT_EQ(seen["listed"], 3) << "clips of both sets stand together";
  EXPECT_EQ(seen["second"], "raw/p1/r1#0-50");
  EXPECT_EQ(seen["second_time"], "0.000");
  EXPECT_EQ(seen["space_after_click"], "true");
  EXPECT_GT(seen["beside"][1], seen["beside"][0]);
  EXPECT_EQ(seen["over"], (nlohmann::json{0, 0}));
  EXPECT_EQ(seen["hidden"], 1);
  EXPECT_EQ(seen["mapped"], "raw/p1/r2#0-60") << "the dot at the right edge";
  EXPECT_EQ(seen["nearest"], "raw/p1/r0#0-40");
  EXPECT_EQ(seen["mapped_by_key"], "raw/p1/r1#0-50");
  EXPECT_EQ(seen["found_time"], "0.333") << "the first frame of the finding";
  EXPECT_EQ(seen["found"], 0);
  EXPECT_EQ(seen["found_label"], 1);
  EXPECT_EQ(seen["linked_time"], "0.500");
  EXPECT_NE(seen["unknown"], "");
}

TEST(ViewerInABrowser, WithoutWebGlBonesAreDrawnOnACanvas) {
  if (!HasDrivenBrowser()) GTEST_SKIP() << "chromium, its driver or selenium is missing";
  Viewed viewed;
  ASSERT_TRUE(viewed.Make());
  const nlohmann::json seen = viewed.Drive("flat")[0];
  EXPECT_EQ(seen["stage"], "canvas");
  EXPECT_GT(seen["coloured"], 500);
  EXPECT_NE(seen["status"], "");
}

TEST(ViewerInABrowser, PartsBesideThePageAreReadAndWhatIsAmissIsSaid) {
  if (!HasDrivenBrowser()) GTEST_SKIP() << "chromium, its driver or selenium is missing";
  Viewed viewed;
  viewed.options.page_bytes = 0.0;
  viewed.options.beside = ".";
  const auto made = viewed.Make();
  ASSERT_EQ(made->summary["parts"], 1);
  const std::string page = viewed.Html(), part = *ReadFile(viewed.folder / "page/part_0000.js");
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const auto write = [&](const std::string& name, const std::string& html, const std::string& text) {
    EXPECT_TRUE(MakeFolder(viewed.folder / name));
    EXPECT_TRUE(WriteFile(viewed.folder / name / "index.html", html));
    EXPECT_TRUE(WriteFile(viewed.folder / name / "part_0000.js", text));
  };
  write("other part", page, changed(part, "take(2,", "take(3,"));
  write("cut part", page, part.substr(0, 100));
  write("foreign part", page, changed(part, "take(2,\"", "take(2,\"0"));
  write("damaged part", page, changed(part, ",0,\"", ",0,\"!!"));
  write("other page", changed(page, "\"schema\":2", "\"schema\":9"), part);
  const nlohmann::json seen =
      viewed.Drive("look", {"page", "other part", "cut part", "foreign part", "damaged part", "other page"});
  ASSERT_EQ(seen.size(), 6U);
  EXPECT_GT(seen[0]["coloured"], 3000);
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_TRUE(seen[i]["clip"].is_null()) << seen[i];
    EXPECT_NE(seen[i]["status"], "");
  }
}

}  // namespace
}  // namespace mocurate::test
