// Tables and arrays as other programs write them: variants.txt says what comes of each.

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "core/base/text.h"
#include "core/formats/npy.h"
#include "core/formats/npz.h"
#include "core/formats/pickle_writer.h"
#include "ingest/formats/joint_table.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/read_motions.h"
#include "ingest/sources/ntu_people.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"
#include "tests/support/swinging_clips.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Names = std::vector<std::string>;
using ::testing::Contains;
using ::testing::IsEmpty;

constexpr int kFrames = 60;

/// A walk of the 25 joints of NTU, y up, metres: left is +x.
const Motion& Walk() {
  static const Clip clip =
      Swinging(LoadSkeleton("ntu25").value(), StudioTake("anna", "walk", 0, kFrames), "walk", 0.4, 0.15);
  return *clip.motion;
}

/// A point with three decimals, as it stands in a file.
Vector3d PointOf(int frame, const std::string& joint) {
  const Vector3d point = Walk().joints.at(frame, *Walk().skeleton->FindJoint(joint));
  return (1000.0 * point).array().round() / 1000.0;
}

Names SwappedSides(Names names) {
  for (std::string& name : names) {
    if (name.rfind("left", 0) == 0)
      name = "right" + name.substr(4);
    else if (name.rfind("right", 0) == 0)
      name = "left" + name.substr(5);
  }
  return names;
}

Names Shuffled(Names names) {
  std::shuffle(names.begin(), names.end(), std::mt19937(3));
  return names;
}

/// "left_knee" -> "KneeLeft", as Kinect's SDK writes it.
std::string SdkName(const std::string& joint) {
  std::string name, side;
  for (const std::string_view word : SplitText(joint, '_')) {
    std::string capital(word);
    capital[0] = static_cast<char>(capital[0] - 'a' + 'A');
    (word == "left" || word == "right" ? side : name) += capital;
  }
  return name + side;
}

using NameOf = std::function<std::string(const std::string& joint, char axis)>;

/// How a table is written.
struct Style {
  Names joints = NtuJointNames();
  Names lines = {};         ///< of the header
  Names leading = {};       ///< texts before the joints, of each frame
  std::string before = "";  ///< of each joint; "#" is its number
  std::string behind = "";
  std::string end = "";  ///< of each row
  double scale = 1.0;
  char separator = ',';
};

Style Named(Names joints, const NameOf& name) {
  Style style;
  style.joints = std::move(joints);
  Names cells;
  for (const std::string& joint : style.joints) {
    for (const char axis : {'x', 'y', 'z'}) cells.push_back(name(joint, axis));
  }
  style.lines = {JoinTexts(cells, ",")};
  return style;
}

/// A column before the joints: its name, and its text in a frame.
Style Counted(const std::string& name, const std::function<std::string(int)>& number) {
  Style style = Named(NtuJointNames(), [](const std::string& joint, char axis) { return joint + "_" + axis; });
  style.lines[0] = name + "," + style.lines[0];
  for (int f = 0; f < kFrames; ++f) style.leading.push_back(number(f));
  return style;
}

std::string Text(const Style& style) {
  std::string text;
  for (const std::string& line : style.lines) text += line + "\n";
  for (int f = 0; f < kFrames; ++f) {
    std::string row = style.leading.empty() ? "" : style.leading[static_cast<std::size_t>(f)];
    int number = 0;
    for (const std::string& joint : style.joints) {
      const Vector3d point = style.scale * PointOf(f, joint);
      if (style.before == "#") row += (row.empty() ? "" : ",") + std::to_string(number++);
      for (int axis = 0; axis < 3; ++axis) row += (row.empty() ? "" : ",") + FormatDouble(point[axis]);
      row += style.behind;
    }
    row += style.end;
    if (style.separator != ',') std::replace(row.begin(), row.end(), ',', style.separator);
    text += row + "\n";
  }
  return text;
}

std::string Snake(const std::string& joint, char axis) { return joint + "_" + axis; }

