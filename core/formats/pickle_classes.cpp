// The class names that a pickle may hold, and what becomes of them. Nothing else is ever made, and nothing is called.

#include "core/base/file.h"
#include "core/formats/pickle_machine.h"

namespace mocurate {
namespace {

constexpr PickleClassName kClasses[] = {
    {"collections OrderedDict", PickleClass::kOrderedDict, nullptr},
    {"numpy.core.multiarray _reconstruct", PickleClass::kReconstruct, nullptr},
    {"numpy._core.multiarray _reconstruct", PickleClass::kReconstruct, nullptr},
    {"numpy ndarray", PickleClass::kNdarray, nullptr},
    {"numpy dtype", PickleClass::kDtype, nullptr},
    {"numpy.core.multiarray scalar", PickleClass::kScalar, nullptr},
    {"numpy._core.multiarray scalar", PickleClass::kScalar, nullptr},
    {"numpy.core.numeric _frombuffer", PickleClass::kFromBuffer, nullptr},
    {"numpy._core.numeric _frombuffer", PickleClass::kFromBuffer, nullptr},
    {"_codecs encode", PickleClass::kEncode, nullptr},
    {"__builtin__ bytes", PickleClass::kBytes, nullptr},
    {"builtins bytes", PickleClass::kBytes, nullptr},
    {"__builtin__ bytearray", PickleClass::kBytes, nullptr},
    {"builtins bytearray", PickleClass::kBytes, nullptr},
    {"__builtin__ set", PickleClass::kSet, nullptr},
    {"builtins set", PickleClass::kSet, nullptr},
    {"__builtin__ object", PickleClass::kObject, nullptr},
    {"builtins object", PickleClass::kObject, nullptr},
    {"copy_reg _reconstructor", PickleClass::kReconstructor, nullptr},
    {"copyreg _reconstructor", PickleClass::kReconstructor, nullptr},
    {"scipy.sparse.csc csc_matrix", PickleClass::kCsc, nullptr},
    {"scipy.sparse._csc csc_matrix", PickleClass::kCsc, nullptr},
    {"scipy.sparse._csc csc_array", PickleClass::kCsc, nullptr},
    {"scipy.sparse._arrays csc_array", PickleClass::kCsc, nullptr},
    {"scipy.sparse.csr csr_matrix", PickleClass::kCsr, nullptr},
    {"scipy.sparse._csr csr_matrix", PickleClass::kCsr, nullptr},
    {"scipy.sparse._csr csr_array", PickleClass::kCsr, nullptr},
    {"scipy.sparse._arrays csr_array", PickleClass::kCsr, nullptr},
    {"chumpy.ch Ch", PickleClass::kCh, nullptr},
    {"chumpy Ch", PickleClass::kCh, nullptr},
    {"chumpy.reordering Select", PickleClass::kChSelect, nullptr},
    {"joblib.numpy_pickle NumpyArrayWrapper", PickleClass::kJoblibArray, nullptr},
    {"torch._utils _rebuild_tensor_v2", PickleClass::kTensor, nullptr},
    {"torch._utils _rebuild_parameter", PickleClass::kParameter, nullptr},
    {"torch DoubleStorage", PickleClass::kStorage, "<f8"},
    {"torch FloatStorage", PickleClass::kStorage, "<f4"},
    {"torch HalfStorage", PickleClass::kStorage, "<f2"},
    {"torch LongStorage", PickleClass::kStorage, "<i8"},
    {"torch IntStorage", PickleClass::kStorage, "<i4"},
    {"torch ShortStorage", PickleClass::kStorage, "<i2"},
    {"torch CharStorage", PickleClass::kStorage, "|i1"},
    {"torch ByteStorage", PickleClass::kStorage, "|u1"},
    {"torch BoolStorage", PickleClass::kStorage, "|b1"},
};

PickleClass MeaningOf(const PickleValue& value) { return kClasses[value.integer].meaning; }

}  // namespace

const PickleClassName* FindPickleClass(const std::string& name) {
  for (const PickleClassName& known : kClasses) {
    if (name == known.name) return &known;
  }
  return nullptr;
}

std::optional<Error> ForeignClassIn(std::string_view bytes, const std::string& name) {
  const Expected<int> read = PickleMachine(bytes, name, PickleLimits(), true).Read();
  return !read && read.error().reason == Reason::kUnsafePickle ? std::optional<Error>(read.error()) : std::nullopt;
}

Status PickleMachine::PushClass(const std::string& name) {
  const PickleClassName* known = FindPickleClass(name);
  if (known == nullptr) {
    return Fail(
        ErrorCode::kUnsupported, "the file names '" + DisplayPath(name) + "', which is not plain data",
        pickle_.name + ": byte " + std::to_string(position_),
        "save arrays, lists and dictionaries alone; nothing else is read, and nothing of a file is ever executed",
        Reason::kUnsafePickle);
  }
  PickleValue value;
  value.kind = PickleKind::kClass;
  value.text = known->name;
  value.integer = known - kClasses;
  return Push(std::move(value));
}

Status PickleMachine::StepClass(unsigned char opcode) {
  switch (opcode) {
    case 'c': {  // GLOBAL
      const Expected<std::string_view> module = TakeLine("a class name");
      if (!module) return Forward(module);
      const Expected<std::string_view> name = TakeLine("a class name");
      if (!name) return Forward(name);
      if (module->size() + name->size() > 1000) return Bad("a class name does not end");
      return PushClass(std::string(*module) + " " + std::string(*name));
    }
    case 0x93: {  // STACK_GLOBAL
      if (!Has(2)) return Bad("a class without its name");
      const PickleValue& name = At(Pop());
      const PickleValue& module = At(Pop());
      if (name.kind != PickleKind::kText || module.kind != PickleKind::kText ||
          name.text.size() + module.text.size() > 1000) {
        return Bad("a class whose name is not a text");
      }
      return PushClass(std::string(module.text) + " " + std::string(name.text));
    }
    case 'R':
      return Reduce();
    case 'b':
      return Build();
    case 'Q':
      return PersistentId();
    default:  // NEWOBJ, NEWOBJ_EX
      return NewObject(opcode == 0x92);
  }
}

Status PickleMachine::Reduce() {
  if (!Has(2)) return Bad("a call without function or arguments");
  const PickleValue& arguments = At(Pop());
  const PickleValue& function = At(Pop());
  if (function.kind != PickleKind::kClass || arguments.kind != PickleKind::kTuple) {
    return Bad("a call of something that is not a class name");
  }
  const std::vector<int>& items = arguments.children;
  switch (MeaningOf(function)) {
    case PickleClass::kOrderedDict:
      return OrderedDict(items);
    case PickleClass::kReconstruct: {
      if (items.size() != 3 || At(items[0]).kind != PickleKind::kClass ||
          MeaningOf(At(items[0])) != PickleClass::kNdarray) {
        return Bad("an array that is not made of numpy.ndarray", ErrorCode::kUnsupported);
      }
      return Push(NewArray());
    }
    case PickleClass::kDtype:
      return Dtype(items);
    case PickleClass::kScalar:
      return Scalar(items);
    case PickleClass::kFromBuffer:
      return FromBuffer(items);
    case PickleClass::kEncode:
      return Encode(items);
    case PickleClass::kBytes:
      if (items.empty()) return PushText(PickleKind::kBytes, {});
      if (items.size() == 1 && At(items[0]).kind == PickleKind::kBytes) {
        return PushText(PickleKind::kBytes, At(items[0]).text);
      }
      return Encode(items);
    case PickleClass::kSet:
      if (items.size() != 1 || At(items[0]).kind != PickleKind::kList) return Bad("a set that is not made of a list");
      stack_.push_back(items[0]);
      return {};
    case PickleClass::kReconstructor:
      if (items.size() != 3 || At(items[0]).kind != PickleKind::kClass || At(items[1]).kind != PickleKind::kClass ||
          MeaningOf(At(items[1])) != PickleClass::kObject) {
        return Bad("an object that is not made of a class and 'object'", ErrorCode::kUnsupported);
      }
      return MakeObject(items[0]);
    case PickleClass::kTensor:
      return Tensor(items);
    case PickleClass::kParameter:
      if (items.empty() || At(items[0]).kind != PickleKind::kArray) return Bad("a parameter without its tensor");
      stack_.push_back(items[0]);
      return {};
    default:
      return Bad("'" + std::string(function.text) + "' is called", ErrorCode::kUnsupported);
  }
}

Status PickleMachine::OrderedDict(const std::vector<int>& arguments) {
  PickleValue dict;
  dict.kind = PickleKind::kDict;
  if (arguments.size() > 1 || (arguments.size() == 1 && At(arguments[0]).kind != PickleKind::kList)) {
    return Bad("an OrderedDict that is not made of pairs", ErrorCode::kUnsupported);
  }
  if (arguments.size() == 1) {
    for (const int pair : At(arguments[0]).children) {
      const std::vector<int>& items = At(pair).children;
      const PickleKind kind = At(pair).kind;
      if ((kind != PickleKind::kList && kind != PickleKind::kTuple) || items.size() != 2) {
        return Bad("an OrderedDict that is not made of pairs");
      }
      if (Status charged = Charge(1); !charged) return charged;
      dict.children.insert(dict.children.end(), items.begin(), items.end());
    }
  }
  return Push(std::move(dict));
}

Status PickleMachine::Encode(const std::vector<int>& arguments) {
  if (arguments.size() != 2 || At(arguments[0]).kind != PickleKind::kText ||
      At(arguments[1]).kind != PickleKind::kText) {
    return Bad("bytes that are not made of a text and its encoding");
  }
  const std::string_view encoding = At(arguments[1]).text;
  if (encoding != "latin1" && encoding != "latin-1" && encoding != "iso-8859-1") {
    return Bad("bytes in the encoding '" + DisplayPath(std::string(encoding.substr(0, 40))) + "'",
               ErrorCode::kUnsupported);
  }
  const std::string_view text = At(arguments[0]).text;
  std::string bytes;
  bytes.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto lead = static_cast<unsigned char>(text[i]);
    if (lead < 0x80) {
      bytes += text[i];
    } else if (lead <= 0xC3 && i + 1 < text.size()) {  // valid UTF-8: C2 or C3 and one byte more
      bytes += static_cast<char>(((lead & 3u) << 6) | (static_cast<unsigned char>(text[++i]) & 0x3Fu));
    } else {
      return Bad("a text with a character outside latin1");
    }
  }
  const Expected<std::string_view> owned = Own(std::move(bytes));
  if (!owned) return Forward(owned);
  return PushText(PickleKind::kBytes, *owned);
}

