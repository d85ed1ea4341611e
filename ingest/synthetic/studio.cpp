#include "ingest/synthetic/studio.h"

#include <functional>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/links.h"
#include "core/base/sha256.h"
#include "ingest/sources/source_file.h"
#include "ingest/stages.h"
#include "ingest/synthetic/actions.h"
#include "ingest/synthetic/performance.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

/// The studio's tracker writes tenths of millimetres in the sensor's axes: x to the right of the image, y up, z away
/// from the sensor (left-handed).
const Vector3d kUnitsPerMetre(1000.0, 1000.0, -1000.0);
constexpr double kStepsPerUnit = 10.0;

/// Calls `take` for every take of a capture with its true motion.
Status ForEachTake(const SyntheticOptions& options, const std::function<Status(const Take&, Motion)>& use) {
  if (options.actions.empty()) {
    return Fail(ErrorCode::kConfig, "the list of actions is empty", "ingest.synthetic.actions", "e.g. [wave, kick]");
  }
  for (const std::string& action : options.actions) {
    if (Status known = CheckAction(action); !known) return known;
  }
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(StudioSource().skeleton);
  if (!skeleton) return Forward(skeleton);
  const std::vector<Subject> cast = Cast(options.seed, options.subjects, **skeleton);
  for (const Take& take : Takes(options)) {
    if (Status used = use(take, PerformTake(options, take, cast[take.subject], *skeleton)); !used) return used;
  }
  return {};
}

namespace fs = std::filesystem;

bool IsPlainName(const std::string& name) {
  constexpr std::size_t kLongest = 255;  // bytes of a name on common file systems
  return !name.empty() && name.size() <= kLongest && name != "." && name != ".." &&
         name.find_first_of(std::string_view("/\0", 2)) == std::string::npos;
}

/// Name -> text. The names are plain: no file of a capture gets out of its folder.
Expected<std::map<std::string, std::string>> ReadCapture(const fs::path& artifact) {
  auto capture = ReadJson(artifact);
  if (!capture) return Forward(capture);
  return GuardJson(DisplayPath(artifact), [&]() -> Expected<std::map<std::string, std::string>> {
    std::map<std::string, std::string> files;
    for (const auto& [name, text] : capture->at("files").items()) {
      files.emplace(name, std::move(text.get_ref<std::string&>()));
      if (IsPlainName(name)) continue;
      return Fail(ErrorCode::kMalformed, "'" + name + "' is not the name of a file of a capture", DisplayPath(artifact),
                  "mocurate cache verify");
    }
    return files;
  });
}

/// name -> SHA-256 of the written file; empty when the list is missing or unreadable.
std::map<std::string, std::string> ReadWritten(const fs::path& list) {
  const nlohmann::json json = ReadJson(list).value_or(nullptr);
  std::map<std::string, std::string> written;
  if (!json.is_object()) return written;
  for (const auto& [name, sha256] : json.items()) {
    if (sha256.is_string() && IsPlainName(name)) written[name] = sha256.get<std::string>();
  }
  return written;
}

Status WriteList(const std::map<std::string, std::string>& written, const fs::path& list) {
  return WriteFile(list, nlohmann::json(written).dump(1) + "\n");
}

bool HoldsContent(const fs::path& file, const std::string& sha256) {
  std::error_code unknown;
  if (!fs::is_regular_file(fs::symlink_status(file, unknown))) return false;
  const auto bytes = ReadFile(file);
  return bytes && Sha256Hex(*bytes) == sha256;
}

}  // namespace

SourceOptions StudioSource() {
  SourceOptions source;
  source.name = "studio";
  source.format = "joint_table";
  source.files = "{action}_p{person:2}_r{repetition}.txt";
  source.licence = "CC0";
  source.units = "mm";
  source.axes = "+x +y -z";
  source.rate_hz = SyntheticOptions().rate_hz;
  source.skeleton = "kinect20";
  source.joints = TrackedJoints();
  source.columns = {"x", "y", "z", "confidence"};
  source.person = "p{person}";
  return source;
}

Expected<std::map<std::string, std::string>> CaptureFiles(const SyntheticOptions& options) {
  std::map<std::string, std::string> files;
  Status done = ForEachTake(options, [&](const Take& take, const Motion& motion) -> Status {
    const std::vector<std::string>& names = TrackedJoints();
    const TrackedTake tracked = Track(PointsOf(motion, names), names, options.tracker, options.seed, take.file());
    files[take.file()] = TrackText(tracked, kUnitsPerMetre, kStepsPerUnit);
    return {};
  });
  if (!done) return Forward(done);
  return files;
}

Expected<Truth> SyntheticTruth(const SyntheticOptions& options) {
  const SourceOptions source = StudioSource();
  Truth truth;
  Status done = ForEachTake(options, [&](const Take& take, Motion motion) -> Status {
    const Expected<NamedFile> named = ReadName(source, take.file());
    if (!named) return Forward(named);
    ClipIdentity identity = named->identity;
    identity.end_frame = motion.frame_count();
    truth.motion.emplace(identity.id(), std::move(motion));
    return {};
  });
  if (!done) return Forward(done);
  return truth;
}

Expected<StageOutcome> CaptureStage(const StageRequest& request) {
  const Expected<SyntheticOptions> options = OptionsFromJson<SyntheticOptions>(request.options);
  if (!options) return Forward(options);
  const auto files = CaptureFiles(*options);
  if (!files) return Forward(files);
  StageOutcome outcome;
  outcome.summary = {{"files", files->size()}};
  const nlohmann::json artifact = {{"files", *files}};
  if (Status written = WriteFile(request.output, artifact.dump()); !written) return Forward(written);
  return outcome;
}

Expected<std::set<std::string>> CaptureFileNames(const fs::path& artifact) {
  const auto files = ReadCapture(artifact);
  if (!files) return Forward(files);
  std::set<std::string> names;
  for (const auto& [name, text] : *files) names.insert(name);
  return names;
}

Status UnpackCapture(const fs::path& artifact, const fs::path& folder) {
  const auto files = ReadCapture(artifact);
  if (!files) return Forward(files);
  if (const auto made = FolderBelow(folder.parent_path(), folder.filename()); !made) return Forward(made);
  fs::path list = folder;
  list += ".json";
  const std::map<std::string, std::string> before = ReadWritten(list);
  std::map<std::string, std::string> now;
  for (const auto& [name, text] : *files) now[name] = Sha256Hex(text);

  // The list names our files before they are written, so that a killed run can continue.
  std::map<std::string, std::string> both = now;
  both.insert(before.begin(), before.end());
  if (both != before) {
    std::error_code unknown;
    for (const auto& [name, sha256] : now) {
      if (before.count(name) != 0 || !fs::exists(fs::symlink_status(folder / name, unknown)) ||
          HoldsContent(folder / name, sha256))
        continue;
      return Fail(ErrorCode::kCannotWrite, "another file has this name", DisplayPath(folder / name),
                  "move it away, or choose another run folder with -o");
    }
    if (Status listed = WriteList(both, list); !listed) return listed;
  }
  for (const auto& [name, text] : *files) {
    if (HoldsContent(folder / name, now[name])) continue;
    const auto file = FileBelow(folder, name);
    if (!file) return Forward(file);
    if (Status written = WriteFile(*file, text); !written) return written;
  }
  for (const auto& [name, sha256] : before) {
    std::error_code left;
    if (now.count(name) == 0 && HoldsContent(folder / name, sha256)) fs::remove(folder / name, left);
  }
  return now == before ? Status() : WriteList(now, list);
}

}  // namespace mocurate