/// (frames, joints, 3) of the walk.
NpyArray Points() {
  NpyArray array;
  array.dtype = "<f8";
  array.shape = {kFrames, 25, 3};
  for (int f = 0; f < kFrames; ++f) {
    for (const std::string& joint : NtuJointNames()) {
      const Vector3d point = PointOf(f, joint);
      array.values.insert(array.values.end(), point.data(), point.data() + 3);
    }
  }
  return array;
}

/// The same with its axes in another order.
NpyArray Transposed(const NpyArray& array, const std::array<std::size_t, 3>& axes) {
  NpyArray turned = array;
  const std::size_t stride[] = {array.shape[1] * array.shape[2], array.shape[2], 1};
  for (std::size_t k = 0; k < 3; ++k) turned.shape[k] = array.shape[axes[k]];
  std::size_t at = 0;
  for (std::size_t a = 0; a < turned.shape[0]; ++a) {
    for (std::size_t b = 0; b < turned.shape[1]; ++b) {
      for (std::size_t c = 0; c < turned.shape[2]; ++c)
        turned.values[at++] = array.values[a * stride[axes[0]] + b * stride[axes[1]] + c * stride[axes[2]]];
    }
  }
  return turned;
}

/// Rotation vectors of a person who moves, as SMPL's programs write them: (frames, columns).
NpyArray RotationVectors(std::size_t columns) {
  NpyArray array;
  array.dtype = "<f8";
  array.shape = {kFrames, columns};
  std::mt19937 random(7);
  std::vector<double> phase, speed;
  for (std::size_t c = 0; c < columns; ++c) {
    phase.push_back(static_cast<double>(random() % 628) / 100.0);
    speed.push_back(0.05 + static_cast<double>(random() % 100) / 500.0);
  }
  for (int f = 0; f < kFrames; ++f) {
    for (std::size_t c = 0; c < columns; ++c) array.values.push_back(0.4 * std::sin(speed[c] * f + phase[c]));
  }
  return array;
}

std::string MdmResultsFile() {
  const NpyArray turned = Transposed(Points(), {1, 2, 0});
  NpyArray motions = turned;
  motions.shape.insert(motions.shape.begin(), 1);
  NpyArray lengths;
  lengths.dtype = "<i8";
  lengths.shape = {1};
  lengths.values = {kFrames};
  PickleWriter writer;
  writer.BeginDict();
  writer.Text("motion");
  writer.Array(motions);
  writer.Text("text");
  writer.BeginList();
  writer.Text("walk");
  writer.End();
  writer.Text("lengths");
  writer.Array(lengths);
  writer.End();
  std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }";
  header += std::string(117 - header.size(), ' ') + "\n";
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + writer.Finish("results").value();
}

/// Name of the file, its bytes and the joints in its order.
struct Variant {
  std::string file, bytes;
  Names joints;
};

