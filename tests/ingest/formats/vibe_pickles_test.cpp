// Selection of the performer among VIBE tracks: synthetic files with bystanders, false tracks and changed ids.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/vibe_pickle.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/performance.h"
#include "ingest/synthetic/script.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using ::testing::SizeIs;

constexpr const char* kVideo = "a4_d0_p001_c1_color/vibe_output.pkl";

/// The performer and a bystander in UESTC's layout, from the ground truth of the studio, before a camera.
class VibePeople : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options = Perfect(StudioLayout::kUestc);
    options.subjects = 2;
    options.actions = {"forward-lunging", "left-kicking"};
    Write(options);
    motion = Of("p001", "a4_");
    other = Of("p002", "a8_");
    fs::remove_all(folder);
    performer = Track(motion, 1, Vector3d::Zero());
    bystander = Track(other, 2, Vector3d(1.4, 0.0, 0.8));
  }

  const Motion& Of(const std::string& person, const std::string& action) {
    return std::find_if(truth.begin(), truth.end(),
                        [&](const auto& t) {
                          return t.first.find(person + "/" + action) != std::string::npos &&
                                 t.first.find("_c1") != std::string::npos;
                        })
        ->second;
  }

  /// Ground truth is in the canonical world; the camera frame is rotated by 180 degrees about x.
  static VibeTrack Track(const Motion& of, std::int64_t id, const Vector3d& aside) {
    VibeTrack track = VibeTrackOf(SelectFrames(of, RigidTransform{HalfRotationAboutX().rotation, aside}),
                                  TrackerOptions{0, 0, 0, 4, 0, 0.1, 0.5, 0, 2, 0, 0, 8}, 1, "track");
    track.id = id;
    return track;
  }

  /// Frames [begin, end) under another id.
  static VibeTrack Piece(const VibeTrack& whole, std::int64_t id, std::size_t begin, std::size_t end) {
    begin = std::min(begin, whole.frames - 1);
    end = std::min(end, whole.frames);
    VibeTrack piece;
    piece.id = id;
    piece.joints = whole.joints;
    piece.frames = end - begin;
    for (auto field : {&VibeTrack::pose, &VibeTrack::joints3d, &VibeTrack::betas, &VibeTrack::original_camera,
                       &VibeTrack::predicted_camera, &VibeTrack::boxes}) {
      const std::vector<double>& from = whole.*field;
      const auto width = static_cast<std::ptrdiff_t>(from.size() / whole.frames);
      (piece.*field)
          .assign(from.begin() + width * static_cast<std::ptrdiff_t>(begin),
                  from.begin() + width * static_cast<std::ptrdiff_t>(end));
    }
    piece.frame_ids.assign(whole.frame_ids.begin() + static_cast<std::ptrdiff_t>(begin),
                           whole.frame_ids.begin() + static_cast<std::ptrdiff_t>(end));
    return piece;
  }

  mocurate::Ingested Read(const std::vector<VibeTrack>& tracks, const std::vector<std::string>& more = {}) {
    Put(folder / kVideo, *EncodeVibeTracks(tracks, "tracks"));
    // VIBE's image is square here, with its centre at 270.
    std::vector<std::string> settings = {"ingest.path=" + folder.string(), "ingest.source.people.start=[270, 270]"};
    settings.insert(settings.end(), more.begin(), more.end());
    const auto discovery = Discover(Declared("uestc_vibe", settings));
    EXPECT_TRUE(discovery) << discovery.error().Message();
    if (!discovery) return {tl::unexpected<Error>(discovery.error()), {}, {}};
    return RunIngest(discovery->items.at(0), "vibe_people");
  }

  /// Largest root error (metres) or rotation error (radians), with the first roots aligned. The root of the file is the
  /// middle of the hips, millimetres from the pelvis.
  double ErrorOf(const Clip& clip) {
    const Motion& estimate = *clip.motion;
    if (estimate.frame_count() != motion.frame_count()) return 1e9;
    double worst = 0.0;
    const Vector3d shift = motion.joints.at(0, 0) - estimate.joints.at(0, 0);
    for (int f = 0; f < estimate.frame_count(); ++f) {
      worst = std::max(worst, (estimate.joints.at(f, 0) + shift - motion.joints.at(f, 0)).norm());
      for (int j = 0; j < estimate.joint_count(); ++j) {
        worst = std::max(worst, AngleBetween(estimate.rotation_at(f, j), motion.rotation_at(f, j)));
      }
    }
    return worst;
  }

  /// Values of the findings of a code.
  static std::vector<double> Found(const mocurate::Ingested& ingested, const std::string& code) {
    std::vector<double> values;
    for (const Finding& finding : ingested.outcome->findings) {
      if (finding.code == code) values.push_back(finding.value);
    }
    return values;
  }

  Motion motion, other;
  VibeTrack performer, bystander;
};

