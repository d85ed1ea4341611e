#include "canon/options.h"
#include "canon/stages.h"

namespace mocurate {

void TripleOptions::Declare(OptionVisitor& v) {
  v.Number("rate", rate_hz, Unit::kHertz, {0.1, 1000.0},
           "rate of the samples: every n-th recorded frame is used, n rounded down; canon.rate resamples before");
  v.Text("transition", transition, "label of transitions");
  v.Integer("least_frames", least_frames, {0.0, 1e5}, "samples with this many frames or fewer are dropped");
  v.Integer("most_frames", most_frames, {4.0, 1e5}, "samples with this many frames or more are dropped");
  v.Integer("context", context, {0.0, 1e5},
            "frames of the previous action in the network's input; the action itself needs one more");
}

void ChangePointOptions::Declare(OptionVisitor& v) {
  v.Number("rest_penalty", rest_penalty_s, Unit::kSecond, {0.01, 60.0},
           "cost of a boundary at rest, in seconds of a segment that differs from its neighbours: higher costs give "
           "fewer boundaries");
  v.Number("moving_penalty", moving_penalty_s, Unit::kSecond, {0.01, 60.0},
           "cost of a boundary in the middle of a movement");
  v.Number("restless_penalty", restless_penalty_s, Unit::kSecond, {0.01, 60.0},
           "cost of a boundary in a recording without rests");
  v.Number("least_segment", least_segment_s, Unit::kSecond, {0.04, 60.0}, "shortest segment");
  v.Number("least_rest", least_rest_s, Unit::kSecond, {0.0, 60.0},
           "rests shorter than this become one boundary in their middle");
  v.Number("longest", longest_s, Unit::kSecond, {1.0, 600.0}, "longest segment; computing time grows with it");
  v.Number("min_confidence", min_confidence, Unit::kNone, {0.0, 1.0}, "less confident boundaries are dropped");
  v.Bool("keep_rests", keep_rests, "keep rests between actions as clips");
}

void CycleOptions::Declare(OptionVisitor& v) {
  v.Number("shortest", shortest_s, Unit::kSecond, {0.1, 60.0}, "shortest repetition");
  v.Number("longest", longest_s, Unit::kSecond, {0.1, 60.0}, "longest repetition");
}

void ByExampleOptions::Declare(OptionVisitor& v) {
  v.Path("examples", examples, "table clip,begin_s,end_s,label of the marked spans");
  v.Number("join_gap", join_gap_s, Unit::kSecond, {0.0, 60.0}, "found spans with a smaller gap are merged");
  v.Number("min_confidence", min_confidence, Unit::kNone, {0.0, 1.0}, "less confident spans are dropped");
}

void TrimOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule,
           {{"none", TrimRule::kNone},
            {"annotated", TrimRule::kAnnotated},
            {"motion_energy", TrimRule::kMotionEnergy},
            {"triples", TrimRule::kTriples},
            {"change_points", TrimRule::kChangePoints},
            {"cycles", TrimRule::kCycles},
            {"by_example", TrimRule::kByExample}},
           "rule that selects the frames of interest");
  v.Number("still_speed", still_speed, Unit::kMetrePerSecond, {0.0, 10.0},
           "a frame is still when its fastest joint is slower than this");
  v.Number("moving_speed", moving_speed, Unit::kMetrePerSecond, {0.0, 10.0},
           "a movement begins at still_speed and is kept if it reaches this speed; values below still_speed mean "
           "still_speed");
  v.Number("margin", margin_s, Unit::kSecond, {0.0, 10.0},
           "time kept before the first and after the last moving frame");
  v.Number("min_length", min_length_s, Unit::kSecond, {0.0, 3600.0},
           "shorter clips are dropped, with a finding; 0 s keeps single frames");
  v.Texts("drop_labels", drop_labels, "annotated segments with these labels are excluded");
  v.Path("spans", spans,
         "table clip,begin_s,end_s,label, or a list of HumanAct12's names; its spans replace the annotated segments of "
         "the clips that it names");
  v.Text("spans_of", spans_of, "built-in table of spans, where `spans` is empty: humanact12");
  v.Choice(
      "class_from", class_from, {{"label", ClassFrom::kLabel}, {"category", ClassFrom::kCategory}},
      "field of a segment that is the class of its clip; with category (the first of several) its label is the fine "
      "label, as it "
      "is for listed spans with a fine label");
  v.Bool("as_segments", as_segments,
         "do not cut: the spans become proposed segments of whole recordings, for `mocurate review --annotate`; not "
         "with rule: triples");
  v.Group("triples", triples, "with rule: triples, samples of two actions and the transition between them");
  v.Group("change_points", change_points, "with rule: change_points, consecutive actions");
  v.Group("cycles", cycles, "with rule: cycles, repetitions of an exercise");
  v.Group("by_example", by_example, "with rule: by_example, spans similar to marked ones");
}

