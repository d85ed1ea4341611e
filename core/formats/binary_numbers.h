#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mocurate {

/// Numbers as binary formats store them. All of these fit a double without loss.
enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class ByteOrder { kLittle, kBig };

std::size_t SizeOf(NumberType type);
bool IsInteger(NumberType type);

/// The number at `bytes` (at least SizeOf(type) of them).
double LoadNumber(const char* bytes, NumberType type, ByteOrder order);
/// Appends; `value` must fit (NumberFault).
void AppendNumber(std::string& bytes, double value, NumberType type, ByteOrder order);

/// Shortest text that reads back as the same number of this type.
std::string FormatNumber(double value, NumberType type);
/// The value as the type holds it: floats are rounded.
double RoundedTo(NumberType type, double value);
/// Why a value cannot be of this type ("is not a whole number from 0 to 255", "is not finite"); empty if it can.
std::string NumberFault(double value, NumberType type);

/// Text of a file for a message: printable, at most 40 characters.
std::string ShownText(std::string_view text);

}  // namespace mocurate
