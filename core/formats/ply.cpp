#include "core/formats/point_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

using Token = NumberScanner::Token;

constexpr std::size_t kMaxItems = 2'000'000'000;

std::optional<ElementType> TypeFromName(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, ElementType>, 16> kTypes = {{
      {"char", kInt8},
      {"int8", kInt8},
      {"uchar", kUint8},
      {"uint8", kUint8},
      {"short", kInt16},
      {"int16", kInt16},
      {"ushort", kUint16},
      {"uint16", kUint16},
      {"int", kInt32},
      {"int32", kInt32},
      {"uint", kUint32},
      {"uint32", kUint32},
      {"float", kFloat32},
      {"float32", kFloat32},
      {"double", kFloat64},
      {"float64", kFloat64},
  }};
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

/// The parser: header by lines, then items in order.
class PlyParser {
 public:
  PlyParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Expected<Ply> Parse() {
    if (bytes_.empty()) return EmptyFile(name_);
    if (Status header = Header(); !header) return Forward(header);
    if (Status sizes = CheckSizes(); !sizes) return Forward(sizes);
    Status body = ply_.encoding == Ply::Encoding::kAscii ? Ascii() : Binary();
    if (!body) return Forward(body);
    return std::move(ply_);
  }

 private:
  tl::unexpected<Error> BadLine(const std::string& rule) const {
    return Fail(ErrorCode::kMalformed, rule, name_ + ":" + std::to_string(line_),
                "correct the line, or export the file again");
  }
  tl::unexpected<Error> BadItem(const PlyElement& element, std::size_t item, const PlyProperty& property,
                                const std::string& rule,
                                const std::string& hint = "correct the number, or export the file again") const {
    std::string where = name_ + ":";
    if (ply_.encoding == Ply::Encoding::kAscii) where += std::to_string(line_) + ":";
    return Fail(ErrorCode::kMalformed, rule, where + element.name + " " + std::to_string(item) + "/" + property.name,
                hint);
  }

  /// The next header line without its end; false at the end of the file.
  bool NextLine(std::string_view& line) {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) return false;
    line = bytes_.substr(at_, end - at_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at_ = end + 1;
    ++line_;
    return true;
  }

  Status Header() {
    std::string_view line;
    if (!NextLine(line) || line != "ply") return Fail(ErrorCode::kMalformed, "a PLY file begins with 'ply'", name_);
    bool has_format = false;
    while (NextLine(line)) {
      const std::vector<std::string_view> words = SplitBlanks(line);
      if (words.empty()) continue;
      if (words[0] == "end_header") return has_format ? Status() : BadLine("the header has no line 'format'");
      Status read;
      if (words[0] == "format") {
        read = Format(words);
        has_format = true;
      } else if (!has_format && (words[0] == "element" || words[0] == "property")) {
        return BadLine("'format' comes before elements and their properties");
      } else if (words[0] == "element") {
        read = Element(words);
      } else if (words[0] == "property") {
        read = Property(words);
      } else if (words[0] != "comment" && words[0] != "obj_info") {
        return BadLine("'" + Shown(words[0]) + "' is not a keyword of a PLY header");
      }
      if (!read) return read;
    }
    return Fail(ErrorCode::kMalformed, "the header has no end ('end_header')", name_, "is the file cut off?");
  }

  Status Format(const std::vector<std::string_view>& words) {
    if (words.size() != 3 || words[2] != "1.0") return BadLine("'format ENCODING 1.0' is expected");
    if (words[1] == "ascii") {
      ply_.encoding = Ply::Encoding::kAscii;
    } else if (words[1] == "binary_little_endian") {
      ply_.encoding = Ply::Encoding::kBinaryLittleEndian;
    } else if (words[1] == "binary_big_endian") {
      ply_.encoding = Ply::Encoding::kBinaryBigEndian;
    } else {
      return BadLine("the format '" + Shown(words[1]) + "' is not ascii, binary_little_endian or binary_big_endian");
    }
    return {};
  }

  Status Element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return BadLine("'element NAME COUNT' is expected");
    const std::optional<long long> count = ParseInteger(words[2]);
    if (!count || *count < 0 || static_cast<std::size_t>(*count) > kMaxItems) {
      return BadLine("'" + Shown(words[2]) + "' is not a count of elements");
    }
    if (!elements_.insert(words[1]).second) return BadLine("the element '" + Shown(words[1]) + "' appears twice");
    PlyElement element;
    element.name = std::string(words[1]);
    element.count = static_cast<std::size_t>(*count);
    ply_.elements.push_back(std::move(element));
    properties_.clear();
    return {};
  }

  Status Property(const std::vector<std::string_view>& words) {
    const bool list = words.size() > 1 && words[1] == "list";
    if (words.size() != (list ? 5U : 3U)) {
      return BadLine("'property TYPE NAME' or 'property list TYPE TYPE NAME' is expected");
    }
    if (ply_.elements.empty()) return BadLine("a property comes before any element");
    PlyProperty property;
    property.name = std::string(words.back());
    if (!properties_.insert(words.back()).second) {
      return BadLine("the property '" + Shown(property.name) + "' appears twice");
    }
    for (std::size_t i = list ? 2 : 1; i + 1 < words.size(); ++i) {
      std::optional<ElementType> type = TypeFromName(words[i]);
      if (!type) return BadLine("'" + Shown(words[i]) + "' is not a type of a property");
      type->big_endian = ply_.encoding == Ply::Encoding::kBinaryBigEndian;
      if (list && i == 2) {
        if (!type->is_integer()) return BadLine("the count of a list must be a whole number");
        property.list_count = type;
      } else {
        property.type = *type;
      }
    }
    ply_.elements.back().properties.push_back(std::move(property));
    return {};
  }

  /// Bytes that an item takes at least.
  std::size_t SmallestItem(const PlyElement& element) const {
    std::size_t smallest = 0;
    for (const PlyProperty& property : element.properties) {
      const std::size_t binary = property.list_count.value_or(property.type).bytes;
      smallest += ply_.encoding == Ply::Encoding::kAscii ? 1 : binary;
    }
    return smallest;
  }

  static bool HasList(const PlyElement& element) {
    return std::any_of(element.properties.begin(), element.properties.end(),
                       [](const PlyProperty& property) { return property.list_count.has_value(); });
  }

  /// Nothing is reserved that the bytes left could not hold.
  Status CheckSizes() {
    std::size_t left = bytes_.size() - at_;
    for (PlyElement& element : ply_.elements) {
      const std::size_t smallest = SmallestItem(element);
      if (smallest > 0 && element.count > left / smallest + (ply_.encoding == Ply::Encoding::kAscii ? 1 : 0)) {
        const bool counted =
            ply_.encoding != Ply::Encoding::kAscii && !HasList(element) && &element == &ply_.elements.back();
        return Contradiction(element, left / smallest, name_ + ":" + std::to_string(line_), !counted);
      }
      left -= std::min(left, smallest * element.count);
      for (PlyProperty& property : element.properties) {
        property.values.reserve(element.count);
        if (property.list_count) property.first.assign(1, 0);
      }
    }
    return {};
  }

  tl::unexpected<Error> Contradiction(const PlyElement& element, std::size_t found, const std::string& where,
                                      bool at_most = false) const {
    return CountContradiction("element " + element.name, static_cast<double>(element.count), static_cast<double>(found),
                              where, at_most);
  }

  static bool IsCoordinate(const PlyElement& element, const PlyProperty& property) {
    return element.name == "vertex" && (property.name == "x" || property.name == "y" || property.name == "z");
  }

  Status Put(const PlyElement& element, std::size_t item, PlyProperty& property, double value) {
    if (const std::string fault = NumberFault(value, property.type); !fault.empty()) {
      return BadItem(element, item, property, FormatDouble(value) + " " + fault);
    }
    if (std::abs(value) > kLargestCoordinate && IsCoordinate(element, property)) {
      return BadItem(element, item, property, FormatDouble(value) + " is not a plausible coordinate of a scan",
                     kCoordinateHint);
    }
    property.values.push_back(RoundedTo(property.type, value));
    return {};
  }

  Status Binary() {
    for (PlyElement& element : ply_.elements) {
      for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
        for (PlyProperty& property : element.properties) {
          double count = 1.0;
          if (property.list_count) {
            if (!Load(*property.list_count, count)) return CutOff(element, i);
            if (count < 0.0) return BadItem(element, i, property, "a list of " + FormatDouble(count) + " values");
          }
          for (double k = 0.0; k < count; ++k) {
            double value = 0.0;
            if (!Load(property.type, value)) return CutOff(element, i);
            if (std::abs(value) <= kLargestCoordinate) {  // of its type, as it was read
              property.values.push_back(value);
            } else if (Status put = Put(element, i, property, value); !put) {
              return put;
            }
          }
          if (property.list_count) property.first.push_back(property.values.size());
        }
      }
    }
    const std::size_t left = bytes_.size() - at_;
    if (left == 0) return {};
    std::size_t smallest = 0;
    // The number of list items in the remaining bytes is unknown.
    if (!ply_.elements.empty() && !HasList(ply_.elements.back())) smallest = SmallestItem(ply_.elements.back());
    if (smallest > 0 && left >= smallest && ply_.elements.back().count > 0) {
      const PlyElement& last = ply_.elements.back();
      return Contradiction(last, last.count + left / smallest, name_);
    }
    return Fail(ErrorCode::kInconsistent, std::to_string(left) + " bytes are left over after the last element", name_,
                "the counts or types of the header are wrong");
  }

  bool Load(const ElementType& type, double& value) {
    if (bytes_.size() - at_ < type.bytes) return false;
    value = LoadNumber(bytes_.data() + at_, type);
    at_ += type.bytes;
    return true;
  }

  tl::unexpected<Error> CutOff(const PlyElement& element, std::size_t whole) const {
    return Contradiction(element, whole, name_ + ":" + element.name + " " + std::to_string(whole));
  }

  /// One item per line; blank lines are skipped.
  Status Ascii() {
    NumberScanner scanner(bytes_.substr(at_), false, line_ + 1);
    Token token = scanner.Next();
    const auto skip_blank_lines = [&] {
      while (token == Token::kLineEnd) token = scanner.Next();
      line_ = scanner.line();
    };
    for (PlyElement& element : ply_.elements) {
      for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
        skip_blank_lines();
        if (token == Token::kEnd) return Contradiction(element, i, name_ + ":" + std::to_string(line_));
        for (PlyProperty& property : element.properties) {
          double count = 1.0;
          for (double k = property.list_count ? -1.0 : 0.0; k < count; ++k) {
            if (token == Token::kEnd || token == Token::kLineEnd) {
              return BadItem(element, i, property, "the line has too few numbers");
            }
            if (token != Token::kNumber) {
              return BadItem(element, i, property, "'" + Shown(scanner.text()) + "' is not a finite number");
            }
            if (k < 0.0) {
              count = scanner.value();
              const std::string fault = NumberFault(count, *property.list_count);
              if (!fault.empty() || count < 0.0) {
                return BadItem(element, i, property, "a list of " + FormatDouble(count) + " values");
              }
            } else if (Status put = Put(element, i, property, scanner.value()); !put) {
              return put;
            }
            token = scanner.Next();
          }
          if (property.list_count) property.first.push_back(property.values.size());
        }
        if (token != Token::kEnd && token != Token::kLineEnd) {
          return BadItem(element, i, element.properties.back(),
                         "'" + Shown(scanner.text()) + "' is left over on the line");
        }
      }
    }
    skip_blank_lines();
    if (token == Token::kEnd) return {};
    if (ply_.elements.empty()) return BadLine("the line is not part of any element of the header");
    const std::string where = name_ + ":" + std::to_string(line_);
    std::size_t more = 1;
    for (; token != Token::kEnd; token = scanner.Next()) {
      if (token != Token::kLineEnd) continue;
      skip_blank_lines();
      if (token == Token::kEnd) break;
      ++more;
    }
    const PlyElement& last = ply_.elements.back();
    return Contradiction(last, last.count + more, where);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 0;
  Ply ply_;
  std::set<std::string_view> elements_, properties_;  ///< names; of the last element
};

}  // namespace

