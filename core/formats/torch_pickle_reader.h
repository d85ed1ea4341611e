#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/formats/torch_pickle.h"

namespace mocurate::torch_pickle {

enum class Kind { kNone, kBool, kInteger, kFloat, kText, kTuple, kList, kDict, kGlobal, kStorage, kTensor };

struct Element {
  const char* class_name;
  const char* name;
  int bytes;
};

/// Storage class by its full name ("torch FloatStorage"); null for any other.
const Element* FindElement(const std::string& class_name);

// Objects live in one array and refer to each other by position: cycles and deep nesting cost nothing to destroy.
struct Object {
  Kind kind = Kind::kNone;
  std::int64_t integer = 0;
  double number = 0.0;
  std::string text;           // text, class name, storage key
  std::vector<int> children;  // items; key, value, key, value, ... of a dictionary
  int storage = -1;           // of a tensor
  std::int64_t offset = 0;    // of a tensor, elements; number of elements of a storage
  std::vector<std::int64_t> shape;
  std::vector<std::int64_t> stride;
  const Element* element = nullptr;  // of a storage
};

/// The stack machine (torch_pickle_machine.cpp) and what becomes of its result (torch_pickle.cpp).
class Reader {
 public:
  Reader(std::string_view bytes, std::string name, const TorchLimits& limits)
      : bytes_(bytes), name_(std::move(name)), limits_(limits) {}

  Expected<TorchTable> Read();

 private:
  Expected<int> ReadPickle();
  Status Step(unsigned char opcode);
  Status StepNumber(unsigned char opcode);
  Status StepContainer(unsigned char opcode);
  Status Global();
  Status Reduce();
  Status RebuildTensor(int arguments);
  Status PersistentId();
  Status ReadStorages(int keys);
  Status Collect(int object, const std::string& path, int depth, TorchTable& table);
  Status CollectTensor(const Object& tensor, const std::string& path, TorchTable& table);

  tl::unexpected<Error> Bad(const std::string& what, ErrorCode code = ErrorCode::kMalformed) const {
    return Fail(code, what, name_ + ": byte " + std::to_string(position_));
  }
  bool Take(std::size_t count, const char** data) {
    if (count > bytes_.size() - position_) return false;
    *data = bytes_.data() + position_;
    position_ += count;
    return true;
  }
  /// Little-endian unsigned number of `count` <= 8 bytes.
  Expected<std::uint64_t> TakeUnsigned(int count) {
    const char* data = nullptr;
    if (!Take(static_cast<std::size_t>(count), &data)) return Bad("the file ends inside a number");
    std::uint64_t value = 0;
    for (int i = count - 1; i >= 0; --i) value = (value << 8) | static_cast<unsigned char>(data[i]);
    return value;
  }
  Status PushText(int length_bytes);
  Status Push(Object object) {
    if (static_cast<std::int64_t>(objects_.size()) >= limits_.objects) {
      return Bad("more than " + std::to_string(limits_.objects) + " objects", ErrorCode::kUnsupported);
    }
    stack_.push_back(static_cast<int>(objects_.size()));
    objects_.push_back(std::move(object));
    return {};
  }
  /// Objects above the last mark; the mark goes.
  Expected<std::vector<int>> PopToMark() {
    if (marks_.empty()) return Bad("a container ends that never began");
    const std::size_t begin = marks_.back();
    marks_.pop_back();
    std::vector<int> items(stack_.begin() + static_cast<std::ptrdiff_t>(begin), stack_.end());
    stack_.resize(begin);
    return items;
  }
  /// Whether `count` objects lie above the last mark.
  bool Has(std::size_t count) const { return stack_.size() - (marks_.empty() ? 0 : marks_.back()) >= count; }

  std::string_view bytes_;
  std::size_t position_ = 0;
  std::string name_;
  TorchLimits limits_;
  std::vector<Object> objects_;
  std::vector<int> stack_;
  std::vector<std::size_t> marks_;
  std::map<std::uint64_t, int> memo_;
  std::map<std::string, int> storage_of_key_;
  std::map<std::string, std::string_view> storage_bytes_;
  std::int64_t elements_ = 0;
  std::int64_t visited_ = 0;
  std::int64_t characters_ = 0;  // of all names and texts of the table
};

}  // namespace mocurate::torch_pickle
