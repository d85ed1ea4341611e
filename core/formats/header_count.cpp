#include "core/formats/header_count.h"

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::string_view kAnnounces = " announces ";
constexpr std::string_view kHolds = ", the file holds ";

}  // namespace

tl::unexpected<Error> CountContradiction(const std::string& count, double announced, double held,
                                         const std::string& where, bool at_most) {
  return Fail(ErrorCode::kInconsistent,
              count + std::string(kAnnounces) + FormatDouble(announced) + std::string(kHolds) +
                  (at_most ? "at most " : "") + FormatDouble(held),
              where,
              announced > held ? "the file is cut off, or its header is wrong: copy it again"
                               : "more follows than is announced: copy it again, or correct the header");
}

std::optional<double> AnnouncedCount(const Error& error) {
  const std::size_t at = error.what.find(kAnnounces);
  const std::size_t end = error.what.find(kHolds);
  if (error.code != ErrorCode::kInconsistent || at == std::string::npos || end == std::string::npos)
    return std::nullopt;
  const std::size_t begin = at + kAnnounces.size();
  if (begin > end) return std::nullopt;
  return ParseDouble(std::string_view(error.what).substr(begin, end - begin));
}

}  // namespace mocurate
