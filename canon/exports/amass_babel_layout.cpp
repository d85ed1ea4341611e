// The layout amass_babel: SET/PERSON/TAKE_poses.npz in AMASS's form of SMPL-H (156 numbers a frame, metres, z up) and
// babel_v1.0_release/{train,val,test}.json in BABEL's. `trans` is the pelvis itself: SMPL-H's rest pelvis, a constant
// of the body model, is not added. Fingers are straight, `betas` 0. Height 0 is the floor under that body, where a foot
// is ever at rest on it.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "canon/exports/clip_names.h"
#include "canon/exports/smpl_arrays.h"
#include "canon/exports/written_set.h"
#include "canon/frames/level.h"
#include "canon/splits/leaks.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/formats/amass.h"
#include "core/formats/babel.h"

namespace mocurate {
namespace {

constexpr const char* kZUp = "+x -z +y";
constexpr const char* kBabelFolder = "babel_v1.0_release";
constexpr const char* kLabelTable = "labels.csv";
/// Part of a split -> file; clips of no part go to the last one. All other files are always written.
constexpr std::pair<const char*, const char*> kBabelParts[] = {
    {"train", "train.json"}, {"validation", "val.json"}, {"test", "test.json"}, {"other", "other.json"}};
constexpr std::size_t kSmplHColumns = 156;  // root, 21 of the body, two hands of 15
constexpr std::size_t kSmplHBody = 22;
constexpr std::size_t kShapeNumbers = 16;

constexpr const char* kPoses = "_poses";  // at the end of every file's name

/// BABEL's categories in the form of Segment::category: "walk, turn".
std::vector<std::string> Categories(const std::string& text, const std::string& label) {
  std::vector<std::string> categories;
  for (const std::string_view category : SplitText(text, ',')) {
    if (!Trim(category).empty()) categories.emplace_back(Trim(category));
  }
  if (categories.empty()) categories.push_back(label);
  return categories;
}

BabelLabel LabelOfWhole(const std::string& label, const std::string& fine) {
  BabelLabel whole;
  whole.raw_label = fine.empty() ? label : fine;
  whole.proc_label = label;
  whole.act_cat = {label};
  return whole;
}

BabelLabel LabelOfSegment(const Segment& segment) {
  BabelLabel label;
  label.raw_label = label.proc_label = segment.label;
  label.act_cat = Categories(segment.category, segment.label);
  label.start_t = std::max(0.0, segment.begin_s);
  label.end_t = segment.end_s;
  return label;
}

BabelAnnotation AnnotationOfLabels(std::vector<BabelLabel> labels) {
  BabelAnnotation annotation;
  std::set<std::string> actions;
  for (const BabelLabel& label : labels) actions.insert(*label.proc_label);
  annotation.mul_act = actions.size() > 1;
  annotation.labels = std::move(labels);
  return annotation;
}

/// Segments become frame labels; the clip's label becomes the sequence's, without one the label of each action segment.
BabelSequence SequenceOf(const Clip& clip, const std::string& feat_p) {
  BabelSequence sequence;
  sequence.feat_p = feat_p;
  sequence.dur = std::max(0.01, std::round(100.0 * clip.motion->duration()) / 100.0);
  std::vector<BabelLabel> whole, frames;
  if (!clip.label.empty()) whole.push_back(LabelOfWhole(clip.label, clip.fine_label));
  std::set<std::string> actions;
  for (const Segment& segment : clip.segments) {
    if (segment.label.empty() || !(segment.begin_s < segment.end_s)) continue;
    frames.push_back(LabelOfSegment(segment));
    if (clip.label.empty() && actions.insert(segment.label).second) {
      whole.push_back(LabelOfWhole(segment.label, ""));
      whole.back().act_cat = frames.back().act_cat;
    }
  }
  if (!whole.empty()) sequence.seq_anns.push_back(AnnotationOfLabels(std::move(whole)));
  if (!frames.empty()) sequence.frame_anns.push_back(AnnotationOfLabels(std::move(frames)));
  return sequence;
}

/// Height of the floor under a motion, metres; empty where no foot is ever at rest on it.
std::optional<double> FloorHeight(const Motion& motion) {
  LevelOptions options;
  options.rule = FloorRule::kHeight;
  const std::optional<FloorPlane> floor = EstimateFloor(options, {motion});
  return floor ? std::optional<double>(floor->height) : std::nullopt;
}

/// How much a clip is raised, metres, and what its height 0 is then (kHeightOrigin; empty: not known).
struct Raise {
  double metres = 0.0;
  std::string origin;
};

/// The body that is written has SMPL-H's bones: its feet stand where the person's do, on the floor.
Raise RaiseOf(const Clip& clip, const Motion& own, const Motion& written) {
  Raise raise{0.0, clip.Noted(kHeightOrigin)};
  const std::optional<double> floor = FloorHeight(written);
  if (!floor) return raise;
  const bool on_floor = raise.origin == kOriginFloor;  // measured over more clips than this one
  raise.metres = (on_floor ? FloorHeight(own).value_or(0.0) : 0.0) - *floor;
  raise.origin = kOriginFloor;
  return raise;
}

/// A text that fits a cell of labels.csv: ingest splits lines at commas and strips blanks.
bool FitsCell(const std::string& text) {
  return !text.empty() && Trim(text) == text && WithoutControls(text) == text && CsvCell(text) == text;
}

class AmassBabelWriter : public LayoutWriter {
 public:
  explicit AmassBabelWriter(const ExportSet& set) : set_(set), names_(set.ids, RecordingNames::kOfSet) {
    source_ = FileNames({kClipTable, kDeclarationFile, kSkeletonFile, kLabelTable, kBabelFolder}).Of(names_.source());
    for (std::size_t i = 0; i < set.ids.size(); ++i)
      named_poses_ = named_poses_ && names_.Recording(i) != kPoses && EndsWith(names_.Recording(i), kPoses);
    if (!set.splits.empty()) parts_ = PartsOf(set.splits.front(), set.ids.size());
  }

