#include "tests/support/folders.h"

namespace mocurate {

const char* const kSourceFolder = MOCURATE_SOURCE_FOLDER;
const char* const kBinaryFolder = MOCURATE_BINARY_FOLDER;

}  // namespace mocurate
