#include "core/formats/obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/text.h"
#include "core/formats/binary_numbers.h"
#include "core/formats/largest_number.h"

namespace mocurate {
namespace {

/// Keywords of the format that carry no polygon.
bool IsPassedOver(std::string_view keyword) {
  static constexpr std::string_view kKeywords[] = {
      "o",   "g",    "s",    "l",     "p",        "vp",       "usemtl", "mtllib",     "maplib",    "usemap", "cstype",
      "deg", "bmat", "step", "curv",  "curv2",    "surf",     "parm",   "trim",       "hole",      "scrv",   "sp",
      "end", "con",  "mg",   "bevel", "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj", "ctech",  "stech"};
  return std::find(std::begin(kKeywords), std::end(kKeywords), keyword) != std::end(kKeywords);
}

class ObjParser {
 public:
  ObjParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Expected<Obj> Parse() {
    std::string joined;
    for (std::string_view line; NextLine(line);) {
      // A backslash at the end continues the line.
      line = Trim(line);
      if (!line.empty() && line.back() == '\\') {
        line.remove_suffix(1);
        joined.append(line).append(" ");
        continue;
      }
      if (!joined.empty()) line = joined.append(line);
      if (Status read = Line(line); !read) return Forward(read);
      joined.clear();
    }
    if (!joined.empty()) return Bad("the last line is to be continued, but the file ends");
    if (obj_.faces.empty() && !bytes_.empty() && bytes_.back() != '\n')
      return Bad("the file ends within a line, before any face: it is cut off", "copy it again");
    if (obj_.vertices.empty())
      return Fail(ErrorCode::kMalformed, "the file holds no vertices", name_,
                  "export the mesh again, or leave the file out");
    return std::move(obj_);
  }

 private:
  tl::unexpected<Error> Bad(const std::string& rule, const std::string& hint = {}) const {
    const bool last = at_ >= bytes_.size() && !bytes_.empty() && bytes_.back() != '\n';
    const char* usual = last ? "the file ends within this line: it is cut off, copy it again"
                             : "mend the line, or export the mesh again";
    return Fail(ErrorCode::kMalformed, rule, name_ + ":" + std::to_string(line_), hint.empty() ? usual : hint);
  }

  bool NextLine(std::string_view& line) {
    if (at_ >= bytes_.size()) return false;
    std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) end = bytes_.size();
    line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    return true;
  }

  Status Line(std::string_view line) {
    line = Trim(line.substr(0, line.find('#')));
    if (line.empty()) return {};
    Split(line);
    const std::string_view keyword = words_[0];
    if (keyword == "v") return Vertex();
    if (keyword == "vn") return Normal();
    if (keyword == "vt") return Texture();
    if (keyword == "f") return Face();
    if (IsPassedOver(keyword)) return {};
    return Bad("'" + ShownText(keyword) + "' is no keyword of the format",
               "leave the line out, or export the mesh again");
  }

  /// SplitBlanks into words_, whose memory is used again.
  void Split(std::string_view line) {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    words_.clear();
    for (std::size_t at = 0; (at = line.find_first_not_of(kBlanks, at)) != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
      words_.push_back(line.substr(at, end - at));
      at = end;
    }
  }

  /// The words behind the first into numbers_.
  Status Numbers() {
    numbers_.clear();
    for (std::size_t i = 1; i < words_.size(); ++i) {
      const std::optional<double> number = ParseDouble(words_[i]);
      if (!number || !std::isfinite(*number)) return Bad("'" + ShownText(words_[i]) + "' is not a finite number");
      numbers_.push_back(*number);
    }
    return {};
  }

