#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// How the frames of interest are selected.
enum class TrimRule {
  kNone,          ///< whole clip
  kAnnotated,     ///< one clip per annotated segment
  kMotionEnergy,  ///< still frames at both ends are cut
  kTriples,       ///< samples of two actions and the transition between them
  kChangePoints,  ///< cut where the action changes
  kCycles,        ///< one clip per repetition of an exercise
  kByExample,     ///< spans similar to marked ones
};

/// MultiAct's samples [previous action, transition, action] (canon/recipes/action_triples.h).
struct TripleOptions {
  double rate_hz = 20.0;  ///< of samples: every n-th recorded frame, n rounded down
  std::string transition = "transition";
  std::int64_t least_frames = 20;  ///< of a sample
  std::int64_t most_frames = 120;
  std::int64_t context = 4;  ///< last frames of the previous action in the network's input: the action needs one more

  void Declare(OptionVisitor& v);
};

/// The field of a segment that becomes the label of its clip. With kCategory the segment's label is the fine label.
enum class ClassFrom { kLabel, kCategory };

/// Where a recording is cut into consecutive actions (canon/trim/trim.h). Penalties are in seconds of a
/// segment unlike its surroundings.
struct ChangePointOptions {
  double rest_penalty_s = 0.3;      ///< of a boundary at rest
  double moving_penalty_s = 1.0;    ///< of a boundary in the middle of a movement
  double restless_penalty_s = 0.5;  ///< of a boundary in a recording without rests
  double least_segment_s = 0.3;
  double least_rest_s = 0.5;    ///< shorter rests become one boundary in their middle
  double longest_s = 60.0;      ///< longest segment
  double min_confidence = 0.0;  ///< less confident boundaries are dropped
  bool keep_rests = false;

  void Declare(OptionVisitor& v);
};

/// How an exercise is cut into repetitions (canon/trim/trim.h).
struct CycleOptions {
  double shortest_s = 0.4;  ///< of a repetition
  double longest_s = 8.0;

  void Declare(OptionVisitor& v);
};

/// How marked spans of an action are used to find others (canon/trim/by_example.h).
struct ByExampleOptions {
  std::filesystem::path examples;  ///< table clip,begin_s,end_s,label
  double join_gap_s = 0.5;         ///< found spans with a smaller gap are merged
  double min_confidence = 0.5;     ///< measured: precision 0.9

  void Declare(OptionVisitor& v);
};

struct TrimOptions {
  TrimRule rule = TrimRule::kNone;
  double still_speed = 0.15;   ///< m/s of the fastest joint, below which a frame is still
  double moving_speed = 0.15;  ///< m/s that a movement must reach; smaller values than still_speed count as still_speed
  double margin_s = 0.2;       ///< kept before the first and after the last moving frame
  double min_length_s = 0.25;  ///< shorter clips are dropped
  std::vector<std::string> drop_labels;
  /// Spans of clips (canon/recipes/spans_file.h), in place of their annotated segments; empty: none. The file is an
  /// input of the stage `canon`.
  std::filesystem::path spans;
  std::string spans_of;  ///< a table of configs/spans, where `spans` is empty: "humanact12"
  ClassFrom class_from = ClassFrom::kLabel;
  bool as_segments = false;          ///< recordings stay whole, spans become their segments for review
  TripleOptions triples;             ///< with TrimRule::kTriples
  ChangePointOptions change_points;  ///< with TrimRule::kChangePoints
  CycleOptions cycles;               ///< with TrimRule::kCycles
  ByExampleOptions by_example;       ///< with TrimRule::kByExample

  void Declare(OptionVisitor& v);
};

/// Rule of the clip's world rotation (canon/frames/facing.h).
enum class FacingRule {
  kNone,    ///< no change: the world of the source, or of a levelled floor
  kOrigin,  ///< heading as recorded, the anchor's root to the origin
  kHips,    ///< facing +z by the hip axis; where that is nearly vertical, by the forward axis
  kEuler,   ///< facing +z by the yaw of ZYX Euler angles, as in MultiAct's code
  kTwist,   ///< facing +z by the twist about the vertical: continuous in every pose except upside down
  kZero,    ///< the anchor's root rotation becomes the identity (MultiAct's ablation)
  kGiven,   ///< a rotation for each person or view, as ACTOR rotates PHSPD into one camera's axes
};
enum class Anchor { kFirst, kMiddle, kLast, kFirstSegment, kFrame };
enum class HeightOrigin {
  kRoot,      ///< the anchor's root
  kFloor,     ///< y = 0 of the recording, or of a levelled floor
  kMeasured,  ///< the floor where canon.level measures one, else the root
};

/// A world rotation of the clips of some persons or views; empty lists name all.
struct GivenRotationOptions {
  std::vector<std::string> persons;
  std::vector<std::string> views;
  std::vector<double> rotation;  ///< canonical_from_source, 9 numbers row by row

  void Declare(OptionVisitor& v);
};

/// Canonicalisation of position and heading (multiact.md B, y-up form B.3).
struct FacingOptions {
  FacingRule rule = FacingRule::kHips;
  Anchor anchor = Anchor::kFirst;
  std::int64_t anchor_frame = 0;  ///< with Anchor::kFrame
  HeightOrigin height = HeightOrigin::kMeasured;
  double min_horizontal = 0.2;  ///< smallest horizontal part of the hip axis that determines yaw
  std::vector<GivenRotationOptions> given;

