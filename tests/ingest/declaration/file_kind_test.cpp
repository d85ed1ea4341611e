#include "ingest/inspect/file_kind.h"

#include <gtest/gtest.h>

#include <string>

namespace mocurate {
namespace {

/// Only the first bytes of a file are read; a word cut at their end must not change the kind.
TEST(FileKind, RecognisesATableOfWideRowsWhenItsFirstBytesEndWithinARow) {
  for (int columns = 90; columns < 110; ++columns) {
    for (const std::string number : {"1,2345;", "-1.234 ", "1,2E-05;"}) {
      std::string row = std::string(static_cast<std::size_t>(1 + columns % 5), '1') + number.back();
      for (int i = 0; i < columns; ++i) row += number;
      row.back() = '\n';
      std::string table;
      for (int r = 0; r < 20; ++r) table += row;
      EXPECT_EQ(KindOf(table), FileKind::kNumbers) << columns << " times " << number;
    }
  }
}

TEST(FileKind, RecognisesATableOfOneVeryLongRow) {
  std::string row;
  for (int i = 0; i < 3000; ++i) row += "1.5e-05 ";
  EXPECT_EQ(KindOf(row), FileKind::kNumbers);
}

}  // namespace
}  // namespace mocurate
