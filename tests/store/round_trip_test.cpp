#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/motion/kinematics.h"
#include "core/store/dataset_clips.h"
#include "core/store/fields.h"
#include "tests/store/builders.h"

namespace mocurate {
namespace {

using test::MakeDataset;
using test::MakeEvidenceClip;
using test::MakeTruth;
using ::testing::HasSubstr;

std::string Bytes(const std::filesystem::path& path) { return ReadFile(path).value(); }

void ExpectSameMotion(const Motion& read, const Motion& written) {
  ASSERT_EQ(read.frame_count(), written.frame_count());
  ASSERT_EQ(read.joint_count(), written.joint_count());
  EXPECT_TRUE(read.rate == written.rate);
  EXPECT_EQ(read.bone_length, written.bone_length);
  EXPECT_EQ(read.state, written.state);
  EXPECT_EQ(read.position_cov, written.position_cov);
  EXPECT_EQ(read.rotation_sigma, written.rotation_sigma);
  EXPECT_EQ(read.rotation_observed, written.rotation_observed);
  EXPECT_EQ(read.contact, written.contact);
  for (std::size_t i = 0; i < written.joints.xyz.size(); ++i) {
    EXPECT_EQ(read.joints.xyz[i], static_cast<double>(static_cast<float>(written.joints.xyz[i])));
  }
  ASSERT_EQ(read.rotation.size(), written.rotation.size());
  for (std::size_t i = 0; i < written.rotation.size(); ++i) {
    EXPECT_LT((read.rotation[i].coeffs() - written.rotation[i].coeffs()).norm(), 2e-7);
    EXPECT_NEAR(read.rotation[i].norm(), 1.0, 1e-15);
  }
  ASSERT_EQ(read.root_translation.size(), written.root_translation.size());
  for (std::size_t i = 0; i < written.root_translation.size(); ++i) {
    EXPECT_LT((read.root_translation[i] - written.root_translation[i]).norm(), 1e-6);
  }
}

void ExpectSameClip(const Clip& read, const Clip& written) {
  EXPECT_EQ(read.id(), written.id());
  EXPECT_EQ(read.identity.session, written.identity.session);
  EXPECT_EQ(read.identity.view, written.identity.view);
  EXPECT_EQ(read.identity.licence, written.identity.licence);
  EXPECT_EQ(read.label, written.label);
  EXPECT_EQ(read.role, written.role);
  EXPECT_EQ(read.fit_rms, written.fit_rms);
  EXPECT_EQ(read.evidence_sha256, written.evidence_sha256);
  EXPECT_EQ(read.provenance, written.provenance);
  EXPECT_TRUE(read.rate == written.rate);
  EXPECT_EQ(read.canonical_from_source.rotation.coeffs(), written.canonical_from_source.rotation.coeffs());
  EXPECT_EQ(read.canonical_from_source.translation, written.canonical_from_source.translation);
  ASSERT_EQ(read.segments.size(), written.segments.size());
  for (std::size_t i = 0; i < read.segments.size(); ++i) {
    EXPECT_EQ(read.segments[i].begin_s, written.segments[i].begin_s);
    EXPECT_EQ(read.segments[i].end_s, written.segments[i].end_s);
    EXPECT_EQ(read.segments[i].label, written.segments[i].label);
    EXPECT_EQ(read.segments[i].category, written.segments[i].category);
    EXPECT_EQ(read.segments[i].origin, written.segments[i].origin);
  }
}

TEST(Store, ADatasetComesBackAsItWasWritten) {
  const ScratchFolder folder;
  const Dataset written = MakeDataset();
  const Status status = WriteDataset(written, folder / "set.h5");
  ASSERT_TRUE(status) << status.error().Message();
  const auto read = ReadDataset(folder / "set.h5");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_TRUE(store::SameSkeleton(*read->skeleton, *written.skeleton));
  EXPECT_EQ(read->skeleton->joints[0].synonyms, written.skeleton->joints[0].synonyms);
  EXPECT_EQ(read->skeleton->lie->chains, written.skeleton->lie->chains);
  EXPECT_EQ(*read->skeleton->joints[5].reflection, *written.skeleton->joints[5].reflection);
  EXPECT_FALSE(read->joints_only);
  ASSERT_EQ(read->clips.size(), written.clips.size());
  for (std::size_t i = 0; i < written.clips.size(); ++i) {
    ExpectSameClip(read->clips[i], written.clips[i]);
    ExpectSameMotion(*read->clips[i].motion, *written.clips[i].motion);
    const Status checked = read->clips[i].motion->Check();
    EXPECT_TRUE(checked) << checked.error().Message();
  }
  ASSERT_EQ(read->labels.size(), 3u);
  EXPECT_EQ(read->LabelIndex("walk"), 2);
  EXPECT_EQ(read->LabelIndex("swim"), -1);
  EXPECT_EQ(read->fine_labels[1].name, "stroll");
  EXPECT_EQ(read->fine_labels[1].parent, 2);
  ASSERT_NE(read->FindSplit("fold 2"), nullptr);
  EXPECT_EQ(read->FindSplit("fold 2")->validation, std::vector<int>{1});
  EXPECT_EQ(read->FindSplit("by_person")->leak_check, "ok: no person in two parts");
  EXPECT_EQ(read->FindSplit("none"), nullptr);
  EXPECT_EQ(read->findings, written.findings);
  EXPECT_EQ(read->recipe, written.recipe);
  EXPECT_EQ(read->created_by, written.created_by);
  EXPECT_TRUE(read->axes == written.axes);
}

TEST(Store, EachClipKeepsTheRestOffsetsOfItsPerson) {
  const ScratchFolder folder;
  Dataset written = MakeDataset();
  auto own = std::make_shared<Skeleton>(*written.skeleton);
  own->joints[1].rest_offset = Vector3d(0.01, -0.02, 0.03) + own->joints[1].rest_offset;
  Motion& motion = *written.clips[1].motion;
  motion.skeleton = own;
  ComputeJoints(motion);
  Status status = WriteDataset(written, folder / "set.h5");
  ASSERT_TRUE(status) << status.error().Message();
  const auto read = ReadDataset(folder / "set.h5");
  ASSERT_TRUE(read) << read.error().Message();
  for (std::size_t i = 0; i < written.clips.size(); ++i) {
    const Motion& back = *read->clips[i].motion;
    EXPECT_EQ(back.skeleton->joints[1].rest_offset, written.clips[i].motion->skeleton->joints[1].rest_offset) << i;
    status = back.Check();
    EXPECT_TRUE(status) << status.error().Message();
  }
  const auto clips = DatasetClips::Open(folder / "set.h5", DatasetClips::Check::kHashes);
  ASSERT_TRUE(clips) << clips.error().Message();
  EXPECT_EQ(clips->Read(1)->motion->skeleton->joints[1].rest_offset, own->joints[1].rest_offset);
  EXPECT_EQ(clips->Read(0)->motion->skeleton->joints[1].rest_offset, written.skeleton->joints[1].rest_offset);

  own->joints[1].parent = 0;
  own->joints[2].name = "other";
  EXPECT_FALSE(WriteDataset(written, folder / "other.h5")) << "another tree is another skeleton";
}

TEST(Store, ADatasetSaysWhatItsHeightZeroIs) {
  const ScratchFolder folder;
  const auto about = [&](const std::vector<std::string>& origins) {
    Dataset dataset = MakeDataset();
    for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
      dataset.clips[i].provenance.erase(kHeightOrigin);
      if (!origins[i].empty()) dataset.clips[i].provenance[kHeightOrigin] = origins[i];
    }
    EXPECT_TRUE(WriteDataset(dataset, folder / "set.h5"));
    const auto back = ReadDataset(folder / "set.h5");
    EXPECT_TRUE(back) << back.error().Message();
    EXPECT_EQ(back->clips[0].provenance, dataset.clips[0].provenance);
    const auto description = DescribeStore(folder / "set.h5");
    EXPECT_TRUE(description) << description.error().Message();
    return description->value("about", nlohmann::json());
  };
  const std::size_t clips = MakeDataset().clips.size();
  ASSERT_GE(clips, 2u);
  std::vector<std::string> origins(clips, kOriginFloor);
  EXPECT_EQ(about(origins), nlohmann::json({{"origin", "floor"}}));
  origins.back() = kOriginRoot;
  EXPECT_EQ(about(origins), nlohmann::json({{"origin", "mixed"}}));
  origins.back() = "";
  EXPECT_EQ(about(origins), nlohmann::json({{"origin", "mixed"}}));
  EXPECT_TRUE(about(std::vector<std::string>(clips)).is_null());
}

TEST(Store, JointsOnlySetsHaveNoRotationsAnywhere) {
  const ScratchFolder folder;
  const Dataset written = test::MakeJointsOnlyDataset();
  const Status status = WriteDataset(written, folder / "set.h5");
  ASSERT_TRUE(status) << status.error().Message();
  const auto read = ReadDataset(folder / "set.h5");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_TRUE(read->joints_only);
  for (std::size_t i = 0; i < 3; ++i) ExpectSameMotion(*read->clips[i].motion, *written.clips[i].motion);
}

TEST(Store, ADatasetWithoutClipsIsADataset) {
  const ScratchFolder folder;
  Dataset empty;
  empty.skeleton = test::Walker();
  const Status status = WriteDataset(empty, folder / "set.h5");
  ASSERT_TRUE(status) << status.error().Message();
  const auto read = ReadDataset(folder / "set.h5");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_TRUE(read->clips.empty());
}

TEST(Store, EverySkeletonOfTheProgramComesBackWithoutItsYaml) {
  const ScratchFolder folder;
  for (const char* name :
       {"smpl24", "humanact12", "ntu25", "ntu18", "cmu20", "cmu31", "kinect20", "openni15", "bandai22", "a2m21"}) {
    const auto skeleton = LoadSkeleton(name);
    ASSERT_TRUE(skeleton) << skeleton.error().Message();
    Dataset set;
    set.skeleton = *skeleton;
    const Status status = WriteDataset(set, folder / "set.h5");
    ASSERT_TRUE(status) << status.error().Message();
    const auto read = ReadDataset(folder / "set.h5");
    ASSERT_TRUE(read) << read.error().Message();
    EXPECT_TRUE(store::SameSkeleton(*read->skeleton, **skeleton)) << name;
    EXPECT_EQ(read->skeleton->name, (*skeleton)->name);
    for (int j = 0; j < (*skeleton)->joint_count(); ++j) {
      EXPECT_EQ(read->skeleton->Reflection(j), (*skeleton)->Reflection(j)) << name << " " << j;
    }
  }
}

void ExpectSameEvidence(const Evidence& read, const Evidence& written) {
  ASSERT_TRUE(read.tracks);
  EXPECT_EQ(read.tracks->names, written.tracks->names);
  EXPECT_EQ(read.tracks->time_s, written.tracks->time_s);
  EXPECT_EQ(read.tracks->positions.xyz, written.tracks->positions.xyz);
  EXPECT_EQ(read.tracks->confidence, written.tracks->confidence);
  EXPECT_EQ(read.tracks->rotation_confidence, written.tracks->rotation_confidence);
  ASSERT_EQ(read.tracks->rotation.size(), written.tracks->rotation.size());
  for (std::size_t i = 0; i < written.tracks->rotation.size(); ++i)
    EXPECT_EQ(read.tracks->rotation[i].coeffs(), written.tracks->rotation[i].coeffs());
  ASSERT_EQ(read.depth_views.size(), written.depth_views.size());
  for (std::size_t i = 0; i < read.depth_views.size(); ++i) {
    const DepthView& a = read.depth_views[i];
    const DepthView& b = written.depth_views[i];
    EXPECT_EQ(a.files, b.files);
    EXPECT_EQ(a.sha256, b.sha256);
    EXPECT_EQ(a.masks, b.masks);
    EXPECT_EQ(a.mask_sha256, b.mask_sha256);
    EXPECT_EQ(a.time_s, b.time_s);
    EXPECT_EQ(a.camera.name, b.camera.name);
    EXPECT_EQ(a.camera.width, b.camera.width);
    EXPECT_EQ(a.camera.cy, b.camera.cy);
    EXPECT_EQ(a.camera.distortion.p2, b.camera.distortion.p2);
    EXPECT_EQ(a.camera.camera_from_world.rotation.coeffs(), b.camera.camera_from_world.rotation.coeffs());
    EXPECT_EQ(a.camera.camera_from_world.translation, b.camera.camera_from_world.translation);
  }
}

void ExpectSameClouds(const CloudFiles& read, const CloudFiles& written) {
  EXPECT_EQ(read.files, written.files);
  EXPECT_EQ(read.sha256, written.sha256);
  EXPECT_EQ(read.time_s, written.time_s);
  EXPECT_EQ(read.metres_per_unit, written.metres_per_unit);
  EXPECT_EQ(read.world_from_file.rotation.coeffs(), written.world_from_file.rotation.coeffs());
  EXPECT_EQ(read.world_from_file.translation, written.world_from_file.translation);
}

void ExpectSameKeypoints(const Evidence& read, const Evidence& written) {
  EXPECT_EQ(read.keypoint_names, written.keypoint_names);
  EXPECT_EQ(read.subject, written.subject);
  ASSERT_EQ(read.keypoint_views.size(), written.keypoint_views.size());
  for (std::size_t i = 0; i < read.keypoint_views.size(); ++i) {
    const KeypointView& a = read.keypoint_views[i];
    const KeypointView& b = written.keypoint_views[i];
    EXPECT_EQ(a.camera.name, b.camera.name);
    EXPECT_EQ(a.camera.fy, b.camera.fy);
    EXPECT_EQ(a.camera.distortion.k3, b.camera.distortion.k3);
    EXPECT_EQ(a.camera.camera_from_world.translation, b.camera.camera_from_world.translation);
    EXPECT_EQ(a.people, b.people);
    EXPECT_EQ(a.time_s, b.time_s);
    EXPECT_EQ(a.values, b.values);
  }
}

TEST(Store, EvidenceComesBackExactlyWithPathsThatAreNotUtf8) {
  const ScratchFolder folder;
  for (const bool with_motion : {false, true}) {
    const Clip written = MakeEvidenceClip(with_motion);
    const Status status = WriteEvidence(written, folder / "evidence.h5");
    ASSERT_TRUE(status) << status.error().Message();
    const auto read = ReadEvidence(folder / "evidence.h5");
    ASSERT_TRUE(read) << read.error().Message();
    ExpectSameClip(*read, written);
    ExpectSameEvidence(read->evidence, written.evidence);
    ExpectSameKeypoints(read->evidence, written.evidence);
    ASSERT_TRUE(read->evidence.clouds);
    ExpectSameClouds(*read->evidence.clouds, *written.evidence.clouds);
    ASSERT_EQ(read->motion.has_value(), with_motion);
    if (with_motion) ExpectSameMotion(*read->motion, *written.motion);
  }
}

TEST(Store, EvidenceKeepsItsFindings) {
  const ScratchFolder folder;
  Finding finding;
  finding.clip = "KARD/p1/a#0-3";
  finding.code = "bone_slides";
  finding.value = 0.25;
  ASSERT_TRUE(WriteEvidence(MakeEvidenceClip(false), folder / "evidence.h5", {finding, finding}));
  std::vector<Finding> findings;
  ASSERT_TRUE(ReadEvidence(folder / "evidence.h5", &findings));
  EXPECT_EQ(findings, (std::vector<Finding>{finding, finding}));
  ASSERT_TRUE(WriteEvidence(MakeEvidenceClip(false), folder / "evidence.h5"));
  ASSERT_TRUE(ReadEvidence(folder / "evidence.h5", &findings));
  EXPECT_TRUE(findings.empty());
}

TEST(Store, MissingObservationsAreNotStoredAsNan) {
  const ScratchFolder folder;
  Clip clip = MakeEvidenceClip(false);
  clip.evidence.tracks->positions.xyz[6] = std::numeric_limits<double>::quiet_NaN();  // confidence 0
  ASSERT_TRUE(WriteEvidence(clip, folder / "evidence.h5"));
  EXPECT_EQ(ReadEvidence(folder / "evidence.h5")->evidence.tracks->positions.xyz[6], 0.0);
  clip.evidence.tracks->positions.xyz[0] = std::numeric_limits<double>::quiet_NaN();  // confidence 1
  const Status refused = WriteEvidence(clip, folder / "evidence.h5");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInconsistent);
  EXPECT_NE(refused.error().where.find(":/tracks/positions"), std::string::npos) << refused.error().Message();
}

