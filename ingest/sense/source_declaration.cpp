#include "ingest/sense/source_declaration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/motion/skeleton.h"
#include "ingest/chosen_clips.h"
#include "ingest/formats/driver.h"
#include "ingest/options.h"
#include "ingest/sense/clip_votes.h"
#include "ingest/sense/declaration_writer.h"
#include "ingest/sense/declared_names.h"
#include "ingest/sense/fitted_skeleton.h"
#include "ingest/sense/source_root.h"
#include "ingest/sources/babel_segments.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr double kFacingHabit = 0.6;   // share of votes that face one way, below which facing is no habit of the source
constexpr double kFewestVoters = 0.1;  // share of clips that must show something, to be believed of all
constexpr double kNearUsual = 0.02;    // relative, of a measured rate
constexpr double kOneRate = 0.99;      // share of files that say the same rate
constexpr std::size_t kMostFindings = 10;

/// Format of an inspection -> ingest.source.format.
const std::map<std::string, std::string>& Formats() {
  static const std::map<std::string, std::string> formats = {{"joint_table", "joint_table"},
                                                             {"bvh", "bvh"},
                                                             {"npy", "npy"},
                                                             {"npz", "npy"},
                                                             {"ntu_skeleton", "ntu_skeleton"},
                                                             {"amc", "asf_amc"},
                                                             {"amass", "amass"},
                                                             {"expmap_table", "expmap"},
                                                             {"phspd_pose", "phspd"},
                                                             {"depth_sequence", "depth_sequence"},
                                                             {"vibe_tracks", "vibe_tracks"},
                                                             {"vibe_cache", "uestc"},
                                                             {"humanact12_pickle", "humanact12_pickle"},
                                                             {"openpose", "openpose"},
                                                             {"panoptic_bodies", "panoptic"},
                                                             {"depth_still", "depth_sequence"}};
  return formats;
}

void WriteAxes(const ClipVotes& source, DeclarationWriter& writer) {
  const Vote axes = source.Ask("axes");
  const Vote up = source.Ask("up");
  const Vote hand = source.Ask("handedness");
  if (!axes.value.is_null() && axes.share >= kFacingHabit && axes.voters >= kFewestVoters) {
    writer.Value("axes", Quoted(axes.value), axes.comment);
    return;
  }
  const std::optional<std::string> turned =
      up.value.is_null() || hand.value.is_null() || std::min(up.voters, hand.voters) < kFewestVoters
          ? std::nullopt
          : AxesFrom(up.value, hand.value == "right");
  if (turned) {
    writer.Comment("Up: " + up.comment + ".");
    writer.Comment("Handedness: " + hand.comment + ".");
    writer.Value("axes", Quoted(*turned), "people face no one way: which way is front is a choice");
    return;
  }
  writer.Unknown("axes",
                 "up " + (up.value.is_null() ? "is not told (" + up.comment + ")" : up.value.get<std::string>()) +
                     ", handedness " +
                     (hand.value.is_null() ? "is not told (" + hand.comment + ")" : hand.value.get<std::string>()));
}

void WriteUnits(const ClipVotes& source, const std::string& format, DeclarationWriter& writer) {
  const bool by_format = format == "ntu_skeleton" || format == "amass" || format == "vibe_tracks" ||
                         format == "uestc" || format == "humanact12_pickle" || format == "depth_sequence" ||
                         format == "phspd";
  if (format == "panoptic") return writer.Line("    # units: centimetres, declared by the format");
  if (by_format) return writer.Line("    # units: metres, declared by the format");
  const Vote units = source.Ask("units");
  if (units.value.is_null()) return writer.Unknown("units", units.comment);
  writer.Value("units", Quoted(units.value), units.comment);
}

/// The usual rate that a measured one is near to.
std::optional<double> UsualRate(double measured) {
  for (const double usual : {24.0, 25.0, 30.0, 50.0, 60.0, 90.0, 100.0, 120.0, 200.0, 240.0}) {
    if (std::abs(measured / usual - 1.0) < kNearUsual) return usual;
  }
  return std::nullopt;
}

