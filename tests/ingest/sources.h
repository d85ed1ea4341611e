#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/store/store.h"
#include "ingest/discover.h"
#include "ingest/stages.h"
#include "tests/support/folders.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {

/// The folder of unpacked test data, or empty.
inline std::string TestData() {
  const char* folder = std::getenv("MOCURATE_DATA");
  return folder == nullptr ? std::string() : std::string(folder);
}

/// An empty folder of one test.
inline std::filesystem::path FreshFolder(const std::string& name) {
  const std::filesystem::path folder = SharedScratch("ingest_" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

inline void Put(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A source declaration of configs/sources/, with changes as in `--set`.
inline IngestOptions Declared(const std::string& name, std::vector<std::string> assignments = {}) {
  // Without recorded data the tests that need them are skipped; others use the declaration only.
  if (TestData().empty()) assignments.insert(assignments.begin(), "ingest.path=.");
  const auto node =
      LoadConfig(std::filesystem::path(kSourceFolder) / "configs" / "sources" / (name + ".yaml"), assignments);
  if (!node) ADD_FAILURE() << node.error().Message();
  const ConfigNode* group = node ? node->Find("ingest") : nullptr;
  const auto options = group != nullptr ? OptionsFromConfig<IngestOptions>(*group)
                                        : Expected<IngestOptions>(tl::unexpected<Error>(Error()));
  if (!options) ADD_FAILURE() << options.error().Message();
  return options ? *options : IngestOptions();
}

/// A table of two joints per frame in a synthetic source.
inline IngestOptions SmallTable(const std::filesystem::path& folder) {
  IngestOptions options;
  options.path = folder;
  SourceOptions& source = options.source;
  source.name = "small";
  source.format = "joint_table";
  source.files = "a{action}_s{person}.txt";
  source.units = "mm";
  source.axes = "+x +y +z";
  source.rate_hz = 30.0;
  source.joints = {"left_hip", "right_hip"};
  return options;
}

/// Arrays of SMPL's joints in a synthetic source, metres.
inline IngestOptions SmallArrays(const std::filesystem::path& folder) {
  IngestOptions options;
  options.path = folder;
  SourceOptions& source = options.source;
  source.name = "mine";
  source.format = "npy";
  source.files = "{clip}.npy";
  source.person = "p";
  source.recording = "{clip}";
  source.units = "m";
  source.axes = "+x +y +z";
  source.rate_hz = 20.0;
  source.skeleton = "smpl24";
  return options;
}

struct Ingested {
  Expected<StageOutcome> outcome;
  std::filesystem::path artifact;
  Clip clip;  ///< of the artifact, if written
};

/// With the clip of the artifact, or the error of an outcome that has none.
inline Ingested IngestedOf(Expected<StageOutcome> outcome, const std::filesystem::path& artifact) {
  Ingested result{std::move(outcome), artifact, {}};
  if (result.outcome && !HasArtifact(result.outcome->kind)) {
    const Error why = result.outcome->error;
    result.outcome = tl::unexpected<Error>(why);
  }
  if (result.outcome) {
    auto clip = ReadEvidence(artifact);
    if (clip)
      result.clip = std::move(*clip);
    else
      ADD_FAILURE() << clip.error().Message();
  }
  return result;
}

inline Ingested RunIngest(const ItemSpec& item, const std::string& name) {
  StageRequest request;
  request.stage = "ingest";
  request.item = item.item;
  request.options = item.options.Whole();
  request.inputs = item.inputs;
  request.output = SharedScratch("ingest_" + name + ".h5");
  std::filesystem::remove(request.output);
  return IngestedOf(IngestStage(request), request.output);
}

/// Ingests the only file of a small source and returns its error, if any.
inline Status IngestOnly(const IngestOptions& options, const std::string& name) {
  const auto discovery = Discover(options);
  if (!discovery) return Forward(discovery);
  const Ingested result = RunIngest(discovery->items.at(0), name);
  return result.outcome ? Status() : Status(Forward(result.outcome));
}

}  // namespace mocurate
