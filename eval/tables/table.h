#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "eval/metrics/interval.h"

namespace mocurate {

/// A table of results: one row per method, one column per metric.
struct Table {
  struct Cell {
    std::optional<double> value;  ///< nothing: printed as a dash
    std::optional<std::array<double, 2>> interval;
    std::string interval_kind;        ///< a Name of IntervalKind or SampledKind
    std::vector<double> repetitions;  ///< of several repetitions
    bool marked = false;              ///< outside the published interval
  };
  struct Row {
    std::string name;
    std::vector<Cell> cells;  ///< one per column
    std::string source;       ///< of published numbers; empty: ours
    bool unconverged = false;
    bool given_pose = false;  ///< began with a real first pose: not ranked
  };
  std::string title;
  std::string first = "method";  ///< head of the rows' names
  std::vector<std::string> columns;
  std::vector<int> digits;  ///< decimals per column
  std::vector<Row> rows;
  std::vector<std::string> notes;
};

/// Texts of the heading and of the rows: name and source, then "0.923 ± 0.002" for each column.
std::vector<std::vector<std::string>> CellTexts(const Table& table);
/// Lines below a table: the meanings of ±, †, ‡ and §, then the notes.
std::vector<std::string> LinesBelow(const Table& table);
/// "0.923 ± 0.002" per cell, † after a marked value, ‡ after the name of an unconverged row, § after one that was given
/// real first poses; published rows follow ours under their own heading. Below are the meanings of ±, then the notes.
/// Names and notes are plain text: markup characters are escaped.
std::string ToMarkdown(const Table& table);
/// Long form: method, metric, value, interval and its kind, the three intervals of the papers' codes from the
/// repetitions, their number, source.
std::string ToCsv(const Table& table);
/// A tabular for the package booktabs and, below it, the notes.
std::string ToLatex(const Table& table);

}  // namespace mocurate