void WriteRate(const ClipVotes& source, const std::string& format, DeclarationWriter& writer) {
  const Vote rate = source.Ask("rate_hz");
  if (rate.from == "measured") {
    const std::optional<double> usual = UsualRate(rate.value);
    if (!usual) return writer.Unknown("rate", rate.comment);  // near, but no rate to divide times by
    return writer.Value("rate", FormatDouble(*usual) + " Hz",
                        "the usual rate that is nearest; " + rate.comment + ", " + FormatDouble(rate.value) + " Hz");
  }
  if (!rate.value.is_null() && rate.share < kOneRate) {
    return writer.Comment("rate: each file says its own, most " + FormatDouble(rate.value.get<double>()) + " Hz");
  }
  if (!rate.value.is_null()) {
    return writer.Value("rate", FormatDouble(rate.value.get<double>()) + " Hz", rate.comment);
  }
  if (format == "bvh" || format == "amass" || format == "depth_sequence") return;
  writer.Unknown("rate", rate.comment);
}

/// Names of the joints as they stand in the file.
std::vector<std::string> JointsOf(const Json& clip) {
  std::vector<std::string> joints;
  const Json& first = clip.at("first_frame").at("value");
  if (!first.is_array()) return joints;
  for (const Json& point : first)
    joints.push_back(point.at("joint").is_null() ? "" : point.at("joint").get<std::string>());
  return joints;
}

/// Formats whose rotations are those of SMPL's joints.
bool IsSmpl(const std::string& format) {
  return format == "amass" || format == "humanact12_pickle" || format == "uestc" || format == "vibe_tracks";
}

/// The skeleton of configs/skeletons that the rotations of the files belong to; empty where their tree is their own, or
/// nothing says it.
std::string SkeletonOfRotations(const ClipVotes& source, const std::string& format) {
  if (IsSmpl(format)) return "smpl24";
  const Vote skeleton = source.Ask("skeleton");
  return skeleton.value.is_string() && LoadSkeleton(skeleton.value) ? skeleton.value.get<std::string>() : "";
}

/// Rotations that the files hold are kept, where a job by itself fits others to the joints, on smpl24.
void WriteRecordedRotations(const ClipVotes& source, const std::string& format, DeclarationWriter& writer) {
  if (!DriverOf(format).rotations) return;
  if (const std::string skeleton = SkeletonOfRotations(source, format); !skeleton.empty()) {
    writer.Line("# Of the dataset: the skeleton of the files.");
    writer.Line("skeleton: " + skeleton);
  }
  writer.Line("# The recorded rotations are kept; joint_tracks would replace them by rotations fitted to the joints.");
  writer.Line("fitting: {method: none}");
}

void WriteSkeleton(const ClipVotes& source, const std::string& format, DeclarationWriter& writer) {
  const Vote skeleton = source.Ask("skeleton");
  if (format == "bvh" || format == "asf_amc") {
    const std::string known = SkeletonOfRotations(source, format);
    return writer.Value(
        "skeleton", Quoted(known),
        known.empty() ? "the files' own tree: its joints are those of no known skeleton" : skeleton.comment);
  }
  if (IsSmpl(format)) return writer.Value("skeleton", "smpl24", "declared by the format: its rotations are SMPL's");
  if (format == "depth_sequence") return writer.Value("skeleton", "\"\"", "unknown, and not needed to read images");
  if (skeleton.value.is_null()) {
    writer.Unknown("skeleton", skeleton.comment);
    if (format != "ntu_skeleton") writer.UnknownJoints();
    return;
  }
  if (LoadSkeleton(skeleton.value.get<std::string>())) {
    writer.Value("skeleton", Quoted(skeleton.value), skeleton.comment);
  } else {
    writer.Unknown("skeleton", "the order is " + skeleton.value.get<std::string>() + "'s, of which there is no tree");
  }
  if (format == "ntu_skeleton") return;
  writer.List("joints", JointsOf(source.Surest("skeleton")), "in the order of the file, as for the skeleton");
}

