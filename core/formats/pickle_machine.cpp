#include "core/formats/pickle_machine.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

namespace mocurate {

PickleMachine::PickleMachine(std::string_view bytes, const std::string& name, const PickleLimits& limits,
                             bool persistent)
    : bytes_(bytes), limits_(limits), persistent_(persistent) {
  pickle_.name = name;
}

Status PickleMachine::Push(PickleValue value) {
  if (static_cast<std::int64_t>(pickle_.values.size()) >= limits_.objects) {
    return Bad("more than " + std::to_string(limits_.objects) + " objects", ErrorCode::kUnsupported);
  }
  stack_.push_back(static_cast<int>(pickle_.values.size()));
  pickle_.values.push_back(std::move(value));
  return {};
}

Status PickleMachine::PushConstant(PickleValue value) {
  if (value.kind == PickleKind::kInteger && (value.integer < 0 || value.integer > 255)) return Push(std::move(value));
  const std::int64_t slot = value.kind == PickleKind::kNone   ? 0
                            : value.kind == PickleKind::kBool ? 1 + value.integer
                                                              : 3 + value.integer;
  int& known = constants_[static_cast<std::size_t>(slot)];
  if (known > 0) {
    stack_.push_back(known - 1);
    return {};
  }
  if (Status pushed = Push(std::move(value)); !pushed) return pushed;
  known = stack_.back() + 1;
  return {};
}

Status PickleMachine::Charge(std::size_t steps) {
  charged_ += static_cast<std::int64_t>(steps);
  if (charged_ > limits_.objects) return Bad("more operations than plain data needs", ErrorCode::kUnsupported);
  return {};
}

Expected<std::vector<int>> PickleMachine::PopToMark() {
  if (marks_.empty()) return Bad("a container ends that never began");
  const std::size_t begin = marks_.back();
  marks_.pop_back();
  std::vector<int> items(stack_.begin() + static_cast<std::ptrdiff_t>(begin), stack_.end());
  stack_.resize(begin);
  return items;
}

Status PickleMachine::Remember(std::uint64_t slot) {
  if (!Has(1)) return Bad("nothing to remember");
  if (slot >= bytes_.size()) return Bad("memo number " + std::to_string(slot) + " in a file that is shorter");
  if (slot >= memo_.size()) memo_.resize(static_cast<std::size_t>(slot) + 1, -1);
  if (memo_[slot] < 0) ++remembered_;
  memo_[slot] = stack_.back();
  return {};
}

Status PickleMachine::Recall(std::uint64_t slot) {
  if (slot >= memo_.size() || memo_[slot] < 0) {
    return Bad("object " + std::to_string(slot) + " is used before it is defined");
  }
  stack_.push_back(memo_[slot]);
  return {};
}

Status PickleMachine::StepMemo(unsigned char opcode) {
  if (opcode == 0x94) return Remember(remembered_);  // MEMOIZE
  const bool put = opcode == 'p' || opcode == 'q' || opcode == 'r';
  if (opcode == 'p' || opcode == 'g') {  // PUT, GET
    const Expected<std::string_view> line = TakeLine("a memo number");
    if (!line) return Forward(line);
    std::uint64_t slot = 0;
    const auto [stop, error] = std::from_chars(line->begin(), line->end(), slot);
    if (error != std::errc() || stop != line->end()) return Bad("a memo number that is not a whole number");
    return put ? Remember(slot) : Recall(slot);
  }
  const Expected<std::uint64_t> slot = TakeUnsigned(opcode == 'q' || opcode == 'h' ? 1 : 4);
  if (!slot) return Forward(slot);
  return put ? Remember(*slot) : Recall(*slot);
}

Status PickleMachine::StepContainer(unsigned char opcode) {
  PickleValue value;
  value.kind = PickleKind::kTuple;
  if (opcode == ')') return Push(std::move(value));
  if (opcode >= 0x85 && opcode <= 0x87) {  // TUPLE1 to TUPLE3
    const std::size_t count = opcode - 0x84u;
    if (!Has(count)) return Bad("a tuple of objects that are not there");
    value.children.assign(stack_.end() - static_cast<std::ptrdiff_t>(count), stack_.end());
    stack_.resize(stack_.size() - count);
    return Push(std::move(value));
  }
  std::vector<int> items;
  if (opcode == 'a' || opcode == 's') {  // APPEND, SETITEM
    const std::size_t count = opcode == 'a' ? 1 : 2;
    if (!Has(count + 1)) return Bad("an item for a container that is not there");
    items.assign(stack_.end() - static_cast<std::ptrdiff_t>(count), stack_.end());
    stack_.resize(stack_.size() - count);
  } else {
    Expected<std::vector<int>> popped = PopToMark();
    if (!popped) return Forward(popped);
    items = std::move(*popped);
  }
  if (opcode == 't' || opcode == 'l' || opcode == 'd') {  // TUPLE, LIST, DICT
    value.kind = opcode == 't' ? PickleKind::kTuple : opcode == 'l' ? PickleKind::kList : PickleKind::kDict;
    if (opcode == 'd' && items.size() % 2 != 0) return Bad("a dictionary with a key that has no value");
    value.children = std::move(items);
    return Push(std::move(value));
  }
  const PickleKind wanted = opcode == 's' || opcode == 'u' ? PickleKind::kDict : PickleKind::kList;
  if (!Has(1) || At(stack_.back()).kind != wanted || (wanted == PickleKind::kDict && items.size() % 2 != 0)) {
    return Bad("items for something that is not a container of them");
  }
  std::vector<int>& children = At(stack_.back()).children;
  children.insert(children.end(), items.begin(), items.end());
  return {};
}

Status PickleMachine::StepStack(unsigned char opcode) {
  switch (opcode) {
    case '(':
      marks_.push_back(stack_.size());
      return {};
    case '0':  // POP: a value, or the mark itself
      if (!marks_.empty() && marks_.back() == stack_.size()) {
        marks_.pop_back();
        return {};
      }
      if (!Has(1)) return Bad("nothing to drop");
      stack_.pop_back();
      return {};
    case '1': {
      const Expected<std::vector<int>> dropped = PopToMark();
      return dropped ? Status{} : Status(Forward(dropped));
    }
    case '2':
      if (!Has(1)) return Bad("nothing to duplicate");
      stack_.push_back(stack_.back());
      return {};
    case 0x80: {
      const Expected<std::uint64_t> protocol = TakeUnsigned(1);
      if (!protocol) return Forward(protocol);
      if (*protocol <= 5) return {};
      return Bad("pickle protocol " + std::to_string(*protocol) + "; known are 0 to 5", ErrorCode::kUnsupported);
    }
    default: {  // FRAME
      const Expected<std::uint64_t> size = TakeUnsigned(8);
      if (!size) return Forward(size);
      if (*size > left()) {
        return Bad("a frame announces " + std::to_string(*size) + " bytes, " + std::to_string(left()) + " are left");
      }
      return {};
    }
  }
}

Status PickleMachine::StepConstant(unsigned char opcode) {
  PickleValue value;
  if (opcode == 0x88 || opcode == 0x89) {
    value.kind = PickleKind::kBool;
    value.integer = opcode == 0x88;
  } else if (opcode != 'N') {
    value.kind = opcode == '}' ? PickleKind::kDict : PickleKind::kList;
    return Push(std::move(value));
  }
  return PushConstant(std::move(value));
}

Status PickleMachine::Step(unsigned char opcode) {
  using Work = Status (PickleMachine::*)(unsigned char);
  static const std::array<Work, 256> works = [] {
    std::array<Work, 256> all;
    all.fill(&PickleMachine::Unknown);
    const std::pair<std::string_view, Work> groups[] = {
        {"(012\x80\x95", &PickleMachine::StepStack},
        {"ILFJKMG\x8a\x8b", &PickleMachine::StepNumber},
        {"STUVXBC\x8c\x8d\x8e\x96", &PickleMachine::StepText},
        {")tldaesu\x85\x86\x87\x90", &PickleMachine::StepContainer},
        {"pqrghj\x94", &PickleMachine::StepMemo},
        {"cRbQ\x81\x92\x93", &PickleMachine::StepClass},
        {"N}]\x88\x89\x8f", &PickleMachine::StepConstant},
    };
    for (const auto& [opcodes, work] : groups) {
      for (const char one : opcodes) all[static_cast<unsigned char>(one)] = work;
    }
    return all;
  }();
  return (this->*works[opcode])(opcode);
}

Status PickleMachine::Unknown(unsigned char opcode) {
  struct Named {
    unsigned char opcode;
    const char* name;
  };
  static constexpr Named kNames[] = {{'i', "INST"},  {'o', "OBJ"},   {'P', "PERSID"},       {0x82, "EXT1"},
                                     {0x83, "EXT2"}, {0x84, "EXT4"}, {0x97, "NEXT_BUFFER"}, {0x98, "READONLY_BUFFER"}};
  char text[8];
  std::snprintf(text, sizeof(text), "0x%02x", opcode);
  std::string what = std::string("opcode ") + text;
  for (const Named& named : kNames) {
    if (named.opcode != opcode) continue;
    --position_;
    return Bad(what + " (" + named.name + ") is not allowed in plain data", ErrorCode::kUnsupported,
               Reason::kUnsafePickle);
  }
  --position_;
  return Bad(what + " is not allowed in plain data", ErrorCode::kUnsupported);
}

Expected<int> PickleMachine::Read() {
  stack_.clear();
  marks_.clear();
  memo_.clear();
  remembered_ = 0;
  std::string_view opcode;
  while (true) {
    if (!Take(1, &opcode)) return Bad("the file ends before its pickle");
    if (opcode[0] == '.') break;
    if (Status step = Step(static_cast<unsigned char>(opcode[0])); !step) return Forward(step);
  }
  if (!marks_.empty()) return Bad("a container is never ended");
  if (stack_.empty()) return Bad("a pickle without a result");
  return stack_.back();
}

Status PickleMachine::Check(int root) const {
  constexpr std::uint64_t kTooLarge = std::uint64_t{1} << 60;
  const std::uint64_t most = 32 * static_cast<std::uint64_t>(bytes_.size()) + (std::uint64_t{64} << 20);
  struct Seen {
    std::uint64_t size = 0;  // bytes when everything that is shared is written out
    int depth = 0;           // 0: not seen, -1: being visited
  };
  std::vector<Seen> seen(pickle_.values.size());
  std::vector<std::pair<int, std::size_t>> path{{root, 0}};
  while (!path.empty()) {
    const auto [position, next] = path.back();
    const PickleValue& value = pickle_.values[static_cast<std::size_t>(position)];
    Seen& mine = seen[static_cast<std::size_t>(position)];
    if (next == 0) mine.depth = -1;
    if (next < value.children.size()) {
      ++path.back().second;
      const int child = value.children[next];
      const Seen& other = seen[static_cast<std::size_t>(child)];
      if (other.depth < 0) return Bad("a container that holds itself", ErrorCode::kUnsupported);
      if (other.depth == 0) path.emplace_back(child, 0);
      continue;
    }
    if (value.kind == PickleKind::kObject) return Bad("an object without its state");
    mine.size = 64 + value.text.size();
    if (value.kind == PickleKind::kArray) {
      const PickleArray& array = pickle_.arrays[static_cast<std::size_t>(value.array)];
      if (array.dtype.empty()) return Bad("an array without its state");
      mine.size += 8 * array.data.size();
    }
    mine.depth = 1;
    for (const int child : value.children) {
      const Seen& other = seen[static_cast<std::size_t>(child)];
      mine.size = std::min(mine.size + other.size, kTooLarge);
      mine.depth = std::max(mine.depth, other.depth + 1);
    }
    if (mine.depth > limits_.depth) {
      return Bad("containers nested deeper than " + std::to_string(limits_.depth), ErrorCode::kUnsupported);
    }
    if (mine.size > most) return Bad("the same values are repeated too often", ErrorCode::kUnsupported);
    path.pop_back();
  }
  return {};
}

}  // namespace mocurate
