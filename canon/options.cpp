#include "canon/options.h"

namespace mocurate {

void TrimOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule,
           {{"none", TrimRule::kNone}, {"annotated", TrimRule::kAnnotated}, {"motion_energy", TrimRule::kMotionEnergy}},
           "how the frames of interest are found");
  v.Number("still_speed", still_speed, Unit::kMetrePerSecond, {0.0, 10.0},
           "a frame is still when its fastest joint is slower than this");
  v.Number("speed_window", speed_window_s, Unit::kSecond, {0.0, 10.0},
           "a speed is the slope of a joint's path over this time: longer is less moved by noise");
  v.Number("margin", margin_s, Unit::kSecond, {0.0, 10.0}, "kept before the first and after the last moving frame");
  v.Number("min_length", min_length_s, Unit::kSecond, {0.0, 3600.0},
           "shorter clips are dropped, with a reason; 0 s keeps single frames");
  v.Texts("drop_labels", drop_labels, "annotated segments of these labels are left out");
}

void FacingOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule, {{"none", FacingRule::kNone}, {"hips", FacingRule::kHips}},
           "where yaw is read from: the left-right hip axis, or nowhere");
  v.Choice("anchor", anchor, {{"first", Anchor::kFirst}, {"last", Anchor::kLast}},
           "frame whose root goes to the origin and faces +z");
  v.Number("min_horizontal", min_horizontal, Unit::kNone, {0.01, 1.0},
           "below this horizontal part of the hip axis the forward axis decides, and the clip is flagged");
}

void CanonOptions::Declare(OptionVisitor& v) {
  v.Text("skeleton", skeleton, "skeleton of the joints-only baseline made from unfitted tracks");
  v.Group("trim", trim, "frames of interest");
  v.Group("facing", facing, "place and heading");
  v.Text("rate", rate, "frames per second of the dataset, a number or a fraction; empty keeps each clip's own");
  v.Path("review", review, "decisions about its clips, as `mocurate review` saves them");
}

void SplitOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the split");
  v.Choice("by", by,
           {{"person", SplitBy::kPerson},
            {"style", SplitBy::kStyle},
            {"fraction", SplitBy::kFraction},
            {"role", SplitBy::kRole}},
           "what two parts must not share");
  v.Texts("test", test, "persons or styles that test");
  v.Texts("validation", validation, "persons or styles that select");
  v.Texts("train", train, "persons or styles that train, as all others do, and that no draw takes");
  v.Choice("absent", absent, {{"draw", AbsentGroups::kDraw}, {"refuse", AbsentGroups::kRefuse}},
           "when the set has none of the persons or styles that test or select: draw others and say so, or refuse");
  v.Bool("sessions_together", sessions_together,
         "by fraction: all clips of one session of a person are of one part, its repetitions too");
  v.Number("test_share", test_share, Unit::kNone, {0.0, 1.0}, "share of the performances (or drawn groups) that test");
  v.Number("validation_share", validation_share, Unit::kNone, {0.0, 1.0},
           "share of the performances (or drawn groups) that select");
  v.Integer("seed", seed, {}, "of the drawing");
  v.Integer("min_train_frames", min_train_frames, {0.0, 1e6}, "shorter clips do not train; 0: no limit");
}

void ClassOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "of the class");
  v.Texts("from", from, "labels of clips that the class takes, beside its own name");
  v.Texts("fine", fine, "its fine labels, in the order of their indices");
  v.OptionalNumber("clips", clips, Unit::kNone, {0.0, {}}, "clips it is expected to have; another number is a finding");
}

void ExpectedCounts::Declare(OptionVisitor& v) {
  v.OptionalNumber("clips", clips, Unit::kNone, {0.0, {}}, "clips of the dataset");
  v.OptionalNumber("frames", frames, Unit::kNone, {0.0, {}}, "frames of all clips");
  v.OptionalNumber("persons", persons, Unit::kNone, {0.0, {}}, "persons of the dataset");
}

void AssembleOptions::Declare(OptionVisitor& v) {
  v.Text("recipe", recipe, "how the set was made, in words");
  v.List(
      "classes", classes,
      "classes in the order of their indices, absent ones included; clips of other labels are excluded; empty: every "
      "label is a class");
  v.Texts("label_order", label_order,
          "order of the classes where none are listed; empty: that of ingest.source.labels, else by name");
  v.Group("expected", expected, "counts of the published set; other numbers are a finding");
  v.List("splits", splits, "train, validation and test parts");
}

void LabelNoiseOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "look for clips that look like those of another class");
  v.Integer("frames", frames, {2.0, 256.0}, "frames that each clip is resampled to");
  v.Number("velocity_weight", velocity_weight, Unit::kNone, {0.0, 100.0},
           "weight of differences in time beside places");
  v.Number("width", width, Unit::kNone, {1e-3, 1e3}, "exponent of the kernel at the median squared distance of clips");
  v.Number("ridge", ridge, Unit::kNone, {1e-4, 1e3}, "added to the kernel's diagonal");
  v.Number("other_share", other_share, Unit::kNone, {0.0, 10.0},
           "least score of the other class, as a share of that class's mean own score");
  v.Number("own_share", own_share, Unit::kNone, {-10.0, 10.0},
           "largest score of the own class, as a share of its mean own score");
  v.Number("none_share", none_share, Unit::kNone, {-10.0, 10.0},
           "largest score of any class, as a share of its mean own score, of a clip that fits none");
  v.Number("least_usual", least_usual, Unit::kNone, {0.0, 1.0}, "least mean own score of a class that is judged");
  v.Integer("most_clips", most_clips, {2.0, 20000.0}, "that a fold learns from; of more so many are drawn");
  v.Integer("most_folds", most_folds, {2.0, 1000.0}, "folds that persons are spread over, at most");
  v.Integer("drawn_folds", drawn_folds, {2.0, 1000.0}, "folds of clips, where there are fewer than three persons");
}

void OutlierOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "report clips whose jerk, speed, length, ... is unlike that of their class");
  v.Number("deviations", deviations, Unit::kNone, {1.0, 1e6},
           "robust standard deviations from the median of the class");
  v.Integer("least_clips", least_clips, {3.0, 1e6}, "smaller classes are compared with the whole set");
}

void AuditOptions::Declare(OptionVisitor& v) {
  v.Text("split", split, "split of the nearest-neighbour figure; empty takes the first");
  v.Integer("nearest_neighbour_frames", nearest_neighbour_frames, {2.0, 1000.0},
            "frames each clip is resampled to before distances are taken");
  v.Group("labels", labels, "how label errors are looked for");
  v.Group("outliers", outliers, "which clips are reported as unlike their class");
  v.Number("repeated_distance", repeated_distance_m, Unit::kMetre, {1e-6, 1.0},
           "of the joint that differs most between two clips, by its distances from the others, below which they show "
           "the same");
}

StageDeclaration CanonDeclaration() { return {"canon", 15, "mocurate-annotate", ClipLimits()}; }
StageDeclaration AssembleDeclaration() { return {"assemble", 12, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration AuditDeclaration() { return {"audit", 3, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
