// The layout humanact12: PssGggRrrFffffTttttAaaaa.npy, one a clip, (T,J,3) doubles, metres, x to the image's right, y
// down, the person faces -z (Action2Motion's HumanAct12). The name contains person, group, repetition, first and last
// frame (inclusive), class and fine class.

#include <algorithm>
#include <map>
#include <set>

#include "canon/exports/clip_names.h"
#include "canon/exports/smpl_arrays.h"
#include "canon/exports/written_set.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/formats/npy.h"
#include "core/formats/phspd_text.h"

namespace mocurate {
namespace {

constexpr const char* kYDown = "+x -y -z";
constexpr int kTwoDigits = 99;
constexpr int kMostFrames = 9999;  // the last frame number has four digits

/// Whether a text is this one, in which # stands for any digit.
bool HasForm(std::string_view text, std::string_view form) {
  return std::equal(text.begin(), text.end(), form.begin(), form.end(),
                    [](char c, char f) { return f == '#' ? c >= '0' && c <= '9' : c == f; });
}

/// Codes of labels: two digits for the class, "01" for the first, "00" for no label; two for the fine label, "01" for
/// the first of the class in the dataset's order, "00" for none.
class ActionCodes {
 public:
  ActionCodes(const std::vector<std::string>& labels, const std::vector<FineLabel>& fine_labels) : labels_(labels) {
    std::map<int, int> count;
    for (const FineLabel& fine : fine_labels) {
      const int number = ++count[fine.parent];
      if (number > kTwoDigits || fine.parent >= kTwoDigits) continue;
      const std::string code = ZeroPadded(fine.parent + 1, 2) + ZeroPadded(number, 2);
      texts_.emplace(code, fine.name);
      codes_.emplace(std::pair(labels[static_cast<std::size_t>(fine.parent)], fine.name), code);
    }
  }

  /// Whether the code of a name, "0203", can represent these labels: the class has that code, and no other fine label
  /// uses it. If so, it is assigned to them.
  bool Keep(const std::string& code, const std::string& label, const std::string& fine) {
    if (code.substr(0, 2) != Coarse(label)) return false;
    const auto text = texts_.find(code);
    const auto own = codes_.find({label, fine});
    if (text != texts_.end() && own != codes_.end()) return text->second == fine && own->second == code;
    if (text != texts_.end() || own != codes_.end()) return false;
    texts_.emplace(code, fine);
    codes_.emplace(std::pair(label, fine), code);
    return true;
  }

  /// Error kUnsupported: more classes or fine labels than two digits can count.
  Expected<std::string> Of(const std::string& label, const std::string& fine, const std::string& clip) {
    const auto known = codes_.find({label, fine});
    if (known != codes_.end()) return known->second;
    const std::string coarse = Coarse(label);
    for (int number = fine.empty() ? 0 : 1; number <= kTwoDigits && coarse.size() == 2; ++number) {
      const std::string code = coarse + ZeroPadded(number, 2);
      if (!texts_.emplace(code, fine).second) continue;
      return codes_.emplace(std::pair(label, fine), code).first->second;
    }
    return Fail(ErrorCode::kUnsupported,
                "label '" + label + "'" + (fine.empty() ? "" : ", '" + fine + "'") +
                    ": a name has two digits for the class and two for the fine label, 1 to 99 each",
                clip, "remove classes from the recipe (assemble.classes), or export with another layout");
  }

  /// Coarse code -> label, of those that were used.
  std::map<std::string, std::string> Labels() const {
    std::map<std::string, std::string> labels;
    for (const auto& [names, code] : codes_) labels[code.substr(0, 2)] = names.first;
    return labels;
  }
  /// Code -> fine label.
  std::map<std::string, std::string> FineLabels() const { return texts_; }
  bool HasFineLabels() const {
    return std::any_of(texts_.begin(), texts_.end(), [](const auto& text) { return !text.second.empty(); });
  }

 private:
  std::string Coarse(const std::string& label) {
    auto found = std::find(labels_.begin(), labels_.end(), label);
    if (found == labels_.end() && !label.empty()) found = labels_.insert(labels_.end(), label);
    return label.empty() ? "00" : ZeroPadded(static_cast<int>(found - labels_.begin()) + 1, 2);
  }

  std::vector<std::string> labels_;
  std::map<std::pair<std::string, std::string>, std::string> codes_;  ///< by label and fine label
  std::map<std::string, std::string> texts_;                          ///< code -> fine label
};

class HumanAct12Writer : public LayoutWriter {
 public:
  explicit HumanAct12Writer(const ExportSet& set)
      : set_(set), names_(set.ids, RecordingNames::kOfPerson), codes_(set.labels, set.fine_labels) {
    for (std::size_t i = 0; i < set.ids.size(); ++i) persons_.emplace(names_.Person(i), 0);
    // "P07" keeps its number; the others get unused numbers, in their order.
    std::set<int> numbers;
    int next = 0;
    for (auto& [person, own] : persons_) {
      if (HasForm(person, "P##") && person != "P00") numbers.insert(own = std::stoi(person.substr(1)));
    }
    for (auto& [person, own] : persons_) {
      if (own > 0) continue;
      while (!numbers.insert(++next).second) continue;
      own = next;
    }
  }

