#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/base/text.h"
#include "core/formats/asf.h"
#include "core/formats/file_rules.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

using Words = std::vector<std::string_view>;
constexpr const char* kOrderHint =
    "write e.g. order TX TY TZ RX RY RZ, in the order of the numbers of `root` in the motions";

std::optional<AcclaimChannel> AcclaimChannelOf(std::string_view word) {
  for (int i = 0; i <= static_cast<int>(AcclaimChannel::kLength); ++i) {
    if (SameWord(word, Name(static_cast<AcclaimChannel>(i)))) return static_cast<AcclaimChannel>(i);
  }
  return std::nullopt;
}

/// "XYZ" in any order and letter case, in upper case.
std::optional<std::string> AxisOrder(std::string_view word) {
  std::string order, sorted;
  for (const char c : word) order += c >= 'x' && c <= 'z' ? static_cast<char>(c - 'x' + 'X') : c;
  sorted = order;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != "XYZ") return std::nullopt;
  return order;
}

class AsfParser {
 public:
  AsfParser(std::string_view bytes, const std::string& name) : lines_(bytes, name) {}

  Expected<Asf> Run() {
    std::string_view line = Next();
    if (line.empty()) return EmptyFile(lines_.name());
    while (!line.empty()) {
      if (line.front() != ':') {
        return Bad("an ASF file consists of sections that begin with ':', not '" + Shown(line) + "'");
      }
      if (Status read = Section(line); !read) return Forward(read);
      line = Next();
    }
    if (Status whole = Whole(); !whole) return Forward(whole);
    return std::move(asf_);
  }

 private:
  tl::unexpected<Error> Bad(std::string what, std::string hint = {}) const {
    if (hint.empty()) hint = "correct the line, or copy the skeleton file again";
    return lines_.Bad(std::move(what), std::move(hint));
  }

  std::string_view Next() {
    std::string_view line = lines_.Next();
    while (!line.empty() && line.front() == '#') line = lines_.Next();
    return line;
  }

  /// The next line of a section; empty where the next section begins, or at the end.
  std::string_view NextOfSection() {
    for (;;) {
      const std::string_view line = lines_.Peek();
      if (line.empty() || line.front() == ':') return {};
      lines_.Next();
      if (line.front() != '#') return line;
    }
  }

  Status Section(std::string_view line) {
    const Words words = SplitBlanks(line);
    std::string section;
    for (const char c : words[0].substr(1)) section += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const std::string_view rest = Trim(line.substr(words[0].size()));
    static const std::vector<std::string> kSections = {"version", "name",     "units",    "documentation",
                                                       "root",    "bonedata", "hierarchy"};
    if (std::find(kSections.begin(), kSections.end(), section) == kSections.end()) {
      const auto nearest = Nearest(section, kSections);
      return Bad("unknown section ':" + Shown(section) + "'", nearest ? "did you mean ':" + *nearest + "'?" : "");
    }
    if (!sections_.insert(section).second) return Bad("the section ':" + section + "' appears twice");
    if (section == "version" || section == "name") return CheckText(rest, section);
    if (!rest.empty()) return Bad("'" + Shown(rest) + "' follows ':" + section + "'");
    if (section == "documentation") {
      while (!NextOfSection().empty()) continue;
      return {};
    }
    if (section == "bonedata") return Bones();
    if (section == "hierarchy") return Hierarchy();
    for (line = NextOfSection(); !line.empty(); line = NextOfSection()) {
      const Words of_line = SplitBlanks(line);
      Status read = section == "units" ? Units(of_line) : Root(of_line);
      if (!read) return read;
    }
    return {};
  }

  Status CheckText(std::string_view text, const std::string& section) const {
    if (text.empty()) return Bad("':" + section + "' has no value");
    const double version = section == "version" ? ParseDouble(text).value_or(0.0) : 1.0;
    if (!(version > 0.0 && version < 1000.0)) return Bad("'" + Shown(text) + "' is not a version");
    return {};
  }

  Expected<double> Number(std::string_view word, const std::string& field) const {
    const std::optional<double> value = ParseDouble(word);
    if (!value || !std::isfinite(*value)) return Bad("'" + Shown(word) + "' is not a finite number: " + field);
    if (std::abs(*value) > kLargestNumber) {
      return Bad("'" + Shown(word) + "' is not a plausible value: " + field,
                 "the largest allowed number is " + FormatDouble(kLargestNumber) + ": correct it");
    }
    return *value;
  }

