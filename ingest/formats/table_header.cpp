#include "ingest/formats/table_header.h"

#include <algorithm>
#include <array>
#include <set>

#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "core/formats/row_counter.h"
#include "core/motion/skeleton.h"
#include "ingest/inspect/joint_orders.h"

namespace mocurate {
namespace {

using Words = std::vector<std::string>;

constexpr std::size_t kManyPassedOver = 4;  // columns on end
constexpr std::size_t kFewestNames = 3;     // of joints, for a header to be one of joints

bool IsOneOf(const std::string& word, const char* words) {
  for (const std::string_view known : SplitBlanks(words)) {
    if (word == known) return true;
  }
  return false;
}

constexpr const char* kAxes = "x y z";
constexpr std::pair<const char*, const char*> kUnits[] = {{"m", "m meter meters metre metres"},
                                                          {"cm", "cm centimeter centimeters centimetre centimetres"},
                                                          {"mm", "mm millimeter millimeters millimetre millimetres"},
                                                          {"inch", "in inch inches"}};
constexpr const char* kPlace = "pos position positions loc location coord coords coordinate world global translation";
constexpr const char* kConfidence = "c conf confidence score likelihood prob probability visibility";
constexpr const char* kOther =
    "w qx qy qz qw rx ry rz roll pitch yaw state tracking tracked rot rotation orientation orient quat quaternion "
    "euler "
    "angle angles vel velocity speed acc accel acceleration force moment emg err error std stdev var sigma gyr gyro "
    "imu "
    "mag delta diff normal normals noise";

/// The short name of a unit of length; empty: it is none.
std::string UnitOf(const std::string& word) {
  for (const auto& [unit, names] : kUnits) {
    if (IsOneOf(word, names)) return unit;
  }
  return "";
}

bool IsNameDigit(char c) { return c >= '0' && c <= '9'; }
bool IsCapital(char c) { return c >= 'A' && c <= 'Z'; }
bool IsNameLetter(char c) { return IsCapital(c) || (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80; }

std::string Lower(std::string text) {
  for (char& c : text) c = IsCapital(c) ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// Words between what is no letter or digit, and before a capital behind a small letter or digit.
Words WordsOf(std::string_view text) {
  Words words;
  char before = ' ';
  for (const char c : text) {
    const bool inside = IsNameLetter(c) || IsNameDigit(c);
    const bool begins = !(IsNameLetter(before) || IsNameDigit(before)) || (IsCapital(c) && !IsCapital(before));
    if (inside && begins) words.emplace_back();
    if (inside) words.back() += c;
    before = c;
  }
  return words;
}

/// Lower case, letters and digits alone.
std::string PlainName(std::string_view text) {
  std::string plain;
  for (const std::string& word : WordsOf(text)) plain += Lower(word);
  return plain;
}

/// Without digits, to see which names differ by their numbers alone.
std::string WithoutDigits(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), IsNameDigit), text.end());
  return text;
}

/// Takes a text in brackets off the end: "left_knee_x [mm]".
std::string TakeBracket(std::string_view& cell) {
  const std::size_t open = cell.find_last_of("([");
  if (open == std::string_view::npos || (cell.back() != ')' && cell.back() != ']')) return "";
  const std::string inside = Lower(std::string(Trim(cell.substr(open + 1, cell.size() - open - 2))));
  std::string unit = UnitOf(inside);
  if (!unit.empty()) cell = Trim(cell.substr(0, open));
  return unit;
}

/// The axis of "posx", "xpos", "Xposition", "px" and "tx"; else empty.
std::string AxisBesidePlace(const std::string& word) {
  if (word.size() == 2 && IsOneOf(word, "px py pz tx ty tz")) return word.substr(1);
  if (word.size() < 4) return "";
  if (IsOneOf(word.substr(0, 1), kAxes) && IsOneOf(word.substr(1), kPlace)) return word.substr(0, 1);
  const std::string end = word.substr(word.size() - 1);
  return IsOneOf(end, kAxes) && IsOneOf(word.substr(0, word.size() - 1), kPlace) ? end : "";
}

/// Joint, word and unit of one cell; the word is empty where the cell is a name alone.
HeaderColumn ColumnOfCell(const std::string& cell) {
  HeaderColumn column;
  column.cell = cell;
  std::string_view text = Trim(cell);
  column.unit = TakeBracket(text);
  Words words = WordsOf(text);
  const auto last = [&] { return words.empty() ? std::string() : Lower(words.back()); };
  if (words.size() > 1 && column.unit.empty() && !UnitOf(last()).empty() &&
      IsOneOf(Lower(words[words.size() - 2]), kAxes)) {
    column.unit = UnitOf(last());
    words.pop_back();
  }
  const std::string end = last();
  const std::string joined = AxisBesidePlace(end);
  if (IsOneOf(end, kAxes) || IsOneOf(joined, kAxes)) {
    column.word = joined.empty() ? end : joined;
    words.pop_back();
  } else if (IsOneOf(end, kConfidence) && words.size() > 1) {
    column.word = "confidence";
    words.pop_back();
  } else if (IsOneOf(end, kOther) && words.size() > 1) {
    column.word = "skip";
    words.pop_back();
  } else if (words.size() > 1) {  // the one axis among the words: "x_left_knee", "Position X left knee"
    const auto is_axis = [](const std::string& word) { return IsOneOf(Lower(word), kAxes); };
    const auto axis = std::find_if(words.begin(), words.end(), is_axis);
    if (std::count_if(words.begin(), words.end(), is_axis) == 1) {
      column.word = Lower(*axis);
      words.erase(axis);
    }
  }
  while (!words.empty() && IsOneOf(last(), kPlace)) words.pop_back();
  while (words.size() > 1 && !column.word.empty() && IsOneOf(Lower(words[0]), kPlace)) words.erase(words.begin());
  const bool other = std::any_of(words.begin(), words.end(), [](const std::string& word) {
    return word.size() > 1 && IsOneOf(Lower(word), kOther);
  });
  if (other && !column.word.empty()) {
    column.word = "skip";
    words.erase(std::remove_if(words.begin(), words.end(),
                               [](const std::string& word) { return IsOneOf(Lower(word), kOther); }),
                words.end());
  }
  column.joint = JoinTexts(words, "_");
  return column;
}

bool IsCounter(const std::string& cell) {
  const CounterName name = CounterNameOf(cell);
  return name.time || name.frame;
}

/// Normalised names of all joints and landmarks of configs/skeletons and of known orders.
bool IsKnownJoint(const std::string& name) {
  static const std::set<std::string> known = [] {
    std::set<std::string> names;
    for (const std::string& skeleton : SkeletonNames()) {
      const auto loaded = KnownSkeleton(skeleton);
      if (!loaded) continue;
      for (const Joint& joint : (*loaded)->joints) {
        names.insert(PlainName(joint.name));
        for (const std::string& synonym : joint.synonyms) names.insert(PlainName(synonym));
      }
      for (const Landmark& landmark : (*loaded)->landmarks) names.insert(PlainName(landmark.name));
    }
    for (const JointOrder& order : KnownJointOrders()) {
      for (const std::string& joint : order.joints) names.insert(PlainName(joint));
    }
    return names;
  }();
  return known.count(PlainName(name.substr(name.find_last_of(":|") + 1))) > 0;
}

/// Cells that are empty take the name before them.
void FillRight(std::vector<std::string>& cells) {
  for (std::size_t c = 1; c < cells.size(); ++c) {
    if (cells[c].empty()) cells[c] = cells[c - 1];
  }
}

/// Names of a line above the axes, one for each x y z; empty where it is another line: a title, "Position".
std::vector<std::string> NamesAbove(std::vector<std::string> above, const std::vector<HeaderColumn>& columns) {
  while (!above.empty() && above.back().empty()) above.pop_back();
  std::vector<std::size_t> starts;  // of the joints
  std::size_t others = 0;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].word == "x") starts.push_back(c);
    others += IsCounter(columns[c].cell) ? 1 : 0;
  }
  std::vector<std::string> names;
  if (above.size() == starts.size() + others)
    above.erase(above.begin(), above.begin() + static_cast<std::ptrdiff_t>(others));
  if (above.size() == starts.size()) {
    names = above;
  } else if (above.size() <= columns.size() && !starts.empty() && above.size() > starts.back()) {
    above.resize(columns.size());
    FillRight(above);
    for (const std::size_t start : starts) {
      for (std::size_t c = start; c < std::min(start + 3, columns.size()); ++c) {
        if (above[c] != above[start]) return {};
      }
      names.push_back(above[start]);
    }
  }
  const std::set<std::string> different(names.begin(), names.end());
  const auto known = static_cast<std::size_t>(std::count_if(names.begin(), names.end(), IsKnownJoint));
  return different.size() == names.size() && known >= kFewestNames ? names : std::vector<std::string>();
}

