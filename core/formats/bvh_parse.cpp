#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "core/base/text.h"
#include "core/formats/bvh.h"
#include "core/formats/file_rules.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

using Token = NumberScanner::Token;

constexpr int kMaxTreeDepth = 512;  // no body is deeper; bounds what a hostile file can make a reader of ours do
constexpr std::size_t kMostDuplicates = 100;  // findings of duplicate names; damaged rows are counted apart
constexpr double kShortestFrame = 1e-6;
constexpr double kLongestFrame = 1e6;  // seconds
constexpr const char* kFrameTimeHint = "write the seconds from frame to frame, 0.0333333 for 30 frames a second";

std::optional<BvhChannel> BvhChannelOf(std::string_view word) {
  constexpr std::string_view kNames[] = {"Xposition", "Yposition", "Zposition", "Xrotation", "Yrotation", "Zrotation"};
  for (int i = 0; i < 6; ++i) {
    if (SameWord(word, kNames[i])) return static_cast<BvhChannel>(i);
  }
  return std::nullopt;
}

/// Numbers of a program whose language has a comma there; else empty.
std::string CommaHint(std::string_view text) {
  if (text.find(',') == std::string_view::npos) return "";
  return "numbers have a decimal point, not a comma: export the file again, or replace the commas";
}

class BvhParser {
 public:
  BvhParser(std::string_view bytes, const std::string& name, DamagedRows damaged_rows)
      : lines_(bytes, name), name_(name), bytes_(bytes.size()), reports_(damaged_rows == DamagedRows::kReport) {}

  Expected<Bvh> Run() {
    const std::string_view first = lines_.Next();
    if (first.empty()) return EmptyFile(name_);
    if (!SameWord(first, "HIERARCHY")) {
      const bool wide = first.substr(0, 2) == "\xFF\xFE" || first.substr(0, 2) == "\xFE\xFF";
      return Bad("a BVH file begins with HIERARCHY, not '" + Shown(first) + "'", 0,
                 wide ? "the text is UTF-16: save it as UTF-8" : "is it a BVH file, and complete?");
    }
    if (Status read = Hierarchy(); !read) return Forward(read);
    if (Status read = Header(); !read) return Forward(read);
    if (Status read = Frames(); !read) return Forward(read);
    return std::move(bvh_);
  }

 private:
  /// Without a hint of its own: the way out of any damaged line.
  tl::unexpected<Error> Bad(std::string what, int line = 0, std::string hint = {}) const {
    if (hint.empty()) {
      hint = line == 0 && Trim(lines_.rest()).empty() ? "the file ends there: it is cut off, copy it again"
                                                      : "correct the line, or export the file again";
    }
    return Fail(ErrorCode::kMalformed, std::move(what), name_ + ":" + std::to_string(line > 0 ? line : lines_.number()),
                std::move(hint));
  }

  Expected<Vector3d> Offset(const std::vector<std::string_view>& words) const {
    Vector3d offset;
    if (words.size() != 4) return Bad("OFFSET needs 3 numbers, found " + std::to_string(words.size() - 1));
    for (int i = 0; i < 3; ++i) {
      const std::optional<double> value = ParseDouble(words[i + 1]);
      if (!value || !std::isfinite(*value)) {
        return Bad("'" + Shown(words[i + 1]) + "' in OFFSET is not a finite number", 0, CommaHint(words[i + 1]));
      }
      if (std::abs(*value) > kLargestNumber)
        return Bad(
            "'" + Shown(words[i + 1]) + "' in OFFSET is not a plausible length", 0,
            "the largest allowed number is " + FormatDouble(kLargestNumber) + ": correct it, or export the file again");
      offset[i] = *value;
    }
    return offset;
  }

