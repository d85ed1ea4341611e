#include "core/formats/file_rules.h"

#include "core/base/file.h"
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

Status CheckPoseMemory(std::size_t joints, std::size_t frames, std::size_t bytes, const std::string& name) {
  constexpr std::uint64_t kPose = 7 * sizeof(double);
  const std::uint64_t most = MostUnpacked(bytes) / kPose;  // joints of all frames
  if (joints == 0 || frames <= most / joints) return {};
  return Fail(ErrorCode::kMalformed,
              Counted(static_cast<long long>(joints), "joint") + " in " +
                  Counted(static_cast<long long>(frames), "frame") + " take more memory than a file of " +
                  Counted(static_cast<long long>(bytes), "byte") + " may: " + std::to_string(most) +
                  " joints of all frames",
              name, "remove the joints that have no numbers, or cut the motion into files");
}

}  // namespace mocurate
