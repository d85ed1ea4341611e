#include "core/formats/array_elements.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::size_t kMaxAxes = 32;
constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;

template <class T>
T LoadElement(const char* bytes, bool swap) {
  char raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

template <class T>
void Store(T value, bool swap, std::string& bytes) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[swap ? sizeof(T) - 1 - i : i];
}

double HalfToDouble(std::uint16_t half) {
  const int exponent = (half >> 10) & 31;
  const int fraction = half & 1023;
  double value = 0.0;
  if (exponent == 31) {
    value = fraction == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  } else {
    value = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  }
  return (half & 0x8000) != 0 ? -value : value;
}

/// Nearest half, ties to even; beyond 65504 infinity.
std::uint16_t DoubleToHalf(double value) {
  const std::uint16_t sign = std::signbit(value) ? 0x8000 : 0;
  if (std::isnan(value)) return static_cast<std::uint16_t>(sign | 0x7E00);
  const double size = std::abs(value);
  if (size >= 65520.0) return static_cast<std::uint16_t>(sign | 0x7C00);
  int exponent = 0;
  std::frexp(size, &exponent);                    // size in [2^(exponent-1), 2^exponent)
  const int step = std::max(exponent - 11, -24);  // of the last digit
  const double digits = std::nearbyint(std::ldexp(size, -step));
  if (size == 0.0 || digits == 0.0) return sign;
  // Digits of a normal number carry its hidden bit; a carry into the next exponent comes out right by addition.
  const int bits = static_cast<int>(digits) + (step == -24 ? 0 : (step + 24) << 10);
  return static_cast<std::uint16_t>(sign | bits);
}

template <class T>
bool Holds(double value) {
  constexpr double low = static_cast<double>(std::numeric_limits<T>::lowest());
  const double beyond = std::ldexp(1.0, std::numeric_limits<T>::digits);
  return value >= low && value < beyond && value == std::floor(value);
}

struct Boolean {
  std::uint8_t byte = 0;
  explicit operator double() const { return byte != 0 ? 1.0 : 0.0; }
};

struct Half {
  std::uint16_t bits = 0;
  explicit operator double() const { return HalfToDouble(bits); }
};

/// Calls `visit` with a value of the C++ type that a numeric type is.
template <class Visit>
auto Typed(const ElementType& type, const Visit& visit) {
  switch (type.kind) {
    case ElementKind::kBool:
      return visit(Boolean{});
    case ElementKind::kSigned:
      if (type.bytes == 1) return visit(std::int8_t{});
      if (type.bytes == 2) return visit(std::int16_t{});
      if (type.bytes == 4) return visit(std::int32_t{});
      return visit(std::int64_t{});
    case ElementKind::kUnsigned:
      if (type.bytes == 1) return visit(std::uint8_t{});
      if (type.bytes == 2) return visit(std::uint16_t{});
      if (type.bytes == 4) return visit(std::uint32_t{});
      return visit(std::uint64_t{});
    default:
      if (type.bytes == 2) return visit(Half{});
      if (type.bytes == 4) return visit(float{});
      return visit(double{});
  }
}

/// False where the type cannot hold the value.
bool StoreNumber(const ElementType& type, double value, std::string& bytes) {
  return Typed(type, [&](auto typed) {
    using T = decltype(typed);
    if constexpr (std::is_same_v<T, Boolean>) {
      if (value != 0.0 && value != 1.0) return false;
      bytes += static_cast<char>(value);
    } else if constexpr (std::is_same_v<T, Half>) {
      Store(DoubleToHalf(value), type.big_endian, bytes);
    } else {
      if (std::is_integral_v<T> && !Holds<T>(value)) return false;
      Store(static_cast<T>(value), type.big_endian, bytes);
    }
    return true;
  });
}

}  // namespace

