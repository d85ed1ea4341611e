#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mocurate {

/// A value to keep, in memory of just its size.
inline std::vector<std::uint8_t> Packed(const nlohmann::json& value) {
  const std::vector<std::uint8_t> packed = nlohmann::json::to_cbor(value);
  return {packed.begin(), packed.end()};
}

/// Figures about an item: an object of JSON that is kept packed, which copies share. A run holds some 100,000 of them;
/// as trees they take several times the memory. Each access unpacks it.
class ItemSummary {
 public:
  ItemSummary() = default;  ///< an empty object
  ItemSummary(const nlohmann::json& object)
      : packed_(std::make_shared<const std::vector<std::uint8_t>>(Packed(object))) {}
  ItemSummary(nlohmann::json::initializer_list_t object) : ItemSummary(nlohmann::json(object)) {}

  nlohmann::json Unpacked() const {
    return packed_ == nullptr ? nlohmann::json::object() : nlohmann::json::from_cbor(*packed_);
  }
  bool contains(const std::string& name) const { return Unpacked().contains(name); }
  nlohmann::json at(const std::string& name) const { return Unpacked().at(name); }
  template <class T>
  T value(const std::string& name, const T& otherwise) const {
    return Unpacked().value(name, otherwise);
  }
  void Set(const std::string& name, nlohmann::json value) {
    nlohmann::json object = Unpacked();
    object[name] = std::move(value);
    *this = object;
  }

 private:
  std::shared_ptr<const std::vector<std::uint8_t>> packed_;
};

inline void to_json(nlohmann::json& json, const ItemSummary& summary) { json = summary.Unpacked(); }
inline bool operator==(const ItemSummary& a, const ItemSummary& b) { return a.Unpacked() == b.Unpacked(); }

}  // namespace mocurate
