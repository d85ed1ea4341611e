#include <algorithm>

#include "core/store/hdf5_file.h"
#include "core/store/hdf5_values.h"

// Fields that no table names: values stay bytes of the type that the file states.
namespace mocurate {

std::uint64_t ExtraField::count() const {
  std::uint64_t product = 1;
  for (const std::uint64_t extent : shape) product *= extent;
  return product;
}

bool ExtraField::HasRowsLike(const ExtraField& other) const {
  return SameType(type, other.type) && !shape.empty() && shape.size() == other.shape.size() &&
         std::equal(shape.begin() + 1, shape.end(), other.shape.begin() + 1);
}

ExtraField ExtraField::Rows(std::uint64_t begin, std::uint64_t end) const {
  ExtraField some;
  some.type = type;
  some.shape = shape;
  some.shape.at(0) = end - begin;
  if (rows() == 0) return some;
  const std::size_t width = bytes.size() / rows();
  some.bytes = bytes.substr(begin * width, (end - begin) * width);
  const std::size_t wide = texts.size() / rows();
  some.texts.assign(texts.begin() + static_cast<std::ptrdiff_t>(begin * wide),
                    texts.begin() + static_cast<std::ptrdiff_t>(end * wide));
  return some;
}

void ExtraField::Append(const ExtraField& more) {
  shape.at(0) += more.rows();
  bytes += more.bytes;
  texts.insert(texts.end(), more.texts.begin(), more.texts.end());
}

bool operator==(const ExtraField& a, const ExtraField& b) {
  return a.shape == b.shape && a.bytes == b.bytes && a.texts == b.texts && SameType(a.type, b.type);
}

std::optional<std::string> DatasetOfAttribute(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos || path.compare(slash, 2, "/@") != 0) return std::nullopt;
  return path.substr(0, slash);
}

bool SameType(const std::string& a, const std::string& b) {
  if (a == b || a.empty() || b.empty()) return a == b;
  const store::Hdf5Id first(H5Tdecode(a.data()), H5Tclose), second(H5Tdecode(b.data()), H5Tclose);
  return first.ok() && second.ok() && H5Tequal(first.get(), second.get()) > 0;
}

}  // namespace mocurate

