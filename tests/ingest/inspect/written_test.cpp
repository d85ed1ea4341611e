// Reports of `mocurate inspect` on files of other programs that no recorded set contains.

#include <gmock/gmock.h>

#include "core/formats/babel.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/vibe_pickle.h"
#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;

TEST_F(WrittenFormats, ReportBabelSegmentsAndImpossibleTimes) {
  BabelSequence sequence;
  sequence.key = "7692";
  sequence.babel_sid = 7692;
  sequence.url = "https://example.org/007692.mp4";
  sequence.feat_p = "CMU/CMU/01/01_01_poses.npz";
  sequence.dur = 6.5;
  BabelAnnotation annotation;
  annotation.babel_lid = "1";
  annotation.anntr_id = "2";
  annotation.mul_act = true;
  for (const auto& [start, end] : {std::pair{0.0, 2.5}, {2.5, 6.0}, {5.0, 4.0}}) {
    BabelLabel label;
    label.raw_label = label.proc_label = "walk";
    label.act_cat = std::vector<std::string>{"walk"};
    label.seg_id = "s" + std::to_string(start);
    label.start_t = start;
    label.end_t = end;
    annotation.labels.push_back(label);
  }
  sequence.frame_anns = {annotation};
  BabelAnnotation whole = annotation;
  whole.labels = {annotation.labels[0]};
  whole.labels[0].start_t.reset();
  whole.labels[0].end_t.reset();
  sequence.seq_anns = {whole};
  const Json inspection = InspectPath(Written("train.json", EncodeBabel({sequence})), std::nullopt);
  ASSERT_EQ(inspection.at("companions").size(), 1u) << inspection.dump(1);
  EXPECT_EQ(inspection.at("format"), "babel");
  const Json& facts = inspection.at("companions")[0].at("facts");
  EXPECT_EQ(facts.at("sequences"), 1.0);
  EXPECT_EQ(facts.at("segments"), 3.0);
  EXPECT_EQ(facts.at("sequence_labels"), 1.0);
  EXPECT_EQ(facts.at("duration_s"), 6.5);
  EXPECT_EQ(facts.at("segments_s"), 6.0);
  EXPECT_THAT(Codes(inspection, "warning"), ElementsAre("babel_times"));
}

TEST_F(WrittenFormats, ReportAFileThatIsTooLarge) {
  const std::filesystem::path file = Written("large.bvh", "HIERARCHY\nROOT hips\n");
  std::filesystem::resize_file(file, (1u << 30) + 1);  // a hole: it takes no space
  EXPECT_THAT(Codes(InspectPath(folder_, std::nullopt), "error"), ElementsAre("too_large", "no_clips"));
}

/// A swaying person of 24 joints.
std::vector<double> StandingPerson(std::size_t frames) {
  constexpr double kRest[24][3] = {{0, 0, 0},           {0.06, 0.09, 0},      {-0.06, 0.09, 0},    {0, -0.12, 0},
                                   {0.1, 0.47, -0.02},  {-0.1, 0.47, -0.02},  {0, -0.25, 0},       {0.1, 0.87, 0},
                                   {-0.1, 0.87, 0},     {0, -0.31, 0},        {0.11, 0.93, -0.12}, {-0.11, 0.93, -0.12},
                                   {0, -0.52, 0},       {0.08, -0.42, 0},     {-0.08, -0.42, 0},   {0, -0.62, -0.04},
                                   {0.19, -0.46, 0},    {-0.19, -0.46, 0},    {0.25, -0.21, 0},    {-0.25, -0.21, 0},
                                   {0.27, 0.02, -0.05}, {-0.27, 0.02, -0.05}, {0.28, 0.1, -0.06},  {-0.28, 0.1, -0.06}};
  std::vector<double> xyz;
  for (std::size_t f = 0; f < frames; ++f) {
    const double sway = 0.05 * static_cast<double>(f) / static_cast<double>(frames);
    for (const auto& joint : kRest) xyz.insert(xyz.end(), {joint[0] + sway, joint[1], joint[2]});
  }
  return xyz;
}

TEST_F(WrittenFormats, ReadOneClipPerHumanAct12Entry) {
  std::vector<HumanAct12Clip> clips(2);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    clips[i].frames = 20 + i;
    clips[i].poses.assign(clips[i].frames * 72, 0.0);
    clips[i].joints = StandingPerson(clips[i].frames);
    clips[i].label = static_cast<int>(3 + i);
  }
  const auto bytes = EncodeHumanAct12Pickle(clips, "poses");
  ASSERT_TRUE(bytes);
  const Json inspection = InspectPath(Written("humanact12poses.pkl", *bytes), std::nullopt);
  ASSERT_EQ(inspection.at("clips").size(), 2u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[1];
  EXPECT_EQ(clip.at("format"), "humanact12_pickle");
  EXPECT_EQ(Value(clip, "frames"), 21);
  EXPECT_EQ(Value(clip, "skeleton"), "smpl24");
  EXPECT_EQ(clip.at("facts").at("label"), "4");
  ExpectFrame(clip, "m", "-y", "right");
}

