#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace mocurate {

/// Options of one item: those of its stage, which copies share, and its own, which precede them. A run holds 100,000
/// items, and the options of a source are some 20 KB.
class ItemOptions {
 public:
  ItemOptions() : ItemOptions(nlohmann::json::object()) {}
  ItemOptions(nlohmann::json::initializer_list_t shared) : ItemOptions(nlohmann::json(shared)) {}
  ItemOptions(nlohmann::json shared) : shared_(std::make_shared<const nlohmann::json>(std::move(shared))) {}

  /// Sets an option of this item alone.
  void Set(const std::string& name, nlohmann::json value) { own_[name] = std::move(value); }

  bool contains(const std::string& name) const { return own_.contains(name) || shared_->contains(name); }
  const nlohmann::json& at(const std::string& name) const {
    const auto own = own_.find(name);
    return own != own_.end() ? *own : shared_->at(name);
  }
  template <class T>
  T value(const std::string& name, const T& otherwise) const {
    return contains(name) ? at(name).get<T>() : otherwise;
  }

  /// All of them, in one object.
  nlohmann::json Whole() const {
    nlohmann::json whole = *shared_;
    whole.update(own_);
    return whole;
  }

 private:
  std::shared_ptr<const nlohmann::json> shared_;
  nlohmann::json own_ = nlohmann::json::object();
};

inline bool operator==(const ItemOptions& a, const ItemOptions& b) { return a.Whole() == b.Whole(); }

}  // namespace mocurate
