#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// How the frames of interest are found.
enum class TrimRule {
  kNone,          ///< whole clip
  kAnnotated,     ///< one clip per annotated segment
  kMotionEnergy,  ///< still frames at both ends are cut
  kTriples,       ///< samples of two actions and the transition between them
  kChangePoints,  ///< cut where what is done changes
  kCycles,        ///< one clip per repetition of an exercise
  kByExample,     ///< spans that are like marked ones
};

/// MultiAct's samples [previous action, transition, action] (canon/recipes/action_triples.h). Numbers of frames are
/// those of a sample; the defaults are the released code's (multiact.md A.3).
struct TripleOptions {
  double rate_hz = 20.0;  ///< of samples: every so-many-th recorded frame, rounded down
  std::string transition = "transition";
  double transition_share = 0.1;  ///< of a neighbour that a transition takes, twice that where none is labelled
  std::int64_t most_taken = 5;    ///< frames of a neighbour that a transition takes at most, twice that as above
  std::int64_t extra_frames = 3;  ///< that the action runs past its label
  std::int64_t least_frames = 20;
  std::int64_t most_frames = 120;
  std::int64_t least_part = 3;  ///< frames of each part
  std::int64_t context = 4;     ///< last frames of the previous action that the network is given: it has one more

  void Declare(OptionVisitor& v);
};

/// What of a segment becomes the label of its clip. With kCategory the segment's label is the fine label.
enum class ClassFrom { kLabel, kCategory };

/// Where a recording is cut into what is done one after the other (canon/trim/change_points.h). Penalties are seconds
/// of a segment that is like nothing around it.
struct ChangePointOptions {
  double rest_penalty_s = 0.3;      ///< of a boundary at rest
  double moving_penalty_s = 1.0;    ///< of a boundary in the middle of a movement
  double restless_penalty_s = 0.5;  ///< of a boundary in a recording without rests
  double least_segment_s = 0.3;
  double least_rest_s = 0.5;    ///< shorter rests are one boundary in their middle
  double longest_s = 60.0;      ///< over which a segment is compared with itself
  double min_confidence = 0.0;  ///< less confident boundaries are none
  bool keep_rests = false;

  void Declare(OptionVisitor& v);
};

/// How an exercise is cut into repetitions (canon/trim/cycles.h).
struct CycleOptions {
  double shortest_s = 0.4;  ///< of a repetition
  double longest_s = 8.0;

  void Declare(OptionVisitor& v);
};

/// How marked spans of an action find others (canon/trim/by_example.h).
struct ByExampleOptions {
  std::filesystem::path examples;  ///< table clip,begin_s,end_s,label
  double join_gap_s = 0.5;         ///< between two found spans that are one
  double min_confidence = 0.5;     ///< measured: precision 0.9

  void Declare(OptionVisitor& v);
};

struct TrimOptions {
  TrimRule rule = TrimRule::kNone;
  double still_speed = 0.15;    ///< m/s of the fastest joint, below which a frame is still
  double moving_speed = 0.15;   ///< m/s that a movement must reach to be one; less than still_speed: the same as it
  double speed_window_s = 0.4;  ///< a speed is the slope of a joint's path over this time
  double margin_s = 0.2;        ///< kept before the first and after the last moving frame
  double min_length_s = 0.25;   ///< shorter clips are dropped
  std::vector<std::string> drop_labels;
  /// Spans of clips (canon/recipes/spans_file.h), in place of their annotated segments; empty: none. The stage `canon`
  /// takes the file as an input.
  std::filesystem::path spans;
  std::string spans_of;  ///< a table of configs/spans, where `spans` is empty: "humanact12"
  ClassFrom class_from = ClassFrom::kLabel;
  bool as_segments = false;          ///< recordings stay whole, spans become their segments, for a person to look at
  TripleOptions triples;             ///< with TrimRule::kTriples
  ChangePointOptions change_points;  ///< with TrimRule::kChangePoints
  CycleOptions cycles;               ///< with TrimRule::kCycles
  ByExampleOptions by_example;       ///< with TrimRule::kByExample

