#include "canon/values/set_files.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/store/dataset_writer.h"
#include "core/store/fields.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Fields of datasets' files that the format does not name, in a dataset that is made of them.
struct KeptFields {
  ExtraFields fields;             ///< for DatasetWriter::Create: those of frames without values
  std::vector<Finding> findings;  ///< "field_dropped" for each of the others
};

/// How what a file holds differs from the dataset that is made.
struct Change {
  bool clips = false;   ///< their ids or order
  bool frames = false;  ///< of some clip, or the clips
  bool joints = false;  ///< of the skeleton
};

Change ChangeOf(const Dataset& before, const Dataset& made) {
  Change change;
  change.clips = !std::equal(before.clips.begin(), before.clips.end(), made.clips.begin(), made.clips.end(),
                             [](const Clip& a, const Clip& b) { return a.id() == b.id(); });
  change.frames = change.clips || !std::equal(before.clips.begin(), before.clips.end(), made.clips.begin(),
                                              [](const Clip& a, const Clip& b) {
                                                return a.motion->frame_count() == b.motion->frame_count();
                                              });
  change.joints = before.skeleton && made.skeleton && !SameTree(*before.skeleton, *made.skeleton);
  return change;
}

std::int64_t FramesOf(const Dataset& dataset) {
  std::int64_t frames = 0;
  for (const Clip& clip : dataset.clips) frames += clip.motion->frame_count();
  return frames;
}

/// The group of the table that a path stands in: "/labels", "/splits/NAME"; empty: none.
std::string GroupOf(const std::string& path) {
  for (const char* group : {"/clips", "/frames", "/skeleton", "/segments", "/labels", "/fine_labels", "/findings"}) {
    if (path.rfind(std::string(group) + "/", 0) == 0) return group;
  }
  constexpr std::string_view kSplits = "/splits/";
  if (path.rfind(kSplits, 0) != 0) return "";
  return path.substr(0, path.find('/', kSplits.size()));
}

/// What the table's fields of the groups hold, but for /clips and /frames.
store::Content TableOf(const Dataset& dataset) {
  store::Content content;
  std::vector<const Clip*> clips;
  for (const Clip& clip : dataset.clips) clips.push_back(&clip);
  store::PackSkeleton(*dataset.skeleton, "", content);
  store::PackClips(clips, content);
  store::PackLabels(dataset, content);
  store::PackFindings(dataset.findings, content);
  (void)store::PackSplits(dataset.splits, content);
  return content;
}

bool SameGroup(const std::string& group, const Dataset& before, const Dataset& made, const Change& change) {
  if (group == "/clips") return !change.clips;
  if (group == "/frames") return !change.frames;
  const auto below = [&](const Dataset& dataset) {
    std::vector<std::pair<std::string, store::Array>> fields;
    for (auto& [path, array] : TableOf(dataset).fields) {
      if (path.rfind(group + "/", 0) == 0) fields.emplace_back(path, array);
    }
    return fields;
  };
  return below(before) == below(made);
}

/// The fields that all files have alike. Rows of clips and frames follow their clips. Dropped is a field that some file
/// lacks, that cannot be read, or that no longer fits: frames, clips or joints changed, or the group that it stands in;
/// one of the whole set also where the files' values differ. `repeated`: clips of several files, each with the origin
/// that was taken; their values must be equal. Frames of `made` are not looked at, but their numbers.
class FieldKeeper {
 public:
  FieldKeeper(const Dataset& made, const std::vector<ClipOrigin>& origins,
              const std::vector<std::pair<ClipOrigin, ClipOrigin>>& repeated, const std::vector<DatasetFile>& files)
      : made_(made), origins_(origins), repeated_(repeated), files_(files) {
    for (const DatasetFile& file : files) {
      others_.push_back(file.clips.ReadOtherFields());
      changes_.push_back(ChangeOf(file.outline, made));
    }
  }

  KeptFields Keep() {
    std::set<std::string> paths;
    for (const OtherFields& others : others_) {
      for (const auto& [path, reason] : others.unreadable) paths.insert(path);
      for (const ExtraFields* fields : {&others.of_clips, &others.of_frames, &others.of_set}) {
        for (const auto& [path, field] : *fields) paths.insert(path);
      }
    }
    // A finding about a dropped field is one of /findings.
    std::vector<std::string> ordered(paths.begin(), paths.end());
    std::stable_partition(ordered.begin(), ordered.end(),
                          [](const std::string& path) { return GroupOf(path) != "/findings"; });
    for (const std::string& path : ordered) KeepOne(path);
    return std::move(kept_);
  }

 private:
  using Kind = ExtraFields OtherFields::*;

  const ExtraField* Find(std::size_t file, Kind kind, const std::string& path) const {
    const ExtraFields& fields = others_[file].*kind;
    const auto found = fields.find(path);
    return found == fields.end() ? nullptr : &found->second;
  }

