#include "job/verbs/page_screen.h"

#include <unistd.h>

#include <cstdlib>

#include "core/base/file.h"
#include "core/base/text.h"
#include "job/run_and_capture.h"
#include "job/run_folder.h"
#include "job/stage_runs.h"
#include "report/html.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr double kSilence_s = 120.0;

/// Empty without a browser.
fs::path FindBrowser() {
  if (const char* given = std::getenv("MOCURATE_BROWSER"); given != nullptr && *given != '\0') return given;
  const char* path = std::getenv("PATH");
  for (const std::string_view folder : SplitText(path != nullptr ? path : "", ':')) {
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
      fs::path file = fs::path(folder) / name;
      if (!folder.empty() && access(file.c_str(), X_OK) == 0) return file;
    }
  }
  return {};
}

}  // namespace

Status WriteScreen(const fs::path& page, const std::string& corner, const fs::path& picture) {
  const fs::path browser = FindBrowser();
  if (browser.empty()) {
    return Fail(ErrorCode::kMissingOnHost, "no browser to show the page with", DisplayPath(page),
                "install chromium, or name one with MOCURATE_BROWSER");
  }
  const TemporaryFolder scratch;
  if (scratch.path().empty()) return TemporaryFolder::Missing();
  const fs::path shown = scratch.path() / "index.html";  // a URL may not have all characters of a path
  auto html = ReadFile(page);
  if (!html) return Forward(html);
  *html += "<p style=\"text-align: right; margin: 0 24px; max-width: none\">" + EscapeHtml(corner) + "</p>\n";
  if (Status written = WriteFile(shown, *html); !written) return written;
  std::error_code unknown;
  const fs::path written = scratch.path() / "page.png";
  std::vector<std::string> arguments = {"--headless",
                                        "--disable-gpu",
                                        "--use-angle=swiftshader",
                                        "--enable-unsafe-swiftshader",
                                        "--no-first-run",
                                        "--disable-background-networking",
                                        "--hide-scrollbars",
                                        "--virtual-time-budget=5000",
                                        "--window-size=1300,1620",
                                        "--user-data-dir=" + (scratch.path() / "profile").string(),
                                        "--screenshot=" + written.string(),
                                        "file://" + shown.string()};
  if (geteuid() == 0) arguments.insert(arguments.begin(), "--no-sandbox");  // Chromium's sandbox refuses root
  const ProgramAnswer answer = RunAndCapture(browser, arguments, {true, kSilence_s});
  if (!fs::is_regular_file(written, unknown)) {
    return Fail(ErrorCode::kInternal, "the browser wrote no picture: " + LastLine(answer.text), DisplayPath(browser),
                "open the page in a browser instead");
  }
  return CopyWhole(written, picture);
}

}  // namespace mocurate
