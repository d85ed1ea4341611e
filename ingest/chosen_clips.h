#pragma once

#include <string>
#include <vector>

#include "ingest/discover.h"

namespace mocurate {

/// The last part of an item's name.
std::string RecordingOf(const ItemSpec& item);

/// Whether `wanted` names a clip: its item ("source/person/take"), its id ("source/person/take#0-80"), its recording,
/// its file with or without folders and ending, its place in a file of several ("[3]", "3", "[walk][3]"), or file and
/// place together ("clips.npy[3]", as `mocurate inspect` tells).
bool NamesClip(const std::string& wanted, const ItemSpec& item);
bool NamesClip(const std::string& wanted, const std::string& file, const std::string& place);

/// Leaves the clips that are named; empty: all. Error kUsage: a name that no clip has.
Status TakeOnly(const std::vector<std::string>& only, Discovery& discovery);

}  // namespace mocurate
