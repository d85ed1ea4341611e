#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/options.h"
#include "ingest/sense/joint_orders.h"

namespace mocurate {

/// What a file format is, by its content.
enum class FileKind { kUnknown, kEmpty, kBvh, kNpy, kJson, kNumbers };

/// Looks at the first bytes only.
FileKind KindOf(std::string_view bytes);
/// "bvh", "npy", "joint_table", "depth_sequence", "unknown".
std::string_view FormatName(FileKind kind);

/// Something doubtful about a file or clip; `where` and the file are filled in by the caller.
struct Remark {
  std::string code;
  Severity severity = Severity::kWarning;
  double value = 0.0;
  std::string message;
};

/// One clip as it stands in a file: file units, file axes.
struct ObservedClip {
  std::string id;  ///< below the file: empty, or "[3]" of a batch
  std::string format;
  int frames = 0;
  int joints = 0;
  int people = 1;
  JointPositions positions;        ///< empty for a depth sequence
  std::vector<double> confidence;  ///< (frames*joints); 0: missing
  std::vector<std::string> names;  ///< (joints), or empty: unknown
  HandednessPoints points;
  std::optional<double> rate_hz;  ///< where the file says it

  std::string skeleton;  ///< known order or tree; empty: unknown
  std::string skeleton_from = "unknown";
  double skeleton_confidence = 0.0;
  std::string skeleton_evidence;
  std::string layout_evidence;  ///< how frames and joints were told
  std::string units;            ///< where the format says it
  std::string up;
  std::string handedness;
  std::vector<Remark> remarks;
};

/// Everything a file holds. A source of the same format says the layout; without one it is measured. Errors of the
/// formats; kUnsupported for an array or table that is no motion.
Expected<std::vector<ObservedClip>> ObserveFile(std::string_view bytes, const std::string& name,
                                                const std::optional<SourceOptions>& source);

Expected<std::vector<ObservedClip>> ObserveBvh(std::string_view bytes, const std::string& name);
Expected<std::vector<ObservedClip>> ObserveNpy(std::string_view bytes, const std::string& name,
                                               const std::optional<SourceOptions>& source);
Expected<std::vector<ObservedClip>> ObserveTable(std::string_view bytes, const std::string& name,
                                                 const std::optional<SourceOptions>& source);

/// Names the points by the best known order and says how sure that is and what else fits; false if none fits.
bool RecogniseOrder(ObservedClip& clip);
/// Remarks when no two points of a clip without names keep their distance.
void DoubtPositions(ObservedClip& clip);
/// Names the points as declared, and compares with known orders.
void DeclareOrder(const SourceOptions& source, ObservedClip& clip);

}  // namespace mocurate