  Expected<std::vector<ExportedFile>> Add(std::size_t position, const Clip& clip) override {
    Expected<std::vector<int>> order = SmplOrder(clip);
    if (!order) return Forward(order);
    const MotionInAxes motion(clip, *AxisConvention::Parse(kZUp));
    farthest_ = std::max(farthest_, FarthestReadBack(motion.motion, *order, BonesReadBack::kSmpl24));
    const Raise raise = RaiseOf(clip, motion.motion, OnSmpl24(motion.motion, *order, BonesReadBack::kSmpl24));
    order->resize(kSmplHBody);
    Amass amass;
    amass.rate_hz = motion.motion.rate.hz();
    amass.gender = "neutral";
    amass.frames = static_cast<std::size_t>(motion.motion.frame_count());
    amass.pose_columns = kSmplHColumns;
    amass.poses.assign(amass.frames * kSmplHColumns, 0.0);
    const std::vector<double> body = motion.RotationVectors(*order);
    for (std::size_t f = 0; f < amass.frames; ++f) {
      std::copy_n(body.begin() + static_cast<std::ptrdiff_t>(f * 3 * kSmplHBody), 3 * kSmplHBody,
                  amass.poses.begin() + static_cast<std::ptrdiff_t>(f * kSmplHColumns));
    }
    amass.translation_m = motion.RootTranslation();
    for (std::size_t f = 0; f < amass.frames; ++f) amass.translation_m[3 * f + 2] += raise.metres;
    amass.betas.assign(kShapeNumbers, 0.0);
    const std::string take = names_.Recording(position) + (named_poses_ ? "" : kPoses);
    const std::string file = source_ + "/" + names_.Person(position) + "/" + take + ".npz";
    Expected<std::string> bytes = EncodeAmass(amass, clip.id());
    if (!bytes) return Forward(bytes);
    const std::string part = parts_.empty() ? "train" : NameOfPart(parts_[position]);
    const bool annotated = !clip.label.empty() || !clip.segments.empty();
    parts_come_back_ = parts_come_back_ && annotated && !part.empty();
    if (annotated) {
      BabelSequence sequence = SequenceOf(clip, source_ + "/" + file);
      const std::optional<long long> known = ParseInteger(clip.Noted("babel_sid"));
      if (known && *known > 0 && sids_.insert(*known).second) sequence.babel_sid = *known;
      sequences_[part.empty() ? "other" : part].push_back(std::move(sequence));
    }
    takes_.push_back(take);
    clips_.push_back(WrittenClipOf(position, clip, file));
    clips_.back().person = names_.Person(position);
    clips_.back().origin = raise.origin.empty() ? "unknown" : raise.origin;
    clips_.back().raised_m = raise.metres;
    return std::vector<ExportedFile>{{file, *std::move(bytes)}};
  }

  void RemoveLast() override {
    for (auto& [part, sequences] : sequences_) {
      if (!sequences.empty() && sequences.back().feat_p == source_ + "/" + clips_.back().file) sequences.pop_back();
    }
    clips_.pop_back();
    takes_.pop_back();
  }

