#include "core/store/fields.h"

namespace mocurate::store {

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
  texts("action", [](const Finding& f) { return std::string(Name(f.action)); });
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
    finding.action = FindingActionFromName(text("action"));
  }
  return findings;
}

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

void UnpackDatasetParts(const Content& content, Dataset& dataset) {
  dataset.joints_only = content.Text("/@kinematics") == "joints";
  if (content.Has("/labels/name")) dataset.labels = content.Values<std::string>("/labels/name");
  if (content.Has("/fine_labels/name")) {
    const auto& names = content.Values<std::string>("/fine_labels/name");
    const auto& parents = content.Values<std::int32_t>("/fine_labels/parent");
    for (std::size_t i = 0; i < names.size(); ++i) dataset.fine_labels.push_back({names[i], parents[i]});
  }
  dataset.splits = UnpackSplits(content);
  dataset.findings = UnpackFindings(content);
  dataset.recipe = content.Text("/recipe");
  dataset.created_by = content.Text("/@created_by");
  dataset.axes = *AxisConvention::Parse(content.Text("/@axes"));
}

}  // namespace mocurate::store
