#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/amc.h"
#include "ingest/sense/angle_sense.h"
#include "ingest/sense/asf_sense.h"
#include "ingest/sense/observe.h"
#include "ingest/sense/path_sense.h"
#include "ingest/sense/rate_sense.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

struct Beside {
  fs::path skeleton;   ///< empty: none whose name begins the motion's
  std::string others;  ///< names of those that lie there as well
};

std::string LowerCase(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// "01" begins "01_01", "walk" begins "walk", "1" does not begin "12_01".
bool Begins(const std::string& skeleton, const std::string& motion) {
  if (skeleton.empty() || motion.compare(0, skeleton.size(), skeleton) != 0) return false;
  if (skeleton.size() == motion.size()) return true;
  const char next = motion[skeleton.size()];
  return next == '_' || next == '-' || next == '.' || next == ' ';
}

/// The longest such name, in the motion's folder, then in the one above.
Beside SkeletonBeside(const fs::path& motion) {
  Beside beside;
  const std::string stem = LowerCase(DisplayPath(motion.stem()));
  const fs::path folder = motion.has_parent_path() ? motion.parent_path() : fs::path(".");
  for (const fs::path& place : {folder, folder / ".."}) {
    std::error_code error;
    std::vector<fs::path> found;
    for (fs::directory_iterator at(place, error), end; !error && at != end; at.increment(error)) {
      if (LowerCase(DisplayPath(at->path().extension())) == ".asf") found.push_back(at->path());
    }
    std::sort(found.begin(), found.end());
    std::size_t longest = 0;
    for (const fs::path& path : found) {
      const std::string name = LowerCase(DisplayPath(path.stem()));
      if (Begins(name, stem) && name.size() > longest) {
        longest = name.size();
        beside.skeleton = path;
      }
      beside.others += (beside.others.empty() ? "" : ", ") + DisplayPath(path.filename());
    }
    if (longest > 0) break;
  }
  return beside;
}

/// HDM05's names end with the rate: HDM_bd_depositFloorR_001_120.amc.
std::optional<double> RateOfName(const fs::path& path) {
  const std::string stem = DisplayPath(path.stem());
  const std::vector<std::string_view> words = SplitText(stem, '_');
  if (words.size() != 5 || words[0] != "HDM" || words[3].size() != 3) return std::nullopt;
  const auto rate = ParseInteger(words[4]);
  if (!rate || *rate < 1) return std::nullopt;
  return static_cast<double>(*rate);
}

/// Places where the bones begin; the root first.
void AddPositions(const Asf& asf, const Amc& amc, ObservedClip& clip) {
  clip.joints = static_cast<int>(asf.bones.size()) + 1;
  clip.names = {"root"};
  std::vector<int> parents = {-1};
  for (const AsfBone& bone : asf.bones) {
    clip.names.push_back(bone.name);
    parents.push_back(bone.parent + 1);
  }
  clip.positions = JointPositions(amc.frames, clip.joints);
  std::vector<Vector3d> ends;
  for (int i = 0; i < clip.positions.frames; ++i) {
    Vector3d root = Vector3d::Zero();
    AcclaimForward(asf, amc, i, ends, &root);
    clip.positions.at(i, 0) = root;
    for (std::size_t b = 0; b < asf.bones.size(); ++b) {
      const int parent = asf.bones[b].parent;
      clip.positions.at(i, static_cast<int>(b) + 1) = parent < 0 ? root : ends[static_cast<std::size_t>(parent)];
    }
  }
  if (!amc.damaged.empty()) clip.confidence.assign(clip.positions.xyz.size() / 3, 1.0);
  for (const int f : amc.damaged)
    std::fill_n(clip.confidence.begin() + static_cast<std::ptrdiff_t>(f) * clip.joints, clip.joints, 0.0);
  FollowTree(parents, "hierarchy of the skeleton file", clip);
  if (const auto path = DoubtPath(clip.positions, clip.points)) clip.remarks.push_back(*path);
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveAmc(const FileBytes& file) {
  ObservedClip clip;
  clip.format = "amc";
  clip.rate_evidence = "the file does not say it";
  const Beside beside = SkeletonBeside(file.path);
  std::optional<Asf> asf;
  std::string skeleton_name;
  if (!beside.skeleton.empty()) {
    const std::string skeleton = DisplayPath(beside.skeleton.filename());
    const fs::path folder = fs::path(file.name).parent_path();
    const bool above = beside.skeleton.parent_path().filename() == "..";
    skeleton_name = DisplayPath((above ? folder.parent_path() : folder) / skeleton);
    const Expected<std::string> bytes = ReadFile(beside.skeleton);
    if (!bytes) return Forward(bytes);
    Expected<Asf> parsed = ParseAsf(*bytes, skeleton_name);
    if (!parsed) return Forward(parsed);
    asf = std::move(*parsed);
    clip.facts.emplace_back("skeleton_file", skeleton);
  }
  AmcOptions options;
  options.skeleton = asf ? &*asf : nullptr;
  options.damaged_rows = DamagedRows::kReport;
  const Expected<Amc> amc = ParseAmc(file.bytes, options, file.name);
  if (!amc) return Forward(amc);
  clip.frames = amc->frames;
  clip.layout_evidence = "frames of the file";
  if (amc->hz) {
    clip.rate_hz = amc->hz;
    clip.rate_evidence = ":SAMPLES-PER-SECOND of the file";
    clip.rate_doubt = DoubtRate(*amc->hz, RateWord::kFramesPerSecond, file.name + ": :SAMPLES-PER-SECOND");
  } else if (const auto rate = RateOfName(file.path)) {
    clip.rate_hz = rate;
    clip.rate_evidence = "the name: HDM05's end with the rate";
  }
  clip.AddRemarks(amc->findings);
  std::optional<Finding> angles = asf ? DoubtAngles(*asf, &*amc) : std::nullopt;
  if (!angles) angles = DoubtAngles(*amc, asf ? &*asf : nullptr);
  if (angles) clip.remarks.push_back(*angles);
  if (asf) clip.AddRemarks(DoubtSkeleton(*asf, skeleton_name));
  if (asf && amc->frames > 0) {
    AddPositions(*asf, *amc, clip);
    if (angles) {
      clip.positions = JointPositions();
      clip.confidence.clear();
      clip.silence = kSpoiledPoses;
    }
  } else {
    clip.silence = "without its skeleton file (.asf) a motion has no lengths";
    clip.skeleton_evidence = std::to_string(amc->bones.size()) + " moving bones; no skeleton file";
    clip.remarks.push_back(MakeFinding("skeleton_missing", Severity::kWarning, 0.0,
                                       "no .asf whose name begins this one's lies beside it" +
                                           (beside.others.empty() ? "" : " (" + beside.others + " are of others)") +
                                           ": lengths, unit and axes stay unknown"));
  }
  return std::vector<ObservedClip>{std::move(clip)};
}

Expected<ObservedFile> ObserveAsf(const FileBytes& file) {
  const Expected<Asf> asf = ParseAsf(file.bytes, file.name);
  if (!asf) return Forward(asf);
  ObservedFile observed;
  observed.companions.push_back(
      {file.name,
       "asf",
       {{"angles", asf->degrees ? "degrees" : "radians"}},
       {{"bones", static_cast<double>(asf->bones.size())}, {"length_unit", asf->length_unit}}});
  std::vector<Finding> doubts = DoubtSkeleton(*asf, file.name);
  if (auto angles = DoubtAngles(*asf)) doubts.push_back(*std::move(angles));
  for (const std::vector<Finding>& findings : {asf->findings, doubts}) {
    for (const Finding& finding : findings) observed.remarks.push_back(finding);
  }
  return observed;
}

}  // namespace mocurate
