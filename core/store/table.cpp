#include "core/store/table.h"

#include "core/store/rules.h"

namespace mocurate::store {
namespace {

using Shape = std::vector<std::string>;
constexpr FieldType kF4 = FieldType::kFloat32;
constexpr FieldType kF8 = FieldType::kFloat64;
constexpr FieldType kI4 = FieldType::kInt32;
constexpr FieldType kI8 = FieldType::kInt64;
constexpr FieldType kU1 = FieldType::kUint8;
constexpr FieldType kText = FieldType::kText;
constexpr Presence kAlways = Presence::kAlways;
constexpr Presence kOptional = Presence::kOptional;
constexpr Presence kMotion = Presence::kMotion;
constexpr Presence kTree = Presence::kTree;

/// Adds fields below one group, all with the same presence.
class Group {
 public:
  Group(std::vector<Field>& fields, std::string path, Presence presence)
      : fields_(fields), path_(std::move(path)), presence_(presence) {}

  Group& Add(const std::string& name, FieldType type, Shape shape, const std::string& unit, Rule rule,
             const std::string& meaning, std::optional<Presence> own = {}) {
    const Presence presence = own.value_or(presence_);
    fields_.push_back(Field{path_ + "/" + name, type, std::move(shape), unit, presence, std::move(rule), meaning,
                            presence == Presence::kGroup ? path_ : ""});
    return *this;
  }

