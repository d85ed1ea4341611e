#include "core/formats/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

using Token = NumberScanner::Token;

constexpr std::uint32_t kColourMask = 0xFFFFFFU;
constexpr std::size_t kLongestLiteral = 32;  // of an LZF block
constexpr std::size_t kLongestCopy = 264;    // 2 + 7 + 255
constexpr std::size_t kShortestCopy = 3;     // bytes of the block that it takes

double ColourFromFloat(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits & kColourMask;
}

bool IsAxis(const PcdField& field) { return field.name == "x" || field.name == "y" || field.name == "z"; }

class PcdParser {
 public:
  PcdParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Expected<Pcd> Parse() {
    if (bytes_.empty()) return EmptyFile(name_);
    if (Status header = Header(); !header) return Forward(header);
    Status body = pcd_.encoding == Pcd::Encoding::kAscii ? Ascii() : Binary();
    if (!body) return Forward(body);
    // Where one coordinate is nan, none is read.
    for (PcdField& field : pcd_.fields) {
      if (!IsAxis(field)) continue;
      for (std::size_t i = 0; i < field.values.size(); ++i) {
        if (pcd_.missing[i / static_cast<std::size_t>(field.count)] != 0) field.values[i] = 0.0;
      }
    }
    return std::move(pcd_);
  }

 private:
  tl::unexpected<Error> BadLine(const std::string& rule) const {
    return Fail(ErrorCode::kMalformed, rule, name_ + ":" + std::to_string(line_),
                "correct the line, or export the file again");
  }

  Status Header() {
    constexpr std::string_view kOrder[] = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                           "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
    std::size_t next = 0;
    while (at_ < bytes_.size()) {
      const std::size_t end = bytes_.find('\n', at_);
      if (end == std::string_view::npos) break;
      std::string_view line = Trim(bytes_.substr(at_, end - at_));
      at_ = end + 1;
      ++line_;
      if (line.empty() || line[0] == '#') continue;
      const std::vector<std::string_view> words = SplitBlanks(line);
      // COUNT and VIEWPOINT are optional.
      if (words[0] != kOrder[next] && (kOrder[next] == "COUNT" || kOrder[next] == "VIEWPOINT")) ++next;
      if (words[0] != kOrder[next]) {
        return BadLine("'" + std::string(kOrder[next]) + "' is expected, not '" + Shown(words[0]) + "'");
      }
      if (Status read = HeaderLine(words); !read) return read;
      if (++next == std::size(kOrder)) return {};
    }
    return Fail(ErrorCode::kMalformed, "the header has no line '" + std::string(kOrder[next]) + "'", name_,
                "is this a PCD file, and is it complete?");
  }

  Status HeaderLine(const std::vector<std::string_view>& words) {
    const std::string_view key = words[0];
    if (key == "VERSION") {
      const bool known = words.size() == 2 && (words[1] == "0.7" || words[1] == ".7" || words[1] == "0.6");
      return known ? Status() : BadLine("only versions 0.7 and 0.6 are known");
    }
    if (key == "FIELDS") {
      std::set<std::string_view> names;
      for (std::size_t i = 1; i < words.size(); ++i) {
        PcdField field;
        field.name = std::string(words[i]);
        if (field.name != "_" && !names.insert(words[i]).second) {
          return BadLine("the field '" + Shown(field.name) + "' appears twice");
        }
        pcd_.fields.push_back(std::move(field));
      }
      return pcd_.fields.empty() ? BadLine("the file has no fields") : Status();
    }
    if (key == "SIZE" || key == "TYPE" || key == "COUNT") return PerField(words);
    if (key == "VIEWPOINT") {
      if (words.size() != 8) return BadLine("VIEWPOINT has 7 numbers");
      for (std::size_t i = 0; i < 7; ++i) {
        const std::optional<double> value = ParseDouble(words[i + 1]);
        if (!value || !std::isfinite(*value)) return BadLine("'" + Shown(words[i + 1]) + "' is not a number");
        pcd_.viewpoint[i] = *value;
      }
      return {};
    }
    if (words.size() != 2) return BadLine(std::string(key) + " has one value");
    if (key == "DATA") {
      constexpr std::string_view kEncodings[] = {"ascii", "binary", "binary_compressed"};
      const auto found = std::find(std::begin(kEncodings), std::end(kEncodings), words[1]);
      if (found == std::end(kEncodings)) return BadLine("DATA is ascii, binary or binary_compressed");
      pcd_.encoding = static_cast<Pcd::Encoding>(found - std::begin(kEncodings));
      return {};
    }
    const std::optional<long long> value = ParseInteger(words[1]);
    const long long min = key == "HEIGHT" ? 1 : 0;
    if (!value || *value < min || *value > std::numeric_limits<int>::max()) {
      return BadLine("'" + Shown(words[1]) + "' is not a count");
    }
    if (key == "WIDTH") pcd_.width = static_cast<int>(*value);
    if (key == "HEIGHT") pcd_.height = static_cast<int>(*value);
    if (key == "POINTS") points_line_ = line_;
    if (key == "POINTS" && *value != static_cast<long long>(pcd_.width) * pcd_.height) {
      return Fail(ErrorCode::kInconsistent, "POINTS is not WIDTH times HEIGHT", name_ + ":" + std::to_string(line_));
    }
    return {};
  }

