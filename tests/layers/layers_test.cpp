// The allowed dependencies of the design: which module may include and link which, and where heavy libraries may be
// included.

#include <gtest/gtest.h>

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

const fs::path kRoot = mocurate::kSourceFolder;

/// Module -> modules that it may include besides itself.
const std::map<std::string, std::set<std::string>> kAllowed = {
    {"core/base", {}},
    {"core/geometry", {"core/base"}},
    {"core/motion", {"core/base", "core/geometry"}},
    {"core/quality", {"core/base", "core/geometry", "core/motion"}},
    {"core/body", {"core/base", "core/geometry", "core/motion"}},
    {"core/formats", {"core/base", "core/geometry"}},
    {"core/store", {"core/base", "core/geometry", "core/motion", "core/body"}},
    {"core/skin", {"core/base", "core/geometry", "core/motion", "core/body", "core/formats", "core/store"}},
    {"core/pipeline", {"core/base"}},
    {"ingest", {"core"}},
    {"fitting", {"core"}},
    {"canon", {"core"}},
    {"train", {"core"}},
    {"eval", {"core", "train/recognisers"}},
    {"report", {"core"}},
    {"job", {"core", "ingest", "fitting", "canon", "train", "eval", "report"}},
    {"app", {"job", "core", "ingest", "fitting", "canon", "train", "eval", "report"}},
};

/// Library -> its module.
const std::map<std::string, std::string> kModuleOfLibrary = {
    {"base", "core/base"},
    {"config", "core/base"},
    {"geometry", "core/geometry"},
    {"motion", "core/motion"},
    {"motion_yaml", "core/motion"},
    {"quality", "core/quality"},
    {"body", "core/body"},
    {"formats", "core/formats"},
    {"survey_files", "core/formats"},
    {"store", "core/store"},
    {"skin", "core/skin"},
    {"pipeline", "core/pipeline"},
    {"ingest", "ingest"},
    {"ingest_options", "ingest"},
    {"ingest_video", "ingest"},
    {"fitting", "fitting"},
    {"fitting_options", "fitting"},
    {"fitting_clouds", "fitting"},
    {"canon", "canon"},
    {"canon_options", "canon"},
    {"canon_exports", "canon"},
    {"canon_review", "canon"},
    {"canon_values", "canon"},
    {"train", "train"},
    {"train_options", "train"},
    {"recognisers", "train/recognisers"},
    {"checkpoint", "train"},
    {"eval", "eval"},
    {"eval_options", "eval"},
    {"eval_metrics", "eval"},
    {"eval_tables", "eval"},
    {"eval_fits", "eval"},
    {"report", "report"},
    {"report_options", "report"},
    {"report_survey", "report"},
    {"report_video", "report"},
    {"job", "job"},
};

/// Include prefix of a heavy library -> folders that may include it.
const std::map<std::string, std::set<std::string>> kHeavy = {
    {"torch/", {"train/", "eval/features/"}},
    {"ATen/", {"train/", "eval/features/"}},
    {"ceres/", {"fitting/"}},
    {"open3d/", {"fitting/clouds/"}},
    {"opencv2/", {"ingest/", "fitting/", "report/"}},
    {"yaml-cpp/", {"core/base/", "core/formats/"}},
    {"pugixml", {"core/formats/"}},
    {"toml++/", {"core/formats/"}},
    {"hdf5", {"core/store/", "train/", "tests/"}},
    {"zip.h", {"core/formats/"}},
    {"png.h", {"core/formats/"}},
    {"CLI/", {"app/"}},
};

/// Headers that other modules and installed users include: none of them may include a heavy library.
bool IsPublicHeader(const std::string& path) {
  if (path.size() < 2 || path.substr(path.size() - 2) != ".h") return false;
  if (path.rfind("core/", 0) == 0) return true;
  return std::regex_search(path, std::regex("(stages|options|discover|recogniser|table|fit_clouds)\\.h$"));
}

