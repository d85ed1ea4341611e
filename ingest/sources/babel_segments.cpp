#include "ingest/sources/babel_segments.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kMostOff = 0.05, kMostOff_s = 0.25;  // largest difference between an annotated sequence and the motion

/// Names of datasets before and after AMASS renamed them.
const std::map<std::string, std::string>& NewNames() {
  static const std::map<std::string, std::string> names = {{"BioMotionLab_NTroje", "BMLrub"},
                                                           {"DFaust_67", "DFaust"},
                                                           {"Eyes_Japan_Dataset", "EyesJapanDataset"},
                                                           {"MPI_HDM05", "HDM05"},
                                                           {"MPI_Limits", "PosePrior"},
                                                           {"MPI_mosh", "MoSh"},
                                                           {"SSM_synced", "SSM"},
                                                           {"TCD_handMocap", "TCDHands"},
                                                           {"Transitions_mocap", "Transitions"}};
  return names;
}

std::string Newer(std::string name) {
  const std::string old = "poses.npz";
  if (EndsWith(name, old)) {
    name.replace(name.size() - old.size(), old.size(), "stageii.npz");
  }
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

Finding Found(const char* code, double value, std::string message, FindingAction action) {
  return MakeFinding(code, Severity::kWarning, value, std::move(message), action);
}

std::string NameOfLabel(const BabelLabel& label) {
  const auto& name = label.proc_label ? label.proc_label : label.raw_label;
  return name.value_or("");
}

}  // namespace

std::vector<std::string> AmassNames(const std::string& feat_p) {
  const std::size_t first = feat_p.find('/');
  if (first == std::string::npos) return {feat_p};
  const std::string old = feat_p.substr(first + 1);
  std::vector<std::string> names{old};
  const std::size_t slash = old.find('/');
  const std::string dataset = old.substr(0, slash);
  const auto renamed = NewNames().find(dataset);
  if (slash != std::string::npos && renamed != NewNames().end()) names.push_back(renamed->second + old.substr(slash));
  for (std::size_t i = 0, count = names.size(); i < count; ++i) {
    const std::string newer = Newer(names[i]);
    if (newer != names[i]) names.push_back(newer);
  }
  return names;
}

Expected<BabelIndex> BabelIndex::Read(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  BabelIndex index;
  std::set<std::string> known;
  for (const std::string& name : names) {
    const Expected<std::string> bytes = ReadFile(folder / std::filesystem::u8path(name));
    if (!bytes) return Forward(bytes);
    Expected<std::vector<BabelSequence>> sequences = ParseBabel(*bytes, name);
    if (!sequences) return Forward(sequences);
    for (BabelSequence& sequence : *sequences) {
      if (!known.insert(sequence.key).second) continue;
      for (const std::string& file : AmassNames(sequence.feat_p)) index.by_name_.emplace(file, index.sequences_.size());
      index.sequences_.push_back({std::move(sequence), name});
    }
  }
  index.used_.assign(index.sequences_.size(), false);
  return index;
}

const IndexedSequence* BabelIndex::Find(const std::string& file) {
  for (std::size_t at = 0;; ++at) {
    const auto found = by_name_.find(file.substr(at));
    if (found != by_name_.end()) {
      used_[found->second] = true;
      return &sequences_[found->second];
    }
    at = file.find('/', at);
    if (at == std::string::npos) return nullptr;
  }
}

std::vector<std::string> BabelIndex::Unused() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < sequences_.size(); ++i) {
    if (!used_[i]) names.push_back(sequences_[i].sequence.feat_p);
  }
  return names;
}

std::optional<Finding> CheckDuration(double annotated_s, double duration_s) {
  if (std::abs(annotated_s - duration_s) <= kMostOff_s + kMostOff * duration_s) return std::nullopt;
  return Found("annotation_duration", annotated_s,
               "the annotation is of a sequence of " + RoundedText(annotated_s) + " s, the motion lasts " +
                   RoundedText(duration_s) + " s: check that it is the complete file that feat_p names, and its rate" +
                   "; labels within the motion are kept",
               FindingAction::kKept);
}

std::vector<Segment> SegmentsOf(const BabelSequence& sequence, double duration_s, double frame_s,
                                std::vector<Finding>& findings) {
  const bool whole = sequence.frame_anns.empty();
  const std::vector<BabelAnnotation>& annotations = whole ? sequence.seq_anns : sequence.frame_anns;
  std::vector<Segment> segments;
  if (annotations.empty()) return segments;
  if (auto duration = CheckDuration(sequence.dur, duration_s)) findings.push_back(*std::move(duration));
  int withheld = 0;
  for (const BabelLabel& label : annotations[0].labels) {
    const std::string name = NameOfLabel(label);
    if (name.empty()) {
      ++withheld;
      continue;
    }
    const double begin = whole ? 0.0 : label.start_t.value_or(-1.0);
    const double end = whole ? duration_s : label.end_t.value_or(-1.0);
    if (!(begin >= 0.0 && begin < end && begin < duration_s)) {
      findings.push_back(Found("segment_times", begin,
                               "'" + name + "' from " + RoundedText(begin) + " s to " + RoundedText(end) +
                                   " s cannot be in a motion of " + RoundedText(duration_s) + " s",
                               FindingAction::kExcluded));
      continue;
    }
    if (end > duration_s + frame_s) {
      findings.push_back(Found("segment_times", end - duration_s,
                               "'" + name + "' ends " + FormatDouble(std::round((end - duration_s) * 1e3) / 1e3) +
                                   " s after the motion" + "; cut at its end",
                               FindingAction::kKept));
    }
    segments.push_back({begin, std::min(end, duration_s), name,
                        JoinTexts(label.act_cat.value_or(std::vector<std::string>())), "annotated"});
  }
  if (withheld > 0) {
    findings.push_back(
        Found("label_withheld", withheld, Counted(withheld, "label") + " without a name", FindingAction::kExcluded));
  }
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& a, const Segment& b) { return a.begin_s < b.begin_s; });
  return segments;
}

}  // namespace mocurate