Status PickleMachine::MakeObject(int type) {
  const PickleClass meaning = MeaningOf(At(type));
  const bool known = meaning == PickleClass::kCsc || meaning == PickleClass::kCsr || meaning == PickleClass::kCh ||
                     meaning == PickleClass::kChSelect || meaning == PickleClass::kJoblibArray;
  if (!known) return Bad("an object of '" + std::string(At(type).text) + "'", ErrorCode::kUnsupported);
  PickleValue object;
  object.kind = PickleKind::kObject;
  object.integer = At(type).integer;
  return Push(std::move(object));
}

Status PickleMachine::NewObject(bool with_keywords) {
  if (!Has(with_keywords ? 3 : 2)) return Bad("an object without class or arguments");
  if (with_keywords) {
    const PickleValue& keywords = At(Pop());
    if (keywords.kind != PickleKind::kDict || !keywords.children.empty()) {
      return Bad("an object that is made with named arguments", ErrorCode::kUnsupported);
    }
  }
  const PickleValue& arguments = At(Pop());
  const int type = Pop();
  if (At(type).kind != PickleKind::kClass || arguments.kind != PickleKind::kTuple)
    return Bad("an object without a class");
  if (MeaningOf(At(type)) == PickleClass::kOrderedDict) return OrderedDict(arguments.children);
  // numpy and chumpy make their objects without arguments; joblib's wrapper too.
  if (!arguments.children.empty()) return Bad("an object that is made with arguments", ErrorCode::kUnsupported);
  return MakeObject(type);
}

