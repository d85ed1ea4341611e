#pragma once

#include <string>
#include <vector>

#include "ingest/checks/check_options.h"

namespace mocurate {

/// One kind of finding that `inspect` and the stage `ingest` report.
struct FindingKind {
  const char* code;
  const char* severity;  ///< "warning", or what it depends on
  const char* help;      ///< what it means; `value` where that is not plain
  /// Of what FindDefects and the stage `duplicates` look for, whose `ingest.source.checks` says limits and actions: the
  /// option that is the limit, or empty.
  bool check = false;
  const char* limit = "";
  const char* source = "";  ///< of the limit: what it was measured on
  OnFinding by_default = OnFinding::kReport;
};

/// Every kind, in the order of docs/inspect.md, whose tables are made from it.
const std::vector<FindingKind>& FindingKinds();

/// Null for a code that is none.
const FindingKind* FindFindingKind(const std::string& code);

/// The two tables of docs/inspect.md.
std::string FindingTables();

}  // namespace mocurate
