// Clouds in files become a dataset.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/store/store.h"
#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::WriteText;

/// The vertices of a mesh, moved along z, as a PLY.
std::string CloudOf(const std::string& obj, double move) {
  std::istringstream lines(obj);
  std::ostringstream rows;
  std::size_t count = 0;
  std::string line, word;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    double x = 0.0, y = 0.0, z = 0.0;
    if (!(words >> word >> x >> y >> z) || word != "v") continue;
    rows << x << ' ' << y << ' ' << z + move << '\n';
    ++count;
  }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + rows.str();
}

TEST(CloudsRun, ADatasetAndAReportWithoutImages) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  const std::string body = ReadText(fs::path(data) / "body_cc0/male_tpose.obj");
  for (int frame = 1; frame <= 6; ++frame)
    WriteText(folder / ("scans/slide/scan_" + std::to_string(frame) + ".ply"), CloudOf(body, 0.02 * frame));
  WriteText(folder / "job.yaml",
            "name: scans\nskeleton: smpl24\ningest:\n  path: " + (folder / "scans").string() +
                "\n  source:\n    name: scans\n    format: clouds\n    files: \"{recording}/scan_{frame}.ply\"\n"
                "    units: m\n    axes: \"+x +y +z\"\n    rate: 10 Hz\n    person: p1\n"
                "    recording: \"{recording}\"\n    label: \"\"\n"
                "fitting: {method: point_clouds, solver: banded}\n");
  const program::Result run =
      program::RunProgram(folder, {"run", (folder / "job.yaml").string(), "-o", (folder / "r").string(), "--json",
                                   "--set", "report.videos=false", "--set", "report.clouds=true"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.Json()["kept"], 1);
  const auto dataset = ReadDataset(folder / "r/dataset.h5");
  ASSERT_TRUE(dataset) << dataset.error().Message();
  ASSERT_EQ(dataset->clips.size(), 1u);
  EXPECT_EQ(dataset->clips[0].motion->frame_count(), 6);
  const auto page = ReadFile(folder / "r/report/viewer.html");
  ASSERT_TRUE(page) << page.error().Message();
  EXPECT_NE(page->find("\"clouds\""), std::string::npos) << "the measured points, as asked for";
}

}  // namespace
}  // namespace mocurate
