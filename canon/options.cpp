#include "canon/options.h"

namespace mocurate {

void TripleOptions::Declare(OptionVisitor& v) {
  v.Number(
      "rate", rate_hz, Unit::kHertz, {0.1, 1000.0},
      "of the samples: every so-many-th recorded frame is taken, rounded down; canon.rate resamples by time before");
  v.Text("transition", transition, "label of transitions");
  v.Number("transition_share", transition_share, Unit::kNone, {0.0, 0.5},
           "of a neighbour that a labelled transition takes; where none is labelled, twice that");
  v.Integer("most_taken", most_taken, {0.0, 1000.0},
            "frames of a neighbour that a transition takes at most; see above");
  v.Integer("extra_frames", extra_frames, {0.0, 1000.0}, "that the action runs past its label, where there are frames");
  v.Integer("least_frames", least_frames, {0.0, 1e5}, "samples of so many frames or fewer are dropped");
  v.Integer("most_frames", most_frames, {4.0, 1e5}, "samples of so many frames or more are dropped");
  v.Integer("least_part", least_part, {1.0, 1e5}, "frames of each of the three parts");
  v.Integer("context", context, {0.0, 1e5}, "frames of the previous action that the network is given; it has one more");
}

void ChangePointOptions::Declare(OptionVisitor& v) {
  v.Number("rest_penalty", rest_penalty_s, Unit::kSecond, {0.01, 60.0},
           "cost of a boundary at rest: seconds of a segment that is like nothing around it");
  v.Number("moving_penalty", moving_penalty_s, Unit::kSecond, {0.01, 60.0},
           "cost of a boundary in the middle of a movement");
  v.Number("restless_penalty", restless_penalty_s, Unit::kSecond, {0.01, 60.0},
           "cost of a boundary in a recording whose person never comes to rest");
  v.Number("least_segment", least_segment_s, Unit::kSecond, {0.04, 60.0}, "shortest segment");
  v.Number("least_rest", least_rest_s, Unit::kSecond, {0.0, 60.0}, "shorter rests are one boundary in their middle");
  v.Number("longest", longest_s, Unit::kSecond, {1.0, 600.0},
           "longest time over which a segment is compared with itself; computing time grows with it");
  v.Number("min_confidence", min_confidence, Unit::kNone, {0.0, 1.0}, "less confident boundaries are none");
  v.Bool("keep_rests", keep_rests, "rests between actions are clips too");
}

void CycleOptions::Declare(OptionVisitor& v) {
  v.Number("shortest", shortest_s, Unit::kSecond, {0.1, 60.0}, "shortest repetition");
  v.Number("longest", longest_s, Unit::kSecond, {0.1, 60.0}, "longest repetition");
}

void ByExampleOptions::Declare(OptionVisitor& v) {
  v.Path("examples", examples, "table clip,begin_s,end_s,label of the marked spans");
  v.Number("join_gap", join_gap_s, Unit::kSecond, {0.0, 60.0}, "found spans nearer to each other are one");
  v.Number("min_confidence", min_confidence, Unit::kNone, {0.0, 1.0}, "less confident spans are left out");
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
           "how the frames of interest are found");
  v.Number("still_speed", still_speed, Unit::kMetrePerSecond, {0.0, 10.0},
           "a frame is still when its fastest joint is slower than this");
  v.Number("moving_speed", moving_speed, Unit::kMetrePerSecond, {0.0, 10.0},
           "a movement begins where still_speed is passed and counts if it gets as fast as this; less than "
           "still_speed: the same as it");
  v.Number("speed_window", speed_window_s, Unit::kSecond, {0.0, 10.0},
           "a speed is the slope of a joint's path over this time: longer is less moved by noise");
  v.Number("margin", margin_s, Unit::kSecond, {0.0, 10.0}, "kept before the first and after the last moving frame");
  v.Number("min_length", min_length_s, Unit::kSecond, {0.0, 3600.0},
           "shorter clips are dropped, with a reason; 0 s keeps single frames");
  v.Texts("drop_labels", drop_labels, "annotated segments of these labels are left out");
  v.Path("spans", spans,
         "table clip,begin_s,end_s,label, or a list of HumanAct12's names; its spans replace the annotated segments of "
         "the clips that it names");
  v.Text("spans_of", spans_of, "the same from a table that mocurate has, where `spans` names no file: humanact12");
  v.Choice("class_from", class_from, {{"label", ClassFrom::kLabel}, {"category", ClassFrom::kCategory}},
           "what of a segment is the class of its clip; with category (of several the first) its label is the fine "
           "label, as it "
           "is of listed spans with a fine label");
  v.Bool("as_segments", as_segments,
         "recordings stay whole and what would be cut becomes their segments (origin proposed), for `mocurate review "
         "--annotate`; not with rule: triples");
  v.Group("triples", triples, "with rule: triples, samples of two actions and the transition between them");
  v.Group("change_points", change_points, "with rule: change_points, what is done one after the other");
  v.Group("cycles", cycles, "with rule: cycles, repetitions of an exercise");
  v.Group("by_example", by_example, "with rule: by_example, spans like marked ones");
}