TEST(Store, OnlyDetectedKeypointsMustBeFinite) {
  const ScratchFolder folder;
  Clip clip = MakeEvidenceClip(false);
  std::vector<double>& values = clip.evidence.keypoint_views[0].values;
  values[3] = std::numeric_limits<double>::quiet_NaN();  // confidence 0
  ASSERT_TRUE(WriteEvidence(clip, folder / "evidence.h5"));
  EXPECT_EQ(ReadEvidence(folder / "evidence.h5")->evidence.keypoint_views[0].at(0, 0, 1)[0], 0.0);
  values[0] = std::numeric_limits<double>::quiet_NaN();  // confidence 0.5
  const Status refused = WriteEvidence(clip, folder / "evidence.h5");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInconsistent);
  EXPECT_NE(refused.error().Message().find("cam01"), std::string::npos) << refused.error().Message();
  EXPECT_NE(refused.error().what.find("frame 0, person 0, nose"), std::string::npos) << refused.error().Message();
}

TEST(Store, CloudsWithoutOrderUnitOrHashAreRefusedWithTheField) {
  const ScratchFolder folder;
  const auto where = [&](const std::function<void(CloudFiles&)>& damage) {
    Clip clip = MakeEvidenceClip(false);
    damage(*clip.evidence.clouds);
    const Status written = WriteEvidence(clip, folder / "evidence.h5");
    return written ? std::string("written") : written.error().where;
  };
  EXPECT_THAT(where([](CloudFiles&) {}), "written");
  EXPECT_THAT(where([](CloudFiles& clouds) { clouds.time_s[1] = 0.0; }), HasSubstr("/clouds/time_s"));
  EXPECT_THAT(where([](CloudFiles& clouds) { clouds.metres_per_unit = 0.0; }), HasSubstr("/clouds/metres_per_unit"));
  EXPECT_THAT(where([](CloudFiles& clouds) { clouds.sha256[0] = "4"; }), HasSubstr("/clouds/sha256"));
  EXPECT_THAT(where([](CloudFiles& clouds) { clouds.files.pop_back(); }), HasSubstr("/clouds"));
  EXPECT_THAT(where([](CloudFiles& clouds) { clouds.world_from_file.rotation.coeffs() *= 2.0; }),
              HasSubstr("/clouds/world_from_file"));
}