std::map<std::string, Variant> Variants() {
  const Names ntu = NtuJointNames();
  std::map<std::string, Variant> variants;
  const auto table = [&](const std::string& name, const Style& style) {
    variants[name] = {name + ".csv", Text(style), style.joints};
  };
  const auto array = [&](const std::string& name, const NpyArray& values) {
    variants[name] = {name + ".npy", WriteNpy(values), ntu};
  };
  table("suffix_lower", Named(ntu, Snake));
  table("suffix_dot_upper", Named(ntu, [](const std::string& joint, char axis) {
          return SdkName(joint) + "." + static_cast<char>(axis - 'a' + 'A');
        }));
  table("blanks_and_colon", Named(ntu, [](std::string joint, char axis) {
          std::replace(joint.begin(), joint.end(), '_', ' ');
          return joint + ":" + axis;
        }));
  table("right_side_first", Named(SwappedSides(ntu), [](const std::string& joint, char axis) {
          return SdkName(joint) + "_" + static_cast<char>(axis - 'a' + 'A');
        }));
  table("shuffled", Named(Shuffled(ntu), Snake));
  table(
      "fifteen_of_openni",
      Named({"head", "neck", "spine_mid", "left_shoulder", "left_elbow", "left_wrist", "right_shoulder", "right_elbow",
             "right_wrist", "left_hip", "left_knee", "left_ankle", "right_hip", "right_knee", "right_ankle"},
            [](const std::string& joint, char axis) { return (joint == "spine_mid" ? "torso" : joint) + "_" + axis; }));
  table("axis_first", Named(ntu, [](const std::string& joint, char axis) { return axis + ("_" + joint); }));
  Style style;
  style.lines = {JoinTexts(ntu, " ")};
  style.separator = ' ';
  table("one_name_a_joint", style);
  table("name_on_three_columns", Named(ntu, [](const std::string& joint, char) { return joint; }));
  table("name_then_empty_cells",
        Named(ntu, [](const std::string& joint, char axis) { return axis == 'x' ? joint : ""; }));
  style = Named(ntu, [](const std::string&, char axis) { return std::string(1, axis); });
  style.lines.insert(style.lines.begin(), JoinTexts(ntu, ",,,") + ",,");
  table("names_above_axes", style);
  style = Named(ntu, [](const std::string& joint, char axis) { return "\"" + joint + "_" + axis + "\""; });
  style.lines[0] = "\xEF\xBB\xBF" + style.lines[0];
  table("quoted_after_byte_mark", style);
  table("camel_sides", Named(ntu, [](const std::string& joint, char axis) {
          std::string name;
          for (const std::string_view word : SplitText(joint, '_')) {
            name +=
                name.empty() ? std::string(word) : static_cast<char>(word[0] - 'a' + 'A') + std::string(word.substr(1));
          }
          return name + static_cast<char>(axis - 'a' + 'A');
        }));
  style = Named(ntu, [](const std::string& joint, char axis) { return joint + "_" + axis + "_mm"; });
  style.scale = 1000.0;
  table("units_mm", style);
  style = Named(ntu, [](const std::string& joint, char axis) { return joint + " " + axis + " [cm]"; });
  style.scale = 100.0;
  table("units_in_brackets", style);
  table("time_seconds", Counted("time_s", [](int f) { return FormatDouble(std::round(1e6 * f / 30.0) / 1e6); }));
  table("time_milliseconds", Counted("Time (ms)", [](int f) { return FormatDouble(std::round(1e3 * f / 30.0)); }));
  table("time_nanoseconds",
        Counted("timestamp_ns", [](int f) { return FormatDouble(1.7e14 + std::round(1e9 * f / 30.0)); }));
  table("frame_column", Counted("frame", [](int f) { return std::to_string(f + 7); }));
  table("frame_and_time", Counted("frame,timestamp (s)", [](int f) {
          return std::to_string(f) + "," + FormatDouble(std::round(1e6 * f / 30.0) / 1e6);
        }));
  style = Style();
  Names cells;
  for (const std::string& joint : ntu) {
    for (const char* word : {"x", "y", "z", "confidence"}) cells.push_back(joint + "_" + word);
  }
  style.lines = {JoinTexts(cells, ",")};
  style.behind = ",0.75";
  table("named_confidence", style);
  style = Style();
  style.before = "#";
  table("index_before_each", style);
  style = Style();
  for (int i = 0; i < 75; ++i) style.end += ",0";
  table("absent_second_person", style);
  style = Style();
  style.behind = ",1";
  table("unnamed_fourth", style);
  style = Style();
  for (int f = 0; f < kFrames; ++f) style.leading.push_back(std::to_string(f + 1));
  table("numbered_rows", style);
  table("axis_in_the_middle", Named(ntu, [](const std::string& joint, char axis) {
          return std::string("Position ") + static_cast<char>(axis - 'a' + 'A') + " " + SdkName(joint);
        }));
  style = Named(ntu, [](const std::string&, char axis) { return std::string(1, axis); });
  style.lines.insert(style.lines.begin(), JoinTexts(ntu, ",,,") + ",,");
  style.lines.push_back(JoinTexts(Names(75, "mm"), ","));
  style.scale = 1000.0;
  table("units_below", style);
  style = Style();
  cells.clear();
  for (const std::string& joint : ntu) {
    for (const char* word : {"X", "Y", "Z", "TrackingState"}) cells.push_back(SdkName(joint) + "_" + word);
  }
  style.lines = {JoinTexts(cells, ",")};
  style.behind = ",2";
  table("tracking_states", style);
  const auto with_words = [&](const std::string& name, const Names& words, const std::string& behind) {
    Style beside;
    Names named;
    for (const std::string& joint : ntu) {
      for (const std::string& word : words) named.push_back(joint + "_" + word);
    }
    beside.lines = {JoinTexts(named, ",")};
    beside.behind = behind;
    table(name, beside);
  };
  with_words("two_confidences", {"x", "y", "z", "score", "visibility"}, ",0.9,0.8");
  with_words("scores_of_hundred", {"x", "y", "z", "score"}, ",87");
  with_words("errors_beside", {"x", "y", "z", "error", "ncams", "score"}, ",2.5,3,0.9");
  style = Named(ntu, [](const std::string&, char axis) { return std::string(1, static_cast<char>(axis - 'a' + 'A')); });
  style.lines[0] = "," + style.lines[0];
  style.lines.insert(style.lines.begin(), "," + JoinTexts(Names(75, "Position"), ","));
  style.lines.insert(style.lines.begin(), "," + JoinTexts(ntu, ",,,") + ",,");
  for (int f = 0; f < kFrames; ++f) style.leading.push_back("1");
  table("line_of_kinds_between", style);
  style = Named(ntu, [](const std::string&, char axis) { return std::string(1, axis); });
  style.lines.insert(style.lines.begin(), "Walking trial 3" + std::string(74, ','));
  table("title_above_axes", style);
  style = Named(ntu, Snake);
  style.lines[0] += ",,,";
  table("trailing_empty_cells", style);
  style = Named(ntu, [](const std::string& joint, char axis) {
    return SdkName(joint) + "." + static_cast<char>(axis - 'a' + 'A') + " (cm)";
  });
  style.scale = 100.0;
  std::string semicolons = Text(style);
  std::replace(semicolons.begin(), semicolons.end(), ',', ';');
  for (std::size_t at = semicolons.find('\n'); at < semicolons.size(); ++at) {
    if (semicolons[at] == '.') semicolons[at] = ',';
  }
  variants["semicolons_and_units"] = {"semicolons_and_units.csv", semicolons, ntu};
  table("pandas_index", Counted("", [](int f) { return std::to_string(f); }));
  table("pandas_tuples",
        Named(ntu, [](const std::string& joint, char axis) { return "\"('" + joint + "', '" + axis + "')\""; }));
  table("pandas_duplicates", Named(ntu, [](const std::string& joint, char axis) {
          return SdkName(joint) + (axis == 'x' ? "" : axis == 'y' ? ".1" : ".2");
        }));
  style = Style();
  cells.clear();
  for (int j = 0; j < 25; ++j) {
    for (const char* axis : {"x", "y", "z"}) cells.push_back("person0_joint" + std::to_string(j) + "_" + axis);
  }
  style.lines = {JoinTexts(cells, ",")};
  table("numbers_with_a_prefix", style);
  style = Named(ntu, [](const std::string& joint, char axis) {
    return SdkName(joint) + "." + static_cast<char>(axis - 'a' + 'A') + " (millimeters)";
  });
  style.scale = 1000.0;
  table("long_units", style);
  table("axis_with_position", Named(ntu, [](const std::string& joint, char axis) {
          return SdkName(joint) + "_" + static_cast<char>(axis - 'a' + 'A') + "position";
        }));
  style = Style();
  style.lines = {JoinTexts(ntu, " ")};
  style.behind = ",1";
  style.separator = ' ';
  table("names_on_four", style);
  NpyArray people = Points();
  people.shape = {kFrames, 1, 25, 3};
  array("people_in_an_axis", people);
  std::string both;
  const std::string one = Text(Style());
  for (const std::string_view row : SplitText(one, '\n')) {
    if (!row.empty()) both += std::string(row) + "," + std::string(row) + "\n";
  }
  variants["second_person_there"] = {"two.csv", both, ntu};
  table("two_dimensions", Named(ntu, [](const std::string& joint, char axis) {
          return axis == 'z' ? joint + "_likelihood" : joint + "_" + axis;
        }));
  table("unknown_names", Named(ntu, [](std::string joint, char axis) {
          std::reverse(joint.begin(), joint.end());
          return joint + "_" + axis;
        }));
  table("half_known_names", Named(ntu, [](const std::string& joint, char axis) {
          return (joint.rfind("left", 0) == 0 ? "wand" + std::to_string(joint.size()) + joint.substr(5) : joint) + "_" +
                 axis;
        }));
  style = Named(ntu, Snake);
  style.lines[0] = style.lines[0].substr(0, style.lines[0].rfind(",right_thumb_x"));
  style.lines[0] = style.lines[0].substr(0, style.lines[0].rfind(','));
  table("names_of_fewer_columns", style);
  table("units_that_differ", Named(ntu, [](const std::string& joint, char axis) {
          return joint + "_" + axis + (joint == "head" ? "_cm" : "_mm");
        }));
  std::string tidy = "frame,joint,x,y,z\n";
  for (int f = 0; f < kFrames; ++f) {
    for (const std::string& joint : ntu) {
      const Vector3d point = PointOf(f, joint);
      tidy += std::to_string(f) + "," + joint + "," + FormatDouble(point[0]) + "," + FormatDouble(point[1]) + "," +
              FormatDouble(point[2]) + "\n";
    }
  }
  variants["joints_in_words"] = {"joints_in_words.csv", tidy, ntu};
  table("times_of_day", Counted("Timestamp", [](int f) { return "2024-05-01T12:00:0" + FormatDouble(f / 60.0); }));
  style = Named(ntu, Snake);
  style.lines[0] += ",label";
  style.end = ",walk";
  table("label_at_the_end", style);
  NpyArray last = Transposed(Points(), {1, 2, 0});
  last.shape.insert(last.shape.begin(), 1);
  array("frames_last", last);
  array("joints_before_frames", Transposed(Points(), {1, 0, 2}));
  variants["smpl_body_pose"] = {"body_pose.npy", WriteNpy(RotationVectors(69)), ntu};
  array("smplh_poses", RotationVectors(156));
  array("smplx_fullpose", RotationVectors(165));
  Npz npz;
  for (const auto& [name, columns] :
       std::map<std::string, std::size_t>{{"body_pose", 69}, {"global_orient", 3}, {"transl", 3}, {"betas", 10}}) {
    NpzMember member;
    member.name = name;
    member.array = RotationVectors(columns);
    npz.members.push_back(std::move(member));
  }
  variants["npz_of_parameters"] = {"wham.npz", EncodeNpz(npz, "wham.npz").value(), ntu};
  variants["mdm_results"] = {"results.npy", MdmResultsFile(), ntu};
  return variants;
}

