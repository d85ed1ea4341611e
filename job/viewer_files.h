#pragma once

#include <filesystem>
#include <string>

#include "core/pipeline/runner.h"

namespace mocurate {

/// Folder beside a page of the viewer for the motions that are not in it: "demo_files" of demo.html.
std::string FolderBeside(const std::filesystem::path& page);

/// Puts what the stage `view` made where it is asked for: the page, and its parts into FolderBeside(page). Parts of an
/// earlier page that this one has not are removed. Error kCannotWrite, also for a link in the place of a part.
Status CopyViewer(const ItemResult& made, const std::filesystem::path& page);

/// body_cc0.h5 where FindBody finds it, else empty: pages are passed on, so that a body that may not be, SMPL, is never
/// taken without being asked for.
std::filesystem::path PassableBody();

}  // namespace mocurate
