#include "app/usage.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

std::vector<std::string> VerbsOf(const CLI::App& app) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    verbs.push_back(verb->get_name());
  }
  return verbs;
}

std::string ListedNames(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// The first word that is no option, when it is no verb either: what was meant.
std::optional<Error> UnknownVerb(const CLI::App& app, int argc, char** argv) {
  const auto word = std::find_if(argv + 1, argv + argc, [](const char* text) { return text[0] != '-'; });
  if (word == argv + argc) return std::nullopt;
  const std::vector<std::string> verbs = VerbsOf(app);
  if (std::find(verbs.begin(), verbs.end(), *word) != verbs.end()) return std::nullopt;
  const std::filesystem::path path(*word);
  const bool config = path.extension() == ".yaml" || path.extension() == ".yml";
  std::error_code ignored;
  const auto near = Nearest(*word, verbs);
  std::string meant = near ? *near : "";
  if (config) meant = "run " + DisplayPath(path);
  if (!config && std::filesystem::exists(path, ignored)) meant = "inspect " + DisplayPath(path);
  return Error{ErrorCode::kUsage, "there is no verb '" + DisplayPath(path) + "'", "command line",
               meant.empty() ? "the verbs are: " + ListedNames(verbs) : "did you mean 'mocurate " + meant + "'?"};
}

/// The verb that the words led to, and how it is called: "mocurate cache".
const CLI::App& Reached(const CLI::App& app, std::string& called) {
  const CLI::App* at = &app;
  for (called = "mocurate"; !at->get_subcommands().empty(); called += " " + at->get_name()) {
    at = at->get_subcommands().front();
  }
  return *at;
}

/// "--set" of an option that is also "-s".
std::vector<std::string> OptionsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* at = &app; at != nullptr; at = at->get_parent()) {
    for (const CLI::Option* option : at->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

Error Unexpected(const CLI::App& verb, const std::string& called, const std::vector<std::string>& words) {
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) { return word[0] == '-'; });
  const std::vector<std::string> verbs = VerbsOf(verb);
  const std::string help = "'" + called + " --help' lists what there is";
  if (option != words.end() && (verbs.empty() || words.size() == 1)) {
    const std::string name = option->substr(0, option->find('='));
    const auto near = Nearest(name, OptionsOf(verb));
    return {ErrorCode::kUsage, "there is no option '" + DisplayPath(name) + "' of '" + called + "'", "command line",
            near ? "did you mean '" + *near + "'?" : help};
  }
  const auto word = std::find_if(words.begin(), words.end(), [](const std::string& text) { return text[0] != '-'; });
  const std::string text = DisplayPath(word == words.end() ? words.front() : *word);
  if (verbs.empty()) {
    return {ErrorCode::kUsage, "'" + text + "' is one word too many for '" + called + "'", "command line", help};
  }
  const auto near = Nearest(text, verbs);
  return {ErrorCode::kUsage, "there is no '" + called + " " + text + "'", "command line",
          near ? "did you mean '" + called + " " + *near + "'?" : "there are: " + ListedNames(verbs)};
}

}  // namespace

Error UsageError(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  if (const auto verb = UnknownVerb(app, argc, argv)) return *verb;
  std::string called;
  const CLI::App& verb = Reached(app, called);
  std::vector<std::string> words = app.remaining(true);
  words.erase(std::remove(words.begin(), words.end(), std::string()), words.end());
  if (!words.empty()) return Unexpected(verb, called, words);
  const std::vector<std::string> verbs = VerbsOf(verb);
  if (!verbs.empty()) {
    return {ErrorCode::kUsage, "'" + called + "' alone does nothing", "command line",
            "there are: " + ListedNames(verbs)};
  }
  return {ErrorCode::kUsage, error.what(), "command line", "'" + called + " --help' tells more"};
}

}  // namespace mocurate