std::string ModuleOf(const std::string& path) {
  std::string best;
  for (const auto& [module, allowed] : kAllowed) {
    if (path.rfind(module + "/", 0) == 0 && module.size() > best.size()) best = module;
  }
  return best;
}

bool MayInclude(const std::string& module, const std::string& included) {
  if (included.rfind(module + "/", 0) == 0) return true;
  for (const std::string& allowed : kAllowed.at(module)) {
    if (included.rfind(allowed + "/", 0) == 0) return true;
  }
  return false;
}

std::vector<std::string> SourceFiles() {
  std::vector<std::string> files;
  for (const char* top : {"core", "ingest", "fitting", "canon", "train", "eval", "report", "job", "app"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".h" || extension == ".cpp") files.push_back(fs::relative(entry.path(), kRoot).string());
    }
  }
  return files;
}

std::string ReadText(const fs::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Forbidden include lines of one file's text; empty if it keeps to the allowed dependencies.
std::vector<std::string> ForbiddenIncludes(const std::string& path, const std::string& text) {
  std::vector<std::string> forbidden;
  const std::string module = ModuleOf(path);
  const std::regex include("^#include [\"<]([^\">]+)[\">]");
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    const std::string included = match[1];
    if (!ModuleOf(included).empty() && !MayInclude(module, included))
      forbidden.push_back(path + " includes " + included);
    for (const auto& [prefix, folders] : kHeavy) {
      if (included.rfind(prefix, 0) != 0) continue;
      bool allowed = false;
      for (const std::string& folder : folders) allowed = allowed || path.rfind(folder, 0) == 0;
      if (!allowed) forbidden.push_back(path + " includes " + included + " outside its module");
      if (prefix != "hdf5" && IsPublicHeader(path)) forbidden.push_back(path + " shows " + included + " publicly");
    }
  }
  return forbidden;
}

/// Forbidden links "library links library" of one CMakeLists text.
std::vector<std::string> ForbiddenLinks(const std::string& text) {
  std::vector<std::string> forbidden;
  const std::regex library("mocurate_library\\((\\w+)([^)]*)\\)");
  const std::regex linked("mocurate_(\\w+)");
  for (std::sregex_iterator it(text.begin(), text.end(), library), end; it != end; ++it) {
    const std::string name = (*it)[1];
    const auto module = kModuleOfLibrary.find(name);
    if (module == kModuleOfLibrary.end()) {
      forbidden.push_back(name + " has no module in the table");
      continue;
    }
    const std::string body = (*it)[2];
    for (std::sregex_iterator l(body.begin(), body.end(), linked); l != end; ++l) {
      const auto other = kModuleOfLibrary.find((*l)[1]);
      if (other == kModuleOfLibrary.end()) continue;
      const std::string own = module->second == "train/recognisers" ? "train" : module->second;
      if (!MayInclude(own, other->second + "/x")) forbidden.push_back(name + " links " + (*l)[1].str());
    }
  }
  return forbidden;
}

TEST(Layers, EveryIncludeIsAllowed) {
  std::size_t files = 0;
  for (const std::string& path : SourceFiles()) {
    ++files;
    for (const std::string& offence : ForbiddenIncludes(path, ReadText(kRoot / path))) ADD_FAILURE() << offence;
  }
  EXPECT_GT(files, 50u) << "the source tree was not found";
}

/// What a stage has to say about a clip or the set is a finding, which the job prints and keeps.
bool PrintsWarnings(const std::string& text) {
  return std::regex_search(text, std::regex("LogWarning|LogLevel::k(Warning|Error)|stderr|std::cerr"));
}

TEST(Layers, NoStagePrintsWarnings) {
  for (const std::string& path : SourceFiles()) {
    const std::string top = path.substr(0, path.find('/'));
    if (top == "core" || top == "job" || top == "app") continue;
    EXPECT_FALSE(PrintsWarnings(ReadText(kRoot / path))) << path << ": report a finding instead";
  }
  EXPECT_TRUE(PrintsWarnings("  LogWarning(\"a clip is odd\");"));
}

