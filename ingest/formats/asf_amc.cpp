#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/amc.h"
#include "core/motion/kinematics.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/checks/root_scale.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/folder_listing.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/raw_clip.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/bvh_skeleton.h"
#include "ingest/sources/damaged_frames.h"

namespace mocurate {
namespace {

/// Findings about the numbers of a motion, and of its skeleton if there is one.
struct AcclaimFindings {
  std::vector<Finding> findings;
  std::optional<Finding> rate;
};

AcclaimFindings CheckAcclaim(const Asf* asf, const std::string& skeleton, const Amc& amc, const std::string& name,
                             std::optional<double> declared_m) {
  AcclaimFindings checked;
  checked.findings = amc.findings;
  if (asf != nullptr) {
    for (Finding& finding : CheckAsfSkeleton(*asf, skeleton, declared_m))
      checked.findings.push_back(std::move(finding));
  }
  std::optional<Finding> angles = asf != nullptr ? CheckAngleUnits(*asf, &amc) : std::nullopt;
  if (!angles) angles = CheckAngleUnits(amc, asf);
  if (angles) checked.findings.push_back(*std::move(angles));
  if (amc.hz) checked.rate = CheckStatedRate(*amc.hz, RateUnit::kFramesPerSecond, name + ": :SAMPLES-PER-SECOND");
  return checked;
}

Status CheckSkeletonFiles(const SourceOptions& source) {
  if (!source.skeleton_files.empty()) return {};
  return Fail(ErrorCode::kConfig, "source '" + source.name + "' does not declare the .asf of an .amc",
              "ingest.source.skeleton_files", "e.g. '{subject}.asf' where files are '{subject}_{take}.amc'");
}

/// A tree of fixed bones cannot represent a bone that stretches or shifts.
Status CheckDof(const Asf& asf, const std::string& name) {
  for (const AsfBone& bone : asf.bones) {
    for (const AcclaimChannel channel : bone.dof) {
      if (IsRotation(channel)) continue;
      return Fail(ErrorCode::kUnsupported,
                  "bone '" + bone.name + "' has the degree of freedom '" + Name(channel) +
                      "', which a tree of fixed bones cannot represent",
                  name, "only bones with rotational degrees of freedom are read");
    }
  }
  return {};
}

/// The declared unit in metres; nothing where none is declared.
std::optional<double> DeclaredUnit(const SourceOptions& source) {
  const Expected<double> metres = MetresPerUnit(source.units);
  return metres ? std::optional<double>(*metres) : std::nullopt;
}

/// The tree of an ASF: a joint where each bone starts, named as the bone, parents first; joint 0 is the root. `order`
/// is the bone of each joint.
struct AsfTree {
  Bvh tree;
  BvhOffsets offsets;
  std::vector<int> order;
};

AsfTree TreeOf(const Asf& asf, const Matrix3d& metres_from_file) {
  AsfTree made;
  made.order.push_back(-1);
  for (const int bone : asf.Order()) made.order.push_back(bone);
  std::vector<int> joint_of(asf.bones.size(), 0);
  for (std::size_t j = 1; j < made.order.size(); ++j) joint_of[made.order[j]] = static_cast<int>(j);
  for (const int bone : made.order) {
    BvhJoint joint;
    BvhOffsets::Joint offset;
    joint.name = bone < 0 ? "root" : asf.bones[bone].name;
    joint.parent = -1;
    if (bone >= 0) {
      const int parent = asf.bones[bone].parent;
      joint.parent = parent < 0 ? 0 : joint_of[parent];
      if (parent >= 0) offset.offset = metres_from_file * AsfOffset(asf.bones[parent]);
    }
    offset.above_carrier = bone < 0;
    joint.offset = offset.offset;
    made.tree.joints.push_back(std::move(joint));
    made.offsets.joints.push_back(offset);
  }
  return made;
}

/// parent_from_joint of every joint of the tree in one frame, in the file's axes; `root` receives the root's position.
void LocalRotations(const Asf& asf, const Amc& amc, int frame, const AsfTree& made, std::vector<Matrix3d>& local,
                    Vector3d& root) {
  std::vector<Vector3d> ends;
  std::vector<Matrix3d> global;
  AcclaimForward(asf, amc, frame, ends, &root, &global);
  local.assign(made.order.size(), Matrix3d::Identity());
  for (std::size_t j = 1; j < made.order.size(); ++j) {
    const int bone = made.order[j];
    local[j] = AcclaimLocalRotation(asf, amc, frame, bone);
    if (asf.bones[bone].parent < 0) local[0] = global[bone] * local[j].transpose();
  }
}

/// AMC and its ASF -> given motion. A joint lies where its bone starts; rest offsets and lengths are the ASF's. Bones
/// that stretch or shift are refused.
Expected<IngestedClip> ReadAsfAmcClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  const Expected<SkeletonPtr> declared = SourceSkeleton(source);
  if (!declared) return Forward(declared);
  const Expected<Asf> asf = ParseAsf(file.skeleton_bytes, file.skeleton_name);
  if (!asf) return Forward(asf);
  if (Status turns = CheckDof(*asf, file.skeleton_name); !turns) return Forward(turns);
  AmcOptions reading;
  reading.skeleton = &*asf;
  reading.damaged_rows = source.damaged_rows;
  Expected<Amc> amc = ParseAmc(file.bytes, reading, file.name);
  if (!amc) return Forward(amc);
  if (asf->bones.empty() || amc->frames == 0) {
    return Fail(ErrorCode::kInconsistent, asf->bones.empty() ? "the skeleton has no bone" : "the file has no frame",
                asf->bones.empty() ? file.skeleton_name : file.name);
  }

