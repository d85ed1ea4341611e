// Sources of a room are compiled several at a time (MOCURATE_UNITY): what two of them name alike in their unnamed
// namespaces is one name there. Functions of one name and other parameters would not even clash, but overload.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// What a line at file level declares: a function, a type or a constant; empty: nothing.
std::string DeclaredName(const std::string& line) {
  static const std::regex type("^(?:struct|class|enum class|enum) (\\w+)\\b(?!.*;$)");
  static const std::regex constant("^(?:constexpr|const|static)\\b[^(={]*?(\\w+)(?:\\[\\w*\\])? ?(?:=|\\{|;)");
  static const std::regex function(
      "^(?!using|namespace|return|template|typedef|friend|TEST|INSTANTIATE|extern|//)"
      "[A-Za-z_][\\w:<>,*& ]*[ >*&](\\w+)\\(");
  std::smatch match;
  for (const std::regex* declares : {&type, &function, &constant}) {
    if (std::regex_search(line, match, *declares)) return match[1];
  }
  return {};
}

/// Names that a source declares in its unnamed namespaces, as clang-format lays them out: nothing is indented there.
std::set<std::string> OwnNames(std::istream& source) {
  std::set<std::string> names;
  bool unnamed = false;
  for (std::string line; std::getline(source, line);) {
    if (line == "namespace {") unnamed = true;
    if (line == "}  // namespace") unnamed = false;
    const std::string name = unnamed ? DeclaredName(line) : std::string();
    if (!name.empty()) names.insert(name);
  }
  return names;
}

/// "core/quality", "ingest", "tests/ingest": sources that may be compiled together.
std::string UnitOf(const fs::path& path) {
  auto part = path.begin();
  const std::string top = part->string();
  return top == "core" || top == "tests" ? top + "/" + std::next(part)->string() : top;
}

/// Every name that several sources of a unit have: "Name: a.cpp b.cpp".
std::vector<std::string> SharedNames(const std::map<std::string, std::set<std::string>>& names_of_source) {
  std::map<std::pair<std::string, std::string>, std::string> sources;
  std::map<std::pair<std::string, std::string>, int> count;
  for (const auto& [path, names] : names_of_source) {
    for (const std::string& name : names) {
      const std::pair key(UnitOf(path), name);
      sources[key] += " " + path;
      ++count[key];
    }
  }
  std::vector<std::string> shared;
  for (const auto& [key, times] : count) {
    if (times > 1) shared.push_back(key.second + ":" + sources.at(key));
  }
  return shared;
}

TEST(Names, OfUnnamedNamespacesAreOfOneSourceOfARoom) {
  const fs::path root = MOCURATE_SOURCE_FOLDER;
  std::map<std::string, std::set<std::string>> names;
  std::size_t count = 0;
  for (const char* top : {"core", "ingest", "fitting", "canon", "train", "eval", "report", "app", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string path = fs::relative(entry.path(), root).string();
      if (entry.path().extension() != ".cpp" || path.rfind("tests/benchmarks/", 0) == 0) continue;  // a program each
      std::ifstream source(entry.path());
      names[path] = OwnNames(source);
      count += names[path].size();
    }
  }
  EXPECT_GT(count, 1000u) << "the source tree was not found";
  for (const std::string& shared : SharedNames(names)) {
    ADD_FAILURE() << shared << "\nname one of them after what it is, or share it in a header";
  }
}

TEST(Names, OfFunctionsTypesAndConstantsAreSeen) {
  std::istringstream source(R"(namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr double kNear = 0.3;  // metres
constexpr std::array<double, 2> kLimits = {0.1, 0.2};

struct Limb {
  int joint = -1;
};

std::map<std::string, int> CountOf(const Limb& limb) {
  const int inner = limb.joint;
  return {};
}

template <typename T>
Expected<T> Read(const std::string& name) {
  return {};
}

}  // namespace

int Public(int value) { return value; }

}  // namespace mocurate
)");
  EXPECT_EQ(OwnNames(source), (std::set<std::string>{"kNear", "kLimits", "Limb", "CountOf", "Read"}));
}

TEST(Names, OfTwoSourcesAreSharedInOneRoomAlone) {
  EXPECT_EQ(SharedNames({{"ingest/a.cpp", {"Read"}}, {"ingest/sense/b.cpp", {"Read"}}, {"fitting/c.cpp", {"Read"}}}),
            std::vector<std::string>{"Read: ingest/a.cpp ingest/sense/b.cpp"});
  EXPECT_TRUE(SharedNames({{"tests/ingest/a.cpp", {"Read"}}, {"tests/fitting/a.cpp", {"Read"}}}).empty());
}

}  // namespace
