#include "job/extractor_folder.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/links.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "mocurate-extractor/1";
constexpr const char* kWeights = "weights.safetensors";
constexpr const char* kDescription = "extractor.yaml";
constexpr const char* kManifest = "manifest.json";
constexpr std::size_t kMostManifestBytes = 1 << 20;

/// JSON texts and lists are YAML.
std::string DescriptionOf(const Checkpoint& checkpoint, const std::string& name) {
  const nlohmann::json& options = checkpoint.options;
  std::vector<std::string> joints;
  std::vector<int> parents;
  for (const Joint& joint : checkpoint.skeleton->joints) {
    joints.push_back(joint.name);
    parents.push_back(joint.parent);
  }
  const bool graph = checkpoint.kind == "st_gcn";
  const auto line = [](const char* key, const nlohmann::json& value, const char* comment = "") {
    return std::string(key) + ": " + value.dump() + (*comment == '\0' ? "" : std::string("  # ") + comment) + "\n";
  };
  return "# What this recogniser reads. mocurate eval --protocol own --extractor FOLDER scores with it.\n" +
         line("name", name) + line("network", checkpoint.kind) + "input:\n" +
         line("  values", graph ? "rotation_6d_rows" : "joints",
              graph ? "two rows of each local rotation" : "x, y, z of each joint, metres") +
         line("  skeleton", checkpoint.skeleton->name) + line("  joints", joints) +
         line("  parents", parents, "of each joint, -1: root") +
         line("  axes", "+x +y +z", "right-handed, y up, facing +z in the first frame") +
         line("  root", "first_frame", "at the origin in the first frame that is read") +
         line("  frames", options.value("frames", nlohmann::json())) +
         line("  length", options.value("input", "crop"), "how motions of another length are read") +
         line("  rate", checkpoint.facts.value("rate", nlohmann::json())) + line("labels", checkpoint.labels) +
         line("trained_on", checkpoint.dataset_sha256, "SHA-256 of the dataset's content");
}

Expected<nlohmann::json> EntryOf(const fs::path& file) {
  const auto digits = Sha256OfFile(file);
  if (!digits) return Forward(digits);
  std::error_code unknown;
  return nlohmann::json{{"bytes", fs::file_size(file, unknown)}, {"sha256", *digits}};
}

}  // namespace

Status WriteExtractorFolder(const Checkpoint& checkpoint, const std::string& name, const fs::path& folder) {
  if (checkpoint.kind != "gru_recogniser" && checkpoint.kind != "st_gcn") {
    return Fail(ErrorCode::kUsage, "the network '" + checkpoint.kind + "' computes no features", "--layout extractor",
                "export a recogniser: checkpoints/recogniser_*.h5 of a run");
  }
  if (checkpoint.skeleton == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the checkpoint has no skeleton", "--layout extractor", "train again");
  }
  if (Status made = MakeFolder(folder); !made) return made;
  if (Status written = ExportSafetensors(checkpoint, folder / kWeights); !written) return written;
  if (Status written = WriteFile(folder / kDescription, DescriptionOf(checkpoint, name)); !written) return written;
  nlohmann::json manifest = {{"schema", kSchema},
                             {"name", name},
                             {"network", checkpoint.kind},
                             {"labels", checkpoint.labels},
                             {"mocurate", std::string(Version())},
                             {"files", nlohmann::json::object()}};
  for (const char* file : {kWeights, kDescription}) {
    const auto entry = EntryOf(folder / file);
    if (!entry) return Forward(entry);
    manifest["files"][file] = *entry;
  }
  return WriteFile(folder / kManifest, manifest.dump(1) + "\n");
}

Expected<ExtractorFolder> OpenExtractorFolder(const fs::path& folder) {
  const fs::path path = folder / kManifest;
  const auto text = ReadSmallFile(path, kMostManifestBytes);
  if (!text) {
    return Fail(text.error().code, text.error().what, DisplayPath(path),
                "give a folder of mocurate export CHECKPOINT --layout extractor -o FOLDER");
  }
  const auto manifest = ParseJson(*text, DisplayPath(path));
  if (!manifest) return Forward(manifest);
  const auto malformed = [&](const std::string& what) {
    return Fail(ErrorCode::kMalformed, what, DisplayPath(path),
                "write the folder again: mocurate export CHECKPOINT --layout extractor -o FOLDER");
  };
  if (!manifest->is_object() || manifest->value("schema", nlohmann::json()) != kSchema ||
      !manifest->value("files", nlohmann::json()).is_object() ||
      !manifest->value("name", nlohmann::json()).is_string()) {
    return malformed(std::string("it is no manifest of the schema '") + kSchema + "'");
  }
  for (const char* file : {kWeights, kDescription}) {
    const nlohmann::json entry = manifest->at("files").value(file, nlohmann::json());
    const std::string stated = entry.is_object() && entry.value("sha256", nlohmann::json()).is_string()
                                   ? entry["sha256"].get<std::string>()
                                   : std::string();
    if (stated.size() != 64 || stated.find_first_not_of("0123456789abcdef") != std::string::npos) {
      return malformed(std::string("it does not state the SHA-256 of ") + file);
    }
    if (Status plain = CheckNotLink(folder / file); !plain) return Forward(plain);
    const auto digits = Sha256OfFile(folder / file);
    if (!digits) return Forward(digits);
    if (*digits == entry["sha256"]) continue;
    return Fail(
        ErrorCode::kInconsistent, "SHA-256 " + *digits + ", the manifest states " + entry["sha256"].get<std::string>(),
        DisplayPath(folder / file), "the file was changed or damaged: fetch the folder again, or export it again");
  }
  const std::string name = (*manifest)["name"].get<std::string>();
  const auto checkpoint = ReadCheckpoint(folder / kWeights);
  if (!checkpoint) return Forward(checkpoint);
  const auto description = ReadSmallFile(folder / kDescription, kMostManifestBytes);
  if (!description) return Forward(description);
  if (checkpoint->skeleton == nullptr || *description != DescriptionOf(*checkpoint, name) ||
      manifest->value("labels", nlohmann::json()) != checkpoint->labels) {
    return Fail(ErrorCode::kInconsistent, "it does not describe the network of the weights",
                DisplayPath(folder / kDescription), "export the folder again");
  }
  return ExtractorFolder{name, folder / kWeights};
}

}  // namespace mocurate