TEST_F(WrittenFormats, ReadOldPicklesAndReportUnsafeOnes) {
  const std::string numbers = "(lp1\nI1\naF2.5\naV\\u00e9x\np2\naL1234567890L\nas.";
  const Json unknown = InspectPath(Written("lists.pkl", "(dp0\nS'poses'\n" + numbers), std::nullopt);
  EXPECT_THAT(Places(unknown), ElementsAre("no_motion lists.pkl"));
  for (const auto& [forbidden, byte] : {std::pair{std::string("cos\nsystem\np0\n(S'touch x'\np1\ntp2\nRp3\n."), 11},
                                        {std::string("(S'touch x'\nios\nsystem\n."), 12},
                                        {std::string("cos\nsystem\nq\0(U\x07touch xtRq\1.", 28), 11}}) {
    const Json inspection = InspectPath(Written("evil.pkl", forbidden), std::nullopt);
    EXPECT_THAT(Places(inspection), ElementsAre("unsafe_pickle evil.pkl: byte " + std::to_string(byte)));
  }
  for (const char* text : {"(see below)\n", "count\nname\n1 walks\n", "cab\nabc\n", "]\n", "(1) first\n"}) {
    const Json inspection = InspectPath(Written("notes.txt", text), std::nullopt);
    EXPECT_EQ(inspection.at("findings")[0].at("code"), "unknown_format") << text;
  }
}

TEST_F(WrittenFormats, ReadVibeTracksAndCachesAsClips) {
  VibeTrack track;
  track.id = 7;
  track.frames = 12;
  track.joints = 49;
  track.pose.assign(12 * 72, 0.0);
  track.joints3d.assign(12 * 49 * 3, 0.0);
  for (std::size_t i = 0; i < track.joints3d.size(); ++i) track.joints3d[i] = 0.001 * static_cast<double>(i % 147);
  track.betas.assign(12 * 10, 0.0);
  for (std::int64_t f = 0; f < 12; ++f) track.frame_ids.push_back(f);
  const auto tracks = EncodeVibeTracks({track}, "tracks");
  ASSERT_TRUE(tracks) << tracks.error().Message();
  const Json one = InspectPath(Written("vibe_output.pkl", *tracks), std::nullopt);
  ASSERT_EQ(one.at("clips").size(), 1u) << one.dump(1);
  EXPECT_EQ(one.at("clips")[0].at("format"), "vibe_tracks");
  EXPECT_EQ(one.at("clips")[0].at("facts").at("track"), "7");
  EXPECT_EQ(Value(one.at("clips")[0], "joints"), 49);
  const auto cache = EncodeVibeCache({track, track}, "cache");
  ASSERT_TRUE(cache) << cache.error().Message();
  const Json two = InspectPath(Written("vibe_cache_refined.pkl", *cache), std::nullopt);
  ASSERT_EQ(two.at("clips").size(), 2u) << two.dump(1);
  EXPECT_EQ(Value(two.at("clips")[1], "frames"), 12);
}

TEST_F(WrittenFormats, ReadUntrackedJointsAsMissing) {
  NtuSkeleton skeleton;
  skeleton.frames.resize(4);
  for (std::size_t f = 0; f < 2; ++f) {
    NtuBody body;
    body.id = 72057594037931101ULL;
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
      body.joints[j].y_m = 0.1 * static_cast<double>(j);
      body.joints[j].tracking = j < 5 ? 0 : 2;
    }
    skeleton.frames[f].push_back(body);
  }
  const Json inspection =
      InspectPath(Written("S001C001P001R001A001.skeleton", WriteNtuSkeleton(skeleton)), std::nullopt);
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[0];
  EXPECT_EQ(clip.at("facts").at("body"), "72057594037931101");
  EXPECT_EQ(Value(clip, "missing_share"), 0.6) << "5 of 25 joints in half of the frames, 25 in the other half";
  EXPECT_EQ(Value(clip, "people_per_frame"), (Json{{"min", 0}, {"max", 1}}));
  EXPECT_THAT(Codes(inspection, "warning"), Contains("many_missing"));
}

TEST_F(WrittenFormats, ReportThePlaceOfDamageInEveryFormat) {
  const std::vector<std::tuple<std::string, std::string, std::string>> files = {
      {"cut.skeleton", "malformed cut.skeleton:6",
       "2\n1\n72057594037931101 0 1 1 1 1 0 0.1 0.1 2\n25\n0 0 1 0 0 0 0 0 0 0 0 2\n"},
      {"cut.ply", "count_contradiction cut.ply:9",
       "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
       "0\n"},
      {"cut.mot", "count_contradiction cut.mot:3",
       "Coordinates\nversion=1\nnRows=2\nnColumns=2\ninDegrees=yes\nendheader\ntime\ta\n0\t1\n"},
      {"cut.asf", "malformed cut.asf:7",
       ":version 1.10\n:name x\n:units\n  length 0.45\n  angle deg\n:root\n  order TX nothing\n"},
      {"cut.pkl", "malformed cut.pkl: byte 4", std::string("\x80\x02}q", 4)}};
  for (const auto& [name, error, bytes] : files) {
    const Json inspection = InspectPath(Written(name, bytes), std::nullopt);
    EXPECT_TRUE(inspection.at("clips").empty()) << name;
    EXPECT_THAT(Places(inspection), ElementsAre(error));
  }
}

}  // namespace
}  // namespace mocurate
