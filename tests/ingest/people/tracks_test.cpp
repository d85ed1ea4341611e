// Selection and stitching of tracked bodies, with known ground truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "ingest/people/person_tracks.h"
#include "tests/quality/people.h"

namespace mocurate {
namespace {

using test::Perform;
using test::TakeOptions;
using ::testing::ElementsAre;

TakeOptions Body(double stature, int frames = 90) {
  TakeOptions options;
  options.stature = stature;
  options.frames = frames;
  options.walk = 0.5;
  options.noise = 0.01;
  return options;
}

/// Frames [begin, end) of a take, every `step`-th, moved by `offset`.
PersonTrack Piece(const test::Take& take, std::uint64_t id, int begin, int end,
                  const Vector3d& offset = Vector3d::Zero(), int step = 1) {
  PersonTrack track;
  track.ids = {id};
  track.positions.joints = take.positions.joints;
  for (int f = begin; f < end; f += step) {
    track.frames.push_back(f);
    ++track.positions.frames;
    for (int k = 0; k < take.positions.joints; ++k) {
      const Vector3d place = take.positions.at(f, k) + offset;
      track.positions.xyz.insert(track.positions.xyz.end(), place.data(), place.data() + 3);
      track.confidence.push_back(1.0);
    }
  }
  return track;
}

std::vector<PersonTrack> Stitched(std::vector<PersonTrack> tracks, const test::Take& like,
                                  std::vector<Finding>* found = nullptr) {
  std::vector<Finding> findings;
  auto people = StitchTracks(std::move(tracks), like.parents, like.time_s, PeopleOptions().max_lost_s, findings);
  if (found != nullptr) *found = findings;
  return people;
}

People Chosen(std::vector<PersonTrack> tracks, std::size_t count, const test::Take& like,
              TrackRule rule = TrackRule::kMotion) {
  return ChoosePeople(std::move(tracks), count, rule, true, like.parents, like.rest_lengths, 90);
}

/// Frames of each false track.
std::vector<double> FalseTrackFrames(const People& people) {
  std::vector<double> frames;
  for (const Finding& finding : people.findings) {
    if (finding.code == "false_track") frames.push_back(finding.value);
  }
  return frames;
}

TEST(Stitching, JoinsAPersonWhoReturnsUnderAnotherId) {
  const test::Take a = Perform(1, Body(1.1)), b = Perform(2, Body(0.9));
  std::vector<Finding> findings;
  const auto people =
      Stitched({Piece(a, 10, 0, 40), Piece(a, 11, 52, 90), Piece(b, 20, 0, 90, {1.2, 0, 0})}, a, &findings);
  ASSERT_EQ(people.size(), 2u);
  EXPECT_THAT(people[0].ids, ElementsAre(10, 11));
  EXPECT_THAT(people[1].ids, ElementsAre(20));
  EXPECT_EQ(people[0].frames.size(), 78u);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "ids_stitched");
  EXPECT_EQ(findings[0].value, 12.0);
  EXPECT_EQ(people[0].positions.xyz.size(), people[0].frames.size() * 60);
}

TEST(Stitching, KeepsIdentitiesOfTwoPeopleWhoChangePlaces) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const test::Take a = Perform(seed, Body(1.15)), b = Perform(seed + 100, Body(0.85));
    const Vector3d left(-0.4, 0, 0), right(0.4, 0, 0);
    const auto people = Stitched({Piece(a, 10, 0, 40, left), Piece(b, 20, 0, 40, right), Piece(b, 21, 50, 90, left),
                                  Piece(a, 11, 50, 90, right)},
                                 a);
    ASSERT_EQ(people.size(), 2u) << "seed " << seed;
    EXPECT_THAT(people[0].ids, ElementsAre(10, 11)) << "seed " << seed;
    EXPECT_THAT(people[1].ids, ElementsAre(20, 21)) << "seed " << seed;
  }
}