  void KeepOne(const std::string& path) {
    const auto dataset = DatasetOfAttribute(path);
    if (dataset && dropped_.count(*dataset) > 0) return;  // with its field
    Kind kind = &OtherFields::of_set;
    for (const Kind one : {&OtherFields::of_clips, &OtherFields::of_frames}) {
      if (Find(0, one, path) != nullptr) kind = one;
    }
    std::optional<std::string> reason = WhyDropped(path, kind, dataset.has_value());
    if (!reason) reason = Take(path, kind);
    if (!reason) return;
    dropped_.insert(path);
    kept_.findings.push_back(
        MakeFinding("field_dropped", Severity::kWarning, 0.0, path + ": " + *reason, FindingAction::kDropped));
  }

  std::optional<std::string> WhyDropped(const std::string& path, Kind kind, bool attribute) const {
    for (std::size_t file = 0; file < files_.size(); ++file) {
      const auto unreadable = others_[file].unreadable.find(path);
      if (unreadable != others_[file].unreadable.end()) return unreadable->second + " in " + files_[file].name;
      const ExtraField* field = Find(file, kind, path);
      const ExtraField* first = Find(0, kind, path);
      if (field == nullptr || first == nullptr) {
        return "is not in " + files_[field == nullptr ? file : 0].name + ", or of another shape there";
      }
      const bool of_set = kind == &OtherFields::of_set;
      if (!of_set && !field->HasRowsLike(*first)) return "is of another type or shape in " + files_[file].name;
      if (of_set && !(*field == *first)) return "has other values in " + files_[file].name;
      if (attribute) continue;
      if (auto reason = WhyUnfit(path, kind, *field, file)) return reason;
    }
    return std::nullopt;
  }

  /// Why a field does not fit what changed.
  std::optional<std::string> WhyUnfit(const std::string& path, Kind kind, const ExtraField& field,
                                      std::size_t file) const {
    const Dataset& before = files_[file].outline;
    const Change& change = changes_[file];
    const bool of_set = kind == &OtherFields::of_set;
    const std::string group = of_set ? GroupOf(path) : "";
    const auto joints = static_cast<std::uint64_t>(before.skeleton ? before.skeleton->joint_count() : 0);
    if (change.joints && std::count(field.shape.begin() + (of_set ? 0 : 1), field.shape.end(), joints) > 0) {
      return "has " + std::to_string(joints) + " values, as skeleton '" + before.skeleton->name +
             "' has joints; the skeleton is '" + made_.skeleton->name + "' now";
    }
    if (!group.empty()) {
      const bool same = SameGroup(group, before, made_, change) && (group != "/findings" || kept_.findings.empty());
      return same ? std::nullopt : std::optional<std::string>("the rows of " + group + " are others now");
    }
    if (!of_set || field.shape.empty()) return std::nullopt;
    if (change.clips && field.rows() == before.clips.size()) {
      return "has as many rows as clips, which are others now; below /clips they follow";
    }
    if (change.frames && field.rows() == static_cast<std::uint64_t>(FramesOf(before))) {
      return "has as many rows as frames, which are others now; below /frames they follow";
    }
    return std::nullopt;
  }

  /// Adds the field to those that are kept; else the reason why its rows cannot follow.
  std::optional<std::string> Take(const std::string& path, Kind kind) {
    if (kind == &OtherFields::of_set) {
      kept_.fields[path] = others_.front().of_set.at(path);
      return std::nullopt;
    }
    if (kind == &OtherFields::of_clips) return TakeRowsOfClips(path);
    ExtraField shape = others_.front().of_frames.at(path);
    shape.shape[0] = 0;
    for (std::size_t i = 0; i < origins_.size(); ++i) {
      const int frames = made_.clips[i].motion->frame_count();
      if (origins_[i].end - origins_[i].begin != frames) {
        return "clip '" + made_.clips[i].id() + "' has " + std::to_string(frames) + " frames, the field has " +
               std::to_string(origins_[i].end - origins_[i].begin) + " for it";
      }
      shape.shape[0] += static_cast<std::uint64_t>(frames);
    }
    for (const auto& [a, b] : repeated_) {
      const auto of_a = files_[a.file].clips.ReadOtherFrames(path, a.row, a.begin, a.end);
      const auto of_b = files_[b.file].clips.ReadOtherFrames(path, b.row, b.begin, b.end);
      if (!of_a || !of_b) return (of_a ? of_b : of_a).error().what;
      if (!(*of_a == *of_b)) return OtherValues(a, b);
    }
    kept_.fields[path] = std::move(shape);
    return std::nullopt;
  }

  std::optional<std::string> TakeRowsOfClips(const std::string& path) {
    const auto row_of = [&](const ClipOrigin& origin) {
      return others_[origin.file].of_clips.at(path).Rows(origin.row, origin.row + 1);
    };
    for (const auto& [a, b] : repeated_) {
      if (!(row_of(a) == row_of(b))) return OtherValues(a, b);
    }
    ExtraField rows = others_.front().of_clips.at(path).Rows(0, 0);
    for (const ClipOrigin& origin : origins_) rows.Append(row_of(origin));
    kept_.fields[path] = std::move(rows);
    return std::nullopt;
  }

