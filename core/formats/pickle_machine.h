#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/array_elements.h"
#include "core/formats/pickle.h"

namespace mocurate {

/// Known classes; see pickle_classes.cpp for their spellings.
enum class PickleClass {
  kOrderedDict,
  kReconstruct,
  kNdarray,
  kDtype,
  kScalar,
  kFromBuffer,
  kEncode,
  kBytes,
  kSet,  ///< of chumpy's objects; read as a list
  kObject,
  kReconstructor,
  kCsc,
  kCsr,
  kCh,
  kChSelect,
  kJoblibArray,
  kTensor,
  kParameter,
  kStorage,
};

struct PickleClassName {
  const char* name;  ///< module and class with a blank between
  PickleClass meaning;
  const char* dtype;  ///< of a storage
};

/// Null when the name is not in the list.
const PickleClassName* FindPickleClass(const std::string& name);

/// Elements of one tensor storage.
struct PickleStorage {
  std::string key;
  std::string dtype;
  std::size_t count = 0;
  std::string_view data;
  bool has_data = false;
};

/// The stack machine behind ParsePickle and ParseTorchPickle: reads one pickle after the other from `bytes` into one
/// list of values.
class PickleMachine {
 public:
  /// `persistent` allows persistent ids, which are PyTorch's storages.
  PickleMachine(std::string_view bytes, const std::string& name, const PickleLimits& limits, bool persistent);

  /// Position of the result of the next pickle; the next one may follow it.
  Expected<int> Read();
  /// Whether what hangs from `root` is free of cycles, not too deep, and not too large when written out.
  Status Check(int root) const;

  tl::unexpected<Error> Bad(const std::string& what, ErrorCode code = ErrorCode::kMalformed,
                            Reason reason = Reason::kNone) const {
    return Fail(code, what, pickle_.name + ": byte " + std::to_string(position_), "", reason);
  }
  bool Take(std::size_t count, std::string_view* data) {
    if (count > bytes_.size() - position_) return false;
    *data = bytes_.substr(position_, count);
    position_ += count;
    return true;
  }
  /// Little-endian unsigned number of `count` <= 8 bytes.
  Expected<std::uint64_t> TakeUnsigned(std::size_t count);
  void SkipTo(std::size_t position) { position_ = position; }
  std::size_t left() const { return bytes_.size() - position_; }
  PickleValue& At(int position) { return pickle_.values[static_cast<std::size_t>(position)]; }
  Pickle& pickle() { return pickle_; }
  std::vector<PickleStorage>& storages() { return storages_; }
  int FindStorage(std::string_view key) const;

 private:
  Status Step(unsigned char opcode);
  Status StepConstant(unsigned char opcode);
  Status StepStack(unsigned char opcode);
  Status StepNumber(unsigned char opcode);
  Status StepText(unsigned char opcode);
  Status StepContainer(unsigned char opcode);
  Status StepMemo(unsigned char opcode);
  Status StepClass(unsigned char opcode);
  Status Unknown(unsigned char opcode);

  // pickle_classes.cpp
  Status PushClass(const std::string& name);
  Status Reduce();
  Status NewObject(bool with_keywords);
  Status MakeObject(int type);
  Status Build();
  Status BuildObject(int object, int state);
  Status OrderedDict(const std::vector<int>& arguments);
  Status Encode(const std::vector<int>& arguments);
  Status PersistentId();

  // pickle_arrays.cpp
  PickleValue NewArray(PickleArray array = {});
  Status Dtype(const std::vector<int>& arguments);
  Status BuildDtype(PickleValue& dtype, const std::vector<int>& state);
  Status BuildArray(PickleValue& array, const std::vector<int>& state);
  Status FillArray(PickleValue& array, int shape, int dtype, bool fortran, int data);
  Status Scalar(const std::vector<int>& arguments);
  Status FromBuffer(const std::vector<int>& arguments);
  Status Tensor(const std::vector<int>& arguments);
  Status BuildSparse(PickleValue& object, PickleClass type, const PickleValue& state);
  Status BuildSelect(PickleValue& object, const PickleValue& state);
  Status ReadJoblibArray(PickleValue& object, const PickleValue& state);
  Expected<std::vector<std::size_t>> Shape(int tuple, const char* what);
  /// Position of the value under a text key of a dictionary; -1 when there is none.
  Expected<int> Attribute(const PickleValue& dict, std::string_view key);

  Status Push(PickleValue value);
  /// None, a truth value or a small number: equal ones share one value.
  Status PushConstant(PickleValue value);
  Status PushText(PickleKind kind, std::string_view text);
  Status PushBytes(std::string_view text);
  /// Keeps a text that is not in the file as written.
  Expected<std::string_view> Own(std::string text);
  Status Charge(std::size_t steps);
  Expected<std::string_view> TakeLine(const char* what);
  Expected<std::string_view> TakeCounted(std::size_t length_bytes, const char* what);
  /// Values above the last mark; the mark goes.
  Expected<std::vector<int>> PopToMark();
  /// Whether `count` values lie above the last mark.
  bool Has(std::size_t count) const { return stack_.size() - (marks_.empty() ? 0 : marks_.back()) >= count; }
  int Pop() {
    const int top = stack_.back();
    stack_.pop_back();
    return top;
  }
  Status Remember(std::uint64_t slot);
  Status Recall(std::uint64_t slot);

  std::string_view bytes_;
  std::size_t position_ = 0;
  PickleLimits limits_;
  bool persistent_ = false;
  Pickle pickle_;
  std::vector<int> stack_;
  std::vector<std::size_t> marks_;
  std::vector<int> memo_;
  std::size_t remembered_ = 0;
  std::vector<PickleStorage> storages_;
  std::map<std::string, int, std::less<>> storage_of_key_;
  std::int64_t charged_ = 0;
  std::size_t owned_bytes_ = 0;
  std::array<int, 259> constants_{};  ///< position + 1 of None, false, true, 0 to 255; 0: not yet there
};

/// Elements of an array in C order, gathered by its strides. Error when they reach outside the data.
Expected<std::string> GatherElements(const PickleArray& array, const std::string& name);

}  // namespace mocurate