TEST(Stitching, JoinsManyTracksIntoTwoPeople) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Random random(seed, "pieces", "");
    const test::Take a = Perform(seed, Body(1.0 + 0.15 * random.Uniform(), 300));
    const test::Take b = Perform(seed + 500, Body(0.7 + 0.15 * random.Uniform(), 300));
    std::vector<PersonTrack> pieces;
    for (const bool second : {false, true}) {
      int begin = 0;
      for (std::uint64_t id = second ? 200 : 100; begin < 300; ++id) {
        const int end = std::min(300, begin + 15 + static_cast<int>(60.0 * random.Uniform()));
        pieces.push_back(Piece(second ? b : a, id, begin, end, Vector3d(second ? 0.8 : 0.0, 0, 0)));
        begin = end + static_cast<int>(20.0 * random.Uniform());
      }
    }
    const auto people = Stitched(pieces, a);
    ASSERT_EQ(people.size(), 2u) << "seed " << seed;
    for (const PersonTrack& person : people) {
      for (const std::uint64_t id : person.ids) EXPECT_EQ(id / 100, person.ids[0] / 100) << "seed " << seed;
    }
  }
}

TEST(Stitching, SeparatesTracksAfterALongGapOrWithOtherBoneLengths) {
  const test::Take a = Perform(1, Body(1.1, 200)), b = Perform(2, Body(0.8, 200));
  EXPECT_EQ(Stitched({Piece(a, 1, 0, 40), Piece(a, 2, 130, 200)}, a).size(), 2u) << "a gap of 3 s";
  EXPECT_EQ(Stitched({Piece(a, 1, 0, 40), Piece(b, 2, 45, 200)}, a).size(), 2u) << "bone lengths of another person";
  EXPECT_EQ(Stitched({Piece(a, 1, 0, 40), Piece(a, 2, 45, 200, {5, 0, 0})}, a).size(), 2u) << "5 m in 0.2 s";
  EXPECT_EQ(Stitched({Piece(a, 1, 0, 40), Piece(a, 2, 45, 200)}, a).size(), 1u);
}

TEST(Stitching, JoinsAlternatingIdsButNotSimultaneousOnes) {
  const test::Take a = Perform(1, Body(1.0)), b = Perform(2, Body(1.0));
  const auto one = Stitched({Piece(a, 1, 0, 90, {0, 0, 0}, 2), Piece(a, 2, 1, 90, {0, 0, 0}, 2)}, a);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].frames.size(), 90u);
  EXPECT_TRUE(std::is_sorted(one[0].frames.begin(), one[0].frames.end()));
  EXPECT_EQ(Stitched({Piece(a, 1, 0, 90), Piece(b, 2, 0, 90, {0.6, 0, 0})}, a).size(), 2u) << "both in the same frames";
  EXPECT_EQ(Stitched({Piece(a, 1, 0, 90, {0, 0, 0}, 2), Piece(b, 2, 1, 90, {3, 0, 0}, 2)}, a).size(), 2u)
      << "alternating, but 3 m apart";
}

TEST(Stitching, FindsTheAssignmentOfLeastCost) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed, "assignment", "");
    const int n = 1 + static_cast<int>(5.0 * random.Uniform());
    std::vector<double> costs(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    for (double& cost : costs) cost = 2.0 * random.Uniform();
    const auto at = [&](int r, int c) { return costs[static_cast<std::size_t>(r * n + c)]; };
    const std::vector<int> partner = LeastCostAssignment(costs, n, n, 1.0);
    double sum = 0.0;
    std::vector<char> used(static_cast<std::size_t>(n), 0);
    for (int r = 0; r < n; ++r) {
      const int c = partner[static_cast<std::size_t>(r)];
      sum += c < 0 ? 1.0 : at(r, c);
      if (c < 0) continue;
      EXPECT_LT(at(r, c), 1.0);
      EXPECT_EQ(used[static_cast<std::size_t>(c)]++, 0) << "a column is assigned twice";
    }
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    double least = 1e9;
    do {
      double total = 0.0;
      for (int r = 0; r < n; ++r) total += std::min(1.0, at(r, order[static_cast<std::size_t>(r)]));
      least = std::min(least, total);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(sum, least, 1e-9) << "seed " << seed;
  }
}

