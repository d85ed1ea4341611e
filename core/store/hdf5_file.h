#pragma once

#include <hdf5.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/store/array.h"
#include "core/store/extra_field.h"

namespace mocurate::store {

/// Owns one HDF5 identifier.
class Hdf5Id {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Id() = default;
  Hdf5Id(hid_t id, Close close) : id_(id), close_(close) {}
  Hdf5Id(Hdf5Id&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Hdf5Id& operator=(Hdf5Id&& other) noexcept;
  ~Hdf5Id() { Reset(); }
  void Reset();
  hid_t get() const { return id_; }
  bool ok() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// From now on HDF5 prints nothing on stderr from this thread, also not at exit after it has met a broken file.
void SilenceHdf5();

/// "file.h5:/frames/joints".
std::string Where(const std::filesystem::path& file, const std::string& field);

/// Reads fields of an HDF5 file that may be damaged or hostile. Sizes are compared with the stored bytes before memory
/// is allocated, chunks with their declared size before HDF5 unpacks them, and all fields together with MostUnpacked;
/// links that are not hard, external and virtual storage and filters other than one deflate, shuffle and fletcher32 are
/// refused.
class Hdf5Reader {
 public:
  /// Error kNotFound, kUnreadable, kMalformed (not HDF5, truncated).
  static Expected<Hdf5Reader> Open(const std::filesystem::path& file);

  /// A dataset "/a/b", or an attribute of the root "/@name".
  bool Has(const std::string& path) const;
  /// Error kMalformed when the field is of another type or does not fit its storage.
  Expected<Array> Read(const std::string& path, FieldType type) const;
  /// Of a dataset of numbers with rows: its shape, rows [first, first + count), and the SHA-256 of its values, read in
  /// blocks of so many bytes. Errors as of Read.
  Expected<std::vector<std::uint64_t>> ShapeOfRows(const std::string& path, FieldType type) const;
  Expected<Array> ReadRows(const std::string& path, FieldType type, std::uint64_t first, std::uint64_t count) const;
  Expected<std::string> HashOfRows(const std::string& path, FieldType type, std::uint64_t block) const;
  /// The text attribute `name` of a dataset; empty when there is none.
  std::optional<std::string> AttributeOf(const std::string& path, const std::string& name) const;
  /// Names of the groups directly below `group`, sorted; empty when the group does not exist.
  std::vector<std::string> GroupsBelow(const std::string& group) const;
  /// Paths of all datasets and "/@name" of all attributes of the root, sorted. Error kMalformed for groups nested too
  /// deep, or paths that are too long together.
  Expected<std::vector<std::string>> AllPaths() const;
  /// Paths beyond `known`, as of ExtraFields, sorted: of datasets, of named types, of links that are not hard, and of
  /// attributes of the root, of groups and of datasets; not "sha256" of a known one. Errors as of AllPaths.
  Expected<std::vector<std::string>> PathsBeyond(const std::set<std::string>& known) const;
  /// Any dataset or attribute of values of a fixed size, or of texts: its type and shape, and its values. Error
  /// kUnsupported for other types and for links, kMalformed as of Read.
  Expected<ExtraField> ShapeOfExtra(const std::string& path) const;
  Expected<ExtraField> ReadExtra(const std::string& path) const;
  /// Rows [first, first + count) of a dataset.
  Expected<ExtraField> ReadExtraRows(const std::string& path, std::uint64_t first, std::uint64_t count) const;
  const std::filesystem::path& file() const { return path_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  Expected<Array> ReadDataset(const std::string& path, FieldType type) const;
  Expected<Array> ReadAttribute(const std::string& path, FieldType type) const;
  /// Whether a field may be read: once for each path.
  Status CheckStorage(hid_t dataset, std::uint64_t count, std::uint64_t element_size, const std::string& path) const;
  Status CheckChunks(hid_t dataset, const std::vector<hsize_t>& chunk, std::uint64_t most, int deflate,
                     const std::string& path) const;
  /// Adds to what the fields take in memory.
  Status Charge(std::uint64_t bytes, const std::string& path) const;
  /// Calls `visit` once with every object, the root first, and with every link that is not hard (object: -1).
  Status Walk(const std::function<void(const std::string& path, hid_t object, H5O_type_t type)>& visit) const;
  /// An open dataset of numbers with rows.
  struct Rows {
    FieldType type;
    Hdf5Id dataset;
    std::vector<std::uint64_t> shape;
  };
  Expected<const Rows*> OpenRows(const std::string& path, FieldType type) const;
  Expected<std::vector<std::string>> ReadTexts(hid_t dataset, hid_t type, std::uint64_t count,
                                               const std::string& path) const;
  /// Those that are selected in `space`.
  Expected<std::vector<std::string>> ReadVariableTexts(hid_t dataset, hid_t space, std::uint64_t count,
                                                       const std::string& path) const;

  std::string WhereOf(const std::string& path) const { return shown_ + path; }

  std::filesystem::path path_;
  std::string shown_;  ///< Where(path_, "")
  std::uint64_t bytes_ = 0;
  Hdf5Id id_;
  mutable std::set<std::string> checked_;     ///< paths of fields that may be read
  mutable std::uint64_t charged_ = 0;         ///< bytes that they take in memory
  mutable std::map<std::string, Rows> rows_;  ///< stay open, so that HDF5 unpacks a chunk once
};

/// An open file that HDF5 writes through `DescriptorDriver`. Nothing fails inside HDF5, which cannot go on after a
/// failed write: the first error is kept here and what follows is thrown away.
struct DescriptorFile {
  int descriptor = -1;    ///< of an empty file, open for reading and writing; not closed here
  int error = 0;          ///< errno of the first write that failed; 0: none did
  bool finished = false;  ///< nothing is written any more
};

/// File access properties for `file`, which must outlive the HDF5 file; its name does not matter. Space is given out as
/// by HDF5's driver for files in memory: the same calls make the same bytes.
hid_t DescriptorAccess(DescriptorFile& file);

/// Builds an HDF5 file, which appears when it is finished: no input or output can fail inside HDF5. Same calls, same
/// bytes: no times, fixed library bounds, contiguous, uncompressed. Bounds start at 1.8, whose metadata carry
/// checksums.
class Hdf5Writer {
 public:
  /// Links of `path` are followed (PendingFile::CreateOutput). Error kCannotWrite, also for a device or a pipe.
  static Expected<Hdf5Writer> Create(const std::filesystem::path& path);
  /// A dataset "/a/b" (its groups are made) or a text attribute "/@name". Texts are of fixed length, UTF-8,
  /// zero-padded.
  Status Write(const std::string& path, const Array& array);
  /// A dataset of numbers whose rows are written later, in any order.
  Status Make(const std::string& path, FieldType type, const std::vector<std::uint64_t>& shape);
  Status WriteRows(const std::string& path, std::uint64_t first, const Array& rows);
  /// A dataset or attribute as it was read (its dataset is there); a dataset whose rows are written later; its rows.
  Status WriteExtra(const std::string& path, const ExtraField& field);
  Status MakeExtra(const std::string& path, const ExtraField& field);
  Status WriteExtraRows(const std::string& path, std::uint64_t first, const ExtraField& rows);
  /// A text attribute of a dataset, or of the root "/". One that is there gets another text of the same length.
  Status AttributeOf(const std::string& path, const std::string& name, const std::string& text);
  /// Publishes the file. Error kCannotWrite, for all that was written before.
  Status Finish();

 private:
  Hdf5Writer(std::filesystem::path path, PendingFile file) : path_(std::move(path)), file_(std::move(file)) {}
  Status MakeGroups(const std::string& path);
  Expected<Hdf5Id> MakeDataset(const std::string& path, hid_t type, const std::vector<std::uint64_t>& shape);
  Status PutAttribute(hid_t object, const std::string& name, const std::string& text, const std::string& path);
  /// What failed in the file.
  Status Written() const;

  std::filesystem::path path_;
  PendingFile file_;  ///< outlives id_, as its driver's
  std::unique_ptr<DescriptorFile> driver_file_ = std::make_unique<DescriptorFile>();
  Hdf5Id id_;
  std::map<std::string, Hdf5Id> made_;  ///< datasets of Make
};

}  // namespace mocurate::store