Status PickleMachine::Build() {
  if (!Has(2)) return Bad("a state without its object");
  const int state = Pop();
  PickleValue& object = At(stack_.back());
  switch (object.kind) {
    case PickleKind::kDict:  // attributes of an OrderedDict (_metadata of a state_dict): not data
      return {};
    case PickleKind::kDtype:
    case PickleKind::kArray:
      if (At(state).kind != PickleKind::kTuple) return Bad("a state that is not a tuple");
      return object.kind == PickleKind::kDtype ? BuildDtype(object, At(state).children)
                                               : BuildArray(object, At(state).children);
    case PickleKind::kObject:
      return BuildObject(stack_.back(), state);
    default:
      return Bad(std::string("a state for ") + KindName(object.kind));
  }
}

Status PickleMachine::BuildObject(int position, int state_position) {
  PickleValue& object = At(position);
  const PickleValue& state = At(state_position);
  const PickleClassName& type = kClasses[object.integer];
  if (state.kind != PickleKind::kDict) return Bad(std::string("the state of '") + type.name + "' is not a dictionary");
  switch (type.meaning) {
    case PickleClass::kCh: {
      const Expected<int> x = Attribute(state, "x");
      if (!x) return Forward(x);
      if (*x < 0 || At(*x).kind != PickleKind::kArray) return Bad("a chumpy array without its numbers 'x'");
      object = At(*x);
      return {};
    }
    case PickleClass::kChSelect:
      return BuildSelect(object, state);
    case PickleClass::kJoblibArray:
      return ReadJoblibArray(object, state);
    default:
      return BuildSparse(object, type.meaning, state);
  }
}

