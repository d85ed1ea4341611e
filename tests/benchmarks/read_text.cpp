// bench_read_text kard | bvh | ntu | florence [REPEATS]: every file of a set, already in memory, read by our readers.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/formats/bvh.h"
#include "core/formats/joint_table.h"
#include "core/formats/ntu_skeleton.h"
#include "tests/benchmarks/json_line.h"

namespace {

using namespace mocurate;

std::vector<std::string> Load(const std::filesystem::path& folder, const std::string& ending) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.size() > ending.size() && name.substr(name.size() - ending.size()) == ending) paths.push_back(entry);
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> files;
  for (const auto& path : paths) files.push_back(ReadFile(path).value());
  return files;
}

/// How many values the file holds; 0: it is refused.
std::size_t Read(const std::string& set, const std::string& bytes) {
  if (set == "bvh") {
    const auto bvh = ParseBvh(bytes, "file");
    return bvh ? bvh->values.size() : 0;
  }
  if (set == "ntu") {
    const auto skeleton = ParseNtuSkeleton(bytes, "file");
    return skeleton ? skeleton->frames.size() : 0;
  }
  JointTableLayout layout;
  layout.rows_per_frame = 15;
  const auto table = ParseJointTable(bytes, layout, "file");
  return table ? table->values.size() : 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string set = argc > 1 ? argv[1] : "kard";
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 5;
  const char* data = std::getenv("MOCURATE_TEST_DATA");
  if (data == nullptr) return std::fprintf(stderr, "MOCURATE_TEST_DATA is not set\n"), 1;
  const std::filesystem::path root = data;
  const std::vector<std::string> files = set == "bvh"        ? Load(root / "bvh/bandai1", ".bvh")
                                         : set == "ntu"      ? Load(root / "ntu", ".skeleton")
                                         : set == "florence" ? Load(root / "kinect/florence3d", ".txt")
                                                             : Load(root / "kinect/kard", "_realworld.txt");
  double megabytes = 0;
  for (const std::string& bytes : files) {
    megabytes += static_cast<double>(bytes.size()) / 1e6;
    if (Read(set, bytes) == 0) return std::fprintf(stderr, "a file of %s is refused\n", set.c_str()), 1;
  }
  benchmarks::Report(("read_" + set).c_str(), megabytes, "MB", repeats, [&] {
    std::size_t values = 0;
    for (const std::string& bytes : files) values += Read(set, bytes);
    if (values == 0) std::abort();
  });
  return 0;
}
