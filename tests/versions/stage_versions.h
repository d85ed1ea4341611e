#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "tests/support/scratch_folder.h"

namespace mocurate::versions {

/// Path of a record: one JSON file per case, {"stage", "version", "options", "made_from", "record"}.
std::filesystem::path RecordFile(const std::string& name);

/// Runs stages in their worker programs and compares their output with the record of their version.
class StageVersions : public testing::Test {
 protected:
  void SetUp() override;

  std::filesystem::path Path(const std::string& name) const { return folder_ / name; }
  StageInput Input(const char* role, const std::string& name, const std::string& file) const {
    return {role, name, folder_ / file, ""};
  }
  /// Writes a file of the fixed input.
  void Put(const std::string& file, const std::string& bytes);

  /// Runs one item; fails the test when it has no artifact.
  ItemResult Run(const StageDeclaration& stage, const ItemSpec& item);
  /// Runs it and compares with the record of this name; with MOCURATE_REGENERATE=1 writes the record instead, unless
  /// that would give an old version a new output. `made_from`: stages whose outputs are among the inputs.
  ItemResult Judge(const StageDeclaration& stage, const std::string& name, const ItemSpec& item, double tolerance,
                   const std::vector<StageDeclaration>& made_from = {});

 private:
  ScratchFolder folder_;
  std::unique_ptr<Runner> runner_;
};

}  // namespace mocurate::versions