  Status Vector(Vector3d& to, const Words& words, std::size_t count, const std::string& field) const {
    if (words.size() != count) {
      return Bad(field + " needs " + std::to_string(count - 1) + " values, found " + std::to_string(words.size() - 1));
    }
    for (int i = 0; i < 3; ++i) {
      const Expected<double> value = Number(words[static_cast<std::size_t>(i) + 1], field);
      if (!value) return Forward(value);
      to[i] = *value;
    }
    return {};
  }

  Status Scale(double& to, const Words& words, const std::string& field) const {
    if (words.size() != 2) return Bad(field + " needs one number");
    const Expected<double> value = Number(words[1], field);
    if (!value) return Forward(value);
    if (!(*value > 0.0)) return Bad(field + " " + FormatDouble(*value) + " is not positive");
    to = *value;
    return {};
  }

  Status Channels(std::vector<AcclaimChannel>& to, const Words& words, const std::string& field) const {
    if (!to.empty()) return Bad(field + " appears twice");
    for (std::size_t i = 1; i < words.size(); ++i) {
      const std::optional<AcclaimChannel> channel = AcclaimChannelOf(words[i]);
      if (!channel) {
        return Bad("unknown channel '" + Shown(words[i]) + "': " + field, "channels are tx ty tz rx ry rz l");
      }
      if (std::find(to.begin(), to.end(), *channel) != to.end()) {
        return Bad("channel '" + Shown(words[i]) + "' twice: " + field);
      }
      to.push_back(*channel);
    }
    if (to.empty()) return Bad(field + " names no channel");
    return {};
  }

  Status Order(std::string& to, std::string_view word, const std::string& field) const {
    const std::optional<std::string> order = AxisOrder(word);
    if (!order) return Bad("'" + Shown(word) + "' is not an order of the axes X, Y and Z: " + field);
    to = *order;
    return {};
  }

  Status Units(const Words& words) {
    double mass = 1.0;  // not used
    if (SameWord(words[0], "mass")) return Scale(mass, words, "mass of :units");
    if (SameWord(words[0], "length")) return Scale(asf_.length_unit, words, "length of :units");
    if (!SameWord(words[0], "angle")) return Bad("unknown unit '" + Shown(words[0]) + "'", "use mass, length or angle");
    const bool degrees = words.size() == 2 && (SameWord(words[1], "deg") || SameWord(words[1], "degrees"));
    const bool radians = words.size() == 2 && (SameWord(words[1], "rad") || SameWord(words[1], "radians"));
    if (!degrees && !radians) return Bad("angle of :units is 'deg' or 'rad', not '" + Shown(words.back()) + "'");
    asf_.degrees = degrees;
    return {};
  }

  Status Root(const Words& words) {
    if (SameWord(words[0], "order")) {
      if (Status read = Channels(asf_.root_order, words, "order of :root"); !read) return read;
      return WholeOrder();
    }
    if (SameWord(words[0], "axis")) {
      if (words.size() != 2) return Bad("axis of :root needs one word, as XYZ");
      root_axis_reported_ = true;
      return Order(asf_.root_axis, words[1], "axis of :root");
    }
    if (SameWord(words[0], "position")) return Vector(asf_.root_position, words, 4, "position of :root");
    if (SameWord(words[0], "orientation")) return Vector(asf_.root_orientation, words, 4, "orientation of :root");
    return Bad("unknown key '" + Shown(words[0]) + "' of :root", "use order, axis, position or orientation");
  }

  /// A root has no or three translation channels, and no or three rotation channels.
  Status WholeOrder() const {
    const auto has = [&](int i) {
      const auto& order = asf_.root_order;
      return std::find(order.begin(), order.end(), static_cast<AcclaimChannel>(i)) != order.end();
    };
    if (has(static_cast<int>(AcclaimChannel::kLength)))
      return Bad("the order of :root has the channel l (length), which a root cannot have");
    for (int first = 0; first <= 3; first += 3) {
      std::string missing;
      for (int i = first; i < first + 3; ++i) missing += has(i) ? "" : std::string(" ") + Name(AcclaimChannel(i));
      if (missing.empty() || missing.size() == 9) continue;
      return Bad("order of :root names " + std::to_string(asf_.root_order.size()) + " channels; missing are" + missing,
                 kOrderHint);
    }
    return {};
  }

  Status Bones() {
    for (std::string_view line = NextOfSection(); !line.empty(); line = NextOfSection()) {
      if (!SameWord(line, "begin")) return Bad("'begin' of a bone is expected, not '" + Shown(line) + "'");
      if (Status bone = Bone(); !bone) return bone;
    }
    return {};
  }

