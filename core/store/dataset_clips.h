#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/store/extra_field.h"
#include "core/store/store.h"

namespace mocurate {

/// The clips of a dataset or MotionSet one at a time: /clips, /segments, /labels and /skeleton are kept in memory,
/// frames are read of one clip.
class DatasetClips {
 public:
  enum class Check {
    kHashes,  ///< everything against content_sha256 and the hashes of the fields, frames block by block
    kNone,    ///< each clip by the rules of the table when it is read
  };

  /// Errors of ReadDataset, as far as `check` looks.
  static Expected<DatasetClips> Open(const std::filesystem::path& path, Check check);

  std::size_t size() const;
  const std::string& Id(std::size_t row) const;
  const std::string& Label(std::size_t row) const;
  const AxisConvention& axes() const;
  const SkeletonPtr& skeleton() const;
  const std::vector<std::string>& labels() const;
  std::vector<Split> splits() const;
  std::string recipe() const;
  std::string created_by() const;
  /// Code of each finding, in their order.
  std::vector<std::string> finding_codes() const;

  /// Which optional fields of /frames a clip has: bits of /clips/field_mask.
  std::uint8_t OptionalFields(std::size_t row) const;
  std::string content_sha256() const;

  /// All but the frames: what ReadDataset gives, with motions that have skeleton, rate, counts of frames and joints,
  /// and bone lengths, but no arrays of frames. The rules of the table are checked, but for those of frames. Error
  /// kMalformed.
  Expected<Dataset> Outline() const;
  /// SHA-256 of a clip's motion as it is stored: rate, frames with their optional fields, bone lengths, rest offsets.
  /// Equal motions have equal ones in every file. Error kMalformed.
  Expected<std::string> MotionSha256(std::size_t row) const;

  /// What the file holds beyond the table.
  OtherFields ReadOtherFields() const;
  /// Frames [begin, end) of a clip, of one of its fields of_frames. Error kMalformed.
  Expected<ExtraField> ReadOtherFrames(const std::string& field, std::size_t row, int begin, int end) const;

  /// What ReadDataset gives at this place, `row` below size(). The rules of the table are checked. Error kMalformed.
  Expected<Clip> Read(std::size_t row) const;

 private:
  struct File;
  explicit DatasetClips(std::shared_ptr<const File> file) : file_(std::move(file)) {}
  std::shared_ptr<const File> file_;
};

}  // namespace mocurate