/// Names for a line of axes, from the nearest line above that has one for each joint.
void NameFromAbove(const std::vector<std::vector<std::string>>& header, std::vector<HeaderColumn>& columns) {
  for (std::size_t line = header.size() - 1; line-- > 0;) {
    const std::vector<std::string> names = NamesAbove(header[line], columns);
    if (names.empty()) continue;
    std::size_t joint = 0;
    for (HeaderColumn& column : columns) {
      joint += column.word == "x" ? 1 : 0;
      if (joint > 0 && !column.word.empty()) column.joint = names[joint - 1];
    }
    return;
  }
}

/// "LeftKnee.1" behind "LeftKnee", as pandas numbers equal names.
bool IsRepeated(const std::string& cell, const std::string& first) {
  return cell == first || cell.empty() ||
         (cell.size() > first.size() + 1 && cell.compare(0, first.size(), first) == 0 && cell[first.size()] == '.' &&
          cell.find_first_not_of("0123456789", first.size() + 1) == std::string::npos);
}

/// Names that stand on three columns each, or before two empty cells. False where one stands on four: which of them are
/// x, y and z is not said.
bool ReadRuns(std::vector<HeaderColumn>& columns) {
  bool of_four = false;
  for (std::size_t c = 0; c < columns.size();) {
    const std::string first = columns[c].cell;
    std::size_t end = c + 1;
    while (!first.empty() && end < columns.size() && IsRepeated(columns[end].cell, first)) ++end;
    constexpr std::array<const char*, 3> kWords = {"x", "y", "z"};
    const bool joint = end - c == 3 && !IsCounter(first);
    of_four = of_four || (end - c == 4 && IsKnownJoint(first));
    for (std::size_t k = c; k < end; ++k) {
      columns[k].joint = joint ? first : "";
      columns[k].word = joint ? kWords[k - c] : "";
    }
    c = end;
  }
  return !of_four;
}

