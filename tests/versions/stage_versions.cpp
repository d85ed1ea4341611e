#include "tests/versions/stage_versions.h"

#include <cstdlib>

#include "core/base/file.h"
#include "tests/support/folders.h"
#include "tests/support/scratch_folder.h"
#include "tests/versions/stage_record.h"

namespace mocurate::versions {
namespace {

constexpr const char* kAccept = "MOCURATE_REGENERATE=1 build/test/bin/test_versions";
constexpr std::size_t kShownDifferences = 6;

nlohmann::json Versions(const std::vector<StageDeclaration>& stages) {
  nlohmann::json versions = nlohmann::json::object();
  for (const StageDeclaration& stage : stages) versions[stage.name] = stage.version;
  return versions;
}

nlohmann::json OutcomeRecord(const ItemResult& result) {
  nlohmann::json findings = nlohmann::json::array();
  for (const Finding& finding : result.outcome.findings) findings.push_back(finding);
  return RecordJson({{"kind", Name(result.outcome.kind)}, {"summary", result.summary}, {"findings", findings}});
}

std::string Listed(const std::vector<std::string>& differences) {
  std::string text;
  for (std::size_t i = 0; i < differences.size() && i < kShownDifferences; ++i) text += "\n  " + differences[i];
  if (differences.size() > kShownDifferences) {
    text += "\n  and " + std::to_string(differences.size() - kShownDifferences) + " more";
  }
  return text;
}

}  // namespace

std::filesystem::path RecordFile(const std::string& name) {
  return std::filesystem::path(kSourceFolder) / "tests/versions" / "expected" / (name + ".json");
}

void StageVersions::SetUp() {
  RunnerOptions options;
  options.run_folder = folder_ / "run";
  options.cache_folder = folder_ / "cache";
  options.worker_folder = kBinaryFolder;
  options.jobs = 1;
  options.quiet = true;
  auto runner = Runner::Make(options);
  ASSERT_TRUE(runner) << runner.error().Message();
  runner_ = std::move(*runner);
}

void StageVersions::Put(const std::string& file, const std::string& bytes) {
  const Status written = WriteFile(folder_ / file, bytes);
  ASSERT_TRUE(written) << written.error().Message();
}

ItemResult StageVersions::Run(const StageDeclaration& stage, const ItemSpec& item) {
  auto report = runner_->Run(stage, {item});
  if (!report) {
    ADD_FAILURE() << report.error().Message();
    return {};
  }
  const ItemResult& result = report->items.front();
  if (result.artifact.empty()) ADD_FAILURE() << stage.name << ": " << result.outcome.error.Message();
  return result;
}

ItemResult StageVersions::Judge(const StageDeclaration& stage, const std::string& name, const ItemSpec& item,
                                double tolerance, const std::vector<StageDeclaration>& made_from) {
  ItemResult result = Run(stage, item);
  if (result.artifact.empty()) return result;
  const auto artifact = RecordArtifact(result.artifact);
  if (!artifact) {
    ADD_FAILURE() << artifact.error().Message();
    return result;
  }
  const nlohmann::json now = {{"stage", stage.name},
                              {"version", stage.version},
                              {"options", item.options.Whole()},
                              {"made_from", Versions(made_from)},
                              {"record", {{"outcome", OutcomeRecord(result)}, {"artifact", *artifact}}}};
  const auto text = ReadFile(RecordFile(name));
  const nlohmann::json recorded = text ? nlohmann::json::parse(*text) : nlohmann::json();
  const bool same_version = recorded.is_object() && recorded["version"] == now["version"];
  const bool same_input =
      recorded.is_object() && recorded["options"] == now["options"] && recorded["made_from"] == now["made_from"];
  const std::vector<std::string> differences =
      recorded.is_object() ? Differences(recorded["record"], now["record"], tolerance) : std::vector<std::string>{};
  if (same_version && same_input && differences.empty()) return result;
  if (same_version && same_input) {
    ADD_FAILURE()
        << "stage '" << stage.name << "' has another output under its old version " << stage.version << ":"
        << Listed(differences) << "\nraise the version of stage '" << stage.name
        << "' (its Declaration in <module>/options.cpp), so that caches do not serve the old output, or restore the "
           "output; to accept then run "
        << kAccept << " (if the input of this test was changed on purpose, remove " << RecordFile(name).string()
        << " first)";
    return result;
  }
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    const Status written = WriteFile(RecordFile(name), now.dump(1) + "\n");
    EXPECT_TRUE(written) << written.error().Message();
    return result;
  }
  if (!recorded.is_object()) {
    ADD_FAILURE() << "stage '" << stage.name << "' has no record " << RecordFile(name).string() << "; to make it run "
                  << kAccept;
  } else if (!same_version) {
    ADD_FAILURE() << "stage '" << stage.name << "' has version " << stage.version << ", recorded is "
                  << recorded["version"]
                  << (differences.empty() ? " with the same output: is the new version needed? " : "; ")
                  << "to accept run " << kAccept << Listed(differences);
  } else {
    ADD_FAILURE() << "stage '" << stage.name << "' was recorded with other options or from other stages' outputs ("
                  << recorded["made_from"].dump() << "); to accept run " << kAccept << Listed(differences);
  }
  return result;
}

}  // namespace mocurate::versions