void GivenRotationOptions::Declare(OptionVisitor& v) {
  v.Texts("persons", persons, "persons whose clips are rotated; empty: all");
  v.Texts("views", views, "cameras whose clips are rotated; empty: all");
  v.Numbers("rotation", rotation, Unit::kNone, {-1.001, 1.001},
            "matrix canonical_from_source, 9 numbers row by row, in the axes of ingest.source.axes");
}

void FacingOptions::Declare(OptionVisitor& v) {
  v.Choice(
      "rule", rule,
      {{"none", FacingRule::kNone},
       {"origin", FacingRule::kOrigin},
       {"hips", FacingRule::kHips},
       {"euler", FacingRule::kEuler},
       {"twist", FacingRule::kTwist},
       {"zero", FacingRule::kZero},
       {"given", FacingRule::kGiven}},
      "rule of the rotation: no change (none), only the root moves to the origin (origin), the person "
      "faces +z by the hip axis (hips), by ZYX Euler angles as in MultiAct's code (euler) or by the twist about the "
      "vertical (twist), the root's rotation is inverted (zero), or facing.given (given)");
  v.Choice("anchor", anchor,
           {{"first", Anchor::kFirst},
            {"middle", Anchor::kMiddle},
            {"last", Anchor::kLast},
            {"first_segment", Anchor::kFirstSegment},
            {"frame", Anchor::kFrame}},
           "frame whose root moves to the origin and faces +z; first_segment: the last frame of the first segment");
  v.Integer("anchor_frame", anchor_frame, {0.0, 1e9}, "with anchor: frame, index from 0");
  v.Choice("height", height,
           {{"root", HeightOrigin::kRoot}, {"floor", HeightOrigin::kFloor}, {"measured", HeightOrigin::kMeasured}},
           "height 0: the anchor's root (root), y = 0 of the recording or of canon.level's floor (floor), or the floor "
           "where canon.level measures one, else the root (measured)");
  v.Number("min_horizontal", min_horizontal, Unit::kNone, {0.01, 1.0},
           "report a clip whose heading axis has a horizontal part below this; rule hips then uses the forward axis");
  v.List("given", given, "with rule: given, rotations by person or view");
}

void LevelOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule, {{"none", FloorRule::kNone}, {"height", FloorRule::kHeight}, {"tilt", FloorRule::kTilt}},
           "no change (none); the floor under standing feet moves to y = 0 (height); a tilted sensor is also levelled "
           "(tilt)");
  v.Choice(
      "of", of,
      {{"set", LevelOf::kSet},
       {"session", LevelOf::kSession},
       {"view", LevelOf::kView},
       {"person", LevelOf::kPerson},
       {"clip", LevelOf::kClip}},
      "clips that share a floor: all, those of a person's session, of a view in a session, of a person, or each clip "
      "has its own");
}

void CanonOptions::Declare(OptionVisitor& v) {
  v.Text("skeleton", skeleton, "skeleton of the joints-only baseline made from unfitted tracks");
  v.Group("trim", trim, "frames of interest");
  v.Group("level", level, "the floor");
  v.Group("facing", facing, "position and heading");
  v.Text("rate", rate, "frames per second of the dataset, a number or a fraction; empty keeps each clip's own");
  v.Path("review", review, "decisions about its clips, saved by `mocurate review`");
}

void SplitOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the split");
  v.Choice("by", by,
           {{"person", SplitBy::kPerson},
            {"style", SplitBy::kStyle},
            {"fraction", SplitBy::kFraction},
            {"role", SplitBy::kRole}},
           "property that no two parts share");
  v.Texts("test", test, "persons or styles in the test part");
  v.Texts("validation", validation, "persons or styles in the validation part");
  v.Texts("train", train,
          "persons or styles that are always in the training part; others are in it unless drawn for another part");
  v.Choice("absent", absent, {{"draw", AbsentGroups::kDraw}, {"refuse", AbsentGroups::kRefuse}},
           "if the set lacks a person or style that is named for a part, or by role under ingest.source.roles: refuse; "
           "or report a finding, and draw others for a part that has none of its names (by role none are drawn)");
  v.Bool("sessions_together", sessions_together,
         "by fraction: keep all clips of a person's session, repetitions included, in one part");
  v.Number("test_share", test_share, Unit::kNone, {0.0, 1.0},
           "share of the performances (or drawn groups) in the test part");
  v.Number("validation_share", validation_share, Unit::kNone, {0.0, 1.0},
           "share of the performances (or drawn groups) in the validation part");
  v.Integer("seed", seed, {}, "random seed of the draw");
  v.Integer("most_per_label", most_per_label, {0.0, 1e9},
            "maximum clips of a label in a part, drawn by hash of their ids; 0: all. No clip is repeated");
  v.Integer("min_train_frames", min_train_frames, {0.0, 1e6}, "shorter clips are not used for training; 0: no limit");
}

void ClassOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the class");
  v.Texts("from", from, "labels that map to the class, beside its own name");
  v.Texts("fine", fine, "its fine labels, in the order of their indices");
  v.OptionalNumber("clips", clips, Unit::kNone, {0.0, {}}, "expected number of clips; another number is a finding");
}

void ExpectedCounts::Declare(OptionVisitor& v) {
  v.OptionalNumber("clips", clips, Unit::kNone, {0.0, {}}, "expected number of clips");
  v.OptionalNumber("frames", frames, Unit::kNone, {0.0, {}}, "expected number of frames over all clips");
  v.OptionalNumber("persons", persons, Unit::kNone, {0.0, {}}, "expected number of persons");
}

void AssembleOptions::Declare(OptionVisitor& v) {
  v.Text("recipe", recipe, "description of how the set was made");
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
  v.Bool("enabled", enabled, "look for clips that resemble another class");
  v.Number("other_share", other_share, Unit::kNone, {0.0, 10.0},
           "minimum score of a clip for another class, as a share of the mean score of that class's own clips");
  v.Number("own_share", own_share, Unit::kNone, {-10.0, 10.0},
           "maximum score of a clip for its own class, as a share of the mean score of that class's clips");
  v.Integer("most_clips", most_clips, {2.0, 20000.0}, "maximum training clips of a fold; larger sets are sampled");
}

void OutlierOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "report clips whose jerk, speed, length, ... is an outlier of their class");
  v.Number("deviations", deviations, Unit::kNone, {1.0, 1e6},
           "robust standard deviations from the median of the class");
}

void AuditOptions::Declare(OptionVisitor& v) {
  v.Text("split", split, "split of the nearest-neighbour baseline; empty: the first");
  v.Group("labels", labels, "search for label errors");
  v.Group("outliers", outliers, "search for outliers of a class");
  v.Number("repeated_distance", repeated_distance_m, Unit::kMetre, {1e-6, 1.0},
           "two clips have the same motion if each joint's distances to the others differ by at most this");
}

StageDeclaration LevelDeclaration() { return {"level", 3, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration CanonDeclaration() { return {"canon", 19, "mocurate-annotate", ClipLimits()}; }
StageDeclaration AssembleDeclaration() { return {"assemble", 15, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration AuditDeclaration() { return {"audit", 7, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
