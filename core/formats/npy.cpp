#include "core/formats/npy.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/base/text.h"
#include "core/formats/array_elements.h"
#include "core/formats/file_rules.h"
#include "core/formats/pickle.h"

namespace mocurate {
namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";
constexpr std::size_t kMaxDimensions = 32;

struct Header {
  std::string dtype;
  bool fortran = false;
  std::vector<std::size_t> shape;
};

/// Reads the Python dictionary literal of the header: exactly the three keys that numpy writes, in any order.
class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  Expected<Header> Read() {
    Header header;
    bool has_descr = false, has_order = false, has_shape = false;
    if (!Take('{')) return Bad("'{'");
    while (!Take('}')) {
      const std::optional<std::string> key = Quoted();
      if (!key || !Take(':')) return Bad("a quoted key");
      if (*key == "descr") {
        if (Peek() == '[') {
          return Fail(ErrorCode::kUnsupported, "the array holds records, not plain numbers", name_,
                      "save the field with the positions as an array of its own");
        }
        const std::optional<std::string> dtype = Quoted();
        if (!dtype) return Bad("the type in quotes");
        header.dtype = *dtype;
        has_descr = true;
      } else if (*key == "fortran_order") {
        if (!Word("True") && !Word("False")) return Bad("True or False");
        header.fortran = last_word_ == "True";
        has_order = true;
      } else if (*key == "shape") {
        if (!Shape(header.shape)) return Bad("the shape in parentheses");
        has_shape = true;
      } else {
        return Bad("descr, fortran_order or shape");
      }
      Take(',');
    }
    if (!has_descr || !has_order || !has_shape) return Bad("descr, fortran_order and shape");
    return header;
  }

 private:
  tl::unexpected<Error> Bad(const std::string& wanted) const {
    return Fail(ErrorCode::kMalformed, "the npy header does not have " + wanted,
                name_ + ":byte " + std::to_string(at_));
  }
  void SkipBlanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t')) ++at_;
  }
  char Peek() {
    SkipBlanks();
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool Take(char wanted) {
    if (Peek() != wanted || at_ >= text_.size()) return false;
    ++at_;
    return true;
  }
  bool Word(std::string_view wanted) {
    SkipBlanks();
    if (text_.substr(at_, wanted.size()) != wanted) return false;
    at_ += wanted.size();
    last_word_ = wanted;
    return true;
  }
  std::optional<std::string> Quoted() {
    const char quote = Peek();
    if (quote != '\'' && quote != '"') return std::nullopt;
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) return std::nullopt;
    std::string word(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return word;
  }
  bool Shape(std::vector<std::size_t>& shape) {
    if (!Take('(')) return false;
    while (!Take(')')) {
      const std::size_t begin = (SkipBlanks(), at_);
      while (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') ++at_;
      const std::optional<long long> extent = ParseInteger(text_.substr(begin, at_ - begin));
      if (!extent || shape.size() == kMaxDimensions) return false;
      shape.push_back(static_cast<std::size_t>(*extent));
      if (!Take(',') && Peek() != ')') return false;
    }
    return true;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::string_view last_word_;
};

/// The header, and the bytes behind it.
struct Parts {
  Header header;
  std::string_view data;
};

tl::unexpected<Error> CutHeader(std::string_view bytes, const std::string& name) {
  return Fail(ErrorCode::kMalformed,
              "the header is cut off: the file ends after " + Counted(static_cast<long long>(bytes.size()), "byte"),
              name, "copy the file again");
}

Expected<Parts> Split(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) return EmptyFile(name);
  const bool begins = bytes.substr(0, kNpyMagic.size()) == kNpyMagic.substr(0, bytes.size());
  if (!begins) {
    return Fail(ErrorCode::kMalformed, "the file does not begin with the magic bytes of a .npy file", name,
                "write the array with numpy.save, or remove the file from the folder");
  }
  if (bytes.size() < 10) return CutHeader(bytes, name);
  const int version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3) {
    return Fail(ErrorCode::kUnsupported, "npy format version " + std::to_string(version), name, "known are 1, 2 and 3");
  }
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  if (bytes.size() < 8 + length_bytes) return CutHeader(bytes, name);
  std::size_t length = 0;
  for (std::size_t i = 0; i < length_bytes; ++i) {
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[8 + i])) << (8 * i);
  }
  const std::size_t begin = 8 + length_bytes;
  if (length > bytes.size() - begin) return CutHeader(bytes, name);
  Expected<Header> header = HeaderReader(bytes.substr(begin, length), name).Read();
  if (!header) return Forward(header);
  return Parts{std::move(*header), bytes.substr(begin + length)};
}

/// Brings elements from Fortran to C order.
template <class T>
void Reorder(const std::vector<std::size_t>& shape, std::vector<T>& elements) {
  const std::vector<std::size_t> positions = FortranPositions(shape, elements.size());
  std::vector<T> ordered;
  ordered.reserve(elements.size());
  for (const std::size_t position : positions) ordered.push_back(std::move(elements[position]));
  elements = std::move(ordered);
}

