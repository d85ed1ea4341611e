#include "core/formats/torch_pickle.h"

#include <algorithm>
#include <deque>
#include <unordered_map>
#include <utility>

#include "core/base/file.h"
#include "core/formats/pickle_machine.h"
#include "core/formats/zip_archive.h"

namespace mocurate {
namespace {

const char* ElementName(std::string_view dtype) {
  static constexpr std::pair<const char*, const char*> kNames[] = {
      {"f2", "float16"}, {"f4", "float32"}, {"f8", "float64"}, {"i8", "int64"},  {"i4", "int32"},  {"i2", "int16"},
      {"i1", "int8"},    {"u1", "uint8"},   {"u2", "uint16"},  {"u4", "uint32"}, {"u8", "uint64"}, {"b1", "bool"}};
  for (const auto& [letters, name] : kNames) {
    if (dtype.substr(1) == letters) return name;
  }
  return "";
}

/// What becomes of the values that the stack machine read.
class TorchReader {
 public:
  TorchReader(std::string_view bytes, const std::string& name, const TorchLimits& limits)
      : bytes_(bytes), name_(name), limits_(limits) {
    // Tensors may share numbers, or repeat them.
    limits_.elements =
        std::min(limits.elements, static_cast<std::int64_t>(MostUnpacked(bytes.size()) / sizeof(double)));
  }

  Expected<TorchTable> ReadLegacy();
  Expected<TorchTable> ReadZip();

 private:
  PickleMachine Machine(std::string_view bytes, const std::string& name) const {
    PickleLimits limits;
    limits.objects = limits_.objects;
    limits.depth = limits_.depth;
    return PickleMachine(bytes, name, limits, true);
  }
  Status ReadStorages(PickleMachine& machine, int keys);
  Status Collect(PickleMachine& machine, int value, const std::string& path, int depth, TorchTable& table);
  Status CollectArray(PickleMachine& machine, const PickleValue& value, const std::string& path, TorchTable& table);

