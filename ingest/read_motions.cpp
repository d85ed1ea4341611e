#include "ingest/read_motions.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <tuple>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/formats/npy.h"
#include "core/motion/gaps.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/quality/padding.h"
#include "ingest/discover.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/item_facts.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

/// The clip's own motion, or its tracks as one.
Status GiveMotion(const SourceOptions& source, Clip& clip) {
  if (clip.motion) return {};
  if (!clip.evidence.tracks) {
    return Fail(ErrorCode::kUnsupported, "the clip holds neither a motion nor joint tracks", clip.id(),
                "fit it first: mocurate fit");
  }
  if (source.skeleton.empty()) {
    return Fail(ErrorCode::kUnsupported, "joint tracks without a skeleton are no motion", clip.id(),
                "fit them first (mocurate fit), or declare ingest.source.skeleton");
  }
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(source.skeleton);
  if (!skeleton) return Forward(skeleton);
  Expected<Motion> motion = MotionFromTracks(*clip.evidence.tracks, *skeleton, clip.rate, MaxGapOf(clip));
  if (!motion) return Forward(motion);
  clip.motion = std::move(*motion);
  return {};
}

/// Whether the clip can stand in one file with those before it.
Status FitsSet(const Dataset& set, const Clip& clip) {
  const Motion& motion = *clip.motion;
  if (set.clips.empty()) return {};
  if (!SameTree(*set.skeleton, *motion.rest_pose())) {
    return Fail(ErrorCode::kInconsistent,
                "skeleton '" + motion.skeleton->name + "' with " + Counted(motion.joint_count(), "joint") +
                    "; the first clip has '" + set.skeleton->name + "'",
                clip.id(), "read sources of different skeletons one by one");
  }
  if (motion.joints_only() != set.joints_only) {
    return Fail(
        ErrorCode::kInconsistent,
        motion.joints_only() ? "holds no rotations, the first clip does" : "holds rotations, the first clip does not",
        clip.id(), "read them one by one");
  }
  return {};
}

/// The clip's rest pose on the set's skeleton: a person's bones may point elsewhere than the first one's.
void ShareSkeleton(const Dataset& set, Motion& motion) {
  const bool shared = motion.joints_only() || SameRestOffsets(*motion.skeleton, *set.skeleton);
  motion.skeleton = shared ? set.skeleton : WithRestOffsetsOf(*set.skeleton, *motion.skeleton);
  motion.rotation_reference = shared ? nullptr : set.skeleton;
}

/// Whether a name begins with the class and no further letter: "walk_03", "Walk 3", "walk3", not "walker".
bool BeginsWithClass(const std::string& name, const std::string& plain_class) {
  std::size_t matched = 0, at = 0;
  for (; at < name.size() && matched < plain_class.size(); ++at) {
    const auto c = static_cast<unsigned char>(name[at]);
    if (std::isalnum(c) == 0) continue;
    if (static_cast<char>(std::tolower(c)) != plain_class[matched++]) return false;
  }
  return matched == plain_class.size() &&
         (at == name.size() || std::isalpha(static_cast<unsigned char>(name[at])) == 0);
}

/// A name whose numbers compare as numbers: "2" before "10".
std::string OrderOfName(const std::string& name) {
  constexpr std::size_t kDigits = 20;
  std::string order, digits;
  for (const char c : name + '\0') {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      digits += c;
      continue;
    }
    if (!digits.empty()) order += std::string(kDigits - std::min(kDigits, digits.size()), '0') + digits;
    digits.clear();
    order += c;
  }
  return order;
}

/// Which entry of a batch an item is: "[3]" -> 3.
std::optional<std::size_t> EntryOfItem(const ItemSpec& item) {
  const std::string id = FactsOf(item).array;
  const std::size_t open = id.rfind('[');
  if (open == std::string::npos || id.back() != ']') return std::nullopt;
  const auto entry = ParseInteger(id.substr(open + 1, id.size() - open - 2));
  return entry && *entry >= 0 ? std::optional<std::size_t>(static_cast<std::size_t>(*entry)) : std::nullopt;
}

