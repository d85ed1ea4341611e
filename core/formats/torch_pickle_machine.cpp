#include <cstdio>
#include <cstring>

#include "core/formats/torch_pickle_reader.h"

namespace mocurate::torch_pickle {
namespace {

constexpr Element kElements[] = {
    {"torch FloatStorage", "float32", 4}, {"torch DoubleStorage", "float64", 8}, {"torch LongStorage", "int64", 8},
    {"torch IntStorage", "int32", 4},     {"torch ShortStorage", "int16", 2},    {"torch CharStorage", "int8", 1},
    {"torch ByteStorage", "uint8", 1},
};

}  // namespace

const Element* FindElement(const std::string& class_name) {
  for (const Element& element : kElements) {
    if (class_name == element.class_name) return &element;
  }
  return nullptr;
}

Status Reader::PushText(int length_bytes) {
  const Expected<std::uint64_t> length = TakeUnsigned(length_bytes);
  if (!length) return Forward(length);
  const char* data = nullptr;
  if (!Take(static_cast<std::size_t>(*length), &data)) return Bad("the file ends inside a text");
  Object object;
  object.kind = Kind::kText;
  object.text.assign(data, static_cast<std::size_t>(*length));
  return Push(std::move(object));
}

Status Reader::Global() {
  const std::size_t first = bytes_.find('\n', position_);
  const std::size_t second = first == std::string_view::npos ? first : bytes_.find('\n', first + 1);
  if (second == std::string_view::npos || second - position_ > 1000) return Bad("a class name does not end");
  Object object;
  object.kind = Kind::kGlobal;
  object.text = std::string(bytes_.substr(position_, first - position_)) + " " +
                std::string(bytes_.substr(first + 1, second - first - 1));
  const bool known = object.text == "collections OrderedDict" || object.text == "torch._utils _rebuild_tensor_v2" ||
                     FindElement(object.text) != nullptr;
  if (!known) {
    return Fail(ErrorCode::kUnsupported, "the file names '" + object.text + "', which is no plain data",
                name_ + ": byte " + std::to_string(position_),
                "save a state_dict of tensors; nothing else is read, and nothing of the file is ever executed");
  }
  position_ = second + 1;
  return Push(std::move(object));
}

Status Reader::RebuildTensor(int arguments) {
  const std::vector<int> items = objects_[arguments].children;
  if (items.size() < 4) return Bad("a tensor with fewer than 4 facts");
  const Object& offset = objects_[items[1]];
  const Object& shape = objects_[items[2]];
  const Object& stride = objects_[items[3]];
  if (objects_[items[0]].kind != Kind::kStorage || offset.kind != Kind::kInteger || shape.kind != Kind::kTuple ||
      stride.kind != Kind::kTuple || shape.children.size() != stride.children.size()) {
    return Bad("the facts of a tensor are not storage, offset, shape, stride");
  }
  Object tensor;
  tensor.kind = Kind::kTensor;
  tensor.storage = items[0];
  tensor.offset = offset.integer;
  for (std::size_t i = 0; i < shape.children.size(); ++i) {
    const Object& size = objects_[shape.children[i]];
    const Object& step = objects_[stride.children[i]];
    if (size.kind != Kind::kInteger || step.kind != Kind::kInteger || size.integer < 0 || step.integer < 0) {
      return Bad("a tensor's shape or stride is not made of non-negative integers");
    }
    tensor.shape.push_back(size.integer);
    tensor.stride.push_back(step.integer);
  }
  return Push(std::move(tensor));
}

Status Reader::Reduce() {
  if (!Has(2)) return Bad("a call without function or arguments");
  const int arguments = stack_.back();
  stack_.pop_back();
  const int function = stack_.back();
  stack_.pop_back();
  if (objects_[function].kind != Kind::kGlobal || objects_[arguments].kind != Kind::kTuple) {
    return Bad("a call of something that is no class name");
  }
  const std::string& name = objects_[function].text;
  if (name == "torch._utils _rebuild_tensor_v2") return RebuildTensor(arguments);
  if (name != "collections OrderedDict") return Bad("'" + name + "' is called");
  Object dict;
  dict.kind = Kind::kDict;
  if (!objects_[arguments].children.empty()) return Bad("an OrderedDict made from arguments", ErrorCode::kUnsupported);
  return Push(std::move(dict));
}

Status Reader::PersistentId() {
  if (!Has(1)) return Bad("a storage without facts");
  const int id = stack_.back();
  stack_.pop_back();
  const std::vector<int> items = objects_[id].children;
  if (objects_[id].kind != Kind::kTuple || items.size() < 5 || objects_[items[0]].text != "storage" ||
      objects_[items[1]].kind != Kind::kGlobal || objects_[items[2]].kind != Kind::kText ||
      objects_[items[4]].kind != Kind::kInteger || objects_[items[4]].integer < 0) {
    return Bad("the facts of a storage are not class, key, device, size");
  }
  if (items.size() > 5 && objects_[items[5]].kind != Kind::kNone) {
    return Bad("a storage that is a view of another one", ErrorCode::kUnsupported);
  }
  Object storage;
  storage.kind = Kind::kStorage;
  storage.element = FindElement(objects_[items[1]].text);
  storage.text = objects_[items[2]].text;
  storage.offset = objects_[items[4]].integer;
  if (storage.element == nullptr) return Bad("'" + objects_[items[1]].text + "' is no storage");
  const auto known = storage_of_key_.find(storage.text);
  if (known != storage_of_key_.end()) {
    const Object& first = objects_[known->second];
    if (first.element != storage.element || first.offset != storage.offset) {
      return Bad("storage '" + storage.text + "' is described in two ways");
    }
    stack_.push_back(known->second);
    return {};
  }
  const std::string key = storage.text;
  if (Status pushed = Push(std::move(storage)); !pushed) return pushed;
  storage_of_key_[key] = stack_.back();
  return {};
}

Status Reader::StepNumber(unsigned char opcode) {
  Object object;
  object.kind = Kind::kInteger;
  if (opcode == 0x8a) {  // LONG1
    const Expected<std::uint64_t> count = TakeUnsigned(1);
    if (!count) return Forward(count);
    if (*count > 8) return Bad("an integer of " + std::to_string(*count) + " bytes", ErrorCode::kUnsupported);
    const Expected<std::uint64_t> value = TakeUnsigned(static_cast<int>(*count));
    if (!value) return Forward(value);
    std::uint64_t bits = *value;
    if (*count > 0 && *count < 8 && (bits >> (8 * *count - 1)) != 0) bits |= ~std::uint64_t{0} << (8 * *count);
    object.integer = static_cast<std::int64_t>(bits);
  } else if (opcode == 'G') {  // BINFLOAT, big-endian
    const char* data = nullptr;
    if (!Take(8, &data)) return Bad("the file ends inside a number");
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = (bits << 8) | static_cast<unsigned char>(data[i]);
    object.kind = Kind::kFloat;
    std::memcpy(&object.number, &bits, 8);
  } else {
    const int count = opcode == 'K' ? 1 : opcode == 'M' ? 2 : 4;
    const Expected<std::uint64_t> value = TakeUnsigned(count);
    if (!value) return Forward(value);
    object.integer =
        count == 4 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(*value)) : static_cast<std::int64_t>(*value);
  }
  return Push(std::move(object));
}

