#include "core/store/store.h"

#include "core/base/file.h"
#include "core/store/content_file.h"
#include "core/store/dataset_writer.h"
#include "core/store/fields.h"
#include "core/store/motion_writer.h"

namespace mocurate {
namespace {

using store::Content;
using store::MotionRow;

std::string Kinematics(bool joints_only) { return joints_only ? "joints" : "tree"; }

Expected<SkeletonPtr> CheckedSkeleton(const Content& content, const std::string& prefix,
                                      const std::filesystem::path& path) {
  auto skeleton = std::make_shared<Skeleton>(store::UnpackSkeleton(content, prefix));
  if (Status checked = store::CheckSkeleton(*skeleton, ErrorCode::kMalformed, path, prefix); !checked) {
    return Forward(checked);
  }
  return SkeletonPtr(std::move(skeleton));
}

}  // namespace

int Dataset::LabelIndex(const std::string& label) const {
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == label) return static_cast<int>(i);
  }
  return -1;
}

int Dataset::FineLabelIndex(const std::string& label) const {
  for (std::size_t i = 0; i < fine_labels.size(); ++i) {
    if (fine_labels[i].name == label) return static_cast<int>(i);
  }
  return -1;
}

const Split* Dataset::FindSplit(const std::string& name) const {
  for (const Split& split : splits) {
    if (split.name == name) return &split;
  }
  return nullptr;
}

Expected<Dataset> ReadDataset(const std::filesystem::path& path) {
  auto content = store::ReadContent(store::DatasetSchema(), path);
  if (!content) return Forward(content);
  auto skeleton = CheckedSkeleton(*content, "", path);
  if (!skeleton) return Forward(skeleton);
  Dataset dataset;
  dataset.skeleton = *skeleton;
  store::UnpackDatasetParts(*content, dataset);
  dataset.clips = store::UnpackClips(*content);
  std::vector<Motion> motions = store::UnpackMotions(*content, "", *skeleton);
  for (std::size_t i = 0; i < motions.size(); ++i) dataset.clips[i].motion = std::move(motions[i]);
  return dataset;
}

Status WriteEvidence(const Clip& clip, const std::filesystem::path& path, const std::vector<Finding>& findings) {
  Content content;
  if (!findings.empty()) store::PackFindings(findings, content);
  store::PackClips({&clip}, content);
  if (Status packed = store::InFile(store::PackEvidence(clip.evidence, content), path); !packed) return packed;
  if (!clip.motion) {
    content.PutText("/@kinematics", "none");
    return store::WriteContent(store::EvidenceSchema(), std::move(content), path);
  }
  const Motion& motion = *clip.motion;
  content.PutText("/@kinematics", Kinematics(motion.joints_only()));
  if (motion.skeleton == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the motion has no skeleton", store::Where(path, clip.id()));
  }
  const Skeleton& skeleton = *motion.rest_pose();
  if (Status checked = store::CheckSkeleton(skeleton, ErrorCode::kInconsistent, path, ""); !checked) return checked;
  store::PackSkeleton(skeleton, "", content);
  if (Status rates = store::CheckRates(clip, path); !rates) return rates;
  auto writer = store::MotionWriter::Create(store::EvidenceSchema(), std::move(content),
                                            {{clip.id(), &motion, OptionalFieldsOf(motion)}}, skeleton,
                                            motion.joints_only(), path);
  if (!writer) return Forward(writer);
  if (Status written = writer->Append(motion); !written) return written;
  return writer->Finish();
}

Expected<Clip> ReadEvidence(const std::filesystem::path& path, std::vector<Finding>* findings) {
  auto content = store::ReadContent(store::EvidenceSchema(), path);
  if (!content) return Forward(content);
  Clip clip = std::move(store::UnpackClips(*content)[0]);
  clip.evidence = store::UnpackEvidence(*content);
  if (findings != nullptr) *findings = store::UnpackFindings(*content);
  if (content->Text("/@kinematics") == "none") return clip;
  auto skeleton = CheckedSkeleton(*content, "", path);
  if (!skeleton) return Forward(skeleton);
  clip.motion = std::move(store::UnpackMotions(*content, "", *skeleton)[0]);
  return clip;
}

Status WriteTruth(const Truth& truth, const std::filesystem::path& path) {
  Content content;
  const std::string prefix = store::TruthSchema().prefix;
  if (truth.motion.empty()) {
    content.PutText("/@kinematics", "none");
    return store::WriteContent(store::TruthSchema(), std::move(content), path);
  }
  std::vector<MotionRow> rows;
  std::vector<std::string> ids;
  std::vector<std::string> rates;
  for (const auto& [id, motion] : truth.motion) {
    rows.push_back({id, &motion, OptionalFieldsOf(motion)});
    ids.push_back(id);
    rates.push_back(store::TextOfRate(motion.rate));
  }
  const Motion& first = *rows[0].motion;
  if (first.skeleton == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the motion has no skeleton", store::Where(path, ids[0]));
  }
  content.PutText("/@kinematics", Kinematics(first.joints_only()));
  store::PackSkeleton(*first.skeleton, prefix, content);
  content.Put(prefix + "/clips/id", {rows.size()}, std::move(ids));
  content.Put(prefix + "/clips/rate", {rows.size()}, std::move(rates));
  auto writer = store::MotionWriter::Create(store::TruthSchema(), std::move(content), rows, *first.skeleton,
                                            first.joints_only(), path);
  if (!writer) return Forward(writer);
  for (const MotionRow& row : rows) {
    if (Status written = writer->Append(*row.motion); !written) return written;
  }
  return writer->Finish();
}

Expected<Truth> ReadTruth(const std::filesystem::path& path) {
  auto content = store::ReadContent(store::TruthSchema(), path);
  if (!content) return Forward(content);
  Truth truth;
  if (content->Text("/@kinematics") == "none") return truth;
  const std::string prefix = store::TruthSchema().prefix;
  auto skeleton = CheckedSkeleton(*content, prefix, path);
  if (!skeleton) return Forward(skeleton);
  std::vector<Motion> motions = store::UnpackMotions(*content, prefix, *skeleton);
  const auto& ids = content->Values<std::string>(prefix + "/clips/id");
  for (std::size_t i = 0; i < motions.size(); ++i) truth.motion[ids[i]] = std::move(motions[i]);
  return truth;
}

}  // namespace mocurate
