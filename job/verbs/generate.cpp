#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "canon/values/set_files.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/random.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/motion/limbs.h"
#include "core/motion/request.h"
#include "core/store/dataset_clips.h"
#include "core/store/store.h"
#include "job/config_loading.h"
#include "job/machine.h"
#include "job/run_folder.h"
#include "job/stage_runs.h"
#include "job/verbs/generate.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "train/checkpoint/checkpoint.h"
#include "train/options.h"
#include "train/stages.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestScale = 100.0;
constexpr double kMostFramesInAll = 2e7;  // 100 GB of joints and rotations

/// Requested classes, in order: "sit:10" ten times, "3" the class of that index; without a request each class once.
Expected<std::vector<int>> LabelsOf(const std::vector<std::string>& wanted, const std::vector<std::string>& labels) {
  std::vector<int> result;
  for (std::size_t c = 0; wanted.empty() && c < labels.size(); ++c) result.push_back(static_cast<int>(c));
  for (const std::string& text : wanted) {
    const std::size_t colon = text.rfind(':');
    const auto count = colon == std::string::npos ? std::optional<long long>(1) : ParseInteger(text.substr(colon + 1));
    const auto label = RequestedClass(text.substr(0, colon), labels, "--label");
    if (!label) return Forward(label);
    if (!count || *count < 1 || *count > 1000000) {
      return Fail(ErrorCode::kUsage, "'" + text.substr(colon + 1) + "' is not a number of motions", "--label",
                  "write LABEL:COUNT, e.g. sit:10");
    }
    result.insert(result.end(), static_cast<std::size_t>(*count), *label);
  }
  return result;
}

/// Mean length of each bone along the chains, over the frames of all motions of a dataset: (J), 0 for the root.
/// `person`: of this one alone; empty: of all.
Expected<std::vector<double>> LengthsOf(const fs::path& path, const std::string& person, const Skeleton& skeleton) {
  const Expected<Dataset> set = ReadDataset(path);
  if (!set) return Forward(set);
  if (!SameTree(*set->skeleton, skeleton)) {
    return Fail(ErrorCode::kInconsistent,
                "the motions have skeleton '" + set->skeleton->name + "', but the network has '" + skeleton.name + "'",
                DisplayPath(path), "give motions of skeleton '" + skeleton.name + "'");
  }
  std::vector<double> lengths(static_cast<std::size_t>(skeleton.joint_count()), 0.0);
  const std::vector<int> parents = skeleton.lie ? skeleton.LieParents() : std::vector<int>();
  double frames = 0.0;
  std::set<std::string> persons;
  for (const Clip& clip : set->clips) {
    persons.insert(clip.identity.person);
    if (!clip.motion || (!person.empty() && clip.identity.person != person)) continue;
    for (int f = 0; f < clip.motion->frame_count(); ++f, ++frames) {
      for (int j = 1; j < skeleton.joint_count(); ++j) {
        const auto at = static_cast<std::size_t>(j);
        const int parent = parents.empty() ? skeleton.joints[at].parent : parents[at];
        lengths[at] += (clip.motion->joints.at(f, j) - clip.motion->joints.at(f, parent)).norm();
      }
    }
  }
  if (frames == 0.0 && !person.empty()) {
    return Fail(ErrorCode::kNotFound, "the dataset has no motion of person '" + person + "'", DisplayPath(path),
                NearestOfAll(person, {persons.begin(), persons.end()}, "the persons are: "));
  }
  if (frames == 0.0) {
    return Fail(ErrorCode::kInconsistent, "the dataset has no motion", DisplayPath(path),
                "give a dataset of at least one motion");
  }
  for (double& length : lengths) length /= frames;
  return lengths;
}

/// Joints below `root`.
std::vector<bool> Below(const Skeleton& skeleton, int root) {
  std::vector<bool> below(static_cast<std::size_t>(skeleton.joint_count()), false);
  for (int j = 1; j < skeleton.joint_count() && root >= 0; ++j) {
    const int parent = skeleton.joints[static_cast<std::size_t>(j)].parent;
    below[static_cast<std::size_t>(j)] = parent == root || (parent >= 0 && below[static_cast<std::size_t>(parent)]);
  }
  return below;
}

