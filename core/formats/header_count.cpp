#include "core/formats/header_count.h"

#include "core/base/text.h"

namespace mocurate {
tl::unexpected<Error> CountContradiction(const std::string& count, double announced, double found,
                                         const std::string& where, bool at_most) {
  return Fail(ErrorCode::kInconsistent,
              count + " announces " + FormatDouble(announced) + ", the file holds " + (at_most ? "at most " : "") +
                  FormatDouble(found),
              where,
              announced > found ? "the file is cut off, or its header is wrong: copy it again"
                                : "more follows than is announced: copy it again, or correct the header",
              Reason::kCount, announced);
}

}  // namespace mocurate