  void Declare(OptionVisitor& v);
};

enum class FloorRule {
  kNone,
  kHeight,  ///< the floor under the feet moves to y = 0
  kTilt,    ///< a tilted sensor is also levelled
};
/// The clips that share one floor and one sensor.
enum class LevelOf { kSet, kSession, kView, kPerson, kClip };

/// The floor under the clips of a sensor (canon/frames/level.h).
struct LevelOptions {
  FloorRule rule = FloorRule::kNone;
  LevelOf of = LevelOf::kSet;

  void Declare(OptionVisitor& v);
};

struct CanonOptions {
  std::string skeleton;  ///< of the joints-only baseline (input role "tracks")
  TrimOptions trim;
  LevelOptions level;
  FacingOptions facing;
  std::string rate;  ///< "20", "30", "120000/1001"; empty keeps each clip's own
  /// Decisions about clips of the dataset (canon/review/review.h), or empty. The file is an input of the stages
  /// `assemble` and `audit`, not of `canon`.
  std::filesystem::path review;

  void Declare(OptionVisitor& v);
};

enum class SplitBy { kPerson, kStyle, kFraction, kRole };

/// What happens where a split names persons or styles that the set lacks (by role: ingest.source.roles does). Drawing
/// is for recordings of a known layout that have other people: where a part has none of its names, `test_share` or
/// `validation_share` of those in the set that no part names.
enum class AbsentGroups { kDraw, kRefuse };

/// The train, validation and test parts. By person or style: the names in `test` and `validation`, all others train;
/// names in `train` are never drawn. By fraction: shares of the performances, drawn by hash of their names and `seed`;
/// all cameras of one performance stay together.
struct SplitOptions {
  std::string name = "default";
  SplitBy by = SplitBy::kFraction;
  std::vector<std::string> test;
  std::vector<std::string> validation;
  std::vector<std::string> train;
  AbsentGroups absent = AbsentGroups::kRefuse;
  bool sessions_together = false;  ///< by fraction: the clips of a person's session are one group
  double test_share = 0.2;
  double validation_share = 0.1;
  std::int64_t seed = 1;
  std::int64_t most_per_label = 0;    ///< clips of a label in a part, drawn by hash and `seed`; 0: all
  std::int64_t min_train_frames = 0;  ///< shorter clips do not train (ACTOR's UESTC: 45)

  void Declare(OptionVisitor& v);
};

/// One class of a dataset; its index is its position in the list.
struct ClassOptions {
  std::string name;
  std::vector<std::string> from;  ///< labels that map to it, beside its own name
  std::vector<std::string> fine;  ///< its fine labels, in order
  std::optional<double> clips;    ///< expected number

  void Declare(OptionVisitor& v);
};

/// Expected counts of a published set.
struct ExpectedCounts {
  std::optional<double> clips;
  std::optional<double> frames;
  std::optional<double> persons;

  void Declare(OptionVisitor& v);
};

struct AssembleOptions {
  std::string recipe;  ///< description of how the set was made
  std::vector<ClassOptions> classes;
  std::vector<std::string> label_order;  ///< where no classes are listed
  ExpectedCounts expected;
  std::vector<SplitOptions> splits;

  void Declare(OptionVisitor& v);
};

/// Search for label errors (canon/audit/audit.h). Measured on KARD with 3 and 10 % of the labels exchanged, 20
/// draws each: docs/audited_sets.md.
struct LabelNoiseOptions {
  bool enabled = true;
  double other_share = 0.7;        ///< share of a class's mean own score that a clip of another class must reach
  double own_share = 0.25;         ///< share of its own class's mean own score that it must stay below
  std::int64_t most_clips = 4000;  ///< maximum training clips of a fold

  void Declare(OptionVisitor& v);
};

/// Which measures of a clip are reported as outliers of its class (canon/audit/audit.h).
struct OutlierOptions {
  bool enabled = true;
  double deviations = 8.0;  ///< robust standard deviations from the median

  void Declare(OptionVisitor& v);
};

struct AuditOptions {
  std::string split;  ///< of the nearest-neighbour baseline; empty: the first one
  LabelNoiseOptions labels;
  OutlierOptions outliers;
  double repeated_distance_m = 0.004;  ///< of two clips (FindDuplicates), below which they have the same motion

  void Declare(OptionVisitor& v);
};

/// Role of a table of spans.
inline constexpr const char* kSpansRole = "spans";

/// Roles of the table of marked spans, and of the clips that it names.
inline constexpr const char* kExamplesRole = "examples";
inline constexpr const char* kExampleRole = "example";
/// Role of the floor under an example clip; the input's name is the clip's.
inline constexpr const char* kExampleFloorRole = "example_floor";

/// Role of the floor under a clip, an output of the stage `level`.
inline constexpr const char* kFloorRole = "floor";

/// Roles of a file of decisions. By id: decisions also apply to other motions of the same clips, such as unfitted
/// tracks.
inline constexpr const char* kReviewRole = "review";
inline constexpr const char* kReviewByIdRole = "review_by_id";

}  // namespace mocurate
