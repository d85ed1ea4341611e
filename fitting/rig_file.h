#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/geometry/camera.h"
#include "core/pipeline/stage.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {

/// What the audit decided about a camera.
enum class RigVerdict {
  kKept,        ///< as calibrated
  kCorrected,   ///< this camera differs from its calibration or its files, and is corrected
  kAmbiguous,   ///< this camera or another one does: which is ambiguous; the views agree with the poses of the file
  kReported,    ///< it differs, but the options only report that; as calibrated
  kNotAudited,  ///< as calibrated, because the takes do not allow an audit
};
/// "kept", "corrected", "ambiguous", "reported", "not_audited".
std::string Name(RigVerdict verdict);

/// A camera of an audited rig, and how its keypoints are read.
struct RigCamera {
  Camera camera;                 ///< pose and intrinsics as corrected
  std::string files_of;          ///< camera whose files have its keypoints; its own name unless files are exchanged
  bool mirrored = false;         ///< x counts from the right of the image, after pixel_scale
  bool sides_exchanged = false;  ///< left and right are exchanged
  double pixel_scale = 1.0;      ///< factor on the pixels of the keypoints
  double unit_scale = 1.0;       ///< by which the calibration's lengths were divided; the pose is in metres
  double clock_s = 0.0;          ///< a stamp t is the time t + clock
  double moved_m = 0.0;          ///< distance from the calibrated centre
  double rotated_rad = 0.0;      ///< angle from the calibrated orientation
  RigVerdict verdict = RigVerdict::kKept;
  std::optional<double> confidence;  ///< of a correction, [0, 1]; none: nothing of it was
  ConfidenceOf confidence_of = ConfidenceOf::kSpansOfOneTake;
  std::string place;  ///< "rig.yaml:12:5", for messages

  void Declare(OptionVisitor& v);
};

/// A take that a rig was audited with.
struct AuditedTake {
  std::string name;                             ///< clip id
  std::string sha256;                           ///< of its evidence
  std::map<std::string, std::string> verdicts;  ///< camera -> Name(RigVerdict), of the take alone
  std::string not_audited;                      ///< why it has no verdicts of its own; empty: it has

  void Declare(OptionVisitor& v);
};

/// A rig of keypoint cameras as audited with all takes of a configuration: a YAML file that other takes use
/// (`fitting.keypoints.rig`).
struct RigFile {
  static constexpr std::int64_t kVersion = 1;  ///< version of the format (numerical)

  std::int64_t version = kVersion;
  std::string config;                        ///< name of the configuration
  std::map<std::string, std::string> audit;  ///< test -> "off", "report", "correct" (fitting.keypoints.audit)
  std::vector<AuditedTake> takes;
  /// Uncertainty of people's positions where the moved camera is ambiguous: the shift that the chosen poses cause, m^2
  /// per axis and between axes. Symmetric.
  Matrix3d place_covariance = Matrix3d::Zero();
  std::vector<RigCamera> cameras;

  void Declare(OptionVisitor& v);
};

/// The file as YAML, with a comment about its fields. The same rig gives the same bytes, and is read back exactly.
std::string RigText(const RigFile& rig);

/// Errors with file, line, value and rule: kNotFound; kMalformed for all that is not such a file, among it another
/// version, fields that are missing or out of range, cameras that occur twice.
Expected<RigFile> ReadRigFile(const std::filesystem::path& path);

/// Role of a rig's file as input of a stage.
inline constexpr const char* kRigRole = "rig";
/// The input of this role; null: none.
const StageInput* RigInput(const StageRequest& request);
/// Provenance entry of a clip that uses an audited rig: SHA-256 of the file.
inline constexpr const char* kRigFile = "rig_file";

}  // namespace mocurate