/// One line of variants.txt.
struct Expectation {
  std::string name, outcome, rate, units, layout;  ///< `rate` is the code of a refused one
};

std::vector<Expectation> Expectations() {
  std::vector<Expectation> all;
  const auto text = ReadFile(fs::path(kSourceFolder) / "tests" / "ingest" / "formats" / "variants.txt");
  EXPECT_TRUE(text);
  for (const std::string_view line : SplitText(*text, '\n')) {
    if (line.empty() || line[0] == '#') continue;
    Names words;
    for (const std::string_view word : SplitBlanks(line)) words.emplace_back(word);
    Expectation one{words[0], words[1], words[2], words.size() > 3 ? words[3] : "", ""};
    for (std::size_t i = 4; i < words.size(); ++i) one.layout += (i == 4 ? "" : " ") + words[i];
    all.push_back(one);
  }
  return all;
}

std::string Key(std::string name) {
  return Walk().skeleton->joints[static_cast<std::size_t>(*Walk().skeleton->FindJoint(name))].name;
}

Names NamesOf(const Json& clip) {
  Names names;
  for (const Json& point : clip.at("first_frame").at("value")) names.push_back(point.value("joint", std::string()));
  return names;
}

class TableVariants : public WrittenFormats {
 protected:
  /// The tracks or joints of a run by what an inspection says.
  void ExpectRunReadsTheSame(const fs::path& file, const Json& clip, const Names& joints) {
    IngestOptions options = SmallArrays(file.parent_path());
    SourceOptions& source = options.source;
    source.files = "{clip}" + file.extension().string();
    const bool table = file.extension() == ".csv";
    source.skeleton = Value(clip, "skeleton");
    source.units = "m";
    if (table) {
      source.format = "joint_table";
      source.layout = clip.at("facts").at("layout");
      for (std::size_t at = 0; (at = source.layout.find(kFillIn)) != std::string::npos;)
        source.layout.replace(at, std::string(kFillIn).size(), "skip");
    }
    source.units = clip.at("units").at("from") == "declared" ? Value(clip, "units").get<std::string>() : "m";
    source.joints = NamesOf(clip);
    source.rate_hz = 30.0;
    const auto read = ReadAllMotions({options, {}});
    ASSERT_TRUE(read) << read.error().Message();
    ASSERT_EQ(read->set.clips.size(), 1u);
    const Motion& motion = *read->set.clips[0].motion;
    ASSERT_EQ(motion.frame_count(), kFrames);
    for (const std::string& joint : joints) {
      const auto at = motion.skeleton->FindJoint(joint);
      ASSERT_TRUE(at) << joint;
      for (const int f : {0, kFrames - 1})
        EXPECT_LT((motion.joints.at(f, *at) - PointOf(f, joint)).norm(), 1e-9) << joint << " " << f;
    }
  }
};

