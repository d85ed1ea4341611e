#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/text.h"
#include "core/formats/array_elements.h"
#include "core/formats/point_cloud.h"

namespace mocurate {

inline bool operator==(const PlyProperty& a, const PlyProperty& b) {
  return a.name == b.name && a.type == b.type && a.list_count == b.list_count && a.values == b.values &&
         a.first == b.first;
}

inline bool operator==(const PlyElement& a, const PlyElement& b) {
  return a.name == b.name && a.count == b.count && a.properties == b.properties;
}

inline bool operator==(const Ply& a, const Ply& b) { return a.encoding == b.encoding && a.elements == b.elements; }

inline std::string_view TypeName(const ElementType& type) {
  if (type.kind == ElementKind::kReal) return type.bytes == 4 ? "float" : "double";
  const bool is_signed = type.kind == ElementKind::kSigned;
  if (type.bytes == 1) return is_signed ? "char" : "uchar";
  if (type.bytes == 2) return is_signed ? "short" : "ushort";
  return is_signed ? "int" : "uint";
}

/// Shortest text that reads back as the same number of this type.
inline std::string FormatNumber(double value, const ElementType& type) {
  if (!(type == kFloat32)) return FormatDouble(value);
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), static_cast<float>(value));
  return error == std::errc() ? std::string(text.data(), end) : FormatDouble(value);
}

/// `value` must fit the type.
inline void AppendNumber(std::string& bytes, double value, const ElementType& type) {
  if (!EncodeNumbers(type, {value}, "number", bytes)) std::abort();
}

inline std::string_view EncodingName(Ply::Encoding encoding) {
  constexpr std::string_view kNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  return kNames[static_cast<std::size_t>(encoding)];
}

inline void AppendValue(std::string& bytes, double value, ElementType type, Ply::Encoding encoding) {
  if (encoding == Ply::Encoding::kAscii) {
    if (!bytes.empty() && bytes.back() != '\n') bytes += ' ';
    bytes += FormatNumber(value, type);
  } else {
    type.big_endian = encoding == Ply::Encoding::kBinaryBigEndian;
    AppendNumber(bytes, value, type);
  }
}

/// In the file's encoding; values must fit their types.
inline std::string WritePly(const Ply& ply) {
  std::string bytes = "ply\nformat " + std::string(EncodingName(ply.encoding)) + " 1.0\n";
  for (const PlyElement& element : ply.elements) {
    bytes += "element " + element.name + " " + std::to_string(element.count) + "\n";
    for (const PlyProperty& property : element.properties) {
      bytes += "property ";
      if (property.list_count) bytes += "list " + std::string(TypeName(*property.list_count)) + " ";
      bytes += std::string(TypeName(property.type)) + " " + property.name + "\n";
    }
  }
  bytes += "end_header\n";
  for (const PlyElement& element : ply.elements) {
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!property.list_count) {
          AppendValue(bytes, property.values[i], property.type, ply.encoding);
          continue;
        }
        const std::size_t begin = property.first[i];
        const std::size_t end = property.first[i + 1];
        AppendValue(bytes, static_cast<double>(end - begin), *property.list_count, ply.encoding);
        for (std::size_t k = begin; k < end; ++k) AppendValue(bytes, property.values[k], property.type, ply.encoding);
      }
      if (ply.encoding == Ply::Encoding::kAscii) bytes += '\n';
    }
  }
  return bytes;
}

inline bool operator==(const PcdField& a, const PcdField& b) {
  return a.name == b.name && a.type == b.type && a.count == b.count && a.values == b.values;
}

inline bool operator==(const Pcd& a, const Pcd& b) {
  return a.encoding == b.encoding && a.width == b.width && a.height == b.height && a.viewpoint == b.viewpoint &&
         a.fields == b.fields && a.missing == b.missing;
}

inline float ColourAsFloat(double colour) {
  const auto bits = static_cast<std::uint32_t>(colour);
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// The value as the file holds it.
inline double StoredValue(const Pcd& pcd, const PcdField& field, std::size_t i) {
  const std::size_t point = i / static_cast<std::size_t>(field.count);
  const bool axis = field.name == "x" || field.name == "y" || field.name == "z";
  if (axis && pcd.missing[point] != 0) return std::numeric_limits<double>::quiet_NaN();
  return field.PackedColour() ? static_cast<double>(ColourAsFloat(field.values[i])) : field.values[i];
}

inline void AppendPoint(const Pcd& pcd, const PcdField& field, std::size_t point, std::string& bytes) {
  for (int k = 0; k < field.count; ++k) {
    const std::size_t i = point * static_cast<std::size_t>(field.count) + static_cast<std::size_t>(k);
    const double value = StoredValue(pcd, field, i);
    if (pcd.encoding != Pcd::Encoding::kAscii) {
      AppendNumber(bytes, value, field.type);
    } else {
      if (bytes.back() != '\n') bytes += ' ';
      bytes += std::isnan(value) ? "nan" : FormatNumber(value, field.type);
    }
  }
}

/// A valid block of literals only: a little longer than `bytes`.
inline std::string PackLzf(std::string_view bytes) {
  std::string block;
  constexpr std::size_t kLongestLiteral = 32;
  for (std::size_t at = 0; at < bytes.size(); at += kLongestLiteral) {
    const std::string_view run = bytes.substr(at, kLongestLiteral);
    block += static_cast<char>(run.size() - 1);
    block += run;
  }
  return block;
}

/// In the file's encoding; compressed files are stored without compression.
inline std::string WritePcd(const Pcd& pcd) {
  std::string names = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT", viewpoint = "VIEWPOINT";
  for (const PcdField& field : pcd.fields) {
    const bool is_signed = field.type.kind == ElementKind::kSigned;
    names += " " + field.name;
    sizes += " " + std::to_string(field.type.bytes);
    types += !field.type.is_integer() ? " F" : is_signed ? " I" : " U";
    counts += " " + std::to_string(field.count);
  }
  for (const double value : pcd.viewpoint) viewpoint += " " + FormatDouble(value);
  constexpr std::string_view kEncodings[] = {"ascii", "binary", "binary_compressed"};
  std::string bytes = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + names + "\n" + sizes + "\n" +
                      types + "\n" + counts + "\nWIDTH " + std::to_string(pcd.width) + "\nHEIGHT " +
                      std::to_string(pcd.height) + "\n" + viewpoint + "\nPOINTS " + std::to_string(pcd.point_count()) +
                      "\nDATA " + std::string(kEncodings[static_cast<std::size_t>(pcd.encoding)]) + "\n";
  if (pcd.encoding == Pcd::Encoding::kBinaryCompressed) {
    std::string data;
    for (const PcdField& field : pcd.fields) {
      for (std::size_t i = 0; i < pcd.point_count(); ++i) AppendPoint(pcd, field, i, data);
    }
    const std::string block = PackLzf(data);
    AppendNumber(bytes, static_cast<double>(block.size()), kUint32);
    AppendNumber(bytes, static_cast<double>(data.size()), kUint32);
    return bytes + block;
  }
  for (std::size_t i = 0; i < pcd.point_count(); ++i) {
    for (const PcdField& field : pcd.fields) AppendPoint(pcd, field, i, bytes);
    if (pcd.encoding == Pcd::Encoding::kAscii) bytes += '\n';
  }
  return bytes;
}

}  // namespace mocurate