/// The skeleton of the dataset, where the one that a job takes by itself does not have the joints that are tracked.
void WriteFittedSkeleton(const ClipVotes& source, const std::string& format, DeclarationWriter& writer) {
  if (format != "joint_table" && format != "ntu_skeleton") return;  // motions keep their own
  const Vote order = source.Ask("skeleton");
  if (order.value.is_null()) return;
  const std::string known = order.value.get<std::string>();
  const std::string fitted = FittedSkeleton(JointsOf(source.Surest("skeleton")));
  if (fitted == "smpl24" || (fitted.empty() && !LoadSkeleton(known))) return;
  writer.Line(
      "# Of the dataset: the least skeleton in configs/skeletons that has all tracked joints, and its root between");
  writer.Line("# the hips.");
  writer.Line("skeleton: " + (fitted.empty() ? known : fitted));
}

void WriteTable(const ClipVotes& source, DeclarationWriter& writer) {
  const auto fact = [&](const char* key) {
    for (const std::string& text : source.Facts(key)) {
      if (!text.empty()) return text;
    }
    return std::string();
  };
  const std::string how = source.Surest("skeleton").at("frames").value("evidence", "");
  if (const std::string layout = fact("layout"); !layout.empty()) {
    writer.Value("layout", Quoted(layout), "measured: " + how);
  } else {
    writer.Value("columns", "[" + fact("columns") + "]", "measured: " + how);
  }
  const auto unsure = std::find_if(source.clips().begin(), source.clips().end(),
                                   [](const Json* clip) { return clip->at("missing_share").at("value").is_null(); });
  if (unsure != source.clips().end() && fact("columns").find("confidence") != std::string::npos) {
    writer.Comment(
        "least_confidence: 0.1 would take joints of confidence 0 as seen, but doubted; without it they are not seen. " +
        (*unsure)->at("missing_share").at("evidence").get<std::string>());
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
void WriteAnnotations(const ClipVotes& source, const Json& inspection, const std::filesystem::path& folder,
                      DeclarationWriter& writer) {
  std::vector<std::string> files;
  std::string list;
  for (const Json& companion : inspection.at("companions")) {
    if (companion.at("format") != "babel") continue;
    files.push_back(companion.at("file"));
    list += (list.empty() ? "" : ", ") + Quoted(files.back());
  }
  if (files.empty()) return writer.Comment("annotations: no file of BABEL's lies in the folder, clips have no labels");
  Expected<BabelIndex> babel = BabelIndex::Read(folder, files);
  if (!babel) return writer.Comment("annotations: not written, " + babel.error().Message());
  const auto spoken_of = [&](const Json* clip) { return babel->Find(clip->at("file").get<std::string>()) != nullptr; };
  const auto joined = std::count_if(source.clips().begin(), source.clips().end(), spoken_of);
  writer.Value("annotations", "[" + list + "]",
               "BABEL's, joined by the path in `feat_p`, which names " + std::to_string(joined) + " of the " +
                   Counted(source.clips().size(), "motion") +
                   (joined > 0 ? "" : ": keep AMASS's folders as they were"));
}

std::string FormatToDeclare(const Json& inspection) {
  std::map<std::string, std::size_t> counts;
  for (const Json& clip : inspection.at("clips")) {
    if (Formats().count(clip.at("format")) != 0) counts[clip.at("format")] += 1;
  }
  std::string best;
  for (const auto& [format, count] : counts) {
    if (best.empty() || count > counts[best]) best = format;
  }
  return best;
}

void WriteHead(const std::string& what, DeclarationWriter& writer) {
  writer.Line("# Made by `mocurate config init` from " + what + ".");
  writer.Line("# Every value says where it comes from. " + std::string(kFillIn) + " has to be replaced before a run.");
}

void WriteSource(const std::filesystem::path& path, const std::string& name, const std::string& format,
                 DeclarationWriter& writer) {
  writer.Line("ingest:");
  writer.Line("  path: " + Quoted(DisplayPath(path)));
  writer.Line("  source:");
  writer.Value("name", Quoted(name), "a choice: the first part of every clip's id");
  writer.Value("format", format, "declared by the file");
}

/// Depth images and point clouds have no clips of their own in an inspection.
WrittenDeclaration DeclareSurfaces(const Json& inspection, const std::filesystem::path& path, const std::string& name) {
  const bool images = IsDepthViews(inspection);
  WrittenDeclaration written;
  std::error_code unknown;
  written.path = std::filesystem::absolute(path, unknown);
  DeclarationWriter writer(written);
  const auto count = static_cast<long long>(inspection.at(images ? "cameras" : "clouds").size());
  WriteHead(images ? "depth images of " + Counted(count, "calibrated camera") : Counted(count, "point cloud"), writer);
  WriteSource(written.path, name, images ? "depth_views" : "clouds", writer);
  if (images)
    WriteDepthViews(inspection, path, writer);
  else
    WriteClouds(inspection, writer);
  return written;
}

}  // namespace

Status ChooseClip(const std::string& clip, Json& inspection) {
  Json chosen = Json::array();
  std::string first;
  std::size_t known = 0;
  for (const Json& candidate : inspection.at("clips")) {
    const std::string file = candidate.at("file"), id = candidate.at("id");
    if (id == clip || NamesClip(clip, file, id.substr(std::min(id.size(), file.size())))) chosen.push_back(candidate);
    if (known++ < kMostFindings) first += (first.empty() ? "" : ", ") + id;
  }
  if (chosen.empty()) {
    return Fail(ErrorCode::kUsage, "there is no clip '" + clip + "'", "--clip",
                known == 0 ? "no clips are there" : "it has " + first + (known > kMostFindings ? ", ..." : ""));
  }
  inspection["clips"] = std::move(chosen);
  return {};
}

Expected<WrittenDeclaration> DeclareSource(const Json& inspected, const std::filesystem::path& path,
                                           const std::string& name) {
  Json inspection = inspected;
  const std::string observed = FormatToDeclare(inspection);
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(path, unknown);
  const bool surfaces = IsDepthViews(inspection) || !inspection.at("clouds").empty();
  if (observed.empty() && folder && surfaces) return DeclareSurfaces(inspection, path, name);
  if (observed.empty()) {
    std::string why = "no file holds motion in a format that a source can declare";
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("severity") == "error") {
        why += ": " + finding.at("message").get<std::string>();
        break;
      }
    }
    return Fail(ErrorCode::kUnsupported, why, DisplayPath(path), "`mocurate inspect` says what is there");
  }
  const std::string& format = Formats().at(observed);
  const ClipVotes source(inspection, observed);
  WrittenDeclaration written;
  DeclarationWriter writer(written);
  const std::filesystem::path normal = std::filesystem::absolute(path, unknown).lexically_normal();
  const std::filesystem::path whole = normal.filename().empty() ? normal.parent_path() : normal;
  const std::filesystem::path asked = folder ? whole : whole.parent_path();
  const bool gathered = format == "openpose" || format == "panoptic";
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
  WriteSource(written.path, name, format, writer);
  if (gathered) {
    WriteGathered(source, inspection, asked, root.prefix, format, writer);
  } else {
    WriteNames(source, format, whole, root, writer);
  }
  writer.Value("other_files", "ignore", "a choice: `error` refuses files that the pattern does not match");
  writer.Value("licence", "\"\"", "unknown: no file says it");
  if (format != "openpose") WriteUnits(source, format, writer);
  if (format != "openpose") WriteAxes(source, writer);
  WriteRate(source, format, writer);
  if (!gathered) WriteSkeleton(source, format, writer);
  if (format == "joint_table") WriteTable(source, writer);
  if (format == "amass" && folder) WriteAnnotations(source, inspection, root.folder, writer);
  std::map<std::string, std::pair<std::size_t, std::string>> findings;
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("severity") == "info") continue;
    auto& entry = findings[finding.at("code")];
    if (entry.first++ == 0) {
      entry.second = finding.at("where").get<std::string>() + ": " + finding.at("message").get<std::string>();
    }
  }
  std::size_t told = 0;
  for (const auto& [code, entry] : findings) {
    if (told++ == kMostFindings) break;
    writer.Comment("Finding " + code + " (" + std::to_string(entry.first) + "), first " + entry.second);
  }
  return written;
}

}  // namespace mocurate