  Status Channels(BvhJoint& joint, const std::vector<std::string_view>& words) {
    const std::optional<long long> count = words.size() > 1 ? ParseInteger(words[1]) : std::nullopt;
    if (!count || *count < 0 || static_cast<std::size_t>(*count) != words.size() - 2) {
      return Bad("CHANNELS of '" + joint.name + "' must declare the number of names that follow, found " +
                 std::to_string(words.size() > 1 ? words.size() - 2 : 0));
    }
    if (!joint.channels.empty()) return Bad("CHANNELS of '" + joint.name + "' appear twice");
    joint.first_channel = bvh_.channel_count;
    for (std::size_t i = 2; i < words.size(); ++i) {
      const std::optional<BvhChannel> channel = BvhChannelOf(words[i]);
      if (!channel) {
        return Bad("unknown channel '" + Shown(words[i]) + "' of joint '" + joint.name + "'", 0,
                   "channels are [XYZ]position and [XYZ]rotation");
      }
      if (std::count(joint.channels.begin(), joint.channels.end(), *channel) > 0) {
        return Bad("channel '" + Shown(words[i]) + "' of joint '" + joint.name + "' appears twice", 0,
                   "name each axis once, in the order of the numbers of a row; or export the file again");
      }
      joint.channels.push_back(*channel);
    }
    bvh_.channel_count += static_cast<int>(joint.channels.size());
    return {};
  }

  Status Open(std::string_view line, bool root) {
    const std::string_view name = Trim(line.substr(root ? 4 : 5));
    if (name.empty()) return Bad("a joint has no name");
    BvhJoint joint;
    joint.name = std::string(name);
    joint.parent = stack_.empty() ? -1 : stack_.back();
    bvh_.joints.push_back(joint);
    if (reports_ && !names_.insert(joint.name).second && bvh_.findings.size() < kMostDuplicates) {
      Report("joint_twice", static_cast<double>(bvh_.joints.size() - 1), lines_.number(), 0,
             "joint '" + Shown(name) + "' appears twice, so that the name is ambiguous; rename one");
      bvh_.findings.back().severity = Severity::kWarning;
    }
    if (static_cast<int>(stack_.size()) >= kMaxTreeDepth) return Bad("joints are nested too deeply");
    return Brace("'" + Shown(name) + "'");
  }

  Status Brace(const std::string& owner) {
    const std::string_view line = lines_.Next();
    if (line.empty()) return lines_.CutOff("'{' of " + owner);
    if (line != "{") return Bad("'{' is expected after " + owner + ", not '" + Shown(line) + "'");
    return {};
  }

  Status EndSite() {
    if (stack_.empty()) return Bad("End Site outside of a joint");
    if (Status brace = Brace("End Site"); !brace) return brace;
    BvhJoint& joint = bvh_.joints[stack_.back()];
    for (std::string_view line = lines_.Next(); line != "}"; line = lines_.Next()) {
      if (line.empty()) return lines_.CutOff("'}' of an End Site");
      const std::vector<std::string_view> words = SplitBlanks(line);
      if (!SameWord(words[0], "OFFSET")) return Bad("an End Site holds OFFSET only, not '" + Shown(line) + "'");
      const Expected<Vector3d> offset = Offset(words);
      if (!offset) return Forward(offset);
      joint.end_site = *offset;
    }
    joint.has_end_site = true;
    return {};
  }

