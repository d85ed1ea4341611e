#include "core/formats/pickle_writer.h"

#include <cstring>
#include <limits>

#include "core/base/file.h"
#include "core/formats/array_elements.h"

namespace mocurate {
namespace {

void AppendLittle(std::uint64_t value, std::size_t count, std::string& bytes) {
  for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>((value >> (8 * i)) & 0xFF);
}

/// Latin-1 as UTF-8: protocol 2 has no bytes of its own, numpy writes them as a text to encode.
std::string Widened(std::string_view latin1) {
  std::string utf8;
  utf8.reserve(latin1.size() + latin1.size() / 2);
  for (const char c : latin1) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0 | (byte >> 6));
      utf8 += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return utf8;
}

}  // namespace

void PickleWriter::Counted(char opcode, std::string_view bytes) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) problem_ = "a text or array of 4 GiB and more";
  bytes_ += opcode;
  AppendLittle(bytes.size(), 4, bytes_);
  bytes_ += bytes;
}

void PickleWriter::BeginDict() {
  bytes_ += "}(";
  open_ += 'u';
}

void PickleWriter::BeginList() {
  bytes_ += "](";
  open_ += 'e';
}

void PickleWriter::BeginTuple() {
  bytes_ += '(';
  open_ += 't';
}

void PickleWriter::End() {
  if (open_.empty()) {
    problem_ = "a container ends that never began";
    return;
  }
  bytes_ += open_.back();
  open_.pop_back();
}

void PickleWriter::None() { bytes_ += 'N'; }

void PickleWriter::Bool(bool value) { bytes_ += value ? '\x88' : '\x89'; }

void PickleWriter::Integer(std::int64_t value) {
  if (value >= 0 && value < 256) {
    bytes_ += 'K';
    AppendLittle(static_cast<std::uint64_t>(value), 1, bytes_);
  } else if (value >= std::numeric_limits<std::int32_t>::min() && value <= std::numeric_limits<std::int32_t>::max()) {
    bytes_ += 'J';
    AppendLittle(static_cast<std::uint64_t>(value), 4, bytes_);
  } else {
    bytes_ += "\x8a\x08";
    AppendLittle(static_cast<std::uint64_t>(value), 8, bytes_);
  }
}

void PickleWriter::Float(double value) {
  bytes_ += 'G';
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, 8);
  for (int i = 7; i >= 0; --i) bytes_ += static_cast<char>((bits >> (8 * i)) & 0xFF);
}

void PickleWriter::Text(std::string_view text) {
  if (FirstNotUtf8(text)) problem_ = "a text that is not UTF-8";
  Counted('X', text);
}

void PickleWriter::Array(const NpyArray& array) {
  const std::optional<ElementType> type = ParseElementType(array.dtype);
  if (!type || type->kind == ElementKind::kObject) {
    problem_ = "an array of type '" + array.dtype + "'";
    return;
  }
  std::string data;
  const Status encoded = type->is_number() ? EncodeNumbers(*type, array.values, "array", data)
                                           : EncodeTexts(*type, array.texts, "array", data);
  if (!encoded) {
    problem_ = encoded.error().what;
    return;
  }
  if (!ElementCount(array.shape, type->bytes, data.size())) {
    problem_ = "an array of shape " + ShapeText(array.shape) + " with " + std::to_string(array.size()) + " elements";
    return;
  }
  const auto bytes = [&](std::string_view raw) {
    bytes_ += "c_codecs\nencode\n";
    Counted('X', Widened(raw));
    Counted('X', "latin1");
    bytes_ += "\x86R";
  };
  const bool has_order = std::string_view("<>=|").find(array.dtype[0]) != std::string_view::npos;
  bytes_ += "cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\n";
  Integer(0);
  bytes_ += '\x85';
  bytes("b");
  bytes_ += "\x87R(";
  Integer(1);
  BeginTuple();
  for (const std::size_t extent : array.shape) Integer(static_cast<std::int64_t>(extent));
  End();
  bytes_ += "cnumpy\ndtype\n";
  Counted('X', has_order ? array.dtype.substr(1) : array.dtype);
  bytes_ += "\x89\x88\x87R(";
  Integer(3);
  Counted('X', has_order && array.dtype[0] != '=' ? array.dtype.substr(0, 1) : "<");
  bytes_ += "NNN";
  // Only texts have a size and an alignment.
  Integer(type->is_number() ? -1 : static_cast<std::int64_t>(type->bytes));
  Integer(type->is_number() ? -1 : type->kind == ElementKind::kText ? 4 : 1);
  Integer(0);
  bytes_ += "tb\x89";
  bytes(data);
  bytes_ += "tb";
}

Expected<std::string> PickleWriter::Finish(const std::string& name) {
  if (problem_.empty() && !open_.empty()) problem_ = "a container is not ended";
  if (!problem_.empty()) return Fail(ErrorCode::kInconsistent, problem_ + " cannot be written", name);
  return bytes_ + ".";
}

}  // namespace mocurate