  Status PerField(const std::vector<std::string_view>& words) {
    if (words.size() != pcd_.fields.size() + 1) {
      return BadLine(std::string(words[0]) + " needs one value for each of the " + std::to_string(pcd_.fields.size()) +
                     " fields");
    }
    if (words[0] == "SIZE") sizes_.clear();
    for (std::size_t i = 1; i < words.size(); ++i) {
      PcdField& field = pcd_.fields[i - 1];
      const std::optional<long long> number = ParseInteger(words[i]);
      if (words[0] == "SIZE") {
        if (!number || (*number != 1 && *number != 2 && *number != 4 && *number != 8)) {
          return BadLine("the size '" + Shown(words[i]) + "' is not 1, 2, 4 or 8");
        }
        sizes_.push_back(*number);
      } else if (words[0] == "COUNT") {
        if (!number || *number < 1 || *number > 100'000) return BadLine("'" + Shown(words[i]) + "' is not a count");
        field.count = static_cast<int>(*number);
      } else if (Status type = TypeOf(words[i], sizes_[i - 1], field); !type) {
        return type;
      }
    }
    return {};
  }

  Status TypeOf(std::string_view type, long long size, PcdField& field) const {
    if (type == "F" && (size == 4 || size == 8)) {
      field.type = size == 4 ? kFloat32 : kFloat64;
    } else if ((type == "I" || type == "U") && size == 8) {
      return Fail(ErrorCode::kUnsupported, "the field '" + field.name + "' has whole numbers of 8 bytes", name_);
    } else if (type == "I") {
      field.type = size == 1 ? kInt8 : size == 2 ? kInt16 : kInt32;
    } else if (type == "U") {
      field.type = size == 1 ? kUint8 : size == 2 ? kUint16 : kUint32;
    } else {
      return BadLine("the type '" + Shown(type) + "' of " + std::to_string(size) +
                     " bytes is not F (4, 8), I or U (1, 2, 4)");
    }
    return {};
  }

  std::size_t points() const { return static_cast<std::size_t>(pcd_.width) * static_cast<std::size_t>(pcd_.height); }
  std::size_t BytesPerPoint() const {
    std::size_t bytes = 0;
    for (const PcdField& field : pcd_.fields) bytes += field.type.bytes * static_cast<std::size_t>(field.count);
    return bytes;
  }

  std::size_t NumbersPerPoint() const {
    std::size_t numbers = 0;
    for (const PcdField& field : pcd_.fields) numbers += static_cast<std::size_t>(field.count);
    return numbers;
  }

  /// Takes a number over; empty: it is nan. Infinite ones are refused.
  Status Put(std::size_t point, PcdField& field, std::optional<double> value) {
    const auto where = [&] {
      const std::string line = pcd_.encoding == Pcd::Encoding::kAscii ? std::to_string(line_) + ":" : "";
      return name_ + ":" + line + "point " + std::to_string(point) + "/" + field.name;
    };
    if (!value) {
      if (field.type.is_integer()) return Fail(ErrorCode::kMalformed, "a whole number is nan", where());
      if (IsAxis(field)) pcd_.missing[point] = 1;
      field.values.push_back(0.0);
      return {};
    }
    if (const std::string fault = NumberFault(*value, field.type); !fault.empty()) {
      return Fail(ErrorCode::kMalformed, FormatDouble(*value) + " " + fault, where(), "correct the number");
    }
    if (IsAxis(field) && std::abs(*value) > kLargestCoordinate) {
      return Fail(ErrorCode::kMalformed, FormatDouble(*value) + " is not a plausible coordinate of a scan", where(),
                  kCoordinateHint);
    }
    field.values.push_back(field.PackedColour() ? ColourFromFloat(static_cast<float>(*value))
                                                : RoundedTo(field.type, *value));
    return {};
  }

  Status Ascii() {
    const std::size_t columns = NumbersPerPoint();
    if (const std::size_t most = (bytes_.size() - at_) / (2 * columns) + 1; points() > most)
      return Contradiction(most, true);
    pcd_.missing.assign(points(), 0);
    NumberScanner scanner(bytes_.substr(at_), false, line_ + 1);
    Token token = scanner.Next();
    for (std::size_t i = 0; i < points(); ++i) {
      while (token == Token::kLineEnd) token = scanner.Next();
      line_ = scanner.line();
      for (PcdField& field : pcd_.fields) {
        for (int k = 0; k < field.count; ++k, token = scanner.Next()) {
          if (token == Token::kEnd) return Contradiction(i);
          if (token == Token::kLineEnd) return BadLine("the line has too few numbers, '" + field.name + "' is missing");
          const bool nan = token == Token::kNotFinite && scanner.text().find_first_of("nN") < 2 &&
                           scanner.text().find_first_of("fF") == std::string_view::npos;
          if (token != Token::kNumber && !nan) {
            return BadLine("'" + Shown(scanner.text()) + "' is not a value for '" + field.name + "'");
          }
          if (Status put = Put(i, field, nan ? std::nullopt : std::optional(scanner.value())); !put) return put;
        }
      }
      if (token != Token::kEnd && token != Token::kLineEnd) {
        return BadLine("'" + Shown(scanner.text()) + "' is left over on the line");
      }
    }
    while (token == Token::kLineEnd) token = scanner.Next();
    line_ = scanner.line();
    if (token == Token::kEnd) return {};
    std::size_t found = points() + 1;
    for (bool line_ended = false; token != Token::kEnd; token = scanner.Next()) {
      if (token != Token::kLineEnd && line_ended) ++found;
      line_ended = token == Token::kLineEnd;
    }
    return Contradiction(found);
  }

  tl::unexpected<Error> Contradiction(std::size_t found, bool at_most = false) const {
    return CountContradiction("POINTS", static_cast<double>(points()), static_cast<double>(found),
                              name_ + ":" + std::to_string(points_line_), at_most);
  }

  Status Binary() {
    const std::size_t stride = BytesPerPoint();
    std::string_view data = bytes_.substr(at_);
    std::string unpacked;
    const bool by_field = pcd_.encoding == Pcd::Encoding::kBinaryCompressed;
    if (by_field) {
      if (data.size() < 8) return Contradiction(0);
      const auto packed = static_cast<std::size_t>(LoadNumber(data.data(), kUint32));
      const auto size = static_cast<std::size_t>(LoadNumber(data.data() + 4, kUint32));
      data.remove_prefix(8);
      if (packed != data.size() || size / stride != points() || size % stride != 0) {
        return Fail(ErrorCode::kInconsistent, "the sizes of the compressed block do not fit the header", name_,
                    "is the file cut off?");
      }
      if (const std::uint64_t most = MostUnpacked(bytes_.size());
          size > most || points() > most / 8 / NumbersPerPoint()) {
        return Fail(ErrorCode::kMalformed,
                    "the compressed block unpacks to " + std::to_string(size) + " bytes in " +
                        std::to_string(points()) + " points, which take more than the " + std::to_string(most) +
                        " bytes that a file of this size may",
                    name_ + ":" + std::to_string(points_line_), "remove the points that are not measured");
      }
      std::optional<std::string> block = UnpackLzf(data, size);
      if (!block) return Fail(ErrorCode::kMalformed, "the compressed block is damaged", name_);
      unpacked = std::move(*block);
      data = unpacked;
    }
    if (data.size() / stride != points()) return Contradiction(data.size() / stride);
    if (data.size() % stride != 0) {
      return Fail(ErrorCode::kInconsistent,
                  std::to_string(data.size() % stride) + " bytes are left over after the last point", name_);
    }
    pcd_.missing.assign(points(), 0);
    std::size_t begin = 0;  // of the field, in the point or in the file
    for (PcdField& field : pcd_.fields) {
      const std::size_t size = field.type.bytes;
      const std::size_t own = size * static_cast<std::size_t>(field.count);
      for (std::size_t i = 0; i < points(); ++i) {
        for (int k = 0; k < field.count; ++k) {
          const std::size_t at = begin + i * (by_field ? own : stride) + static_cast<std::size_t>(k) * size;
          if (Status put = PutBinary(i, field, data.data() + at); !put) return put;
        }
      }
      begin += by_field ? own * points() : own;
    }
    return {};
  }

  Status PutBinary(std::size_t point, PcdField& field, const char* bytes) {
    if (field.PackedColour()) {
      // The bits are the colour; as a float they may be nan.
      const double bits = LoadNumber(bytes, kUint32);
      field.values.push_back(static_cast<std::uint32_t>(bits) & kColourMask);
      return {};
    }
    const double value = LoadNumber(bytes, field.type);
    return Put(point, field, std::isnan(value) ? std::nullopt : std::optional(value));
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 0;
  int points_line_ = 0;
  std::vector<long long> sizes_;
  Pcd pcd_;
};

}  // namespace

const PcdField* Pcd::Find(std::string_view field) const {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const PcdField& candidate) { return candidate.name == field; });
  return found == fields.end() ? nullptr : &*found;
}

