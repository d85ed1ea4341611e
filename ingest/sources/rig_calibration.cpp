#include "ingest/sources/rig_calibration.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/camera_files.h"
#include "ingest/inspect/calibration_estimate.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostCamerasNamed = 5;

/// "cam01, cam02, ... (7 in all)".
std::string ListedCameras(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMostCamerasNamed; ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() <= kMostCamerasNamed ? text : text + ", ... (" + std::to_string(names.size()) + " in all)";
}

bool IsOpenCv(const std::string& bytes) {
  return bytes.rfind("%YAML", 0) == 0 || bytes.find("<opencv_storage>") != std::string::npos;
}

/// One file per camera: named by the {camera} of its name.
Expected<Calibration> ReadCameraFiles(const std::vector<std::pair<std::string, std::string>>& files,
                                      const NamePattern& pattern) {
  Calibration all;
  for (const auto& [name, bytes] : files) {
    Expected<Calibration> one = ParseOpenCvCalibration({{name, bytes}});
    if (!one) return Forward(one);
    const std::optional<NameFields> fields = pattern.Match(name);
    if (!fields || one->views.size() != 1) {
      return Fail(ErrorCode::kInconsistent, "one camera is expected, not " + std::to_string(one->views.size()), name);
    }
    one->views[0].name = fields->at("camera");
    all.dialect = one->dialect;
    all.views.push_back(std::move(one->views[0]));
  }
  return all;
}

Expected<Calibration> ReadFiles(const SourceFile& file, std::string& content) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const StageInput& input : file.calibrations) {
    Expected<std::string> bytes = ReadFile(input.path);
    if (!bytes) return Forward(bytes);
    content += *bytes;
    files.emplace_back(input.name, std::move(*bytes));
  }
  if (files.empty()) {
    return Fail(ErrorCode::kNotFound, "the clip has no calibration", file.name, "correct ingest.source.calibration");
  }
  const std::vector<std::string>& declared = file.source.calibration;
  const std::vector<std::string> fields = FieldsOf(declared[0]);
  if (std::find(fields.begin(), fields.end(), "camera") != fields.end()) {
    const Expected<NamePattern> pattern = NamePattern::Parse(declared[0], "ingest.source.calibration");
    if (!pattern) return Forward(pattern);
    return ReadCameraFiles(files, *pattern);
  }
  if (IsOpenCv(files[0].second)) return ParseOpenCvCalibration(files);
  if (files.size() > 1) {
    return Fail(ErrorCode::kConfig, std::to_string(files.size()) + " files calibrate the cameras", files[1].first,
                "only OpenCV's intri and extri are two files; correct ingest.source.calibration");
  }
  return ParseCalibration(files[0].second, files[0].first);
}

/// The declaration fills in what the format does not state; where both do and differ, that is a contradiction.
Status Declare(const SourceOptions& source, Calibration& calibration, std::vector<Finding>& findings) {
  const std::map<CameraPose, PoseConvention> readings = {{CameraPose::kMeasured, PoseConvention::kUnknown},
                                                         {CameraPose::kWorldToCamera, PoseConvention::kWorldToCamera},
                                                         {CameraPose::kCentre, PoseConvention::kCentre},
                                                         {CameraPose::kCameraToWorld, PoseConvention::kCameraToWorld}};
  const PoseConvention pose = readings.at(source.camera_pose);
  const auto contradict = [&](const std::string& message) {
    findings.push_back(Contradiction(source, "calibration_contradiction", 0.0, message));
  };
  if (pose != PoseConvention::kUnknown) {
    if (calibration.reading != PoseConvention::kUnknown && calibration.reading != pose) {
      contradict("a file of the format " + calibration.dialect + " states " + std::string(Name(calibration.reading)) +
                 ", the source declares " + std::string(Name(pose)));
    }
    calibration.reading = pose;
  }
  if (source.units.empty()) return {};
  const Expected<double> metres = MetresPerUnit(source.units);
  if (!metres) return Forward(metres);
  if (calibration.metres_per_unit > 0.0 && std::abs(calibration.metres_per_unit / *metres - 1.0) > 1e-9) {
    contradict("a file of the format " + calibration.dialect + " has a unit of " +
               FormatDouble(calibration.metres_per_unit) + " m, the source declares " + source.units);
  }
  calibration.metres_per_unit = *metres;
  return {};
}

