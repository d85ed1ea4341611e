#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canon/exports/layout.h"

namespace mocurate {

/// A layout of one file per clip, named by its folders: LABEL/PERSON/RECORDING.ending, or with a fine label
/// LABEL/FINE_LABEL/PERSON/RECORDING.ending. Texts are converted to file names (canon/exports/clip_names.h); "_" means
/// no label.
struct LabelledFolder {
  std::string layout;
  std::string ending;  ///< ".csv"
  /// The file of a clip, or the error that prevents it.
  Expected<std::string> (*encode)(const Clip& clip, const ExportSet& set);
  /// Options of ingest.source, except those for names, and their values in YAML. `rate` is the first clip's.
  std::vector<std::pair<std::string, std::string>> (*declare)(const ExportSet& set, const FrameRate& rate);
  bool holds_rate = false;              ///< each file states its rate
  bool declares_rate = true;            ///< the declaration must state the rate, even where the files do
  bool holds_tree = false;              ///< each file contains the tree of joints
  bool joint_table = false;             ///< read as joint tracks
  const char* not_in_joint_names = "";  ///< characters that the files' names of joints cannot hold
};

std::unique_ptr<LayoutWriter> MakeLabelledFolder(const ExportSet& set, const LabelledFolder& folder);

}  // namespace mocurate