/// One name for each three numbers, behind names of counters.
std::vector<HeaderColumn> Spread(const std::vector<std::string>& cells, std::size_t columns) {
  std::size_t leading = 0;
  while (leading < cells.size() && IsCounter(cells[leading])) ++leading;
  if (leading + 3 * (cells.size() - leading) != columns) return {};
  std::vector<HeaderColumn> spread;
  for (std::size_t c = 0; c < leading; ++c) spread.push_back({"", "", "", cells[c]});
  for (std::size_t j = leading; j < cells.size(); ++j) {
    for (const char* word : {"x", "y", "z"}) spread.push_back({cells[j], word, "", cells[j]});
  }
  return spread;
}

/// Takes a last line of units off: "mm,mm,mm". (columns), or none.
std::vector<std::string> TakeUnits(std::vector<std::vector<std::string>>& header, std::size_t columns) {
  if (header.size() < 2 || header.back().size() != columns) return {};
  std::vector<std::string> units;
  bool any = false;
  for (const std::string& cell : header.back()) {
    std::string_view text = Trim(cell);
    if (text.size() > 2 && (text.front() == '(' || text.front() == '[')) text = text.substr(1, text.size() - 2);
    const std::string word = Lower(std::string(text));
    units.push_back(UnitOf(word));
    any = any || !units.back().empty();
    if (units.back().empty() && !word.empty() && !IsOneOf(word, "s ms us ns")) return {};
  }
  if (!any) return {};
  header.pop_back();
  return units;
}

/// Columns of the same joint become one group: "nose_error" behind nose_x, nose_y, nose_z is of the nose. Those of no
/// joint that has its place are passed over; before the joints they may count the frames.
void GroupColumns(std::vector<HeaderColumn>& columns) {
  bool begun = false;
  for (std::size_t c = 0; c < columns.size();) {
    const std::string joint = columns[c].joint;
    std::size_t end = c;
    bool placed = false, sure = false;
    for (; end < columns.size(); ++end) {
      HeaderColumn& column = columns[end];
      const bool beside = placed && !IsOneOf(column.word, kAxes) && column.joint.rfind(joint + "_", 0) == 0;
      if (column.joint != joint && !beside) break;
      if (beside) column.joint = joint, column.word = "skip";
      placed = placed || (!joint.empty() && IsOneOf(column.word, kAxes));
      const bool again = column.word == "confidence" && sure;
      if (again || (placed && column.word.empty())) column.word = "skip";
      sure = sure || column.word == "confidence";
    }
    for (std::size_t k = c; k < end && !placed; ++k) {
      columns[k].joint.clear();
      columns[k].word = !begun || IsCounter(columns[k].cell) ? "" : "skip";
    }
    begun = begun || placed;
    c = std::max(end, c + 1);
  }
}