TEST_F(VibePeople, SelectsThePerformerByEveryRule) {
  for (const char* rule : {"uestc_released", "uestc_corrected", "presence", "nearest"}) {
    SCOPED_TRACE(rule);
    const VibeTrack shorter = Piece(bystander, 2, 3, bystander.frames - 5);
    const mocurate::Ingested ingested = Read({shorter, performer}, {std::string("ingest.source.people.rule=") + rule});
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.clip.provenance.at("tracks"), "1");
    EXPECT_LT(ErrorOf(ingested.clip), 0.005);
    EXPECT_EQ(ingested.clip.label, "forward-lunging");
  }
}

TEST_F(VibePeople, JoinsTracksOfAChangedIdAndFillsTheGap) {
  const std::size_t half = performer.frames / 2;
  const std::vector<VibeTrack> tracks = {Piece(performer, 1, 0, half), Piece(bystander, 2, 4, half + 8),
                                         Piece(performer, 7, half + 3, performer.frames)};
  for (const char* rule : {"uestc_released", "uestc_corrected", "presence"}) {
    SCOPED_TRACE(rule);
    const mocurate::Ingested ingested = Read(tracks, {std::string("ingest.source.people.rule=") + rule});
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.clip.provenance.at("tracks"), "1+7");
    EXPECT_LT(ErrorOf(ingested.clip), 0.1) << "three frames are interpolated";
    EXPECT_THAT(Found(ingested, "frames_filled"), ElementsAre(3.0));
  }
}

TEST_F(VibePeople, RejectsAPosterAsAFalseTrack) {
  VibeTrack poster = bystander;
  for (auto field : {&VibeTrack::pose, &VibeTrack::joints3d, &VibeTrack::original_camera, &VibeTrack::boxes}) {
    std::vector<double>& values = poster.*field;
    const auto width = static_cast<std::ptrdiff_t>(values.size() / poster.frames);
    for (auto row = values.begin() + width; row != values.end(); row += width)
      std::copy(values.begin(), values.begin() + width, row);
  }
  const mocurate::Ingested ingested =
      Read({poster, Piece(performer, 1, 0, performer.frames - 8)}, {"ingest.source.people.rule=presence"});
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.provenance.at("tracks"), "1") << "although the poster is present longer";
  EXPECT_THAT(Found(ingested, "false_track"), ElementsAre(static_cast<double>(poster.frames)));
}

TEST_F(VibePeople, SelectsADistantPersonUnderTheReleasedRuleOnly) {
  const std::size_t half = performer.frames / 2;
  VibeTrack later = Piece(Track(other, 2, Vector3d(3.2, 0.0, 0.8)), 2, 0, 10);
  for (std::int64_t& frame : later.frame_ids) frame += static_cast<std::int64_t>(half);
  const std::vector<VibeTrack> tracks = {Piece(performer, 1, 0, half), later};
  const mocurate::Ingested released = Read(tracks, {"ingest.source.people.rule=uestc_released"});
  ASSERT_TRUE(released.outcome) << released.outcome.error().Message();
  EXPECT_EQ(released.clip.provenance.at("tracks"), "1+2");
  const mocurate::Ingested corrected = Read(tracks, {"ingest.source.people.rule=uestc_corrected"});
  ASSERT_TRUE(corrected.outcome) << corrected.outcome.error().Message();
  EXPECT_EQ(corrected.clip.provenance.at("tracks"), "1");
  EXPECT_THAT(Found(corrected, "other_person"), SizeIs(1));
}

