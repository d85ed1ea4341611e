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
};

struct TrimOptions {
  TrimRule rule = TrimRule::kNone;
  double still_speed = 0.15;    ///< m/s of the fastest joint, below which a frame is still
  double speed_window_s = 0.4;  ///< a speed is the slope of a joint's path over this time
  double margin_s = 0.2;        ///< kept before the first and after the last moving frame
  double min_length_s = 0.25;   ///< shorter clips are dropped
  std::vector<std::string> drop_labels;

  void Declare(OptionVisitor& v);
};

enum class FacingRule { kNone, kHips };
enum class Anchor { kFirst, kLast };

/// Canonicalisation of place and heading (multiact.md B, y-up form B.3).
struct FacingOptions {
  FacingRule rule = FacingRule::kHips;
  Anchor anchor = Anchor::kFirst;
  double min_horizontal = 0.2;  ///< shortest horizontal part of the hip axis that yaw is read from

  void Declare(OptionVisitor& v);
};

struct CanonOptions {
  std::string skeleton;  ///< of the joints-only baseline (input role "tracks")
  TrimOptions trim;
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

/// Roles of a file of decisions. By id: also about motions other than those that were looked at, such as the unfitted
/// tracks of the same clips.
inline constexpr const char* kReviewRole = "review";
inline constexpr const char* kReviewByIdRole = "review_by_id";

/// Finding::action of what an audit found.
inline constexpr const char* kAudited = "reported by an audit";

StageDeclaration CanonDeclaration();
StageDeclaration AssembleDeclaration();
StageDeclaration AuditDeclaration();

}  // namespace mocurate
