#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/base/file.h"
#include "core/store/hdf5_file.h"
#include "core/store/hdf5_values.h"

namespace mocurate::store {

std::string Reason() {
  std::string reason;
  const auto visit = [](unsigned, const H5E_error2_t* error, void* data) -> herr_t {
    auto& text = *static_cast<std::string*>(data);
    if (text.empty() && error->desc != nullptr) text = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit, &reason);
  return reason.empty() ? "no reason given" : reason;
}

std::optional<std::uint64_t> Product(const std::vector<hsize_t>& extents, std::uint64_t start) {
  std::uint64_t product = start;
  for (const hsize_t extent : extents) {
    if (__builtin_mul_overflow(product, static_cast<std::uint64_t>(extent), &product)) return std::nullopt;
  }
  return product;
}

std::uint64_t BytesOf(const std::vector<std::string>& texts) {
  std::uint64_t bytes = 0;
  for (const std::string& text : texts) bytes += text.size();
  return bytes;
}

Hdf5Id SpaceOf(const std::vector<std::uint64_t>& shape) {
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  return Hdf5Id(extents.empty() ? H5Screate(H5S_SCALAR)
                                : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                H5Sclose);
}

bool SelectRows(hid_t space, std::uint64_t first, const std::vector<std::uint64_t>& shape) {
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  std::vector<hsize_t> start(extents.size(), 0);
  start[0] = first;
  return H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extents.data(), nullptr) >= 0;
}

std::optional<std::vector<hsize_t>> ShapeOf(hid_t space) {
  const H5S_class_t kind = H5Sget_simple_extent_type(space);
  if (kind == H5S_SCALAR) return std::vector<hsize_t>{};
  const int rank = kind == H5S_SIMPLE ? H5Sget_simple_extent_ndims(space) : -1;
  if (rank < 0) return std::nullopt;
  std::vector<hsize_t> shape(static_cast<std::size_t>(rank));
  if (rank > 0 && H5Sget_simple_extent_dims(space, shape.data(), nullptr) < 0) return std::nullopt;
  return shape;
}

std::optional<std::string> Unpad(const char* text, std::size_t size, H5T_str_t padding) {
  std::size_t length = strnlen(text, size);
  if (padding != H5T_STR_NULLTERM) {
    for (std::size_t i = length; i < size; ++i) {
      if (text[i] != '\0') return std::nullopt;
    }
  }
  if (padding == H5T_STR_SPACEPAD) {
    while (length > 0 && text[length - 1] == ' ') --length;
  }
  return std::string(text, length);
}

namespace {

constexpr std::uint64_t kMostDeflated = 1032;   // bytes out of one of a deflate stream [zlib's technical details]
constexpr std::uint64_t kBytesPerChunk = 1024;  // that HDF5 takes for each chunk of a dataset it reads
constexpr std::uint64_t kTextReference = 16;    // bytes of the place of a text of variable length

std::optional<FieldType> TypeOf(hid_t type) {
  const std::size_t size = H5Tget_size(type);
  switch (H5Tget_class(type)) {
    case H5T_FLOAT:
      if (size == 4) return FieldType::kFloat32;
      if (size == 8) return FieldType::kFloat64;
      return std::nullopt;
    case H5T_INTEGER:
      if (size == 1 && H5Tget_sign(type) == H5T_SGN_NONE) return FieldType::kUint8;
      if (size == 4 && H5Tget_sign(type) == H5T_SGN_2) return FieldType::kInt32;
      if (size == 8 && H5Tget_sign(type) == H5T_SGN_2) return FieldType::kInt64;
      return std::nullopt;
    case H5T_STRING:
      return FieldType::kText;
    default:
      return std::nullopt;
  }
}

std::string TypeText(hid_t type) {
  if (const auto known = TypeOf(type)) return std::string(Name(*known));
  const char* kind = H5Tget_class(type) == H5T_INTEGER ? "integer"
                     : H5Tget_class(type) == H5T_FLOAT ? "float"
                                                       : "other";
  return std::string(kind) + " of " + std::to_string(H5Tget_size(type)) + " bytes";
}

herr_t FreeVariable(hid_t type, hid_t space, char** text) { return H5Dvlen_reclaim(type, space, H5P_DEFAULT, text); }

/// Memory for texts of variable length, of which HDF5 reads no more than fit: a hostile file may point many elements at
/// one long text.
class TextMemory {
 public:
  explicit TextMemory(std::uint64_t bytes) : left_(bytes) {}
  TextMemory(const TextMemory&) = delete;
  TextMemory& operator=(const TextMemory&) = delete;
  ~TextMemory() {
    while (last_ != nullptr) std::free(std::exchange(last_, static_cast<Block*>(last_)->before));
  }
  bool exhausted() const { return exhausted_; }

