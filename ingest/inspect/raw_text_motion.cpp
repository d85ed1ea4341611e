#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/text.h"
#include "core/formats/babel.h"
#include "core/formats/expmap_table.h"
#include "core/formats/opensim_table.h"
#include "core/formats/row_counter.h"
#include "core/quality/tracked_points.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {
namespace {

constexpr double kTurn = 6.2832;          // radians; no rotation vector of these sets is longer
constexpr double kStill = 1e-5;           // radians; rounding of the exporter
constexpr double kFewestConstant = 0.15;  // share of columns; bones without a degree of freedom stay at 0

constexpr double kMostDamaged = 0.5;  // share of rows that are not whole, of what is named a table of rotations

/// 99 or 117 where most rows of the file have as many numbers; 0: another file.
int ColumnsOfExpmap(std::string_view bytes) {
  std::size_t rows = 0, as_99 = 0, as_117 = 0;
  for (const std::string_view line : SplitText(bytes, '\n')) {
    if (Trim(line).empty()) continue;
    const auto commas = std::count(line.begin(), line.end(), ',');
    ++rows;
    as_99 += commas == 98 ? 1 : 0;
    as_117 += commas == 116 ? 1 : 0;
  }
  return 2 * as_99 > rows ? 99 : 2 * as_117 > rows ? 117 : 0;
}

/// Whether every number of a row is one, and no vector longer than a turn.
bool IsWholeRow(const ExpmapTable& table, std::size_t f) {
  const std::size_t columns = static_cast<std::size_t>(table.joints) * 3;
  for (std::size_t c = 0; c < columns; c += 3) {
    const double* r = &table.rotation_rad[f * columns + c];
    if (!(std::hypot(r[0], r[1], r[2]) <= kTurn)) return false;
  }
  return true;
}

/// Of rows whose numbers stand and are too large.
Finding TooLarge(std::size_t f) {
  const int frame = static_cast<int>(f);
  Finding finding = FrameFinding("malformed", frame, frame + 1, "", 1.0,
                                 "row " + std::to_string(frame + 1) +
                                     ": a rotation vector is longer than 2 pi, those of the other rows are not: its "
                                     "numbers are damaged; copy the file again");
  finding.severity = Severity::kError;
  return finding;
}

}  // namespace

std::optional<RawClip> ReadRawExpmap(std::string_view bytes, const std::string& name) {
  const int wide = ColumnsOfExpmap(bytes);
  if (wide == 0) return std::nullopt;
  const auto table = ParseExpmapTable(bytes, name, wide, DamagedRows::kReport);
  if (!table || table->frames < 2) return std::nullopt;
  const auto columns = static_cast<std::size_t>(table->joints) * 3, rows = static_cast<std::size_t>(table->frames);
  std::vector<std::size_t> whole;
  for (std::size_t f = 0; f < rows; ++f) {
    if (IsWholeRow(*table, f)) whole.push_back(f);
  }
  if (static_cast<double>(rows - whole.size()) > kMostDamaged * static_cast<double>(rows)) return std::nullopt;
  std::size_t constant = 0;
  for (std::size_t c = 0; c < columns; ++c) {
    const auto still = [&](std::size_t f) {
      return std::abs(table->rotation_rad[f * columns + c] - table->rotation_rad[whole[0] * columns + c]) <= kStill;
    };
    constant += std::all_of(whole.begin(), whole.end(), still) ? 1 : 0;
  }
  if (static_cast<double>(constant) < kFewestConstant * static_cast<double>(columns)) return std::nullopt;
  RawClip clip;
  clip.format = "expmap_table";
  clip.frames = table->frames;
  clip.joints = table->joints;
  clip.layout_evidence = std::to_string(3 + columns) + " columns: place of the root and " +
                         std::to_string(table->joints) + " rotation vectors, " + std::to_string(constant) +
                         " numbers of them constant";
  clip.skeleton.evidence = "rotations; the tree is not in the file";
  clip.silence = "rotations of a skeleton that is not in the file";
  clip.rate_evidence = "the file does not declare it";
  clip.missing_share = static_cast<double>(rows - whole.size()) / static_cast<double>(rows);
  clip.AddRemarks(table->findings);
  const auto reported = [&](std::size_t f) {
    return std::any_of(table->findings.begin(), table->findings.end(), [&](const Finding& finding) {
      return finding.frame_begin <= static_cast<int>(f) && static_cast<int>(f) < finding.frame_end;
    });
  };
  for (std::size_t f = 0; f < rows; ++f) {
    if (!std::binary_search(whole.begin(), whole.end(), f) && !reported(f)) clip.remarks.push_back(TooLarge(f));
  }
  return clip;
}

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
