#include "fitting/rig_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kUnitQuaternion = 1e-6;  ///< of 1; largest departure of a quaternion's norm (numerical)
constexpr const char* kAuditAgain = "write it with `mocurate rig audit CONFIG -o rig.yaml`";

constexpr const char* kNeededOfCamera[] = {"name", "files_of", "clock_s", "width",    "height",     "fx",
                                           "fy",   "cx",       "cy",      "rotation", "translation"};

constexpr std::pair<const char*, RigVerdict> kRigVerdicts[] = {{"kept", RigVerdict::kKept},
                                                               {"corrected", RigVerdict::kCorrected},
                                                               {"ambiguous", RigVerdict::kAmbiguous},
                                                               {"reported", RigVerdict::kReported},
                                                               {"not_audited", RigVerdict::kNotAudited}};

constexpr const char* kRigComment =
    "# A rig of keypoint cameras, audited by mocurate. Other takes use it: fitting.keypoints.rig: THIS_FILE\n"
    "#\n"
    "# A camera maps a point X of the world (metres, y up) to x = R X + t in its own axes (x right, y down, z "
    "forward):\n"
    "# rotation is R as a unit quaternion, translation is t in metres. width, height, fx, fy, cx, cy are pixels,\n"
    "# k1 k2 p1 p2 k3 is OpenCV's lens distortion.\n"
    "# files_of: camera whose files have this camera's keypoints. pixel_scale: their pixels are multiplied by\n"
    "# it. mirrored: the x of the result counts from the right. sides_exchanged: left and right are exchanged.\n"
    "# unit_scale: the calibration's lengths were divided by it (the pose here is in metres).\n"
    "# clock_s: seconds that are added to their time stamps. moved_m, rotated_rad: from the calibrated pose.\n"
    "# verdict: kept, corrected, ambiguous (this camera or another one differs from its calibration), reported (it\n"
    "# differs, and the options only report that), or not_audited (the takes do not allow an audit).\n"
    "# confidence: of the correction, 0 to 1; null: nothing of it was. confidence_of: takes (from the variation\n"
    "# between takes), spans_of_one_take (of errors that last for the whole take it knows nothing), or model (a\n"
    "# likelihood, as of a person's size). audit: the tests, and whether they correct.\n"
    "# place_covariance: uncertainty of people's positions from ambiguous poses, square metres.\n"
    "# takes: what was audited together, with the SHA-256 of the evidence and the verdicts of each take alone.\n";

/// A 3-vector or quaternion as a group of named numbers.
template <std::size_t N>
void DeclareNumbers(OptionVisitor& v, const char* group, const char* const (&names)[N], double* const (&values)[N],
                    const char* help) {
  v.BeginGroup(group, help);
  for (std::size_t i = 0; i < N; ++i) v.Number(names[i], *values[i], Unit::kNone, {}, "");
  v.EndGroup();
}

struct RigProblem {
  std::string place, what;
};

/// All that is wrong with the cameras. `nodes`: where they are in the file of this name.
std::vector<RigProblem> WrongCameras(const RigFile& rig, const std::vector<ConfigNode>& nodes,
                                     const std::string& file) {
  std::vector<RigProblem> problems;
  std::set<std::string> names, files;
  for (const RigCamera& one : rig.cameras) names.insert(one.camera.name);
  std::set<std::string> seen;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const RigCamera& one = rig.cameras[i];
    const Camera& camera = one.camera;
    const auto wrong = [&](const char* field, const std::string& what) {
      const ConfigNode* node = nodes[i].Find(field);
      const Origin& at = node == nullptr ? nodes[i].origin : node->key_origin;
      problems.push_back({Origin{file, at.line, at.column}.Text(), what});
    };
    if (camera.name.empty()) wrong("name", "the camera has no name");
    if (!seen.insert(camera.name).second) wrong("name", "camera '" + camera.name + "' occurs twice");
    if (names.count(one.files_of) == 0) {
      wrong("files_of", "files_of is '" + one.files_of + "', which is no camera of the rig");
    } else if (!files.insert(one.files_of).second) {
      wrong("files_of", "the files of camera '" + one.files_of + "' are given to two cameras");
    }
    if (!(camera.fx > 0.0) || !(camera.fy > 0.0)) {
      wrong("fx", "focal length " + RoundedText(camera.fx) + ", " + RoundedText(camera.fy) + " px is not positive");
    }
    const double norm = camera.camera_from_world.rotation.norm();
    if (!(std::abs(norm - 1.0) <= kUnitQuaternion)) {
      wrong("rotation", "the rotation is no unit quaternion: its norm is " + RoundedText(norm, 6));
    }
    if (one.mirrored && camera.width == 0) wrong("width", "a mirrored image needs a width");
  }
  return problems;
}

}  // namespace