/// The place of each item in the order of motions: that of the files' names, whose numbers count as numbers, and within
/// a file that of its entries.
std::vector<std::size_t> PlacesOf(const std::vector<ItemSpec>& items) {
  std::vector<std::tuple<std::string, std::size_t, std::size_t>> order;  // file, entry, position in the list
  for (std::size_t i = 0; i < items.size(); ++i) {
    order.emplace_back(OrderOfName(items[i].inputs.front().name), EntryOfItem(items[i]).value_or(0), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> places(items.size());
  for (std::size_t i = 0; i < order.size(); ++i) places[std::get<2>(order[i])] = i;
  return places;
}

/// Error kInconsistent where a list beside the motions has other than one entry of each.
Status CheckCount(std::size_t listed, const char* what, std::size_t motions, const std::string& file,
                  const char* hint) {
  if (listed == 0 || listed == motions) return {};
  return Fail(
      ErrorCode::kInconsistent,
      Counted(static_cast<long long>(listed), what) + " for " + Counted(static_cast<long long>(motions), "motion"),
      file, hint);
}

/// Gives clips their labels: those of a file beside the motions, the clip's own, else the class its name begins
/// with.
class LabelAssignment {
 public:
  LabelAssignment(const MotionLabels& labels, const std::vector<std::string>& classes)
      : labels_(labels), classes_(classes) {}

  /// `place`: of the item in the order of motions. Error kInconsistent where the labels have no name of the motion.
  Status Assign(const ItemSpec& item, std::size_t place, Clip& clip) const {
    const std::string file = StemOfName(item.inputs.front().name);
    if (!labels_.ordered.empty()) {
      clip.label = labels_.ordered[place];
    } else if (!labels_.by_name.empty()) {
      const std::string with_ending = std::filesystem::path(item.inputs.front().name).filename().string();
      for (const std::string& name : {file, with_ending, clip.identity.recording, clip.id()}) {
        const auto found = labels_.by_name.find(name);
        if (found == labels_.by_name.end()) continue;
        clip.label = found->second;
        return {};
      }
      return Fail(ErrorCode::kInconsistent, "the labels name no motion '" + file + "'", clip.id(),
                  "add a line 'name,label' with the file's name without its ending");
    } else if (clip.label.empty() && !EntryOfItem(item)) {
      clip.label = ClassInName(item.inputs.front().name);
    }
    return {};
  }

 private:
  /// "a/walk_03.npy" -> "walk_03".
  static std::string StemOfName(const std::string& name) { return std::filesystem::path(name).stem().string(); }

  /// The longest class that the file's name, or the name of its folder, begins with; else nothing.
  std::string ClassInName(const std::string& name) const {
    const std::filesystem::path path(name);
    std::string best;
    for (const std::string& text : {path.parent_path().filename().string(), path.stem().string()}) {
      for (const std::string& listed : classes_) {
        const std::string plain = LettersAndDigits(listed);
        if (plain.size() > LettersAndDigits(best).size() && BeginsWithClass(text, plain)) best = listed;
      }
    }
    return best;
  }

  const MotionLabels& labels_;
  const std::vector<std::string>& classes_;
};

/// Number of the motion's frames within the length that is stated for it; all without one. A length counts frames of
/// the file, of which those without an observation at both ends are cut already. Error kInconsistent where the file has
/// fewer frames, or shows nothing within them.
Expected<int> StatedFrames(const MotionsOptions& options, const MotionLengths& lengths, std::size_t place,
                           const ReadItem& read) {
  const Clip& clip = read.clip;
  const int frames = clip.motion->frame_count();
  if (lengths.frames.empty()) return frames;
  const std::int64_t stated = lengths.frames[place];
  std::int64_t of_file = frames;
  for (const Finding& finding : read.outcome.findings) {
    if (finding.code == "unobserved_ends") of_file += std::lround(finding.value);
  }
  if (stated > of_file) {
    return Fail(ErrorCode::kInconsistent,
                Counted(stated, "frame") + " are stated, the motion " + clip.id() + " has " + std::to_string(of_file),
                lengths.places[place], "state at most the frames of the motion");
  }
  // Clips of a dataset count the frames of their recording, and keep their ends.
  const int begin = DriverOf(options.ingest.source.format).stored ? 0 : clip.identity.begin_frame;
  if (stated <= begin) {
    return Fail(ErrorCode::kInconsistent,
                Counted(stated, "frame") + " are stated, and nothing is observed in the first " +
                    Counted(begin, "frame") + " of the motion " + clip.id(),
                lengths.places[place], "state more frames, or leave the motion out");
  }
  return static_cast<int>(std::min<std::int64_t>(stated - begin, frames));
}

/// Cuts a motion to its first `stated` frames and cuts or counts its padding. Error kInconsistent for a motion of
/// zeros.
Status TreatPadding(const MotionsOptions& options, int stated, bool states_lengths, ReadMotions& read, Clip& clip) {
  const int all = clip.motion->frame_count();
  int frames = stated;
  if (frames < all) {
    Expected<Clip> cut = Cut(clip, 0, frames);
    if (!cut) return Forward(cut);
    clip = std::move(*cut);
  }
  if (options.padding != PaddingAction::kNone) {
    const bool foreign = !DriverOf(options.ingest.source.format).stored;
    frames = FramesWithoutPadding(*clip.motion, foreign && !states_lengths);
  }
  if (frames == all) return {};
  if (frames == 0 && options.padding == PaddingAction::kCut) {
    return Fail(ErrorCode::kInconsistent, "all of its " + Counted(all, "frame") + " are zero: it is no motion",
                clip.id(), "remove it, or score it as it is: --padding keep");
  }
  const std::string id = clip.id();
  ++read.padded.motions;
  read.padded.frames += all - frames;
  if (read.padded.first.empty()) read.padded.first = id;
  if (options.padding == PaddingAction::kKeep) return {};
  if (frames < clip.motion->frame_count()) {
    Expected<Clip> cut = Cut(clip, 0, frames);
    if (!cut) return Forward(cut);
    clip = std::move(*cut);
  }
  read.set.findings.push_back(MakeFinding("padding_cut", Severity::kInfo, all - frames,
                                          Counted(all - frames, "frame") + " of padding at the end are cut",
                                          FindingAction::kRepaired));
  read.set.findings.back().clip = clip.id();
  return {};
}

bool Tolerates(const MotionsOptions& options, const std::string& code) {
  return std::find(options.tolerate.begin(), options.tolerate.end(), code) != options.tolerate.end();
}

/// The declaration under which findings that are tolerated exclude no clip.
IngestOptions Tolerating(const MotionsOptions& options) {
  IngestOptions ingest = options.ingest;
  for (const std::string& code : options.tolerate) {
    const OnFinding action = ingest.source.checks.ActionFor(code);
    if (action == OnFinding::kDrop || action == OnFinding::kDropRecorded)
      ingest.source.checks.actions[code] = OnFinding::kReport;
  }
  if (Tolerates(options, "mostly_missing")) ingest.source.max_missing = 1.0;
  if (Tolerates(options, "count_contradiction")) ingest.source.damaged_rows = DamagedRows::kReport;
  return ingest;
}

/// Why a clip is not taken: the finding that refuses or excludes it and is not tolerated, with the way to do so.
/// Nothing where it is taken.
std::optional<Error> WhyNotTaken(const MotionsOptions& options, const ReadItem& read) {
  if (HasArtifact(read.outcome.kind)) return std::nullopt;
  const std::vector<Finding>& findings = read.outcome.findings;
  const bool whole = read.clip.motion || !read.clip.evidence.empty();
  const auto rule = std::find_if(findings.begin(), findings.end(), [&](const Finding& finding) {
    return finding.action == FindingAction::kRefused && !Tolerates(options, finding.code);
  });
  if (read.outcome.kind == OutcomeKind::kRefused && whole && rule == findings.end()) return std::nullopt;
  Error error = read.outcome.error;
  const std::string code = rule != findings.end() ? rule->code : findings.empty() ? "" : findings.back().code;
  if (!code.empty() && (whole || code == "count_contradiction"))
    error.hint += (error.hint.empty() ? "" : "; or ") + ("--tolerate " + code + " reads such clips");
  return error;
}

/// What the clips of a source contradict together, as a run finds it. Clips are refused for it where the declaration
/// asks for that.
void CheckSet(const MotionsOptions& options, std::vector<ItemResult> clips, ReadMotions& read) {
  for (Finding& finding : FindSetContradictions(options.ingest.source, clips)) {
    const bool refuse = options.ingest.source.on_contradiction == OnContradiction::kRefuse;
    if (refuse && !Tolerates(options, finding.code)) {
      for (const Clip& clip : read.set.clips)
        read.refused.push_back({clip.id(),
                                {ErrorCode::kInconsistent, finding.message, clip.id(),
                                 "set ingest.source.on_contradiction: flag to keep such clips; or --tolerate " +
                                     finding.code + " reads them"}});
      read.set.clips.clear();
    }
    read.set.findings.push_back(std::move(finding));
  }
}

/// Why the first item that cannot be read is none; nothing where all can.
std::optional<Error> FirstUnreadable(const MotionsOptions& options, const std::vector<ItemSpec>& items) {
  for (const ItemSpec& item : items) {
    const Expected<ReadItem> one = ReadSourceItem({"motions", item.item, item.options.Whole(), item.inputs, {}, {}});
    if (!one) return one.error();
    if (auto error = WhyNotTaken(options, *one)) return error;
  }
  return std::nullopt;
}

}  // namespace

Expected<MotionLabels> ReadMotionLabels(const std::filesystem::path& file) {
  const Expected<std::string> bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  const std::string name = DisplayPath(file);
  MotionLabels labels;
  labels.file = name;
  if (file.extension() == ".npy") {
    const Expected<NpyArray> array = ParseNpy(*bytes, name);
    if (!array) return Forward(array);
    labels.ordered = array->texts;
    for (const double value : array->values) labels.ordered.push_back(FormatDouble(value));
    return labels;
  }
  int line_number = 0;
  for (const std::string_view raw : SplitText(WithoutByteOrderMark(*bytes), '\n')) {
    ++line_number;
    const std::string line(Trim(raw));
    if (line.empty()) continue;
    const std::size_t comma = line.find(',');
    if (file.extension() != ".csv" || comma == std::string::npos) {
      labels.ordered.push_back(line);
      continue;
    }
    const std::string motion(Trim(line.substr(0, comma))), label(Trim(line.substr(comma + 1)));
    if (label.find(',') != std::string::npos || motion.empty()) {
      return Fail(ErrorCode::kMalformed, "a line is 'name,label', one label a line alone, or empty",
                  name + ":" + std::to_string(line_number));
    }
    if (line_number == 1 && label == "label") continue;
    if (!labels.by_name.emplace(motion, label).second) {
      return Fail(ErrorCode::kMalformed, "'" + motion + "' occurs twice", name + ":" + std::to_string(line_number),
                  "a motion has one label");
    }
  }
  if (!labels.ordered.empty() && !labels.by_name.empty()) {
    return Fail(ErrorCode::kMalformed, "some lines name a motion and some do not", name, "name all, or none");
  }
  if (!labels.empty()) return labels;
  return Fail(ErrorCode::kMalformed, "no label is there", name);
}

Expected<MotionLengths> ReadMotionLengths(const std::filesystem::path& file) {
  const Expected<std::string> bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  MotionLengths lengths;
  lengths.file = DisplayPath(file);
  const auto add = [&](const std::optional<long long>& frames, const std::string& text, std::string place) -> Status {
    if (!frames || *frames < 1) {
      return Fail(ErrorCode::kMalformed, "'" + text + "' is no number of frames: a whole number from 1 on", place,
                  "state one for each motion, in their order");
    }
    lengths.frames.push_back(*frames);
    lengths.places.push_back(std::move(place));
    return {};
  };
  if (file.extension() == ".npy") {
    const Expected<NpyArray> array = ParseNpy(*bytes, lengths.file);
    if (!array) return Forward(array);
    for (std::size_t i = 0; i < array->values.size(); ++i) {
      const std::string text = FormatDouble(array->values[i]);
      if (Status added = add(ParseInteger(text), text, lengths.file + "[" + std::to_string(i) + "]"); !added) {
        return Forward(added);
      }
    }
  } else {
    int line_number = 0;
    for (const std::string_view raw : SplitText(WithoutByteOrderMark(*bytes), '\n')) {
      ++line_number;
      const std::string line(Trim(raw));
      if (line.empty()) continue;
      Status added = add(ParseInteger(line), line, lengths.file + ":" + std::to_string(line_number));
      if (!added) return Forward(added);
    }
  }
  if (!lengths.frames.empty()) return lengths;
  return Fail(ErrorCode::kMalformed, "no length is there", lengths.file, "state one for each motion, in their order");
}

Expected<ReadMotions> ReadAllMotions(const MotionsOptions& options, const MotionLabels& labels,
                                     const MotionLengths& lengths) {
  Expected<Discovery> discovery = Discover(Tolerating(options));
  if (!discovery) return Forward(discovery);
  const LabelAssignment assignment(labels, options.classes);
  const std::vector<std::size_t> places = PlacesOf(discovery->items);
  ReadMotions read;
  read.set.created_by = CreatedBy();
  for (const ItemResult& excluded : discovery->excluded) {
    if (IsFailure(excluded.outcome.kind)) {
      read.refused.push_back({excluded.item, excluded.outcome.error});
    } else {
      const std::vector<Finding>& findings = excluded.outcome.findings;
      read.excluded.insert(read.excluded.end(), findings.begin(), findings.end());
    }
  }
  read.excluded.insert(read.excluded.end(), discovery->findings.begin(), discovery->findings.end());
  Status counts = CheckCount(labels.ordered.size(), "label", places.size(), labels.file,
                             "one label a motion, in the order of the motions, or lines of 'name,label'");
  if (counts) {
    counts = CheckCount(lengths.frames.size(), "length", places.size(), lengths.file,
                        "one length a motion, in the order of the motions");
  }
  if (!counts) {
    if (auto unreadable = FirstUnreadable(options, discovery->items))
      return tl::unexpected<Error>(std::move(*unreadable));
    return Forward(counts);
  }
  std::set<std::string> names;
  std::vector<ItemResult> results;
  for (std::size_t i = 0; i < discovery->items.size(); ++i) {
    const ItemSpec& item = discovery->items[i];
    StageRequest request{"motions", item.item, item.options.Whole(), item.inputs, {}, {}};
    Expected<ReadItem> one = ReadSourceItem(request);
    if (auto error = one ? WhyNotTaken(options, *one) : std::nullopt) one = tl::unexpected<Error>(*std::move(error));
    Status taken = one ? GiveMotion(options.ingest.source, one->clip) : Forward(one);
    if (taken) taken = assignment.Assign(item, places[i], one->clip);
    if (taken) taken = FitsSet(read.set, one->clip);
    const Expected<int> frames = taken ? StatedFrames(options, lengths, places[i], *one) : Forward(taken);
    if (taken && !frames) taken = Forward(frames);
    if (taken) {
      one->clip.evidence = Evidence();
      taken = TreatPadding(options, *frames, !lengths.frames.empty(), read, one->clip);
    }
    if (!taken) {
      read.refused.push_back({item.item, taken.error()});
      continue;
    }
    Clip& clip = one->clip;
    clip.provenance["inspected_as"] = item.inputs.front().name + FactsOf(item).Place();
    if (read.set.clips.empty()) {
      read.set.skeleton = clip.motion->rest_pose();
      read.set.joints_only = clip.motion->joints_only();
    }
    ShareSkeleton(read.set, *clip.motion);
    names.insert(clip.label);
    for (const Finding& finding : one->outcome.findings) read.set.findings.push_back(finding);
    ItemResult result{item.item, {}, {}, {}, false, {}};
    result.summary = one->outcome.summary;
    result.outcome = std::move(one->outcome);
    results.push_back(std::move(result));
    read.set.clips.push_back(std::move(clip));
  }
  CheckSet(options, std::move(results), read);
  if (read.set.clips.empty()) {
    const Error first =
        read.refused.empty() ? Error{ErrorCode::kInconsistent, "no clip is there", "", ""} : read.refused.front().error;
    return Fail(first.code, "no clip can be read; the first: " + first.what,
                first.where.empty() ? DisplayPath(options.ingest.path) : first.where, first.hint);
  }
  std::sort(read.set.clips.begin(), read.set.clips.end(), [](const Clip& a, const Clip& b) { return a.id() < b.id(); });
  names.erase("");
  for (const std::string& listed : options.classes) {
    if (names.erase(listed) > 0) read.set.labels.push_back(listed);
  }
  read.set.labels.insert(read.set.labels.end(), names.begin(), names.end());
  return read;
}

Expected<StageOutcome> MotionsStage(const StageRequest& request) {
  Expected<MotionsOptions> options = OptionsFromJson<MotionsOptions>(request.options, "motions");
  if (!options) return Forward(options);
  MotionLabels labels;
  MotionLengths lengths;
  std::vector<const StageInput*> sources;
  for (const StageInput& input : request.inputs) {
    if (input.role == "source") sources.push_back(&input);
    if (input.role == "lengths") {
      Expected<MotionLengths> given = ReadMotionLengths(input.path);
      if (!given) return Forward(given);
      lengths = std::move(*given);
    }
    if (input.role != "labels") continue;
    Expected<MotionLabels> given = ReadMotionLabels(input.path);
    if (!given) return Forward(given);
    labels = std::move(*given);
  }
  if (sources.empty()) return Fail(ErrorCode::kInternal, "no input with the role 'source'", request.item);
  // The folder is what remains of a path without the name below it.
  const std::string path = sources.front()->path.native(), name = sources.front()->name;
  const bool below = path.size() > name.size() && path.compare(path.size() - name.size(), name.size(), name) == 0;
  options->ingest.path = sources.size() == 1 || !below
                             ? std::filesystem::path(path)
                             : std::filesystem::path(path.substr(0, path.size() - name.size()));
  Expected<ReadMotions> read = ReadAllMotions(*options, labels, lengths);
  if (!read) return Forward(read);
  StageOutcome outcome;
  outcome.findings = read->excluded;
  for (const RefusedClip& refused : read->refused) {
    outcome.findings.push_back(
        MakeFinding("clip_refused", Severity::kError, 0.0, refused.error.Message(), FindingAction::kRefused));
    outcome.findings.back().clip = refused.item;
  }
  for (const Finding& finding : read->set.findings) {
    if (finding.severity == Severity::kError) outcome.findings.push_back(finding);
  }
  outcome.summary = {{"clips", read->set.clips.size()},
                     {"refused", read->refused.size()},
                     {"padded", read->padded.motions},
                     {"padding_frames", read->padded.frames},
                     {"first_padded", read->padded.first}};
  for (const Finding& finding : outcome.findings) {
    if (std::find(read->set.findings.begin(), read->set.findings.end(), finding) == read->set.findings.end())
      read->set.findings.push_back(finding);
  }
  if (Status written = WriteDataset(read->set, request.output); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
