#include "job/job_checks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "canon/splits/groups.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/motion/skeleton.h"
#include "fitting/rig_file.h"
#include "ingest/formats/driver.h"
#include "ingest/synthetic/actions.h"

namespace mocurate {
namespace {

Error Unknown(const std::string& what, const std::string& name, const std::string& option,
              const std::vector<std::string>& known, const std::string& known_is) {
  return {ErrorCode::kConfig, "there is no " + what + " '" + name + "'", option,
          DidYouMean(name, known, known_is + (known.empty() ? "none" : JoinTexts(known)))};
}

Status CheckSkeletons(const JobOptions& options) {
  const std::pair<const char*, const std::string*> named[] = {
      {"skeleton", &options.skeleton},
      {"ingest.source.skeleton", &options.ingest.source.skeleton},
      {"proportions.skeleton", &options.proportions.skeleton},
      {"fitting.skeleton", &options.fitting.skeleton},
      {"canon.skeleton", &options.canon.skeleton}};
  for (const auto& [option, name] : named) {
    if (name->empty()) continue;
    if (name->rfind(kFillIn, 0) == 0) continue;  // CheckSource reports it
    const auto skeleton = LoadSkeleton(*name);
    if (skeleton) continue;
    Error error = skeleton.error();
    error.code = ErrorCode::kConfig;
    error.where = option + (error.where.empty() ? std::string() : ": " + error.where);
    return tl::unexpected<Error>(error);
  }
  return {};
}

/// Checks files and devices of the networks before the run.
Status CheckTraining(const TrainOptions& options) {
  std::error_code unseen;
  const bool cuda = std::filesystem::exists("/dev/nvidiactl", unseen) || std::filesystem::exists("/dev/dxg", unseen);
  for (std::size_t i = 0; i < options.networks.size(); ++i) {
    if (!options.networks[i].enabled) continue;
    if (options.networks[i].learning.device == TrainDevice::kCuda && !cuda) {
      return Fail(ErrorCode::kMissingOnHost, "this machine has no CUDA device",
                  "train.networks[" + std::to_string(i) + "].device", "set device: cpu");
    }
    const std::pair<const char*, const std::filesystem::path*> files[] = {
        {"weights", &options.networks[i].learning.weights},
        {"start_from", &options.networks[i].learning.start_from},
        {"body", &options.networks[i].body()}};
    for (const auto& [option, file] : files) {
      std::error_code unknown;
      if (file->empty() || std::filesystem::is_regular_file(*file, unknown)) continue;
      return Fail(ErrorCode::kNotFound, "there is no file " + DisplayPath(*file),
                  "train.networks[" + std::to_string(i) + "]." + option, "give the path of a file");
    }
  }
  return {};
}

/// Checks that durations requested of generators are whole frames, distinct, and supported by every generator.
Status CheckDurations(const JobOptions& options) {
  const std::vector<double>& durations = options.evaluate.durations;
  const auto refused = [](const std::string& what, const char* hint) {
    return Fail(ErrorCode::kConfig, what, "evaluate.durations", hint);
  };
  if (durations.empty()) return {};
  if (!options.evaluate.generators) return refused("no generator is scored", "remove it, or set generators: true");
  for (std::size_t i = 0; i < durations.size(); ++i) {
    if (durations[i] != std::floor(durations[i])) {
      return refused(RoundedText(durations[i]) + " is not a whole number of frames", "e.g. [40, 60, 80]");
    }
    if (i > 0 && durations[i] <= durations[i - 1])
      return refused("the durations are not increasing", "write them in increasing order");
  }
  for (const NetworkOptions& network : options.train.networks) {
    const bool one_length =
        network.enabled && network.kind == NetworkKind::kActor && network.actor.coders == ActorCoders::kFullyConnected;
    if (one_length && (durations.size() > 1 || durations[0] != static_cast<double>(network.data.frames))) {
      return refused(
          "'" + network.name + "' generates " + Counted(network.data.frames, "frame") + " and no other duration",
          "remove the network, or the other durations");
    }
  }
  return {};
}

/// Checks rows of filtered motions: each of a network of single actions, with its own name.
Status CheckFilterRows(const JobOptions& options) {
  std::set<std::string> names = {"Real", "Real-test", "reference", "reference_test"};
  for (const NetworkOptions& network : options.train.networks) names.insert(network.name);
  for (std::size_t i = 0; i < options.evaluate.filters.size(); ++i) {
    const FilterRowOptions& row = options.evaluate.filters[i];
    const std::string where = "evaluate.filters[" + std::to_string(i) + "]";
    const auto made = std::find_if(options.train.networks.begin(), options.train.networks.end(),
                                   [&](const NetworkOptions& network) { return network.name == row.network; });
    const bool answers = made != options.train.networks.end() && GeneratesMotions(made->kind) && !made->NeedsParts();
    if (!answers || !options.evaluate.rows.empty()) {
      return Fail(ErrorCode::kConfig, "'" + row.network + "' is not a network of single actions", where + ".network",
                  "name a generator of single actions, and remove evaluate.rows");
    }
    if (row.name.empty() || !names.insert(row.name).second) {
      return Fail(ErrorCode::kConfig, "'" + row.name + "' is empty, or another row has it", where + ".name",
                  "give each row a name of its own");
    }
    if (!row.filter.on()) {
      return Fail(ErrorCode::kConfig, "the filter has no effect", where + ".least_cutoff", "e.g. 1 Hz");
    }
  }
  return {};
}

/// Checks that rows that answer scripts name networks of the job of suitable kinds.
Status CheckScriptRows(const JobOptions& options) {
  const auto named = [&](const std::string& name) -> const NetworkOptions* {
    for (const NetworkOptions& network : options.train.networks) {
      if (network.enabled && network.name == name) return &network;
    }
    return nullptr;
  };
  const bool scored = options.evaluate.generators && options.evaluate.rows.empty();
  for (const NetworkOptions& network : options.train.networks) {
    const bool single = network.enabled && GeneratesMotions(network.kind) && !network.NeedsParts();
    if (!scored || !single || options.evaluate.part == ClipPart::kWhole) continue;
    if (options.evaluate.part == ClipPart::kTransition || !options.evaluate.durations.empty()) {
      return Fail(ErrorCode::kConfig,
                  "'" + network.name +
                      "' generates single actions, which have no transition and use the "
                      "samples' lengths",
                  "evaluate.part", "list evaluate.rows, and remove durations");
    }
  }
  std::set<std::string> seen;
  for (std::size_t i = 0; i < options.evaluate.rows.size(); ++i) {
    const ScriptRowOptions& row = options.evaluate.rows[i];
    const std::string where = "evaluate.rows[" + std::to_string(i) + "]";
    const auto refused = [&](const char* option, const std::string& what, const char* hint) {
      return Fail(ErrorCode::kConfig, what, where + option, hint);
    };
    const bool reserved =
        row.name == "Real" || row.name == "Real-test" || row.name == "reference" || row.name == "reference_test";
    if (row.name.empty() || reserved || !seen.insert(row.name).second) {
      return refused(".name", "'" + row.name + "' is empty, reserved for real motions, or given twice",
                     "give each row a name of its own");
    }
    const NetworkOptions *main = named(row.network), *first = named(row.first), *fill = named(row.fill);
    const bool continues = main != nullptr && main->kind == NetworkKind::kMacvae;
    const bool joins = main != nullptr && main->kind == NetworkKind::kActor && main->actor.NeedsRotations();
    if (!continues && !joins) {
      return refused(".network",
                     "'" + row.network + "' is neither a macvae nor an actor of rotations in train.networks",
                     "name one of train.networks");
    }
    const bool none = row.script == ScriptDraw::kNone;
    if (continues && none) return refused(".script", "a macvae only answers scripts", "set script: after_sample");
    if (joins && row.script == ScriptDraw::kAfterSample) {
      return refused(".script", "an actor does not continue a sample", "set script: after_generated, chain or none");
    }
    const bool needs_first = continues && row.script != ScriptDraw::kAfterSample;
    const bool makes_first = first != nullptr && first->kind == NetworkKind::kActor && first->actor.NeedsRotations();
    if (needs_first != makes_first || (!needs_first && !row.first.empty())) {
      return refused(".first", needs_first ? "no network makes the first action" : "the script has no first action",
                     needs_first ? "name an actor of train.networks" : "remove it");
    }
    if (!row.fill.empty() && (!joins || fill == nullptr || fill->kind != NetworkKind::kSsmct)) {
      return refused(".fill", "'" + row.fill + "' cannot fill transitions of joined motions",
                     "name an ssmct of train.networks, for an actor");
    }
    if (row.align && !joins) return refused(".align", "a macvae continues motions at their end", "remove it");
    if (row.steps > 1 && row.script != ScriptDraw::kChain) {
      return refused(".steps", "only a chain has several steps", "set script: chain");
    }
    if (none && options.evaluate.part == ClipPart::kTransition) {
      return refused(".script", "a single action has no transition", "set script: after_generated or chain");
    }
  }
  return {};
}

Status CheckIngestActions(const IngestOptions& options) {
  if (!options.synthetic.enabled || !options.path.empty()) return {};
  for (const std::string& action : options.synthetic.actions) {
    if (Status known = CheckAction(action); !known) return known;
  }
  return {};
}

Status CheckDataSets(const std::vector<DataSetOptions>& sets) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const std::string where = "data[" + std::to_string(i) + "]";
    const std::string& name = sets[i].name;
    if (name.empty() || name.front() == '.' || name.find_first_of("/\\=") != std::string::npos) {
      return Fail(ErrorCode::kConfig, "'" + name + "' is not a valid name of a set", where + ".name",
                  "use a folder's name, without '/', '\\' and '='");
    }
    if (!seen.insert(name).second) {
      return Fail(ErrorCode::kConfig, "two sets have the name '" + name + "'", where + ".name",
                  "give each a name of its own");
    }
    if (sets[i].job.empty()) {
      return Fail(ErrorCode::kConfig, "the set has no job", where + ".job", "name a config of configs/ or a file");
    }
  }
  return {};
}