  void Declare(OptionVisitor& v);
};

/// What the world of a clip is turned by (canon/frames/facing.h).
enum class FacingRule {
  kNone,    ///< nothing is moved: the world stays as the source, or a levelled floor, has it
  kOrigin,  ///< heading as recorded, the anchor's root to the origin
  kHips,    ///< facing +z by the hip axis; where that is nearly vertical, by the forward axis
  kEuler,   ///< facing +z by the yaw of ZYX Euler angles, as MultiAct's code has it
  kTwist,   ///< facing +z by the turn about the vertical: continuous in every pose but upside down
  kZero,    ///< the anchor's root rotation becomes the identity (MultiAct's ablation)
  kGiven,   ///< a rotation for each person or view, as ACTOR turns PHSPD into one camera's axes
};
enum class Anchor { kFirst, kMiddle, kLast, kFirstSegment, kFrame };
enum class HeightOrigin { kRoot, kFloor };

/// A world rotation of the clips of some persons or views; empty lists name all.
struct GivenRotationOptions {
  std::vector<std::string> persons;
  std::vector<std::string> views;
  std::vector<double> rotation;  ///< canonical_from_source, 9 numbers row by row

  void Declare(OptionVisitor& v);
};

/// Canonicalisation of place and heading (multiact.md B, y-up form B.3).
struct FacingOptions {
  FacingRule rule = FacingRule::kHips;
  Anchor anchor = Anchor::kFirst;
  std::int64_t anchor_frame = 0;  ///< with Anchor::kFrame
  HeightOrigin height = HeightOrigin::kRoot;
  double min_horizontal = 0.2;  ///< shortest horizontal part of the hip axis that yaw is read from
  std::vector<GivenRotationOptions> given;

  void Declare(OptionVisitor& v);
};

enum class FloorRule {
  kNone,
  kHeight,  ///< the floor under the feet comes to y = 0
  kTilt,    ///< and a tilted sensor is levelled
};
/// What stands before one floor and one sensor.
enum class LevelOf { kSet, kSession, kView, kPerson, kClip };

/// The floor under the clips of a sensor (canon/frames/level.h).
struct LevelOptions {
  FloorRule rule = FloorRule::kNone;
  LevelOf of = LevelOf::kSet;
  double height_sigma = 0.03;     ///< metres, of a standing foot's height: a tracker's noise and people's ankles
  double body_sigma = 0.07;       ///< radians, of a standing person's axis around the vertical and the common lean
  double lean_sigma = 0.05;       ///< radians, prior of the common lean
  std::int64_t most_clips = 300;  ///< that the floor is estimated from, drawn by hash of their ids

  void Declare(OptionVisitor& v);
};

struct CanonOptions {
  std::string skeleton;  ///< of the joints-only baseline (input role "tracks")
  TrimOptions trim;
  LevelOptions level;
  FacingOptions facing;
  std::string rate;  ///< "20", "30", "120000/1001"; empty keeps each clip's own
  /// Decisions about clips of the dataset (canon/review/review.h), or empty. The stages `assemble` and `audit` take
  /// the file as an input, the stage `canon` does not know it.
  std::filesystem::path review;

  void Declare(OptionVisitor& v);
};

enum class SplitBy { kPerson, kStyle, kFraction, kRole };

/// What happens when the set has none of the persons or styles that a split names for a part: other recordings of a
/// known layout bring other people. Drawing takes `test_share` or `validation_share` of those that are there, and only
/// such as no part names.
enum class AbsentGroups { kDraw, kRefuse };

