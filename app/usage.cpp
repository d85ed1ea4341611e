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

Error UnknownVerbOf(const std::string& called, const std::string& word, const std::vector<std::string>& verbs) {
  const auto near = Nearest(word, verbs);
  return {ErrorCode::kUsage, "there is no '" + called + " " + word + "'", "command line",
          near ? "did you mean '" + called + " " + *near + "'?" : "there are: " + JoinTexts(verbs)};
}

/// A path instead of a verb: suggests a verb for it.
Error UnknownFirstVerb(const std::filesystem::path& word, const std::vector<std::string>& verbs) {
  const bool config = word.extension() == ".yaml" || word.extension() == ".yml";
  std::error_code ignored;
  std::string meant = Nearest(word.native(), verbs).value_or("");
  if (config) meant = "run " + DisplayPath(word);
  if (!config && std::filesystem::exists(word, ignored)) meant = "inspect " + DisplayPath(word);
  return {ErrorCode::kUsage, "there is no verb '" + DisplayPath(word) + "'", "command line",
          meant.empty() ? "the verbs are: " + JoinTexts(verbs) : "did you mean 'mocurate " + meant + "'?"};
}

/// The verb that the words select, and its full name: "mocurate cache".
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

/// Unexpected words: an option that does not exist, or more words than the verb accepts.
Error Unexpected(const CLI::App& verb, const std::string& called, const std::vector<std::string>& words) {
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) { return word[0] == '-'; });
  const std::string help = "'" + called + " --help' lists the options";
  if (option == words.end()) {
    return {ErrorCode::kUsage, "'" + DisplayPath(words.front()) + "' is one word too many for '" + called + "'",
            "command line", help};
  }
  const std::string name = option->substr(0, option->find('='));
  return {ErrorCode::kUsage, "there is no option '" + DisplayPath(name) + "' of '" + called + "'", "command line",
          DidYouMean(name, OptionsOf(verb), help)};
}

}  // namespace

std::optional<Error> UnknownVerb(const CLI::App& app, int argc, char** argv) {
  const CLI::App* at = &app;
  std::string called = "mocurate";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::vector<std::string> verbs = VerbsOf(*at);
    if (verbs.empty()) break;                      // the rest are the verb's own words
    if (word.empty() || word[0] == '-') continue;  // all options before the last verb are flags
    if (std::find(verbs.begin(), verbs.end(), word) == verbs.end()) {
      return at == &app ? UnknownFirstVerb(word, verbs) : UnknownVerbOf(called, DisplayPath(word), verbs);
    }
    at = at->get_subcommand(word);
    called += " " + word;
  }
  return std::nullopt;
}

Error UsageError(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  if (const auto verb = UnknownVerb(app, argc, argv)) return *verb;
  std::string called;
  const CLI::App& verb = Reached(app, called);
  std::vector<std::string> words = app.remaining(true);
  words.erase(std::remove(words.begin(), words.end(), std::string()), words.end());
  if (!words.empty()) return Unexpected(verb, called, words);
  const std::vector<std::string> verbs = VerbsOf(verb);
  if (!verbs.empty()) {
    return {ErrorCode::kUsage, "'" + called + "' alone does nothing", "command line", "there are: " + JoinTexts(verbs)};
  }
  return {ErrorCode::kUsage, error.what(), "command line", "'" + called + " --help' has more information"};
}

}  // namespace mocurate