  std::string_view bytes_;
  const std::string& name_;
  TorchLimits limits_;
  std::int64_t elements_ = 0;
  std::int64_t visited_ = 0;
  std::int64_t characters_ = 0;  // of all names and texts of the table
};

Status TorchReader::ReadStorages(PickleMachine& machine, int keys) {
  if (machine.At(keys).kind != PickleKind::kList) return machine.Bad("the value for storages is not a list");
  for (const int key : machine.At(keys).children) {
    const PickleValue& text = machine.At(key);
    const int position = text.kind == PickleKind::kText ? machine.FindStorage(text.text) : -1;
    if (position < 0)
      return machine.Bad("storage '" + DisplayPath(std::string(text.text)) + "' is not part of any tensor");
    PickleStorage& storage = machine.storages()[static_cast<std::size_t>(position)];
    const Expected<std::uint64_t> count = machine.TakeUnsigned(8);
    if (!count) return Forward(count);
    const std::size_t each = ParseElementType(storage.dtype)->bytes;
    if (*count != storage.count || *count > machine.left() / each) {
      return machine.Bad("storage '" + storage.key + "' announces " + std::to_string(*count) + " numbers, " +
                         std::to_string(storage.count) + " are expected and " + std::to_string(machine.left()) +
                         " bytes left");
    }
    machine.Take(static_cast<std::size_t>(*count) * each, &storage.data);
    storage.has_data = true;
  }
  return {};
}

Status TorchReader::CollectArray(PickleMachine& machine, const PickleValue& value, const std::string& path,
                                 TorchTable& table) {
  PickleArray array = machine.pickle().arrays[static_cast<std::size_t>(value.array)];
  if (array.storage >= 0) {
    const PickleStorage& storage = machine.storages()[static_cast<std::size_t>(array.storage)];
    if (!storage.has_data) return machine.Bad("tensor '" + path + "' has no stored numbers");
    array.data = storage.data;
  }
  const std::optional<ElementType> type = ParseElementType(array.dtype);
  if (!type || !type->is_number()) return machine.Bad("array '" + path + "' holds no numbers", ErrorCode::kUnsupported);
  const bool empty = std::find(array.shape.begin(), array.shape.end(), std::size_t{0}) != array.shape.end();
  std::int64_t count = empty ? 0 : 1;
  for (std::size_t axis = 0; axis < array.shape.size() && !empty; ++axis) {
    const auto extent = static_cast<std::int64_t>(array.shape[axis]);
    if (count > limits_.elements / extent) return machine.Bad("tensor '" + path + "' is larger than allowed");
    count *= extent;
  }
  elements_ += count;
  if (elements_ > limits_.elements) return machine.Bad("more numbers than allowed", ErrorCode::kUnsupported);
  // A tensor without axes has no strides, but may be anywhere in its storage.
  if (array.storage >= 0 && array.strides.empty()) {
    const std::size_t stored = array.data.size() / type->bytes;
    if (array.offset >= stored) return machine.Bad("tensor '" + path + "' reaches outside its storage");
    array.data = array.data.substr(array.offset * type->bytes, type->bytes);
  }
  const Expected<std::string> gathered = GatherElements(array, name_ + ": " + path);
  if (!gathered) return Forward(gathered);
  TorchTensor result{path, ElementName(array.dtype), {array.shape.begin(), array.shape.end()}, {}};
  DecodeNumbers(*type, *gathered, result.values);
  table.tensors.push_back(std::move(result));
  return {};
}

Status TorchReader::Collect(PickleMachine& machine, int position, const std::string& path, int depth,
                            TorchTable& table) {
  if (depth > limits_.depth) return machine.Bad("containers nested deeper than " + std::to_string(limits_.depth));
  characters_ += static_cast<std::int64_t>(path.size());
  if (++visited_ > limits_.objects || characters_ > limits_.characters) {
    return machine.Bad("more objects than allowed", ErrorCode::kUnsupported);
  }
  const PickleValue& value = machine.At(position);
  const std::string prefix = path.empty() ? "" : path + "/";
  switch (value.kind) {
    case PickleKind::kArray:
      return CollectArray(machine, value, path, table);
    case PickleKind::kBool:
    case PickleKind::kInteger:
      table.numbers[path] = static_cast<double>(value.integer);
      return {};
    case PickleKind::kFloat:
      table.numbers[path] = value.number;
      return {};
    case PickleKind::kText:
      characters_ += static_cast<std::int64_t>(value.text.size());
      table.texts[path] = std::string(value.text);
      return {};
    case PickleKind::kTuple:
    case PickleKind::kList:
      for (std::size_t i = 0; i < value.children.size(); ++i) {
        if (Status s = Collect(machine, value.children[i], prefix + std::to_string(i), depth + 1, table); !s) return s;
      }
      return {};
    case PickleKind::kDict:
      for (std::size_t i = 0; i + 1 < value.children.size(); i += 2) {
        const PickleValue& key = machine.At(value.children[i]);
        if (key.kind != PickleKind::kText && key.kind != PickleKind::kInteger) {
          return machine.Bad("a key that is neither a text nor an integer");
        }
        const std::string name = key.kind == PickleKind::kText ? std::string(key.text) : std::to_string(key.integer);
        if (Status s = Collect(machine, value.children[i + 1], prefix + name, depth + 1, table); !s) return s;
      }
      return {};
    default:
      return {};
  }
}

Expected<TorchTable> TorchReader::ReadLegacy() {
  static constexpr char kMagic[] = "\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e";
  constexpr std::size_t kMagicSize = sizeof(kMagic) - 1;
  PickleMachine machine = Machine(bytes_, name_);
  if (bytes_.substr(0, kMagicSize) != std::string_view(kMagic, kMagicSize)) return machine.Bad("no file of torch.save");
  machine.SkipTo(kMagicSize);
  const Expected<int> version = machine.Read();
  if (!version) return Forward(version);
  if (machine.At(*version).integer != 1001) return machine.Bad("protocol is not 1001", ErrorCode::kUnsupported);
  const Expected<int> system = machine.Read();
  if (!system) return Forward(system);
  TorchTable facts;
  if (Status s = Collect(machine, *system, "", 0, facts); !s) return Forward(s);
  if (facts.numbers["little_endian"] != 1.0)
    return machine.Bad("numbers are not little-endian", ErrorCode::kUnsupported);
  const Expected<int> top = machine.Read();
  if (!top) return Forward(top);
  const Expected<int> keys = machine.Read();
  if (!keys) return Forward(keys);
  if (Status s = ReadStorages(machine, *keys); !s) return Forward(s);
  TorchTable table;
  if (Status s = Collect(machine, *top, "", 0, table); !s) return Forward(s);
  return table;
}

Expected<TorchTable> TorchReader::ReadZip() {
  static constexpr std::string_view kTop = "data.pkl";
  ZipLimits limits;
  limits.bytes = static_cast<std::size_t>(limits_.elements) * 8;
  Expected<ZipArchive> archive = ZipArchive::Open(bytes_, name_, limits);
  if (!archive) return Forward(archive);
  const std::vector<std::string>& members = archive->members();
  std::unordered_map<std::string_view, std::size_t> places;  // the first of a name
  for (std::size_t i = 0; i < members.size(); ++i) places.emplace(members[i], i);
  const auto find = [&](const std::string& member) {
    const auto found = places.find(member);
    return found == places.end() ? members.size() : found->second;
  };
  const auto top = std::find_if(members.begin(), members.end(), [](const std::string& member) {
    return member == kTop ||
           (member.size() > kTop.size() && member.substr(member.size() - kTop.size() - 1) == "/" + std::string(kTop));
  });
  if (top == members.end()) {
    return Fail(ErrorCode::kMalformed, "the archive holds no data.pkl", name_, "it is not a file of torch.save");
  }
  const std::string folder = top->substr(0, top->size() - kTop.size());
  if (const std::size_t order = find(folder + "byteorder"); order < members.size()) {
    const Expected<std::string> text = archive->Read(order);
    if (!text) return Forward(text);
    if (*text != "little") {
      return Fail(ErrorCode::kUnsupported, "numbers are not little-endian", name_ + ":" + folder + "byteorder");
    }
  }
  const Expected<std::string> pickle = archive->Read(static_cast<std::size_t>(top - members.begin()));
  if (!pickle) return Forward(pickle);
  PickleMachine machine = Machine(*pickle, name_ + ":" + *top);
  const Expected<int> root = machine.Read();
  if (!root) return Forward(root);
  std::deque<std::string> contents;
  for (PickleStorage& storage : machine.storages()) {
    const std::string member = folder + "data/" + storage.key;
    const std::size_t index = find(member);
    if (index == members.size()) {
      return Fail(ErrorCode::kMalformed, "the archive does not have the numbers '" + member + "'", name_);
    }
    Expected<std::string> content = archive->Read(index);
    if (!content) return Forward(content);
    const std::size_t each = ParseElementType(storage.dtype)->bytes;
    if (content->size() / each < storage.count || content->size() % each != 0) {
      return Fail(ErrorCode::kMalformed,
                  std::to_string(storage.count) + " numbers of " + std::to_string(each) + " bytes are expected, not " +
                      std::to_string(content->size()) + " bytes",
                  name_ + ":" + member);
    }
    contents.push_back(std::move(*content));
    storage.data = std::string_view(contents.back()).substr(0, storage.count * each);
    storage.has_data = true;
  }
  TorchTable table;
  if (Status s = Collect(machine, *root, "", 0, table); !s) return Forward(s);
  return table;
}

}  // namespace

const TorchTensor* TorchTable::Find(std::string_view name) const {
  for (const TorchTensor& tensor : tensors) {
    if (tensor.name == name) return &tensor;
  }
  return nullptr;
}

Expected<TorchTable> ParseTorchPickle(std::string_view bytes, const std::string& name, const TorchLimits& limits) {
  TorchReader reader(bytes, name, limits);
  return bytes.substr(0, 2) == "PK" ? reader.ReadZip() : reader.ReadLegacy();
}

Expected<TorchTable> ReadTorchPickle(const std::filesystem::path& path, const TorchLimits& limits) {
  const Expected<std::string> bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  return ParseTorchPickle(*bytes, DisplayPath(path), limits);
}

}  // namespace mocurate