/// Pictures are files of one folder.
Status CheckPictures(const std::vector<DrawnMotionsOptions>& pictures) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string& name = pictures[i].name;
    const std::string where = "reproduce.pictures[" + std::to_string(i) + "].name";
    if (name.empty() || name.front() == '.' || name.find_first_of("/\\") != std::string::npos) {
      return Fail(ErrorCode::kConfig, "'" + name + "' is not a valid name of a file", where, "use no '/' and '\\'");
    }
    if (!seen.insert(name).second) {
      return Fail(ErrorCode::kConfig, "two pictures have the name '" + name + "'", where,
                  "give each a name of its own");
    }
  }
  return {};
}

Status CheckSplitNames(const JobOptions& options, JobStage last) {
  struct Asked {
    std::string option;
    const std::string* split;
    bool used;
  };
  const std::string recogniser = RecogniserOf(options);
  std::vector<Asked> asked = {{"audit.split", &options.audit.split, true}};
  for (std::size_t i = 0; i < options.train.networks.size(); ++i) {
    const std::string& split = options.train.networks[i].data.split;
    asked.push_back({"train.networks." + std::to_string(i) + ".split", &split, last >= JobStage::kTrain});
  }
  asked.push_back({"evaluate.split", &options.evaluate.split, last >= JobStage::kTable && !recogniser.empty()});
  std::vector<std::string> networks;
  for (const NetworkOptions& network : options.train.networks) networks.push_back(network.name);
  if (!recogniser.empty() && std::find(networks.begin(), networks.end(), recogniser) == networks.end()) {
    return tl::unexpected<Error>(
        Unknown("network", recogniser, "evaluate.recogniser", networks, "train.networks has: "));
  }
  std::vector<std::string> known;
  for (const SplitOptions& split : options.assemble.splits) known.push_back(split.name);
  for (const Asked& name : asked) {
    if (!name.used || name.split->empty()) continue;
    if (std::find(known.begin(), known.end(), *name.split) != known.end()) continue;
    return tl::unexpected<Error>(Unknown("split", *name.split, name.option, known, "assemble.splits has: "));
  }
  return {};
}

