#include "ingest/formats/table_header.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/base/resources.h"
#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "core/formats/row_counter.h"
#include "core/geometry/axes.h"
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
constexpr const char* kUnits = "m cm mm in inch";
constexpr const char* kPlace = "pos position positions loc location coord coords coordinate world global translation";
constexpr const char* kConfidence = "c conf confidence score likelihood prob probability visibility";
constexpr const char* kOther =
    "w qx qy qz qw rx ry rz roll pitch yaw state tracked rot rotation orientation orient quat quaternion euler angle "
    "angles vel velocity speed acc accel acceleration force moment";
constexpr const char* kNumbered = "joint jt j p pt point kp keypoint marker landmark lm m bone col column v node";

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

/// Whether it names a joint by a number: "joint 3", "p12", "7".
bool IsNumbered(const Words& words) {
  return std::all_of(words.begin(), words.end(), [](const std::string& word) {
    std::string letters = Lower(word);
    while (!letters.empty() && IsNameDigit(letters.back())) letters.pop_back();
    return letters.empty() || IsOneOf(letters, kNumbered);
  });
}

/// Takes a text in brackets off the end: "left_knee_x [mm]".
std::string TakeBracket(std::string_view& cell) {
  const std::size_t open = cell.find_last_of("([");
  if (open == std::string_view::npos || (cell.back() != ')' && cell.back() != ']')) return "";
  const std::string inside = Lower(std::string(Trim(cell.substr(open + 1, cell.size() - open - 2))));
  if (!IsOneOf(inside, kUnits)) return "";
  cell = Trim(cell.substr(0, open));
  return inside;
}

/// Joint, word and unit of one cell; the word is empty where the cell is a name alone.
HeaderColumn ColumnOfCell(const std::string& cell) {
  HeaderColumn column;
  column.cell = cell;
  std::string_view text = Trim(cell);
  column.unit = TakeBracket(text);
  Words words = WordsOf(text);
  const auto last = [&] { return words.empty() ? std::string() : Lower(words.back()); };
  if (words.size() > 1 && column.unit.empty() && IsOneOf(last(), kUnits) &&
      IsOneOf(Lower(words[words.size() - 2]), kAxes)) {
    column.unit = last();
    words.pop_back();
  }
  const std::string end = last();
  const std::string joined = end.size() == 4 && end.compare(0, 3, "pos") == 0 ? end.substr(3) : "";
  if (IsOneOf(end, kAxes) || IsOneOf(joined, kAxes)) {
    column.word = joined.empty() ? end : joined;
    words.pop_back();
  } else if (IsOneOf(end, kConfidence) && words.size() > 1) {
    column.word = "confidence";
    words.pop_back();
  } else if (IsOneOf(end, kOther) && words.size() > 1) {
    column.word = "skip";
    words.pop_back();
  } else if (words.size() > 1 && IsOneOf(Lower(words[0]), kAxes)) {
    column.word = Lower(words[0]);
    words.erase(words.begin());
  }
  while (!words.empty() && IsOneOf(last(), kPlace)) words.pop_back();
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

bool IsJointName(const std::string& joint) { return !joint.empty() && !IsNumbered(WordsOf(joint)); }

/// Cells that are empty take the name before them.
void FillRight(std::vector<std::string>& cells) {
  for (std::size_t c = 1; c < cells.size(); ++c) {
    if (cells[c].empty()) cells[c] = cells[c - 1];
  }
}

/// Names above a line of axes.
void NameFromAbove(std::vector<std::string> above, std::vector<HeaderColumn>& columns) {
  const auto of_axes = [](const HeaderColumn& column) { return column.word == "x"; };
  const auto triples = static_cast<std::size_t>(std::count_if(columns.begin(), columns.end(), of_axes));
  const auto others = static_cast<std::size_t>(
      std::count_if(columns.begin(), columns.end(), [](const HeaderColumn& column) { return IsCounter(column.cell); }));
  if (above.size() == triples + others && IsCounter(above[0]))
    above.erase(above.begin(), above.begin() + static_cast<std::ptrdiff_t>(others));
  if (above.size() == triples) {
    std::size_t joint = 0;
    for (HeaderColumn& column : columns) {
      joint += of_axes(column) ? 1 : 0;
      if (joint > 0 && !IsCounter(column.cell)) column.joint = above[joint - 1];
    }
    return;
  }
  if (above.size() > columns.size() || above.size() < triples) return;
  above.resize(columns.size());
  FillRight(above);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].cell.empty()) columns[c].cell = above[c];
    if (!columns[c].word.empty()) columns[c].joint = above[c];
  }
}

/// Names that stand on three or four columns each, or before as many empty cells.
void ReadRuns(std::vector<HeaderColumn>& columns) {
  std::vector<std::string> cells;
  for (const HeaderColumn& column : columns) cells.push_back(column.cell);
  FillRight(cells);
  for (std::size_t c = 0; c < columns.size();) {
    std::size_t end = c;
    while (end < columns.size() && cells[end] == cells[c]) ++end;
    constexpr std::array<const char*, 4> kWords = {"x", "y", "z", kFillIn};
    const bool joint = (end - c == 3 || end - c == 4) && !IsCounter(cells[c]);
    for (std::size_t k = c; k < end; ++k) {
      columns[k].joint = joint ? cells[c] : "";
      columns[k].word = joint ? kWords[k - c] : IsCounter(cells[c]) ? "" : "skip";
    }
    c = end;
  }
}

