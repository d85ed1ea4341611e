#include "ingest/sense/fault_codes.h"

#include "core/formats/header_count.h"
#include "core/formats/pickle.h"

namespace mocurate {

std::string FaultCode(const Error& error, std::string_view format) {
  const auto says = [&](std::string_view words) { return error.what.find(words) != std::string::npos; };
  if (AnnouncedCount(error)) return "count_contradiction";
  if (error.code == ErrorCode::kNotFound || error.code == ErrorCode::kUnreadable) return "unreadable";
  if (NamesForeignClass(error)) return "unsafe_pickle";
  if (error.code == ErrorCode::kUnsupported) return "no_motion";
  if (error.code != ErrorCode::kMalformed && error.code != ErrorCode::kInconsistent) {
    return std::string(Name(error.code));
  }
  if (says("the file is empty")) return "empty_file";
  const bool nobody = format == "ntu_skeleton" && error.code == ErrorCode::kInconsistent;
  if (says("no joint is seen") || nobody) return "no_joint_seen";
  const bool tree = format == "bvh" || format == "asf_amc";
  if (tree && error.code == ErrorCode::kInconsistent && says("skeleton '")) return "joints_contradiction";
  const bool layout = format == "joint_table" || format == "npy";
  return error.code == ErrorCode::kInconsistent && layout ? "layout_contradiction" : "malformed";
}

}  // namespace mocurate
