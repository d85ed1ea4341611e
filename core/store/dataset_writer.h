#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/store/extra_field.h"
#include "core/store/store.h"

namespace mocurate {
namespace store {
class MotionWriter;
}

/// Writes a dataset clip by clip. In memory are all fields except /frames, and the frames of one clip. The file has the
/// same bytes as with WriteDataset, and appears atomically.
///
///     auto writer = DatasetWriter::Create(outline, optional_fields, path);
///     for (...) writer->Append(clip);                          // in the order of outline.clips
///     writer->Finish();
class DatasetWriter {
 public:
  /// `outline` is the dataset without frames: of each clip's motion the skeleton, the rate, the counts of frames and
  /// joints and the bone lengths are looked at (DatasetClips::Outline; arrays of frames may be there).
  /// `optional_fields` are those that each clip's motion will have (OptionalFieldsOf). Error kInconsistent where this
  /// breaks a rule of the table, naming the clip or the field; kCannotWrite. `extra`: fields beyond the table, those of
  /// frames without values.
  static Expected<DatasetWriter> Create(const Dataset& outline, const std::vector<std::uint8_t>& optional_fields,
                                        const std::filesystem::path& path, ExtraFields extra = {});
  DatasetWriter(DatasetWriter&&) noexcept;
  DatasetWriter& operator=(DatasetWriter&&) noexcept;
  ~DatasetWriter();

  /// The frames of the next clip; all else is in the outline. Error kInconsistent naming the clip: it is not the next
  /// one, its motion differs from the outline, or breaks a rule; kCannotWrite. `frames`: its rows of each field of
  /// frames beyond the table.
  Status Append(const Clip& clip, const ExtraFields& frames = {});
  /// Error kInconsistent: clips are missing; kCannotWrite.
  Status Finish();

 private:
  explicit DatasetWriter(std::unique_ptr<store::MotionWriter> writer);
  std::unique_ptr<store::MotionWriter> writer_;
};

/// Which optional fields a motion has: bits of /clips/field_mask.
std::uint8_t OptionalFieldsOf(const Motion& motion);

}  // namespace mocurate