  Status Hierarchy() {
    do {
      const std::string_view line = lines_.Next();
      if (line.empty())
        return lines_.CutOff(bvh_.joints.empty() ? "ROOT" : "'}' of joint '" + bvh_.joints.back().name + "'");
      const std::vector<std::string_view> words = SplitBlanks(line);
      const bool root = SameWord(words[0], "ROOT");
      if (root || SameWord(words[0], "JOINT")) {
        if (root != stack_.empty()) return Bad("a file has one ROOT, with every JOINT inside it");
        if (Status open = Open(line, root); !open) return open;
        stack_.push_back(static_cast<int>(bvh_.joints.size()) - 1);
      } else if (stack_.empty()) {
        return Bad("ROOT is expected, not '" + Shown(line) + "'");
      } else if (SameWord(words[0], "OFFSET")) {
        const Expected<Vector3d> offset = Offset(words);
        if (!offset) return Forward(offset);
        bvh_.joints[stack_.back()].offset = *offset;
      } else if (SameWord(words[0], "CHANNELS")) {
        if (Status read = Channels(bvh_.joints[stack_.back()], words); !read) return read;
      } else if (SameWord(words[0], "End") && words.size() > 1 && SameWord(words[1], "Site")) {
        if (Status read = EndSite(); !read) return read;
      } else if (line == "}") {
        stack_.pop_back();
      } else {
        const std::string open = Counted(static_cast<long long>(stack_.size()), "joint") + " still open";
        return Bad("'" + Shown(line) + "' is not a part of a hierarchy", 0,
                   SameWord(line, "MOTION") ? "a '}' is missing before it, with " + open : std::string());
      }
    } while (!stack_.empty());
    return {};
  }

  Status Header() {
    std::string_view line = lines_.Next();
    if (line.empty()) return lines_.CutOff("MOTION");
    if (!SameWord(line, "MOTION")) {
      return Bad("MOTION is expected, not '" + Shown(line) + "'", 0,
                 line == "}" ? "there is one '}' too many: remove it"
                 : SameWord(SplitBlanks(line)[0], "ROOT")
                     ? "a file has one ROOT: write each person into a file of its own"
                     : "a line MOTION is required between the hierarchy and 'Frames:': write it there, or export the "
                       "file again");
    }
    line = lines_.Next();
    if (line.empty()) return lines_.CutOff("'Frames:'");
    const std::size_t colon = std::min(line.find(':'), line.size() - 1);
    const std::optional<long long> frames = ParseInteger(Trim(line.substr(colon + 1)));
    if (!SameWord(Trim(line.substr(0, colon)), "Frames") || !frames) {
      return Bad("'Frames: N' is expected, not '" + Shown(line) + "'", 0,
                 "write the count of rows that follow 'Frame Time:' for N, a whole number");
    }
    announced_ = *frames;
    announced_line_ = lines_.number();
    line = lines_.Next();
    if (line.empty()) return lines_.CutOff("'Frame Time:'");
    const std::size_t second = std::min(line.find(':'), line.size() - 1);
    const std::optional<double> time = ParseDouble(Trim(line.substr(second + 1)));
    const std::vector<std::string_view> key = SplitBlanks(line.substr(0, second));
    if (key.size() != 2 || !SameWord(key[0], "Frame") || !SameWord(key[1], "Time") || !time) {
      const std::string comma = CommaHint(line.substr(second));
      return Bad("'Frame Time: S' is expected, not '" + Shown(line) + "'", 0, comma.empty() ? kFrameTimeHint : comma);
    }
    if (!(*time >= kShortestFrame && *time <= kLongestFrame)) {
      return Bad("frame time " + FormatDouble(*time) + " s is out of range", 0,
                 std::string("it must be from 1e-6 to 1e6 seconds; ") + kFrameTimeHint);
    }
    if (bvh_.channel_count == 0) {
      return Bad("no joint has a channel", 0, "the CHANNELS line of each joint declares its numbers in a row");
    }
    bvh_.frame_time_s = *time;
    bvh_.frame_time_line = lines_.number();
    return {};
  }

  /// The first implausibly large number of the row.
  std::optional<double> TooLarge(std::size_t begin) const {
    for (std::size_t at = begin; at < bvh_.values.size(); ++at) {
      if (std::abs(bvh_.values[at]) > kLargestNumber) return bvh_.values[at];
    }
    return std::nullopt;
  }