void GivenRotationOptions::Declare(OptionVisitor& v) {
  v.Texts("persons", persons, "whose clips it turns; empty: everybody's");
  v.Texts("views", views, "of which cameras; empty: all");
  v.Numbers("rotation", rotation, Unit::kNone, {-1.001, 1.001},
            "matrix canonical_from_source, 9 numbers row by row, in the axes of ingest.source.axes");
}

void FacingOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule,
           {{"none", FacingRule::kNone},
            {"origin", FacingRule::kOrigin},
            {"hips", FacingRule::kHips},
            {"euler", FacingRule::kEuler},
            {"twist", FacingRule::kTwist},
            {"zero", FacingRule::kZero},
            {"given", FacingRule::kGiven}},
           "what the world is turned by: nothing moves (none), only the root goes to the origin (origin), the person "
           "faces +z by the hip axis (hips), by ZYX Euler angles as MultiAct's code (euler) or by the turn about the "
           "vertical (twist), the root's rotation is undone (zero), or by facing.given");
  v.Choice("anchor", anchor,
           {{"first", Anchor::kFirst},
            {"middle", Anchor::kMiddle},
            {"last", Anchor::kLast},
            {"first_segment", Anchor::kFirstSegment},
            {"frame", Anchor::kFrame}},
           "frame whose root goes to the origin and faces +z; first_segment: the last one of the first segment");
  v.Integer("anchor_frame", anchor_frame, {0.0, 1e9}, "with anchor: frame, counted from 0");
  v.Choice("height", height, {{"root", HeightOrigin::kRoot}, {"floor", HeightOrigin::kFloor}},
           "height of the origin: the anchor's root, or y = 0 (the floor, where canon.level finds it)");
  v.Number("min_horizontal", min_horizontal, Unit::kNone, {0.01, 1.0},
           "below this horizontal part of what yaw is read from the clip is flagged; of rule hips the forward axis "
           "decides");
  v.List("given", given, "with rule: given, rotations by person or view");
}

void LevelOptions::Declare(OptionVisitor& v) {
  v.Choice("rule", rule, {{"none", FloorRule::kNone}, {"height", FloorRule::kHeight}, {"tilt", FloorRule::kTilt}},
           "none; the floor under standing feet comes to y = 0 (height); and a tilted sensor is levelled (tilt)");
  v.Choice(
      "of", of,
      {{"set", LevelOf::kSet},
       {"session", LevelOf::kSession},
       {"view", LevelOf::kView},
       {"person", LevelOf::kPerson},
       {"clip", LevelOf::kClip}},
      "whose clips share a floor: all, those of a person's session, of a view in a session, of a person, or each clip "
      "has its own");
  v.Number("height_sigma", height_sigma, Unit::kMetre, {1e-4, 1.0}, "standard deviation of a standing foot's height");
  v.Number("body_sigma", body_sigma, Unit::kRadian, {1e-3, 1.0},
           "standard deviation of a standing person's axis around the vertical");
  v.Number("lean_sigma", lean_sigma, Unit::kRadian, {1e-4, 1.0},
           "prior standard deviation of the lean that standing people have in common");
  v.Integer("most_clips", most_clips, {1.0, 1e6}, "clips that a floor is estimated from, drawn by hash of their ids");
}

void CanonOptions::Declare(OptionVisitor& v) {
  v.Text("skeleton", skeleton, "skeleton of the joints-only baseline made from unfitted tracks");
  v.Group("trim", trim, "frames of interest");
  v.Group("level", level, "the floor");
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
  v.Integer("most_per_label", most_per_label, {0.0, 1e9},
            "clips of a label that a part takes at most, drawn by hash of their ids; 0: all. None is repeated to fill");
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

StageDeclaration LevelDeclaration() { return {"level", 2, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration CanonDeclaration() { return {"canon", 17, "mocurate-annotate", ClipLimits()}; }
StageDeclaration AssembleDeclaration() { return {"assemble", 13, "mocurate-annotate", WholeSetLimits()}; }
StageDeclaration AuditDeclaration() { return {"audit", 3, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
