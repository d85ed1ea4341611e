#include "ingest/inspect/source_declaration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/motion/skeleton.h"
#include "ingest/chosen_clips.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/options.h"
#include "ingest/sources/babel_segments.h"

namespace mocurate {
namespace {

constexpr const char* kUsualSkeleton = "smpl24";
constexpr double kNearHips = 0.1;  // metres, in the rest pose

bool HoldsAll(const std::vector<std::string>& joints, const Skeleton& skeleton) {
  std::set<int> taken;
  for (const std::string& name : joints) {
    if (name.empty() || name == "-") continue;
    const auto is_it = [&](const Landmark& landmark) { return landmark.name == name; };
    if (std::any_of(skeleton.landmarks.begin(), skeleton.landmarks.end(), is_it)) continue;
    const auto joint = skeleton.FindJoint(name);
    if (!joint || !taken.insert(*joint).second) return false;
  }
  return !taken.empty();
}

bool RootBetweenHips(const Skeleton& skeleton) {
  const auto hips = skeleton.Hips();
  if (!hips) return false;
  Vector3d middle = Vector3d::Zero();
  for (const int hip : *hips) {
    for (int joint = hip; joint > 0; joint = skeleton.joints[static_cast<std::size_t>(joint)].parent)
      middle += 0.5 * skeleton.joints[static_cast<std::size_t>(joint)].rest_offset;
  }
  return middle.norm() < kNearHips;
}

/// The skeleton of configs/skeletons/ to fit tracks of these joints with: one that has them all, each once, and its
/// root between the hips. "smpl24" where it does; else the one of fewest joints; empty where none does. "" and "-" are
/// no joints.
std::string FittedSkeleton(const std::vector<std::string>& joints) {
  const Expected<SkeletonPtr> usual = LoadSkeleton(kUsualSkeleton);
  if (usual && HoldsAll(joints, **usual)) return kUsualSkeleton;
  SkeletonPtr best;
  for (const std::string& name : SkeletonNames()) {
    const Expected<SkeletonPtr> skeleton = LoadSkeleton(name);
    if (!skeleton || !HoldsAll(joints, **skeleton) || !RootBetweenHips(**skeleton)) continue;
    if (!best || (*skeleton)->joint_count() < best->joint_count()) best = *skeleton;
  }
  return best ? best->name : "";
}

constexpr double kFacingHabit = 0.6;   // share of votes that face one way, below which facing is no habit of the source
constexpr double kFewestVoters = 0.1;  // share of clips that must show something, to be believed of all
constexpr double kNearUsual = 0.02;    // relative, of a measured rate
constexpr double kOneRate = 0.99;      // share of files that say the same rate
constexpr std::size_t kMostFindings = 10;

/// ingest.source.format of what an inspection calls a clip's format; empty: no source can be of it.
std::string DeclaredFormat(const std::string& inspected) {
  if (inspected == "npz") return "npy";
  if (inspected == "depth_still") return "depth_sequence";
  for (const FormatDriver& driver : FormatDrivers()) {
    if (driver.clip_format() == inspected && driver.to_clip != nullptr) return driver.name;
  }
  return "";
}

void WriteAxes(const ClipConsensus& source, DeclarationWriter& writer) {
  const Vote<std::string> axes = source.Ask(&InspectedClip::axes);
  const Vote<std::string> up = source.Ask(&InspectedClip::up);
  const Vote<std::string> hand = source.Ask(&InspectedClip::handedness);
  if (axes.value && axes.share >= kFacingHabit && axes.voters >= kFewestVoters) {
    writer.Value("axes", YamlQuoted(*axes.value), axes.comment);
    return;
  }
  const bool known = up.value && hand.value && std::min(up.voters, hand.voters) >= kFewestVoters;
  if (const auto turned = known ? AxesFrom(*up.value, hand.value == "right") : std::nullopt) {
    writer.Comment("Up: " + up.comment + ".");
    writer.Comment("Handedness: " + hand.comment + ".");
    writer.Value("axes", YamlQuoted(*turned), "people face no one way: which way is front is a choice");
    return;
  }
  const auto stated = [](const Vote<std::string>& vote) {
    return vote.value.value_or("is unknown (" + vote.comment + ")");
  };
  writer.Unknown("axes", "up " + stated(up) + ", handedness " + stated(hand));
}

void WriteUnits(const ClipConsensus& source, const std::string& format, DeclarationWriter& writer) {
  const UnitOf unit = DriverOf(format).unit;
  if (unit == UnitOf::kCentimetres) return writer.Line("    # units: centimetres, declared by the format");
  if (unit != UnitOf::kDeclaration) return writer.Line("    # units: metres, declared by the format");
  const Vote<std::string> units = source.Ask(&InspectedClip::units);
  if (!units.value) return writer.Unknown("units", units.comment);
  writer.Value("units", YamlQuoted(*units.value), units.comment);
}

/// The usual rate that the one of a clock is near to.
std::optional<double> UsualRate(double measured) {
  for (const double usual : {24.0, 25.0, 30.0, 50.0, 60.0, 90.0, 100.0, 120.0, 200.0, 240.0}) {
    if (std::abs(measured / usual - 1.0) < kNearUsual) return usual;
  }
  return std::nullopt;
}

/// The most frequent text of a fact, of those that leave nothing to fill in where there are any, and a clip with it.
std::pair<std::string, const InspectedClip*> UsualFact(const ClipConsensus& source, const char* key) {
  std::map<std::string, std::size_t> counts;
  std::pair<std::string, const InspectedClip*> usual{"", nullptr};
  const auto open = [](const std::string& text) { return text.find(kFillIn) != std::string::npos; };
  for (const InspectedClip* clip : source.clips()) {
    const std::string text = clip->Fact(key);
    if (text.empty()) continue;
    const std::size_t count = ++counts[text];
    const bool better = open(text) == open(usual.first) ? count > counts[usual.first] : !open(text);
    if (usual.second == nullptr || better) usual = {text, clip};
  }
  return usual;
}

void WriteRate(const ClipConsensus& source, const std::string& format, DeclarationWriter& writer) {
  const Vote<double> rate = source.Ask(&InspectedClip::rate_hz);
  if (!rate.value) {
    if (!DriverOf(format).states_rate) writer.Unknown("rate", rate.comment);
    return;
  }
  const std::string hz = FormatDouble(*rate.value) + " Hz";
  if (CheckStatedRate(*rate.value, RateUnit::kFramesPerSecond, ""))
    return writer.Comment("rate: the files' own, " + hz + ", is no rate of a recording: declare the right one");
  if (rate.from == Provenance::kMeasured) {
    const std::optional<double> usual = UsualRate(*rate.value);
    if (!usual) return writer.Comment("rate: by the times of each file, " + rate.comment);
    return writer.Value("rate", FormatDouble(*usual) + " Hz",
                        "the usual rate that is nearest; " + rate.comment + ", " + hz);
  }
  if (rate.share < kOneRate) return writer.Comment("rate: each file declares its own, mostly " + hz);
  writer.Value("rate", hz, rate.comment);
}

/// Names of the joints as they stand in the file.
std::vector<std::string> JointsOf(const InspectedClip& clip) {
  if (!clip.first_frame.value) return {};
  return clip.joint_names.empty() ? std::vector<std::string>(clip.first_frame.value->size()) : clip.joint_names;
}

/// Formats whose rotations are those of SMPL's joints.
bool IsSmpl(const std::string& format) {
  return format == "amass" || format == "humanact12_pickle" || format == "uestc" || format == "vibe_tracks";
}

/// The skeleton of configs/skeletons that the rotations of the files belong to; empty where their tree is their own, or
/// nothing says it.
std::string SkeletonOfRotations(const ClipConsensus& source, const std::string& format) {
  if (IsSmpl(format)) return "smpl24";
  const Vote<std::string> skeleton = source.Ask(&InspectedClip::skeleton);
  return skeleton.value && LoadSkeleton(*skeleton.value) ? *skeleton.value : "";
}

/// Rotations that the files hold are kept, where a job by itself fits others to the joints, on smpl24.
void WriteRecordedRotations(const ClipConsensus& source, const std::string& format, DeclarationWriter& writer) {
  if (!DriverOf(format).rotations) return;
  if (const std::string skeleton = SkeletonOfRotations(source, format); !skeleton.empty()) {
    writer.Line("# Of the dataset: the skeleton of the files.");
    writer.Line("skeleton: " + skeleton);
  }
  writer.Line("# The recorded rotations are kept; joint_tracks would replace them by rotations fitted to the joints.");
  writer.Line("fitting: {method: none}");
}

/// How the clips are fitted, where a job by itself would fit joint tracks.
void WriteMethod(const std::string& format, DeclarationWriter& writer) {
  const EvidenceKind gives = DriverOf(format).gives;
  if (gives == EvidenceKind::kKeypoints) writer.Line("fitting: {method: keypoints}");
  if (gives == EvidenceKind::kDepthViews || gives == EvidenceKind::kPointClouds)
    writer.Line("fitting: {method: point_clouds}");
}

void WriteSkeleton(const ClipConsensus& source, const std::string& format, DeclarationWriter& writer) {
  const Vote<std::string> skeleton = source.Ask(&InspectedClip::skeleton);
  if (format == "bvh" || format == "asf_amc") {
    const std::string known = SkeletonOfRotations(source, format);
    return writer.Value(
        "skeleton", YamlQuoted(known),
        known.empty() ? "the files' own tree: its joints are those of no known skeleton" : skeleton.comment);
  }
  if (IsSmpl(format)) return writer.Value("skeleton", "smpl24", "declared by the format: its rotations are SMPL's");
  if (format == "depth_sequence") return writer.Value("skeleton", "\"\"", "unknown, and not needed to read images");
  if (!skeleton.value) {
    writer.Unknown("skeleton", skeleton.comment);
    if (format != "ntu_skeleton")
      writer.UnknownList("joints", "names in the order of the file, \"-\" for what is no joint");
    return;
  }
  if (LoadSkeleton(*skeleton.value)) {
    writer.Value("skeleton", YamlQuoted(*skeleton.value), skeleton.comment);
  } else {
    writer.Unknown("skeleton", "the order is " + *skeleton.value + "'s, of which there is no tree");
  }
  if (format == "ntu_skeleton") return;
  writer.List("joints", JointsOf(source.ClearestSkeleton()), "in the order of the file, as for the skeleton");
}

/// The skeleton of the dataset, where the one that a job takes by itself does not have the joints that are tracked.
void WriteFittedSkeleton(const ClipConsensus& source, const std::string& format, DeclarationWriter& writer) {
  if (format != "joint_table" && format != "ntu_skeleton") return;  // motions keep their own
  const Vote<std::string> order = source.Ask(&InspectedClip::skeleton);
  if (!order.value) return;
  const std::string known = *order.value;
  const std::string fitted = FittedSkeleton(JointsOf(source.ClearestSkeleton()));
  if (fitted == "smpl24" || (fitted.empty() && !LoadSkeleton(known))) return;
  writer.Line(
      "# Of the dataset: the least skeleton in configs/skeletons that has all tracked joints, and its root between");
  writer.Line("# the hips.");
  writer.Line("skeleton: " + (fitted.empty() ? known : fitted));
}

void WriteTable(const ClipConsensus& source, DeclarationWriter& writer) {
  const auto fact = [&](const char* key) { return UsualFact(source, key).first; };
  for (const char* option : {"layout", "columns"}) {
    const auto [text, clip] = UsualFact(source, option);
    if (clip == nullptr) continue;
    const bool layout = option == std::string("layout");
    const std::size_t open = text.find(kFillIn), z = text.find('z');
    const bool behind = open != std::string::npos && z != std::string::npos && open > z;
    writer.Measured(option, layout ? YamlQuoted(text) : "[" + text + "]", clip->frames.evidence,
                    open == std::string::npos ? ""
                    : behind                  ? "`confidence` or `skip`: nothing says what stands behind x, y, z"
                             : "`frame` where the column counts frames, or its unit where it is a clock: "
                               "time_s, time_ms, time_us, time_100ns, time_ns; the findings have its steps");
    if (!behind) break;
    const auto unsure = std::find_if(source.clips().begin(), source.clips().end(),
                                     [](const InspectedClip* one) { return !one->missing_share.value; });
    if (unsure != source.clips().end()) {
      writer.Comment(
          "least_confidence: 0.1 takes joints of confidence 0 as seen, but doubted; without it they are not seen. " +
          (*unsure)->missing_share.evidence);
    }
    break;
  }
  if (!fact("end_word").empty()) writer.Value("end_word", fact("end_word"), "measured: the last line of some files");
  double missing = 0.0;
  for (const std::string& share : source.Facts("at_origin")) {
    missing = std::max(missing, ParseDouble(share).value_or(0.0));
  }
  if (missing > 0.0) {
    writer.Value("missing", "zero",
                 "measured: up to " + TwoDecimals(100.0 * missing) + " % of a clip's joints are at the origin");
  }
}

/// BABEL's files of the folder, and how many of the motions they speak of.
void WriteAnnotations(const ClipConsensus& source, const Inspection& inspection, const std::filesystem::path& folder,
                      DeclarationWriter& writer) {
  std::vector<std::string> files;
  std::string list;
  for (const RawCompanion& companion : inspection.companions) {
    if (companion.format != "babel") continue;
    files.push_back(companion.file);
    list += (list.empty() ? "" : ", ") + YamlQuoted(files.back());
  }
  if (files.empty()) return writer.Comment("annotations: no file of BABEL's lies in the folder, clips have no labels");
  Expected<BabelIndex> babel = BabelIndex::Read(folder, files);
  if (!babel) return writer.Comment("annotations: not written, " + babel.error().Message());
  const auto spoken_of = [&](const InspectedClip* clip) { return babel->Find(clip->file) != nullptr; };
  const auto joined = std::count_if(source.clips().begin(), source.clips().end(), spoken_of);
  writer.Value("annotations", "[" + list + "]",
               "BABEL's, joined by the path in `feat_p`, which names " + std::to_string(joined) + " of the " +
                   Counted(source.clips().size(), "motion") +
                   (joined > 0 ? "" : ": keep AMASS's folders as they were"));
}

std::string FormatToDeclare(const Inspection& inspection) {
  std::map<std::string, std::size_t> counts;
  for (const InspectedClip& clip : inspection.clips) {
    if (!DeclaredFormat(clip.format).empty()) counts[clip.format] += 1;
  }
  std::string best;
  for (const auto& [format, count] : counts) {
    if (best.empty() || count > counts[best]) best = format;
  }
  return best;
}

void WriteHead(const std::string& what, DeclarationWriter& writer) {
  writer.Line("# Made by `mocurate config init` from " + what + ".");
  writer.Line("# Every value has its origin. " + std::string(kFillIn) + " has to be replaced before a run.");
}

void WriteSource(const std::filesystem::path& path, const std::string& name, const std::string& format,
                 DeclarationWriter& writer) {
  writer.Line("ingest:");
  writer.Line("  path: " + YamlQuoted(DisplayPath(path)));
  writer.Line("  source:");
  writer.Value("name", YamlQuoted(name), "a choice: the first part of every clip's id");
  writer.Value("format", format, "declared by the file");
}

/// Depth images and point clouds have no clips of their own in an inspection.
WrittenDeclaration DeclareSurfaces(const Inspection& inspection, const std::filesystem::path& path,
                                   const std::string& name) {
  const bool images = IsDepthViews(inspection);
  WrittenDeclaration written;
  std::error_code unknown;
  written.path = std::filesystem::absolute(path, unknown);
  DeclarationWriter writer(written);
  const auto count = static_cast<long long>(images ? inspection.cameras.size() : inspection.clouds.size());
  WriteHead(images ? "depth images of " + Counted(count, "calibrated camera") : Counted(count, "point cloud"), writer);
  const char* format = images ? "depth_views" : "clouds";
  WriteMethod(format, writer);
  WriteSource(written.path, name, format, writer);
  if (images)
    WriteDepthViews(inspection, path, writer);
  else
    WriteClouds(inspection, writer);
  return written;
}

}  // namespace

Status ChooseClips(const std::vector<std::string>& names, Inspection& inspection) {
  const std::vector<InspectedClip>& clips = inspection.clips;
  std::vector<bool> chosen(clips.size(), names.empty());
  for (const std::string& name : names) {
    bool known = false;
    for (std::size_t i = 0; i < clips.size(); ++i) {
      const std::string &id = clips[i].id, &file = clips[i].file;
      if (id != name && !NamesClip(name, file, id.substr(std::min(id.size(), file.size())))) continue;
      known = chosen[i] = true;
    }
    if (known) continue;
    std::string first;
    for (std::size_t i = 0; i < std::min(clips.size(), kMostFindings); ++i) first += (i == 0 ? "" : ", ") + clips[i].id;
    return Fail(
        ErrorCode::kUsage, "there is no clip '" + name + "'", "--clip",
        clips.empty() ? "no clips are there" : "it has " + first + (clips.size() > kMostFindings ? ", ..." : ""));
  }
  std::vector<InspectedClip> kept;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (chosen[i]) kept.push_back(clips[i]);
  }
  inspection.clips = std::move(kept);
  return {};
}

