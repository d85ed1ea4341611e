#include "core/store/store.h"

#include <algorithm>
#include <set>

#include "core/base/file.h"
#include "core/store/content_file.h"
#include "core/store/fields.h"

namespace mocurate {
namespace {

using store::Content;
using store::MotionRow;

std::string Kinematics(bool joints_only) { return joints_only ? "joints" : "tree"; }

/// Errors of packing get the file's name before the clip's.
Status InFile(Status status, const std::filesystem::path& path) {
  if (!status) status.error().where = store::Where(path, status.error().where);
  return status;
}

void PackLabels(const Dataset& dataset, Content& content) {
  std::vector<std::int32_t> classes;
  for (const Clip& clip : dataset.clips) classes.push_back(dataset.LabelIndex(clip.label));
  content.Put("/labels/name", {dataset.labels.size()}, dataset.labels);
  content.Put("/clips/class", {dataset.clips.size()}, std::move(classes));
  if (dataset.fine_labels.empty()) return;
  std::vector<std::string> names;
  std::vector<std::int32_t> parents, fine;
  for (const FineLabel& label : dataset.fine_labels) {
    names.push_back(label.name);
    parents.push_back(label.parent);
  }
  for (const Clip& clip : dataset.clips) fine.push_back(dataset.FineLabelIndex(clip.fine_label));
  const std::uint64_t N = names.size();
  content.Put("/fine_labels/name", {N}, std::move(names));
  content.Put("/fine_labels/parent", {N}, std::move(parents));
  content.Put("/clips/fine_class", {dataset.clips.size()}, std::move(fine));
}

Status PackSplits(const std::vector<Split>& splits, Content& content) {
  for (const Split& split : splits) {
    if (!content.splits.insert(split.name).second) {
      return Fail(ErrorCode::kInconsistent, "two splits have the name '" + split.name + "'", "/splits");
    }
    const std::string path = "/splits/" + split.name;
    const auto put = [&](const char* name, const std::vector<int>& rows) {
      content.Put(path + name, {rows.size()}, std::vector<std::int32_t>(rows.begin(), rows.end()));
    };
    put("/train", split.train);
    put("/validation", split.validation);
    put("/test", split.test);
    content.PutText(path + "/rule", split.rule);
    content.PutText(path + "/leak_check", split.leak_check);
  }
  return {};
}

void PackFindings(const std::vector<Finding>& findings, Content& content) {
  const std::uint64_t N = findings.size();
  const auto texts = [&](const char* name, const auto& member) {
    std::vector<std::string> values;
    for (const Finding& finding : findings) values.emplace_back(member(finding));
    content.Put(std::string("/findings/") + name, {N}, std::move(values));
  };
  std::vector<std::int32_t> begin;
  std::vector<std::int32_t> end;
  std::vector<double> value;
  for (const Finding& finding : findings) {
    begin.push_back(finding.frame_begin);
    end.push_back(finding.frame_end);
    value.push_back(finding.value);
  }
  texts("clip", [](const Finding& f) { return f.clip; });
  content.Put("/findings/frame_begin", {N}, std::move(begin));
  content.Put("/findings/frame_end", {N}, std::move(end));
  texts("joint", [](const Finding& f) { return f.joint; });
  texts("code", [](const Finding& f) { return f.code; });
  texts("severity", [](const Finding& f) { return std::string(Name(f.severity)); });
  content.Put("/findings/value", {N}, std::move(value));
  texts("message", [](const Finding& f) { return f.message; });
  texts("action", [](const Finding& f) { return f.action; });
}

std::vector<Finding> UnpackFindings(const Content& content) {
  std::vector<Finding> findings(content.Has("/findings/clip") ? content.fields.at("/findings/clip").rows() : 0);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const auto text = [&](const char* name) {
      return content.Values<std::string>(std::string("/findings/") + name)[i];
    };
    Finding& finding = findings[i];
    finding.clip = text("clip");
    finding.code = text("code");
    for (const Severity severity : {Severity::kInfo, Severity::kWarning, Severity::kError}) {
      if (text("severity") == Name(severity)) finding.severity = severity;
    }
    finding.frame_begin = content.Values<std::int32_t>("/findings/frame_begin")[i];
    finding.frame_end = content.Values<std::int32_t>("/findings/frame_end")[i];
    finding.joint = text("joint");
    finding.value = content.Values<double>("/findings/value")[i];
    finding.message = text("message");
    finding.action = text("action");
  }
  return findings;
}

/// Packs one motion per clip after checking that clip and motion agree on the rate.
Status PackClipMotions(const std::vector<const Clip*>& clips, const Skeleton& skeleton, bool joints_only,
                       Content& content) {
  std::vector<MotionRow> rows;
  for (const Clip* clip : clips) {
    if (!clip->motion) return Fail(ErrorCode::kInconsistent, "the clip has no motion", clip->id());
    if (!(clip->motion->rate == clip->rate)) {
      return Fail(ErrorCode::kInconsistent,
                  "the clip's rate is " + clip->rate.Text() + ", its motion's " + clip->motion->rate.Text(),
                  clip->id());
    }
    rows.push_back({clip->id(), &*clip->motion});
  }
  return store::PackMotions(rows, skeleton, joints_only, "", content);
}

Expected<SkeletonPtr> CheckedSkeleton(const Content& content, const std::string& prefix,
                                      const std::filesystem::path& path) {
  auto skeleton = std::make_shared<Skeleton>(store::UnpackSkeleton(content, prefix));
  if (Status checked = store::CheckSkeleton(*skeleton, ErrorCode::kMalformed, path, prefix); !checked) {
    return Forward(checked);
  }
  return SkeletonPtr(std::move(skeleton));
}

}  // namespace

