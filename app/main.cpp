// The command: parses the command line, calls one verb, turns its result into an exit code.

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/usage.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/version.h"
#include "job/verbs/verbs.h"

namespace {

using namespace mocurate;

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 more failures than tolerated; 2 usage or config; 3 input unusable; 4 something is missing "
    "on\n"
    "this machine (see mocurate doctor); 70 a defect of mocurate; 74 output cannot be written; 75 interrupted, run "
    "again to continue.";

void PrintErrorDocument(const Error& error, int exit_code) {
  const nlohmann::json document = {{"error",
                                    {{"code", Name(error.code)},
                                     {"what", error.what},
                                     {"where", error.where},
                                     {"hint", error.hint},
                                     {"exit_code", exit_code}}},
                                   {"findings",
                                    {{{"code", Name(error.code)},
                                      {"severity", "error"},
                                      {"where", error.where},
                                      {"value", nullptr},
                                      {"message", error.what + (error.hint.empty() ? "" : " (" + error.hint + ")")}}}}};
  PrintJson(document);
}

int Report(const Status& status, const CommonArguments& common) {
  if (status) return static_cast<int>(ExitCode::kDone);
  const Error& error = status.error();
  const int exit_code = static_cast<int>(ExitCodeOf(error.code));
  if (common.json && !common.answered) PrintErrorDocument(error, exit_code);
  PrintError("mocurate: " + error.Message() + "\n");
  return exit_code;
}

/// Help and version as one document: the text otherwise printed to stdout.
void PrintAnswer(const CLI::App& app, const CLI::ParseError& asked) {
  const bool version = dynamic_cast<const CLI::CallForVersion*>(&asked) != nullptr;
  const nlohmann::json document =
      version ? nlohmann::json{{"program", "mocurate"}, {"version", Version()}} : nlohmann::json{{"help", app.help()}};
  PrintJson(document);
}

/// Help and version are printed to stdout without an error, unless they are requested for a verb that does not exist;
/// all else is wrong usage.
int ReportParse(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  CommonArguments common;
  common.json = std::any_of(argv, argv + argc, [](const char* word) { return std::strcmp(word, "--json") == 0; });
  if (error.get_exit_code() != 0) return Report(tl::unexpected<Error>(UsageError(app, error, argc, argv)), common);
  if (const auto unknown = UnknownVerb(app, argc, argv)) return Report(tl::unexpected<Error>(*unknown), common);
  if (!common.json) return app.exit(error);
  PrintAnswer(app, error);
  return 0;
}

/// Redirects stdout to /dev/null, whichever verb prints. Without /dev/null nothing changes.
void DiscardStdout() {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  close(nowhere);
}

/// Exit code 74 instead of 0 for an answer that was not completely written to stdout.
int ExitCodeAfterFlush(int exit_code) {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0) return exit_code;
  const std::string why = errno == 0 ? "" : std::string(": ") + std::strerror(errno);
  PrintError("mocurate: stdout: cannot be written" + why + " (free space or send the output elsewhere)\n");
  return exit_code == 0 ? static_cast<int>(ExitCode::kCannotWrite) : exit_code;
}

int Run(int argc, char** argv) {
  CommonArguments common;
  std::function<Status()> verb;
  CLI::App app("mocurate: from noisy motion captures to clean, documented datasets");
  app.set_version_flag("--version", std::string(CreatedBy()));
  app.add_flag("--json", common.json, "print the result as one JSON document on stdout");
  app.add_flag("-q,--quiet", common.quiet,
               "print errors only: no result (except the document of --json), no progress, no warnings");
  app.add_flag("-v,--verbose", common.verbose, "more log lines");
  app.add_flag("--allow-include", common.allow_include,
               "let configurations include files that are not below their folder");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(kFooter);
  for (const auto add : {AddRunVerbs, AddMotionVerbs, AddDatasetVerbs, AddSourceVerbs}) add({app, common, verb});
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return ReportParse(app, error, argc, argv);
  }
  SetLogLevel(common.quiet ? LogLevel::kError : common.verbose ? LogLevel::kDebug : LogLevel::kInfo);
  if (common.quiet && !common.json) DiscardStdout();
  try {
    return Report(GuardJson("a file that was read", verb), common);
  } catch (const std::exception& defect) {
    return Report(Fail(ErrorCode::kInternal, defect.what(), "", "this is a defect of mocurate; please report it"),
                  common);
  }
}

}  // namespace

int main(int argc, char** argv) { return ExitCodeAfterFlush(Run(argc, argv)); }
