#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// One tensor of a PyTorch file, row-major whatever its strides were there.
struct TorchTensor {
  std::string name;                 ///< keys from the top joined by '/', e.g. "model/linear1.weight"
  std::string element;              ///< "float32", "float64", "int64", "int32", "int16", "int8", "uint8"
  std::vector<std::int64_t> shape;  ///< empty for a single number
  std::vector<double> values;
};

/// What a PyTorch file holds, as data.
struct TorchTable {
  std::vector<TorchTensor> tensors;       ///< in the order of the file
  std::map<std::string, double> numbers;  ///< integers, floats and truth values by name
  std::map<std::string, std::string> texts;

  /// Null when it does not exist.
  const TorchTensor* Find(std::string_view name) const;
};

/// Bounds on what a file may request, whatever it declares.
struct TorchLimits {
  std::int64_t elements = std::int64_t{1} << 27;    ///< over all tensors together
  std::int64_t objects = std::int64_t{1} << 20;     ///< while reading and when the table is made
  std::int64_t characters = std::int64_t{1} << 27;  ///< of all names and texts
  int depth = 64;                                   ///< of nested containers
};

/// Reads a file of torch.save, the zip form and the legacy one, with the stack machine of `pickle`: no code of the file
/// runs, every name or opcode outside its list is an error that names it. `name` is shown in messages. Errors
/// kMalformed, kUnsupported.
Expected<TorchTable> ParseTorchPickle(std::string_view bytes, const std::string& name, const TorchLimits& limits = {});
Expected<TorchTable> ReadTorchPickle(const std::filesystem::path& path, const TorchLimits& limits = {});

}  // namespace mocurate