Status Reader::StepContainer(unsigned char opcode) {
  Object object;
  object.kind = Kind::kTuple;
  if (opcode == ')') return Push(std::move(object));
  if (opcode >= 0x85 && opcode <= 0x87) {
    const std::size_t count = opcode - 0x84u;
    if (!Has(count)) return Bad("a tuple of objects that are not there");
    object.children.assign(stack_.end() - static_cast<std::ptrdiff_t>(count), stack_.end());
    stack_.resize(stack_.size() - count);
    return Push(std::move(object));
  }
  std::vector<int> items;
  if (opcode == 'a' || opcode == 's') {
    const std::size_t count = opcode == 'a' ? 1 : 2;
    if (!Has(count + 1)) return Bad("an item for a container that is not there");
    items.assign(stack_.end() - static_cast<std::ptrdiff_t>(count), stack_.end());
    stack_.resize(stack_.size() - count);
  } else {
    Expected<std::vector<int>> popped = PopToMark();
    if (!popped) return Forward(popped);
    items = std::move(*popped);
  }
  if (opcode == 't') {
    object.children = std::move(items);
    return Push(std::move(object));
  }
  const bool dict = opcode == 's' || opcode == 'u';
  if (!Has(1) || objects_[stack_.back()].kind != (dict ? Kind::kDict : Kind::kList) ||
      (dict && items.size() % 2 != 0)) {
    return Bad("items for something that is no container of them");
  }
  std::vector<int>& children = objects_[stack_.back()].children;
  children.insert(children.end(), items.begin(), items.end());
  return {};
}