 private:
  std::vector<Field>& fields_;
  std::string path_;
  Presence presence_;
};

void AddRoot(std::vector<Field>& fields, const std::string& schema, const std::vector<std::string>& kinematics,
             Presence motion) {
  Group(fields, "", kAlways)
      .Add("@schema", kText, {}, "", EqualTo(schema), "what this file is")
      .Add("@kinematics", kText, {}, "", OneOf(kinematics),
           "tree: rotations on the skeleton's tree, joints follow from them; joints: positions only")
      .Add("@units", kText, {}, "", EqualTo("m s rad"), "units of all fields that name no other")
      .Add("@content_sha256", kText, {}, "", Sha256Digits(false),
           "SHA-256 of all other fields of this table, see content_sha256")
      .Add("@skeleton", kText, {}, "", Anything(), "name of the skeleton", motion);
}

void AddSkeleton(std::vector<Field>& fields, const std::string& prefix, Presence presence) {
  const std::string path = prefix + "/skeleton";
  Group(fields, path, presence)
      .Add("names", kText, {"J"}, "", UniqueNames(), "joints; joint 0 is the root")
      .Add("parents", kI4, {"J"}, "", Parents(), "position of the parent")
      .Add("rest_offsets", kF8, {"J", "3"}, "m", Finite(), "from the parent in the rest pose, y up, facing +z")
      .Add("mirror", kI4, {"J"}, "", MirrorPartners(), "partner on the other side, itself on the midline")
      .Add("radius", kF8, {"J"}, "m", AtLeast(0), "capsule of the bone that ends at the joint")
      .Add("surface_point", kU1, {"J"}, "", InRange(0, 1), "1: a point on the surface kept as a joint, never rotates");
  Group(fields, path + "/reflections", Presence::kGroup)
      .Add("joint", kI4, {"R"}, "", RowOf("/skeleton/names"), "joint whose reflection is given")
      .Add("matrix", kF8, {"R", "3", "3"}, "", Finite(),
           "frame of the mirror partner from the joint's, in a mirror image");
  Group(fields, path + "/synonyms", Presence::kGroup)
      .Add("joint", kI4, {"Y"}, "", RowOf("/skeleton/names"), "joint that has another name")
      .Add("name", kText, {"Y"}, "", NotEmpty(), "the other name");
  Group(fields, path + "/limits", Presence::kGroup)
      .Add("given", kU1, {"J"}, "", InRange(0, 1), "1 for joints with limits")
      .Add("min", kF8, {"J", "3"}, "rad", Finite(), "least rotation vector, in the frame of the rest pose")
      .Add("max", kF8, {"J", "3"}, "rad", NotBelow("min"), "greatest rotation vector");
  Group(fields, path + "/landmarks", Presence::kGroup)
      .Add("name", kText, {"M"}, "", UniqueNames(), "points that are not joints of the tree")
      .Add("joint", kI4, {"M"}, "", RowOf("/skeleton/names"), "joint they are fixed to")
      .Add("offset", kF8, {"M", "3"}, "m", Finite(), "in the joint's frame, rest pose");
  Group(fields, path + "/lie", Presence::kGroup)
      .Add("chain_length", kI4, {"H"}, "", ChainLengths(), "joints of each Lie chain")
      .Add("chain_joint", kI4, {"Q"}, "", RowOf("/skeleton/names"), "joints of the chains, one chain after the other")
      .Add("raw_offset", kF8, {"J", "3"}, "", Finite(), "unit direction of the bone, zero for the root");
}

void AddFrames(std::vector<Field>& fields, const std::string& prefix, Presence presence) {
  Group(fields, prefix + "/frames", presence)
      .Add("root_translation", kF4, {"F", "3"}, "m", Finite(), "of joint 0 in the world", kTree)
      .Add("rotation", kF4, {"F", "J", "4"}, "", UnitQuaternion(1e-5), "parent_from_joint; world_from_root", kTree)
      .Add("joints", kF4, {"F", "J", "3"}, "m", ForwardKinematicsJoints(), "positions in the world")
      .Add("state", kU1, {"F", "J"}, "", InRange(0, 3), "0 observed, 1 repaired, 2 interpolated, 3 inferred", kOptional)
      .Add("position_cov", kF4, {"F", "J", "6"}, "m2", Covariance(), "xx xy xz yy yz zz", kOptional)
      .Add("rotation_sigma", kF4, {"F", "J", "3"}, "rad", AtLeast(0),
           "standard deviation about the axes of the joint; at most 1.81 of the root, 1 of hips, knees, shoulders and "
           "elbows, 0.2 to 0.4 of others: the spread of postures without evidence",
           kOptional)
      .Add("rotation_observed", kF4, {"F", "J", "3"}, "", AtMost(1), "1 - posterior/prior variance", kOptional)
      .Add("contact", kU1, {"F", "2"}, "", InRange(0, 1), "left and right foot on the floor", kOptional);
}

/// Where each clip's frames lie. `rows` is "C", or "1" in a file of one clip.
void AddSpans(std::vector<Field>& fields, const std::string& prefix, const std::string& rows, Presence presence) {
  Group(fields, prefix + "/clips", presence)
      .Add("offset", kI8, {rows}, "frames", OffsetsTileFrames(), "first row of the clip in /frames")
      .Add("count", kI8, {rows}, "frames", AtLeast(1), "rows of the clip in /frames")
      .Add("field_mask", kU1, {rows}, "bits", OptionalFieldMask(),
           "which optional fields of /frames the clip has: 1 state, 2 position_cov, 4 rotation_sigma, 8 "
           "rotation_observed, "
           "16 contact; rows of others are zero")
      .Add("bone_length", kF8, {rows, "J"}, "m", AtLeast(0), "length of the person's bone that ends at the joint",
           kTree);
  Group(fields, prefix + "/clips", presence)
      .Add("rest_offset", kF8, {rows, "J", "3"}, "m", Finite(),
           "rest offsets of the person, in place of /skeleton/rest_offsets: only directions matter, lengths are "
           "bone_length; rotations are relative to the pose of /skeleton/rest_offsets",
           kOptional);
}

void AddClips(std::vector<Field>& fields, const std::string& rows) {
  Group(fields, "/clips", kAlways)
      .Add("id", kText, {rows}, "", SortedIds(), "source/person/recording#begin-end")
      .Add("source", kText, {rows}, "", Anything(), "data set the clip comes from")
      .Add("person", kText, {rows}, "", Anything(), "who moves")
      .Add("recording", kText, {rows}, "", Anything(), "take")
      .Add("begin_frame", kI4, {rows}, "frames", AtLeast(0), "span in the recording, [begin, end)")
      .Add("end_frame", kI4, {rows}, "frames", NotBelow("begin_frame"), "span in the recording, [begin, end)")
      .Add("session", kText, {rows}, "", Anything(), "session, or empty")
      .Add("view", kText, {rows}, "", Anything(), "camera, or empty")
      .Add("licence", kText, {rows}, "", Anything(), "of the source")
      .Add("role", kText, {rows}, "", Anything(), "train, test or empty, as the source declares it")
      .Add("label", kText, {rows}, "", Anything(), "of the whole clip, or empty")
      .Add("rate", kText, {rows}, "Hz", RateText(), "frames per second as a fraction: 30, 120000/1001")
      .Add("fit_rms", kF8, {rows}, "m", AtLeast(0), "residual of the fit; 0 if not fitted")
      .Add("canonical_from_source", kF8, {rows, "7"}, "m", UnitQuaternion(1e-6), "w x y z, then translation")
      .Add("provenance", kText, {rows}, "", JsonTexts(), "JSON object of texts; bytes that are not UTF-8 as \\xNN")
      .Add("evidence_sha256", kText, {rows}, "", Anything(),
           "SHA-256 of the files that the evidence was read from (source file, depth images, clouds), or empty");
  Group(fields, "/clips", Presence::kOptional)
      .Add("fine_label", kText, {rows}, "", Anything(), "finer label of the whole clip, or empty");
  Group(fields, "/segments", Presence::kGroup)
      .Add("clip", kI4, {"S"}, "", RowOf("/clips/id"), "row of the clip")
      .Add("begin_s", kF8, {"S"}, "s", Finite(), "from the clip's first frame")
      .Add("end_s", kF8, {"S"}, "s", NotBelow("begin_s"), "from the clip's first frame, not included")
      .Add("label", kText, {"S"}, "", Anything(), "what happens")
      .Add("category", kText, {"S"}, "", Anything(), "coarser class, or empty")
      .Add("origin", kText, {"S"}, "", Anything(), "annotated, measured, file_name");
}

void AddDatasetParts(std::vector<Field>& fields) {
  Group(fields, "", kAlways)
      .Add("@rate", kText, {}, "Hz", RateOfClips(), "the rate of every clip, or mixed")
      .Add("@axes", kText, {}, "", AxesText(), "where +x +y +z point; +x +y +z is canonical: y up, facing +z")
      .Add("@created_by", kText, {}, "", Anything(), "program and version")
      .Add("recipe", kText, {}, "", Anything(), "configuration that made the file");
  Group(fields, "", Presence::kOptional)
      .Add("about", kText, {}, "", JsonTexts(),
           "JSON object of texts; origin: what height 0 of the clips is, as in their provenance: root (of the anchor "
           "frame), floor (as measured), source_height (as recorded), source (nothing moved), or mixed");
  Group(fields, "/clips", kAlways)
      .Add("class", kI4, {"C"}, "", ClassOfLabel(), "row of the clip's label in /labels, -1 if it is not there");
  Group(fields, "/clips", Presence::kOptional)
      .Add("fine_class", kI4, {"C"}, "", RowOf("/fine_labels/name", true), "row in /fine_labels, -1 without one");
  Group(fields, "/labels", Presence::kGroup)
      .Add("name", kText, {"L"}, "", UniqueNames(), "classes in the recipe's order; class index is the position");
  Group(fields, "/fine_labels", Presence::kGroup)
      .Add("name", kText, {"P"}, "", UniqueNames(), "fine labels; fine class index is the position")
      .Add("parent", kI4, {"P"}, "", RowOf("/labels/name"), "class that the fine label is part of");
  Group(fields, "/splits/*", Presence::kGroup)
      .Add("train", kI4, {"*"}, "", SplitRows(), "clip rows")
      .Add("validation", kI4, {"*"}, "", SplitRows(), "clip rows")
      .Add("test", kI4, {"*"}, "", SplitRows(), "clip rows")
      .Add("rule", kText, {}, "", Anything(), "how the split was made")
      .Add("leak_check", kText, {}, "", Anything(), "what the leak check found");
}

void AddFindings(std::vector<Field>& fields) {
  Group(fields, "/findings", Presence::kGroup)
      .Add("clip", kText, {"N"}, "", Anything(), "clip id; may be of a clip that was dropped")
      .Add("frame_begin", kI4, {"N"}, "frames", Anything(), "[begin, end) of the clip; 0, 0 is the whole clip")
      .Add("frame_end", kI4, {"N"}, "frames", NotBelow("frame_begin"), "[begin, end) of the clip")
      .Add("joint", kText, {"N"}, "", Anything(), "joint name, or empty")
      .Add("code", kText, {"N"}, "", NotEmpty(), "stable text")
      .Add("severity", kText, {"N"}, "", OneOf({"info", "warning", "error"}), "severity")
      .Add("value", kF8, {"N"}, "given in the message", Finite(), "measured number")
      .Add("message", kText, {"N"}, "", Anything(), "explains the value")
      .Add("action", kText, {"N"}, "", Anything(), "what was done about it");
}

void AddEvidence(std::vector<Field>& fields) {
  Group(fields, "/tracks", Presence::kGroup)
      .Add("names", kText, {"K"}, "", Anything(), "tracked points, names of the source")
      .Add("time_s", kF8, {"T"}, "s", Rising(), "time of each frame")
      .Add("positions", kF8, {"T", "K", "3"}, "m", Finite(), "in the world; meaningless where confidence is 0")
      .Add("confidence", kF8, {"T", "K"}, "", InRange(0, 1), "0: not observed");
  Group(fields, "/track_rotations", Presence::kGroup)
      .Add("rotation", kF8, {"T", "K", "4"}, "", UnitQuaternion(1e-6),
           "world_from_point as recorded; meaningless where confidence is 0")
      .Add("confidence", kF8, {"T", "K"}, "", InRange(0, 1), "0: not recorded");
  Group(fields, "/depth", Presence::kGroup)
      .Add("camera", kText, {"V"}, "", Anything(), "name of each view")
      .Add("width", kI4, {"V"}, "px", AtLeast(0), "of the image")
      .Add("height", kI4, {"V"}, "px", AtLeast(0), "of the image")
      .Add("intrinsics", kF8, {"V", "4"}, "px", Finite(), "fx fy cx cy; the centre of the first pixel is (0, 0)")
      .Add("distortion", kF8, {"V", "5"}, "", Finite(), "k1 k2 p1 p2 k3 (OpenCV)")
      .Add("camera_from_world", kF8, {"V", "7"}, "m", UnitQuaternion(1e-6), "w x y z, then translation")
      .Add("metres_per_unit", kF8, {"V"}, "m", AtLeast(0), "depth of one unit of the images")
      .Add("count", kI8, {"V"}, "", ViewCounts("/depth/path"), "images of each view")
      .Add("path", kText, {"D"}, "", Anything(),
           "16-bit PNG files of view 0, then view 1, ...; paths as raw bytes of the system; empty: no image at that "
           "time")
      .Add("sha256", kText, {"D"}, "", Sha256Digits(true), "of the file, or empty")
      .Add("time_s", kF8, {"D"}, "s", RisingPerView(), "time of each image");
  Group(fields, "/depth_masks", Presence::kGroup)
      .Add("path", kText, {"D"}, "", Anything(),
           "8-bit PNG or JPEG per depth image, 128 and more where the person is; empty: the image has none")
      .Add("sha256", kText, {"D"}, "", Sha256Digits(true), "of the file, or empty");
  Group(fields, "/clouds", Presence::kGroup)
      .Add("path", kText, {"G"}, "", Anything(),
           "PLY or PCD file of each frame; paths as raw bytes of the system; empty: no cloud at that frame")
      .Add("sha256", kText, {"G"}, "", Sha256Digits(true), "of the file, or empty")
      .Add("time_s", kF8, {"G"}, "s", Rising(), "time of each frame")
      .Add("metres_per_unit", kF8, {"1"}, "m", NotZero(),
           "of the files' coordinates; negative: their axes are left-handed")
      .Add("world_from_file", kF8, {"1", "7"}, "m", UnitQuaternion(1e-6),
           "w x y z, then translation, of a file's point times metres_per_unit");
  Group(fields, "/keypoints", Presence::kGroup)
      .Add("names", kText, {"E"}, "", UniqueNames(), "points of the detector's layout")
      .Add("subject", kI4, {"1"}, "", AtLeast(0),
           "person of the clip among the observed people, ordered by presence; 0: the most present")
      .Add("camera", kText, {"W"}, "", UniqueNames(), "name of each view")
      .Add("width", kI4, {"W"}, "px", AtLeast(0), "of the image; 0: not known")
      .Add("height", kI4, {"W"}, "px", AtLeast(0), "of the image; 0: not known")
      .Add("intrinsics", kF8, {"W", "4"}, "px", Finite(), "fx fy cx cy; the centre of the first pixel is (0, 0)")
      .Add("distortion", kF8, {"W", "5"}, "", Finite(), "k1 k2 p1 p2 k3 (OpenCV)")
      .Add("camera_from_world", kF8, {"W", "7"}, "m", UnitQuaternion(1e-6), "w x y z, then translation")
      .Add("people", kI4, {"W"}, "", AtLeast(0), "rows (people) per image of the view in /keypoints/values")
      .Add("count", kI8, {"W"}, "", ViewCounts("/keypoints/time_s"), "images of each view")
      .Add("time_s", kF8, {"I"}, "s", RisingPerView(), "time of each image of view 0, then view 1, ...")
      .Add("values", kF8, {"U", "E", "3"}, "px", KeypointValues(),
           "u, v with the lens's distortion, and a confidence without unit, 0: not detected; a row per person of an "
           "image, "
           "in no particular order");
}

Schema MakeDatasetSchema() {
  Schema schema{"mocurate/1",
                "A dataset, or a set of generated motions: clips with motion, one skeleton.",
                "",
                {},
                "run CONFIG --to assemble"};
  AddRoot(schema.fields, schema.name, {"tree", "joints"}, kAlways);
  AddSkeleton(schema.fields, "", kAlways);
  AddClips(schema.fields, "C");
  AddSpans(schema.fields, "", "C", kAlways);
  AddFrames(schema.fields, "", kAlways);
  AddDatasetParts(schema.fields);
  AddFindings(schema.fields);
  return schema;
}

Schema MakeEvidenceSchema() {
  Schema schema{"mocurate-evidence/1",
                "One clip with its evidence, and the motion it has (given, or fitted).",
                "",
                {},
                "run CONFIG"};
  AddRoot(schema.fields, schema.name, {"none", "tree", "joints"}, kMotion);
  AddClips(schema.fields, "1");
  AddEvidence(schema.fields);
  AddFindings(schema.fields);
  AddSkeleton(schema.fields, "", kMotion);
  AddSpans(schema.fields, "", "1", kMotion);
  AddFrames(schema.fields, "", kMotion);
  return schema;
}

Schema MakeTruthSchema() {
  Schema schema{"mocurate-truth/1", "True motion of a synthetic capture, by clip id.", "/truth", {}, "run CONFIG"};
  AddRoot(schema.fields, schema.name, {"none", "tree", "joints"}, kMotion);
  AddSkeleton(schema.fields, "/truth", kMotion);
  Group(schema.fields, "/truth/clips", kMotion)
      .Add("id", kText, {"C"}, "", SortedIds(), "source/person/recording#begin-end")
      .Add("rate", kText, {"C"}, "Hz", RateText(), "frames per second as a fraction");
  AddSpans(schema.fields, "/truth", "C", kMotion);
  AddFrames(schema.fields, "/truth", kMotion);
  return schema;
}

Schema MakeFeatureSchema() {
  Schema schema{"mocurate-features/1",
                "Outputs of a recogniser for a set of motions, from which metrics are computed.",
                "",
                {},
                "eval -o"};
  Group(schema.fields, "", kAlways)
      .Add("@schema", kText, {}, "", EqualTo(schema.name), "what this file is")
      .Add("@units", kText, {}, "", EqualTo("m s rad"), "units of all fields that name no other")
      .Add("@content_sha256", kText, {}, "", Sha256Digits(false),
           "SHA-256 of all other fields of this table, see content_sha256")
      .Add("features", kF4, {"X", "Z"}, "", Finite(), "features of each motion: output of the layer before the logits")
      .Add("logits", kF4, {"X", "B"}, "", Finite(), "of each motion and class")
      .Add("label", kI4, {"X"}, "", RowOf("/classes", true), "intended class of the motion, -1 if not known")
      .Add("clip", kText, {"X"}, "", Anything(), "clip id")
      .Add("classes", kText, {"B"}, "", UniqueNames(), "of the recogniser; class index is the position")
      .Add("pass_begin", kI8, {"O"}, "", AtLeast(0), "first row of each pass over the set; passes draw anew")
      .Add("about", kText, {}, "", JsonTexts(), "JSON: extractor, weights, draws");
  const Rule measured = AtLeast(-1);
  Group(schema.fields, "/quality", kOptional)
      .Add("foot_skate", kF8, {"X"}, "m/s", measured, "horizontal speed of the feet while they are on the floor")
      .Add("floor_penetration", kF8, {"X"}, "m", measured,
           "mean depth of the lowest foot below the floor, -1: no floor")
      .Add("jerk", kF8, {"X"}, "m/s^3", measured, "root mean square third derivative of joint positions")
      .Add("bone_spread", kF8, {"X"}, "m", measured, "standard deviation of bone lengths over time, mean of the bones")
      .Add("limit_violations", kF8, {"X"}, "", measured, "share of rotations beyond the joint limits, -1: no rotations")
      .Add("frozen_share", kF8, {"X"}, "", measured, "share of frames equal to the one before")
      .Add("movement", kF8, {"X"}, "m/s", measured, "mean speed of the joints")
      .Add("peak_jerk", kF8, {"X"}, "m/s^3", measured, "largest jerk of a joint in any frame, of a transition")
      .Add("jerk_area", kF8, {"X"}, "m/s^2", measured,
           "integral over time of the largest jerk of a joint, of a transition")
      .Add("mbench_slide", kF8, {"X"}, "mm", measured, "horizontal step of the feet in contact, a frame (MBench)")
      .Add("mbench_float", kF8, {"X"}, "", measured, "share of frames in which a foot moves with the root (MBench)")
      .Add("mbench_jitter", kF8, {"X"}, "mm", measured, "second difference of the joints, a frame^2 (MBench)")
      .Add("mbench_dynamic", kF8, {"X"}, "mm", measured, "first difference of the joints, a frame (MBench)")
      .Add("mbench_penetration", kF8, {"X"}, "mm", measured,
           "mean depth of feet more than 5 mm below the lowest one: 0 (MBench)");
  return schema;
}

}  // namespace

const Schema& FeatureSchema() {
  static const Schema schema = MakeFeatureSchema();
  return schema;
}

const Schema& DatasetSchema() {
  static const Schema schema = MakeDatasetSchema();
  return schema;
}

const Schema& EvidenceSchema() {
  static const Schema schema = MakeEvidenceSchema();
  return schema;
}

const Schema& TruthSchema() {
  static const Schema schema = MakeTruthSchema();
  return schema;
}

std::vector<const Schema*> AllSchemas() {
  return {&DatasetSchema(), &EvidenceSchema(), &TruthSchema(), &FeatureSchema()};
}

}  // namespace mocurate::store
