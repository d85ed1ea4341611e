#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/store/content_file.h"
#include "core/store/fields.h"

namespace mocurate::store {

/// Writes a file with motions one by one: what `content` holds, and the frames as they come. Kept are the fields of the
/// clips and the frames of one motion.
class MotionWriter {
 public:
  /// `content` holds all but /frames and the spans of the clips. Errors of ContentWriter::Create; kInconsistent naming
  /// the clip.
  static Expected<MotionWriter> Create(const Schema& schema, Content content, const std::vector<MotionRow>& rows,
                                       const Skeleton& skeleton, bool joints_only, const std::filesystem::path& path);
  /// Empty after the last row.
  std::string NextId() const { return next_ < rows_.size() ? rows_[next_].id : ""; }
  /// The motion of the next row. Error kInconsistent naming the clip: it is not what the row announced, or breaks a
  /// rule of the table; kCannotWrite.
  Status Append(const Motion& motion);
  /// Its rows of a field beyond the table.
  Status AppendExtra(const std::string& field, const ExtraField& rows) { return writer_.AppendExtra(field, rows); }
  /// Error kInconsistent: motions are missing; kCannotWrite.
  Status Finish();

 private:
  struct Announced {
    std::string id;
    int frames;
    std::uint8_t optional_fields;
  };
  MotionWriter(ContentWriter writer, const Schema& schema, std::filesystem::path path)
      : writer_(std::move(writer)), schema_(&schema), path_(std::move(path)) {}

  ContentWriter writer_;
  const Schema* schema_;
  std::filesystem::path path_;
  bool joints_only_ = false;
  unsigned present_ = 0;  ///< optional fields that some motion has
  std::vector<Announced> rows_;
  std::size_t next_ = 0;
  Content rules_;  ///< what the rules of /frames look at: skeleton and /@kinematics
  std::vector<double> bone_lengths_, rest_offsets_;
};

}  // namespace mocurate::store
