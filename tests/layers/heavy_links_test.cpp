// Heavy libraries stay in their modules, also where no include shows them: in what a library or program links, directly
// or indirectly, and in headers that other modules include.

#include <gmock/gmock.h>
#include <stdio.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/folders.h"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const fs::path kSources = mocurate::kSourceFolder;
const char* const kModules[] = {"core", "ingest", "fitting", "canon", "train", "eval", "report", "job", "app"};

/// Link name of a heavy library (as a prefix) -> the targets that may name it.
const std::map<std::string, std::set<std::string>> kHeavyLinks = {
    {"Ceres::", {"mocurate_fitting"}},
    {"Open3D::", {"mocurate_fitting_clouds"}},
    {"opencv_",
     {"mocurate_ingest_video", "mocurate_fitting", "mocurate_fitting_clouds", "mocurate_report",
      "mocurate_report_video"}},
    {"mocurate_torch", {"mocurate_recognisers", "mocurate_train", "mocurate_eval"}},
    {"${TORCH_LIBRARIES}", {"mocurate_torch"}},
    {"yaml-cpp", {"mocurate_config", "mocurate_formats"}},
    {"CLI11::", {"mocurate"}},
};

/// Program -> heavy libraries that it must not reach through anything it links.
const std::map<std::string, std::vector<std::string>> kForbiddenReach = {
    {"mocurate", {"Ceres::", "Open3D::", "opencv_", "mocurate_torch"}},
    {"mocurate-annotate", {"mocurate_torch", "opencv_videoio"}},
    {"mocurate-video", {"Ceres::", "Open3D::", "mocurate_torch"}},
    {"mocurate-learn", {"Ceres::", "Open3D::", "opencv_", "CLI11::"}},
    {"mocurate_canon", {"Ceres::", "Open3D::", "opencv_", "mocurate_torch"}},
    {"mocurate_eval_metrics", {"Ceres::", "Open3D::", "opencv_", "mocurate_torch"}},
};