std::string Name(RigVerdict verdict) {
  return std::find_if(std::begin(kRigVerdicts), std::end(kRigVerdicts),
                      [&](const auto& one) { return one.second == verdict; })
      ->first;
}

void RigCamera::Declare(OptionVisitor& v) {
  v.Text("name", camera.name, "name of the camera, as the source gives it");
  v.Choice("verdict", verdict, {std::begin(kRigVerdicts), std::end(kRigVerdicts)}, "what the audit decided");
  v.OptionalNumber("confidence", confidence, Unit::kNone, {0.0, 1.0}, "of the correction; null: none");
  v.Choice("confidence_of", confidence_of,
           {{"takes", ConfidenceOf::kTakes},
            {"spans_of_one_take", ConfidenceOf::kSpansOfOneTake},
            {"model", ConfidenceOf::kModel}},
           "samples whose variation gives the confidence, or model: a likelihood");
  v.Number("moved_m", moved_m, Unit::kNone, {0.0, {}}, "distance from the calibrated centre, metres");
  v.Number("rotated_rad", rotated_rad, Unit::kNone, {0.0, 4.0}, "angle from the calibrated orientation, radians");
  v.Number("clock_s", clock_s, Unit::kNone, {-1e3, 1e3}, "added to the time stamps, seconds");
  v.Text("files_of", files_of, "camera whose files have its keypoints");
  v.Bool("mirrored", mirrored, "x counts from the right");
  v.Bool("sides_exchanged", sides_exchanged, "left and right are exchanged");
  v.Number("pixel_scale", pixel_scale, Unit::kNone, {1e-3, 1e3}, "factor on the pixels of the keypoints");
  v.Number("unit_scale", unit_scale, Unit::kNone, {1e-9, 1e9}, "by which the calibration's lengths were divided");
  std::int64_t width = camera.width, height = camera.height;
  v.Integer("width", width, {0.0, 1e6}, "of the image, pixels; 0: unknown");
  v.Integer("height", height, {0.0, 1e6}, "of the image, pixels; 0: unknown");
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  const std::pair<const char*, double*> numbers[] = {{"fx", &camera.fx},
                                                     {"fy", &camera.fy},
                                                     {"cx", &camera.cx},
                                                     {"cy", &camera.cy},
                                                     {"k1", &camera.distortion.k1},
                                                     {"k2", &camera.distortion.k2},
                                                     {"p1", &camera.distortion.p1},
                                                     {"p2", &camera.distortion.p2},
                                                     {"k3", &camera.distortion.k3}};
  for (const auto& [name, value] : numbers) v.Number(name, *value, Unit::kNone, {}, "intrinsics, OpenCV's model");
  Quaterniond& r = camera.camera_from_world.rotation;
  Vector3d& t = camera.camera_from_world.translation;
  DeclareNumbers(v, "rotation", {"w", "x", "y", "z"}, {&r.w(), &r.x(), &r.y(), &r.z()},
                 "camera from world, unit quaternion");
  DeclareNumbers(v, "translation", {"x", "y", "z"}, {&t.x(), &t.y(), &t.z()}, "camera from world, metres");
}

void AuditedTake::Declare(OptionVisitor& v) {
  v.Text("name", name, "clip");
  v.Text("sha256", sha256, "of its evidence");
  v.TextMap("verdicts", verdicts, "camera -> verdict of this take alone");
  v.Text("not_audited", not_audited, "why the take has no verdicts of its own");
}