/// Which clips train, select and test. By person or style: the names in `test` and `validation`, all others train;
/// those in `train` also where others are drawn. By fraction: shares of the performances, drawn by hash of their names
/// and `seed`; what several cameras saw at once is one.
struct SplitOptions {
  std::string name = "default";
  SplitBy by = SplitBy::kFraction;
  std::vector<std::string> test;
  std::vector<std::string> validation;
  std::vector<std::string> train;
  AbsentGroups absent = AbsentGroups::kDraw;
  bool sessions_together = false;  ///< by fraction: the clips of one session of a person are one group
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
  std::vector<std::string> from;  ///< labels of clips that it takes, beside its own name
  std::vector<std::string> fine;  ///< its fine labels, in order
  std::optional<double> clips;    ///< how many it is expected to have

  void Declare(OptionVisitor& v);
};

/// Counts that a published set is known to have.
struct ExpectedCounts {
  std::optional<double> clips;
  std::optional<double> frames;
  std::optional<double> persons;

  void Declare(OptionVisitor& v);
};

struct AssembleOptions {
  std::string recipe;  ///< free text that says how the set was made
  std::vector<ClassOptions> classes;
  std::vector<std::string> label_order;  ///< where no classes are listed
  ExpectedCounts expected;
  std::vector<SplitOptions> splits;

  void Declare(OptionVisitor& v);
};

/// How label errors are looked for (canon/audit/label_noise.h). Measured on KARD with 3 and 10 % of the labels
/// exchanged, 20 draws each: docs/audited_sets.md.
struct LabelNoiseOptions {
  bool enabled = true;
  std::int64_t frames = 32;        ///< that a clip is resampled to
  double velocity_weight = 3.0;    ///< of differences beside places
  double width = 1.0;              ///< exponent at the median squared distance of two clips
  double ridge = 0.1;              ///< added to the kernel's diagonal of ones
  double other_share = 0.7;        ///< of a class's usual score that another class's clip must reach
  double own_share = 0.25;         ///< of its own class's usual score that it must stay below
  double none_share = 0.15;        ///< of every class's usual score that a clip of no class stays below
  double least_usual = 0.05;       ///< usual score below which a class is not recognised at all, and not judged
  std::int64_t most_clips = 4000;  ///< that a fold learns from
  std::int64_t most_folds = 10;    ///< that persons are spread over
  std::int64_t drawn_folds = 5;    ///< of clips, where there are fewer than three persons

  void Declare(OptionVisitor& v);
};

/// Which measures of a clip are reported as outliers of its class (canon/audit/clip_measures.h).
struct OutlierOptions {
  bool enabled = true;
  double deviations = 8.0;       ///< robust standard deviations from the median
  std::int64_t least_clips = 8;  ///< of a class that is compared with itself

  void Declare(OptionVisitor& v);
};

struct AuditOptions {
  std::string split;  ///< of the nearest-neighbour figure; empty: the first one
  std::int64_t nearest_neighbour_frames = 32;
  LabelNoiseOptions labels;
  OutlierOptions outliers;
  double repeated_distance_m = 0.004;  ///< of two clips (StretchLimits::distance), below which they show the same

  void Declare(OptionVisitor& v);
};

/// Role of a table of spans.
inline constexpr const char* kSpansRole = "spans";

/// Roles of the table of marked spans, and of the clips that it names.
inline constexpr const char* kExamplesRole = "examples";
inline constexpr const char* kExampleRole = "example";
/// Role of the floor under such a clip; the input's name is that of the clip's.
inline constexpr const char* kExampleFloorRole = "example_floor";

/// Role of the floor under a clip, what the stage `level` gives.
inline constexpr const char* kFloorRole = "floor";

/// Roles of a file of decisions. By id: also about motions other than those that were looked at, such as the unfitted
/// tracks of the same clips.
inline constexpr const char* kReviewRole = "review";
inline constexpr const char* kReviewByIdRole = "review_by_id";

StageDeclaration LevelDeclaration();
StageDeclaration CanonDeclaration();
StageDeclaration AssembleDeclaration();
StageDeclaration AuditDeclaration();

}  // namespace mocurate
