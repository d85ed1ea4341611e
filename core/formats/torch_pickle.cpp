#include "core/formats/torch_pickle.h"

#include <cstring>

#include "core/base/file.h"
#include "core/formats/torch_pickle_reader.h"

namespace mocurate {
namespace torch_pickle {
namespace {

template <class T>
double Decode(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double DecodeElement(const Element& element, const char* bytes) {
  const std::string_view name = element.name;
  if (name == "float32") return Decode<float>(bytes);
  if (name == "float64") return Decode<double>(bytes);
  if (name == "int64") return Decode<std::int64_t>(bytes);
  if (name == "int32") return Decode<std::int32_t>(bytes);
  if (name == "int16") return Decode<std::int16_t>(bytes);
  if (name == "int8") return Decode<std::int8_t>(bytes);
  return Decode<std::uint8_t>(bytes);
}

}  // namespace

Status Reader::ReadStorages(int keys) {
  if (objects_[keys].kind != Kind::kList) return Bad("the list of storages is no list");
  for (const int key : objects_[keys].children) {
    const auto found = storage_of_key_.find(objects_[key].text);
    if (objects_[key].kind != Kind::kText || found == storage_of_key_.end()) {
      return Bad("storage '" + objects_[key].text + "' belongs to no tensor");
    }
    const Object& storage = objects_[found->second];
    const Expected<std::uint64_t> count = TakeUnsigned(8);
    if (!count) return Forward(count);
    const std::uint64_t bytes_left = bytes_.size() - position_;
    if (*count != static_cast<std::uint64_t>(storage.offset) || *count > bytes_left / storage.element->bytes) {
      return Bad("storage '" + storage.text + "' announces " + std::to_string(*count) + " numbers, " +
                 std::to_string(storage.offset) + " are expected and " + std::to_string(bytes_left) + " bytes left");
    }
    const std::size_t size = static_cast<std::size_t>(*count) * storage.element->bytes;
    storage_bytes_[storage.text] = bytes_.substr(position_, size);
    position_ += size;
  }
  return {};
}

Status Reader::CollectTensor(const Object& tensor, const std::string& path, TorchTable& table) {
  const Object& storage = objects_[tensor.storage];
  const auto bytes = storage_bytes_.find(storage.text);
  if (bytes == storage_bytes_.end()) return Bad("tensor '" + path + "' has no stored numbers");
  std::int64_t count = 1;
  std::int64_t last = tensor.offset;
  for (std::size_t i = 0; i < tensor.shape.size(); ++i) {
    if (tensor.shape[i] == 0) count = 0;
    if (count == 0) break;
    if (count > limits_.elements / tensor.shape[i]) return Bad("tensor '" + path + "' is larger than allowed");
    count *= tensor.shape[i];
    if (tensor.shape[i] > 1 && tensor.stride[i] > (storage.offset + 1) / (tensor.shape[i] - 1))
      last = storage.offset;
    else
      last += (tensor.shape[i] - 1) * tensor.stride[i];
    if (last < 0 || last >= storage.offset) return Bad("tensor '" + path + "' reaches outside its storage");
  }
  if (tensor.offset < 0 || (count > 0 && last >= storage.offset)) {
    return Bad("tensor '" + path + "' reaches outside its storage");
  }
  elements_ += count;
  if (elements_ > limits_.elements) return Bad("more numbers than allowed", ErrorCode::kUnsupported);
  TorchTensor result{path, storage.element->name, tensor.shape, {}};
  result.values.reserve(static_cast<std::size_t>(count));
  std::vector<std::int64_t> index(tensor.shape.size(), 0);
  std::int64_t at = tensor.offset;
  for (std::int64_t k = 0; k < count; ++k) {
    result.values.push_back(DecodeElement(*storage.element, bytes->second.data() + at * storage.element->bytes));
    for (int axis = static_cast<int>(index.size()) - 1; axis >= 0; --axis) {
      at += tensor.stride[axis];
      if (++index[axis] < tensor.shape[axis]) break;
      at -= tensor.stride[axis] * tensor.shape[axis];
      index[axis] = 0;
    }
  }
  table.tensors.push_back(std::move(result));
  return {};
}

Status Reader::Collect(int id, const std::string& path, int depth, TorchTable& table) {
  if (depth > limits_.depth) return Bad("containers nested deeper than " + std::to_string(limits_.depth));
  characters_ += static_cast<std::int64_t>(path.size());
  if (++visited_ > limits_.objects || characters_ > limits_.characters)
    return Bad("more objects than allowed", ErrorCode::kUnsupported);
  const Object& object = objects_[id];
  const std::string prefix = path.empty() ? "" : path + "/";
  switch (object.kind) {
    case Kind::kTensor:
      return CollectTensor(object, path, table);
    case Kind::kBool:
    case Kind::kInteger:
      table.numbers[path] = static_cast<double>(object.integer);
      return {};
    case Kind::kFloat:
      table.numbers[path] = object.number;
      return {};
    case Kind::kText:
      characters_ += static_cast<std::int64_t>(object.text.size());
      table.texts[path] = object.text;
      return {};
    case Kind::kTuple:
    case Kind::kList:
      for (std::size_t i = 0; i < object.children.size(); ++i) {
        if (Status s = Collect(object.children[i], prefix + std::to_string(i), depth + 1, table); !s) return s;
      }
      return {};
    case Kind::kDict:
      for (std::size_t i = 0; i + 1 < object.children.size(); i += 2) {
        const Object& key = objects_[object.children[i]];
        if (key.kind != Kind::kText && key.kind != Kind::kInteger) return Bad("a key that is no text and no integer");
        const std::string name = key.kind == Kind::kText ? key.text : std::to_string(key.integer);
        if (Status s = Collect(object.children[i + 1], prefix + name, depth + 1, table); !s) return s;
      }
      return {};
    default:
      return {};
  }
}

Expected<TorchTable> Reader::Read() {
  static constexpr char kMagic[] = "\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e";
  constexpr std::size_t kMagicSize = sizeof(kMagic) - 1;
  if (bytes_.substr(0, 2) == "PK") {
    return Fail(ErrorCode::kUnsupported, "a zip file of torch.save; only the older form is read", name_,
                "write it with torch.save(..., _use_new_zipfile_serialization=False)");
  }
  if (bytes_.substr(0, kMagicSize) != std::string_view(kMagic, kMagicSize)) return Bad("no file of torch.save");
  position_ = kMagicSize;
  const Expected<int> version = ReadPickle();
  if (!version) return Forward(version);
  if (objects_[*version].integer != 1001) return Bad("protocol is not 1001", ErrorCode::kUnsupported);
  const Expected<int> system = ReadPickle();
  if (!system) return Forward(system);
  TorchTable facts;
  if (Status s = Collect(*system, "", 0, facts); !s) return Forward(s);
  if (facts.numbers["little_endian"] != 1.0) return Bad("numbers are not little-endian", ErrorCode::kUnsupported);
  const Expected<int> top = ReadPickle();
  if (!top) return Forward(top);
  const Expected<int> keys = ReadPickle();
  if (!keys) return Forward(keys);
  if (Status s = ReadStorages(*keys); !s) return Forward(s);
  TorchTable table;
  if (Status s = Collect(*top, "", 0, table); !s) return Forward(s);
  return table;
}

}  // namespace torch_pickle

const TorchTensor* TorchTable::Find(std::string_view name) const {
  for (const TorchTensor& tensor : tensors) {
    if (tensor.name == name) return &tensor;
  }
  return nullptr;
}

Expected<TorchTable> ParseTorchPickle(std::string_view bytes, const std::string& name, const TorchLimits& limits) {
  return torch_pickle::Reader(bytes, name, limits).Read();
}

Expected<TorchTable> ReadTorchPickle(const std::filesystem::path& path, const TorchLimits& limits) {
  const Expected<std::string> bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  return ParseTorchPickle(*bytes, DisplayPath(path), limits);
}

}  // namespace mocurate