Status PickleMachine::PersistentId() {
  if (!persistent_) return Bad("opcode 0x51 (BINPERSID) outside a PyTorch file", ErrorCode::kUnsupported);
  if (!Has(1)) return Bad("a storage without arguments");
  const PickleValue& id = At(Pop());
  const std::vector<int>& items = id.children;
  if (id.kind != PickleKind::kTuple || items.size() < 5 || At(items[0]).text != "storage" ||
      At(items[1]).kind != PickleKind::kClass || At(items[2]).kind != PickleKind::kText ||
      At(items[2]).text.size() > 1000 || At(items[4]).kind != PickleKind::kInteger || At(items[4]).integer < 0) {
    return Bad("the arguments of a storage are not class, key, device, size");
  }
  if (items.size() > 5 && At(items[5]).kind != PickleKind::kNone) {
    return Bad("a storage that is a view of another one", ErrorCode::kUnsupported);
  }
  const PickleClassName& type = kClasses[At(items[1]).integer];
  if (type.dtype == nullptr) return Bad(std::string("'") + type.name + "' is not a storage");
  PickleStorage storage;
  storage.key = std::string(At(items[2]).text);
  storage.dtype = type.dtype;
  storage.count = static_cast<std::size_t>(At(items[4]).integer);
  PickleValue value;
  value.kind = PickleKind::kStorage;
  const int known = FindStorage(storage.key);
  if (known >= 0) {
    const PickleStorage& first = storages_[static_cast<std::size_t>(known)];
    if (first.dtype != storage.dtype || first.count != storage.count) {
      return Bad("storage '" + storage.key + "' is described in two ways");
    }
    value.integer = known;
    return Push(std::move(value));
  }
  value.integer = static_cast<std::int64_t>(storages_.size());
  storage_of_key_[storage.key] = static_cast<int>(storages_.size());
  storages_.push_back(std::move(storage));
  return Push(std::move(value));
}

int PickleMachine::FindStorage(std::string_view key) const {
  const auto found = storage_of_key_.find(key);
  return found == storage_of_key_.end() ? -1 : found->second;
}

}  // namespace mocurate
