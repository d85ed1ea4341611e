#include "core/formats/binary_numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/base/text.h"

namespace mocurate {
namespace {

template <class T>
double LoadTyped(const char* bytes, ByteOrder order) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order == ByteOrder::kBig) std::reverse(raw.begin(), raw.end());
  T value;
  std::memcpy(&value, raw.data(), sizeof(T));
  return static_cast<double>(value);
}

template <class T>
void AppendTyped(std::string& bytes, double value, ByteOrder order) {
  const T typed = static_cast<T>(value);
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &typed, sizeof(T));
  if (order == ByteOrder::kBig) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// Calls `visit` with a value of the C++ type.
template <class Visit>
auto Typed(NumberType type, Visit visit) {
  switch (type) {
    case NumberType::kInt8:
      return visit(std::int8_t{});
    case NumberType::kUint8:
      return visit(std::uint8_t{});
    case NumberType::kInt16:
      return visit(std::int16_t{});
    case NumberType::kUint16:
      return visit(std::uint16_t{});
    case NumberType::kInt32:
      return visit(std::int32_t{});
    case NumberType::kUint32:
      return visit(std::uint32_t{});
    case NumberType::kFloat32:
      return visit(float{});
    case NumberType::kFloat64:
      break;
  }
  return visit(double{});
}

}  // namespace

std::size_t SizeOf(NumberType type) {
  return Typed(type, [](auto value) { return sizeof(value); });
}

bool IsInteger(NumberType type) { return type != NumberType::kFloat32 && type != NumberType::kFloat64; }

double LoadNumber(const char* bytes, NumberType type, ByteOrder order) {
  return Typed(type, [&](auto value) { return LoadTyped<decltype(value)>(bytes, order); });
}

void AppendNumber(std::string& bytes, double value, NumberType type, ByteOrder order) {
  Typed(type, [&](auto typed) {
    AppendTyped<decltype(typed)>(bytes, value, order);
    return 0;
  });
}

std::string FormatNumber(double value, NumberType type) {
  if (type != NumberType::kFloat32) return FormatDouble(value);
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), static_cast<float>(value));
  return error == std::errc() ? std::string(text.data(), end) : FormatDouble(value);
}

double RoundedTo(NumberType type, double value) {
  if (type != NumberType::kFloat32) return value;
  // Beyond the range of float the conversion is undefined; the value stays, and NumberFault reports it.
  return std::abs(value) <= std::numeric_limits<float>::max() ? static_cast<double>(static_cast<float>(value)) : value;
}

std::string NumberFault(double value, NumberType type) {
  if (!std::isfinite(value)) return "is not finite";
  if (type == NumberType::kFloat32) {
    return std::abs(value) <= std::numeric_limits<float>::max() ? "" : "is beyond the range of float";
  }
  if (type == NumberType::kFloat64) return {};
  const auto [min, max] = Typed(type, [](auto typed) {
    using T = decltype(typed);
    return std::pair<double, double>(std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
  });
  if (value >= min && value <= max && value == std::floor(value)) return {};
  return "is not a whole number from " + FormatDouble(min) + " to " + FormatDouble(max);
}

std::string ShownText(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown;
  for (const char c : text.substr(0, kLongest)) shown += (c >= ' ' && c < 127) ? c : '?';
  return text.size() > kLongest ? shown + "..." : shown;
}

}  // namespace mocurate