Expected<WrittenDeclaration> DeclareSource(Inspection inspection, const std::filesystem::path& path,
                                           const std::string& name) {
  const std::string observed = FormatToDeclare(inspection);
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(path, unknown);
  const bool surfaces = IsDepthViews(inspection) || !inspection.clouds.empty();
  if (observed.empty() && folder && surfaces) return DeclareSurfaces(inspection, path, name);
  if (observed.empty()) {
    std::string why = "no file holds motion in a format that a source can declare";
    const auto fault = std::find_if(inspection.findings.begin(), inspection.findings.end(),
                                    [](const Finding& finding) { return finding.severity == Severity::kError; });
    if (fault != inspection.findings.end()) why += ": " + fault->message;
    return Fail(ErrorCode::kUnsupported, why, DisplayPath(path), "`mocurate inspect` describes the files");
  }
  const std::string format = DeclaredFormat(observed);
  const ClipConsensus source(inspection, observed);
  WrittenDeclaration written;
  DeclarationWriter writer(written);
  const std::filesystem::path normal = std::filesystem::absolute(path, unknown).lexically_normal();
  const std::filesystem::path whole = normal.filename().empty() ? normal.parent_path() : normal;
  const std::filesystem::path asked = folder ? whole : whole.parent_path();
  const bool gathered = DriverOf(format).gathered();
  const SourceRoot root = format == "openpose"  ? RootOfCameras(asked, inspection)
                          : format == "asf_amc" ? RootOfSkeletons(source, asked)
                                                : SourceRoot{asked, ""};
  written.path = folder ? root.folder : whole;
  WriteHead(Counted(static_cast<long long>(source.clips().size()), "clip") + " of format " + observed, writer);
  for (const auto& [what, count] : source.others()) {
    written.others.push_back(Counted(static_cast<long long>(count), "clip") + " of format " + what);
    writer.Line("# Not of this source: " + written.others.back() + ".");
  }
  WriteFittedSkeleton(source, format, writer);
  WriteRecordedRotations(source, format, writer);
  WriteMethod(format, writer);
  WriteSource(written.path, name, format, writer);
  if (gathered) {
    WriteGathered(source, inspection, asked, root.prefix, format, writer);
  } else {
    WriteNames(source, format, whole, root, writer);
  }
  writer.Value("other_files", "ignore", "a choice: `error` refuses files that the pattern does not match");
  writer.Value("licence", "\"\"", "unknown: no file declares it");
  if (format != "openpose") WriteUnits(source, format, writer);
  if (format != "openpose") WriteAxes(source, writer);
  WriteRate(source, format, writer);
  if (!gathered) WriteSkeleton(source, format, writer);
  if (format == "joint_table") WriteTable(source, writer);
  if (format == "amass" && folder) WriteAnnotations(source, inspection, root.folder, writer);
  std::map<std::string, std::pair<std::size_t, std::string>> findings;
  for (const Finding& finding : inspection.findings) {
    if (finding.severity == Severity::kInfo) continue;
    auto& [count, first] = findings[finding.code];
    if (count++ == 0) first = finding.clip + ": " + finding.message;
  }
  std::size_t listed = 0;
  for (const auto& [code, entry] : findings) {
    if (listed++ == kMostFindings) break;
    writer.Comment("Finding " + code + " (" + std::to_string(entry.first) + "), first " + entry.second);
  }
  return written;
}

}  // namespace mocurate
