#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/skeleton.h"
#include "core/quality/handedness.h"
#include "ingest/checks/root_scale.h"
#include "ingest/inspect/inspection.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/options.h"

namespace mocurate {

/// One clip as it stands in a file: file units, file axes.
struct RawClip {
  std::string id;  ///< below the file: empty, or "[3]" of a batch
  std::string format;
  int frames = 0;
  int joints = 0;
  bool joints_measured = false;  ///< nothing in the file says how many
  int people = 1;                ///< most in one frame
  int fewest_people = 1;         ///< in one frame
  std::string people_evidence = "files of this format hold one person";
  JointPositions positions;        ///< empty where the file holds none, or only with what it does not hold
  std::vector<double> confidence;  ///< (frames*joints); 0: missing
  /// (frames*joints), or empty: 1 where the file has 0 0 0 and no declaration calls that missing; confidence is 0
  /// there, so that nothing is measured of it.
  std::vector<char> zeros;
  std::vector<std::string> names;  ///< (joints), or empty: unknown
  std::vector<int> parents;        ///< (joints) where the file holds a tree; -1 for the root
  BodyLandmarks points;
  std::optional<double> rate_hz;        ///< where the file says it
  std::optional<Finding> rate_finding;  ///< why that is none, where no source declares one
  std::string rate_evidence;            ///< where it says it, or what is known besides the file
  bool rate_measured = false;           ///< by a column that only its values show to be a clock
  double set_rate_hz = 0.0;             ///< where only the set that the file is of tells it
  std::string set_evidence;
  std::optional<double> missing_share;  ///< where positions do not show it
  std::string missing_evidence;         ///< of what that is the share; without one, why it is unknown; or empty
  double guessed_share = 0.0;           ///< of joints: they have a place, and a number behind it that is 0
  bool lengths_assumed = false;         ///< positions are of a body of standard size: no unit is measured of them
  std::optional<RootScale> root_scale;  ///< where the path of the root and the bones come from different places
  std::string silence = "no joints";    ///< why nothing can be measured without positions
  /// What else the file says: ("gender", "male").
  std::vector<std::pair<std::string, std::string>> facts;

  Reported<std::string> skeleton;  ///< known order or tree
  std::string layout_evidence;     ///< how frames and joints were recognised
  std::string units;               ///< where the format says it
  std::string up;
  std::string handedness;
  std::string axes;  ///< as a source says them
  std::vector<Finding> remarks;

  /// Points of `joints` joints, (frames, joints, 3): those at 0 0 0 and those that are no numbers are missing.
  void TakePoints(int count, const std::vector<double>& xyz);
  /// Nothing is seen in these frames.
  void SetMissing(const std::vector<int>& lost) {
    if (!lost.empty()) confidence.assign(positions.xyz.size() / 3, 1.0);
    for (const int f : lost)
      std::fill_n(confidence.begin() + static_cast<std::ptrdiff_t>(f) * positions.joints, positions.joints, 0.0);
  }
  /// Frames at both ends whose rows are damaged, by the remarks, show nothing: they are cut, as a run cuts them.
  void CutDamagedEnds();
  void AddRemarks(const std::vector<Finding>& more) { remarks.insert(remarks.end(), more.begin(), more.end()); }
};

/// Names the points by the best known order and says how sure that is and what else fits; false if none fits.
bool RecogniseOrder(RawClip& clip);
/// Remarks when no two points of a clip without names keep their distance.
void CheckPositions(RawClip& clip);
/// Remarks "joint_order_contradiction" where points that are named as declared are no body of the declared skeleton and
/// another order is one.
void CompareOrder(const SourceOptions& source, RawClip& clip);
/// Names the points, of a skeleton of configs/skeletons, as the format says.
void FollowFormat(const std::string& skeleton, const std::vector<std::string>& joints, const std::string& evidence,
                  RawClip& clip);

/// A tree with names: a skeleton of configs/skeletons if all its names are that one's, else one of the file's own.
/// Names and their number must be set; points are set.
void FollowTree(const std::vector<int>& parents, const std::string& evidence, RawClip& clip);

/// The points of a skeleton: by the names that all skeletons share, or, in a tree of a file's own, by what its names
/// look like.
BodyLandmarks PointsOfBody(const Skeleton& skeleton);
/// Of tracks with these names: joints of `skeleton` (may be null) by any of their names. Detectors' layouts have no
/// head; their nose is taken.
BodyLandmarks PointsOfBody(const std::vector<std::string>& names, const Skeleton* skeleton);

}  // namespace mocurate
