#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canon/exports/layout.h"

namespace mocurate {

/// A layout of one file a clip in folders that say its names: LABEL/PERSON/RECORDING.ending, or with a fine label
/// LABEL/FINE_LABEL/PERSON/RECORDING.ending. What is no name for a file is written as one that is
/// (canon/exports/clip_names.h); "_" stands for no label.
struct LabelledFolder {
  std::string layout;
  std::string ending;  ///< ".csv"
  /// The file of a clip. Error: why it cannot be written.
  Expected<std::string> (*encode)(const Clip& clip, const ExportSet& set);
  /// Options of ingest.source, beside those about names, and their values in YAML. `rate` is the first clip's.
  std::vector<std::pair<std::string, std::string>> (*declare)(const ExportSet& set, const FrameRate& rate);
  bool holds_rate = false;   ///< each file says its rate
  bool says_rate = true;     ///< the declaration has to say the rate, whether the files do or not
  bool holds_tree = false;   ///< each file holds the tree of joints
  bool joint_table = false;  ///< read as joint tracks
};

std::unique_ptr<LayoutWriter> MakeLabelledFolder(const ExportSet& set, const LabelledFolder& folder);

}  // namespace mocurate
