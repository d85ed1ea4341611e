#include "ingest/checks/fault_codes.h"

namespace mocurate {

std::string FaultCode(const Error& error, std::string_view format) {
  if (error.reason == Reason::kCount) return "count_contradiction";
  if (error.code == ErrorCode::kNotFound || error.code == ErrorCode::kUnreadable) return "unreadable";
  if (error.reason == Reason::kUnsafePickle) return "unsafe_pickle";
  if (error.code == ErrorCode::kUnsupported) return "no_motion";
  if (error.code != ErrorCode::kMalformed && error.code != ErrorCode::kInconsistent) {
    return std::string(Name(error.code));
  }
  if (error.reason == Reason::kEmptyFile) return "empty_file";
  if (error.reason == Reason::kNoValidSamples) return "no_joint_seen";
  if (error.reason == Reason::kPersonMissing) return "people_missing";
  if (error.reason == Reason::kOtherTree) return "joints_contradiction";
  if (error.reason == Reason::kOtherLayout) return "layout_contradiction";
  if (error.reason == Reason::kOtherRate) return "rate_contradiction";
  if (error.reason == Reason::kViewNumbering) return "view_numbering";
  const bool layout = format == "joint_table" || format == "npy";
  return error.code == ErrorCode::kInconsistent && layout ? "layout_contradiction" : "malformed";
}

}  // namespace mocurate
