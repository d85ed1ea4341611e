#pragma once

#include <string>
#include <vector>

#include "eval/metrics/interval.h"

namespace mocurate {

/// A table of results as papers print them: one row per method, one column per metric.
struct Table {
  struct Cell {
    std::vector<double> values;  ///< one per repetition; empty prints a dash
  };
  struct Row {
    std::string name;
    std::vector<Cell> cells;  ///< one per column
  };
  std::string title;
  std::vector<std::string> columns;
  std::vector<int> digits;  ///< decimals per column
  std::vector<Row> rows;
  std::vector<std::string> notes;
};

/// "0.923 ± 0.002" per cell; the notes say what stands behind the ±. Names and notes are plain text: what a format
/// takes for markup is escaped.
std::string ToMarkdown(const Table& table, IntervalKind interval);
/// Long form: method, metric, mean, the three intervals, repetitions.
std::string ToCsv(const Table& table);
/// A tabular and, below it, the notes. Needs no package.
std::string ToLatex(const Table& table, IntervalKind interval);

}  // namespace mocurate