/// "legs=1.25,arms=0.9,all=1.1" of bone lengths.
Status Scale(const std::string& text, const Skeleton& skeleton, std::vector<double>& lengths) {
  if (text.empty()) return {};
  const Limbs limbs = LimbsOf(skeleton);
  std::set<std::string> seen;
  for (const std::string_view part : SplitText(text, ',')) {
    const std::size_t equals = part.find('=');
    const auto factor =
        equals == std::string_view::npos ? std::nullopt : ParseDouble(std::string(Trim(part.substr(equals + 1))));
    const std::string group(Trim(part.substr(0, equals)));
    if (!factor || !(*factor > 0.0 && *factor <= kLargestScale)) {
      return Fail(ErrorCode::kUsage, "'" + std::string(part) + "' is not of the form GROUP=FACTOR", "--scale",
                  "write e.g. --scale legs=1.25,arms=1.25");
    }
    if (group != "legs" && group != "arms" && group != "all") {
      return Fail(ErrorCode::kUsage, "there is no group '" + group + "'", "--scale", "the groups are legs, arms, all");
    }
    if (!seen.insert(group).second) {
      return Fail(ErrorCode::kUsage, "'" + group + "' is given twice", "--scale", "give each group one factor");
    }
    for (std::size_t side = 0; side < 2; ++side) {
      const Limb& limb = group == "legs" ? limbs.leg[side] : limbs.arm[side];
      if (group != "all" && !limb.known()) {
        return Fail(ErrorCode::kInconsistent, "skeleton '" + skeleton.name + "' has no known " + group, "--scale",
                    "scale all bones: all=" + RoundedText(*factor));
      }
      const std::vector<bool> of_group =
          group == "all" ? std::vector<bool>(lengths.size(), side == 0) : Below(skeleton, limb.root);
      for (std::size_t j = 0; j < lengths.size(); ++j) lengths[j] *= of_group[j] ? *factor : 1.0;
    }
  }
  return {};
}

/// Bone lengths of the motions; empty: the network's own.
Expected<std::vector<double>> BoneLengthsOf(const GenerateArguments& arguments, const Checkpoint& checkpoint,
                                            const NetworkOptions& options) {
  if (arguments.scale.empty() && arguments.bone_lengths.empty()) return std::vector<double>();
  const bool lays_out = (options.kind == NetworkKind::kAction2Motion && options.action2motion.lie) ||
                        (options.kind == NetworkKind::kActMoCoGan && options.act_mocogan.lie) ||
                        options.kind == NetworkKind::kMacvae ||
                        (options.kind == NetworkKind::kActor && options.actor.NeedsRotations());
  if (!lays_out) {
    return Fail(ErrorCode::kUsage, "the network generates positions, but other bone lengths need rotations",
                arguments.scale.empty() ? "--bone-lengths" : "--scale",
                "use a network of rotations: lie: true, or kind actor");
  }
  std::vector<double> lengths = checkpoint.facts.value("bone_length", std::vector<double>());
  if (lengths.empty()) lengths = checkpoint.skeleton->RestBoneLengths();
  if (static_cast<int>(lengths.size()) != checkpoint.skeleton->joint_count()) {
    return Fail(ErrorCode::kMalformed,
                Counted(static_cast<long long>(lengths.size()), "bone length") + " for a skeleton of " +
                    Counted(checkpoint.skeleton->joint_count(), "joint"),
                DisplayPath(arguments.checkpoint), "use the file as written by `mocurate`");
  }
  if (!arguments.bone_lengths.empty()) {
    auto given = LengthsOf(arguments.bone_lengths, arguments.person, *checkpoint.skeleton);
    if (!given) return Forward(given);
    lengths = std::move(*given);
  }
  if (Status scaled = Scale(arguments.scale, *checkpoint.skeleton, lengths); !scaled) return Forward(scaled);
  return lengths;
}

/// "60" or "40:120:5".
Expected<std::vector<int>> DurationsOf(const std::string& text, int trained) {
  if (text.empty()) return std::vector<int>{trained};
  std::vector<long long> numbers;
  for (const std::string_view part : SplitText(text, ':')) {
    const auto number = ParseInteger(part);
    if (!number || *number < 1 || *number > 100000) numbers.clear();
    if (!number || *number < 1 || *number > 100000) break;
    numbers.push_back(*number);
  }
  const bool range = numbers.size() == 2 || numbers.size() == 3;
  if ((numbers.size() != 1 && !range) || (range && numbers[1] < numbers[0])) {
    return Fail(ErrorCode::kUsage, "'" + text + "' is not a number of frames", "--frames",
                "write 1 to 100000, e.g. 60, or FIRST:LAST:STEP, e.g. 40:120:5");
  }
  std::vector<int> durations;
  const long long last = range ? numbers[1] : numbers[0], step = numbers.size() == 3 ? numbers[2] : 1;
  for (long long frames = numbers[0]; frames <= last; frames += step) durations.push_back(static_cast<int>(frames));
  return durations;
}