  static void* Take(std::size_t size, void* memory) {
    auto& own = *static_cast<TextMemory*>(memory);
    own.exhausted_ = own.exhausted_ || size > own.left_;
    void* const block = own.exhausted_ ? nullptr : std::malloc(sizeof(Block) + size);
    if (block == nullptr) return nullptr;
    static_cast<Block*>(block)->before = std::exchange(own.last_, block);
    own.left_ -= size;
    return static_cast<Block*>(block) + 1;
  }
  static void Give(void*, void*) {}  // all at the end

 private:
  struct Block {
    void* before;
  };
  std::uint64_t left_;
  void* last_ = nullptr;
  bool exhausted_ = false;
};

/// Bytes that a deflate stream unpacks to; beyond `most`, any number above it.
std::uint64_t UnpackedSize(const std::vector<unsigned char>& packed, std::uint64_t most) {
  z_stream stream{};
  stream.next_in = const_cast<unsigned char*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  if (inflateInit(&stream) != Z_OK) return 0;
  static thread_local std::array<unsigned char, std::size_t{1} << 16> part;
  std::uint64_t size = 0;
  for (int state = Z_OK; state == Z_OK && size <= most;) {
    stream.next_out = part.data();
    stream.avail_out = static_cast<uInt>(part.size());
    state = inflate(&stream, Z_NO_FLUSH);
    size += part.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return size;
}

}  // namespace

Hdf5Id& Hdf5Id::operator=(Hdf5Id&& other) noexcept {
  if (this != &other) {
    Reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
  }
  return *this;
}

void Hdf5Id::Reset() {
  if (id_ >= 0 && close_ != nullptr) close_(id_);
  id_ = -1;
}

void SilenceHdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

std::string Where(const std::filesystem::path& file, const std::string& field) {
  return DisplayPath(file) + ":" + field;
}

Expected<Hdf5Reader> Hdf5Reader::Open(const std::filesystem::path& file) {
  SilenceHdf5();
  std::error_code failure;
  const auto status = std::filesystem::status(file, failure);
  if (!std::filesystem::exists(status)) return Fail(ErrorCode::kNotFound, "no such file", DisplayPath(file));
  if (!std::filesystem::is_regular_file(status)) {
    return Fail(ErrorCode::kUnreadable, "is not a regular file", DisplayPath(file));
  }
  Hdf5Reader reader;
  reader.path_ = file;
  reader.shown_ = Where(file, "");
  reader.bytes_ = std::filesystem::file_size(file, failure);
  if (failure) return Fail(ErrorCode::kUnreadable, failure.message(), DisplayPath(file));
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  H5Pset_file_locking(access.get(), false, true);
  reader.id_ = Hdf5Id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (reader.id_.ok()) return reader;
  const std::string reason = Reason();
  if (reader.bytes_ > 0 && H5Fis_hdf5(file.c_str()) < 0) {
    return Fail(ErrorCode::kUnreadable, "cannot be opened: " + reason, DisplayPath(file));
  }
  return Fail(ErrorCode::kMalformed,
              reader.bytes_ == 0 ? "is empty; an HDF5 file was expected" : "is not a whole HDF5 file: " + reason,
              Where(file, "/"), "make the file again; it may have been cut short while copying");
}

bool Hdf5Reader::Has(const std::string& path) const {
  SilenceHdf5();
  if (path.rfind("/@", 0) == 0) return H5Aexists_by_name(id_.get(), "/", path.c_str() + 2, H5P_DEFAULT) > 0;
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    H5L_info_t link{};
    if (H5Lexists(id_.get(), part.c_str(), H5P_DEFAULT) <= 0 ||
        H5Lget_info(id_.get(), part.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
      return false;
    }
    if (end == std::string::npos) return true;
  }
}

Expected<Array> Hdf5Reader::Read(const std::string& path, FieldType type) const {
  SilenceHdf5();
  return path.rfind("/@", 0) == 0 ? ReadAttribute(path, type) : ReadDataset(path, type);
}

Expected<Array> Hdf5Reader::ReadDataset(const std::string& path, FieldType type) const {
  const std::string where = WhereOf(path);
  const Hdf5Id dataset(H5Dopen2(id_.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.ok()) return Fail(ErrorCode::kMalformed, "cannot be opened as a dataset: " + Reason(), where);
  const Hdf5Id stored_type(H5Dget_type(dataset.get()), H5Tclose);
  if (!stored_type.ok() || TypeOf(stored_type.get()) != type) {
    return Fail(ErrorCode::kMalformed,
                "is of type " + TypeText(stored_type.get()) + "; the format asks for " + std::string(Name(type)),
                where);
  }
  const Hdf5Id space(H5Dget_space(dataset.get()), H5Sclose);
  const auto extents = ShapeOf(space.get());
  const auto count = extents ? Product(*extents) : std::nullopt;
  if (!count) return Fail(ErrorCode::kMalformed, "has no usable shape", where);
  const bool variable = type == FieldType::kText && H5Tis_variable_str(stored_type.get()) > 0;
  const std::uint64_t element_size = variable ? 1 : H5Tget_size(stored_type.get());
  if (Status fits = CheckStorage(dataset.get(), *count, element_size, path); !fits) return Forward(fits);

  std::vector<std::uint64_t> shape(extents->begin(), extents->end());
  if (type != FieldType::kText) {
    return WithNumber(type, [&](auto number, hid_t native) -> Expected<Array> {
      std::vector<decltype(number)> values(*count);
      if (*count > 0 && H5Dread(dataset.get(), native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
        return Fail(ErrorCode::kMalformed, "values cannot be read: " + Reason(), where);
      }
      return MakeArray(std::move(shape), std::move(values));
    });
  }
  auto texts = variable ? ReadVariableTexts(dataset.get(), H5S_ALL, *count, path)
                        : ReadTexts(dataset.get(), stored_type.get(), *count, path);
  if (!texts) return Forward(texts);
  if (Status fits = variable ? Charge(BytesOf(*texts), path) : Status(); !fits) return Forward(fits);
  return MakeArray(std::move(shape), std::move(*texts));
}

Status Hdf5Reader::Charge(std::uint64_t bytes, const std::string& path) const {
  const std::uint64_t most = MostUnpacked(bytes_);
  if (bytes <= most - charged_) {
    charged_ += bytes;
    return {};
  }
  return Fail(ErrorCode::kMalformed,
              "takes " + std::to_string(bytes) + " bytes of memory after " + std::to_string(charged_) +
                  " of other fields; a file of " + std::to_string(bytes_) + " bytes may take " + std::to_string(most),
              WhereOf(path), "a file that is packed so tightly holds no recorded motion; store it unpacked to read it");
}

/// A packed stream does not state its length, and HDF5 unpacks all of it, whatever the chunk's size: each is unpacked
/// here first, and not kept. `most`: bytes of a chunk before it is packed; `deflate`: place of that filter, -1: none.
Status Hdf5Reader::CheckChunks(hid_t dataset, const std::vector<hsize_t>& chunk, std::uint64_t most, int deflate,
                               const std::string& path) const {
  if (deflate < 0 || chunk.empty()) return {};
  const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
  const auto extents = ShapeOf(space.get());
  std::vector<hsize_t> at(chunk.size(), 0);
  std::vector<unsigned char> packed;
  for (bool more = true; more;) {
    std::uint32_t skipped = 0;  // filters of this chunk
    hsize_t size = 0;
    const bool found = H5Dget_chunk_storage_size(dataset, at.data(), &size) >= 0 && size <= bytes_;
    packed.resize(found ? static_cast<std::size_t>(size) : 0);
    if (!found || (size > 0 && H5Dread_chunk(dataset, H5P_DEFAULT, at.data(), &skipped, packed.data()) < 0)) {
      return Fail(ErrorCode::kMalformed, "values cannot be read: " + Reason(), WhereOf(path));
    }
    const bool is_packed = (skipped & (1u << deflate)) == 0;
    if ((is_packed ? UnpackedSize(packed, most) : size) > most) {
      return Fail(ErrorCode::kMalformed, "has a chunk that unpacks to more than its " + std::to_string(most) + " bytes",
                  WhereOf(path), "the file is damaged: copy it again");
    }
    more = false;
    for (std::size_t axis = at.size(); axis-- > 0 && !more;) {
      at[axis] += chunk[axis];
      more = at[axis] < (*extents)[axis];
      if (!more) at[axis] = 0;
    }
  }
  return {};
}

Status Hdf5Reader::CheckStorage(hid_t dataset, std::uint64_t count, std::uint64_t element_size,
                                const std::string& path) const {
  if (checked_.count(path) > 0) return {};
  const std::string where = WhereOf(path);
  const auto needed = Product({count}, std::max<std::uint64_t>(1, element_size));
  const std::uint64_t stored = H5Dget_storage_size(dataset);
  const Hdf5Id creation(H5Dget_create_plist(dataset), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(creation.get());
  if ((layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT) ||
      H5Pget_external_count(creation.get()) != 0) {
    return Fail(ErrorCode::kMalformed, "keeps its values outside this file", where);
  }
  int deflate = -1;
  std::uint64_t checksums = 0;  // that are packed with the values
  const int filters = layout == H5D_CHUNKED ? H5Pget_nfilters(creation.get()) : 0;
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0;
    unsigned config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(creation.get(), static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
    const bool checksum = filter == H5Z_FILTER_FLETCHER32;
    const bool known =
        deflate < 0 ? filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE || checksum : checksum;
    if (!known) {
      return Fail(ErrorCode::kMalformed,
                  "is stored with HDF5 filter " + std::to_string(filter) + (deflate < 0 ? "" : " after deflate"), where,
                  "shuffle, then one deflate, and fletcher32 are read");
    }
    if (filter == H5Z_FILTER_DEFLATE) deflate = i;
    if (checksum && deflate < 0) ++checksums;
  }
  const auto limit = Product({stored}, deflate < 0 ? 1 : kMostDeflated);
  std::vector<hsize_t> chunk(layout == H5D_CHUNKED && count > 0 ? H5S_MAX_RANK : 0);
  if (!chunk.empty()) {
    const int rank = H5Pget_chunk(creation.get(), H5S_MAX_RANK, chunk.data());
    chunk.resize(static_cast<std::size_t>(std::max(rank, 0)));
  }
  const auto of_chunk = Product(chunk, element_size);
  const bool has_chunks = chunk.empty() || (of_chunk && limit && *of_chunk > 0 && *of_chunk <= *limit);
  if (!needed || !limit || !has_chunks || stored > bytes_ || *needed > *limit) {
    return Fail(ErrorCode::kMalformed,
                "announces " + (needed ? std::to_string(*needed) : std::string("more than 2^64")) + " bytes, but " +
                    std::to_string(stored) + " are stored in a file of " + std::to_string(bytes_),
                where);
  }
  const Hdf5Id type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
  const auto extents = ShapeOf(space.get());
  if (!extents || (!chunk.empty() && chunk.size() != extents->size())) {
    return Fail(ErrorCode::kMalformed, "has no usable shape", where);
  }
  std::uint64_t chunks = chunk.empty() ? 0 : 1;
  for (std::size_t axis = 0; axis < chunk.size(); ++axis) chunks *= ((*extents)[axis] + chunk[axis] - 1) / chunk[axis];
  const bool texts = H5Tget_class(type.get()) == H5T_STRING, variable = texts && H5Tis_variable_str(type.get()) > 0;
  const auto unpacked = Product({chunks}, *of_chunk + kBytesPerChunk);  // to the ends of the last chunks
  if (!unpacked) return Fail(ErrorCode::kMalformed, "has no usable shape", where);
  const std::uint64_t values = chunk.empty() ? *needed : *unpacked;
  if (Status fits = Charge(values, path); !fits) return fits;
  if (Status fits = Charge(texts ? count * sizeof(std::string) : 0, path); !fits) return fits;
  const std::uint64_t most = *of_chunk * (variable ? kTextReference : 1) + 4 * checksums;
  if (Status sound = CheckChunks(dataset, chunk, most, deflate, path); !sound) return sound;
  checked_.insert(path);
  return {};
}

Expected<std::vector<std::string>> Hdf5Reader::ReadTexts(hid_t dataset, hid_t type, std::uint64_t count,
                                                         const std::string& path) const {
  const std::size_t size = H5Tget_size(type);
  std::vector<char> bytes(count * size);
  if (count > 0 && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) {
    return Fail(ErrorCode::kMalformed, "texts cannot be read: " + Reason(), WhereOf(path));
  }
  std::vector<std::string> texts;
  texts.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    auto text = Unpad(bytes.data() + i * size, size, H5Tget_strpad(type));
    if (!text) {
      return Fail(ErrorCode::kMalformed, "text " + std::to_string(i) + " has a zero byte inside", WhereOf(path));
    }
    texts.push_back(std::move(*text));
  }
  return texts;
}

Expected<std::vector<std::string>> Hdf5Reader::ReadVariableTexts(hid_t dataset, hid_t space, std::uint64_t count,
                                                                 const std::string& path) const {
  std::vector<std::string> texts;
  if (count == 0) return texts;
  const Hdf5Id type(H5Dget_type(dataset), H5Tclose);
  const hsize_t extent = count;
  const Hdf5Id selected(H5Screate_simple(1, &extent, nullptr), H5Sclose);
  const Hdf5Id transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  TextMemory memory(bytes_);
  H5Pset_vlen_mem_manager(transfer.get(), TextMemory::Take, &memory, TextMemory::Give, nullptr);
  std::vector<const char*> pointers(count, nullptr);
  if (H5Dread(dataset, type.get(), selected.get(), space, transfer.get(), pointers.data()) < 0) {
    return Fail(ErrorCode::kMalformed,
                memory.exhausted() ? "texts are longer than the file" : "texts cannot be read: " + Reason(),
                WhereOf(path));
  }
  for (const char* text : pointers) texts.emplace_back(text == nullptr ? "" : text);
  return texts;
}

Expected<Array> Hdf5Reader::ReadAttribute(const std::string& path, FieldType type) const {
  const std::string where = WhereOf(path);
  const Hdf5Id attribute(H5Aopen_by_name(id_.get(), "/", path.c_str() + 2, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const Hdf5Id stored_type(attribute.ok() ? H5Aget_type(attribute.get()) : -1, H5Tclose);
  const Hdf5Id space(attribute.ok() ? H5Aget_space(attribute.get()) : -1, H5Sclose);
  if (!stored_type.ok() || !space.ok() || H5Tget_class(stored_type.get()) != H5T_STRING || type != FieldType::kText ||
      H5Sget_simple_extent_type(space.get()) != H5S_SCALAR) {
    return Fail(ErrorCode::kMalformed, "is not a single text; the format asks for text", where);
  }
  if (H5Tis_variable_str(stored_type.get()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute.get(), stored_type.get(), &text) < 0) {
      return Fail(ErrorCode::kMalformed, "cannot be read: " + Reason(), where);
    }
    Array array = MakeText(text == nullptr ? "" : text);
    FreeVariable(stored_type.get(), space.get(), &text);
    return array;
  }
  const std::size_t size = H5Tget_size(stored_type.get());
  if (size > bytes_) return Fail(ErrorCode::kMalformed, "is longer than the file", where);
  std::vector<char> bytes(size);
  if (H5Aread(attribute.get(), stored_type.get(), bytes.data()) < 0) {
    return Fail(ErrorCode::kMalformed, "cannot be read: " + Reason(), where);
  }
  auto text = Unpad(bytes.data(), size, H5Tget_strpad(stored_type.get()));
  if (!text) return Fail(ErrorCode::kMalformed, "has a zero byte inside", where);
  return MakeText(std::move(*text));
}

}  // namespace mocurate::store
