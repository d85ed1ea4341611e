#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/geometry/axes.h"
#include "ingest/inspect/inspection.h"
#include "ingest/inspect/measure.h"
#include "ingest/options.h"

namespace mocurate {

struct ItemResult;

/// What is said of a clip without looking at its numbers; empty: nothing.
struct DeclaredFrame {
  std::string units, up, handedness, facing, axes, who;
};

/// What the clip's format says, and over it what the source declares.
DeclaredFrame DeclaredFrameOf(const RawClip& clip, const std::optional<SourceOptions>& source);

/// One thing that is declared and that the clip shows.
struct Comparison {
  Finding finding;  ///< an error "up_contradiction" with how sure that is, or metres; it is one where they differ
  std::string measured;
  double weight = 0.0;  ///< how much the clip tells, 0 to 1
  bool contradicts = false;
};

/// Units, up and handedness: those that are declared and that the clip shows. Nothing of what it does not show.
std::vector<Comparison> CompareFrame(const DeclaredFrame& said, const ClipMeasures& measures);

/// The limit that the value behind a contradiction is beyond: metres of a body, a factor of a path, how sure a measure
/// is, the declared rate, the fit of an order of joints. 0 of other codes.
double ContradictionThreshold(const std::string& code, double value, const SourceOptions& source);

/// A rate that a file says, where it is not the declared one: "rate_contradiction". Writers of BVH round.
std::optional<Finding> CompareRate(const SourceOptions& source, double file_hz);

/// Least share of clips that deny their rate, of a set whose rate is wrong. Of recorded sets with half or twice their
/// rate, or 4 times that, it is 7.5 % to 91 %, or none; 3 % of KARD's gestures with 4 times theirs. With true rates no
/// clip of 1,460 denies it (docs/real_sets.md).
inline constexpr double kShareOfWrongRate = 0.05;
inline constexpr std::size_t kFewestWrongRates = 5;

/// Of all clips together: whether those whose motion denies their rate make that a fact about the set. One that allows
/// it says little, as people may do anything slowly: 5 that deny it in the same direction, and 5 %, are enough.
struct RateDenials {
  std::size_t clips = 0;
  std::size_t too_fast = 0;  ///< marked with more than the motion allows
  std::size_t too_slow = 0;

  void Add(double marked_hz, double fits_hz) { (fits_hz < marked_hz ? too_fast : too_slow) += 1; }
  double Share() const { return static_cast<double>(std::max(too_fast, too_slow)) / static_cast<double>(clips); }
  bool OfTheSet() const;
  std::string Words() const;  ///< "86 of 205 clips deny their rate, all as too fast"
};

/// A declared order of joints that scores better (BodyScore::total) is not doubted.
inline constexpr double kPlausibleOrder = 0.12;

/// Clips that contradict a declaration together, and the least share of what the clips that decide it say: no clip of
/// KARD, MSR-Action3D, UTKinect and Florence3D contradicts a correct one.
inline constexpr std::size_t kFewestDenials = 3;
inline constexpr double kAgreement = 0.95;

/// What the clips of a source, after the stage `ingest`, say together against its declaration. Unit, axes and order of
/// joints belong to the source, not to a clip: where at least 3 clips show one of them and contradict the declaration
/// to 95 % (by how much each tells), that is one finding (error) about all of them, and all are suspect; with
/// on_contradiction: refuse all are refused. Those that show nothing come from the same files. So is a rate, declared
/// or of the files, that the motions of enough clips deny (RateDenials).
std::vector<Finding> FindSetContradictions(const SourceOptions& source, std::vector<ItemResult>& clips);

/// How a file says its rate.
enum class RateUnit { kFramesPerSecond, kSecondsPerFrame };

/// Motion is recorded between these rates; faster cameras look at a hand or a foot alone.
inline constexpr double kSlowestRecorded_hz = 1.0, kFastestRecorded_hz = 2000.0;

/// The rate at which cameras and trackers run that is within half a per cent; nothing where none is.
std::optional<double> NearestUsualRate(double hz);

/// "rate_implausible", an error whose value is the rate: a rate of no recording, 1 Hz and less or more than
/// 2000. The message says as what the number of the file would be a usual rate: the other of both words, or
/// milliseconds. `place`: file and line or field. Nothing of a rate that the source declares.
std::optional<Finding> CheckStatedRate(double hz, RateUnit word, const std::string& place);

}  // namespace mocurate