namespace store {

std::vector<Split> UnpackSplits(const Content& content) {
  std::vector<Split> splits;
  for (const std::string& name : content.splits) {
    const std::string path = "/splits/" + name;
    const auto rows = [&](const char* part) {
      const auto& values = content.Values<std::int32_t>(path + part);
      return std::vector<int>(values.begin(), values.end());
    };
    splits.push_back({name, rows("/train"), rows("/validation"), rows("/test"), content.Text(path + "/rule"),
                      content.Text(path + "/leak_check")});
  }
  return splits;
}

}  // namespace store

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

Status WriteDataset(const Dataset& dataset, const std::filesystem::path& path) {
  if (dataset.skeleton == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the dataset has no skeleton", DisplayPath(path));
  }
  Content content;
  content.PutText("/@kinematics", Kinematics(dataset.joints_only));
  content.PutText("/@axes", dataset.axes.Text());
  content.PutText("/@created_by", dataset.created_by);
  content.PutText("/recipe", dataset.recipe);
  store::PackSkeleton(*dataset.skeleton, "", content);
  std::vector<const Clip*> clips;
  for (const Clip& clip : dataset.clips) clips.push_back(&clip);
  store::PackClips(clips, content);
  content.PutText("/@rate", store::CommonRate(content.Values<std::string>("/clips/rate")));
  PackLabels(dataset, content);
  PackFindings(dataset.findings, content);
  if (Status packed = InFile(PackSplits(dataset.splits, content), path); !packed) return packed;
  if (Status packed = InFile(PackClipMotions(clips, *dataset.skeleton, dataset.joints_only, content), path); !packed) {
    return packed;
  }
  if (Status checked = store::CheckSkeleton(*dataset.skeleton, ErrorCode::kInconsistent, path, ""); !checked) {
    return checked;
  }
  return store::WriteContent(store::DatasetSchema(), std::move(content), path);
}

Expected<Dataset> ReadDataset(const std::filesystem::path& path) {
  auto content = store::ReadContent(store::DatasetSchema(), path);
  if (!content) return Forward(content);
  auto skeleton = CheckedSkeleton(*content, "", path);
  if (!skeleton) return Forward(skeleton);
  Dataset dataset;
  dataset.skeleton = *skeleton;
  dataset.joints_only = content->Text("/@kinematics") == "joints";
  dataset.clips = store::UnpackClips(*content);
  std::vector<Motion> motions = store::UnpackMotions(*content, "", *skeleton);
  for (std::size_t i = 0; i < motions.size(); ++i) dataset.clips[i].motion = std::move(motions[i]);
  if (content->Has("/labels/name")) dataset.labels = content->Values<std::string>("/labels/name");
  if (content->Has("/fine_labels/name")) {
    const auto& names = content->Values<std::string>("/fine_labels/name");
    const auto& parents = content->Values<std::int32_t>("/fine_labels/parent");
    for (std::size_t i = 0; i < names.size(); ++i) dataset.fine_labels.push_back({names[i], parents[i]});
  }
  dataset.splits = store::UnpackSplits(*content);
  dataset.findings = UnpackFindings(*content);
  dataset.recipe = content->Text("/recipe");
  dataset.created_by = content->Text("/@created_by");
  dataset.axes = *AxisConvention::Parse(content->Text("/@axes"));
  return dataset;
}

Status WriteEvidence(const Clip& clip, const std::filesystem::path& path, const std::vector<Finding>& findings) {
  Content content;
  if (!findings.empty()) PackFindings(findings, content);
  store::PackClips({&clip}, content);
  if (Status packed = InFile(store::PackEvidence(clip.evidence, content), path); !packed) return packed;
  content.PutText("/@kinematics", clip.motion ? Kinematics(clip.motion->joints_only()) : "none");
  if (clip.motion) {
    if (clip.motion->skeleton == nullptr) {
      return Fail(ErrorCode::kInconsistent, "the motion has no skeleton", store::Where(path, clip.id()));
    }
    const Skeleton& skeleton = *clip.motion->rest_pose();
    if (Status checked = store::CheckSkeleton(skeleton, ErrorCode::kInconsistent, path, ""); !checked) return checked;
    store::PackSkeleton(skeleton, "", content);
    Status packed = InFile(PackClipMotions({&clip}, skeleton, clip.motion->joints_only(), content), path);
    if (!packed) return packed;
  }
  return store::WriteContent(store::EvidenceSchema(), std::move(content), path);
}

Expected<Clip> ReadEvidence(const std::filesystem::path& path, std::vector<Finding>* findings) {
  auto content = store::ReadContent(store::EvidenceSchema(), path);
  if (!content) return Forward(content);
  Clip clip = std::move(store::UnpackClips(*content)[0]);
  clip.evidence = store::UnpackEvidence(*content);
  if (findings != nullptr) *findings = UnpackFindings(*content);
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
    rows.push_back({id, &motion});
    ids.push_back(id);
    rates.push_back(store::TextOfRate(motion.rate));
  }
  const Motion& first = *rows[0].motion;
  if (first.skeleton == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the motion has no skeleton", store::Where(path, ids[0]));
  }
  content.PutText("/@kinematics", Kinematics(first.joints_only()));
  store::PackSkeleton(*first.skeleton, prefix, content);
  Status packed = InFile(store::PackMotions(rows, *first.skeleton, first.joints_only(), prefix, content), path);
  if (!packed) return packed;
  content.Put(prefix + "/clips/id", {rows.size()}, std::move(ids));
  content.Put(prefix + "/clips/rate", {rows.size()}, std::move(rates));
  return store::WriteContent(store::TruthSchema(), std::move(content), path);
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
