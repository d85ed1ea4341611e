#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mocurate {

/// Values of a field that the format of datasets does not name, or of an attribute: kept as another program wrote them.
struct ExtraField {
  std::string type;                  ///< of a value, as HDF5 encodes it; empty: texts
  std::vector<std::uint64_t> shape;  ///< row-major; empty: one value
  std::string bytes;                 ///< of values that are no texts
  std::vector<std::string> texts;

  std::uint64_t rows() const { return shape.empty() ? 1 : shape[0]; }
  /// Number of values that the shape announces.
  std::uint64_t count() const;
  /// Whether it is more than type and shape.
  bool HasValues() const { return !bytes.empty() || !texts.empty() || count() == 0; }
  /// Whether rows of `other` can stand beside its own.
  bool HasRowsLike(const ExtraField& other) const;
  /// Rows [begin, end) below rows(); without values where it has none.
  ExtraField Rows(std::uint64_t begin, std::uint64_t end) const;
  void Append(const ExtraField& more);
};

/// Whether two encoded types are one: HDF5 encodes the types of files of several versions in several ways.
bool SameType(const std::string& a, const std::string& b);

bool operator==(const ExtraField& a, const ExtraField& b);

/// By path: "/clips/score"; an attribute after its dataset's, "/clips/score/@unit", and of the root "/@note".
using ExtraFields = std::map<std::string, ExtraField>;

/// Of an attribute's path that of its dataset, "" for the root; nothing for the path of a dataset.
std::optional<std::string> DatasetOfAttribute(const std::string& path);

/// The fields of a dataset's file that the format does not name, by what their rows belong to.
struct OtherFields {
  ExtraFields of_clips;                           ///< below /clips, a row per clip
  ExtraFields of_frames;                          ///< below /frames, a row per frame; type and shape without values
  ExtraFields of_set;                             ///< all others, and the attributes of these fields and of the root
  std::map<std::string, std::string> unreadable;  ///< path -> reason
};

}  // namespace mocurate
