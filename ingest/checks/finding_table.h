#pragma once

#include <string>
#include <vector>

#include "ingest/checks/check_options.h"

namespace mocurate {

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

/// The two tables of docs/inspect.md.
std::string FindingTables();

}  // namespace mocurate