  std::string OtherValues(const ClipOrigin& a, const ClipOrigin& b) const {
    return "has other values of clip '" + files_[a.file].outline.clips[a.row].id() + "' in " + files_[a.file].name +
           " and " + files_[b.file].name;
  }

  const Dataset& made_;
  const std::vector<ClipOrigin>& origins_;
  const std::vector<std::pair<ClipOrigin, ClipOrigin>>& repeated_;
  const std::vector<DatasetFile>& files_;
  std::vector<OtherFields> others_;
  std::vector<Change> changes_;
  std::set<std::string> dropped_;
  KeptFields kept_;
};

/// The last `count` parts of a path.
std::string EndOf(const fs::path& path, std::size_t count) {
  std::vector<fs::path> parts(path.begin(), path.end());
  fs::path end;
  for (std::size_t i = parts.size() - std::min(count, parts.size()); i < parts.size(); ++i) end /= parts[i];
  return DisplayPath(end);
}

}  // namespace

std::vector<std::string> NamesOfFiles(const std::vector<fs::path>& paths) {
  std::size_t longest = 1;
  for (const fs::path& path : paths) {
    longest = std::max(longest, static_cast<std::size_t>(std::distance(path.begin(), path.end())));
  }
  std::vector<std::string> names;
  for (std::size_t count = 1; count <= longest; ++count) {
    names.clear();
    for (const fs::path& path : paths) {
      names.push_back(EndOf(path, path.filename() == "dataset.h5" ? std::max<std::size_t>(count, 2) : count));
    }
    if (std::set<std::string>(names.begin(), names.end()).size() == names.size()) break;
  }
  return names;
}

Expected<std::vector<DatasetFile>> OpenDatasetFiles(const std::vector<fs::path>& paths) {
  const std::vector<std::string> names = NamesOfFiles(paths);
  std::vector<DatasetFile> files;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    auto clips = DatasetClips::Open(paths[i], DatasetClips::Check::kHashes);
    if (!clips) return Forward(clips);
    auto outline = clips->Outline();
    if (!outline) return Forward(outline);
    files.push_back({names[i], std::move(*outline), std::move(*clips)});
  }
  return files;
}

ClipOrigin WholeClip(std::size_t file, std::size_t row, const std::vector<DatasetFile>& files) {
  return {file, row, 0, files[file].outline.clips[row].motion->frame_count()};
}

std::vector<ClipOrigin> WholeClips(const std::vector<std::size_t>& rows, const std::vector<DatasetFile>& files) {
  std::vector<ClipOrigin> origins;
  for (const std::size_t row : rows) origins.push_back(WholeClip(0, row, files));
  return origins;
}

std::vector<ClipOrigin> WholeClips(const std::vector<DatasetFile>& files) {
  std::vector<std::size_t> rows(files.front().outline.clips.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return WholeClips(rows, files);
}

Expected<std::vector<Finding>> WriteFromFiles(Dataset& made, const std::vector<ClipOrigin>& origins,
                                              const std::vector<DatasetFile>& files, const fs::path& to,
                                              const std::vector<std::pair<ClipOrigin, ClipOrigin>>& repeated) {
  KeptFields kept = FieldKeeper(made, origins, repeated, files).Keep();
  made.findings.insert(made.findings.end(), kept.findings.begin(), kept.findings.end());
  const auto has_frames = [](const Clip& clip) { return !clip.motion->joints.empty(); };
  std::vector<std::uint8_t> optional_fields;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const Clip& clip = made.clips[i];
    optional_fields.push_back(has_frames(clip) ? OptionalFieldsOf(*clip.motion)
                                               : files[origins[i].file].clips.OptionalFields(origins[i].row));
  }
  std::vector<std::string> of_frames;
  for (const auto& [path, field] : kept.fields) {
    if (!field.HasValues()) of_frames.push_back(path);
  }
  auto writer = DatasetWriter::Create(made, optional_fields, to, std::move(kept.fields));
  if (!writer) return Forward(writer);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const ClipOrigin& origin = origins[i];
    const DatasetClips& clips = files[origin.file].clips;
    ExtraFields frames;
    for (const std::string& path : of_frames) {
      auto rows = clips.ReadOtherFrames(path, origin.row, origin.begin, origin.end);
      if (!rows) return Forward(rows);
      frames[path] = *std::move(rows);
    }
    const auto read = has_frames(made.clips[i]) ? Expected<Clip>(made.clips[i]) : clips.Read(origin.row);
    if (!read) return Forward(read);
    if (Status written = writer->Append(*read, frames); !written) return Forward(written);
  }
  if (Status finished = writer->Finish(); !finished) return Forward(finished);
  return std::move(kept.findings);
}

}  // namespace mocurate