TEST(Store, TruthComesBackByClip) {
  const ScratchFolder folder;
  const Truth written = MakeTruth();
  const Status status = WriteTruth(written, folder / "truth.h5");
  ASSERT_TRUE(status) << status.error().Message();
  const auto read = ReadTruth(folder / "truth.h5");
  ASSERT_TRUE(read) << read.error().Message();
  ASSERT_EQ(read->motion.size(), written.motion.size());
  for (const auto& [id, motion] : written.motion) ExpectSameMotion(read->motion.at(id), motion);
  ASSERT_TRUE(WriteTruth({}, folder / "none.h5"));
  EXPECT_TRUE(ReadTruth(folder / "none.h5")->motion.empty());
}

TEST(Store, TheSameContentGivesTheSameBytesAlsoAfterReading) {
  const ScratchFolder folder;
  for (const Dataset& dataset : {MakeDataset(), test::MakeJointsOnlyDataset()}) {
    ASSERT_TRUE(WriteDataset(dataset, folder / "a.h5"));
    ASSERT_TRUE(WriteDataset(dataset, folder / "b.h5"));
    EXPECT_TRUE(Bytes(folder / "a.h5") == Bytes(folder / "b.h5"));
    ASSERT_TRUE(WriteDataset(ReadDataset(folder / "a.h5").value(), folder / "b.h5"));
    EXPECT_TRUE(Bytes(folder / "a.h5") == Bytes(folder / "b.h5"));
  }
  ASSERT_TRUE(WriteEvidence(MakeEvidenceClip(true), folder / "a.h5"));
  ASSERT_TRUE(WriteEvidence(ReadEvidence(folder / "a.h5").value(), folder / "b.h5"));
  EXPECT_TRUE(Bytes(folder / "a.h5") == Bytes(folder / "b.h5"));
  ASSERT_TRUE(WriteTruth(MakeTruth(), folder / "a.h5"));
  ASSERT_TRUE(WriteTruth(ReadTruth(folder / "a.h5").value(), folder / "b.h5"));
  EXPECT_TRUE(Bytes(folder / "a.h5") == Bytes(folder / "b.h5"));
}