std::uint64_t SeedOf(Random& random) {
  const std::uint64_t high = random.Next();
  return (high << 32) | random.Next();
}

Expected<std::vector<MotionRequest>> RequestsOf(const GenerateArguments& arguments, const Checkpoint& checkpoint,
                                                const NetworkOptions& options) {
  const auto labels = LabelsOf(arguments.labels, checkpoint.labels);
  if (!labels) return Forward(labels);
  const auto lengths = BoneLengthsOf(arguments, checkpoint, options);
  if (!lengths) return Forward(lengths);
  const auto durations = DurationsOf(arguments.frames, static_cast<int>(options.data.frames));
  if (!durations) return Forward(durations);
  constexpr int kMostFrames = 5000;  // rows of ACTOR's positional table
  if (options.kind == NetworkKind::kActor && durations->back() > kMostFrames) {
    return Fail(ErrorCode::kUsage, "'" + arguments.frames + "': the network's positional encoding ends at 5000 frames",
                "--frames", "request at most 5000");
  }
  double all = 0.0;
  for (const int frames : *durations) {
    all += static_cast<double>(frames) * static_cast<double>(labels->size()) * std::max(1, arguments.interpolate);
  }
  if (all > kMostFramesInAll) {
    return Fail(ErrorCode::kUsage, "the motions have " + RoundedText(all, 3) + " frames in all", "--frames",
                "request at most 2e7");
  }
  if (arguments.interpolate > 0 && options.kind != NetworkKind::kActor) {
    return Fail(ErrorCode::kUsage, "the network has no latent of a whole motion", "--interpolate",
                "use a network of kind actor");
  }
  std::vector<MotionRequest> requests;
  for (const int frames : *durations) {
    for (std::size_t i = 0; i < labels->size(); ++i) {
      Random random(arguments.seed, "generate", std::to_string(i));
      MotionRequest request;
      request.label = (*labels)[i];
      request.frames = frames;
      request.seed = SeedOf(random);
      request.bone_length = *lengths;
      requests.push_back(request);
      if (arguments.interpolate > 0) request.to_seed = SeedOf(random);
      for (int k = 1; k < arguments.interpolate; ++k) {
        request.fraction = static_cast<double>(k) / (arguments.interpolate - 1);
        requests.push_back(request);
      }
    }
  }
  return requests;
}