Expected<NpyArray> ParseParts(const Parts& parts, const std::string& name) {
  const Header& header = parts.header;
  const std::optional<ElementType> type = ParseElementType(header.dtype);
  if (!type || type->kind == ElementKind::kObject) {
    if (type) {
      if (auto foreign = ForeignClassIn(parts.data, name)) return tl::unexpected<Error>(*std::move(foreign));
      return Fail(ErrorCode::kUnsupported,
                  "arrays of type '" + header.dtype +
                      "' are not read: it holds Python objects, such as arrays of "
                      "different lengths",
                  name, "save each of its arrays on its own, e.g. all of them with numpy.savez");
    }
    return Fail(ErrorCode::kUnsupported, "arrays of type '" + header.dtype + "' are not read", name,
                "save it as numbers (bool, int, uint, float16 to float64) or texts");
  }
  const std::string_view data = parts.data;
  const std::optional<std::size_t> count = ElementCount(header.shape, type->bytes, data.size());
  if (!count) {
    double announced = 1.0;
    for (const std::size_t extent : header.shape) announced *= static_cast<double>(extent);
    const double stored = static_cast<double>(data.size()) / static_cast<double>(std::max<std::size_t>(1, type->bytes));
    const double found = std::floor(stored) == announced ? stored : std::floor(stored);
    return CountContradiction("shape " + ShapeText(header.shape), announced, found, name);
  }
  NpyArray array;
  array.shape = header.shape;
  array.dtype = header.dtype;
  if (type->is_number()) {
    DecodeNumbers(*type, data, array.values);
    if (header.fortran) Reorder(array.shape, array.values);
    return array;
  }
  std::optional<std::vector<std::string>> texts = DecodeTexts(*type, data);
  if (!texts) return Fail(ErrorCode::kMalformed, "a text holds a character that is not valid Unicode", name);
  array.texts = std::move(*texts);
  if (type->bytes == 0) array.texts.resize(*count);
  if (header.fortran) Reorder(array.shape, array.texts);
  return array;
}

}  // namespace

Expected<NpyArray> ParseNpyHeader(std::string_view bytes, const std::string& name) {
  Expected<Parts> parts = Split(bytes, name);
  if (!parts) return Forward(parts);
  NpyArray array;
  array.shape = std::move(parts->header.shape);
  array.dtype = std::move(parts->header.dtype);
  return array;
}

Expected<NpyArray> ParseNpy(std::string_view bytes, const std::string& name) {
  const Expected<Parts> parts = Split(bytes, name);
  if (!parts) return Forward(parts);
  return ParseParts(*parts, name);
}

Expected<std::string_view> PickleOfNpy(std::string_view bytes, const std::string& name) {
  const Expected<Parts> parts = Split(bytes, name);
  if (!parts) return Forward(parts);
  const std::optional<ElementType> type = ParseElementType(parts->header.dtype);
  if (type && type->kind == ElementKind::kObject) return parts->data;
  return Fail(ErrorCode::kInconsistent, "the array is of type '" + parts->header.dtype + "', not of objects", name);
}

Expected<NpyArray> ParseNpyEntry(std::string_view bytes, std::size_t entry, const std::string& name) {
  Expected<Parts> parts = Split(bytes, name);
  if (!parts) return Forward(parts);
  std::vector<std::size_t>& shape = parts->header.shape;
  if (shape.empty() || entry >= shape[0]) {
    return Fail(ErrorCode::kInconsistent,
                "entry " + std::to_string(entry) + " is asked for, the array has shape " + ShapeText(shape), name);
  }
  if (parts->header.fortran) {  // an entry lies all over the file
    Expected<NpyArray> whole = ParseParts(*parts, name);
    if (!whole) return whole;
    const auto cut = [&](auto& elements) {
      const auto each = static_cast<std::ptrdiff_t>(elements.size() / shape[0]);
      elements.erase(elements.begin() + each * static_cast<std::ptrdiff_t>(entry + 1), elements.end());
      elements.erase(elements.begin(), elements.begin() + each * static_cast<std::ptrdiff_t>(entry));
    };
    cut(whole->values);
    cut(whole->texts);
    whole->shape.erase(whole->shape.begin());
    return whole;
  }
  const std::optional<ElementType> type = ParseElementType(parts->header.dtype);
  // Contradictions are reported for the whole array.
  if (!type || type->kind == ElementKind::kObject || !ElementCount(shape, type->bytes, parts->data.size())) {
    return ParseParts(*parts, name);
  }
  const std::size_t each = parts->data.size() / shape[0];
  parts->data = parts->data.substr(entry * each, each);
  shape.erase(shape.begin());
  return ParseParts(*parts, name);
}

Expected<std::string> EncodeNpy(const NpyArray& array, const std::string& name) {
  const std::optional<ElementType> type = ParseElementType(array.dtype);
  if (!type || type->kind == ElementKind::kObject) {
    return Fail(ErrorCode::kUnsupported, "arrays of type '" + array.dtype + "' are not written", name);
  }
  std::size_t count = 1;
  for (const std::size_t extent : array.shape) count *= extent;
  if (count != (type->is_number() ? array.values.size() : array.texts.size())) {
    return Fail(ErrorCode::kInconsistent,
                "the shape " + ShapeText(array.shape) + " does not fit " + std::to_string(array.size()) + " elements",
                name);
  }
  std::string header =
      "{'descr': '" + array.dtype + "', 'fortran_order': False, 'shape': " + ShapeText(array.shape) + ", }";
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes(kNpyMagic);
  bytes += '\x01';
  bytes += '\0';
  bytes += static_cast<char>(header.size() & 0xFF);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  const Status encoded = type->is_number() ? EncodeNumbers(*type, array.values, name, bytes)
                                           : EncodeTexts(*type, array.texts, name, bytes);
  if (!encoded) return Forward(encoded);
  return bytes;
}

std::string WriteNpy(const NpyArray& array) {
  NpyArray plain = array;
  if (plain.dtype != "<f4") plain.dtype = "<f8";
  Expected<std::string> bytes = EncodeNpy(plain, "array");
  if (!bytes) throw std::logic_error(bytes.error().Message());
  return std::move(*bytes);
}

}  // namespace mocurate