TEST_F(VibePeople, RejectsFrameNumbersFarBeyondTheRowsByEveryRule) {
  const auto read = [this](std::int64_t id, const char* rule) {
    VibeTrack damaged = Piece(performer, 1, 0, 10);
    damaged.frame_ids.back() = id;
    return Read({damaged, Piece(bystander, 2, 0, 5)}, {std::string("ingest.source.people.rule=") + rule});
  };
  for (const char* rule : {"uestc_released", "uestc_corrected", "presence", "nearest"}) {
    for (const std::int64_t id : {std::int64_t{40000000}, (std::int64_t{1} << 32) - 1, std::int64_t{1} << 40}) {
      SCOPED_TRACE(rule + (" " + std::to_string(id)));
      ExpectError(read(id, rule).outcome, ErrorCode::kInconsistent, kVideo);
    }
  }
}

TEST_F(VibePeople, ReadsAVideoWhoseFrameNumbersDoNotStartAtZero) {
  const auto from = [this](std::int64_t first, const char* rule) {
    std::vector<VibeTrack> tracks = {Piece(bystander, 2, 3, bystander.frames - 5), performer};
    for (VibeTrack& track : tracks) {
      for (std::int64_t& frame : track.frame_ids) frame += first;
    }
    return Read(tracks, {std::string("ingest.source.people.rule=") + rule});
  };
  for (const char* rule : {"uestc_corrected", "presence"}) {
    for (const std::int64_t first : {std::int64_t{5000}, (std::int64_t{1} << 40) - 1000}) {
      SCOPED_TRACE(rule + (" " + std::to_string(first)));
      const mocurate::Ingested ingested = from(first, rule);
      ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
      EXPECT_EQ(ingested.clip.provenance.at("tracks"), "1");
      EXPECT_LT(ErrorOf(ingested.clip), 0.005);
    }
  }
}

TEST_F(VibePeople, KeepsOrMovesTheRootByTheCameraOnRequest) {
  const mocurate::Ingested still = Read({performer}, {"ingest.source.root_translation=still"});
  const mocurate::Ingested moving = Read({performer});
  ASSERT_TRUE(still.outcome && moving.outcome);
  const int last = motion.frame_count() / 2;
  const Vector3d way = motion.joints.at(last, 0) - motion.joints.at(0, 0);
  ASSERT_GT(way.norm(), 0.05);
  EXPECT_LT((still.clip.motion->joints.at(last, 0) - still.clip.motion->joints.at(0, 0)).norm(), 0.02);
  EXPECT_LT((moving.clip.motion->joints.at(last, 0) - moving.clip.motion->joints.at(0, 0) - way).norm(), 0.005);
}

TEST_F(VibePeople, RejectsARuleThatTheFilesDoNotSupport) {
  IngestOptions ntu = Declared("ntu", {"ingest.source.people.rule=uestc_released"});
  ExpectError(CheckSource(ntu.source), ErrorCode::kConfig, "ingest.source.people.rule");
  VibeTrack without = performer;
  without.original_camera.clear();
  VibeTrack second = without;
  second.id = 3;
  ExpectError(Read({without, second}, {"ingest.source.people.rule=presence"}).outcome, ErrorCode::kInconsistent,
              kVideo);
}

TEST_F(VibePeople, ReportsJointsThatContradictTheDeclaration) {
  const auto contradictions = [](const std::vector<std::string>& codes) {
    std::vector<std::string> selected;
    for (const std::string& code : codes) {
      if (code.find("_contradiction") != std::string::npos) selected.push_back(code);
    }
    return selected;
  };
  for (const auto& [factor, code] :
       {std::pair<double, std::string>{1.0, ""}, {-1.0, "handedness_contradiction"}, {1000.0, "units_contradiction"}}) {
    VibeTrack altered = performer;
    for (std::size_t i = 0; i < altered.joints3d.size(); ++i)
      altered.joints3d[i] *= factor > 0.0 ? factor : (i % 3 == 0 ? -1.0 : 1.0);
    const auto ingested = Read({altered});
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    const std::vector<std::string> expected = code.empty() ? std::vector<std::string>() : std::vector{code};
    std::vector<std::string> codes;
    for (const Finding& finding : ingested.outcome->findings) codes.push_back(finding.code);
    EXPECT_EQ(contradictions(codes), expected);
    const auto source = Declared("uestc_vibe", {"ingest.path=" + folder.string()}).source;
    EXPECT_EQ(contradictions(Codes(InspectPath(folder, source), "error")), expected);
  }
}

}  // namespace
}  // namespace mocurate