std::string ReadLinks(const fs::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

bool StartsWith(const std::string& text, const std::string& prefix) { return text.rfind(prefix, 0) == 0; }

/// Target -> targets that it links, PUBLIC or PRIVATE: both of a static library end up in the program.
using Links = std::map<std::string, std::set<std::string>>;

void AddLinks(const std::string& cmake, Links& links) {
  static const std::regex kCall("(mocurate_library|target_link_libraries)\\s*\\(\\s*([^\\s)]+)([^)]*)\\)");
  static const std::set<std::string> kKeywords = {"PUBLIC", "PRIVATE", "INTERFACE"};
  for (std::sregex_iterator it(cmake.begin(), cmake.end(), kCall), end; it != end; ++it) {
    const bool ours = (*it)[1] == "mocurate_library";
    std::set<std::string>& linked = links[ours ? "mocurate_" + (*it)[2].str() : (*it)[2].str()];
    std::istringstream words((*it)[3].str());
    bool listing = !ours;
    for (std::string word; words >> word;) {
      if (kKeywords.count(word) != 0) {
        listing = true;
      } else if (word == "SOURCES" || word == "EXCLUDE") {
        listing = false;
      } else if (listing) {
        linked.insert(word);
      }
    }
  }
}

std::vector<std::string> ForbiddenDirectLinks(const Links& links) {
  std::vector<std::string> forbidden;
  for (const auto& [target, linked] : links) {
    for (const std::string& name : linked) {
      for (const auto& [heavy, allowed] : kHeavyLinks) {
        if (StartsWith(name, heavy) && allowed.count(target) == 0) {
          forbidden.push_back(target + " links " + name + " outside its module");
        }
      }
    }
  }
  return forbidden;
}

std::vector<std::string> ForbiddenReach(const Links& links) {
  std::vector<std::string> forbidden;
  for (const auto& [program, heavies] : kForbiddenReach) {
    std::map<std::string, std::string> through = {{program, program}};
    std::vector<std::string> open = {program};
    while (!open.empty()) {
      const std::string target = open.back();
      open.pop_back();
      for (const std::string& heavy : heavies) {
        if (StartsWith(target, heavy)) forbidden.push_back("through " + through[target]);
      }
      const auto found = links.find(target);
      if (found == links.end()) continue;
      for (const std::string& next : found->second) {
        if (through.emplace(next, through[target] + " -> " + next).second) open.push_back(next);
      }
    }
  }
  return forbidden;
}

Links AllLinks() {
  Links links;
  for (const char* module : kModules) AddLinks(ReadLinks(kSources / module / "CMakeLists.txt"), links);
  return links;
}

/// "fitting/stages.h" -> its includes.
using Includes = std::map<std::string, std::vector<std::string>>;

Includes AllIncludes() {
  static const std::regex kInclude("^\\s*#\\s*include [\"<]([^\">]+)[\">]");
  Includes includes;
  for (const char* module : kModules) {
    for (const auto& entry : fs::recursive_directory_iterator(kSources / module)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp") continue;
      std::vector<std::string>& own = includes[fs::relative(entry.path(), kSources).string()];
      std::istringstream lines(ReadLinks(entry.path()));
      for (std::string line; std::getline(lines, line);) {
        std::smatch match;
        if (std::regex_search(line, match, kInclude)) own.push_back(match[1]);
      }
    }
  }
  return includes;
}

std::string TopFolder(const std::string& path) { return path.substr(0, path.find('/')); }

/// Headers of core, and headers that a file of another module includes, must not include a heavy library, directly or
/// indirectly.
std::vector<std::string> HeaviesShownPublicly(const Includes& includes) {
  std::set<std::string> open_to_others;
  for (const auto& [path, included] : includes) {
    if (StartsWith(path, "core/") && path.back() == 'h') open_to_others.insert(path);
    for (const std::string& header : included) {
      if (includes.count(header) != 0 && TopFolder(header) != TopFolder(path)) open_to_others.insert(header);
    }
  }
  std::vector<std::string> shown;
  for (const std::string& header : open_to_others) {
    std::set<std::string> seen = {header};
    std::vector<std::string> open = {header};
    while (!open.empty()) {
      const std::string path = open.back();
      open.pop_back();
      for (const std::string& next : includes.at(path)) {
        for (const char* heavy : {"torch/", "ATen/", "c10/", "ceres/", "open3d/", "opencv2/", "yaml-cpp/"}) {
          if (StartsWith(next, heavy)) shown.push_back(header + " shows " + next + " through " + path);
        }
        if (includes.count(next) != 0 && seen.insert(next).second) open.push_back(next);
      }
    }
  }
  return shown;
}

TEST(HeavyLinks, EachLibraryIsLinkedOnlyInItsModule) {
  const Links links = AllLinks();
  ASSERT_TRUE(links.count("mocurate") && links.count("mocurate_fitting")) << "the link lists were not found";
  EXPECT_THAT(ForbiddenDirectLinks(links), IsEmpty());
}

TEST(HeavyLinks, NoProgramReachesALibraryOfAnotherModule) { EXPECT_THAT(ForbiddenReach(AllLinks()), IsEmpty()); }

TEST(HeavyLinks, FrontEndLoadsNoHeavyLibrary) {
  const fs::path program = fs::path(mocurate::kBinaryFolder) / "mocurate";
  if (!fs::exists(program)) GTEST_SKIP() << "the learn slice has no front end";
  FILE* pipe = ::popen(("LC_ALL=C readelf -d '" + program.string() + "'").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string dynamic;
  for (int c = ::fgetc(pipe); c != EOF; c = ::fgetc(pipe)) dynamic += static_cast<char>(c);
  ASSERT_EQ(::pclose(pipe), 0);
  ASSERT_THAT(dynamic, HasSubstr("[libstdc++")) << "unexpected output of readelf";
  for (const char* heavy : {"[libtorch", "[libc10", "[libceres", "[libOpen3D", "[libopencv", "blas", "[libgomp"}) {
    EXPECT_THAT(dynamic, testing::Not(HasSubstr(heavy)));
  }
}

TEST(HeavyLinks, NoPublicHeaderIncludesAHeavyLibrary) {
  const Includes includes = AllIncludes();
  ASSERT_GT(includes.size(), 100u) << "the source tree was not found";
  EXPECT_THAT(HeaviesShownPublicly(includes), IsEmpty());
}

TEST(HeavyLinks, DetectsAForbiddenLink) {
  Links links;
  AddLinks("mocurate_library(canon SOURCES *.cpp PUBLIC mocurate_store PRIVATE\n Ceres::ceres)", links);
  EXPECT_THAT(ForbiddenDirectLinks(links), SizeIs(1));
  links.clear();
  AddLinks(
      "mocurate_library(fitting SOURCES a.cpp PRIVATE Ceres::ceres)\nmocurate_library(x SOURCES x.cpp PUBLIC "
      "mocurate_fitting)\n"
      "target_link_libraries(mocurate PRIVATE mocurate_x CLI11::CLI11)",
      links);
  EXPECT_THAT(ForbiddenDirectLinks(links), IsEmpty());
  EXPECT_THAT(ForbiddenReach(links),
              testing::ElementsAre("through mocurate -> mocurate_x -> mocurate_fitting -> Ceres::ceres"));
}

TEST(HeavyLinks, DetectsAHeavyLibraryBehindAnotherHeader) {
  const Includes includes = {
      {"fitting/a.h", {"fitting/b.h"}}, {"fitting/b.h", {"ceres/ceres.h"}}, {"app/x.cpp", {"fitting/a.h"}}};
  EXPECT_THAT(HeaviesShownPublicly(includes),
              testing::ElementsAre("fitting/a.h shows ceres/ceres.h through fitting/b.h"));
  EXPECT_THAT(HeaviesShownPublicly({{"fitting/b.h", {"ceres/ceres.h"}}, {"fitting/b.cpp", {"fitting/b.h"}}}),
              IsEmpty());
}

}  // namespace