std::optional<std::string> UnpackLzf(std::string_view block, std::size_t size) {
  if (size / kLongestCopy > block.size() / kShortestCopy) return std::nullopt;
  std::string bytes;
  bytes.reserve(size);
  std::size_t at = 0;
  const auto next = [&](std::size_t& value) {
    if (at == block.size()) return false;
    value = static_cast<unsigned char>(block[at++]);
    return true;
  };
  for (std::size_t control = 0; next(control);) {
    if (control < kLongestLiteral) {
      const std::size_t length = control + 1;
      if (block.size() - at < length || size - bytes.size() < length) return std::nullopt;
      bytes.append(block.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5;
    std::size_t extra = 0;
    if (length == 7 && !next(extra)) return std::nullopt;
    length += extra + 2;
    std::size_t low = 0;
    if (!next(low)) return std::nullopt;
    const std::size_t back = ((control & 0x1F) << 8) + low + 1;
    if (back > bytes.size() || size - bytes.size() < length) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) bytes += bytes[bytes.size() - back];
  }
  if (bytes.size() != size) return std::nullopt;
  return bytes;
}

Expected<Pcd> ParsePcd(std::string_view bytes, const std::string& name) { return PcdParser(bytes, name).Parse(); }

Expected<std::vector<Vector3d>> PcdPoints(const Pcd& pcd, const std::string& name) {
  const PcdField* axes[] = {pcd.Find("x"), pcd.Find("y"), pcd.Find("z")};
  for (const PcdField* axis : axes) {
    if (axis == nullptr || axis->count != 1) {
      return Fail(ErrorCode::kMalformed, "the cloud has no fields x, y and z of one number each", name);
    }
  }
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < pcd.point_count(); ++i) {
    if (pcd.missing[i] != 0) continue;
    points.emplace_back(axes[0]->values[i], axes[1]->values[i], axes[2]->values[i]);
  }
  return points;
}

}  // namespace mocurate
