#pragma once

#include <algorithm>
#include <iterator>
#include <string>

#include "core/base/random.h"

namespace mocurate::test {

/// One to four edits: a byte changed, a piece removed, duplicated or replaced by a token that formats parse.
inline std::string Mutated(std::string bytes, Random& random) {
  static const std::string kSpices[] = {"nan",
                                        "-",
                                        "1e999",
                                        "{",
                                        "}",
                                        "\n",
                                        "\r",
                                        "\0x",
                                        "99999999999999999999",
                                        ":",
                                        "CHANNELS 6",
                                        "JOINT a\n{\n",
                                        "End Site\n{\n",
                                        "[",
                                        "]",
                                        "\"",
                                        "(",
                                        ",",
                                        "\xFF",
                                        "-1",
                                        "0",
                                        "4294967296",
                                        "null"};
  const std::uint64_t edits = 1 + random.Below(4);
  for (std::uint64_t i = 0; i < edits && !bytes.empty(); ++i) {
    const std::size_t at = random.Below(bytes.size());
    const std::size_t length = std::min<std::size_t>(random.Below(64), bytes.size() - at);
    switch (random.Below(5)) {
      case 0:
        bytes[at] = static_cast<char>(random.Next() & 0xFF);
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 3:
        bytes.insert(at, kSpices[random.Below(std::size(kSpices))]);
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

}  // namespace mocurate::test
