#include "ingest/known_issues.h"

#include <algorithm>
#include <filesystem>

#include "core/base/config.h"
#include "core/base/resources.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// A file of configs/known_issues.
struct IssueFile {
  std::vector<KnownIssue> issues;

  void Declare(OptionVisitor& v) { v.List("issues", issues, "what is known about which clips"); }
};

std::vector<std::string> BuiltInLists() {
  const std::string folder = "known_issues/", ending = ".yaml";
  std::vector<std::string> names;
  for (const std::string& path : ResourcePaths()) {
    if (path.rfind(folder, 0) == 0)
      names.push_back(path.substr(folder.size(), path.size() - folder.size() - ending.size()));
  }
  return names;
}

Expected<ConfigNode> ReadIssues(const std::string& name) {
  const std::string resource = "known_issues/" + name + ".yaml";
  if (const auto text = FindResource(resource)) return LoadData(ConfigSource{std::string(*text), resource, {}});
  std::error_code ignored;
  if (std::filesystem::is_regular_file(name, ignored)) return LoadData(std::filesystem::path(name));
  return Fail(ErrorCode::kNotFound, "there is no list '" + name + "' of known issues, neither built in nor as a file",
              "ingest.source.known_issue_lists",
              DidYouMean(name, BuiltInLists(), "built in: " + JoinTexts(BuiltInLists())));
}

}  // namespace

void KnownIssue::Declare(OptionVisitor& v) {
  v.Text("kind", kind, "what is wrong, in one word");
  v.Text("source", source, "origin of the statement");
  v.Text("note", note, "the statement");
  v.Texts("clips", clips, "names of recordings; * stands for any characters");
}

Expected<KnownIssues> KnownIssues::Load(const std::vector<std::string>& names) {
  KnownIssues known;
  for (const std::string& name : names) {
    const auto node = ReadIssues(name);
    if (!node) return Forward(node);
    auto file = OptionsFromConfig<IssueFile>(*node);
    if (!file) return Forward(file);
    for (KnownIssue& issue : file->issues) {
      if (issue.source.empty()) {
        return Fail(ErrorCode::kConfig, "issue '" + issue.kind + "' does not declare its source", node->origin.file,
                    "a known issue needs its origin: name it under `source`");
      }
      known.issues_.push_back(std::move(issue));
    }
  }
  return known;
}

std::optional<KnownIssue> KnownIssues::Find(const std::string& recording) const {
  const std::size_t dot = recording.rfind('.');
  const std::string last = dot == std::string::npos ? recording : recording.substr(dot + 1);
  for (const KnownIssue& issue : issues_) {
    for (const std::string& clip : issue.clips) {
      if (MatchesWildcard(clip, recording) || clip == last) return issue;
    }
  }
  return std::nullopt;
}

bool MatchesWildcard(const std::string& pattern, const std::string& text) {
  std::size_t p = 0, t = 0, star = std::string::npos, from = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      from = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string::npos) {
      p = star + 1;
      t = ++from;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace mocurate