  IngestedClip ingested;
  ingested.findings = asf->findings;
  const AcclaimFindings checked = CheckAcclaim(&*asf, file.skeleton_name, *amc, file.name, DeclaredUnit(source));
  ingested.findings.insert(ingested.findings.end(), checked.findings.begin(), checked.findings.end());
  ingested.clip.rate =
      amc->hz ? RateOfFile(source, *amc->hz, ingested, checked.rate) : FrameRate::FromHz(*source.rate_hz);
  const Matrix3d& world_from_file = frame->world_from_file;
  const Matrix3d& metres_from_file = frame->metres_from_file;
  const AsfTree made = TreeOf(*asf, metres_from_file);
  const Expected<BvhSkeleton> fit =
      MakeBvhSkeleton(made.tree, made.offsets, *declared, source.name, file.skeleton_name);
  if (!fit) return Forward(fit);

  const std::size_t joints = made.order.size();
  std::vector<Vector3d> root_translation;
  std::vector<Quaterniond> rotation(static_cast<std::size_t>(amc->frames) * joints);
  std::vector<Matrix3d> local;
  for (int f = 0; f < amc->frames; ++f) {
    Vector3d root;
    LocalRotations(*asf, *amc, f, made, local, root);
    root_translation.push_back(metres_from_file * root);
    for (std::size_t j = 0; j < joints; ++j) {
      rotation[static_cast<std::size_t>(f) * joints + fit->target[j]] =
          Quaterniond(Matrix3d(world_from_file * local[j] * world_from_file.transpose())).normalized();
    }
  }
  if (Status added = AddMotion(amc->damaged, fit->skeleton, fit->bone_length, std::move(root_translation),
                               std::move(rotation), file.name, ingested);
      !added) {
    return Forward(added);
  }
  if (auto path = CheckRootPath(ingested.clip.motion->joints, PointsOfBody(*fit->skeleton))) {
    path->action = ContradictionAction(source);
    ingested.findings.push_back(*std::move(path));
  }
  ingested.clip.provenance["skeleton_file"] = file.skeleton_name;
  return ingested;
}

namespace fs = std::filesystem;

struct Beside {
  fs::path skeleton;   ///< empty: none whose name begins the motion's
  std::string others;  ///< names of the other .asf files there
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

/// The longest such name, in the motion's folder, then, where `above`, in the one above.
Beside SkeletonBeside(const fs::path& motion, bool above) {
  Beside beside;
  const std::string stem = LowerCase(DisplayPath(motion.stem()));
  const fs::path folder = motion.has_parent_path() ? motion.parent_path() : fs::path(".");
  for (const fs::path& place : above ? std::vector{folder, folder / ".."} : std::vector{folder}) {
    std::size_t longest = 0;
    for (const fs::path& path : EntriesOf(place)) {
      if (LowerCase(DisplayPath(path.extension())) != ".asf") continue;
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

/// Positions where the bones begin; the root first.
void AddPositions(const Asf& asf, const Amc& amc, RawClip& clip) {
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
  clip.SetMissing(amc.damaged);
  const std::ptrdiff_t numbers = static_cast<std::ptrdiff_t>(clip.joints) * 3;
  for (const int f : amc.damaged) {
    // The path of the root is looked at without confidences.
    const auto here = clip.positions.xyz.begin() + f * numbers;
    if (f > 0) std::copy_n(here - numbers, numbers, here);
  }
  FollowTree(parents, "hierarchy of the skeleton file", clip);
  if (const auto path = CheckRootPath(clip.positions, clip.points)) clip.remarks.push_back(*path);
}

/// Looks for the .asf whose name begins the file's: beside it, or one folder above where that is not above what is
/// inspected. Without one a remark reports it.
Expected<RawFile> AmcIn(const FileBytes& file) {
  RawClip clip;
  clip.format = "amc";
  clip.rate_evidence = "the file does not state it";
  const Beside beside = SkeletonBeside(file.path, file.name.find('/') != std::string::npos);
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
  } else if (const auto rate = RateOfName(file.path)) {
    clip.rate_hz = rate;
    clip.rate_evidence = "the name: HDM05's end with the rate";
  }
  const AcclaimFindings checked = CheckAcclaim(asf ? &*asf : nullptr, skeleton_name, *amc, file.name, std::nullopt);
  clip.AddRemarks(checked.findings);
  clip.rate_finding = checked.rate;
  if (asf && amc->frames > 0) {
    AddPositions(*asf, *amc, clip);
    if (InvalidatesPoses(checked.findings)) {
      clip.positions = JointPositions();
      clip.confidence.clear();
      clip.silence = kInvalidPoses;
    }
  } else {
    clip.silence = "without its skeleton file (.asf) a motion has no lengths";
    clip.skeleton.evidence = std::to_string(amc->bones.size()) + " moving bones; no skeleton file";
    clip.remarks.push_back(MakeFinding("skeleton_missing", Severity::kWarning, 0.0,
                                       "no .asf whose name begins this one's lies beside it" +
                                           (beside.others.empty() ? "" : " (" + beside.others + " have other names)") +
                                           ": lengths, unit and axes stay unknown; give the folder that holds both"));
  }
  return RawFile::Of(std::move(clip));
}

Expected<RawFile> AsfIn(const FileBytes& file) {
  const Expected<Asf> asf = ParseAsf(file.bytes, file.name);
  if (!asf) return Forward(asf);
  RawFile observed;
  observed.companions.push_back(
      {file.name,
       "asf",
       {{"angles", asf->degrees ? "degrees" : "radians"}},
       {{"bones", static_cast<double>(asf->bones.size())}, {"length_unit", asf->length_unit}}});
  observed.remarks = asf->findings;
  for (Finding& finding : CheckAsfSkeleton(*asf, file.name)) observed.remarks.push_back(std::move(finding));
  if (auto angles = CheckAngleUnits(*asf)) observed.remarks.push_back(*std::move(angles));
  return observed;
}

/// The skeleton's name below the root: beside the motion, else in the nearest folder above; nothing where it is higher.
std::optional<std::string> SkeletonBelow(const fs::path& root, const std::string& motion, const std::string& skeleton) {
  for (std::string folder = FolderOf(motion);; folder = FolderOf(folder)) {
    std::error_code unknown;
    if (fs::is_regular_file(root / folder / skeleton, unknown)) {
      return folder.empty() ? skeleton : folder + "/" + skeleton;
    }
    if (folder.empty()) return std::nullopt;
  }
}

/// ingest.source.skeleton_files, from where the skeletons lie below the folder: fields of the pattern if they give
/// each, else the one file that all share. Nothing where neither does.
std::optional<std::string> EstimateSkeletonFiles(const Proposal& proposal, const NamePatternEstimate& estimate) {
  const std::vector<std::string> skeletons = proposal.source.Facts("skeleton_file");
  std::vector<std::string> motions;
  std::set<std::string> places;
  bool beside = true, top = true;
  for (std::size_t i = 0; i < skeletons.size(); ++i) {
    const std::string& motion = proposal.source.clips()[i]->file;
    motions.push_back(motion);
    const auto place =
        skeletons[i].empty() ? std::optional<std::string>() : SkeletonBelow(proposal.folder, motion, skeletons[i]);
    if (!place) continue;
    places.insert(*place);
    beside = beside && FolderOf(*place) == FolderOf(motion);
    top = top && FolderOf(*place).empty();
  }
  if (places.empty()) return std::nullopt;
  std::optional<std::string> by_fields = EstimateCompanionPattern(estimate, motions, skeletons);
  if (by_fields && top) return by_fields;
  if (by_fields && beside) return FolderOf(estimate.pattern) + "/" + *by_fields;
  if (places.size() == 1) return *places.begin();
  return std::nullopt;
}

/// The field that names the skeleton file is the person.
void ProposeAcclaim(const Proposal& proposal, DeclarationWriter& writer) {
  const NamePatternEstimate estimate = WriteFiles(proposal, writer);
  const std::optional<std::string> skeletons = EstimateSkeletonFiles(proposal, estimate);
  const std::vector<std::string> fields = FieldsOf(skeletons.value_or(""));
  if (skeletons)
    writer.Value("skeleton_files", YamlQuoted(*skeletons), "found beside the motions");
  else
    writer.Unknown("skeleton_files", "no .asf beside the motions begins like the name of a motion");
  if (fields.size() != 1) return WritePersonAndLabel(false, writer);
  writer.Value("person", YamlQuoted("{" + fields.front() + "}"), "whose skeleton file it is");
  writer.Name("label", "", "fields of `files` that name the action, or \"\" for none");
}

}  // namespace

FormatDriver AsfAmcFormat() {
  FormatDriver d;
  d.name = "asf_amc";
  d.inspected = "amc";
  d.kinds = {FileKind::kAsf, FileKind::kAmc};
  d.ending = ".amc";
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.check = CheckSkeletonFiles;
  d.options = {"skeleton_files"};
  d.open = [](const FileBytes& file) { return KindOf(file.bytes) == FileKind::kAsf ? AsfIn(file) : AmcIn(file); };
  d.propose = ProposeAcclaim;
  d.to_clip = ReadAsfAmcClip;
  return d;
}

}  // namespace mocurate