TEST(FalseTracks, IncludeChairsShortAndDuplicateTracksAndFurniture) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const test::Take person = Perform(seed, Body(1.0));
    const PersonTrack real = Piece(person, 1, 0, 90);
    EXPECT_THAT(FalseTrackFrames(Chosen({real}, 1, person)), ElementsAre()) << "seed " << seed;

    TakeOptions still = Body(1.0);
    still.noise = 0.0;
    test::Take chair = Perform(seed + 50, still);
    Random random(seed, "chair", "");
    for (int f = 1; f < 90; ++f) {
      for (int k = 0; k < 20; ++k) chair.positions.at(f, k) = chair.positions.at(0, k).eval();
    }
    for (double& value : chair.positions.xyz) value += 0.001 * random.Normal();
    const People frozen = Chosen({Piece(chair, 2, 0, 90, {1, 0, 0}), real}, 1, person);
    EXPECT_THAT(FalseTrackFrames(frozen), ElementsAre(90.0));

    const People brief = Chosen({Piece(person, 2, 3, 8, {2, 0, 0}), real}, 1, person);
    EXPECT_THAT(FalseTrackFrames(brief), ElementsAre(5.0));

    const test::Take again = Perform(seed, Body(1.0));
    const People twice = Chosen({real, Piece(again, 2, 10, 60, {0.05, 0, 0.05})}, 1, person);
    EXPECT_THAT(FalseTrackFrames(twice), ElementsAre(50.0));

    test::Take table = Perform(seed + 70, Body(1.0));
    for (int f = 0; f < 90; ++f) {
      for (int k = 0; k < 20; ++k) table.positions.at(f, k).y() *= 0.2, table.positions.at(f, k).x() *= 4.0;
    }
    const People furniture = Chosen({Piece(table, 2, 0, 90, {2, 0, 0}), real}, 1, person);
    EXPECT_THAT(FalseTrackFrames(furniture), ElementsAre(90.0));
    for (const People* people : {&frozen, &brief, &twice, &furniture})
      EXPECT_THAT(people->chosen.at(0).ids, ElementsAre(1));
  }
}

TEST(FalseTracks, AreKeptAndReportedWithoutAnotherPerson) {
  const test::Take person = Perform(1, Body(1.0));
  const People people = Chosen({Piece(person, 7, 0, 5)}, 1, person);
  ASSERT_EQ(people.chosen.size(), 1u);
  EXPECT_EQ(people.findings[0].action, FindingAction::kKept);
}

TEST(Rules, SelectThePersonThatTheyDefine) {
  // One moves most but briefly, one is present longest but hardly moves, one is nearest.
  TakeOptions brisk = Body(1.0), calm = Body(1.0), near = Body(1.0);
  brisk.walk = 3.0;
  calm.walk = 0.05;
  near.walk = 0.6;
  const test::Take one = Perform(1, brisk), two = Perform(2, calm), three = Perform(3, near);
  const std::vector<PersonTrack> tracks = {Piece(one, 1, 0, 40, {2, 0, 3}), Piece(two, 2, 0, 90, {-2, 0, 3}),
                                           Piece(three, 3, 0, 80, {0, 0, 1})};
  EXPECT_THAT(Chosen(tracks, 1, one, TrackRule::kOfficial).chosen[0].ids, ElementsAre(1));
  EXPECT_THAT(Chosen(tracks, 1, one, TrackRule::kPresence).chosen[0].ids, ElementsAre(2));
  EXPECT_THAT(Chosen(tracks, 1, one, TrackRule::kNearest).chosen[0].ids, ElementsAre(3));
  EXPECT_THAT(Chosen(tracks, 1, one, TrackRule::kMotion).chosen[0].ids, ElementsAre(3))
      << "a track shorter than half of the longest ranks last";
  const People two_of_them = Chosen(tracks, 2, one, TrackRule::kMotion);
  EXPECT_EQ(two_of_them.chosen.size(), 2u);
  EXPECT_EQ(two_of_them.others.size(), 1u);
}

TEST(Rules, ReportASecondMovingPerson) {
  const test::Take a = Perform(1, Body(1.0)), b = Perform(2, Body(0.9));
  const People people = Chosen({Piece(a, 1, 0, 90), Piece(b, 2, 0, 90, {1, 0, 0})}, 1, a);
  std::vector<std::string> codes;
  for (const Finding& finding : people.findings) codes.push_back(finding.code);
  EXPECT_THAT(codes, ElementsAre("bodies_skipped", "second_person"));
  EXPECT_TRUE(Chosen({Piece(a, 1, 0, 90), Piece(b, 2, 0, 90, {1, 0, 0})}, 2, a).findings.empty());
}

}  // namespace
}  // namespace mocurate
