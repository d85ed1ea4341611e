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

/// What a line at file level declares: functions, types, aliases or constants.
std::vector<std::string> DeclaredNames(const std::string& line) {
  static const std::regex type("^(?:struct|class|enum class|enum) (\\w+)\\b(?!.*;$)");
  static const std::regex constant("^(?:constexpr|const|static)\\b[^(={]*?(\\w+)(?:\\[\\w*\\])? ?(?:=|\\{|;)");
  static const std::regex further(", (k[A-Z]\\w*) =");
  static const std::regex alias("^using (\\w+) = ");
  static const std::regex function(
      "^(?!using|namespace|return|template|typedef|friend|TEST|INSTANTIATE|extern|//)"
      "[A-Za-z_][\\w:<>,*& ]*[ >*&](\\w+)\\(");
  std::smatch match;
  for (const std::regex* declares : {&type, &alias, &function, &constant}) {
    if (!std::regex_search(line, match, *declares)) continue;
    std::vector<std::string> names = {match[1]};
    for (std::sregex_iterator it(line.begin(), line.end(), further), end; declares == &constant && it != end; ++it) {
      names.push_back((*it)[1]);
    }
    return names;
  }
  return {};
}

/// A source, as clang-format lays it out: nothing is indented in namespaces.
struct SourceNames {
  std::map<std::string, std::string> own;  ///< in its unnamed namespaces, with the line of those that are aliases
  std::set<std::string> shown;             ///< functions and types that other sources may see
};

SourceNames NamesIn(std::istream& source) {
  SourceNames names;
  bool unnamed = false;
  for (std::string line; std::getline(source, line);) {
    if (line == "namespace {") unnamed = true;
    if (line == "}  // namespace") unnamed = false;
    for (const std::string& name : DeclaredNames(line)) {
      if (unnamed) names.own.emplace(name, line.rfind("using ", 0) == 0 ? line : "");
      if (!unnamed) names.shown.insert(name);
    }
  }
  return names;
}

/// "core/quality", "ingest", "tests/ingest": sources that may be compiled together.
std::string UnitOf(const fs::path& path) {
  auto part = path.begin();
  const std::string top = part->string();
  return top == "core" || top == "tests" ? top + "/" + std::next(part)->string() : top;
}

/// Every name of an unnamed namespace that another source of the unit has too: "Name: a.cpp b.cpp". Aliases for the
/// same are none.
std::vector<std::string> SharedNames(const std::map<std::string, SourceNames>& names_of_source) {
  struct Use {
    std::set<std::string> own, shown, aliases;
  };
  std::map<std::pair<std::string, std::string>, Use> uses;
  for (const auto& [path, names] : names_of_source) {
    for (const auto& [name, alias] : names.own) {
      Use& use = uses[{UnitOf(path), name}];
      use.own.insert(path);
      use.aliases.insert(alias);
    }
    for (const std::string& name : names.shown) uses[{UnitOf(path), name}].shown.insert(path);
  }
  std::vector<std::string> shared;
  for (const auto& [key, use] : uses) {
    const bool one_alias = use.aliases.size() == 1 && !use.aliases.begin()->empty();
    std::set<std::string> sources = use.own;
    sources.insert(use.shown.begin(), use.shown.end());
    if (use.own.empty() || sources.size() < 2 || (one_alias && use.shown.empty())) continue;
    std::string text = key.second + ":";
    for (const std::string& source : sources) text += " " + source;
    shared.push_back(text);
  }
  return shared;
}

TEST(Names, OfUnnamedNamespacesAreOfOneSourceOfARoom) {
  const fs::path root = MOCURATE_SOURCE_FOLDER;
  std::map<std::string, SourceNames> names;
  std::size_t count = 0;
  for (const char* top : {"core", "ingest", "fitting", "canon", "train", "eval", "report", "app", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string path = fs::relative(entry.path(), root).string();
      if (entry.path().extension() != ".cpp" || path.rfind("tests/benchmarks/", 0) == 0) continue;  // a program each
      std::ifstream source(entry.path());
      names[path] = NamesIn(source);
      count += names[path].own.size();
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

constexpr double kNear = 0.3, kFar = 3.0;  // metres
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
  const SourceNames names = NamesIn(source);
  std::set<std::string> own;
  for (const auto& [name, alias] : names.own) own.insert(name);
  EXPECT_EQ(own, (std::set<std::string>{"Json", "kNear", "kFar", "kLimits", "Limb", "CountOf", "Read"}));
  EXPECT_EQ(names.shown, std::set<std::string>{"Public"});
}

TEST(Names, OfTwoSourcesAreSharedInOneRoomAlone) {
  const SourceNames reads{{{"Read", ""}}, {}}, json{{{"Json", "using Json = nlohmann::json;"}}, {}};
  EXPECT_EQ(SharedNames({{"ingest/a.cpp", reads}, {"ingest/sense/b.cpp", reads}, {"fitting/c.cpp", reads}}),
            std::vector<std::string>{"Read: ingest/a.cpp ingest/sense/b.cpp"});
  EXPECT_EQ(SharedNames({{"ingest/a.cpp", reads}, {"ingest/b.cpp", {{}, {"Read"}}}}).size(), 1u);
  EXPECT_EQ(SharedNames({{"ingest/a.cpp", json}, {"ingest/b.cpp", {{{"Json", "using Json = int;"}}, {}}}}).size(), 1u);
  EXPECT_TRUE(SharedNames({{"ingest/a.cpp", json}, {"ingest/b.cpp", json}}).empty());
  EXPECT_TRUE(SharedNames({{"tests/ingest/a.cpp", reads}, {"tests/fitting/a.cpp", reads}}).empty());
}

}  // namespace
