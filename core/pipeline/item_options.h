#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

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

}  // namespace mocurate