/// Checks that the method of fitting suits the evidence of the format; motion is passed through, or its joints are
/// fitted.
Status CheckMethod(const JobOptions& options, JobStage last) {
  const EvidenceKind gives = EvidenceKindOf(options.ingest.source);
  if (gives == EvidenceKind::kNothing) return {};
  std::vector<FitMethod> methods = {MethodFor(gives)};
  if (gives == EvidenceKind::kMotion) methods.push_back(FitMethod::kNone);
  if (gives == EvidenceKind::kKeypointsAndDepth)
    methods.insert(methods.end(), {FitMethod::kKeypoints, FitMethod::kPointClouds});
  if (gives == EvidenceKind::kJointTracks &&
      DriverOf(options.ingest.source.format).HasOption("depth_files"))  // where its depth files are there
    methods.insert(methods.end(), {FitMethod::kPointClouds, FitMethod::kJointsAndClouds});
  const JobStage first = options.fitting.method == FitMethod::kNone ? JobStage::kCanon : JobStage::kProportions;
  const bool suits = std::find(methods.begin(), methods.end(), options.fitting.method) != methods.end();
  const FitMethod method = options.fitting.method;
  const bool both = method == FitMethod::kJointsAndClouds || method == FitMethod::kKeypointsAndClouds;
  if (both && last >= first && !options.fitting.joint_tracks.uncertainty) {
    return Fail(ErrorCode::kConfig, "is false, but both kinds of evidence are weighed by the uncertainty of the tracks",
                "fitting.joint_tracks.uncertainty", "set it to true, or fit one of them: fitting.method");
  }
  if (suits || last < first) return {};
  FittingOptions wanted;
  wanted.method = gives == EvidenceKind::kMotion ? FitMethod::kNone : MethodFor(gives);
  return Fail(ErrorCode::kConfig,
              "the method does not suit format " + options.ingest.source.format + ", which gives " + Name(gives),
              "fitting.method",
              "write `method: " + OptionsToJson(wanted).at("method").get<std::string>() + "` under fitting");
}

