#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/formats/humanact12_pickle.h"
#include "core/formats/vibe_pickle.h"
#include "core/motion/clip.h"
#include "ingest/options.h"

namespace mocurate {

/// One clip of a file that holds them all, by what the set says of it without its numbers.
struct ContainerEntry {
  std::string name;      ///< what ingest.source.files is matched with
  std::string label;     ///< where the set names it; empty otherwise
  int frames = 0;        ///< at most so many are of the clip; 0: all
  std::string left_out;  ///< why it is no clip
};

/// The clips of ingest.source.container below `folder`, in its order. UESTC: names, frame counts and classes stand in
/// info/ beside it; the second camera's moving view is left out. HumanAct12's pickle names none: "c0007_y04" are the
/// place in the file and the class, from 1. A dataset's are named by their ids. Errors of the formats; kNotFound names
/// the file that is missing.
Expected<std::vector<ContainerEntry>> EntriesOf(const SourceOptions& source, const std::filesystem::path& folder);

/// A pickle of thousands of clips is mapped and parsed once by a process, and kept until another is asked for. What is
/// kept is where each array stands, 5 KB per video of UESTC, and never its numbers: those of one clip are decoded at a
/// time.
Expected<VibeTrack> ReadUestcVideo(const std::filesystem::path& container, int entry, const std::string& name);
Expected<Clip> ReadMotionsEntry(const std::filesystem::path& container, int entry, const std::string& name);
Expected<HumanAct12Clip> ReadHumanAct12Entry(const std::filesystem::path& container, int entry,
                                             const std::string& name);

}  // namespace mocurate