void RigFile::Declare(OptionVisitor& v) {
  v.Integer("version", version, {1.0, {}}, "of this layout");
  v.Text("config", config, "name of the configuration that was audited");
  v.TextMap("audit", audit, "test -> off, report, correct");
  v.List("takes", takes, "takes that were audited together");
  Matrix3d& c = place_covariance;
  DeclareNumbers(v, "place_covariance", {"xx", "xy", "xz", "yy", "yz", "zz"},
                 {&c(0, 0), &c(0, 1), &c(0, 2), &c(1, 1), &c(1, 2), &c(2, 2)},
                 "of people's positions, because of ambiguous poses; m^2");
  c(1, 0) = c(0, 1), c(2, 0) = c(0, 2), c(2, 1) = c(1, 2);
  v.List("cameras", cameras, "all cameras of the rig");
}

std::string RigText(const RigFile& rig) { return kRigComment + ShowOptions(rig, ConfigNode(), false); }

const StageInput* RigInput(const StageRequest& request) {
  const auto found = std::find_if(request.inputs.begin(), request.inputs.end(),
                                  [](const StageInput& input) { return input.role == kRigRole; });
  return found == request.inputs.end() ? nullptr : &*found;
}

Expected<RigFile> ReadRigFile(const std::filesystem::path& path) {
  const std::string file = DisplayPath(path);
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    const bool exists = std::filesystem::exists(path, unknown);
    return Fail(
        ErrorCode::kNotFound,
        exists ? "is a folder or device, not the file of an audited rig" : "there is no such file of an audited rig",
        file, kAuditAgain);
  }
  const auto malformed = [](Error error) {
    if (error.code == ErrorCode::kConfig) error.code = ErrorCode::kMalformed;
    if (error.hint.empty() && error.code == ErrorCode::kMalformed) error.hint = kAuditAgain;
    return tl::unexpected<Error>(error);
  };
  const auto node = LoadData(path);
  if (!node) return malformed(node.error());
  const ConfigNode* version = node->Find("version");
  const std::string expected = std::to_string(RigFile::kVersion);
  if (version == nullptr || version->scalar != expected) {
    const std::string where = version == nullptr ? file : version->origin.Text();
    return Fail(ErrorCode::kMalformed,
                version == nullptr
                    ? "the file is not an audited rig: it has no version"
                    : "version '" + version->scalar + "' of an audited rig; this program reads " + expected,
                where, kAuditAgain);
  }
  auto rig = OptionsFromConfig<RigFile>(*node);
  if (!rig) return malformed(rig.error());
  const ConfigNode* cameras = node->Find("cameras");
  std::vector<RigProblem> problems;
  for (std::size_t i = 0; i < rig->cameras.size(); ++i) {
    const ConfigNode& camera = cameras->sequence[i];
    const std::string name = DisplayPath(path.filename());
    rig->cameras[i].place = Origin{name, camera.origin.line, camera.origin.column}.Text();
    for (const char* field : kNeededOfCamera) {
      if (camera.Find(field) == nullptr)
        problems.push_back({rig->cameras[i].place, std::string(field) + " is missing"});
    }
  }
  if (rig->cameras.size() < 2) {
    return Fail(
        ErrorCode::kMalformed,
        "the rig has " + Counted(static_cast<long long>(rig->cameras.size()), "camera") + ", at least 2 are needed",
        file, kAuditAgain);
  }
  if (problems.empty()) problems = WrongCameras(*rig, cameras->sequence, DisplayPath(path.filename()));
  if ((rig->place_covariance.diagonal().array() < 0.0).any()) {
    problems.push_back({file, "place_covariance has a negative variance"});
  }
  if (problems.empty()) return rig;
  std::string text = problems[0].what;
  for (std::size_t i = 1; i < problems.size(); ++i) text += "\n" + problems[i].place + ": " + problems[i].what;
  return Fail(ErrorCode::kMalformed, text, problems[0].place, kAuditAgain);
}

}  // namespace mocurate
