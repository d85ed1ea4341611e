#include "canon/recipes/classes.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/text.h"

namespace mocurate {
namespace {

/// Label of a clip -> position of its class.
std::map<std::string, int> ClassOfLabels(const std::vector<ClassOptions>& classes) {
  std::map<std::string, int> class_of;
  for (std::size_t c = 0; c < classes.size(); ++c) {
    class_of.emplace(classes[c].name, static_cast<int>(c));
    for (const std::string& label : classes[c].from) class_of.emplace(label, static_cast<int>(c));
  }
  return class_of;
}

Finding NotListed(const Clip& clip, const std::vector<ClassOptions>& classes) {
  std::vector<std::string> names;
  for (const ClassOptions& listed : classes) names.push_back(listed.name);
  const auto near = Nearest(clip.label, names);
  return MakeFinding(kLabelNotListed, Severity::kInfo, 0.0,
                     "label '" + clip.label + "' maps to none of the " + std::to_string(classes.size()) +
                         (classes.size() == 1 ? " class" : " classes") + " of the recipe" +
                         (near ? "; the nearest is '" + *near + "'" : ""),
                     FindingAction::kExcluded, clip.id());
}

/// Fine labels of the clips, by class and name. A fine label of two classes stays with the first: clips of the other
/// lose it, with a finding.
void CollectFineLabels(Dataset& dataset, std::vector<Finding>& findings) {
  std::set<std::pair<int, std::string>> found;
  for (const Clip& clip : dataset.clips) {
    const int parent = dataset.LabelIndex(clip.label);
    if (!clip.fine_label.empty() && parent >= 0) found.emplace(parent, clip.fine_label);
  }
  for (const auto& [parent, name] : found) {
    if (dataset.FineLabelIndex(name) < 0) dataset.fine_labels.push_back({name, parent});
  }
  for (Clip& clip : dataset.clips) {
    const int fine = dataset.FineLabelIndex(clip.fine_label);
    if (fine < 0) continue;
    const std::string& parent =
        dataset.labels[static_cast<std::size_t>(dataset.fine_labels[static_cast<std::size_t>(fine)].parent)];
    if (parent == clip.label) continue;
    findings.push_back(MakeFinding("fine_label_of_two_classes", Severity::kWarning, 0.0,
                                   "fine label '" + clip.fine_label + "' is of class '" + parent +
                                       "', the clip is of '" + clip.label +
                                       "'; give it another name; fine label removed",
                                   FindingAction::kKept, clip.id()));
    clip.fine_label.clear();
  }
}

void Compare(const std::string& what, const std::optional<double>& expected, std::size_t found,
             std::vector<Finding>& findings) {
  if (!expected || *expected == static_cast<double>(found)) return;
  findings.push_back(
      MakeFinding("count_not_expected", Severity::kWarning, static_cast<double>(found),
                  what + ": " + std::to_string(found) + ", the recipe expects " + RoundedText(*expected, 9)));
}

}  // namespace

std::vector<std::string> OrderedLabels(const std::vector<std::string>& order, const std::set<std::string>& present) {
  std::vector<std::string> labels;
  std::set<std::string> rest = present;
  rest.erase("");
  for (const std::string& label : order) {
    if (rest.erase(label) > 0) labels.push_back(label);
  }
  labels.insert(labels.end(), rest.begin(), rest.end());
  return labels;
}

Status CheckClasses(const AssembleOptions& options) {
  std::map<std::string, std::string> class_of, class_of_fine;
  const auto once = [](std::map<std::string, std::string>& seen, const std::string& label, const std::string& name,
                       const char* what) -> Status {
    const auto [known, added] = seen.emplace(label, name);
    if (added) return {};
    return Fail(ErrorCode::kConfig,
                std::string(what) + " '" + label + "' is listed for '" + known->second + "' and '" + name + "'",
                "assemble.classes", "list it once");
  };
  for (const ClassOptions& listed : options.classes) {
    if (listed.name.empty()) return Fail(ErrorCode::kConfig, "a class has no name", "assemble.classes");
    if (Status own = once(class_of, listed.name, listed.name, "class"); !own) return own;
    for (const std::string& label : listed.from) {
      if (label == listed.name) continue;
      if (Status own = once(class_of, label, listed.name, "label"); !own) return own;
    }
    for (const std::string& fine : listed.fine) {
      if (Status own = once(class_of_fine, fine, listed.name, "fine label"); !own) return own;
    }
  }
  return {};
}

void ApplyClasses(const AssembleOptions& options, Dataset& dataset, std::vector<Finding>& findings) {
  if (options.classes.empty()) {
    std::set<std::string> present;
    for (const Clip& clip : dataset.clips) present.insert(clip.label);
    dataset.labels = OrderedLabels(options.label_order, present);
    return CollectFineLabels(dataset, findings);
  }
  for (std::size_t c = 0; c < options.classes.size(); ++c) {
    dataset.labels.push_back(options.classes[c].name);
    for (const std::string& fine : options.classes[c].fine) dataset.fine_labels.push_back({fine, static_cast<int>(c)});
  }
  const std::map<std::string, int> class_of = ClassOfLabels(options.classes);
  std::vector<Clip> kept;
  for (Clip& clip : dataset.clips) {
    const auto found = class_of.find(clip.label);
    if (found == class_of.end()) {
      findings.push_back(NotListed(clip, options.classes));
      continue;
    }
    clip.label = dataset.labels[static_cast<std::size_t>(found->second)];
    kept.push_back(std::move(clip));
  }
  dataset.clips = std::move(kept);
  CollectFineLabels(dataset, findings);
}

void FindEmptyClasses(const AssembleOptions& options, const Dataset& dataset, std::vector<Finding>& findings) {
  std::set<std::string> present;
  for (const Clip& clip : dataset.clips) present.insert(clip.label);
  std::string names;
  std::size_t empty = 0;
  for (const ClassOptions& listed : options.classes) {
    if (present.count(listed.name) != 0) continue;
    names += (empty++ > 0 ? ", " : "") + listed.name;
  }
  if (empty == 0) return;
  findings.push_back(MakeFinding("class_without_clips", Severity::kWarning, static_cast<double>(empty),
                                 std::to_string(empty) + " of the " + std::to_string(options.classes.size()) +
                                     " classes of assemble.classes have no clip: " + names +
                                     "; they keep their indices, for networks and recognisers of the recipe"));
}

void CompareWithExpected(const AssembleOptions& options, const Dataset& dataset, std::vector<Finding>& findings) {
  std::set<std::string> persons;
  std::map<std::string, std::size_t> clips_of;
  std::size_t frames = 0;
  for (const Clip& clip : dataset.clips) {
    persons.insert(clip.identity.person);
    ++clips_of[clip.label];
    frames += static_cast<std::size_t>(clip.motion->frame_count());
  }
  Compare("clips", options.expected.clips, dataset.clips.size(), findings);
  Compare("frames", options.expected.frames, frames, findings);
  Compare("persons", options.expected.persons, persons.size(), findings);
  for (const ClassOptions& listed : options.classes) {
    Compare("clips of class '" + listed.name + "'", listed.clips, clips_of[listed.name], findings);
  }
}

}  // namespace mocurate