  /// Keeps the place of the row; PlaceDamage fills it.
  void Damage(const char* code, double value, int line, long long row, const std::string& what, std::size_t begin) {
    bvh_.values.resize(begin);
    bvh_.damaged.push_back(static_cast<int>(std::min<long long>(row, std::numeric_limits<int>::max() - 1)));
    if (first_damage_.what.empty()) first_damage_ = {ErrorCode::kMalformed, what, PlaceOfLine(line), ""};
    constexpr std::size_t kMostFindings = 1000;
    if (bvh_.findings.size() >= kMostFindings) return;
    Report(code, value, line, row, what);
    bvh_.findings.back().severity = Severity::kWarning;
    bvh_.findings.back().frame_end = bvh_.findings.back().frame_begin + 1;
    bvh_.findings.back().action = FindingAction::kDropped;
  }

  /// Damaged rows get the numbers of the one before, or of the first complete one. Damage that may have split or joined
  /// rows is an error.
  Status PlaceDamage(long long rows) {
    if (bvh_.damaged.empty()) return {};
    const auto wide = static_cast<std::size_t>(bvh_.channel_count);
    const auto damaged = static_cast<long long>(bvh_.damaged.size());
    if (rows > announced_ || (joined_ && rows != announced_) || 2 * damaged > rows) {
      return Fail(ErrorCode::kMalformed, first_damage_.what, first_damage_.where,
                  2 * damaged > rows
                      ? "more rows are damaged than intact: correct the CHANNELS of the hierarchy or the rows"
                      : "the header announces " + std::to_string(announced_) + " frames, the file has " +
                            std::to_string(rows) +
                            " rows: damage may have split or joined rows, so that later frame numbers are "
                            "unreliable; repair the file, or leave it out");
    }
    std::vector<double> placed;
    placed.reserve(static_cast<std::size_t>(rows) * wide);
    std::size_t taken = 0;  // complete rows
    auto next = bvh_.damaged.begin();
    for (int row = 0; row < static_cast<int>(rows); ++row) {
      const bool damage = next != bvh_.damaged.end() && *next == row;
      const std::size_t from = damage ? std::max<std::size_t>(taken, 1) - 1 : taken;
      const auto begin = bvh_.values.begin() + static_cast<std::ptrdiff_t>(from * wide);
      placed.insert(placed.end(), begin, begin + static_cast<std::ptrdiff_t>(wide));
      if (damage) ++next;
      if (!damage) ++taken;
    }
    bvh_.values = std::move(placed);
    return {};
  }

