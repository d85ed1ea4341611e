#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Type of one element of a numpy array, or of a value of a PLY or PCD file.
enum class ElementKind { kBool, kSigned, kUnsigned, kReal, kText, kBytes, kObject };

/// A numpy type as text ("<f4", "|b1", ">i8", "<U6", "|S7", "|O").
struct ElementType {
  ElementKind kind = ElementKind::kReal;
  std::size_t bytes = 8;  ///< of one element; 4 per character of a <U text; 8 of an object
  bool big_endian = false;

  bool is_number() const { return kind <= ElementKind::kReal; }
  bool is_integer() const { return kind == ElementKind::kSigned || kind == ElementKind::kUnsigned; }
};

/// Byte order aside.
inline bool operator==(const ElementType& a, const ElementType& b) { return a.kind == b.kind && a.bytes == b.bytes; }

inline constexpr ElementType kInt8{ElementKind::kSigned, 1}, kInt16{ElementKind::kSigned, 2},
    kInt32{ElementKind::kSigned, 4}, kUint8{ElementKind::kUnsigned, 1}, kUint16{ElementKind::kUnsigned, 2},
    kUint32{ElementKind::kUnsigned, 4}, kFloat32{ElementKind::kReal, 4}, kFloat64{ElementKind::kReal, 8};

/// Empty for any other type (complex numbers, dates, long doubles, records).
std::optional<ElementType> ParseElementType(std::string_view dtype);

/// Number of elements of `shape` when they fit into `stored` bytes exactly; empty otherwise, also for more than 32
/// axes. Never overflows.
std::optional<std::size_t> ElementCount(const std::vector<std::size_t>& shape, std::size_t bytes_each,
                                        std::size_t stored);

/// The number at `bytes`, which holds an element of a numeric type.
double LoadNumber(const char* bytes, const ElementType& type);
/// The value as the type holds it: of kFloat32 rounded.
double RoundedTo(const ElementType& type, double value);
/// Why a value cannot be of this type ("is not a whole number from 0 to 255", "is not finite"); empty if it can.
std::string NumberFault(double value, const ElementType& type);

/// Numbers of `data`, which holds whole elements of a numeric type, appended to `values` in the order of `data`.
/// Integers beyond 2^53 lose their last digits.
void DecodeNumbers(const ElementType& type, std::string_view data, std::vector<double>& values);

/// Texts of a <U or |S type, padding zeros cut off; a <U text comes as UTF-8. Empty when a character is invalid.
std::optional<std::vector<std::string>> DecodeTexts(const ElementType& type, std::string_view data);

/// Inverse of DecodeNumbers. Error kMalformed with the position of the first value that the type cannot hold.
Status EncodeNumbers(const ElementType& type, const std::vector<double>& values, const std::string& name,
                     std::string& bytes);

/// Inverse of DecodeTexts. Error kMalformed with the position of the first text that is too long or not UTF-8.
Status EncodeTexts(const ElementType& type, const std::vector<std::string>& texts, const std::string& name,
                   std::string& bytes);

/// For each element in C order its position in Fortran order.
std::vector<std::size_t> FortranPositions(const std::vector<std::size_t>& shape, std::size_t count);

/// "(2, 3)", as Python writes it: "(2,)" for one axis.
std::string ShapeText(const std::vector<std::size_t>& shape);

/// UTF-8 of one code point; empty for surrogates and what lies beyond U+10FFFF.
std::string Utf8Of(std::uint32_t code_point);
/// Code points of valid UTF-8; empty when it is not.
std::optional<std::vector<std::uint32_t>> CodePoints(std::string_view utf8);

}  // namespace mocurate
