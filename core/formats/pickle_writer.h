#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/npy.h"

namespace mocurate {

/// Writes a pickle of protocol 2 (read by Python 2 and 3) value by value, in order: a dictionary takes a key and its
/// value in turn. Same calls, same bytes. Errors (a type that numpy does not have, a shape that does not fit, a
/// container that is not ended) are kept and returned by Finish.
class PickleWriter {
 public:
  void BeginDict();
  void BeginList();
  void BeginTuple();
  void End();
  void None();
  void Bool(bool value);
  void Integer(std::int64_t value);
  void Float(double value);
  /// UTF-8.
  void Text(std::string_view text);
  /// numpy.ndarray of the array's own type, in C order.
  void Array(const NpyArray& array);

  Expected<std::string> Finish(const std::string& name);

 private:
  void Counted(char opcode, std::string_view bytes);

  std::string bytes_ = std::string("\x80\x02", 2);
  std::string open_;  ///< opcodes that will end the open containers
  std::string problem_;
};

}  // namespace mocurate