/// Requests of scripts, and further inputs of the item.
Expected<std::vector<MotionRequest>> ScriptRequests(const GenerateArguments& arguments, const Checkpoint& checkpoint,
                                                    const NetworkOptions& options, ItemSpec& item) {
  if (arguments.keep_previous && arguments.previous.empty()) {
    return Fail(ErrorCode::kUsage, "--keep-previous is given without motions to continue", "--keep-previous",
                "add --previous SET.h5");
  }
  const bool others =
      !arguments.labels.empty() || arguments.interpolate > 0 || !arguments.frames.empty() || !arguments.mesh.empty();
  if (others) {
    return Fail(ErrorCode::kUsage, "--script is given with options that it replaces", "--script",
                "remove --label, --frames, --interpolate and --mesh; a script sets durations as ACTION:FRAMES");
  }
  const bool continues = options.kind == NetworkKind::kMacvae;
  if (!continues && !(options.kind == NetworkKind::kActor && options.actor.NeedsRotations())) {
    return Fail(ErrorCode::kUsage, "the network answers no scripts", "--script",
                "use a network of kind macvae, or an actor with a pose of rotations");
  }
  if (continues && arguments.first.empty() == arguments.previous.empty()) {
    return Fail(ErrorCode::kUsage,
                arguments.first.empty() ? "no network makes the first action: this one only continues motions"
                                        : "both a first action and a previous motion are given",
                "--script", "give one of --first ACTOR.h5 and --previous SET.h5");
  }
  if (continues ? (arguments.align || !arguments.fill.empty())
                : (arguments.snap || !arguments.first.empty() || !arguments.previous.empty())) {
    return Fail(
        ErrorCode::kUsage,
        continues ? "the network generates its own transitions" : "an actor's motions are joined, not continued",
        "--script", continues ? "remove --align and --fill" : "remove --first, --previous and --snap");
  }
  for (const auto& [role, file] : {std::pair("first", &arguments.first), std::pair("fill", &arguments.fill),
                                   std::pair("previous", &arguments.previous)}) {
    if (!file->empty()) item.inputs.push_back({role, DisplayPath(*file), *file, ""});
  }
  std::vector<std::string> clips;  // candidates to continue
  if (!arguments.previous.empty()) {
    const auto set = DatasetClips::Open(arguments.previous, DatasetClips::Check::kNone);
    if (!set) return Forward(set);
    for (std::size_t row = 0; row < set->size(); ++row) clips.push_back(set->Id(row));
    const bool known = std::find(clips.begin(), clips.end(), arguments.previous_clip) != clips.end();
    if (clips.empty() || (!arguments.previous_clip.empty() && !known)) {
      return Fail(ErrorCode::kUsage, "the set has no clip '" + arguments.previous_clip + "'", "--previous-clip",
                  DidYouMean(arguments.previous_clip, clips, "`mocurate inspect SET.h5` lists its clips"));
    }
    if (known) clips = {arguments.previous_clip};
  } else if (!arguments.previous_clip.empty()) {
    return Fail(ErrorCode::kUsage, "--previous-clip is given without a set of previous motions", "--previous-clip",
                "add --previous SET.h5");
  }
  const auto lengths = BoneLengthsOf(arguments, checkpoint, options);
  if (!lengths) return Forward(lengths);
  double all = 0.0;
  std::vector<MotionRequest> requests;
  for (const std::string& text : arguments.scripts) {
    auto script = ReadScript(text);
    if (!script) return Forward(script);
    if (arguments.transition_frames > 0) {
      for (ScriptActionOptions& action : script->actions) action.transition_frames = arguments.transition_frames;
    }
    const auto steps = StepsOf(*script, checkpoint, !clips.empty());
    if (!steps) return Forward(steps);
    if (continues && clips.empty() && steps->size() < 2) {
      return Fail(ErrorCode::kUsage, "the script has a single action, which only --first would make", "--script",
                  "add a second one, or use the other network with --label ACTION");
    }
    for (int k = 0; k < arguments.count; ++k) {
      Random random(arguments.seed, "script", std::to_string(requests.size()));
      MotionRequest request;
      request.seed = SeedOf(random);
      request.bone_length = *lengths;
      request.script = *steps;
      request.label = steps->front().label;
      request.frames = steps->front().frames;
      if (clips.empty()) {
        request.script.erase(request.script.begin());
      } else {
        request.previous_clip = clips[static_cast<std::size_t>(random.Below(clips.size()))];
      }
      all += static_cast<double>(request.answered_frames());
      if (all > kMostFramesInAll) {
        return Fail(ErrorCode::kUsage, "the scripts have more than 2e7 frames in all", "--count", "request fewer");
      }
      requests.push_back(std::move(request));
    }
  }
  item.options = OptionsToJson(LongMotionOptions{arguments.snap, arguments.align, arguments.keep_previous});
  return requests;
}

/// Denoised clips, with the fields of their dataset that the format does not name.
Status WriteDenoised(const fs::path& made, const fs::path& from, const fs::path& to) {
  auto set = ReadDataset(made);
  if (!set) return Forward(set);
  const auto files = OpenDatasetFiles({from});
  if (!files) return Forward(files);
  const auto dropped = WriteFromFiles(*set, WholeClips(*files), *files, to);
  if (!dropped) return Forward(dropped);
  WarnOf(*dropped);
  return {};
}

}  // namespace