/// Only ParseJson bounds the depth of what it reads.
bool ParsesJson(const std::string& text) {
  return std::regex_search(text, std::regex("\\b(json|Json|ordered_json)\\s*::\\s*(parse|sax_parse|accept)\\s*\\("));
}

TEST(Layers, JsonIsReadByOneFunction) {
  const std::set<std::string> allowed = {
      "core/base/json_text.cpp",
      "ingest/inspect/file_kind.cpp",  // keeps keys alone
  };
  for (const std::string& path : SourceFiles()) {
    if (allowed.count(path) > 0) continue;
    EXPECT_FALSE(ParsesJson(ReadText(kRoot / path))) << path << ": use ParseJson";
  }
  EXPECT_TRUE(ParsesJson("  const auto value = nlohmann::json::parse(text, nullptr, false);"));
}

/// Names in files may hold what a terminal obeys: core/base/terminal.h escapes all that is printed.
bool WritesToTheTerminal(const std::string& text) {
  static const std::regex kWrites(
      "\\b(v?f?printf|fputs|puts|putchar|fputc|putc|perror)\\s*\\(|\\b(cout|cerr|clog)\\b|"
      "\\b(fwrite|write)\\([^;\n]*\\b(stdout|stderr|STDOUT_FILENO|STDERR_FILENO)\\b");
  return std::regex_search(text, kWrites);
}

TEST(Layers, OneWriterPrints) {
  const std::set<std::string> writers = {"core/base/terminal.cpp", "core/pipeline/progress.cpp"};
  for (const std::string& path : SourceFiles()) {
    EXPECT_TRUE(writers.count(path) == 1 || !WritesToTheTerminal(ReadText(kRoot / path)))
        << path << ": use Print, PrintJson or PrintError of core/base/terminal.h";
  }
  for (const char* line : {"std::printf(\"%s\", name);", "fprintf(stderr, \"x\")", "std::cout << name;",
                           "write(STDERR_FILENO, at, left)", "std::fwrite(a, 1, 2, stdout);"}) {
    EXPECT_TRUE(WritesToTheTerminal(line)) << line;
  }
  EXPECT_FALSE(WritesToTheTerminal("std::snprintf(text, sizeof text, \"%d\", 1); std::fflush(stdout);"));
}

TEST(Layers, EveryLinkIsAllowed) {
  for (const char* top : {"core", "ingest", "fitting", "canon", "train", "eval", "report"}) {
    const std::string text = ReadText(kRoot / top / "CMakeLists.txt");
    EXPECT_NE(text.find("mocurate_library"), std::string::npos) << top;
    for (const std::string& offence : ForbiddenLinks(text)) ADD_FAILURE() << offence;
  }
}

TEST(Layers, DetectsForbiddenDependencies) {
  EXPECT_EQ(ForbiddenIncludes("canon/x.cpp", "#include \"fitting/options.h\"\n").size(), 1u);
  EXPECT_EQ(ForbiddenIncludes("core/motion/x.cpp", "#include \"core/store/store.h\"\n").size(), 1u);
  EXPECT_EQ(ForbiddenIncludes("core/formats/x.cpp", "#include \"core/motion/clip.h\"\n").size(), 1u);
  EXPECT_EQ(ForbiddenIncludes("canon/x.cpp", "#include <torch/torch.h>\n").size(), 1u);
  EXPECT_EQ(ForbiddenIncludes("fitting/stages.h", "#include <ceres/ceres.h>\n").size(), 1u);
  EXPECT_TRUE(ForbiddenIncludes("eval/x.cpp", "#include \"train/recognisers/recogniser.h\"\n").empty());
  EXPECT_EQ(ForbiddenIncludes("eval/x.cpp", "#include \"train/trainer/trainer.h\"\n").size(), 1u);
  EXPECT_EQ(ForbiddenLinks("mocurate_library(canon SOURCES *.cpp PUBLIC mocurate_fitting)").size(), 1u);
  EXPECT_EQ(ForbiddenLinks("mocurate_library(motion SOURCES *.cpp PUBLIC mocurate_store)").size(), 1u);
}

}  // namespace
