#include "core/formats/safetensors.h"

#include <algorithm>
#include <cstring>

#include "core/base/json_text.h"

namespace mocurate {
namespace {

constexpr std::size_t kLengthBytes = 8;
constexpr std::uint64_t kMostHeaderBytes = 100'000'000;  // the bound of the format's own reader
constexpr const char* kMetadata = "__metadata__";

std::uint64_t LengthOf(std::string_view bytes) {
  std::uint64_t length = 0;
  for (std::size_t i = kLengthBytes; i-- > 0;) length = (length << 8) | static_cast<unsigned char>(bytes[i]);
  return length;
}

/// Where the numbers of a tensor lie.
struct Span {
  Safetensors::Tensor tensor;
  std::uint64_t begin = 0, end = 0;
};

Expected<Span> SpanOf(const std::string& tensor, const nlohmann::json& entry, std::uint64_t size,
                      const std::string& where) {
  const auto malformed = [&](const std::string& what) {
    return Fail(ErrorCode::kMalformed, "tensor '" + tensor + "': " + what, where, "the file is damaged");
  };
  if (!entry.is_object() || !entry.contains("dtype") || !entry.contains("shape") || !entry.contains("data_offsets")) {
    return malformed("dtype, shape and data_offsets are needed");
  }
  if (entry["dtype"] != "F32") {
    return Fail(ErrorCode::kUnsupported, "tensor '" + tensor + "' is of type " + entry["dtype"].dump() + ", not F32",
                where, "store it as float32");
  }
  const nlohmann::json &shape = entry["shape"], &offsets = entry["data_offsets"];
  const auto whole = [](const nlohmann::json& value) { return value.is_number_unsigned(); };
  if (!shape.is_array() || !std::all_of(shape.begin(), shape.end(), whole) || !offsets.is_array() ||
      offsets.size() != 2 || !whole(offsets[0]) || !whole(offsets[1])) {
    return malformed("shape and data_offsets are whole numbers");
  }
  Span span;
  span.tensor.name = tensor;
  span.begin = offsets[0].get<std::uint64_t>();
  span.end = offsets[1].get<std::uint64_t>();
  std::uint64_t count = 1;
  for (const nlohmann::json& extent : shape) {
    const auto value = extent.get<std::uint64_t>();
    if (value > size || (value > 0 && count > size / value)) return malformed("its shape does not fit the file");
    count *= value;
    span.tensor.shape.push_back(static_cast<std::int64_t>(value));
  }
  if (span.begin > span.end || span.end > size || span.end - span.begin != count * sizeof(float)) {
    return malformed("bytes " + std::to_string(span.begin) + " to " + std::to_string(span.end) + " of " +
                     std::to_string(size) + " do not hold " + std::to_string(count) + " numbers");
  }
  return span;
}

}  // namespace

Expected<Safetensors> ParseSafetensors(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kLengthBytes) return Fail(ErrorCode::kMalformed, "the file ends in its first 8 bytes", name);
  const std::uint64_t length = LengthOf(bytes);
  if (length > kMostHeaderBytes || length > bytes.size() - kLengthBytes) {
    return Fail(ErrorCode::kMalformed,
                "the header has " + std::to_string(length) + " bytes, the file " + std::to_string(bytes.size()), name,
                "the file is not a safetensors file, or cut short");
  }
  const std::string_view text = bytes.substr(kLengthBytes, static_cast<std::size_t>(length));
  const Expected<nlohmann::json> header = ParseJson(text, name + ": header");
  if (!header) return Forward(header);
  if (!header->is_object()) return Fail(ErrorCode::kMalformed, "the header is not a JSON object", name);
  const std::string_view numbers = bytes.substr(kLengthBytes + static_cast<std::size_t>(length));
  Safetensors file;
  std::vector<Span> spans;
  for (const auto& [tensor, entry] : header->items()) {
    if (tensor == kMetadata) {
      if (!entry.is_object()) return Fail(ErrorCode::kMalformed, "__metadata__ is not an object of texts", name);
      for (const auto& [key, value] : entry.items()) {
        if (!value.is_string()) return Fail(ErrorCode::kMalformed, "__metadata__ is not an object of texts", name);
        file.metadata[key] = value.get<std::string>();
      }
      continue;
    }
    auto span = SpanOf(tensor, entry, numbers.size(), name);
    if (!span) return Forward(span);
    spans.push_back(std::move(*span));
  }
  std::sort(spans.begin(), spans.end(),
            [](const Span& a, const Span& b) { return std::pair(a.begin, a.end) < std::pair(b.begin, b.end); });
  std::uint64_t end = 0;
  for (Span& span : spans) {
    if (span.begin != end) {
      return Fail(ErrorCode::kMalformed,
                  "tensor '" + span.tensor.name + "' begins at byte " + std::to_string(span.begin) +
                      ", the one before it ends at " + std::to_string(end),
                  name, "the file is damaged");
    }
    end = span.end;
    span.tensor.values.resize(static_cast<std::size_t>((span.end - span.begin) / sizeof(float)));
    if (!span.tensor.values.empty()) {
      std::memcpy(span.tensor.values.data(), numbers.data() + span.begin,
                  static_cast<std::size_t>(span.end - span.begin));
    }
    file.tensors.push_back(std::move(span.tensor));
  }
  if (end != numbers.size()) {
    return Fail(ErrorCode::kMalformed, std::to_string(numbers.size() - end) + " bytes are not part of any tensor",
                name);
  }
  return file;
}

std::string EncodeSafetensors(const Safetensors& file) {
  nlohmann::json header = nlohmann::json::object();
  if (!file.metadata.empty()) header[kMetadata] = file.metadata;
  std::uint64_t end = 0;
  for (const Safetensors::Tensor& tensor : file.tensors) {
    const std::uint64_t begin = end;
    end += tensor.values.size() * sizeof(float);
    header[tensor.name] = {{"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {begin, end}}};
  }
  std::string text = header.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  text.resize((text.size() + 7) / 8 * 8, ' ');
  std::string bytes;
  for (std::size_t i = 0; i < kLengthBytes; ++i) bytes += static_cast<char>(text.size() >> (8 * i) & 0xFF);
  bytes += text;
  for (const Safetensors::Tensor& tensor : file.tensors) {
    bytes.append(reinterpret_cast<const char*>(tensor.values.data()), tensor.values.size() * sizeof(float));
  }
  return bytes;
}

}  // namespace mocurate
