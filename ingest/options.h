#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/formats/damaged_rows.h"
#include "core/pipeline/stage.h"

namespace mocurate {

struct JointLayout;

enum class SourceFormat { kNone, kJointTable, kBvh, kNpy, kDepthSequence, kNtuSkeleton, kAsfAmc, kAmass };
/// What to do with files of the folder that the pattern does not match.
enum class OtherFiles { kIgnore, kFinding, kError };
/// How a joint table says that a joint was not seen.
enum class MissingValue { kNone, kZero, kNan };
/// What a contradiction between declaration and motion does to a clip.
enum class OnContradiction { kFlag, kRefuse };

/// Declares one source of captures: everything its files do not say themselves. Texts with {fields} take the parts of
/// the file name, {file} is the path without its ending with '/' as '.', {body} is empty or, where a file holds several
/// people, a, b, ... of each.
struct SourceOptions {
  std::string name;
  SourceFormat format = SourceFormat::kNone;
  std::string files;  ///< pattern of the path below the folder: "a{action}_s{person}.txt", "{id:4}.npy" (exact width)
  OtherFiles other_files = OtherFiles::kFinding;
  std::string licence;

  std::string units;  ///< "m", "cm", "mm", "inch", or a length such as "0.0564 m"
  std::string axes;   ///< AxisConvention
  std::optional<double> rate_hz;
  std::string skeleton;
  std::vector<std::string> joints;                  ///< names in the order of the file
  std::int64_t rows_per_frame = 0;                  ///< joint_table; see RowsPerFrame
  std::vector<std::string> columns{"x", "y", "z"};  ///< joint_table, per joint: x y z confidence skip
  std::string layout;    ///< joint_table, instead of `columns`: all numbers of a frame, as ParseJointLayout reads them
  std::string end_word;  ///< joint_table: line that closes the table, where there is one
  std::map<std::string, std::string> bodies;  ///< ntu_skeleton: label text -> people in the file, "2"; others have one
  double inferred_confidence = 0.3;           ///< ntu_skeleton: of a joint that the sensor inferred; tracked is 1
  std::string skeleton_files;                 ///< asf_amc: "{subject}.asf", filled from the fields of the motion's name
  std::vector<std::string> annotations;       ///< amass: BABEL files below the folder
  double least_confidence = 0.0;              ///< joint_table: of a joint that has a position
  DamagedRows damaged_rows = DamagedRows::kRefuse;
  MissingValue missing = MissingValue::kNone;
  double max_slide = 0.002;   ///< bvh: metres a bone may change its length before the clip is refused
  std::string depth_files;    ///< depth_sequence: "depth/{view}_{frame}.png"
  double depth_unit = 0.001;  ///< depth_sequence: metres per step of a depth value

  std::string person = "{person}";
  std::string recording = "{file}";  ///< {file}: the path without its ending, '/' as '.'
  std::string label = "{action}";
  std::string session;
  std::string view;
  std::string style;
  std::map<std::string, std::string> labels;   ///< label text -> name; other texts are refused
  std::map<std::string, std::string> roles;    ///< person -> role
  std::map<std::string, std::string> exclude;  ///< recording -> why its file is left out
  OnContradiction on_contradiction = OnContradiction::kFlag;

  void Declare(OptionVisitor& v);
};

/// The studio's capture: what is performed, and how bad the tracker is.
struct SyntheticOptions {
  bool enabled = false;
  std::int64_t seed = 1;
  std::vector<std::string> actions{"wave", "punch", "kick", "squat", "walk", "jump"};
  std::int64_t subjects = 4;
  std::int64_t repetitions = 6;
  double duration_s = 3.0;
  double rate_hz = 30.0;
  double noise = 0.030;         ///< metres, root mean square in 3D
  double dropout_share = 0.05;  ///< joints not seen
  double outlier_share = 0.02;  ///< joints grossly wrong

  void Declare(OptionVisitor& v);
};

struct IngestOptions {
  std::filesystem::path path;  ///< folder of the source; empty with synthetic.enabled: the capture's folder
  SourceOptions source;
  SyntheticOptions synthetic;

  void Declare(OptionVisitor& v);
};

/// "joint_table", as a configuration says it.
std::string FormatName(SourceFormat format);

/// Rules that go beyond single values: what the format needs and does not say itself. Error kConfig naming the option.
Status CheckSource(const SourceOptions& source);

/// The numbers of a frame of a joint table: `layout`, or `columns` for each of the joints. Error kConfig.
Expected<JointLayout> TableLayout(const SourceOptions& source);

/// Rows of one frame of a joint table: as declared, else one with `layout` and one per joint with `columns`.
int RowsPerFrame(const SourceOptions& source);

/// People in a file whose label text, before renaming, is `label`; 1 where `bodies` says nothing.
int BodiesOf(const SourceOptions& source, const std::string& label);

/// Metres per unit of `units`. Error kConfig.
Expected<double> MetresPerUnit(const std::string& units);

StageDeclaration IngestDeclaration();
StageDeclaration TruthDeclaration();
StageDeclaration CaptureDeclaration();

}  // namespace mocurate