  Status Frames() {
    NumberScanner scanner(lines_.rest(), false, lines_.number() + 1);
    bvh_.values.reserve(std::min<std::size_t>(lines_.rest().size() / 2 + 1,
                                              static_cast<std::size_t>(std::clamp<long long>(announced_, 0, 1 << 24)) *
                                                  static_cast<std::size_t>(bvh_.channel_count)));
    const auto wide = static_cast<std::size_t>(bvh_.channel_count);
    int line = scanner.line();
    long long rows = 0;
    for (bool more = true; more;) {
      const std::size_t begin = bvh_.values.size();
      Token token = scanner.Numbers(bvh_.values);
      const std::size_t in_row = bvh_.values.size() - begin;
      const bool cut = reports_ && rows > 0;  // then the complete rows are kept
      if (cut && token == Token::kWord && Trim(scanner.rest()).empty()) {
        CutOff(in_row, line, rows, " and '" + Shown(scanner.text()) + "'");
        bvh_.values.resize(begin);
        break;
      }
      if (token == Token::kNotFinite || token == Token::kWord) {
        const std::string what = "'" + Shown(scanner.text()) + "' in frame " + std::to_string(rows) + ", channel " +
                                 std::to_string(in_row) + " is no finite number";
        const std::string comma = CommaHint(scanner.text());
        if (!comma.empty() && rows == 0) return Bad(what, scanner.line(), comma);
        if (!reports_) return Bad(what, scanner.line(), "correct or remove the frame, or exclude the file");
        Damage("not_a_number", static_cast<double>(in_row), line, rows++, what, begin);
        while (token != Token::kLineEnd && token != Token::kEnd) token = scanner.Next();
        more = token != Token::kEnd;
        line = scanner.line();
        continue;
      }
      more = token != Token::kEnd;
      const bool ends = !more || Trim(scanner.rest()).empty();
      if (cut && ends && in_row != 0 && in_row < wide) {
        CutOff(in_row, line, rows, "");
        bvh_.values.resize(begin);
        break;
      }
      if (in_row != 0 && in_row != wide) {
        const std::string what = "frame " + std::to_string(rows) + " has " + std::to_string(in_row) +
                                 " numbers, the hierarchy has " + std::to_string(wide) + " channels";
        if (!reports_) return Bad(what, line, "the file is cut off or damaged: copy it again");
        joined_ = joined_ || in_row > wide;
        Damage("row_length", static_cast<double>(in_row), line, rows, what, begin);
      } else if (const std::optional<double> large = TooLarge(begin)) {
        const std::string what =
            FormatDouble(*large) + " in frame " + std::to_string(rows) + " is not a plausible coordinate or angle";
        if (!reports_) return Bad(what, line, "the largest allowed number is " + FormatDouble(kLargestNumber));
        Damage("number_too_large", static_cast<double>(in_row), line, rows, what, begin);
      }
      if (in_row != 0) ++rows;
      line = scanner.line();
    }
    if (rows == 0) {
      return Bad("no frame follows", line,
                 announced_ > 0 ? "the file is cut off: copy it again"
                                : "'Frames: " + std::to_string(announced_) +
                                      "' declares none either: nothing was recorded; export it again, or exclude it");
    }
    if (rows > std::numeric_limits<int>::max()) return Bad("too many frames");
    if (Status fits = CheckPoseMemory(bvh_.joints.size(), static_cast<std::size_t>(rows), bytes_, name_); !fits)
      return fits;
    if (Status placed = PlaceDamage(rows); !placed) return placed;
    if (rows != announced_) {
      const auto contradiction =
          CountContradiction("Frames", static_cast<double>(announced_), static_cast<double>(rows),
                             name_ + ":" + std::to_string(announced_line_));
      if (!reports_) return contradiction;
      Report("count_contradiction", static_cast<double>(announced_), announced_line_, 0,
             contradiction.value().what + ": the existing rows are used");
    }
    bvh_.frames = static_cast<int>(rows);
    return {};
  }

  void CutOff(std::size_t in_row, int line, long long frame, const std::string& rest) {
    Report("cut_off", static_cast<double>(in_row), line, frame,
           "the file is cut off: frame " + std::to_string(frame) + " has " + std::to_string(in_row) + " numbers" +
               rest + " of " + std::to_string(bvh_.channel_count));
  }

  /// A finding about lost data or a wrong header: the motion may be incomplete.
  void Report(const char* code, double value, int line, long long frame, const std::string& what) {
    const int begin = static_cast<int>(std::min<long long>(frame, std::numeric_limits<int>::max() - 1));
    bvh_.findings.push_back(FindingOfFrames(code, begin, frame > 0 ? begin + 1 : 0, value,
                                            PlaceOfLine(line) + ": " + what,
                                            frame > 0 ? FindingAction::kDropped : FindingAction::kKept));
    bvh_.findings.back().severity = Severity::kError;
  }

  std::string PlaceOfLine(int line) const { return name_ + ":" + std::to_string(line); }

  LineReader lines_;
  const std::string& name_;
  std::size_t bytes_;
  Error first_damage_;
  bool reports_;
  Bvh bvh_;
  std::vector<int> stack_;
  std::set<std::string> names_;
  long long announced_ = 0;
  int announced_line_ = 0;
  bool joined_ = false;  ///< a row has more numbers than channels
};

}  // namespace

Expected<Bvh> ParseBvh(std::string_view bytes, const std::string& name, DamagedRows damaged_rows) {
  return BvhParser(bytes, name, damaged_rows).Run();
}

}  // namespace mocurate
