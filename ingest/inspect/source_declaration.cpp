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
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/options.h"

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

/// The usual rate that the one of a clock is near to.
std::optional<double> UsualRate(double measured) {
  for (const double usual : {24.0, 25.0, 30.0, 50.0, 60.0, 90.0, 100.0, 120.0, 200.0, 240.0}) {
    if (std::abs(measured / usual - 1.0) < kNearUsual) return usual;
  }
  return std::nullopt;
}

/// Names of the joints as they stand in the file.
std::vector<std::string> JointsOf(const InspectedClip& clip) {
  if (!clip.first_frame.value) return {};
  return clip.joint_names.empty() ? std::vector<std::string>(clip.first_frame.value->size()) : clip.joint_names;
}

/// The skeleton of configs/skeletons that the rotations of the files belong to; empty where their tree is their own, or
/// nothing says it.
std::string SkeletonOfRotations(const Proposal& proposal) {
  if (*proposal.driver.tree != '\0') return proposal.driver.tree;
  const Vote<std::string> skeleton = proposal.source.Ask(&InspectedClip::skeleton);
  return skeleton.value && LoadSkeleton(*skeleton.value) ? *skeleton.value : "";
}

/// Rotations that the files hold are kept, where a job by itself fits others to the joints, on smpl24.
void WriteRecordedRotations(const Proposal& proposal, DeclarationWriter& writer) {
  if (!proposal.driver.rotations) return;
  if (const std::string skeleton = SkeletonOfRotations(proposal); !skeleton.empty()) {
    writer.Line("# Of the dataset: the skeleton of the files.");
    writer.Line("skeleton: " + skeleton);
  }
  writer.Line("# The recorded rotations are kept; joint_tracks would replace them by rotations fitted to the joints.");
  writer.Line("fitting: {method: none}");
}

/// How the clips are fitted, where a job by itself would fit joint tracks.
void WriteMethod(EvidenceKind gives, DeclarationWriter& writer) {
  if (gives == EvidenceKind::kKeypoints) writer.Line("fitting: {method: keypoints}");
  if (gives == EvidenceKind::kDepthViews || gives == EvidenceKind::kPointClouds)
    writer.Line("fitting: {method: point_clouds}");
}