/// One name for each three or four numbers, behind names of counters.
std::vector<HeaderColumn> Spread(const std::vector<std::string>& cells, std::size_t columns) {
  std::size_t leading = 0;
  while (leading < cells.size() && IsCounter(cells[leading])) ++leading;
  const std::size_t joints = cells.size() - leading;
  if (joints < kFewestNames) return {};
  const std::size_t width = (columns - leading) / joints;
  if ((width != 3 && width != 4) || leading + width * joints != columns) return {};
  std::vector<HeaderColumn> spread;
  for (std::size_t c = 0; c < leading; ++c) spread.push_back({"", "", "", cells[c]});
  for (std::size_t j = leading; j < cells.size(); ++j) {
    for (const char* word : {"x", "y", "z"}) spread.push_back({cells[j], word, "", cells[j]});
    if (width == 4) spread.push_back({cells[j], kFillIn, "", cells[j]});
  }
  return spread;
}

/// Columns of no joint that has its place are passed over, but those that count frames.
void PassOver(std::vector<HeaderColumn>& columns) {
  for (std::size_t c = 0; c < columns.size();) {
    std::size_t end = c;
    bool placed = false;
    for (; end < columns.size() && columns[end].joint == columns[c].joint; ++end)
      placed = placed || IsOneOf(columns[end].word, kAxes);
    for (std::size_t k = c; k < end; ++k) {
      const bool joint = placed && !columns[k].joint.empty();
      if (!joint) columns[k].joint.clear();
      if (!joint) columns[k].word = IsCounter(columns[k].cell) ? "" : "skip";
      if (joint && columns[k].word.empty()) columns[k].word = "skip";
    }
    c = end;
  }
}

/// Joints that have their x.
std::size_t NamedJoints(const std::vector<HeaderColumn>& columns) {
  return static_cast<std::size_t>(std::count_if(columns.begin(), columns.end(), [](const HeaderColumn& column) {
    return column.word == "x" && IsJointName(column.joint);
  }));
}

/// The joints of a skeleton by their names, each once; empty where one is unknown. `unknown` gets those.
Words JointsIn(const Skeleton& skeleton, const Words& names, Words& unknown) {
  Words joints;
  std::set<int> taken;
  for (const std::string& joint : NamesIn(skeleton, names)) {
    const auto found = skeleton.FindJoint(joint);
    if (found && taken.insert(*found).second)
      joints.push_back(skeleton.joints[static_cast<std::size_t>(*found)].name);
    else
      unknown.push_back(joint);
  }
  return unknown.empty() ? joints : Words();
}

tl::unexpected<Error> BadHeader(std::string what, const std::string& name, std::string hint) {
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

}  // namespace

Expected<std::vector<HeaderColumn>> HeaderColumns(const std::vector<std::vector<std::string>>& header, int columns,
                                                  const std::string& name) {
  if (header.empty()) return std::vector<HeaderColumn>();
  const auto wide = static_cast<std::size_t>(columns);
  std::vector<std::string> cells = header.back();
  if (cells.size() == wide + 1 && cells.back().empty()) cells.pop_back();  // behind a last separator
  std::vector<HeaderColumn> read;
  for (const std::string& cell : cells) {
    read.push_back(IsCounter(cell) ? HeaderColumn{"", "", "", cell} : ColumnOfCell(cell));
  }
  const bool axes = std::any_of(read.begin(), read.end(), [](const HeaderColumn& c) { return c.word == "x"; });
  const bool named = std::any_of(read.begin(), read.end(),
                                 [](const HeaderColumn& c) { return IsOneOf(c.word, kAxes) && !c.joint.empty(); });
  if (cells.size() == wide) {
    if (axes && !named && header.size() > 1) NameFromAbove(header[header.size() - 2], read);
    if (!axes) ReadRuns(read);
  } else if (!axes) {
    read = cells.size() < wide ? Spread(cells, wide) : std::vector<HeaderColumn>();
  }
  if (NamedJoints(read) < kFewestNames) return std::vector<HeaderColumn>();
  PassOver(read);
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
  for (const std::string& path : ResourcePaths()) {
    constexpr std::string_view kFolder = "skeletons/", kEnding = ".yaml";
    if (path.rfind(kFolder, 0) != 0 || !EndsWith(path, kEnding)) continue;
    const auto skeleton = KnownSkeleton(path.substr(kFolder.size(), path.size() - kFolder.size() - kEnding.size()));
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
  const auto joint_of = [&](const std::string& said) {
    const auto at = std::find(names.begin(), names.end(), said);
    return at == names.end() ? std::optional<int>()
                             : (*skeleton)->FindJoint(known[static_cast<std::size_t>(at - names.begin())]);
  };
  const auto refuse = [&](const std::string& what, const char* option) {
    return BadHeader(what, name, std::string("correct ingest.source.") + option + ", or the header where it is wrong");
  };
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
          if (of_header && of_source && *of_header != *of_source)
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
