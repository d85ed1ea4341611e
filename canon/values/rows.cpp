#include "canon/values/rows.h"

#include <set>

namespace mocurate {

std::vector<std::size_t> KeepRows(const std::vector<bool>& keep, Dataset& dataset) {
  std::vector<std::size_t> rows;
  std::vector<int> new_row(keep.size(), -1);
  std::vector<Clip> kept;
  std::set<std::string> gone;
  for (std::size_t row = 0; row < keep.size(); ++row) {
    if (!keep[row]) {
      gone.insert(dataset.clips[row].id());
      continue;
    }
    new_row[row] = static_cast<int>(rows.size());
    rows.push_back(row);
    kept.push_back(std::move(dataset.clips[row]));
  }
  dataset.clips = std::move(kept);
  for (Split& split : dataset.splits) {
    for (std::vector<int>* part : {&split.train, &split.validation, &split.test}) {
      std::vector<int> of_part;
      for (const int row : *part) {
        if (new_row[static_cast<std::size_t>(row)] >= 0) of_part.push_back(new_row[static_cast<std::size_t>(row)]);
      }
      *part = std::move(of_part);
    }
  }
  std::vector<Finding> findings;
  for (Finding& finding : dataset.findings) {
    if (gone.count(finding.clip) == 0) findings.push_back(std::move(finding));
  }
  dataset.findings = std::move(findings);
  return rows;
}

void DropEmptyLabels(Dataset& dataset) {
  std::set<std::string> used, used_fine;
  for (const Clip& clip : dataset.clips) {
    used.insert(clip.label);
    used_fine.insert(clip.fine_label);
  }
  std::vector<std::string> labels;
  std::vector<int> new_class(dataset.labels.size(), -1);
  for (std::size_t i = 0; i < dataset.labels.size(); ++i) {
    if (used.count(dataset.labels[i]) == 0) continue;
    new_class[i] = static_cast<int>(labels.size());
    labels.push_back(dataset.labels[i]);
  }
  std::vector<FineLabel> fine_labels;
  for (const FineLabel& fine : dataset.fine_labels) {
    const int parent = new_class[static_cast<std::size_t>(fine.parent)];
    if (parent >= 0 && used_fine.count(fine.name) > 0) fine_labels.push_back({fine.name, parent});
  }
  dataset.labels = std::move(labels);
  dataset.fine_labels = std::move(fine_labels);
}

}  // namespace mocurate