  Expected<std::vector<ExportedFile>> Add(std::size_t position, const Clip& clip) override {
    if (Status same = rate_.Check(clip); !same) return Forward(same);
    const Expected<std::string> name = NameOf(position, clip);
    if (!name) return Forward(name);
    const MotionInAxes motion(clip, *AxisConvention::Parse(kYDown));
    const auto frames = static_cast<std::size_t>(motion.motion.frame_count());
    const auto joints = static_cast<std::size_t>(motion.motion.joint_count());
    Expected<std::string> bytes = EncodeNpy({{frames, joints, 3}, "<f8", motion.Joints(), {}}, clip.id());
    if (!bytes) return Forward(bytes);
    clips_.push_back(WrittenClipOf(position, clip, *name + ".npy"));
    clips_.back().person = name->substr(0, 3);
    return std::vector<ExportedFile>{{clips_.back().file, *std::move(bytes)}};
  }

  void RemoveLast() override { clips_.pop_back(); }

  Expected<std::vector<ExportedFile>> Finish(std::vector<std::string>& notes) override {
    std::vector<ExportedFile> files = {ClipTable(set_, clips_)};
    if (clips_.empty()) return files;
    if (made_ > 0) {
      notes.push_back(Counted(made_, "clip") +
                      " got names in HumanAct12's form, persons got numbers; clips.csv has the clips' ids");
    }
    FileDeclaration declaration;
    declaration.layout = "humanact12";
    declaration.source = names_.source();
    const auto say = [&](const char* option, const std::string& value) {
      declaration.options.emplace_back(option, value);
    };
    say("format", "npy");
    say("files", YamlQuoted("P{person:2}G{group:2}R{repetition:2}F{first:4}T{last:4}A{action:2}{fine:2}.npy"));
    say("other_files", "ignore");
    say("units", "m");
    say("axes", YamlQuoted(kYDown));
    say("rate", FormatDouble(clips_.front().rate.hz()) + " Hz");
    say("person", YamlQuoted("P{person}"));
    if (made_ == 0) say("session", YamlQuoted("G{group}"));
    say("label", YamlQuoted("{action}"));
    say("labels", YamlMap(codes_.Labels()));
    if (codes_.HasFineLabels()) {
      say("fine_label", YamlQuoted("{action}{fine}"));
      say("fine_labels", YamlMap(codes_.FineLabels()));
    }
    AddDeclaration(set_, clips_, declaration, notes, files);
    return files;
  }

 private:
  /// The recording's own name where it is one of HumanAct12's and correct for this clip, else a new one.
  Expected<std::string> NameOf(std::size_t position, const Clip& clip) {
    const std::string& recording = names_.Recording(position);
    const int person = persons_.at(names_.Person(position)), frames = clip.motion->frame_count();
    if (HasForm(recording, "P##G##R##F####T####A####") && recording.substr(0, 3) == "P" + ZeroPadded(person, 2) &&
        taken_.count(recording) == 0 &&
        codes_.Keep(recording.substr(recording.size() - 4), clip.label, clip.fine_label)) {
      taken_.insert(recording);
      return recording;
    }
    const Expected<std::string> action = codes_.Of(clip.label, clip.fine_label, clip.id());
    if (!action) return Forward(action);
    if (person > kTwoDigits || frames > kMostFrames) {
      return Fail(ErrorCode::kUnsupported,
                  person > kTwoDigits ? "person '" + names_.Person(position) + "' is number " + std::to_string(person) +
                                            ", a name has two digits"
                                      : Counted(frames, "frame") + ", a name has four digits",
                  clip.id(), "export fewer with --clip, or with another layout");
    }
    const long long begin = FirstRecordedFrame(clip);
    const int first = begin >= 0 && begin + frames - 1 <= kMostFrames ? static_cast<int>(begin) : 0;
    const auto name_of = [&](int group, int repetition) {
      return "P" + ZeroPadded(person, 2) + "G" + ZeroPadded(group, 2) + "R" + ZeroPadded(repetition, 2) + "F" +
             ZeroPadded(first, 4) + "T" + ZeroPadded(first + frames - 1, 4) + "A" + *action;
    };
    if (const auto phspd = ParsePhspdRecording(clip.identity.recording); phspd && phspd->subject == person) {
      // A clip cut as HumanAct12 was: the set's own name.
      const std::string name = name_of(phspd->group, phspd->time);
      if (taken_.insert(name).second) return name;
    }
    for (int number = 0; number < kTwoDigits * kTwoDigits; ++number) {
      const std::string name = name_of(number / kTwoDigits + 1, number % kTwoDigits + 1);
      if (!taken_.insert(name).second) continue;
      ++made_;
      return name;
    }
    return Fail(
        ErrorCode::kUnsupported,
        "all names of person " + std::to_string(person) + " and code " + *action + " with these frames are taken",
        clip.id(), "export fewer with --clip, or with another layout");
  }

  const ExportSet set_;
  const ClipNames names_;
  ActionCodes codes_;
  OneRate rate_;
  std::map<std::string, int> persons_;  ///< their numbers
  std::set<std::string> taken_;
  std::vector<WrittenClip> clips_;
  long long made_ = 0;
};

}  // namespace

std::unique_ptr<LayoutWriter> MakeHumanAct12Layout(const ExportSet& set) {
  return std::make_unique<HumanAct12Writer>(set);
}

}  // namespace mocurate
