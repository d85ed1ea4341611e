#include "core/formats/npy.h"

#include <cstdint>
#include <cstring>
#include <optional>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
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
    return Fail(ErrorCode::kMalformed, "the npy header lacks " + wanted, name_ + ":byte " + std::to_string(at_));
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

template <class T>
double Element(const char* bytes, bool swap) {
  char raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return static_cast<double>(value);
}

using Reader = double (*)(const char*, bool);

Reader ReaderOf(std::string_view type) {
  if (type == "f4") return Element<float>;
  if (type == "f8") return Element<double>;
  if (type == "i4") return Element<std::int32_t>;
  if (type == "i8") return Element<std::int64_t>;
  return nullptr;
}

/// Position in C order of the element that stands at `position` in Fortran order.
std::size_t FromFortran(std::size_t position, const std::vector<std::size_t>& shape) {
  std::size_t stride = 1;
  for (const std::size_t extent : shape) stride *= extent;
  std::size_t target = 0;
  for (const std::size_t extent : shape) {
    stride /= extent;
    target += (position % extent) * stride;
    position /= extent;
  }
  return target;
}

}  // namespace

Expected<NpyArray> ParseNpy(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) return Fail(ErrorCode::kMalformed, "the file is empty", name);
  if (bytes.size() < 10 || bytes.substr(0, kMagic.size()) != kMagic) {
    return Fail(ErrorCode::kMalformed, "the file does not begin as a numpy array", name, "it is no .npy file");
  }
  const int version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3) {
    return Fail(ErrorCode::kUnsupported, "npy format version " + std::to_string(version), name, "known are 1, 2 and 3");
  }
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  if (bytes.size() < 8 + length_bytes) return Fail(ErrorCode::kMalformed, "the header is cut off", name);
  std::size_t length = 0;
  for (std::size_t i = 0; i < length_bytes; ++i) {
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[8 + i])) << (8 * i);
  }
  const std::size_t begin = 8 + length_bytes;
  if (length > bytes.size() - begin) return Fail(ErrorCode::kMalformed, "the header is cut off", name);
  const Expected<Header> header = HeaderReader(bytes.substr(begin, length), name).Read();
  if (!header) return Forward(header);

  const std::string_view data = bytes.substr(begin + length);
  const std::string& dtype = header->dtype;
  const Reader reader = dtype.size() == 3 ? ReaderOf(std::string_view(dtype).substr(1)) : nullptr;
  if (reader == nullptr || (dtype[0] != '<' && dtype[0] != '>' && dtype[0] != '=')) {
    return Fail(ErrorCode::kUnsupported, "arrays of type '" + dtype + "' are not read", name,
                "save it as float32, float64, int32 or int64");
  }
  const std::size_t width = dtype[2] == '4' ? 4 : 8;
  std::size_t count = 1;
  for (const std::size_t extent : header->shape) {
    if (extent != 0 && count > data.size() / extent) {
      return Fail(ErrorCode::kMalformed, "the shape announces more numbers than the file holds", name,
                  "the file is cut off: copy it again");
    }
    count *= extent;
  }
  if (count > data.size() / width || count * width != data.size()) {
    return Fail(ErrorCode::kMalformed,
                "the shape announces " + std::to_string(count) + " numbers of " + std::to_string(width) +
                    " bytes, the file holds " + std::to_string(data.size()) + " bytes of them",
                name, "the file is cut off: copy it again");
  }
  NpyArray array;
  array.shape = header->shape;
  array.dtype = dtype;
  array.values.resize(count);
  const bool swap = dtype[0] == '>';
  for (std::size_t i = 0; i < count; ++i) {
    array.values[header->fortran ? FromFortran(i, array.shape) : i] = reader(data.data() + i * width, swap);
  }
  return array;
}

std::string WriteNpy(const NpyArray& array) {
  const bool single = array.dtype == "<f4";
  std::string shape = "(";
  for (const std::size_t extent : array.shape) shape += std::to_string(extent) + ", ";
  if (array.shape.size() > 1) shape.resize(shape.size() - 2);
  std::string header =
      std::string("{'descr': '") + (single ? "<f4" : "<f8") + "', 'fortran_order': False, 'shape': " + shape + "), }";
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes(kMagic);
  bytes += '\x01';
  bytes += '\0';
  bytes += static_cast<char>(header.size() & 0xFF);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  for (const double value : array.values) {
    char raw[sizeof(double)];
    if (single) {
      const float narrow = static_cast<float>(value);
      std::memcpy(raw, &narrow, sizeof(narrow));
    } else {
      std::memcpy(raw, &value, sizeof(value));
    }
    bytes.append(raw, single ? sizeof(float) : sizeof(double));
  }
  return bytes;
}

}  // namespace mocurate
