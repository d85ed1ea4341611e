// Arrays of the pickle machine: numpy, scipy.sparse, chumpy, joblib, tensors.

#include <algorithm>
#include <limits>

#include "core/base/file.h"
#include "core/formats/pickle_machine.h"

namespace mocurate {
namespace {

constexpr std::size_t kMaxExtent = std::size_t{1} << 40;

std::vector<std::size_t> FortranStrides(const std::vector<std::size_t>& shape) {
  std::vector<std::size_t> strides(shape.size(), 1);
  for (std::size_t axis = 1; axis < shape.size(); ++axis) {
    strides[axis] = strides[axis - 1] * std::max<std::size_t>(shape[axis - 1], 1);
  }
  return strides;
}

bool IsBytes(const PickleValue& value) { return value.kind == PickleKind::kBytes || value.kind == PickleKind::kText; }

}  // namespace

Expected<std::vector<std::size_t>> PickleMachine::Shape(int tuple, const char* what) {
  const PickleValue& value = At(tuple);
  std::vector<std::size_t> shape;
  if (value.kind == PickleKind::kInteger && value.integer >= 0) {
    shape.push_back(static_cast<std::size_t>(value.integer));
    return shape;
  }
  if ((value.kind != PickleKind::kTuple && value.kind != PickleKind::kList) || value.children.size() > 32) {
    return Bad(std::string(what) + " is not a tuple of sizes");
  }
  for (const int child : value.children) {
    const PickleValue& extent = At(child);
    if (extent.kind != PickleKind::kInteger || extent.integer < 0 ||
        static_cast<std::uint64_t>(extent.integer) > kMaxExtent) {
      return Bad(std::string(what) + " is not made of sizes");
    }
    shape.push_back(static_cast<std::size_t>(extent.integer));
  }
  return shape;
}

Expected<int> PickleMachine::Attribute(const PickleValue& dict, std::string_view key) {
  if (Status charged = Charge(dict.children.size() / 16); !charged) return Forward(charged);
  for (std::size_t i = dict.children.size() / 2; i-- > 0;) {
    const PickleValue& name = At(dict.children[2 * i]);
    if (name.kind == PickleKind::kText && name.text == key) return dict.children[2 * i + 1];
  }
  return -1;
}

PickleValue PickleMachine::NewArray(PickleArray array) {
  PickleValue value;
  value.kind = PickleKind::kArray;
  value.array = static_cast<int>(pickle_.arrays.size());
  pickle_.arrays.push_back(std::move(array));
  return value;
}

Status PickleMachine::Dtype(const std::vector<int>& arguments) {
  if (arguments.empty() || !IsBytes(At(arguments[0])) || At(arguments[0]).text.size() > 20) {
    return Bad("a numpy type has no name");
  }
  const std::string_view text = At(arguments[0]).text;
  const std::optional<ElementType> type = ParseElementType(text);
  if (!type) {
    return Bad("arrays of the type '" + DisplayPath(std::string(text)) + "'; read are numbers, texts and lists",
               ErrorCode::kUnsupported);
  }
  const bool has_order = std::string_view("<>=|").find(text[0]) != std::string_view::npos;
  const Expected<std::string_view> owned = Own((has_order ? "" : "<") + std::string(text));
  if (!owned) return Forward(owned);
  PickleValue value;
  value.kind = PickleKind::kDtype;
  value.text = *owned;
  return Push(std::move(value));
}

Status PickleMachine::BuildDtype(PickleValue& dtype, const std::vector<int>& state) {
  if (state.size() < 5 || !IsBytes(At(state[1])) || At(state[1]).text.size() != 1 ||
      std::string_view("<>=|").find(At(state[1]).text[0]) == std::string_view::npos) {
    return Bad("the byte order of a numpy type is not one of < > = |");
  }
  for (std::size_t i = 2; i < 5; ++i) {
    if (At(state[i]).kind != PickleKind::kNone)
      return Bad("arrays of records are not supported", ErrorCode::kUnsupported);
  }
  const char order = At(state[1]).text[0];
  const Expected<std::string_view> owned =
      Own(std::string(1, order == '=' ? '<' : order) + std::string(dtype.text.substr(1)));
  if (!owned) return Forward(owned);
  dtype.text = *owned;
  return {};
}

Status PickleMachine::BuildArray(PickleValue& array, const std::vector<int>& state) {
  // (version, shape, type, Fortran order, elements); the oldest files have no version.
  if (state.size() != 5 && state.size() != 4) return Bad("the state of an array is not a tuple of 5");
  const std::size_t first = state.size() - 4;
  const PickleValue& fortran = At(state[first + 2]);
  if (fortran.kind != PickleKind::kBool && fortran.kind != PickleKind::kInteger) {
    return Bad("the order of an array is neither true nor false");
  }
  if (!pickle_.arrays[static_cast<std::size_t>(array.array)].dtype.empty()) return Bad("an array has two states");
  return FillArray(array, state[first], state[first + 1], fortran.integer != 0, state[first + 3]);
}

Status PickleMachine::FillArray(PickleValue& array, int shape, int dtype, bool fortran, int data) {
  if (At(dtype).kind != PickleKind::kDtype) return Bad("an array has no numpy type");
  Expected<std::vector<std::size_t>> extents = Shape(shape, "the shape of an array");
  if (!extents) return Forward(extents);
  const std::optional<ElementType> type = ParseElementType(At(dtype).text);
  if (!type) return Bad("an array has an unknown type", ErrorCode::kUnsupported);
  PickleArray& target = pickle_.arrays[static_cast<std::size_t>(array.array)];
  const bool objects = type->kind == ElementKind::kObject;
  if (objects ? At(data).kind != PickleKind::kList : !IsBytes(At(data))) {
    return Bad(std::string("the elements of an array are ") + KindName(At(data).kind));
  }
  const std::size_t stored = objects ? At(data).children.size() : At(data).text.size();
  if (!ElementCount(*extents, objects ? 1 : type->bytes, stored)) {
    return Bad("the shape " + ShapeText(*extents) + " of an array contradicts its " + std::to_string(stored) +
               (objects ? " items" : " bytes"));
  }
  target.dtype = std::string(At(dtype).text);
  target.shape = std::move(*extents);
  if (fortran) target.strides = FortranStrides(target.shape);
  if (objects) {
    target.dtype = "|O";
    array.children = {data};
  } else {
    target.data = At(data).text;
  }
  return {};
}

Status PickleMachine::Scalar(const std::vector<int>& arguments) {
  if (arguments.size() != 2 || At(arguments[0]).kind != PickleKind::kDtype || !IsBytes(At(arguments[1]))) {
    return Bad("a numpy number has no type or no bytes");
  }
  const std::optional<ElementType> type = ParseElementType(At(arguments[0]).text);
  const std::string_view data = At(arguments[1]).text;
  if (!type || type->bytes != data.size() || type->kind == ElementKind::kObject) {
    return Bad("a numpy number of type '" + std::string(At(arguments[0]).text) + "' in " + std::to_string(data.size()) +
               " bytes");
  }
  if (!type->is_number()) {
    std::optional<std::vector<std::string>> texts = DecodeTexts(*type, data);
    if (!texts || texts->size() != 1) return Bad("a numpy text is malformed");
    const Expected<std::string_view> owned = Own(std::move(texts->front()));
    if (!owned) return Forward(owned);
    return type->kind == ElementKind::kText ? PushText(PickleKind::kText, *owned) : PushBytes(*owned);
  }
  std::vector<double> numbers;
  DecodeNumbers(*type, data, numbers);
  PickleValue value;
  const bool exact = type->kind != ElementKind::kReal && numbers[0] >= -9.2e18 && numbers[0] <= 9.2e18;
  value.kind = type->kind == ElementKind::kBool ? PickleKind::kBool : exact ? PickleKind::kInteger : PickleKind::kFloat;
  value.number = numbers[0];
  if (exact) value.integer = static_cast<std::int64_t>(numbers[0]);
  return Push(std::move(value));
}

Status PickleMachine::FromBuffer(const std::vector<int>& arguments) {
  if (arguments.size() != 4 || At(arguments[3]).kind != PickleKind::kText ||
      (At(arguments[3]).text != "C" && At(arguments[3]).text != "F")) {
    return Bad("an array from a buffer lacks bytes, type, shape or order");
  }
  PickleValue array = NewArray();
  if (Status filled = FillArray(array, arguments[2], arguments[1], At(arguments[3]).text == "F", arguments[0]);
      !filled) {
    return filled;
  }
  return Push(std::move(array));
}

Status PickleMachine::Tensor(const std::vector<int>& arguments) {
  if (arguments.size() < 4) return Bad("a tensor has fewer than 4 arguments");
  const PickleValue& storage = At(arguments[0]);
  const PickleValue& offset = At(arguments[1]);
  if (storage.kind != PickleKind::kStorage || offset.kind != PickleKind::kInteger || offset.integer < 0) {
    return Bad("the arguments of a tensor are not storage, offset, shape, stride");
  }
  Expected<std::vector<std::size_t>> shape = Shape(arguments[2], "a tensor's shape");
  if (!shape) return Forward(shape);
  Expected<std::vector<std::size_t>> strides = Shape(arguments[3], "a tensor's stride");
  if (!strides) return Forward(strides);
  if (shape->size() != strides->size()) return Bad("a tensor has another number of sizes than of strides");
  PickleArray array;
  array.storage = static_cast<int>(storage.integer);
  array.dtype = storages_[static_cast<std::size_t>(storage.integer)].dtype;
  array.shape = std::move(*shape);
  array.strides = std::move(*strides);
  array.offset = static_cast<std::size_t>(offset.integer);
  return Push(NewArray(std::move(array)));
}

Status PickleMachine::BuildSparse(PickleValue& object, PickleClass type, const PickleValue& state) {
  Expected<int> shape = Attribute(state, "_shape");
  if (shape && *shape < 0) shape = Attribute(state, "shape");
  if (!shape) return Forward(shape);
  if (*shape < 0) return Bad("a sparse matrix has no '_shape'");
  Expected<std::vector<std::size_t>> extents = Shape(*shape, "the shape of a sparse matrix");
  if (!extents) return Forward(extents);
  if (extents->size() != 2) return Bad("a sparse matrix does not have two axes", ErrorCode::kUnsupported);
  std::vector<int> parts;
  for (const char* key : {"data", "indices", "indptr"}) {
    const Expected<int> part = Attribute(state, key);
    if (!part) return Forward(part);
    if (*part < 0 || At(*part).kind != PickleKind::kArray) {
      return Bad(std::string("a sparse matrix has no '") + key + "'");
    }
    parts.push_back(*part);
  }
  PickleArray layout;
  layout.shape = std::move(*extents);
  object = NewArray(std::move(layout));
  object.kind = PickleKind::kSparse;
  object.text = type == PickleClass::kCsc ? "csc" : "csr";
  object.children = parts;
  return {};
}

/// A choice of elements of another chumpy array: a.ravel()[idxs].reshape(preferred_shape).
Status PickleMachine::BuildSelect(PickleValue& object, const PickleValue& state) {
  int parts[3] = {-1, -1, -1};
  const char* const keys[3] = {"a", "idxs", "preferred_shape"};
  for (std::size_t i = 0; i < 3; ++i) {
    const Expected<int> part = Attribute(state, keys[i]);
    if (!part) return Forward(part);
    if (*part < 0 || (i < 2 && At(*part).kind != PickleKind::kArray)) {
      return Bad(std::string("a chumpy selection has no '") + keys[i] + "'");
    }
    parts[i] = *part;
  }
  Expected<std::vector<std::size_t>> shape = Shape(parts[2], "the shape of a chumpy selection");
  if (!shape) return Forward(shape);
  const PickleArray& whole = pickle_.arrays[static_cast<std::size_t>(At(parts[0]).array)];
  const PickleArray& chosen = pickle_.arrays[static_cast<std::size_t>(At(parts[1]).array)];
  const std::optional<ElementType> type = ParseElementType(whole.dtype);
  const std::optional<ElementType> index_type = ParseElementType(chosen.dtype);
  if (!type || !type->is_number() || !index_type || index_type->bytes == 0 || !index_type->is_number() ||
      whole.storage >= 0 || !whole.strides.empty() || !chosen.strides.empty()) {
    return Bad("a chumpy selection selects from other values than plain arrays", ErrorCode::kUnsupported);
  }
  if (Status charged = Charge(chosen.data.size() / 64); !charged) return charged;
  std::vector<double> indices;
  DecodeNumbers(*index_type, chosen.data, indices);
  std::string data;
  const std::size_t whole_elements = whole.data.size() / type->bytes;
  const auto elements = static_cast<double>(whole_elements);
  for (const double index : indices) {
    if (!(index >= 0.0 && index < elements)) return Bad("'idxs' of a chumpy selection reaches outside its array");
    data.append(whole.data.substr(static_cast<std::size_t>(index) * type->bytes, type->bytes));
  }
  if (!ElementCount(*shape, type->bytes, data.size())) {
    return Bad("the shape of a chumpy selection contradicts its 'idxs'");
  }
  const Expected<std::string_view> owned = Own(std::move(data));
  if (!owned) return Forward(owned);
  PickleArray array;
  array.dtype = whole.dtype;
  array.shape = std::move(*shape);
  array.data = *owned;
  object = NewArray(std::move(array));
  return {};
}

/// joblib writes the elements behind the wrapper's state, after a count of padding bytes in newer files.
Status PickleMachine::ReadJoblibArray(PickleValue& object, const PickleValue& state) {
  int parts[3] = {-1, -1, -1};
  const char* const keys[3] = {"shape", "order", "dtype"};
  for (std::size_t i = 0; i < 3; ++i) {
    const Expected<int> part = Attribute(state, keys[i]);
    if (!part) return Forward(part);
    if (*part < 0) return Bad(std::string("an array of joblib has no '") + keys[i] + "'");
    parts[i] = *part;
  }
  if (At(parts[1]).text != "C" && At(parts[1]).text != "F")
    return Bad("'order' of an array of joblib is neither C nor F");
  if (At(parts[2]).kind != PickleKind::kDtype) return Bad("'dtype' of an array of joblib is not a numpy type");
  Expected<std::vector<std::size_t>> shape = Shape(parts[0], "'shape' of an array of joblib");
  if (!shape) return Forward(shape);
  const std::optional<ElementType> type = ParseElementType(At(parts[2]).text);
  if (!type) return Bad("an array of joblib has an unknown type", ErrorCode::kUnsupported);
  if (type->kind == ElementKind::kObject) {
    return Bad("an array of objects in a joblib file", ErrorCode::kUnsupported);
  }
  const Expected<int> alignment = Attribute(state, "numpy_array_alignment_bytes");
  if (!alignment) return Forward(alignment);
  std::string_view padding;
  if (*alignment >= 0 && At(*alignment).kind != PickleKind::kNone) {
    const Expected<std::uint64_t> count = TakeUnsigned(1);
    if (!count) return Forward(count);
    if (!Take(static_cast<std::size_t>(*count), &padding)) return Bad("the file ends inside the padding of an array");
  }
  std::size_t size = type->bytes;
  for (const std::size_t extent : *shape) {
    if (extent != 0 && size > left() / extent) {
      return Bad("the shape " + ShapeText(*shape) + " of an array of joblib needs more bytes than the file holds");
    }
    size *= extent;
  }
  PickleArray array;
  if (!Take(size, &array.data) || !ElementCount(*shape, type->bytes, size)) {
    return Bad("the shape " + ShapeText(*shape) + " of an array of joblib needs more bytes than the file holds");
  }
  array.dtype = std::string(At(parts[2]).text);
  array.shape = std::move(*shape);
  if (At(parts[1]).text == "F") array.strides = FortranStrides(array.shape);
  object = NewArray(std::move(array));
  return {};
}

Expected<std::string> GatherElements(const PickleArray& array, const std::string& name) {
  const std::optional<ElementType> type = ParseElementType(array.dtype);
  if (!type || type->kind == ElementKind::kObject) {
    return Fail(ErrorCode::kMalformed, "no array of numbers or texts", name);
  }
  if (array.strides.empty()) return std::string(array.data);
  const std::size_t stored = type->bytes == 0 ? 0 : array.data.size() / type->bytes;
  std::size_t count = 1, last = array.offset;
  for (const std::size_t extent : array.shape) count = extent == 0 ? 0 : count;
  for (std::size_t axis = 0; axis < array.shape.size() && count > 0; ++axis) {
    const std::size_t extent = array.shape[axis], stride = array.strides[axis];
    if (extent > 1 && stride > stored / (extent - 1)) {
      return Fail(ErrorCode::kMalformed, "the array reaches outside its storage", name);
    }
    last += (extent - 1) * stride;
    if (extent > std::numeric_limits<std::size_t>::max() / 16 / count) {
      return Fail(ErrorCode::kMalformed, "the array exceeds the address space", name);
    }
    count *= extent;
  }
  if (count > 0 && type->bytes > 0 && last >= stored) {
    return Fail(ErrorCode::kMalformed, "the array reaches outside its storage", name);
  }
  std::string gathered;
  gathered.reserve(count * type->bytes);
  std::vector<std::size_t> index(array.shape.size(), 0);
  std::size_t at = array.offset;
  for (std::size_t k = 0; k < count && type->bytes > 0; ++k) {
    gathered.append(array.data.substr(at * type->bytes, type->bytes));
    for (std::size_t axis = index.size(); axis-- > 0;) {
      at += array.strides[axis];
      if (++index[axis] < array.shape[axis]) break;
      at -= array.strides[axis] * array.shape[axis];
      index[axis] = 0;
    }
  }
  return gathered;
}

}  // namespace mocurate
