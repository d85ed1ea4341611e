#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

/// The whole file as bytes. Error kNotFound, kUnreadable.
Expected<std::string> ReadFile(const std::filesystem::path& path);

/// The same in parts of at most 1 MiB, in order, for files that need not fit in memory.
Status ReadFileInParts(const std::filesystem::path& path, const std::function<void(std::string_view part)>& take);

/// A whole file of at most `most` bytes. Error kUnreadable as well for more bytes, a device, and a pipe unless `pipes`:
/// without it the call never waits.
Expected<std::string> ReadSmallFile(const std::filesystem::path& path, std::size_t most, bool pipes = false);

/// Writes a file atomically: temporary file in the same folder, fsync, rename, fsync of the
/// folder. A link is followed; a device or a pipe is written directly. Error kCannotWrite; the temporary file is
/// removed.
Status WriteFile(const std::filesystem::path& path, std::string_view bytes);

/// The same for a writer that needs a path (HDF5, OpenCV): `write` fills the temporary path it is given, which has the
/// extension of `path`. An error of `write` is passed on.
Status WriteFileWith(const std::filesystem::path& path,
                     const std::function<Status(const std::filesystem::path& temporary)>& write);

/// Makes a folder and its parents. Error kCannotWrite.
Status MakeFolder(const std::filesystem::path& path);

/// Text of a path that is safe in messages and JSON: control characters and bytes that are not UTF-8 are written as
/// \xNN, and so is a backslash before an x, so that PathFromText gives the same path back.
std::string DisplayPath(const std::filesystem::path& path);

/// Inverse of DisplayPath.
std::filesystem::path PathFromText(std::string_view text);

/// Offset of the first byte that is not UTF-8 (surrogates and overlong forms are not); empty when all are.
std::optional<std::size_t> FirstNotUtf8(std::string_view bytes);

}  // namespace mocurate