/// The skeleton of the dataset, where the one that a job takes by itself does not have the joints that are tracked.
void WriteFittedSkeleton(const Proposal& proposal, DeclarationWriter& writer) {
  if (proposal.driver.gives != EvidenceKind::kJointTracks || proposal.driver.gathered()) return;
  const ClipConsensus& source = proposal.source;
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

/// The format of most clips that a source can be of; of a folder without such clips that of its images or clouds.
std::string FormatToDeclare(const Inspection& inspection, bool folder) {
  std::map<std::string, std::size_t> counts;
  for (const InspectedClip& clip : inspection.clips) {
    if (!DeclaredFormat(clip.format).empty()) counts[clip.format] += 1;
  }
  std::string best;
  for (const auto& [format, count] : counts) {
    if (best.empty() || count > counts[best]) best = format;
  }
  if (!best.empty() || !folder) return best;
  return IsDepthViews(inspection) ? "depth_views" : inspection.clouds.empty() ? "" : "clouds";
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

}  // namespace

void WriteAxes(const Proposal& proposal, DeclarationWriter& writer) {
  const ClipConsensus& source = proposal.source;
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

void WriteUnits(const Proposal& proposal, DeclarationWriter& writer) {
  const UnitOf unit = proposal.driver.unit;
  if (unit == UnitOf::kCentimetres) return writer.Line("    # units: centimetres, declared by the format");
  if (unit != UnitOf::kDeclaration) return writer.Line("    # units: metres, declared by the format");
  const Vote<std::string> units = proposal.source.Ask(&InspectedClip::units);
  if (!units.value) return writer.Unknown("units", units.comment);
  writer.Value("units", YamlQuoted(*units.value), units.comment);
}

void WriteRate(const Proposal& proposal, DeclarationWriter& writer) {
  const Vote<double> rate = proposal.source.Ask(&InspectedClip::rate_hz);
  if (!rate.value) {
    if (!proposal.driver.states_rate) writer.Unknown("rate", rate.comment);
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

void WriteSkeleton(const Proposal& proposal, DeclarationWriter& writer) {
  const FormatDriver& driver = proposal.driver;
  if (driver.gives == EvidenceKind::kDepthViews)
    return writer.Value("skeleton", "\"\"", "unknown, and not needed to read images");
  if (*driver.tree != '\0') return writer.Value("skeleton", driver.tree, "declared by the format");
  const Vote<std::string> skeleton = proposal.source.Ask(&InspectedClip::skeleton);
  if (driver.rotations && !driver.needs_skeleton) {
    const std::string known = SkeletonOfRotations(proposal);
    return writer.Value(
        "skeleton", YamlQuoted(known),
        known.empty() ? "the files' own tree: its joints are those of no known skeleton" : skeleton.comment);
  }
  if (driver.HasOption("markers")) {  // the files name their points
    if (skeleton.value) return writer.Value("skeleton", YamlQuoted(*skeleton.value), skeleton.comment);
    return writer.Unknown("skeleton",
                          "that of which the points are joints; of markers that of their set (`include: "
                          "markers/plug_in_gait.yaml` above `ingest`, or `markers` here: docs/formats.md)");
  }
  if (!skeleton.value) {
    writer.Unknown("skeleton", skeleton.comment);
    writer.UnknownList("joints", "names in the order of the file, \"-\" for what is no joint");
    return;
  }
  if (LoadSkeleton(*skeleton.value))
    writer.Value("skeleton", YamlQuoted(*skeleton.value), skeleton.comment);
  else
    writer.Unknown("skeleton", "the order is " + *skeleton.value + "'s, of which there is no tree");
  writer.List("joints", JointsOf(proposal.source.ClearestSkeleton()), "in the order of the file, as for the skeleton");
}

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

Expected<WrittenDeclaration> DeclareSource(const Inspection& inspection, const std::filesystem::path& path,
                                           const std::string& name, NamesOfClips names) {
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(path, unknown);
  const std::string observed = FormatToDeclare(inspection, folder);
  if (observed.empty()) {
    std::string why = "no file holds motion in a format that a source can declare";
    const auto fault = std::find_if(inspection.findings.begin(), inspection.findings.end(),
                                    [](const Finding& finding) { return finding.severity == Severity::kError; });
    if (fault != inspection.findings.end()) why += ": " + fault->message;
    return Fail(ErrorCode::kUnsupported, why, DisplayPath(path),
                inspection.clouds.empty() ? "`mocurate inspect` describes the files"
                                          : "clouds are a file a frame: give the folder that holds them");
  }
  const FormatDriver& driver = DriverOf(DeclaredFormat(observed));
  const ClipConsensus source(inspection, observed);
  WrittenDeclaration written;
  DeclarationWriter writer(names, written);
  const std::filesystem::path normal = std::filesystem::absolute(path, unknown).lexically_normal();
  const std::filesystem::path asked = normal.filename().empty() ? normal.parent_path() : normal;
  const Proposal proposal{source, inspection, driver, asked, folder ? asked : asked.parent_path()};
  WriteHead(!source.clips().empty() ? Counted(source.clips().size(), "clip") + " of format " + observed
            : driver.gives == EvidenceKind::kPointClouds
                ? Counted(inspection.clouds.size(), "point cloud")
                : "depth images of " + Counted(inspection.cameras.size(), "calibrated camera"),
            writer);
  for (const auto& [what, others] : source.others()) {
    written.others.push_back(Counted(static_cast<long long>(others), "clip") + " of format " + what);
    writer.Line("# Not of this source: " + written.others.back() + ".");
  }
  WriteFittedSkeleton(proposal, writer);
  WriteRecordedRotations(proposal, writer);
  WriteMethod(driver.gives, writer);
  WriteSource(asked, name, driver.name, writer);
  if (driver.propose != nullptr) {
    driver.propose(proposal, writer);
  } else {
    WriteFiles(proposal, writer);
    WritePersonAndLabel(false, writer);
  }
  writer.Value("other_files", "ignore", "a choice: `error` refuses files that the pattern does not match");
  writer.Value("licence", "\"\"", "unknown: no file declares it");
  if (!driver.gathered()) {
    WriteUnits(proposal, writer);
    WriteAxes(proposal, writer);
    WriteRate(proposal, writer);
    WriteSkeleton(proposal, writer);
  }
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
