// The layout actor: one pickle in the form of ACTOR's humanact12poses.pkl: `poses`, a list of (T,72) rotation vectors
// of SMPL's joints, `joints3D` of (T,24,3) metres, `y` of class indices, `oldposes` []; x to the image's right, y down,
// the person faces -z. Further keys, which ACTOR does not read: `labels` (names of the classes), `clips` (ids),
// `persons`, `rate_hz`, `splits` {name: {train, validation, test: list indices}}.

#include <algorithm>

#include "canon/exports/clip_names.h"
#include "canon/exports/smpl_arrays.h"
#include "canon/exports/written_set.h"
#include "canon/splits/leaks.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"

namespace mocurate {
namespace {

constexpr const char* kActorAxes = "+x -y -z";
constexpr const char* kActorFile = "actor.pkl";
constexpr double kSamePlace = 1e-4;  // metres

/// Lists of the pickle; all clips' arrays are kept until the end, because the file stores each list as a whole.
class ActorWriter : public LayoutWriter {
 public:
  explicit ActorWriter(const ExportSet& set) : set_(set) {}

  Expected<std::vector<ExportedFile>> Add(std::size_t position, const Clip& clip) override {
    const Expected<std::vector<int>> order = SmplOrder(clip);
    if (!order) return Forward(order);
    const auto label = std::find(set_.labels.begin(), set_.labels.end(), clip.label);
    if (label == set_.labels.end()) {
      return Fail(ErrorCode::kUnsupported, "the clip has no class, its label is '" + clip.label + "'", clip.id(),
                  "`y` needs one; label the clip (`mocurate review`), or export with another layout");
    }
    if (Status same = rate_.Check(clip); !same) return Forward(same);
    const MotionInAxes motion(clip, *AxisConvention::Parse(kActorAxes));
    const auto frames = static_cast<std::size_t>(motion.motion.frame_count());
    constexpr auto kJoints = static_cast<std::size_t>(kSmplBodyJoints);
    poses_.push_back(MakeArray({frames, 3 * kJoints}, motion.RotationVectors(*order)));
    joints_.push_back(MakeArray({frames, kJoints, 3}, motion.Joints(*order)));
    classes_.push_back(label - set_.labels.begin());
    farthest_ = std::max(farthest_, FarthestReadBack(motion.motion, *order, BonesReadBack::kPersons));
    clips_.push_back(WrittenClipOf(position, clip, FileName()));
    clips_.back().person = "unknown";  // as ingest reads the file: ACTOR's lists name no person
    return std::vector<ExportedFile>();
  }

  void RemoveLast() override {}  // no clip has a file of its own

  Expected<std::vector<ExportedFile>> Finish(std::vector<std::string>& notes) override {
    if (clips_.empty()) return std::vector<ExportedFile>();
    Expected<std::string> bytes = Pickle();
    if (!bytes) return Forward(bytes);
    std::vector<ExportedFile> files = {{FileName(), *std::move(bytes)}};
    notes.push_back(
        "ACTOR's lists name neither persons nor recordings: clips come back as c0001, c0002, ... of person "
        "'unknown'; the keys `clips`, `persons` and `splits` hold the originals");
    if (farthest_ > kSamePlace) {
      notes.push_back("read again, on the rest pose of smpl24 and these bone lengths, joints lie up to " +
                      RoundedText(1000.0 * farthest_, 2) + " mm off `joints3D`");
    }
    FileDeclaration declaration;
    if (!set_.file.empty()) declaration.name = std::filesystem::path(set_.file).stem().string() + ".source.yaml";
    declaration.layout = "actor";
    declaration.source = ClipNames(set_.ids, RecordingNames::kOfPerson).source();
    std::map<std::string, std::string> labels;
    for (std::size_t c = 0; c < set_.labels.size(); ++c) {
      labels[ZeroPadded(static_cast<int>(c) + 1, 2)] = set_.labels[c];
    }
    declaration.options = {{"format", "humanact12_pickle"},
                           {"container", YamlQuoted(FileName())},
                           {"files", YamlQuoted("c{clip}_y{action}")},
                           {"axes", YamlQuoted(kActorAxes)},
                           {"rate", FormatDouble(clips_.front().rate.hz()) + " Hz"},
                           {"person", "unknown"},
                           {"recording", YamlQuoted("c{clip}")},
                           {"label", YamlQuoted("{action}")},
                           {"labels", YamlMap(labels)}};
    ExportSet without_splits = set_;
    without_splits.splits.clear();  // ingest does not read persons back
    AddDeclaration(without_splits, clips_, declaration, notes, files);
    return files;
  }

 private:
  std::string FileName() const { return set_.file.empty() ? kActorFile : set_.file; }

  static void AddTexts(PickleWriter& writer, const char* key, const std::vector<std::string>& texts) {
    writer.Text(key);
    writer.BeginList();
    for (const std::string& text : texts) writer.Text(WithoutControls(text));
    writer.End();
  }

  static void AddArrays(PickleWriter& writer, const char* key, const std::vector<NpyArray>& arrays) {
    writer.Text(key);
    writer.BeginList();
    for (const NpyArray& array : arrays) writer.Array(array);
    writer.End();
  }

  void AddSplits(PickleWriter& writer) const {
    writer.Text("splits");
    writer.BeginDict();
    for (const Split& split : set_.splits) {
      const std::vector<int> parts = PartsOf(split, set_.ids.size());
      writer.Text(WithoutControls(split.name));
      writer.BeginDict();
      for (int part = 0; part < 3; ++part) {
        writer.Text(NameOfPart(part));
        writer.BeginList();
        for (std::size_t i = 0; i < clips_.size(); ++i) {
          if (parts[clips_[i].position] == part) writer.Integer(static_cast<std::int64_t>(i));
        }
        writer.End();
      }
      writer.End();
    }
    writer.End();
  }

  Expected<std::string> Pickle() const {
    PickleWriter writer;
    writer.BeginDict();
    AddArrays(writer, "poses", poses_);
    AddArrays(writer, "oldposes", {});
    AddArrays(writer, "joints3D", joints_);
    writer.Text("y");
    writer.BeginList();
    for (const std::int64_t label : classes_) writer.Integer(label);
    writer.End();
    std::vector<std::string> ids, persons;
    for (const WrittenClip& clip : clips_) {
      ids.push_back(set_.ids[clip.position]);
      persons.push_back(PartsOfClipId(ids.back()).person);
    }
    AddTexts(writer, "labels", set_.labels);
    AddTexts(writer, "clips", ids);
    AddTexts(writer, "persons", persons);
    writer.Text("rate_hz");
    writer.Float(clips_.front().rate.hz());
    AddSplits(writer);
    writer.End();
    return writer.Finish(FileName());
  }

  const ExportSet set_;
  OneRate rate_;
  std::vector<NpyArray> poses_;
  std::vector<NpyArray> joints_;
  std::vector<std::int64_t> classes_;
  std::vector<WrittenClip> clips_;
  double farthest_ = 0.0;  ///< metres
};

}  // namespace

std::unique_ptr<LayoutWriter> MakeActorLayout(const ExportSet& set) { return std::make_unique<ActorWriter>(set); }

}  // namespace mocurate
