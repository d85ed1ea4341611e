#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/options.h"
#include "core/pipeline/runner.h"

namespace mocurate {

/// What `Discover` says of an item beside the source's declaration. Options of the item under "item", where set.
struct ItemFacts {
  std::int64_t body = 0;         ///< which of several people in a file, from 1; 0: the file is of one
  std::int64_t entry = -1;       ///< index of the clip in the container; -1: the item is a file of its own
  std::string entry_name;        ///< its name there
  std::int64_t most_frames = 0;  ///< maximum number of frames of the clip; 0: all
  std::string array;             ///< the clip in a file of arrays, sources/array_clips.h
  bool labelled = false;         ///< `label` is the clip's, not what the name tells
  std::string label;
  std::string label_text;   ///< what the table of labels says, where `label` is another text
  std::string annotation;   ///< JSON of one BABEL sequence
  std::string role;         ///< of the file of annotations
  std::string known_issue;  ///< what a list says of the recording

  void Declare(OptionVisitor& v);
  /// Where the clip stands in its file: "[3]", also of people, "[walk][3]"; empty: it is the file.
  std::string Place() const;
};

ItemFacts FactsOf(const ItemSpec& item);
void SetFacts(const ItemFacts& facts, ItemSpec& item);
/// Takes the facts out of an item's options: the declaration is left. Errors of OptionsFromJson.
Expected<ItemFacts> TakeFacts(nlohmann::json& options);

}  // namespace mocurate
