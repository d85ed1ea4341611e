#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// A safetensors file (github.com/huggingface/safetensors): a little-endian length of 8 bytes, a JSON header of that
/// length, then the numbers. Only F32 is read and written.
struct Safetensors {
  struct Tensor {
    std::string name;
    std::vector<std::int64_t> shape;
    std::vector<float> values;  ///< row-major
  };
  std::map<std::string, std::string> metadata;
  std::vector<Tensor> tensors;  ///< in the order of their numbers
};

/// Error kMalformed naming the tensor: a header that is not JSON, offsets that overlap, leave gaps or lie outside of
/// the file, a shape that does not fit its bytes; kUnsupported for another type than F32.
Expected<Safetensors> ParseSafetensors(std::string_view bytes, const std::string& name);

/// The bytes of a file. Same content, same bytes.
std::string EncodeSafetensors(const Safetensors& file);

}  // namespace mocurate