Expected<Ply> ParsePly(std::string_view bytes, const std::string& name) { return PlyParser(bytes, name).Parse(); }

const PlyProperty* PlyElement::Find(std::string_view property) const {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const PlyProperty& candidate) { return candidate.name == property; });
  return found == properties.end() ? nullptr : &*found;
}

const PlyElement* Ply::Find(std::string_view element) const {
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [&](const PlyElement& candidate) { return candidate.name == element; });
  return found == elements.end() ? nullptr : &*found;
}

Expected<std::vector<Vector3d>> PlyPoints(const Ply& ply, const std::string& name) {
  const PlyElement* vertex = ply.Find("vertex");
  if (vertex == nullptr) return Fail(ErrorCode::kMalformed, "the file has no element 'vertex'", name);
  std::array<const PlyProperty*, 3> axes{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis(1, "xyz"[a]);
    axes[a] = vertex->Find(axis);
    if (axes[a] == nullptr || axes[a]->list_count) {
      return Fail(ErrorCode::kMalformed, "the element 'vertex' has no property '" + axis + "'", name);
    }
  }
  std::vector<Vector3d> points(vertex->count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = Vector3d(axes[0]->values[i], axes[1]->values[i], axes[2]->values[i]);
  }
  return points;
}

Expected<std::vector<std::array<int, 3>>> PlyTriangles(const Ply& ply, const std::string& name) {
  std::vector<std::array<int, 3>> triangles;
  const PlyElement* face = ply.Find("face");
  if (face == nullptr || face->count == 0) return triangles;
  const PlyProperty* list = face->Find("vertex_indices");
  if (list == nullptr) list = face->Find("vertex_index");
  if (list == nullptr || !list->list_count || !list->type.is_integer()) {
    return Fail(ErrorCode::kMalformed, "the element 'face' has no list of whole numbers 'vertex_indices'", name);
  }
  const PlyElement* vertex = ply.Find("vertex");
  const double vertices = vertex == nullptr ? 0.0 : static_cast<double>(vertex->count);
  for (std::size_t i = 0; i < face->count; ++i) {
    const std::size_t begin = list->first[i];
    const std::size_t end = list->first[i + 1];
    const std::string where = name + ":face " + std::to_string(i) + "/" + list->name;
    if (end - begin < 3) return Fail(ErrorCode::kMalformed, "a face has at least 3 corners", where);
    for (std::size_t k = begin; k < end; ++k) {
      if (list->values[k] < 0.0 || list->values[k] >= vertices) {
        return Fail(
            ErrorCode::kInconsistent,
            "the file has no vertex " + FormatDouble(list->values[k]) + " (it has " + FormatDouble(vertices) + ")",
            where);
      }
    }
    for (std::size_t k = begin + 1; k + 1 < end; ++k) {
      triangles.push_back({static_cast<int>(list->values[begin]), static_cast<int>(list->values[k]),
                           static_cast<int>(list->values[k + 1])});
    }
  }
  return triangles;
}

}  // namespace mocurate
