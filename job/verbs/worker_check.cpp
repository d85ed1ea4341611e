#include "job/verbs/worker_check.h"

#include "core/base/text.h"
#include "job/run_and_capture.h"

namespace mocurate {
namespace {

struct LibraryPackage {
  std::string_view library;  ///< beginning of the file's name
  std::string_view package;
};

constexpr LibraryPackage kPackages[] = {{"libtorch", "libtorch1.13"},
                                        {"libc10", "libtorch1.13"},
                                        {"libOpen3D", "libopen3d0.16"},
                                        {"libceres", "libceres3"},
                                        {"libglog", "libgoogle-glog0v6"},
                                        {"libgflags", "libgflags2.2"},
                                        {"libcholmod", "libcholmod3"},
                                        {"libcxsparse", "libcxsparse3"},
                                        {"libopenblas", "libopenblas0-pthread"},
                                        {"libblas", "libopenblas0-pthread"},
                                        {"liblapack", "libopenblas0-pthread"},
                                        {"libgomp", "libgomp1"},
                                        {"libyaml-cpp", "libyaml-cpp0.7"},
                                        {"libpugixml", "libpugixml1v5"},
                                        {"libtomlplusplus", "libtomlplusplus3"},
                                        {"libopencv_core", "libopencv-core406"},
                                        {"libopencv_imgproc", "libopencv-imgproc406"},
                                        {"libopencv_imgcodecs", "libopencv-imgcodecs406"},
                                        {"libopencv_videoio", "libopencv-videoio406"},
                                        {"libhdf5_serial", "libhdf5-103-1"},
                                        {"libcrypto", "libssl3"},
                                        {"libstdc++", "libstdc++6"},
                                        {"libgcc_s", "libgcc-s1"}};

std::string LastLine(const std::string& text) {
  std::string last;
  for (const std::string_view line : SplitText(text, '\n')) {
    if (!Trim(line).empty()) last = std::string(Trim(line));
  }
  return last;
}

}  // namespace

std::string PackageOfLibrary(const std::string& library) {
  for (const LibraryPackage& known : kPackages) {
    if (library.compare(0, known.library.size(), known.library) == 0) return std::string(known.package);
  }
  return {};
}

WorkerCheck CheckWorkerProgram(const std::filesystem::path& program) {
  WorkerCheck check;
  // With this variable the dynamic linker lists the libraries it would load ("libx.so.1 => not found") and starts
  // nothing.
  const std::string listed = RunAndCapture(program, {"--version"}, "LD_TRACE_LOADED_OBJECTS=1").text;
  for (const std::string_view line : SplitText(listed, '\n')) {
    const std::size_t arrow = line.find(" => not found");
    if (arrow == std::string_view::npos) continue;
    const std::string name(Trim(line.substr(0, arrow)));
    check.missing.push_back({name, PackageOfLibrary(name)});
  }
  const ProgramAnswer answer = RunAndCapture(program, {"--version"}, "LC_ALL=C");
  check.starts = answer.exit_status == 0 && check.missing.empty();
  (check.starts ? check.version : check.last_output_line) = LastLine(answer.text);
  return check;
}

}  // namespace mocurate