  Status Vertex() {
    if (Status read = Numbers(); !read) return read;
    const std::size_t n = numbers_.size();
    if (n != 3 && n != 4 && n != 6 && n != 7) return Bad("a vertex has 3 numbers, not " + std::to_string(n));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::abs(numbers_[axis]) <= kLargestCoordinate) continue;
      return Bad("'" + ShownText(words_[axis + 1]) + "' is no coordinate of a scan: vertex " +
                     std::to_string(obj_.vertices.size() + 1) + ", " + "xyz"[axis],
                 kCoordinateHint);
    }
    obj_.vertices.emplace_back(numbers_[0], numbers_[1], numbers_[2]);
    obj_.vertex_lines.push_back(line_);
    return {};
  }

  Status Normal() {
    if (Status read = Numbers(); !read) return read;
    if (numbers_.size() != 3) return Bad("a normal has 3 numbers, not " + std::to_string(numbers_.size()));
    obj_.normals.emplace_back(numbers_[0], numbers_[1], numbers_[2]);
    return {};
  }

  Status Texture() {
    if (Status read = Numbers(); !read) return read;
    if (numbers_.empty() || numbers_.size() > 3) return Bad("a texture point has 1 to 3 numbers");
    obj_.textures.emplace_back(numbers_[0], numbers_.size() > 1 ? numbers_[1] : 0.0);
    return {};
  }

  Status Face() {
    if (words_.size() < 4) return Bad("a face has at least 3 corners, not " + std::to_string(words_.size() - 1));
    std::vector<ObjCorner> face;
    face.reserve(words_.size() - 1);
    for (std::size_t i = 1; i < words_.size(); ++i) {
      std::array<std::string_view, 3> parts;
      std::size_t count = 0;
      for (std::string_view rest = words_[i];; ++count) {
        if (count == parts.size()) {
          return Bad("'" + ShownText(words_[i]) + "' is no corner v, v/vt, v//vn or v/vt/vn");
        }
        const std::size_t end = rest.find('/');
        parts[count] = rest.substr(0, end);
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + 1);
      }
      ObjCorner corner;
      Status read = Index(parts[0], obj_.vertices.size(), "vertex", corner.vertex);
      if (read && count > 0 && !(parts[1].empty() && count == 2)) {
        read = Index(parts[1], obj_.textures.size(), "texture point", corner.texture);
      }
      if (read && count > 1) read = Index(parts[2], obj_.normals.size(), "normal", corner.normal);
      if (!read) return read;
      face.push_back(corner);
    }
    obj_.faces.push_back(std::move(face));
    return {};
  }

  Status Index(std::string_view text, std::size_t count, const char* what, int& index) const {
    const std::optional<long long> number = ParseInteger(text);
    const auto size = static_cast<long long>(count);
    if (!number) return Bad("'" + ShownText(text) + "' is no index of a " + what);
    if (*number == 0 || *number > size || *number < -size) {
      return Bad(std::string("there is no ") + what + " " + std::to_string(*number) + " (" + std::to_string(size) +
                 " so far)");
    }
    index = static_cast<int>(*number > 0 ? *number - 1 : size + *number);
    return {};
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::vector<std::string_view> words_;
  std::vector<double> numbers_;
  Obj obj_;
};

}  // namespace

bool operator==(const ObjCorner& a, const ObjCorner& b) {
  return a.vertex == b.vertex && a.texture == b.texture && a.normal == b.normal;
}

bool operator==(const Obj& a, const Obj& b) {
  return a.vertices == b.vertices && a.textures == b.textures && a.normals == b.normals && a.faces == b.faces;
}

Expected<Obj> ParseObj(std::string_view bytes, const std::string& name) { return ObjParser(bytes, name).Parse(); }

std::string WriteObj(const Obj& obj) {
  std::string text;
  const auto line = [&](const char* keyword, const double* numbers, int count) {
    text += keyword;
    for (int i = 0; i < count; ++i) text += " " + FormatDouble(numbers[i]);
    text += '\n';
  };
  for (const Vector3d& vertex : obj.vertices) line("v", vertex.data(), 3);
  for (const Vector2d& texture : obj.textures) line("vt", texture.data(), 2);
  for (const Vector3d& normal : obj.normals) line("vn", normal.data(), 3);
  for (const std::vector<ObjCorner>& face : obj.faces) {
    text += 'f';
    for (const ObjCorner& corner : face) {
      text += " " + std::to_string(corner.vertex + 1);
      if (corner.texture >= 0 || corner.normal >= 0) text += '/';
      if (corner.texture >= 0) text += std::to_string(corner.texture + 1);
      if (corner.normal >= 0) text += "/" + std::to_string(corner.normal + 1);
    }
    text += '\n';
  }
  return text;
}

std::vector<std::array<int, 3>> ObjTriangles(const Obj& obj) {
  std::vector<std::array<int, 3>> triangles;
  for (const std::vector<ObjCorner>& face : obj.faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      triangles.push_back({face[0].vertex, face[k].vertex, face[k + 1].vertex});
    }
  }
  return triangles;
}

}  // namespace mocurate
