#pragma once

// Which links are followed when files are written: those of the path that the user names, none of the names that the
// program chooses below it. So a folder from elsewhere cannot make the program write outside of it.

#include <filesystem>

#include "core/base/error.h"

namespace mocurate {

/// Whether another user may have put this name into a folder that all may write, as /tmp: it is neither ours nor the
/// folder's owner's (the rule of Linux' fs.protected_symlinks).
bool MadeByAnother(const std::filesystem::path& path);

/// The file that is written for a path that the user names: a link is followed, also to a device or a pipe. Error
/// kCannotWrite for a link, a device or a pipe that is MadeByAnother.
Expected<std::filesystem::path> OutputOf(const std::filesystem::path& named);

/// Error kCannotWrite for a link, a pipe or a device; none for a file, a folder, or where nothing is.
Status CheckNotLink(const std::filesystem::path& path);
/// The same of a path and of all that lies below it.
Status CheckNoLinks(const std::filesystem::path& path);

/// `folder`/`name`, for a file with a name of the program below a folder that the user names; the folders of `name` are
/// made. Error kCannotWrite; also where one of them, or the file, is not CheckNotLink.
Expected<std::filesystem::path> FileBelow(const std::filesystem::path& folder, const std::filesystem::path& name);
/// The same for a folder, which is made.
Expected<std::filesystem::path> FolderBelow(const std::filesystem::path& folder, const std::filesystem::path& name);

/// Opens a file that is changed in place (a lock, a journal) for reading and writing; made when missing. `flags`: e.g.
/// O_APPEND. Error kCannotWrite; also for a link, a device, a pipe, and, where it is `written`, a file with another
/// name (hard link).
Expected<int> OpenInPlace(const std::filesystem::path& path, int flags, bool written = true);

}  // namespace mocurate