/// Joints that have their x, by a name that is no number.
std::size_t NamedJoints(const std::vector<HeaderColumn>& columns) {
  std::set<std::string> joints, without_digits;
  for (const HeaderColumn& column : columns) {
    if (column.word != "x" || column.joint.empty()) continue;
    joints.insert(column.joint);
    without_digits.insert(WithoutDigits(column.joint));
  }
  const bool numbered = joints.size() > 1 && without_digits.size() == 1;
  return numbered ? 0 : joints.size();
}

/// The joint that a cell names beside other words, "right_shoulder[0]", "x4_right_shoulder"; empty: none.
std::string JointAmong(const std::string& cell) {
  constexpr std::size_t kFewestLetters = 4;  // of a name of one word
  const Words words = WordsOf(cell);
  for (std::size_t count = words.size(); count > 0; --count) {
    for (std::size_t first = 0; first + count <= words.size(); ++first) {
      const auto begin = words.begin() + static_cast<std::ptrdiff_t>(first);
      const std::string name = JoinTexts(Words(begin, begin + static_cast<std::ptrdiff_t>(count)), "_");
      if ((count > 1 || name.size() >= kFewestLetters) && IsKnownJoint(name)) return PlainName(name);
    }
  }
  return "";
}

/// Different joints that cells name, whatever the columns are.
std::size_t JointsNamed(const std::vector<HeaderColumn>& columns) {
  std::set<std::string> joints;
  for (const HeaderColumn& column : columns) joints.insert(JointAmong(column.cell));
  joints.erase("");
  return joints.size();
}

/// The joints or landmarks of a skeleton by their names, each once; empty where one is unknown. `unknown` gets those.
Words JointsIn(const Skeleton& skeleton, const Words& names, Words& unknown) {
  Words joints;
  std::set<std::string> taken;
  for (const std::string& name : NamesIn(skeleton, names)) {
    const auto joint = skeleton.FindJoint(name);
    const auto landmark = std::find_if(skeleton.landmarks.begin(), skeleton.landmarks.end(),
                                       [&](const Landmark& one) { return PlainName(one.name) == PlainName(name); });
    const std::string found = joint ? skeleton.joints[static_cast<std::size_t>(*joint)].name
                              : landmark != skeleton.landmarks.end() ? landmark->name
                                                                     : "";
    if (!found.empty() && taken.insert(found).second)
      joints.push_back(found);
    else
      unknown.push_back(name);
  }
  return unknown.empty() ? joints : Words();
}

tl::unexpected<Error> BadHeader(const std::string& what, const std::string& name, std::string hint) {
  return Fail(ErrorCode::kInconsistent, "the header: " + what, name, std::move(hint), Reason::kOtherLayout);
}

/// Of consecutive columns of one joint.
struct JointColumns {
  std::string joint;
  Words words;
};

std::vector<JointColumns> JointsOf(const std::vector<HeaderColumn>& columns) {
  std::vector<JointColumns> joints;
  std::string before;
  for (const HeaderColumn& column : columns) {
    if (!column.joint.empty() && column.joint != before) joints.push_back({column.joint, {}});
    if (!column.joint.empty()) joints.back().words.push_back(column.word);
    before = column.joint;
  }
  return joints;
}

/// Whether a column of one joint is declared as another. Names of neighbours differ between programs, a hand is a
/// wrist: one is taken for the other where no column has the declared name (`named`: joints of the header). Where the
/// header's names are not those of the skeleton one to one, only the sides count.
bool Contradict(const Skeleton& skeleton, int said, int declared, const std::set<int>& named, bool one_to_one) {
  const Joint &a = skeleton.joints[static_cast<std::size_t>(said)],
              &b = skeleton.joints[static_cast<std::size_t>(declared)];
  if (said == declared) return false;
  const auto side = [](const Joint& joint) { return joint.name.substr(0, joint.name.find('_')); };
  if ((side(a) == "left" && side(b) == "right") || (side(a) == "right" && side(b) == "left")) return true;
  const bool neighbours = a.parent == declared || b.parent == said;
  return one_to_one && (!neighbours || named.count(declared) > 0);
}

}  // namespace