TEST_F(TableVariants, AreReadAsTheyAreOrRefusedWithTheReason) {
  const std::map<std::string, Variant> variants = Variants();
  const std::vector<Expectation> expected = Expectations();
  EXPECT_EQ(variants.size(), expected.size());
  for (const Expectation& one : expected) {
    SCOPED_TRACE(one.name);
    ASSERT_EQ(variants.count(one.name), 1u);
    const Variant& variant = variants.at(one.name);
    const fs::path file = Written(one.name + "/" + variant.file, variant.bytes);
    const Json inspection = InspectPath(file, std::nullopt);
    if (one.outcome == "refused") {
      EXPECT_THAT(Codes(inspection, "error"), Contains(one.rate)) << inspection.at("findings").dump(1);
      continue;
    }
    EXPECT_THAT(Codes(inspection, "error"), IsEmpty()) << inspection.at("findings").dump(1);
    ASSERT_EQ(inspection.at("clips").size(), 1u);
    const Json& clip = inspection.at("clips")[0];
    EXPECT_EQ(Value(clip, "frames"), kFrames);
    Names names;
    for (const std::string& name : NamesOf(clip)) names.push_back(Key(name));
    EXPECT_EQ(names, variant.joints);
    if (one.rate == "-")
      EXPECT_TRUE(Value(clip, "rate_hz").is_null()) << clip.at("rate_hz");
    else
      EXPECT_EQ(Value(clip, "rate_hz"), *ParseDouble(one.rate));
    if (one.units != "?") {
      EXPECT_EQ(Value(clip, "units"), one.units);
      EXPECT_EQ(clip.at("units").at("from"), "declared");
    }
    if (one.layout != "-") {
      EXPECT_EQ(clip.at("facts").at("layout"), one.layout);
    }
    EXPECT_EQ(Value(clip, "up"), "+y");
    EXPECT_NE(Value(clip, "handedness"), "left");
    ExpectRunReadsTheSame(file, clip, variant.joints);
  }
}