std::string DeclaredMeasure(const char* what, const Measured& measured, bool given) {
  return std::string(what) + " " + measured.value +
         (given ? "" : " (measured: " + measured.evidence + "; " + RoundedText(measured.confidence, 3) + ")");
}

/// "+z" as a direction of the source.
Vector3d Direction(const std::string& axis) {
  Vector3d direction = Vector3d::Zero();
  direction[axis.back() - 'x'] = axis[0] == '-' ? -1.0 : 1.0;
  return direction;
}

/// The images' top compared with the declared axes.
void CheckUp(const SourceOptions& source, const Quaterniond& axes, const Measured& up, std::vector<Finding>& findings) {
  if (up.value.empty()) return;
  const double rises = (axes * Direction(up.value)).y();
  if (rises > 0.5) return;
  findings.push_back(Contradiction(source, "up_contradiction", up.confidence,
                                   "with axes '" + source.axes +
                                       "' the cameras lie on their sides or heads: the top of their images points to " +
                                       up.value + ", " + RoundedText(100.0 * up.confidence, 3) + " % confidence (" +
                                       up.evidence + "); correct ingest.source.axes"));
}

}  // namespace

const Camera* Rig::Find(const SourceOptions& source, const std::string& camera) const {
  const auto declared = source.cameras.find(camera);
  const std::string wanted = declared == source.cameras.end() ? camera : declared->second;
  for (const Camera& own : cameras) {
    if (own.name == wanted) return &own;
  }
  const Camera* alike = nullptr;
  for (const Camera& own : cameras) {
    if (declared != source.cameras.end() || LettersAndDigits(own.name) != LettersAndDigits(wanted)) continue;
    if (alike != nullptr) return nullptr;
    alike = &own;
  }
  return alike;
}

Expected<Rig> ReadRig(const SourceFile& file) {
  const Expected<Quaterniond> axes = RotationOfAxes(file.source.axes);
  if (!axes) return Forward(axes);
  Rig rig;
  Expected<Calibration> calibration = ReadFiles(file, rig.content);
  if (!calibration) return Forward(calibration);
  if (Status declared = Declare(file.source, *calibration, rig.findings); !declared) return Forward(declared);
  const CalibrationEstimate estimate = EstimateCalibration(*calibration);
  const bool pose_given = calibration->reading != PoseConvention::kUnknown;
  if (estimate.reading.value.empty() || estimate.unit.value.empty()) {
    const bool pose = estimate.reading.value.empty();
    return Fail(ErrorCode::kInconsistent,
                std::string(pose ? "what R and t of the cameras mean" : "the unit of length of the cameras") +
                    " is ambiguous: " + (pose ? estimate.reading.evidence : estimate.unit.evidence),
                file.calibrations[0].name,
                pose ? "write ingest.source.camera_pose: world_to_camera, centre or camera_to_world"
                     : "write ingest.source.units: m, cm or mm");
  }
  rig.meaning = DeclaredMeasure("pose", estimate.reading, pose_given) + ", " +
                DeclaredMeasure("unit", estimate.unit, calibration->metres_per_unit > 0.0);
  for (const Finding& remark : estimate.remarks) {
    rig.findings.push_back(Contradiction(file.source, remark.code, remark.value, remark.message));
  }
  CheckUp(file.source, *axes, estimate.up, rig.findings);
  const RigidTransform world_from_source{*axes, Vector3d::Zero()};
  rig.cameras = estimate.cameras;
  for (Camera& camera : rig.cameras) {
    camera.camera_from_world = camera.camera_from_world * Inverse(world_from_source);
    camera.camera_from_world.rotation.normalize();
  }
  return rig;
}

