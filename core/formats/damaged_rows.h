#pragma once

namespace mocurate {

/// What a reader does about a damaged row: refuse the file, or mark what the row holds as missing, in its place, and
/// report it.
enum class DamagedRows { kRefuse, kReport };

}  // namespace mocurate