/// A declaration beside the names of a header: joints in the order of the columns.
Status Declaring(const Names& header, const Names& joints, const std::string& units = "m") {
  SourceOptions source = SmallArrays(".").source;
  source.format = "joint_table";
  source.skeleton = header.size() == 25 ? "ntu25" : "smpl24";
  source.layout = std::to_string(joints.size()) + "*(x y z)";
  source.joints = joints;
  source.units = units;
  Style style = Named(header, [](const std::string& joint, char axis) { return joint + "_" + axis + "_m"; });
  style.joints = Names(header.size(), "head");
  const auto rows = ReadTableRows(source, Text(style), "t.csv");
  return rows ? Status() : Status(Forward(rows));
}

TEST(TableHeaders, RefuseADeclarationThatTheyContradict) {
  const Names ntu = NtuJointNames();
  EXPECT_TRUE(Declaring(ntu, ntu));
  Names shifted = ntu;
  std::rotate(shifted.begin(), shifted.begin() + 1, shifted.end());
  Names knee = ntu;  // one joint along the leg, as a list that is off by one names it
  std::replace(knee.begin(), knee.end(), std::string("left_knee"), std::string("left_ankle"));
  for (const Names& wrong : {SwappedSides(ntu), shifted, knee}) {
    const Status refused = Declaring(ntu, wrong);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().reason, Reason::kOtherLayout);
  }
  EXPECT_FALSE(Declaring(ntu, ntu, "mm"));
  // Another program's names of the same body.
  const Names mixamo = {"Hips", "Spine",        "Spine1",  "Spine2",      "Neck",
                        "Head", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"};
  const Names smpl = {"pelvis", "spine1",      "spine2",        "spine3",     "neck",
                      "head",   "left_collar", "left_shoulder", "left_elbow", "left_wrist"};
  const Status accepted = Declaring(mixamo, smpl);
  EXPECT_TRUE(accepted) << accepted.error().Message();
}

