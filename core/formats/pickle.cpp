#include "core/formats/pickle.h"

#include <cmath>

#include "core/base/file.h"
#include "core/formats/array_elements.h"
#include "core/formats/pickle_machine.h"

namespace mocurate {
namespace {

bool IsNumber(PickleKind kind) {
  return kind == PickleKind::kBool || kind == PickleKind::kInteger || kind == PickleKind::kFloat;
}

double NumberOf(const PickleValue& value) {
  return value.kind == PickleKind::kFloat ? value.number : static_cast<double>(value.integer);
}

std::string KeyText(const PickleValue& key) {
  if (key.kind == PickleKind::kText) return std::string(key.text);
  if (key.kind == PickleKind::kInteger || key.kind == PickleKind::kBool) return std::to_string(key.integer);
  return std::string("(") + KindName(key.kind) + ")";
}

/// The name of the compression, by the file's magic bytes; null when it is not packed.
const char* Packing(std::string_view bytes) {
  if (bytes.substr(0, 2) == "\x1f\x8b") return "gzip";
  if (bytes.substr(0, 3) == "BZh") return "bzip2";
  if (bytes.substr(0, 2) == "ZF") return "the oldest compression of joblib";
  if (bytes.substr(0, 6) == std::string_view("\xFD"
                                             "7zXZ\0",
                                             6))
    return "xz";
  if (bytes.size() > 2 && bytes[0] == '\x78' && (static_cast<unsigned char>(bytes[1]) + 0x7800) % 31 == 0)
    return "zlib";
  return nullptr;
}

}  // namespace

const char* KindName(PickleKind kind) {
  constexpr const char* kNames[] = {"None",         "a truth value", "an integer",      "a number",
                                    "a text",       "bytes",         "a list",          "a tuple",
                                    "a dictionary", "an array",      "a sparse matrix", "a class",
                                    "a numpy type", "a storage",     "an object"};
  return kNames[static_cast<std::size_t>(kind)];
}

PickleRef Pickle::top() const { return PickleRef(*this, root, ""); }

tl::unexpected<Error> PickleRef::Bad(const std::string& rule) const {
  return Fail(ErrorCode::kMalformed, rule, pickle_->name + ":" + (path_.empty() ? "/" : path_));
}

std::size_t PickleRef::size() const {
  switch (kind()) {
    case PickleKind::kList:
    case PickleKind::kTuple:
      return value().children.size();
    case PickleKind::kDict:
      return value().children.size() / 2;
    default:
      return 0;
  }
}

PickleRef PickleRef::Item(std::size_t i) const {
  return PickleRef(*pickle_, value().children[i], path_ + "/" + std::to_string(i));
}

PickleRef PickleRef::KeyAt(std::size_t i) const { return PickleRef(*pickle_, value().children[2 * i], path_); }

PickleRef PickleRef::ValueAt(std::size_t i) const {
  return PickleRef(*pickle_, value().children[2 * i + 1], path_ + "/" + DisplayPath(KeyText(KeyAt(i).value())));
}

std::optional<PickleRef> PickleRef::Find(std::string_view key) const {
  if (kind() != PickleKind::kDict) return std::nullopt;
  for (std::size_t i = size(); i-- > 0;) {
    const PickleValue& name = KeyAt(i).value();
    if (name.kind == PickleKind::kText && name.text == key) return ValueAt(i);
  }
  return std::nullopt;
}

Expected<PickleRef> PickleRef::Key(std::string_view key) const {
  if (kind() != PickleKind::kDict) return Bad(std::string("a dictionary is expected, not ") + KindName(kind()));
  std::optional<PickleRef> found = Find(key);
  if (!found) return Bad("the key '" + std::string(key) + "' is missing");
  return std::move(*found);
}

Expected<double> PickleRef::Number() const {
  double number = 0.0;
  if (IsNumber(kind())) {
    number = NumberOf(value());
  } else if (kind() == PickleKind::kArray) {
    const Expected<NpyArray> array = Array();
    if (!array) return Forward(array);
    if (array->values.size() != 1) return Bad("a number is expected, not " + std::to_string(array->size()));
    number = array->values[0];
  } else {
    return Bad(std::string("a number is expected, not ") + KindName(kind()));
  }
  if (!std::isfinite(number)) return Bad("a finite number is expected");
  return number;
}

Expected<std::int64_t> PickleRef::Integer() const {
  if (kind() == PickleKind::kInteger || kind() == PickleKind::kBool) return value().integer;
  const Expected<double> number = Number();
  if (!number) return Forward(number);
  if (*number != std::floor(*number) || std::abs(*number) > 9e15) return Bad("a whole number is expected");
  return static_cast<std::int64_t>(*number);
}

Expected<std::string> PickleRef::Text() const {
  std::string text;
  if (kind() == PickleKind::kText || kind() == PickleKind::kBytes) {
    text = std::string(value().text);
  } else if (kind() == PickleKind::kArray) {
    const Expected<NpyArray> array = Array();
    if (!array) return Forward(array);
    if (array->texts.size() != 1) return Bad("one text is expected");
    text = array->texts[0];
  } else {
    return Bad(std::string("a text is expected, not ") + KindName(kind()));
  }
  if (FirstNotUtf8(text)) return Bad("a text that is not UTF-8");
  return text;
}

const PickleArray* PickleRef::Layout() const {
  return kind() == PickleKind::kArray ? &pickle_->arrays[static_cast<std::size_t>(value().array)] : nullptr;
}

Expected<NpyArray> PickleRef::ArrayEntry(std::size_t entry) const {
  const PickleArray* layout = Layout();
  const std::optional<ElementType> type = layout == nullptr ? std::nullopt : ParseElementType(layout->dtype);
  if (!type || !type->is_number() || layout->shape.empty() || entry >= layout->shape[0]) {
    return Bad("an array of numbers with an entry " + std::to_string(entry) + " is expected");
  }
  NpyArray array;
  array.dtype = layout->dtype;
  array.shape.assign(layout->shape.begin() + 1, layout->shape.end());
  if (layout->strides.empty()) {
    const std::size_t each = layout->data.size() / layout->shape[0];
    DecodeNumbers(*type, layout->data.substr(entry * each, each), array.values);
    return array;
  }
  const Expected<NpyArray> whole = Array();
  if (!whole) return whole;
  const std::size_t each = whole->values.size() / layout->shape[0];
  const auto first = whole->values.begin() + static_cast<std::ptrdiff_t>(entry * each);
  array.values.assign(first, first + static_cast<std::ptrdiff_t>(each));
  return array;
}

Expected<NpyArray> PickleRef::Array() const {
  NpyArray array;
  if (IsNumber(kind())) {
    array.dtype = kind() == PickleKind::kFloat ? "<f8" : kind() == PickleKind::kBool ? "|b1" : "<i8";
    array.values = {NumberOf(value())};
    return array;
  }
  const PickleArray* layout = Layout();
  if (layout == nullptr) return Bad(std::string("an array is expected, not ") + KindName(kind()));
  const std::optional<ElementType> type = ParseElementType(layout->dtype);
  if (!type || type->kind == ElementKind::kObject) return Bad("an array of numbers is expected, not of objects");
  array.shape = layout->shape;
  array.dtype = layout->dtype;
  std::string gathered;
  std::string_view data = layout->data;
  if (!layout->strides.empty()) {
    Expected<std::string> elements = GatherElements(*layout, pickle_->name + ":" + path_);
    if (!elements) return Forward(elements);
    gathered = std::move(*elements);
    data = gathered;
  }
  if (type->is_number()) {
    DecodeNumbers(*type, data, array.values);
    return array;
  }
  std::optional<std::vector<std::string>> texts = DecodeTexts(*type, data);
  if (!texts) return Bad("a text holds a character that is not valid Unicode");
  array.texts = std::move(*texts);
  if (type->bytes == 0) array.texts.resize(ElementCount(array.shape, 0, 0).value_or(0));
  return array;
}

Expected<SparseMatrix> PickleRef::Sparse() const {
  if (kind() != PickleKind::kSparse) return Bad(std::string("a sparse matrix is expected, not ") + KindName(kind()));
  std::vector<NpyArray> parts;
  constexpr const char* names[3] = {"data", "indices", "indptr"};
  for (std::size_t i = 0; i < 3; ++i) {
    const PickleRef part(*pickle_, value().children[i], path_ + "/" + names[i]);
    Expected<NpyArray> array = part.Array();
    if (!array) return Forward(array);
    if (array->shape.size() != 1 || !array->texts.empty()) return part.Bad("a row of numbers is expected");
    parts.push_back(std::move(*array));
  }
  const std::vector<std::size_t>& shape = pickle_->arrays[static_cast<std::size_t>(value().array)].shape;
  SparseMatrix matrix;
  matrix.rows = shape[0];
  matrix.columns = shape[1];
  matrix.value = std::move(parts[0].values);
  const std::size_t count = matrix.value.size();
  const auto whole = [&](std::size_t part, std::size_t i, std::size_t below) -> std::optional<std::size_t> {
    const double number = parts[part].values[i];
    if (!(number >= 0.0 && number < static_cast<double>(below) && number == std::floor(number))) return std::nullopt;
    return static_cast<std::size_t>(number);
  };
  const bool by_column = value().text == "csc";
  const std::size_t inner = by_column ? matrix.rows : matrix.columns;
  const std::size_t outer = by_column ? matrix.columns : matrix.rows;
  const auto bad = [&](std::size_t part, const std::string& rule) {
    return PickleRef(*pickle_, position_, path_ + "/" + names[part]).Bad(rule);
  };
  if (parts[1].values.size() != count) return bad(1, "one index per entry is expected");
  if (parts[2].values.size() != outer + 1) return bad(2, "one position per column (csc) or row (csr) is expected");
  std::vector<std::size_t> first, second(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<std::size_t> index = whole(1, i, inner);
    if (!index) return bad(1, "entry " + std::to_string(i) + " lies outside the matrix");
    first.push_back(*index);
  }
  std::size_t from = 0;
  for (std::size_t k = 0; k <= outer; ++k) {
    const std::optional<std::size_t> to = whole(2, k, count + 1);
    if (!to || *to < from || (k == 0 && *to != 0) || (k == outer && *to != count)) {
      return bad(2, "position " + std::to_string(k) + " does not follow the one before it");
    }
    for (std::size_t i = from; i < *to; ++i) second[i] = k - 1;
    from = *to;
  }
  matrix.row = std::move(by_column ? first : second);
  matrix.column = std::move(by_column ? second : first);
  return matrix;
}

Expected<Pickle> ParsePickle(std::string_view bytes, const std::string& name, const PickleLimits& limits) {
  if (bytes.empty()) return EmptyFile(name);
  if (const char* packing = Packing(bytes)) {
    return Fail(ErrorCode::kUnsupported, std::string("the file is packed (") + packing + ")", name,
                "unpack it, or write it with joblib.dump(..., compress=0)");
  }
  PickleMachine machine(bytes, name, limits, false);
  const Expected<int> root = machine.Read();
  if (!root) return Forward(root);
  if (Status checked = machine.Check(*root); !checked) return Forward(checked);
  machine.pickle().root = *root;
  return std::move(machine.pickle());
}

}  // namespace mocurate