  Expected<std::vector<ExportedFile>> Finish(std::vector<std::string>& notes) override {
    std::vector<ExportedFile> files = {ClipTable(set_, clips_)};
    if (clips_.empty()) return files;
    NoteLosses(notes);
    FileDeclaration declaration;
    declaration.layout = "amass_babel";
    declaration.source = source_;
    std::vector<std::string> annotations;
    std::map<std::string, std::string> roles;
    for (const auto& [part, name] : kBabelParts) {
      std::vector<BabelSequence>& sequences = sequences_[part];
      if (sequences.empty() && std::string(part) == "other") continue;
      annotations.push_back(kBabelFolder + std::string("/") + name);
      roles[annotations.back()] = part;
      files.push_back({annotations.back(), EncodeBabel(Numbered(sequences))});
    }
    std::map<std::string, std::string> codes;
    files.push_back(LabelTable(codes));
    declaration.options = {{"format", "amass"},
                           {"files", YamlQuoted("{dataset}/{person}/{take}_poses.npz")},
                           {"other_files", "ignore"},
                           {"axes", YamlQuoted(kZUp)},
                           {"annotations", YamlList(annotations)},
                           {"person", YamlQuoted("{person}")},
                           {"recording", YamlQuoted(std::string("{take}") + (named_poses_ ? kPoses : ""))},
                           {"label", "\"\""},
                           {"label_table", kLabelTable}};
    if (parts_come_back_ && !parts_.empty()) {
      declaration.options.emplace_back("annotation_roles", YamlMap(roles));
      declaration.role_split = set_.splits.front().name;
    }
    if (!codes.empty()) declaration.options.emplace_back("labels", YamlMap(codes));
    AddDeclaration(set_, clips_, declaration, notes, files);
    return files;
  }

 private:
  void NoteLosses(std::vector<std::string>& notes) const {
    notes.push_back("read again, on the bones of smpl24, joints lie up to " + RoundedText(1000.0 * farthest_, 2) +
                    " mm off; the joints left_hand and right_hand have no rotation in SMPL-H");
    const auto floorless = std::count_if(clips_.begin(), clips_.end(),
                                         [](const WrittenClip& clip) { return clip.origin != kOriginFloor; });
    notes.push_back("height 0 is the floor under " +
                    Counted(static_cast<long long>(clips_.size()) - static_cast<long long>(floorless), "clip") +
                    "; `raised_m` of clips.csv is how far each was raised");
    if (floorless > 0) {
      notes.push_back("under " + Counted(static_cast<long long>(floorless), "clip") +
                      " the floor is unknown, as no foot is ever at rest: height 0 is that of the dataset (`origin` of "
                      "clips.csv)");
    }
    if (parts_.empty()) notes.push_back("the set has no split: train.json has all labels");
    if (set_.splits.size() > 1) {
      notes.push_back("the labels are divided by split '" + set_.splits.front().name + "', the first of " +
                      std::to_string(set_.splits.size()) + "; choose another with --split");
    }
    if (sequences_.count("other") > 0) notes.push_back("labels of clips in no part of the split: other.json");
  }

  /// Sequences without a BABEL number get unused ones.
  const std::vector<BabelSequence>& Numbered(std::vector<BabelSequence>& sequences) {
    for (BabelSequence& sequence : sequences) {
      while (sequence.babel_sid == 0) {
        if (sids_.insert(++last_sid_).second) sequence.babel_sid = last_sid_;
      }
      sequence.key = std::to_string(sequence.babel_sid);
    }
    return sequences;
  }

  /// "motion,label" for each take: BABEL's labels come back as segments, not as the clip's label. `codes` receives a
  /// replacement for each label that does not fit a cell.
  ExportedFile LabelTable(std::map<std::string, std::string>& codes) const {
    FileNames names;
    bool plain = true;
    for (const WrittenClip& clip : clips_) {
      names.Of(clip.label);
      plain = plain && FitsCell(clip.label);
    }
    std::string text = "motion,label\n";
    for (std::size_t i = 0; i < clips_.size(); ++i) {
      std::string cell = clips_[i].label;
      if (!plain) {
        cell = names.Of(cell);
        codes[cell] = clips_[i].label;
      }
      text += takes_[i] + "," + cell + "\n";
    }
    return {kLabelTable, std::move(text)};
  }

  const ExportSet set_;
  const ClipNames names_;
  std::string source_;      ///< top folder
  std::vector<int> parts_;  ///< of the split; empty: there is none
  std::vector<WrittenClip> clips_;
  std::vector<std::string> takes_;                               ///< of clips_
  std::map<std::string, std::vector<BabelSequence>> sequences_;  ///< by part
  std::set<std::int64_t> sids_;
  std::int64_t last_sid_ = 0;
  bool named_poses_ = true;      ///< the recordings have AMASS's suffix already: nothing is appended to their names
  bool parts_come_back_ = true;  ///< every clip is in a part, and in that part's file
  double farthest_ = 0.0;        ///< metres
};

}  // namespace

std::unique_ptr<LayoutWriter> MakeAmassBabelLayout(const ExportSet& set) {
  return std::make_unique<AmassBabelWriter>(set);
}

}  // namespace mocurate
