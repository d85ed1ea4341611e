// Keypoint files that do not match their declaration. A unique explanation is corrected; several explanations are
// reported, and nothing is changed.

#include "fitting/audit/rig_hypotheses.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <regex>

#include "fitting/audit/keypoint_files.h"
#include "fitting/keypoint_fit.h"
#include "tests/fitting/keypoint_faults.h"
#include "tests/fitting/keypoint_takes.h"
#include "tests/fitting/studio_views.h"

namespace mocurate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

SkeletonPtr SmplOfHypotheses() {
  static const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  return skeleton;
}

Expected<BodyTracks> Tracked(const Evidence& evidence, const KeypointAuditOptions& audit = {}) {
  KeypointFitOptions options;
  options.audit = audit;
  return TracksOnBody(evidence, *SmplOfHypotheses(), SmplOfHypotheses(), options);
}

std::string ReportedByHypotheses(const BodyTracks& found) {
  std::string text;
  for (const RigFault& fault : found.report.faults)
    text += fault.code + " " + fault.camera + ": " + fault.message + "\n";
  return text;
}

bool IsReported(const std::string& code, const BodyTracks& found) {
  return std::any_of(found.findings.begin(), found.findings.end(),
                     [&](const Finding& finding) { return finding.code == code; });
}

/// A message must not give equal shares as evidence: "so 100 % of the entries agree with others, as given 100 %".
void ExpectMessagesShowAnImprovement(const BodyTracks& found) {
  static const std::regex same("so ([0-9]+) % of the entries agree with others, as given \\1 %");
  EXPECT_FALSE(std::regex_search(ReportedByHypotheses(found), same)) << ReportedByHypotheses(found);
}

double MeanErrorOf(const SkeletonTracks& tracks, const Motion& truth) {
  JointTracks joints;
  joints.positions = tracks.positions;
  joints.confidence = tracks.confidence;
  return MeanError(joints, truth);
}

StudioOptions Views(std::int64_t seed, RigKind kind, std::int64_t cameras = 4) {
  StudioOptions options = FourViews(seed);
  options.rig.kind = kind;
  options.rig.cameras = cameras;
  return options;
}

TEST(RigHypotheses, RefusesExchangedOppositeCamerasOfARingNamingAllExplanations) {
  for (const std::size_t first : {0u, 1u}) {
    for (StudioView take : StudioViews(Views(41, RigKind::kRing), 6)) {
      ExchangeFiles(take.evidence, first, first + 2);
      const auto refused = Tracked(take.evidence);
      ASSERT_FALSE(refused) << take.name << ": " << ReportedByHypotheses(*refused);
      EXPECT_THAT(refused.error().Message(),
                  AllOf(HasSubstr("cam01 in those of cam03"), HasSubstr("cam02 in those of cam04"),
                        HasSubstr("mirrored"), HasSubstr("ambiguous")));
    }
  }
}

TEST(RigHypotheses, ReportOnlyCorrectsNothing) {
  KeypointAuditOptions audit;
  audit.exchanged = AuditAction::kReport;
  for (StudioView take : StudioViews(Views(41, RigKind::kRing), 3)) {
    ExchangeFiles(take.evidence, 0, 2);
    const auto found = Tracked(take.evidence, audit);
    ASSERT_TRUE(found) << found.error().Message();
    EXPECT_TRUE(found->report.suspect);
    ASSERT_FALSE(found->report.faults.empty());
    EXPECT_EQ(found->report.faults[0].code, "cameras_exchanged");
    EXPECT_LT(found->report.faults[0].confidence, 0.5);
    for (const RigFault& fault : found->report.faults) EXPECT_FALSE(fault.corrected) << ReportedByHypotheses(*found);
    EXPECT_TRUE(IsReported("rig_not_audited", *found)) << "clocks and camera poses were not audited";
  }
}