Status GenerateVerb(CommonArguments& common, const GenerateArguments& arguments) {
  ChooseBlasKernels();
  if (Status free = CheckOutputs({arguments.output}, {}, arguments.force); !free) return free;
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(arguments.checkpoint);
  if (!checkpoint) return Forward(checkpoint);
  const auto options = OptionsFromJson<NetworkOptions>(checkpoint->options, DisplayPath(arguments.checkpoint));
  if (!options) return Forward(options);
  if (!arguments.person.empty() && arguments.bone_lengths.empty()) {
    return Fail(ErrorCode::kUsage, "--person is given without --bone-lengths", "--person", "add --bone-lengths SET.h5");
  }
  const bool of_scripts = arguments.keep_previous || !arguments.first.empty() || !arguments.fill.empty() ||
                          !arguments.previous.empty() || !arguments.previous_clip.empty() || arguments.align ||
                          arguments.snap || arguments.count != 1 || arguments.transition_frames != 0;
  if (arguments.scripts.empty() && of_scripts) {
    return Fail(ErrorCode::kUsage,
                "--first, --fill, --previous, --previous-clip, --keep-previous, --align, --snap, --count and "
                "--transition-frames need scripts",
                "--script", "add --script ACTION,ACTION,...");
  }
  MeshBodies bodies{arguments.body.empty() ? FindBody() : arguments.body, arguments.shapes, arguments.seed};
  if (!arguments.mesh.empty()) {
    if (!arguments.scale.empty() || !arguments.bone_lengths.empty()) {
      return Fail(ErrorCode::kUsage, "meshes have the bone lengths of their body", "--mesh",
                  "remove --scale and --bone-lengths, or --mesh; --shapes varies bodies");
    }
    if (!options->NeedsRotations()) {
      return Fail(ErrorCode::kUsage, "the network generates no rotations, which meshes need", "--mesh",
                  "use a network of kind actor");
    }
    if (Status body = CheckMeshBody(bodies, *checkpoint->skeleton); !body) return body;
    std::error_code unknown;
    if (fs::exists(arguments.mesh, unknown) && !fs::is_directory(arguments.mesh, unknown)) {
      return Fail(ErrorCode::kUsage, "the path is a file, not a folder", DisplayPath(arguments.mesh),
                  "name a folder with --mesh");
    }
    if (fs::exists(arguments.mesh, unknown) && !fs::is_empty(arguments.mesh, unknown) && !arguments.force) {
      return Fail(ErrorCode::kUsage, "the folder is not empty", DisplayPath(arguments.mesh),
                  "use --force to overwrite its files");
    }
  } else if (arguments.shapes != 1 || !arguments.body.empty()) {
    return Fail(ErrorCode::kUsage, "the option needs --mesh", arguments.body.empty() ? "--shapes" : "--body",
                "add --mesh FOLDER");
  }
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);
  ItemSpec item{"motions", nlohmann::json::object(), {{"generator", "network", arguments.checkpoint, ""}}};
  std::size_t asked = 0;
  if (arguments.denoise.empty()) {
    const auto requests = arguments.scripts.empty() ? RequestsOf(arguments, *checkpoint, *options)
                                                    : ScriptRequests(arguments, *checkpoint, *options, item);
    if (!requests) return Forward(requests);
    asked = requests->size();
    const fs::path file = (*stages)->folder() / "requests.json";
    if (Status written = WriteRequests(*requests, file); !written) return written;
    item.inputs.push_back({"requests", "requests", file, ""});
  } else {
    const bool more = !arguments.labels.empty() || !arguments.scripts.empty() || !arguments.frames.empty() ||
                      arguments.interpolate > 0 || !arguments.scale.empty() || !arguments.bone_lengths.empty();
    if (more) {
      return Fail(ErrorCode::kUsage, "denoised clips keep their labels, durations and bone lengths", "--denoise",
                  "remove --label, --script, --frames, --interpolate, --scale and --bone-lengths");
    }
    RemakeOptions remake;
    remake.seed = static_cast<std::int64_t>(arguments.seed);
    item.options = OptionsToJson(remake);
    item.inputs.push_back({"motions", DisplayPath(arguments.denoise), arguments.denoise, ""});
  }
  const auto generated = (*stages)->One(GenerateDeclaration(), std::move(item));
  if (!generated) return Forward(generated);
  asked = generated->summary.value("motions", asked);
  if (arguments.denoise.empty()) {
    if (Status copied = CopyWhole(generated->artifact, arguments.output); !copied) return copied;
  } else if (Status written = WriteDenoised(generated->artifact, arguments.denoise, arguments.output); !written) {
    return written;
  }
  int meshes = 0;
  if (!arguments.mesh.empty()) {
    const auto set = ReadDataset(arguments.output);
    if (!set) return Forward(set);
    const auto written = WriteMeshes(*set, bodies, arguments.mesh);
    if (!written) return Forward(written);
    meshes = *written;
  }
  if (AnswersInText(common, {{"path", DisplayPath(arguments.output)},
                             {"network", checkpoint->kind},
                             {"motions", asked},
                             {"meshes", meshes}})) {
    Print("%s by %s in %s\n", Counted(static_cast<long long>(asked), "motion").c_str(), options->name.c_str(),
          DisplayPath(arguments.output).c_str());
    if (meshes > 0) {
      Print("%s in %s\n", Counted(meshes, "mesh file").c_str(), DisplayPath(arguments.mesh).c_str());
    }
  }
  return {};
}

}  // namespace mocurate