std::optional<ElementType> ParseElementType(std::string_view dtype) {
  ElementType type;
  if (!dtype.empty() && std::string_view("<>=|").find(dtype[0]) != std::string_view::npos) {
    type.big_endian = dtype[0] == '>';
    dtype.remove_prefix(1);
  }
  if (dtype.empty()) return std::nullopt;
  const char letter = dtype[0];
  if (dtype == "O" || dtype == "O8") return ElementType{ElementKind::kObject, 8, false};
  if (dtype == "?") return ElementType{ElementKind::kBool, 1, false};
  const std::optional<long long> digits = ParseInteger(dtype.substr(1));
  if (!digits || *digits < 0 || dtype[1] == '+') return std::nullopt;
  const auto size = static_cast<std::size_t>(*digits);
  type.bytes = size;
  if (letter == 'U' || letter == 'S' || letter == 'a') {
    if (size > kMaxTextBytes) return std::nullopt;
    type.kind = letter == 'U' ? ElementKind::kText : ElementKind::kBytes;
    if (letter == 'U') type.bytes *= 4;
    return type;
  }
  const bool whole = size == 1 || size == 2 || size == 4 || size == 8;
  if (letter == 'b' && size == 1) {
    type.kind = ElementKind::kBool;
  } else if (letter == 'i' && whole) {
    type.kind = ElementKind::kSigned;
  } else if (letter == 'u' && whole) {
    type.kind = ElementKind::kUnsigned;
  } else if (letter == 'f' && whole && size > 1) {
    type.kind = ElementKind::kReal;
  } else {
    return std::nullopt;
  }
  return type;
}

std::optional<std::size_t> ElementCount(const std::vector<std::size_t>& shape, std::size_t bytes_each,
                                        std::size_t stored) {
  if (shape.size() > kMaxAxes) return std::nullopt;
  std::size_t count = 1;
  for (const std::size_t extent : shape) {
    if (extent == 0) return stored == 0 ? std::optional<std::size_t>(0) : std::nullopt;
  }
  // Elements without bytes (texts of length 0) are bounded as if each had one.
  const std::size_t most = bytes_each == 0 ? kMaxTextBytes : stored / bytes_each;
  for (const std::size_t extent : shape) {
    if (extent > most / count) return std::nullopt;
    count *= extent;
  }
  if (count > most || count * bytes_each != stored) return std::nullopt;
  return count;
}

double LoadNumber(const char* bytes, const ElementType& type) {
  return Typed(type,
               [&](auto typed) { return static_cast<double>(LoadElement<decltype(typed)>(bytes, type.big_endian)); });
}

void DecodeNumbers(const ElementType& type, std::string_view data, std::vector<double>& values) {
  if (type.bytes == 0 || !type.is_number()) return;
  values.reserve(values.size() + data.size() / type.bytes);
  Typed(type, [&](auto typed) {
    for (std::size_t at = 0; at + sizeof(typed) <= data.size(); at += sizeof(typed)) {
      values.push_back(static_cast<double>(LoadElement<decltype(typed)>(data.data() + at, type.big_endian)));
    }
    return 0;
  });
}

double RoundedTo(const ElementType& type, double value) {
  if (!(type == kFloat32)) return value;
  // Beyond the range of float the conversion is undefined; the value stays, and NumberFault reports it.
  return std::abs(value) <= std::numeric_limits<float>::max() ? static_cast<double>(static_cast<float>(value)) : value;
}

std::string NumberFault(double value, const ElementType& type) {
  if (!std::isfinite(value)) return "is not finite";
  if (type == kFloat32) {
    return std::abs(value) <= std::numeric_limits<float>::max() ? "" : "is beyond the range of float";
  }
  if (!type.is_integer()) return {};
  const auto [min, max] = Typed(type, [](auto typed) {
    using T = decltype(typed);
    return std::pair(static_cast<double>(std::numeric_limits<T>::min()),
                     static_cast<double>(std::numeric_limits<T>::max()));
  });
  if (value >= min && value <= max && value == std::floor(value)) return {};
  return "is not a whole number from " + FormatDouble(min) + " to " + FormatDouble(max);
}

