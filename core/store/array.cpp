#include "core/store/array.h"

#include <array>

#include "core/base/sha256.h"

namespace mocurate::store {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "hashes are taken over little-endian memory");

std::string_view Name(FieldType type) {
  constexpr std::array<std::string_view, 6> kNames = {"f4", "f8", "i4", "i8", "u1", "text"};
  return kNames[static_cast<std::size_t>(type)];
}

std::uint64_t Array::count() const {
  std::uint64_t product = 1;
  for (const std::uint64_t extent : shape) product *= extent;
  return product;
}

std::uint64_t Array::size() const {
  return std::visit([](const auto& held) { return static_cast<std::uint64_t>(held.size()); }, values);
}

std::string Array::ShapeText() const {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(shape[i]);
  return text + ")";
}

std::string Array::Sha256() const {
  mocurate::Sha256 hasher;
  AddTo(hasher);
  return hasher.Hex();
}

void Array::AddTo(mocurate::Sha256& hasher) const {
  std::visit(
      [&hasher](const auto& held) {
        using Value = typename std::decay_t<decltype(held)>::value_type;
        if constexpr (std::is_same_v<Value, std::string>) {
          for (const std::string& text : held) hasher.Add(text).Add(std::string_view("\0", 1));
        } else if (!held.empty()) {
          hasher.Add(held.data(), held.size() * sizeof(Value));
        }
      },
      values);
}

bool operator==(const Array& a, const Array& b) { return a.shape == b.shape && a.values == b.values; }

Array MakeText(std::string text) { return Array{{}, std::vector<std::string>{std::move(text)}}; }

Array EmptyArray(FieldType type, std::vector<std::uint64_t> shape) {
  const decltype(Array::values) kinds[] = {std::vector<float>(),        std::vector<double>(),
                                           std::vector<std::int32_t>(), std::vector<std::int64_t>(),
                                           std::vector<std::uint8_t>(), std::vector<std::string>()};
  return Array{std::move(shape), kinds[static_cast<std::size_t>(type)]};
}

const Array* Content::Find(const std::string& path) const {
  const auto found = fields.find(path);
  return found == fields.end() ? nullptr : &found->second;
}

std::string Content::Text(const std::string& path) const {
  const Array* array = Find(path);
  if (array == nullptr || array->type() != FieldType::kText || array->size() != 1) return {};
  return array->as<std::string>()[0];
}

std::string FieldLine(const Array& array, const std::string& sha256) {
  std::string line = " " + std::string(Name(array.type())) + " ";
  for (std::size_t i = 0; i < array.shape.size(); ++i) line += (i == 0 ? "" : ",") + std::to_string(array.shape[i]);
  return line + " " + sha256 + "\n";
}

std::string ContentSha256(const std::map<std::string, std::string>& lines) {
  mocurate::Sha256 hasher;
  for (const auto& [path, line] : lines) {
    if (path != "/@content_sha256") hasher.Add(path).Add(line);
  }
  return hasher.Hex();
}

}  // namespace mocurate::store
