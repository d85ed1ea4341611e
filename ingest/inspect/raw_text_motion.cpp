#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/text.h"
#include "core/formats/babel.h"
#include "core/formats/opensim_table.h"
#include "core/formats/row_counter.h"
#include "core/quality/tracked_points.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {

Expected<RawFile> ReadRawOpenSim(const FileBytes& file) {
  const auto table = ParseOpenSimTable(file.bytes, file.name);
  if (!table) return Forward(table);
  RawClip clip;
  clip.format = "opensim_table";
  clip.frames = table->rows();
  const Expected<RowPlaces> places = PlacesByClock(table->time_s, file.name);
  if (!places) return Forward(places);
  if (places->step > 0.0) {
    clip.rate_hz = std::round(1000.0 / places->step) / 1000.0;
    clip.rate_evidence = "column time of the file";
    const int skipped = places->frames() - clip.frames;
    if (skipped > 0) {
      clip.remarks.push_back(MakeFinding("time_gap", Severity::kWarning, skipped,
                                         Counted(skipped, "frame") + " of those of column time have no row, at " +
                                             FormatDouble(*clip.rate_hz) + " Hz"));
    }
  }
  clip.layout_evidence = std::to_string(table->labels.size()) + " columns beside time";
  clip.skeleton.evidence = "coordinates of a model that is not in the file";
  clip.silence = "coordinates of a model that is not in the file";
  clip.missing_share = 0.0;
  clip.facts.emplace_back("coordinates", std::to_string(table->labels.size()));
  if (table->in_degrees) clip.facts.emplace_back("angles", *table->in_degrees ? "degrees" : "radians");
  if (const auto doubt = CheckAngleUnits(*table)) clip.remarks.push_back(*doubt);
  clip.units = table->components == 1 ? "m" : "";
  return RawFile::Of(std::move(clip));
}

namespace {

/// A category that few segments of BABEL have, or none.
struct RareCategory {
  int labels = 0;
  std::string sequence;  ///< the first that has it
};

void CheckCategories(const BabelSequence& sequence, std::map<std::string, RareCategory>& rare) {
  for (const std::vector<BabelAnnotation>* annotations : {&sequence.seq_anns, &sequence.frame_anns}) {
    for (const BabelAnnotation& annotation : *annotations) {
      for (const BabelLabel& label : annotation.labels) {
        for (const std::string& category : label.act_cat.value_or(std::vector<std::string>())) {
          if (IsFrequentBabelCategory(category)) continue;
          RareCategory& entry = rare[category];
          if (entry.labels++ == 0) entry.sequence = sequence.key;
        }
      }
    }
  }
}

/// One that is nearly a frequent one may be misspelt, and is reported by itself; the others may be BABEL's rare ones.
void ReportCategories(const std::map<std::string, RareCategory>& rare, RawFile& observed) {
  const std::vector<std::string> known = FrequentBabelCategories();
  std::size_t others = 0;
  std::string first;
  for (const auto& [category, entry] : rare) {
    const std::string words = entry.sequence + ": category '" + category + "' of " + Counted(entry.labels, "label");
    if (const std::optional<std::string> meant = Nearest(category, known)) {
      observed.remarks.push_back(
          MakeFinding("category_unknown", Severity::kInfo, static_cast<double>(entry.labels),
                      words + " is none of BABEL's 150 frequent ones: did you mean '" + *meant + "'?"));
    } else if (others++ == 0) {
      first = words;
    }
  }
  if (others == 0) return;
  observed.remarks.push_back(
      MakeFinding("category_unknown", Severity::kInfo, static_cast<double>(others),
                  std::to_string(others) + (others == 1 ? " category" : " categories") +
                      " beside BABEL's 150 frequent ones, which may be of its rare ones; the first: " + first));
}

}  // namespace

Expected<RawFile> ReadRawBabel(const FileBytes& file) {
  const auto sequences = ParseBabel(file.bytes, file.name);
  if (!sequences) return Forward(sequences);
  RawFile observed;
  std::map<std::string, RareCategory> doubts;
  double seconds = 0.0, sequence_labels = 0.0, segments = 0.0, labelled = 0.0;
  for (const BabelSequence& sequence : *sequences) {
    seconds += sequence.dur;
    observed.annotated.push_back({file.name, sequence.key, sequence.feat_p, sequence.dur});
    CheckCategories(sequence, doubts);
    for (const BabelAnnotation& annotation : sequence.seq_anns)
      sequence_labels += static_cast<double>(annotation.labels.size());
    for (const BabelAnnotation& annotation : sequence.frame_anns) {
      for (const BabelLabel& label : annotation.labels) {
        segments += 1.0;
        if (label.start_t && label.end_t) labelled += std::max(0.0, *label.end_t - *label.start_t);
      }
    }
    for (const BabelProblem& problem : FindBabelProblems(sequence)) {
      observed.remarks.push_back(
          MakeFinding("babel_times", Severity::kWarning, 0.0, problem.where + ": " + problem.what));
    }
  }
  ReportCategories(doubts, observed);
  observed.companions.push_back({file.name,
                                 "babel",
                                 {},
                                 {{"sequences", static_cast<double>(sequences->size())},
                                  {"duration_s", seconds},
                                  {"sequence_labels", sequence_labels},
                                  {"segments", segments},
                                  {"segments_s", labelled}}});
  return observed;
}

}  // namespace mocurate