  Status Bone() {
    AsfBone bone;
    bone.line = lines_.number();
    std::set<std::string> seen;
    for (;;) {
      const std::string_view line = NextOfSection();
      if (line.empty()) return lines_.CutOff("'end' of bone '" + Shown(bone.name) + "'");
      if (SameWord(line, "end")) break;
      const Words words = SplitBlanks(line);
      std::string key(words[0]);
      for (char& c : key) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      if (line.front() == '(') key = "limits";
      const bool continues = line.front() == '(' && seen.count("limits") != 0;
      if (!continues && !seen.insert(key).second)
        return Bad("'" + Shown(key) + "' of bone " + Called(bone) + " appears twice");
      if (Status read = Key(bone, key, words, line); !read) return read;
    }
    for (const char* key : {"id", "name", "direction", "length", "axis"}) {
      if (seen.count(key) == 0) return Bad(std::string("bone ") + Called(bone) + " has no " + key);
    }
    if (!bone.limits.empty() && bone.limits.size() != bone.dof.size()) {
      return Bad("bone " + Called(bone) + " has " + std::to_string(bone.dof.size()) + " dof and " +
                 std::to_string(bone.limits.size()) + " limits");
    }
    if (bone.length > 0.0 && !(bone.direction.norm() > 1e-9)) {
      return Bad("bone " + Called(bone) + " has a length, and no direction");
    }
    if (!index_.emplace(bone.name, static_cast<int>(asf_.bones.size())).second || bone.name == "root") {
      return Bad("bone " + Called(bone) + " appears twice");
    }
    if (!ids_.insert(bone.id).second) ReportId(bone);
    asf_.bones.push_back(std::move(bone));
    return {};
  }

  static std::string Called(const AsfBone& bone) { return "'" + Shown(bone.name) + "'"; }

  void Report(const char* code, Severity severity, std::string joint, double value, std::string message) {
    if (asf_.findings.size() < 100)
      asf_.findings.push_back(
          {"", code, severity, 0, 0, std::move(joint), value, 0.0, std::move(message), FindingAction::kKept});
  }

  void ReportId(const AsfBone& bone) {
    Report("bone_id_twice", Severity::kInfo, Shown(bone.name), bone.id,
           lines_.Place() + ": bone " + Called(bone) + " has the id of another bone, " + std::to_string(bone.id) +
               "; bones are identified by name");
  }

  Status Key(AsfBone& bone, const std::string& key, const Words& words, std::string_view line) const {
    const std::string field = key + " of bone " + Called(bone);
    if (key == "id") {
      const std::optional<long long> id = words.size() == 2 ? ParseInteger(words[1]) : std::nullopt;
      if (!id || *id < -1000000 || *id > 1000000) return Bad("'" + Shown(line) + "' is not a whole number: " + field);
      bone.id = static_cast<int>(*id);
      return {};
    }
    if (key == "name") {
      if (words.size() != 2) return Bad("a bone's name is one word: " + field);
      const char first = words[1].front();
      if (first == '#' || first == ':' || SameWord(words[1], "begin") || SameWord(words[1], "end")) {
        return Bad("'" + Shown(words[1]) + "' cannot be the name of a bone");
      }
      bone.name = std::string(words[1]);
      return {};
    }
    if (key == "direction") return Vector(bone.direction, words, 4, field);
    if (key == "length") {
      if (words.size() != 2) return Bad(field + " needs one number");
      const Expected<double> length = Number(words[1], field);
      if (!length) return Forward(length);
      if (*length < 0.0) return Bad(field + " is negative");
      bone.length = *length;
      return {};
    }
    if (key == "axis") {
      if (Status read = Vector(bone.axis.angles, words, 5, field); !read) return read;
      return Order(bone.axis.order, words[4], field);
    }
    if (key == "dof") return Channels(bone.dof, words, field);
    if (key == "limits") return Limits(bone, line, field);
    if (key == "bodymass" || key == "cofmass") {
      if (words.size() != 2) return Bad(field + " needs one number");
      const Expected<double> value = Number(words[1], field);  // not used
      return value ? Status() : Forward(value);
    }
    return Bad("unknown key '" + Shown(key) + "' of bone " + Called(bone),
               "use id, name, direction, length, axis, dof, limits, bodymass or cofmass");
  }

