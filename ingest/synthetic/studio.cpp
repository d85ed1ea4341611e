#include "ingest/synthetic/studio.h"

#include <functional>

#include "core/base/file.h"
#include "ingest/sources/source_file.h"
#include "ingest/stages.h"
#include "ingest/synthetic/actions.h"
#include "ingest/synthetic/performance.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

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
    files[take.file()] = TrackText(motion, options, take.file());
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

}  // namespace mocurate
