#include "core/formats/ply.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"

namespace mocurate {

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

bool operator==(const PlyProperty& a, const PlyProperty& b) {
  return a.name == b.name && a.type == b.type && a.list_count == b.list_count && a.values == b.values &&
         a.first == b.first;
}

bool operator==(const PlyElement& a, const PlyElement& b) {
  return a.name == b.name && a.count == b.count && a.properties == b.properties;
}

bool operator==(const Ply& a, const Ply& b) {
  return a.encoding == b.encoding && a.comments == b.comments && a.elements == b.elements;
}

namespace {

std::string_view TypeName(NumberType type) {
  constexpr std::string_view kNames[] = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
  return kNames[static_cast<std::size_t>(type)];
}

std::string_view EncodingName(Ply::Encoding encoding) {
  constexpr std::string_view kNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  return kNames[static_cast<std::size_t>(encoding)];
}

void AppendValue(std::string& bytes, double value, NumberType type, Ply::Encoding encoding) {
  if (encoding == Ply::Encoding::kAscii) {
    if (!bytes.empty() && bytes.back() != '\n') bytes += ' ';
    bytes += FormatNumber(value, type);
  } else {
    AppendNumber(bytes, value, type,
                 encoding == Ply::Encoding::kBinaryBigEndian ? ByteOrder::kBig : ByteOrder::kLittle);
  }
}

}  // namespace

std::string WritePly(const Ply& ply) {
  std::string bytes = "ply\nformat " + std::string(EncodingName(ply.encoding)) + " 1.0\n";
  for (const std::string& comment : ply.comments) bytes += "comment " + comment + "\n";
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
  if (list == nullptr || !list->list_count || !IsInteger(list->type)) {
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