Expected<std::vector<HeaderColumn>> HeaderColumns(std::vector<std::vector<std::string>> header, int columns,
                                                  const std::string& name) {
  const auto wide = static_cast<std::size_t>(columns);
  const std::vector<std::string> units = TakeUnits(header, wide);
  if (header.empty()) return std::vector<HeaderColumn>();
  std::vector<std::string> cells = header.back();
  while (cells.size() > wide && cells.back().empty()) cells.pop_back();  // behind last separators
  std::vector<HeaderColumn> read;
  for (const std::string& cell : cells) {
    read.push_back(IsCounter(cell) ? HeaderColumn{"", "", "", cell} : ColumnOfCell(cell));
  }
  const std::size_t known = JointsNamed(read);
  const bool axes = std::any_of(read.begin(), read.end(), [](const HeaderColumn& c) { return c.word == "x"; });
  const bool named = std::any_of(read.begin(), read.end(),
                                 [](const HeaderColumn& c) { return IsOneOf(c.word, kAxes) && !c.joint.empty(); });
  if (axes && !named) NameFromAbove(header, read);
  if (!axes && cells.size() < wide) read = Spread(cells, wide);
  if (!axes && cells.size() == wide && !ReadRuns(read)) {
    return BadHeader("a name stands on four numbers, and which of them are x, y and z is not said", name,
                     "name every column, as left_knee_x, or remove the header and declare the columns");
  }
  GroupColumns(read);
  if (NamedJoints(read) < kFewestNames) {
    if (known < kFewestNames || axes) return std::vector<HeaderColumn>();
    return BadHeader("it names " + std::to_string(known) + " joints in a form that is not read", name,
                     "name every column, as left_knee_x, or remove the header and declare the columns");
  }
  for (std::size_t c = 0; c < std::min(read.size(), units.size()); ++c) {
    if (IsOneOf(read[c].word, kAxes) && read[c].unit.empty()) read[c].unit = units[c];
  }
  if (read.size() == wide) return read;
  return BadHeader("it names " + Counted(static_cast<long long>(read.size()), "column") + ", the rows have " +
                       Counted(columns, "number"),
                   name, "name every column, or remove the header and declare the columns");
}

Expected<HeaderLayout> LayoutOfHeader(const std::vector<HeaderColumn>& columns, const std::string& name) {
  const std::vector<JointColumns> groups = JointsOf(columns);
  Words names;
  for (const JointColumns& group : groups) {
    const auto times = [&](const char* word) { return std::count(group.words.begin(), group.words.end(), word); };
    if (times("x") + times("y") + times("z") == 0) continue;  // confidences or rotations apart from the place
    if (times("z") == 0 && times("x") == 1 && times("y") == 1) {
      return BadHeader("'" + Shown(group.joint) + "' has x and y, no z", name,
                       "points of an image are read from OpenPose's JSON files (docs/inspect.md)");
    }
    if (times("x") != 1 || times("y") != 1 || times("z") != 1) {
      return BadHeader("x, y and z of '" + Shown(group.joint) + "' do not stand side by side", name,
                       "write the three columns of a joint next to each other");
    }
    names.push_back(group.joint);
  }
  HeaderLayout layout;
  for (const HeaderColumn& column : columns) {
    if (!IsOneOf(column.word, kAxes) || column.unit.empty()) continue;
    if (!layout.units.empty() && layout.units != column.unit) {
      return BadHeader("coordinates in " + layout.units + " and in " + column.unit, name, "write them in one unit");
    }
    layout.units = column.unit;
  }
  Words fewest_unknown;
  std::string nearest;
  int least = 0;
  for (const std::string& candidate : SkeletonNames()) {
    const auto skeleton = KnownSkeleton(candidate);
    if (!skeleton) continue;
    Words unknown;
    const Words joints = JointsIn(**skeleton, names, unknown);
    if (unknown.empty() && (layout.joints.empty() || (*skeleton)->joint_count() < least)) {
      layout.skeleton = (*skeleton)->name;
      layout.joints = joints;
      least = (*skeleton)->joint_count();
    }
    if (nearest.empty() || unknown.size() < fewest_unknown.size()) {
      nearest = (*skeleton)->name;
      fewest_unknown = unknown;
    }
  }
  if (!layout.joints.empty()) return layout;
  return BadHeader("no skeleton has a joint for " + std::to_string(fewest_unknown.size()) + " of its " +
                       std::to_string(names.size()) + " names, at least: " + JoinTexts(fewest_unknown) + " (" +
                       nearest + ")",
                   name,
                   "declare a source: list the joints in the order of the file under ingest.source.joints, '-' for "
                   "what is no joint");
}