Expected<std::map<std::string, FilesOfCamera>> SortByCamera(const std::string& text, const char* option,
                                                            const std::vector<StageInput>& files) {
  const Expected<NamePattern> pattern = NamePattern::Parse(text, option);
  if (!pattern) return Forward(pattern);
  std::map<std::string, FilesOfCamera> cameras;
  for (const StageInput& input : files) {
    const std::optional<NameFields> fields = pattern->Match(input.name);
    if (!fields) continue;
    const auto camera = fields->find("camera");
    const auto frame = fields->find("frame");
    const std::optional<long long> number = frame == fields->end() ? 0 : ParseInteger(frame->second);
    if (!number || *number < 0) {
      return Fail(ErrorCode::kInconsistent, "'" + frame->second + "' is not a frame number", input.name,
                  std::string("correct ") + option);
    }
    const auto [other, fresh] = cameras[camera == fields->end() ? "" : camera->second].emplace(*number, &input);
    if (!fresh) {
      return Fail(ErrorCode::kInconsistent, "the same frame as " + other->second->name, input.name,
                  "keep one file per camera and frame");
    }
  }
  return cameras;
}

Expected<FrameSpan> SpanOf(const std::map<std::string, FilesOfCamera>& cameras, const std::string& name) {
  constexpr long long kMostGaps = 20;  // frame numbers per file
  std::optional<long long> first, last;
  std::size_t most = 0;
  for (const auto& [camera, files] : cameras) {
    if (files.empty()) continue;
    first = std::min(first.value_or(files.begin()->first), files.begin()->first);
    last = std::max(last.value_or(files.rbegin()->first), files.rbegin()->first);
    most = std::max(most, files.size());
  }
  if (!first) return Fail(ErrorCode::kNotFound, "the clip has no files that can be read", name);
  if (*last - *first >= kMostGaps * static_cast<long long>(most) + 1000) {
    return Fail(ErrorCode::kInconsistent,
                "frames are numbered from " + std::to_string(*first) + " to " + std::to_string(*last) +
                    ", but a camera has at most " + std::to_string(most),
                name, "check for a file of another recording, or correct ingest.source.files");
  }
  return FrameSpan{*first, static_cast<int>(*last - *first + 1)};
}

Expected<Partners> PartnersOf(const SourceFile& file, const Rig& rig,
                              const std::map<std::string, FilesOfCamera>& cameras, std::vector<Finding>& findings,
                              const std::map<std::string, FilesOfCamera>& others) {
  Partners partners;
  std::vector<std::string> uncalibrated, unused;
  std::set<const Camera*> used;
  for (const auto& [name, files] : cameras) {
    const Camera* camera = rig.Find(file.source, name);
    if (camera == nullptr)
      uncalibrated.push_back(name);
    else
      partners.emplace_back(name, camera);
    used.insert(camera);
  }
  for (const auto& other : others) used.insert(rig.Find(file.source, other.first));
  for (const Camera& camera : rig.cameras) {
    if (used.count(&camera) == 0) unused.push_back(camera.name);
  }
  if (!uncalibrated.empty()) {
    findings.push_back(CameraFinding("camera_not_calibrated", static_cast<double>(uncalibrated.size()),
                                     "no calibration has the name of the files of " + ListedCameras(uncalibrated) +
                                         "; assign one with ingest.source.cameras",
                                     FindingAction::kExcluded));
  }
  if (!unused.empty()) {
    findings.push_back(CameraFinding("camera_without_files", static_cast<double>(unused.size()),
                                     "there are no files of the calibrated " + ListedCameras(unused),
                                     FindingAction::kExcluded));
  }
  if (partners.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "no camera of the files is calibrated: those of the files are " + ListedCameras(uncalibrated) +
                    ", calibrated are " + ListedCameras(unused),
                file.calibrations[0].name, "write ingest.source.cameras: {name in the files: name in the calibration}");
  }
  return partners;
}

void KeepPartners(const Partners& partners, std::map<std::string, FilesOfCamera>& cameras) {
  std::map<std::string, FilesOfCamera> kept;
  for (const auto& [camera, calibrated] : partners) {
    if (const auto files = cameras.find(camera); files != cameras.end()) kept.insert(std::move(*files));
  }
  cameras = std::move(kept);
}

Finding CameraFinding(const std::string& code, double value, const std::string& message, FindingAction action) {
  return MakeFinding(code, Severity::kWarning, value, message, action);
}

}  // namespace mocurate