/// Checks the file of an audited rig, and that the method reads it.
Status CheckRig(const JobOptions& options, JobStage last) {
  const std::filesystem::path& rig = options.fitting.keypoints.rig;
  if (rig.empty() || last < JobStage::kProportions) return {};
  if (options.fitting.method != FitMethod::kKeypoints && options.fitting.method != FitMethod::kKeypointsAndClouds) {
    return Fail(ErrorCode::kConfig, "the method fits no keypoints, so that the audited rig has no effect",
                "fitting.keypoints.rig", "remove it, or set fitting.method to keypoints or keypoints_and_clouds");
  }
  if (const auto file = ReadRigFile(rig); !file) return Forward(file);
  return {};
}

}  // namespace

FitMethod MethodFor(EvidenceKind gives) {
  switch (gives) {
    case EvidenceKind::kDepthViews:
    case EvidenceKind::kPointClouds:
      return FitMethod::kPointClouds;
    case EvidenceKind::kKeypoints:
      return FitMethod::kKeypoints;
    case EvidenceKind::kKeypointsAndDepth:
      return FitMethod::kKeypointsAndClouds;
    default:
      return FitMethod::kJointTracks;
  }
}

Status CheckNames(const JobOptions& options, JobStage last) {
  if (Status sets = CheckDataSets(options.data); !sets) return sets;
  if (Status pictures = CheckPictures(options.reproduce.pictures); !pictures) return pictures;
  if (Status skeletons = CheckSkeletons(options); !skeletons) return skeletons;
  if (Status actions = CheckIngestActions(options.ingest); !actions) return actions;
  if (Status training = CheckTraining(options.train); !training && last >= JobStage::kTrain) return training;
  if (Status durations = CheckDurations(options); !durations) return durations;
  if (Status rows = CheckScriptRows(options); !rows) return rows;
  if (Status filters = CheckFilterRows(options); !filters) return filters;
  if (Status method = CheckMethod(options, last); !method) return method;
  if (Status rig = CheckRig(options, last); !rig) return rig;
  return CheckSplitNames(options, last);
}

Status CheckSplitGroups(const AssembleOptions& options, const std::map<std::string, std::string>& roles,
                        const Discovery& discovery, std::vector<Finding>& findings) {
  std::vector<std::string> without_clip;
  for (const auto& [person, role] : roles) {
    if (discovery.performers.count(person) == 0) without_clip.push_back(person);
  }
  for (const SplitOptions& split : options.splits) {
    if (Status sound = CheckSplit(split); !sound) return sound;
    if (split.by == SplitBy::kRole) {
      Status all = CheckAbsent(split, "ingest.source.roles", without_clip, discovery.performers, findings);
      if (!all) return all;
    }
    if (!NamesGroups(split.by)) continue;
    const std::set<std::string>& there = split.by == SplitBy::kPerson ? discovery.persons : discovery.styles;
    if (there.empty()) continue;  // unknown before the set is assembled, which checks it again
    std::vector<Finding> reported_later;
    if (const auto met = ResolveGroups(split, there, reported_later); !met) return Forward(met);
  }
  return {};
}

std::string JointsWithoutTrack(const JobOptions& options) {
  const SourceOptions& source = options.ingest.source;
  const auto skeleton = LoadSkeleton(options.canon.skeleton);
  if (DriverOf(source.format).gives != EvidenceKind::kJointTracks || source.joints.empty() || !skeleton) return "";
  std::set<int> given;
  for (const std::string& name : source.joints) {
    if (const auto joint = (*skeleton)->FindJoint(name)) given.insert(*joint);
  }
  const auto hips = (*skeleton)->Hips();
  if (hips && given.count((*hips)[0]) != 0 && given.count((*hips)[1]) != 0) given.insert(0);  // their middle
  std::vector<std::string> missing;
  for (int joint = 0; joint < (*skeleton)->joint_count(); ++joint) {
    if (given.count(joint) == 0) missing.push_back((*skeleton)->joints[static_cast<std::size_t>(joint)].name);
  }
  return JoinTexts(missing);
}

}  // namespace mocurate
