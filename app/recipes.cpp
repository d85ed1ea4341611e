#include "app/recipes.h"

#include <optional>
#include <vector>

#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr const char* kFolder = "sources/";

std::vector<std::string> Recipes() {
  std::vector<std::string> names;
  for (const std::string& path : ResourcePaths()) {
    if (path.rfind(kFolder, 0) != 0) continue;
    const std::string file = path.substr(std::string(kFolder).size());
    names.push_back(file.substr(0, file.rfind('.')));
  }
  return names;
}

}  // namespace

std::optional<ConfigSource> NamedRecipe(const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos) return std::nullopt;
  const auto text = FindResource(kFolder + name + ".yaml");
  if (!text) return std::nullopt;
  // By its place among the embedded files, so that a recipe may include another that lies beside it.
  return ConfigSource{std::string(*text), "resource:" + std::string(kFolder) + name + ".yaml", {}};
}

Expected<ConfigSource> RecipeOf(const std::string& name) {
  if (std::optional<ConfigSource> recipe = NamedRecipe(name)) return *std::move(recipe);
  std::error_code unknown;
  if (std::filesystem::is_regular_file(name, unknown)) {
    const Expected<std::string> text = ReadFile(name);
    if (!text) return Forward(text);
    return ConfigSource{*text, name, std::filesystem::absolute(name, unknown).parent_path()};
  }
  if (std::filesystem::is_directory(name, unknown)) {
    return Fail(ErrorCode::kUsage, "is a folder, not a config file", name,
                "`mocurate config init " + name + "` writes one from what it holds");
  }
  std::string list;
  for (const std::string& known : Recipes()) list += (list.empty() ? "" : ", ") + known;
  const std::optional<std::string> near = Nearest(name, Recipes());
  return Fail(ErrorCode::kUsage, "there is no recipe of that name", name,
              (near ? "did you mean '" + *near + "'? " : std::string()) + "known: " + list + "; or a config file");
}

}  // namespace mocurate
