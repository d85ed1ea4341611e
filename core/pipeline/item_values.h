#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/wire.h"

namespace mocurate {

/// Options of one item: those of its stage, which copies share, and its own, which precede them. A run holds 100,000
/// items, and the options of a source are some 20 KB.
class ItemOptions {
 public:
  ItemOptions() : ItemOptions(nlohmann::json::object()) {}
  ItemOptions(nlohmann::json::initializer_list_t shared) : ItemOptions(nlohmann::json(shared)) {}
  ItemOptions(nlohmann::json shared) {
    std::string text = CanonicalText(shared);
    shared_ = std::make_shared<const Shared>(Shared{std::move(shared), std::move(text)});
  }

  /// Sets an option of this item alone.
  void Set(const std::string& name, nlohmann::json value) { own_[name] = std::move(value); }

  bool contains(const std::string& name) const { return own_.contains(name) || shared_->options.contains(name); }
  const nlohmann::json& at(const std::string& name) const {
    const auto own = own_.find(name);
    return own != own_.end() ? *own : shared_->options.at(name);
  }
  template <class T>
  T value(const std::string& name, const T& otherwise) const {
    return contains(name) ? at(name).get<T>() : otherwise;
  }

  /// All of them, in one object.
  nlohmann::json Whole() const {
    nlohmann::json whole = shared_->options;
    whole.update(own_);
    return whole;
  }

  /// CanonicalText of all of them.
  std::string Text() const { return own_.empty() ? shared_->text : CanonicalText(Whole()); }

 private:
  struct Shared {
    nlohmann::json options;
    std::string text;
  };
  std::shared_ptr<const Shared> shared_;
  nlohmann::json own_ = nlohmann::json::object();
};

inline bool operator==(const ItemOptions& a, const ItemOptions& b) { return a.Whole() == b.Whole(); }

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
