#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/formats/npy.h"

namespace mocurate {

enum class PickleKind {
  kNone,
  kBool,
  kInteger,
  kFloat,
  kText,   ///< UTF-8; a Python 2 string when it is ASCII
  kBytes,  ///< bytes, bytearray, other Python 2 strings
  kList,
  kTuple,
  kDict,
  kArray,    ///< numpy.ndarray, chumpy.ch.Ch, a tensor
  kSparse,   ///< scipy.sparse csc, csr
  kClass,    ///< a known class itself, not an object of it
  kDtype,    ///< numpy.dtype
  kStorage,  ///< of a tensor
  kObject,   ///< an object whose state did not come
};

/// One value. Values are in one list and refer to each other by position, so shared and deep ones need no copies.
struct PickleValue {
  PickleKind kind = PickleKind::kNone;
  int array = -1;             ///< of kArray, and for the shape of kSparse
  std::int64_t integer = 0;   ///< of kBool, kInteger
  double number = 0.0;        ///< of kFloat; may be NaN
  std::string_view text;      ///< of kText, kBytes; "csc" or "csr" of kSparse
  std::vector<int> children;  ///< items; key, value, key, value, ... of kDict; the list of items of an object array
};

/// Elements of an array as a view of the file.
struct PickleArray {
  std::string dtype;                 ///< "<f4", "|b1", "|O", ...; empty while its state has not come
  std::vector<std::size_t> shape;    ///< of kSparse: rows, columns
  std::vector<std::size_t> strides;  ///< in elements; empty for C order
  std::size_t offset = 0;            ///< of the first element, in elements
  std::string_view data;             ///< elements
  int storage = -1;                  ///< of a tensor: position of its storage
};

/// Entries of a sparse matrix, in the file's order.
struct SparseMatrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<std::size_t> row, column;
  std::vector<double> value;
};

class PickleRef;

/// What a pickle holds, as data: values point into the bytes that were read, which must outlive it.
class Pickle {
 public:
  Pickle() = default;
  Pickle(Pickle&&) = default;
  Pickle& operator=(Pickle&&) = default;

  PickleRef top() const;

  std::string name;
  std::deque<PickleValue> values;
  std::deque<PickleArray> arrays;
  std::deque<std::string> owned;  ///< texts and bytes that the file stores in another form
  int root = -1;
};

/// A value with the path that leads to it, for messages.
class PickleRef {
 public:
  PickleRef(const Pickle& pickle, int position, std::string path)
      : pickle_(&pickle), position_(position), path_(std::move(path)) {}

  const PickleValue& value() const { return pickle_->values[static_cast<std::size_t>(position_)]; }
  PickleKind kind() const { return value().kind; }
  const std::string& path() const { return path_; }
  int position() const { return position_; }
  /// Items of a list or tuple; pairs of a dictionary; else 0.
  std::size_t size() const;
  PickleRef Item(std::size_t i) const;
  PickleRef KeyAt(std::size_t i) const;
  PickleRef ValueAt(std::size_t i) const;
  /// The last value under a text key; empty when there is none or this is not a dictionary.
  std::optional<PickleRef> Find(std::string_view key) const;
  /// The same; error kMalformed that names the key.
  Expected<PickleRef> Key(std::string_view key) const;

  /// Finite number of a bool, integer, float or array of one element. Error kMalformed.
  Expected<double> Number() const;
  Expected<std::int64_t> Integer() const;
  /// Of a text, bytes, or array of one text; bytes must be UTF-8. Error kMalformed.
  Expected<std::string> Text() const;
  /// Of an array of numbers or texts, in C order; of a number an array without axes. NaN is passed on. Error
  /// kMalformed.
  Expected<NpyArray> Array() const;
  /// One entry of an array of numbers along its first axis, without that axis; of an array in C order nothing else is
  /// decoded. Error kMalformed.
  Expected<NpyArray> ArrayEntry(std::size_t entry) const;
  Expected<SparseMatrix> Sparse() const;
  /// Type and shape without the elements; null when this is not an array.
  const PickleArray* Layout() const;

  tl::unexpected<Error> Bad(const std::string& rule) const;

 private:
  const Pickle* pickle_;
  int position_;
  std::string path_;
};

/// "a text", "a dictionary", ... for messages.
const char* KindName(PickleKind kind);

/// Bounds on what a file may request, whatever it declares. In addition, a file of n bytes gives at most 4 n + 1 MiB of
/// texts, and at most 32 n + 64 MiB of shared values written out.
struct PickleLimits {
  std::int64_t objects = std::int64_t{1} << 22;
  int depth = 64;  ///< of nested containers
};

/// Protocols 0 to 5, joblib files that are not packed. A stack machine over data: nothing of the file runs. A fixed
/// list of class names stands for dictionaries, sets (read as lists), bytes, numpy arrays and scalars, scipy's sparse
/// matrices, chumpy arrays and joblib's wrappers; every other name or opcode is an error that names it. Errors
/// kMalformed, kUnsupported.
Expected<Pickle> ParsePickle(std::string_view bytes, const std::string& name, const PickleLimits& limits = {});

/// That error for a pickle inside another file, of arrays of objects or of PyTorch; it names `name`. Empty where all is
/// plain data, as far as it could be read.
std::optional<Error> ForeignClassIn(std::string_view bytes, const std::string& name);

/// Whether the bytes begin as a pickle of protocol 0 or 1, which has no magic number: whether they are opcodes with
/// arguments of their form, up to the end of `head` (the end of a pickle has to be the last byte). What the opcodes
/// would do is not asked: names of classes and opcodes that ParsePickle refuses are opcodes too.
bool BeginsAsOldPickle(std::string_view head);

}  // namespace mocurate