Status Reader::Step(unsigned char opcode) {
  Object object;
  switch (opcode) {
    case 'J':
    case 'K':
    case 'M':
    case 'G':
    case 0x8a:
      return StepNumber(opcode);
    case ')':
    case 't':
    case 'a':
    case 'e':
    case 's':
    case 'u':
    case 0x85:
    case 0x86:
    case 0x87:
      return StepContainer(opcode);
    case 'X':
    case 'T':
      return PushText(4);
    case 'U':
      return PushText(1);
    case 'c':
      return Global();
    case 'R':
      return Reduce();
    case 'Q':
      return PersistentId();
    case '(':
      marks_.push_back(stack_.size());
      return {};
    case 'N':
      return Push(std::move(object));
    case 0x88:
    case 0x89:
      object.kind = Kind::kBool;
      object.integer = opcode == 0x88;
      return Push(std::move(object));
    case '}':
      object.kind = Kind::kDict;
      return Push(std::move(object));
    case ']':
      object.kind = Kind::kList;
      return Push(std::move(object));
    case 'b':  // attributes of a dictionary (_metadata of a state_dict): not data
      if (!Has(2) || objects_[stack_[stack_.size() - 2]].kind != Kind::kDict) return Bad("attributes of no dictionary");
      stack_.pop_back();
      return {};
    case 'q':
    case 'r': {
      const Expected<std::uint64_t> slot = TakeUnsigned(opcode == 'q' ? 1 : 4);
      if (!slot) return Forward(slot);
      if (!Has(1)) return Bad("nothing to remember");
      memo_[*slot] = stack_.back();
      return {};
    }
    case 'h':
    case 'j': {
      const Expected<std::uint64_t> slot = TakeUnsigned(opcode == 'h' ? 1 : 4);
      if (!slot) return Forward(slot);
      const auto found = memo_.find(*slot);
      if (found == memo_.end()) return Bad("object " + std::to_string(*slot) + " is used before it is defined");
      if (static_cast<std::int64_t>(stack_.size()) >= limits_.objects) return Bad("too many objects");
      stack_.push_back(found->second);
      return {};
    }
    default:
      break;
  }
  char text[8];
  std::snprintf(text, sizeof(text), "0x%02x", opcode);
  return Bad(std::string("opcode ") + text + " is not among those of a state_dict", ErrorCode::kUnsupported);
}

Expected<int> Reader::ReadPickle() {
  stack_.clear();
  marks_.clear();
  memo_.clear();
  const char* data = nullptr;
  if (!Take(2, &data) || data[0] != '\x80' || data[1] != 2) return Bad("no pickle of protocol 2 begins here");
  while (true) {
    if (!Take(1, &data)) return Bad("the file ends before its pickle");
    if (*data == '.') break;
    if (Status step = Step(static_cast<unsigned char>(*data)); !step) return Forward(step);
  }
  if (stack_.empty()) return Bad("a pickle without a result");
  return stack_.back();
}

}  // namespace mocurate::torch_pickle
