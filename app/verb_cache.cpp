#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/commands.h"

namespace mocurate {

void AddCache(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<CacheArguments>();
  CLI::App* cache = app.add_subcommand("cache", "Inspect and clean the cache of finished work");
  cache->require_subcommand(1);
  const auto add = [&](const char* action, const char* help, const char* example) {
    CLI::App* sub = cache->add_subcommand(action, help);
    sub->footer(std::string("Example:\n  mocurate cache ") + example);
    sub->callback([&common, &verb, arguments, action] {
      arguments->action = action;
      verb = [&common, arguments] { return CacheVerb(common, *arguments); };
    });
    return sub;
  };
  add("stat", "Count objects and bytes", "stat");
  add("verify", "Compare every object with its recorded hash", "verify");
  CLI::App* prune = add("prune", "Remove objects not used recently", "prune --days 7");
  prune->add_option("--days", arguments->days, "remove objects unused for this many days (default 30)")
      ->check(CLI::Range(0.0, 36500.0));
  prune->add_flag("-n,--dry-run", arguments->dry_run, "show what would be removed, remove nothing");
}

}  // namespace mocurate
