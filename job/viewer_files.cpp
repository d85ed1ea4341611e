#include "job/viewer_files.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/text.h"
#include "job/config_loading.h"
#include "job/run_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

std::string PartFile(int part) { return "part_" + ZeroPadded(part, 4) + ".js"; }

}  // namespace

std::string FolderBeside(const fs::path& page) { return page.stem().string() + "_files"; }

Status CopyViewer(const ItemResult& made, const fs::path& page) {
  const fs::path beside = page.parent_path() / FolderBeside(page);
  const int parts = made.summary.at("parts").get<int>();
  for (const fs::path& folder : {page.parent_path(), parts > 0 ? beside : fs::path()}) {
    if (folder.empty()) continue;
    if (Status there = MakeFolder(folder); !there) return there;
  }
  for (int part = 0; part < parts; ++part) {
    const fs::path file = beside / PartFile(part);
    if (Status plain = CheckNotLink(file); !plain) return plain;
    if (Status copied = CopyWhole(fs::path(made.artifact) / PartFile(part), file); !copied) return copied;
  }
  std::error_code gone;
  for (int part = parts; fs::is_regular_file(fs::symlink_status(beside / PartFile(part), gone)); ++part) {
    fs::remove(beside / PartFile(part), gone);
  }
  return CopyWhole(fs::path(made.artifact) / "index.html", page);
}

fs::path PassableBody() {
  const fs::path found = FindBody();
  return found.filename() == "body_cc0.h5" ? found : fs::path();
}

}  // namespace mocurate
