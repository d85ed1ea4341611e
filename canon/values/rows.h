#pragma once

#include <string>
#include <vector>

#include "core/store/store.h"

namespace mocurate {

/// A clip id without its frames: source/person/recording.
std::string RecordingOf(const std::string& id);

/// Whether a finding is about a clip: about it, or about its whole recording, of which it was cut, in frames that it
/// has or without frames.
bool IsAbout(const Finding& finding, const Clip& clip);

/// Keeps some clips of a dataset: rows of splits follow, and findings about clips that leave go with them. Labels stay,
/// also those without a clip. Gives the rows that stay, in the numbers that they had.
std::vector<std::size_t> KeepRows(const std::vector<bool>& keep, Dataset& dataset);

/// Takes labels and fine labels without a clip out, the others close up.
void DropEmptyLabels(Dataset& dataset);

}  // namespace mocurate