  /// One or more "(least most)"; "inf" is a number here.
  Status Limits(AsfBone& bone, std::string_view line, const std::string& field) const {
    for (std::string_view rest = line.substr(line.find('(') == std::string_view::npos ? line.size() : line.find('('));
         ;) {
      const std::size_t close = rest.find(')');
      if (rest.empty() || rest.front() != '(' || close == std::string_view::npos) {
        return Bad("'" + Shown(line) + "' is not a pair of numbers in brackets: " + field);
      }
      Words pair = SplitBlanks(rest.substr(1, close - 1));
      const std::optional<double> least = pair.size() == 2 ? ParseDouble(pair[0]) : std::nullopt;
      const std::optional<double> most = pair.size() == 2 ? ParseDouble(pair[1]) : std::nullopt;
      if (!least || !most || !(*least <= *most)) {
        return Bad("'" + Shown(rest.substr(0, close + 1)) + "' is not a minimum and a maximum: " + field);
      }
      bone.limits.push_back({*least, *most});
      rest = Trim(rest.substr(close + 1));
      if (rest.empty()) return {};
    }
  }

  Expected<int> Known(std::string_view name) const {
    if (name == "root") return -1;
    const auto found = index_.find(std::string(name));
    if (found == index_.end()) {
      return Bad("'" + Shown(name) + "' in :hierarchy is not a bone of :bonedata", "names are case-sensitive");
    }
    return found->second;
  }

  Status Hierarchy() {
    if (sections_.count("bonedata") == 0) return Bad(":hierarchy precedes :bonedata");
    std::string_view line = NextOfSection();
    const bool brackets = SameWord(line, "begin");
    if (brackets) line = NextOfSection();
    hung_.assign(asf_.bones.size(), false);
    for (; !line.empty() && !(brackets && SameWord(line, "end")); line = NextOfSection()) {
      const Words words = SplitBlanks(line);
      const Expected<int> parent = Known(words[0]);
      if (!parent) return Forward(parent);
      if (words.size() < 2) return Bad("'" + Shown(words[0]) + "' in :hierarchy has no children");
      for (std::size_t i = 1; i < words.size(); ++i) {
        const Expected<int> child = Known(words[i]);
        if (!child) return Forward(child);
        if (*child < 0) return Bad("the root is a child of '" + Shown(words[0]) + "'");
        if (hung_[static_cast<std::size_t>(*child)]) return Bad("bone '" + Shown(words[i]) + "' has two parents");
        hung_[static_cast<std::size_t>(*child)] = true;
        asf_.bones[static_cast<std::size_t>(*child)].parent = *parent;
      }
    }
    if (brackets && line.empty()) return lines_.CutOff("'end' of :hierarchy");
    line = NextOfSection();
    if (!line.empty()) return Bad("'" + Shown(line) + "' follows the end of :hierarchy");
    return {};
  }

  /// The axis is the order of the angles of the orientation: it has no effect where these are 0.
  void CheckRootAxis() {
    if (root_axis_reported_) return;
    const bool turned = !asf_.root_orientation.isZero();
    Report("root_axis_missing", turned ? Severity::kError : Severity::kWarning, "", 0.0,
           lines_.name() + ": :root has no axis (the order of the angles of its orientation); the orientation " +
               (turned ? "is read as XYZ" : "is 0 0 0, so the axis has no effect") + ": write axis XYZ under :root");
  }

  Status Whole() {
    for (const char* section : {"root", "bonedata", "hierarchy"}) {
      if (sections_.count(section) == 0) return lines_.CutOff(std::string("':") + section + "'");
    }
    if (asf_.root_order.empty()) return Fail(ErrorCode::kMalformed, ":root has no order", lines_.name(), kOrderHint);
    CheckRootAxis();
    if (asf_.bones.empty()) return Bad(":bonedata holds no bone");
    for (std::size_t i = 0; i < asf_.bones.size(); ++i) {
      if (!hung_[i]) return Bad("bone " + Called(asf_.bones[i]) + " is not in :hierarchy");
    }
    if (asf_.Order().size() != asf_.bones.size()) return Bad("bones in :hierarchy form a cycle");
    return {};
  }

  LineReader lines_;
  Asf asf_;
  std::set<std::string> sections_;
  std::unordered_map<std::string, int> index_;
  std::set<int> ids_;
  bool root_axis_reported_ = false;
  std::vector<bool> hung_;
};

}  // namespace

Expected<Asf> ParseAsf(std::string_view bytes, const std::string& name) { return AsfParser(bytes, name).Run(); }

}  // namespace mocurate