std::string LayoutWords(const std::vector<HeaderColumn>& columns, const std::vector<std::string>& words) {
  std::string text;
  std::string group;
  int count = 0;
  const auto close = [&] {
    if (count > 0) text += (text.empty() ? "" : " ") + std::to_string(count) + "*(" + group + ")";
    count = 0;
  };
  for (std::size_t c = 0; c < columns.size();) {
    if (columns[c].joint.empty()) {
      close();
      std::size_t end = c + 1;
      while (words[c] == "skip" && end < columns.size() && columns[end].joint.empty() && words[end] == "skip") ++end;
      const bool many = end - c >= kManyPassedOver;
      for (std::size_t k = many ? end : c; k < end; ++k) text += (text.empty() ? "" : " ") + words[k];
      if (many) text += (text.empty() ? "" : " ") + std::to_string(end - c) + "*(skip)";
      c = end;
      continue;
    }
    Words own;
    const std::string& joint = columns[c].joint;
    for (; c < columns.size() && columns[c].joint == joint; ++c) own.push_back(columns[c].word);
    const std::string joined = JoinTexts(own, " ");
    if (joined != group) close();
    group = joined;
    ++count;
  }
  close();
  return text;
}

Status CheckHeader(const std::vector<HeaderColumn>& columns, const JointLayout& layout, const SourceOptions& source,
                   const std::string& name) {
  if (columns.empty() || static_cast<int>(columns.size()) != layout.NumbersPerFrame()) return {};
  const auto skeleton = KnownSkeleton(source.skeleton);
  if (!skeleton) return {};
  Words names;
  for (const JointColumns& group : JointsOf(columns)) names.push_back(group.joint);
  const Words known = NamesIn(**skeleton, names);
  Words unknown;
  const bool one_to_one = !JointsIn(**skeleton, names, unknown).empty();
  const auto joint_of = [&](const std::string& said) {
    const auto at = std::find(names.begin(), names.end(), said);
    return at == names.end() ? std::optional<int>()
                             : (*skeleton)->FindJoint(known[static_cast<std::size_t>(at - names.begin())]);
  };
  const auto refuse = [&](const std::string& what, const char* option) {
    return BadHeader(what, name, std::string("correct ingest.source.") + option + ", or the header where it is wrong");
  };
  std::set<int> joints;
  for (const std::string& said : names) {
    if (const auto found = joint_of(said)) joints.insert(*found);
  }
  std::size_t c = 0, joint = 0;
  for (const JointGroup& group : layout.groups) {
    for (int i = 0; i < group.count; ++i) {
      for (const JointColumn column : group.columns) {
        if (column <= JointColumn::kZ) {
          const HeaderColumn& said = columns[c];
          const std::string axis(1, "xyz"[static_cast<std::size_t>(column)]);
          const std::string& declared = source.joints[joint];
          if (IsOneOf(said.word, kAxes) && said.word != axis)
            return refuse("'" + Shown(said.cell) + "' is declared as " + axis, "layout");
          const auto of_header = joint_of(said.joint), of_source = (*skeleton)->FindJoint(declared);
          if (of_header && of_source && Contradict(**skeleton, *of_header, *of_source, joints, one_to_one))
            return refuse("'" + Shown(said.cell) + "' is declared as joint '" + declared + "'", "joints");
          const auto header_unit = MetresPerUnit(said.unit), unit = MetresPerUnit(source.units);
          if (!said.unit.empty() && header_unit && unit && *header_unit != *unit)
            return refuse("'" + Shown(said.cell) + "' is in " + said.unit + ", declared are " + source.units, "units");
        }
        c += column == JointColumn::kRotation ? 9 : 1;
      }
      joint += group.IsJoint() ? 1 : 0;
    }
  }
  return {};
}

}  // namespace mocurate