TEST(RigHypotheses, UncertainExplanationIsReportedAndTheAuditContinues) {
  KeypointAuditOptions audit;
  audit.sure = 1.0;
  for (StudioView take : StudioViews(Views(42, RigKind::kRing, 6), 3)) {
    ExchangeFiles(take.evidence, 0, 3);
    const auto found = Tracked(take.evidence, audit);
    ASSERT_TRUE(found) << found.error().Message();
    ASSERT_FALSE(found->report.faults.empty());
    EXPECT_EQ(found->report.faults[0].code, "cameras_exchanged");
    EXPECT_TRUE(found->report.faults[0].guessed);
    EXPECT_FALSE(IsAmbiguous(found->report.faults[0]));
    EXPECT_FALSE(FilesAreExchanged(found->report.faults)) << ReportedByHypotheses(*found);
    EXPECT_FALSE(IsReported("rig_not_audited", *found));
  }
}

TEST(RigHypotheses, ExchangesFilesOfOppositeCamerasOfOtherRigsBack) {
  const std::vector<std::pair<StudioOptions, std::size_t>> rigs = {{Views(42, RigKind::kRing, 6), 3},
                                                                   {Views(43, RigKind::kRing, 8), 4},
                                                                   {Views(44, RigKind::kHuman36m), 2},
                                                                   {Views(45, RigKind::kPhspd), 2}};
  for (const auto& [options, other] : rigs) {
    for (StudioView take : StudioViews(options, 3)) {
      const auto sound = Tracked(take.evidence);
      ExchangeFiles(take.evidence, 0, other);
      const auto found = Tracked(take.evidence);
      ASSERT_TRUE(sound && found) << take.name;
      ASSERT_EQ(found->report.faults.size(), 1u) << take.name << ": " << ReportedByHypotheses(*found);
      EXPECT_EQ(found->report.faults[0].code, "cameras_exchanged");
      ExpectMessagesShowAnImprovement(*found);
      EXPECT_LT(MeanErrorOf(found->tracks, take.truth), 1.05 * MeanErrorOf(sound->tracks, take.truth) + 1e-3);
    }
  }
}

TEST(RigHypotheses, CorrectsSidesThatAllViewsExchangeWhereFilesDoNotExplainThem) {
  for (StudioView take : StudioViews(Views(47, RigKind::kHuman36m), 3)) {
    for (KeypointView& view : take.evidence.keypoint_views) ExchangeSides(view, take.evidence.keypoint_names);
    const auto found = Tracked(take.evidence);
    ASSERT_TRUE(found) << take.name << ": " << found.error().Message();
    ASSERT_EQ(found->report.faults.size(), 1u) << take.name << ": " << ReportedByHypotheses(*found);
    EXPECT_EQ(found->report.faults[0].code, "views_swap_sides");
    EXPECT_LT(MeanErrorOf(found->tracks, take.truth), 0.04);
  }
}

TEST(RigHypotheses, ReportsAViewThatExchangesSidesAsNeitherMovedNorMirrored) {
  int named = 0, takes = 0;
  for (StudioView take : StudioViews(Views(46, RigKind::kRing), 12)) {
    ExchangeSides(take.evidence.keypoint_views[1], take.evidence.keypoint_names);
    const auto found = Tracked(take.evidence);
    ASSERT_TRUE(found) << take.name << ": " << found.error().Message();
    ++takes;
    for (const RigFault& fault : found->report.faults) {
      EXPECT_EQ(fault.code, "view_swaps_sides") << take.name << ": " << ReportedByHypotheses(*found);
      const bool whole = fault.limb.empty() && fault.camera == take.evidence.keypoint_views[1].camera.name;
      named += whole ? 1 : 0;
    }
    EXPECT_LT(MeanErrorOf(found->tracks, take.truth), 0.03) << take.name << ": " << ReportedByHypotheses(*found);
  }
  EXPECT_GE(named, takes - 1);
}

}  // namespace
}  // namespace mocurate
