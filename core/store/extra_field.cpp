#include "core/store/extra_field.h"

#include <algorithm>

namespace mocurate {

std::uint64_t ExtraField::count() const {
  std::uint64_t product = 1;
  for (const std::uint64_t extent : shape) product *= extent;
  return product;
}

bool ExtraField::HasRowsLike(const ExtraField& other) const {
  return SameType(type, other.type) && !shape.empty() && shape.size() == other.shape.size() &&
         std::equal(shape.begin() + 1, shape.end(), other.shape.begin() + 1);
}

ExtraField ExtraField::Rows(std::uint64_t begin, std::uint64_t end) const {
  ExtraField some;
  some.type = type;
  some.shape = shape;
  some.shape.at(0) = end - begin;
  if (rows() == 0) return some;
  const std::size_t width = bytes.size() / rows();
  some.bytes = bytes.substr(begin * width, (end - begin) * width);
  const std::size_t wide = texts.size() / rows();
  some.texts.assign(texts.begin() + static_cast<std::ptrdiff_t>(begin * wide),
                    texts.begin() + static_cast<std::ptrdiff_t>(end * wide));
  return some;
}

void ExtraField::Append(const ExtraField& more) {
  shape.at(0) += more.rows();
  bytes += more.bytes;
  texts.insert(texts.end(), more.texts.begin(), more.texts.end());
}

bool operator==(const ExtraField& a, const ExtraField& b) {
  return a.shape == b.shape && a.bytes == b.bytes && a.texts == b.texts && SameType(a.type, b.type);
}

std::optional<std::string> DatasetOfAttribute(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos || path.compare(slash, 2, "/@") != 0) return std::nullopt;
  return path.substr(0, slash);
}

}  // namespace mocurate
