#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// What is done about something that the checks found.
enum class OnFinding {
  kIgnore,        ///< not reported
  kReport,        ///< a finding
  kMissing,       ///< a finding, and the samples are taken as missing (tracks only)
  kDrop,          ///< the clip is excluded
  kDropRecorded,  ///< a clip of tracks is excluded; of given motion, which may stand still, it is a finding
};

/// Limits of the checks on every clip, and what becomes of what they find: in a configuration
/// `checks: {swapped_sides: {ratio: 0.3, action: missing}}`. Checks, limits and defaults are those of the table of
/// findings (checks/finding_table.h).
struct CheckOptions {
  std::map<std::string, OnFinding> actions;  ///< by code; where nothing is said, the table's
  std::map<std::string, double> limits;      ///< by "code.name", in the unit of the table; else the table's

  void Declare(OptionVisitor& v);

  /// As `actions` says, else as the table.
  OnFinding ActionFor(const std::string& code) const;
  /// Whether every check is ignored: then none is made, and the body is not compared with the declaration.
  bool IgnoresAll() const;
  void IgnoreAll();
  /// A limit of a check. Throws std::logic_error where the table has none of that name.
  double Limit(const std::string& code, const std::string& name) const;
  /// The first limit of a check; 0 where it has none.
  double Threshold(const std::string& code) const;
};

/// Codes of the checks, in the order of the table.
const std::vector<std::string>& CheckCodes();

/// A limit of a check.
struct CheckLimit {
  const char* name;
  double value;  ///< in `unit`, where nothing else is said
  Unit unit;
  Range range;
  const char* help;
  const char* source = "";  ///< what it was measured on
  bool whole = false;       ///< a count
};

/// What a check looks at, which decides what may be done about what it finds.
enum class Checked {
  kNothing,  ///< no check of ingest.source.checks
  kSamples,  ///< frames or a joint of a clip, which may be taken as missing
  kClip,     ///< a clip as a whole
  kClips,    ///< several clips: one of them may be dropped
};

/// One kind of finding that `inspect` and the stage `ingest` report.
struct FindingKind {
  const char* code;
  const char* severity;                 ///< "warning", or what it depends on
  const char* help;                     ///< what it means; `value` where that is not plain
  Checked check = Checked::kNothing;    ///< of what ingest.source.checks says limits and actions
  std::vector<CheckLimit> limits = {};  ///< the first is the one that `value` crossed
  OnFinding by_default = OnFinding::kReport;
};

/// Every kind, in the order of docs/inspect.md, whose tables are made from it.
const std::vector<FindingKind>& FindingKinds();

/// Null for a code that is none.
const FindingKind* FindFindingKind(const std::string& code);

}  // namespace mocurate
