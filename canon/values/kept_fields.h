#pragma once

#include <utility>
#include <vector>

#include "canon/values/set_files.h"

namespace mocurate {

/// Fields of datasets' files that the format does not name, in a dataset that is made of them.
struct KeptFields {
  ExtraFields fields;             ///< for DatasetWriter::Create: those of frames without values
  std::vector<Finding> findings;  ///< "field_dropped" for each of the others
};

/// The fields that all files have alike. Rows of clips and frames follow their clips. Dropped is a field that some file
/// lacks, that cannot be read, or that no longer fits: frames, clips or joints changed, or the group that it stands in;
/// one of the whole set also where the files' values differ. `repeated`: clips of several files, each with the origin
/// that was taken; their values must be equal. Frames of `made` are not looked at, but their numbers.
KeptFields KeepFields(const Dataset& made, const std::vector<ClipOrigin>& origins,
                      const std::vector<std::pair<ClipOrigin, ClipOrigin>>& repeated,
                      const std::vector<DatasetFile>& files);

}  // namespace mocurate