namespace mocurate::store {
namespace {

constexpr std::uint64_t kMostAttributeTexts = 1000;

/// Whether a value is its bytes, without a reference to another place.
bool IsPlain(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
    case H5T_FLOAT:
    case H5T_ENUM:
    case H5T_BITFIELD:
    case H5T_OPAQUE:
      return true;
    case H5T_STRING:
      return H5Tis_variable_str(type) == 0;
    case H5T_ARRAY: {
      const Hdf5Id element(H5Tget_super(type), H5Tclose);
      return element.ok() && IsPlain(element.get());
    }
    case H5T_COMPOUND:
      for (int i = 0; i < H5Tget_nmembers(type); ++i) {
        const Hdf5Id member(H5Tget_member_type(type, static_cast<unsigned>(i)), H5Tclose);
        if (!member.ok() || !IsPlain(member.get())) return false;
      }
      return true;
    default:
      return false;
  }
}

Hdf5Id VariableText() {
  Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

/// Without the name of a type that has one in its file.
std::string Encoded(hid_t type) {
  const Hdf5Id own(H5Tcopy(type), H5Tclose);
  std::size_t size = 0;
  if (H5Tencode(own.get(), nullptr, &size) < 0) return "";
  std::string bytes(size, '\0');
  return H5Tencode(own.get(), bytes.data(), &size) < 0 ? "" : bytes;
}

Hdf5Id TypeIn(const ExtraField& field) {
  return field.type.empty() ? VariableText() : Hdf5Id(H5Tdecode(field.type.data()), H5Tclose);
}

/// What HDF5 reads and writes: the bytes, or pointers to the texts.
class RawValues {
 public:
  explicit RawValues(const ExtraField& field) : bytes_(field.bytes.data()) {
    for (const std::string& text : field.texts) pointers_.push_back(text.c_str());
    if (field.type.empty()) bytes_ = pointers_.data();
  }
  const void* data() const { return bytes_; }

 private:
  std::vector<const char*> pointers_;
  const void* bytes_;
};

tl::unexpected<Error> CannotBeWritten(const std::string& path) {
  return Fail(ErrorCode::kCannotWrite, "the values cannot be written: " + Reason(), path);
}

/// A dataset, or an attribute.
struct Opened {
  bool attribute;
  Hdf5Id object, type, space;
  bool text = false, variable = false;

  Opened(hid_t file, const std::string& path) {
    const auto of = DatasetOfAttribute(path);
    attribute = of.has_value();
    if (attribute) {
      object = Hdf5Id(H5Aopen_by_name(file, of->empty() ? "/" : of->c_str(), path.c_str() + of->size() + 2, H5P_DEFAULT,
                                      H5P_DEFAULT),
                      H5Aclose);
    } else {
      object = Hdf5Id(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
    }
    if (!object.ok()) return;
    type = Hdf5Id(attribute ? H5Aget_type(object.get()) : H5Dget_type(object.get()), H5Tclose);
    space = Hdf5Id(attribute ? H5Aget_space(object.get()) : H5Dget_space(object.get()), H5Sclose);
    text = H5Tget_class(type.get()) == H5T_STRING;
    variable = text && H5Tis_variable_str(type.get()) > 0;
  }
};

/// The field with its values: texts of fixed length become texts.
Expected<ExtraField> WithValues(ExtraField field, std::string bytes, const Opened& opened, const std::string& where) {
  if (!opened.text) {
    field.bytes = std::move(bytes);
    return field;
  }
  const std::size_t size = H5Tget_size(opened.type.get());
  for (std::size_t at = 0; at + size <= bytes.size(); at += size) {
    auto text = Unpad(bytes.data() + at, size, H5Tget_strpad(opened.type.get()));
    if (!text) return Fail(ErrorCode::kUnsupported, "has a text with a zero byte inside", where);
    field.texts.push_back(std::move(*text));
  }
  return field;
}

/// Texts of variable length.
Expected<std::vector<std::string>> TextsOfAttribute(const Opened& opened, std::uint64_t count, std::uint64_t most,
                                                    const std::string& where) {
  // HDF5 reads all of them at once, and each may be one that fills the file.
  if (count > kMostAttributeTexts || count * most > MostUnpacked(most)) {
    return Fail(
        ErrorCode::kUnsupported,
        "has " + std::to_string(count) + " texts of any length, of at most " +
            std::to_string(std::min(kMostAttributeTexts, MostUnpacked(most) / std::max<std::uint64_t>(1, most))),
        where);
  }
  std::vector<char*> pointers(count, nullptr);
  if (count > 0 && H5Aread(opened.object.get(), opened.type.get(), pointers.data()) < 0) {
    return Fail(ErrorCode::kMalformed, "texts cannot be read: " + Reason(), where);
  }
  std::vector<std::string> texts;
  for (const char* text : pointers) texts.emplace_back(text == nullptr ? "" : text);
  H5Dvlen_reclaim(opened.type.get(), opened.space.get(), H5P_DEFAULT, pointers.data());
  if (BytesOf(texts) > most) return Fail(ErrorCode::kMalformed, "texts are longer than the file", where);
  return texts;
}

}  // namespace

Expected<std::vector<std::string>> Hdf5Reader::PathsBeyond(const std::set<std::string>& known) const {
  std::vector<std::string> paths;
  const Status whole = Walk([&](const std::string& path, hid_t object, H5O_type_t type) {
    if (object < 0 || (type != H5O_TYPE_GROUP && known.count(path) == 0)) paths.push_back(path);
    for (const std::string& name : AttributesOf(object)) {
      const bool of_table = known.count(path + "/@" + name) > 0 || (known.count(path) > 0 && name == "sha256");
      if (!of_table) paths.push_back(path + "/@" + name);
    }
  });
  if (!whole) return Forward(whole);
  std::sort(paths.begin(), paths.end());
  return paths;
}

Expected<ExtraField> Hdf5Reader::ShapeOfExtra(const std::string& path) const {
  SilenceHdf5();
  const std::string where = WhereOf(path);
  if (!DatasetOfAttribute(path) && !Has(path)) {
    return Fail(ErrorCode::kUnsupported, "is a link to another place", where);
  }
  const Opened opened(id_.get(), path);
  if (!opened.object.ok()) return Fail(ErrorCode::kUnsupported, "is not a dataset", where);
  const auto extents = ShapeOf(opened.space.get());
  const auto count = extents ? Product(*extents) : std::nullopt;
  if (!count) return Fail(ErrorCode::kUnsupported, "has no usable shape", where);
  ExtraField field;
  field.shape.assign(extents->begin(), extents->end());
  if (!opened.text && IsPlain(opened.type.get())) field.type = Encoded(opened.type.get());
  if (!opened.text && field.type.empty()) {
    return Fail(ErrorCode::kUnsupported, "has values that refer to other places: lists of any length, references",
                where);
  }
  const std::size_t size = opened.variable ? 1 : H5Tget_size(opened.type.get());
  if (!opened.attribute) {
    if (Status fits = CheckStorage(opened.object.get(), *count, size, path); !fits) return Forward(fits);
    return field;
  }
  const auto bytes = Product({*count}, size);
  if (bytes && *bytes <= std::min<std::uint64_t>(bytes_, kLongestAttribute)) return field;
  return Fail(ErrorCode::kUnsupported, "is longer than " + std::to_string(kLongestAttribute) + " bytes", where);
}

Expected<ExtraField> Hdf5Reader::ReadExtra(const std::string& path) const {
  Expected<ExtraField> field = ShapeOfExtra(path);
  if (!field) return field;
  const Opened opened(id_.get(), path);
  if (!opened.attribute && !field->shape.empty()) {
    Expected<ExtraField> rows = ReadExtraRows(path, 0, field->rows());
    if (Status fits = rows ? Charge(BytesOf(rows->texts), path) : Status(); !fits) return Forward(fits);
    return rows;
  }
  const std::string where = WhereOf(path);
  if (opened.variable) {
    auto texts = opened.attribute ? TextsOfAttribute(opened, field->count(), bytes_, where)
                                  : ReadVariableTexts(opened.object.get(), H5S_ALL, 1, path);
    if (!texts) return Forward(texts);
    if (Status fits = Charge(BytesOf(*texts), path); !fits) return Forward(fits);
    field->texts = std::move(*texts);
    return field;
  }
  std::string bytes(field->count() * H5Tget_size(opened.type.get()), '\0');
  const bool read = bytes.empty() || (opened.attribute ? H5Aread(opened.object.get(), opened.type.get(), bytes.data())
                                                       : H5Dread(opened.object.get(), opened.type.get(), H5S_ALL,
                                                                 H5S_ALL, H5P_DEFAULT, bytes.data())) >= 0;
  if (!read) return Fail(ErrorCode::kMalformed, "values cannot be read: " + Reason(), where);
  return WithValues(*std::move(field), std::move(bytes), opened, where);
}

Expected<ExtraField> Hdf5Reader::ReadExtraRows(const std::string& path, std::uint64_t first,
                                               std::uint64_t count) const {
  Expected<ExtraField> field = ShapeOfExtra(path);
  if (!field) return field;
  const std::string where = WhereOf(path);
  if (field->shape.empty() || first > field->rows() || count > field->rows() - first) {
    return Fail(ErrorCode::kMalformed, "has not the rows that were requested", where);
  }
  field->shape[0] = count;
  const Opened opened(id_.get(), path);
  if (opened.variable) {
    SelectRows(opened.space.get(), first, field->shape);
    auto texts = ReadVariableTexts(opened.object.get(), opened.space.get(), field->count(), path);
    if (!texts) return Forward(texts);
    field->texts = std::move(*texts);
    return field;
  }
  std::string bytes(field->count() * H5Tget_size(opened.type.get()), '\0');
  const Hdf5Id memory = SpaceOf(field->shape);
  const bool read = bytes.empty() || (SelectRows(opened.space.get(), first, field->shape) &&
                                      H5Dread(opened.object.get(), opened.type.get(), memory.get(), opened.space.get(),
                                              H5P_DEFAULT, bytes.data()) >= 0);
  if (!read) return Fail(ErrorCode::kMalformed, "values cannot be read: " + Reason(), where);
  return WithValues(*std::move(field), std::move(bytes), opened, where);
}

Status Hdf5Writer::MakeExtra(const std::string& path, const ExtraField& field) {
  const Hdf5Id type = TypeIn(field);
  auto dataset = MakeDataset(path, type.get(), field.shape);
  if (!dataset) return Forward(dataset);
  made_[path] = std::move(*dataset);
  return Written();
}

Status Hdf5Writer::WriteExtraRows(const std::string& path, std::uint64_t first, const ExtraField& rows) {
  SilenceHdf5();
  if (rows.count() == 0) return {};
  const Hdf5Id& dataset = made_.at(path);
  const Hdf5Id type = TypeIn(rows), memory = SpaceOf(rows.shape), space(H5Dget_space(dataset.get()), H5Sclose);
  const RawValues values(rows);
  if (!SelectRows(space.get(), first, rows.shape) ||
      H5Dwrite(dataset.get(), type.get(), memory.get(), space.get(), H5P_DEFAULT, values.data()) < 0) {
    return CannotBeWritten(path);
  }
  return Written();
}

Status Hdf5Writer::WriteExtra(const std::string& path, const ExtraField& field) {
  SilenceHdf5();
  const RawValues values(field);
  const Hdf5Id type = TypeIn(field);
  const auto of = DatasetOfAttribute(path);
  if (of) {
    const Hdf5Id object(H5Oopen(id_.get(), of->empty() ? "/" : of->c_str(), H5P_DEFAULT), H5Oclose);
    const Hdf5Id space = SpaceOf(field.shape);
    const Hdf5Id attribute(
        H5Acreate2(object.get(), path.c_str() + of->size() + 2, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    const bool done =
        attribute.ok() && (field.count() == 0 || H5Awrite(attribute.get(), type.get(), values.data()) >= 0);
    return done ? Written() : CannotBeWritten(path);
  }
  const auto dataset = MakeDataset(path, type.get(), field.shape);
  if (!dataset) return Forward(dataset);
  if (field.count() > 0 && H5Dwrite(dataset->get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    return CannotBeWritten(path);
  }
  return Written();
}

}  // namespace mocurate::store