/// Whatever a header says: an error, or points for every joint of every frame.
TEST(TableHeaders, AreReadOrRefusedHoweverTheyAreChanged) {
  std::mt19937 random(11);
  const std::string letters = "xyzXYZ_., ;:()\"'\t\n#0123abLR";
  std::size_t refused = 0, read = 0;
  for (const auto& [name, variant] : Variants()) {
    if (variant.file.find(".csv") == std::string::npos) continue;
    const std::size_t header = variant.bytes.find_first_of("0123456789", variant.bytes.find('\n'));
    const std::string rows = variant.bytes.substr(0, 6000);  // some frames are enough
    for (int i = 0; i < 12; ++i) {
      std::string changed = rows.substr(0, rows.rfind('\n') + 1);
      for (int edits = 1 + i % 4; edits > 0; --edits) {
        const std::size_t at = random() % std::min(header, changed.size());
        const char letter = letters[random() % letters.size()];
        if (random() % 3 == 0)
          changed.erase(at, 1 + random() % 6);
        else if (random() % 2 == 0)
          changed.insert(at, 1, letter);
        else
          changed[at] = letter;
      }
      const Expected<RawFile> file = ReadRawTable({changed, name + ".csv", name + ".csv"});
      file ? ++read : ++refused;
      if (!file) continue;
      for (const RawClip& clip : file->clips) {
        const auto samples = static_cast<std::size_t>(clip.frames) * static_cast<std::size_t>(clip.joints);
        EXPECT_GT(samples, 0u);
        EXPECT_EQ(clip.positions.empty() ? samples * 3 : clip.positions.xyz.size(), samples * 3);
        EXPECT_TRUE(clip.names.empty() || clip.names.size() == static_cast<std::size_t>(clip.joints));
      }
    }
  }
  EXPECT_GT(read, 100u);
  EXPECT_GT(refused, 50u);
}

}  // namespace
}  // namespace mocurate
