#pragma once

namespace mocurate {

/// Where the sources lie, and the programs built from them. folders.cpp alone is compiled with these paths, so that
/// ccache serves another clone.
extern const char* const kSourceFolder;
extern const char* const kBinaryFolder;

}  // namespace mocurate