TEST(Store, AStoredQuaternionIsReadAsUnitAndStoredUnchanged) {
  Random random(1, "quaternions");
  for (int i = 0; i < 300000; ++i) {
    Quaterniond q = Quaterniond(random.Normal(), random.Normal(), random.Normal(), random.Normal()).normalized();
    const double tie = 1 + 1e-7 * random.Normal();
    if (i % 3 == 1) q = Quaterniond(q.x() * tie, q.x(), q.y(), q.z()).normalized();
    if (i % 3 == 2) q = Quaterniond(tie, -1, tie, 1 + 1e-7 * random.Normal()).normalized();
    const auto stored = store::StoredQuaternion(q);
    const Quaterniond read = store::ReadQuaternion(stored.data());
    ASSERT_EQ(store::StoredQuaternion(read), stored);
    ASSERT_NEAR(read.norm(), 1.0, 1e-15);
    ASSERT_LT((read.coeffs() - q.coeffs()).norm(), 3e-7);
  }
}

TEST(Store, ADescriptionNamesSchemaCountsAndFields) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(MakeDataset(), folder / "set.h5"));
  const auto json = DescribeStore(folder / "set.h5");
  ASSERT_TRUE(json) << json.error().Message();
  EXPECT_EQ((*json)["schema"], "mocurate/1");
  EXPECT_EQ((*json)["skeleton"], "walker");
  EXPECT_EQ((*json)["counts"]["clips"], 3);
  EXPECT_EQ((*json)["counts"]["frames"], 21);
  EXPECT_EQ((*json)["clips_per_person"]["p1"], 2);
  EXPECT_EQ((*json)["clips_per_label"]["run"], 1);
  EXPECT_NEAR((*json)["duration_s"].get<double>(), 21 * 1001.0 / 120000, 1e-12);
  EXPECT_TRUE((*json)["unknown"].empty());
  ASSERT_TRUE(WriteEvidence(MakeEvidenceClip(false), folder / "evidence.h5"));
  EXPECT_EQ((*DescribeStore(folder / "evidence.h5"))["counts"]["views"], 2);
  EXPECT_EQ((*DescribeStore(folder / "evidence.h5"))["counts"]["keypoint_images"], 6);
  ASSERT_TRUE(WriteTruth(MakeTruth(), folder / "truth.h5"));
  EXPECT_EQ((*DescribeStore(folder / "truth.h5"))["counts"]["clips"], 2);
}

}  // namespace
}  // namespace mocurate