std::optional<std::vector<std::string>> DecodeTexts(const ElementType& type, std::string_view data) {
  std::vector<std::string> texts;
  if (type.bytes == 0) return texts;
  for (std::size_t at = 0; at + type.bytes <= data.size(); at += type.bytes) {
    std::string_view raw = data.substr(at, type.bytes);
    if (type.kind == ElementKind::kBytes) {
      while (!raw.empty() && raw.back() == '\0') raw.remove_suffix(1);
      texts.emplace_back(raw);
      continue;
    }
    std::size_t characters = raw.size() / 4;
    const auto character = [&](std::size_t i) {
      return LoadElement<std::uint32_t>(raw.data() + 4 * i, type.big_endian);
    };
    while (characters > 0 && character(characters - 1) == 0) --characters;
    std::string text;
    for (std::size_t i = 0; i < characters; ++i) {
      const std::string utf8 = Utf8Of(character(i));
      if (utf8.empty()) return std::nullopt;
      text += utf8;
    }
    texts.push_back(std::move(text));
  }
  return texts;
}

Status EncodeNumbers(const ElementType& type, const std::vector<double>& values, const std::string& name,
                     std::string& bytes) {
  if (!type.is_number()) return Fail(ErrorCode::kMalformed, "the type is not numeric", name);
  bytes.reserve(bytes.size() + values.size() * type.bytes);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!StoreNumber(type, values[i], bytes)) {
      return Fail(ErrorCode::kMalformed,
                  "value " + std::to_string(i) + ", " + FormatDouble(values[i]) + ", does not fit its type", name);
    }
  }
  return {};
}

Status EncodeTexts(const ElementType& type, const std::vector<std::string>& texts, const std::string& name,
                   std::string& bytes) {
  for (std::size_t i = 0; i < texts.size(); ++i) {
    std::string raw;
    if (type.kind == ElementKind::kText) {
      const std::optional<std::vector<std::uint32_t>> characters = CodePoints(texts[i]);
      if (!characters) return Fail(ErrorCode::kMalformed, "text " + std::to_string(i) + " is not UTF-8", name);
      for (const std::uint32_t character : *characters) Store(character, type.big_endian, raw);
    } else {
      raw = texts[i];
    }
    if (raw.size() > type.bytes) {
      return Fail(ErrorCode::kMalformed, "text " + std::to_string(i) + " is longer than its type", name);
    }
    raw.resize(type.bytes, '\0');
    bytes += raw;
  }
  return {};
}

std::vector<std::size_t> FortranPositions(const std::vector<std::size_t>& shape, std::size_t count) {
  std::vector<std::size_t> positions;
  positions.reserve(count);
  std::vector<std::size_t> stride(shape.size(), 1), index(shape.size(), 0);
  for (std::size_t axis = 1; axis < shape.size(); ++axis) stride[axis] = stride[axis - 1] * shape[axis - 1];
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    positions.push_back(at);
    for (std::size_t axis = shape.size(); axis-- > 0;) {
      at += stride[axis];
      if (++index[axis] < shape[axis]) break;
      at -= stride[axis] * shape[axis];
      index[axis] = 0;
    }
  }
  return positions;
}

std::string ShapeText(const std::vector<std::size_t>& shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

std::string Utf8Of(std::uint32_t code_point) {
  if (code_point > 0x10FFFF || (code_point >= 0xD800 && code_point < 0xE000)) return {};
  if (code_point < 0x80) return std::string(1, static_cast<char>(code_point));
  std::string utf8;
  const int tail = code_point < 0x800 ? 1 : code_point < 0x10000 ? 2 : 3;
  const unsigned lead = tail == 1 ? 0xC0 : tail == 2 ? 0xE0 : 0xF0;
  utf8 += static_cast<char>(lead | (code_point >> (6 * tail)));
  for (int i = tail - 1; i >= 0; --i) utf8 += static_cast<char>(0x80 | ((code_point >> (6 * i)) & 0x3F));
  return utf8;
}

std::optional<std::vector<std::uint32_t>> CodePoints(std::string_view utf8) {
  if (FirstNotUtf8(utf8)) return std::nullopt;
  std::vector<std::uint32_t> characters;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const int tail = lead < 0x80 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
    std::uint32_t character = tail == 0 ? lead : lead & (0x3Fu >> tail);
    for (int k = 1; k <= tail; ++k) character = (character << 6) | (static_cast<unsigned char>(utf8[i + k]) & 0x3Fu);
    characters.push_back(character);
    i += static_cast<std::size_t>(tail) + 1;
  }
  return characters;
}

}  // namespace mocurate
