#include "core/formats/pose_log.h"

#include <cmath>

#include "core/base/text.h"
#include "core/formats/json_place.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

using Token = NumberScanner::Token;

constexpr double kMostIndex = 2e9;

/// One line of `count` numbers; empty lines are skipped. False at the end of the file.
Expected<bool> NextRow(NumberScanner& scanner, std::size_t count, const std::string& name, std::vector<double>& row) {
  row.clear();
  Token token = scanner.Next();
  while (token == Token::kLineEnd) token = scanner.Next();
  if (token == Token::kEnd) return false;
  const std::string where = name + ":" + std::to_string(scanner.line());
  for (; token == Token::kNumber; token = scanner.Next()) row.push_back(scanner.value());
  if (token != Token::kEnd && token != Token::kLineEnd) {
    return Fail(ErrorCode::kMalformed, "a finite number is expected", where);
  }
  if (row.size() == count) return true;
  return Fail(ErrorCode::kMalformed, std::to_string(count) + " numbers are expected, not " + std::to_string(row.size()),
              where);
}

}  // namespace

Expected<std::vector<LogPose>> ParsePoseLog(std::string_view bytes, const std::string& name) {
  NumberScanner scanner(bytes, false);
  std::vector<LogPose> poses;
  std::vector<double> row;
  for (;;) {
    const Expected<bool> head = NextRow(scanner, 3, name, row);
    if (!head) return Forward(head);
    if (!*head) break;
    const std::string where = name + ":" + std::to_string(scanner.line() - 1);
    for (const double index : row) {
      if (index != std::floor(index) || std::abs(index) > kMostIndex) {
        return Fail(ErrorCode::kMalformed, FormatDouble(index) + " is no whole number", where);
      }
    }
    LogPose pose;
    pose.first = static_cast<int>(row[0]), pose.second = static_cast<int>(row[1]),
    pose.frame = static_cast<int>(row[2]);
    for (int r = 0; r < 4; ++r) {
      const Expected<bool> line = NextRow(scanner, 4, name, row);
      if (!line) return Forward(line);
      if (!*line) return Fail(ErrorCode::kMalformed, "the matrix has no 4 rows", where, "is the file cut off?");
      if (r == 3) {
        if (row != std::vector<double>{0, 0, 0, 1}) {
          return Fail(ErrorCode::kMalformed, "the last row of a rigid transform is 0 0 0 1", where);
        }
        break;
      }
      pose.rotation.row(r) << row[0], row[1], row[2];
      pose.translation[r] = row[3];
    }
    if (const std::string fault = RotationFault(pose.rotation, 1e-3); !fault.empty()) {
      return Fail(ErrorCode::kInconsistent, fault, where);
    }
    poses.push_back(pose);
  }
  if (poses.empty()) return Fail(ErrorCode::kMalformed, "the file holds no poses", name, "is the file empty?");
  return poses;
}

std::string WritePoseLog(const std::vector<LogPose>& poses) {
  std::string text;
  for (const LogPose& pose : poses) {
    text += std::to_string(pose.first) + " " + std::to_string(pose.second) + " " + std::to_string(pose.frame) + "\n";
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) text += FormatDouble(pose.rotation(r, c)) + " ";
      text += FormatDouble(pose.translation[r]) + "\n";
    }
    text += "0 0 0 1\n";
  }
  return text;
}

}  // namespace mocurate
