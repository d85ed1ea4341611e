#include "core/store/dataset_clips.h"

#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "core/base/sha256.h"
#include "core/store/content_file.h"
#include "core/store/fields.h"

namespace mocurate {
namespace {

using store::Array;
using store::Content;
using store::Field;
using store::Hdf5Reader;

constexpr std::uint64_t kBlockBytes = 4ull << 20;

bool Below(const std::string& path, const char* group) { return path.rfind(group, 0) == 0; }

/// Rows `rows` of an array.
Array RowsOf(const Array& array, const std::vector<std::size_t>& rows) {
  std::uint64_t width = 1;
  for (std::size_t d = 1; d < array.shape.size(); ++d) width *= array.shape[d];
  Array some;
  some.shape = array.shape;
  some.shape[0] = rows.size();
  std::visit(
      [&](const auto& values) {
        std::decay_t<decltype(values)> chosen;
        for (const std::size_t row : rows) {
          const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width);
          chosen.insert(chosen.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
        }
        some.values = std::move(chosen);
      },
      array.values);
  return some;
}

/// Bit of an optional field of /frames in /clips/field_mask; -1 for others.
int MaskBit(const std::string& path) {
  constexpr std::string_view kFrames = "/frames/";
  if (path.rfind(kFrames, 0) != 0) return -1;
  for (std::size_t bit = 0; bit < store::kOptionalFrameFields.size(); ++bit) {
    if (path.compare(kFrames.size(), std::string::npos, store::kOptionalFrameFields[bit]) == 0) {
      return static_cast<int>(bit);
    }
  }
  return -1;
}

}  // namespace

struct DatasetClips::File {
  Hdf5Reader reader;
  Content content;                                                 ///< all but the frames
  std::map<std::string, std::vector<std::uint64_t>> frame_fields;  ///< path -> shape
  SkeletonPtr skeleton;
  AxisConvention axes;
  std::vector<std::vector<std::size_t>> segments;  ///< rows of /segments of each clip
  mutable Content one;                             ///< what all clips share, and the clip read last
  mutable std::optional<std::size_t> held;         ///< its row; files of one clip are read once
  mutable bool shared_is_sound = false;            ///< the rules for what all clips share

  std::string Where(const std::string& field) const { return store::Where(reader.file(), field); }
  void SortByClip();
  Expected<const Content*> OneClip(std::size_t row) const;
  Status CheckClip() const;
  Expected<Array> FramesOf(std::size_t row, const Field& field) const;
  /// Whether `path` is a field of /frames that the clip has.
  bool HasField(std::size_t row, const std::string& path) const;
  /// Ids are unique; splits are complete, and their rows are clips of the file.
  Status CheckIdsAndSplits() const;
};

Expected<DatasetClips> DatasetClips::Open(const std::filesystem::path& path, Check check) {
  Expected<Hdf5Reader> reader = Hdf5Reader::Open(path);
  if (!reader) return Forward(reader);
  auto file = std::make_shared<File>(File{std::move(*reader), {}, {}, {}, {}, {}, {}, {}, false});
  if (Status schema = store::CheckSchemaName(store::DatasetSchema(), file->reader); !schema) return Forward(schema);
  std::map<std::string, std::string> lines;
  for (const std::string& name : file->reader.GroupsBelow("/splits")) file->content.splits.insert(name);
  for (const Field& field : store::ConcreteFields(store::DatasetSchema(), file->content)) {
    if (!file->reader.Has(field.path)) continue;
    std::string sha256;
    if (Below(field.path, "/frames/")) {
      const auto shape = file->reader.ShapeOfRows(field.path, field.type);
      if (!shape) return Forward(shape);
      file->frame_fields[field.path] = *shape;
      if (check == Check::kNone) continue;
      Expected<std::string> hash = file->reader.HashOfRows(field.path, field.type, kBlockBytes);
      if (!hash) return Forward(hash);
      sha256 = std::move(*hash);
      lines[field.path] = store::FieldLine(store::EmptyArray(field.type, *shape), sha256);
    } else {
      auto array = file->reader.Read(field.path, field.type);
      if (!array) return Forward(array);
      if (check == Check::kHashes) {
        sha256 = array->Sha256();
        lines[field.path] = store::FieldLine(*array, sha256);
      }
      file->content.fields[field.path] = std::move(*array);
    }
    if (check == Check::kNone) continue;
    if (Status same = store::CheckHash(file->reader, field.path, sha256); !same) return Forward(same);
  }
  const std::vector<std::string> needed = {"/clips/id",    "/clips/label", "/clips/offset",
                                           "/clips/count", "/clips/rate",  "/clips/field_mask"};
  for (const std::string& field : needed) {
    const Array* array = file->content.Find(field);
    const Array* ids = file->content.Find("/clips/id");
    if (array != nullptr && ids != nullptr && array->shape.size() == 1 && array->rows() == ids->rows() &&
        array->size() == array->rows()) {
      continue;
    }
    return Fail(ErrorCode::kMalformed, array == nullptr ? "is missing" : "has not a row per clip", file->Where(field),
                "docs/store_format.md lists the required fields");
  }
  if (check == Check::kHashes) {
    if (Status whole = store::CheckContentHash(file->reader, file->content, lines); !whole) return Forward(whole);
  }
  if (Status splits = file->CheckIdsAndSplits(); !splits) return Forward(splits);
  const auto axes = AxisConvention::Parse(file->content.Text("/@axes"));
  if (!axes) return Fail(ErrorCode::kMalformed, axes.error().what, file->Where("/@axes"));
  file->axes = *axes;
  // All clips share the skeleton: it is checked with the content of the first valid clip.
  const std::size_t rows = file->content.fields.at("/clips/id").rows();
  file->SortByClip();
  if (rows > 0) {
    Expected<const Content*> first = file->OneClip(0);
    for (std::size_t row = 1; !first && row < rows; ++row) {
      if (const Expected<const Content*> next = file->OneClip(row)) first = next;
    }
    if (!first) return Forward(first);
    auto skeleton = std::make_shared<Skeleton>(store::UnpackSkeleton(**first, ""));
    if (Status sound = store::CheckSkeleton(*skeleton, ErrorCode::kMalformed, path, ""); !sound) return Forward(sound);
    file->skeleton = std::move(skeleton);
  }
  return DatasetClips(std::move(file));
}

std::size_t DatasetClips::size() const { return file_->content.fields.at("/clips/id").rows(); }

const std::string& DatasetClips::Id(std::size_t row) const {
  return file_->content.Values<std::string>("/clips/id").at(row);
}

const std::string& DatasetClips::Label(std::size_t row) const {
  return file_->content.Values<std::string>("/clips/label").at(row);
}

const AxisConvention& DatasetClips::axes() const { return file_->axes; }
const SkeletonPtr& DatasetClips::skeleton() const { return file_->skeleton; }

const std::vector<std::string>& DatasetClips::labels() const {
  static const std::vector<std::string> kNone;
  return file_->content.Has("/labels/name") ? file_->content.Values<std::string>("/labels/name") : kNone;
}

std::string DatasetClips::recipe() const { return file_->content.Text("/recipe"); }
std::string DatasetClips::created_by() const { return file_->content.Text("/@created_by"); }

std::vector<std::string> DatasetClips::finding_codes() const {
  if (!file_->content.Has("/findings/code")) return {};
  return file_->content.Values<std::string>("/findings/code");
}

std::vector<Split> DatasetClips::splits() const { return store::UnpackSplits(file_->content); }

std::uint8_t DatasetClips::OptionalFields(std::size_t row) const {
  return file_->content.Values<std::uint8_t>("/clips/field_mask").at(row);
}

std::string DatasetClips::content_sha256() const { return file_->content.Text("/@content_sha256"); }

Expected<Dataset> DatasetClips::Outline() const {
  Content content = file_->content;
  for (const Field& field : store::DatasetSchema().fields) {
    const auto shape = file_->frame_fields.find(field.path);
    if (shape == file_->frame_fields.end()) continue;
    content.fields[field.path] = store::EmptyArray(field.type, shape->second);
    content.later.insert(field.path);
  }
  const auto where = [this](const std::string& field) { return file_->Where(field); };
  if (Status sound = store::CheckContent(store::DatasetSchema(), content, ErrorCode::kMalformed, where); !sound) {
    return Forward(sound);
  }
  auto skeleton = std::make_shared<const Skeleton>(store::UnpackSkeleton(content, ""));
  if (Status sound = store::CheckSkeleton(*skeleton, ErrorCode::kMalformed, file_->reader.file(), ""); !sound) {
    return Forward(sound);
  }
  Dataset dataset;
  dataset.skeleton = skeleton;
  dataset.clips = store::UnpackClips(content);
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    dataset.clips[row].motion = store::UnpackOutline(content, "", skeleton, row);
  }
  store::UnpackDatasetParts(content, dataset);
  return dataset;
}

Expected<std::string> DatasetClips::MotionSha256(std::size_t row) const {
  Sha256 hasher;
  const auto add = [&hasher](const std::string& name, const Array& array) {
    hasher.Add(name + array.ShapeText());
    array.AddTo(hasher);
  };
  const Content& content = file_->content;
  hasher.Add(content.Values<std::string>("/clips/rate").at(row));
  if (content.Has("/clips/bone_length")) {
    add("bone_length", RowsOf(content.fields.at("/clips/bone_length"), {row}));
    const SkeletonPtr own = store::WithRestOffsets(content, "", row, file_->skeleton);
    for (const Joint& joint : own->joints) hasher.Add(joint.rest_offset.data(), 3 * sizeof(double));
  }
  for (const Field& field : store::DatasetSchema().fields) {
    if (!file_->HasField(row, field.path)) continue;
    const auto frames = file_->FramesOf(row, field);
    if (!frames) return Forward(frames);
    add(field.path, *frames);
  }
  return hasher.Hex();
}

OtherFields DatasetClips::ReadOtherFields() const {
  const Hdf5Reader& reader = file_->reader;
  std::set<std::string> known;
  for (const Field& field : store::ConcreteFields(store::DatasetSchema(), file_->content)) known.insert(field.path);
  const auto joints = file_->frame_fields.find("/frames/joints");
  const std::uint64_t frames = joints == file_->frame_fields.end() ? 0 : joints->second.front();
  OtherFields others;
  std::set<std::string> read;  // datasets, which come before their attributes
  const auto paths = reader.PathsBeyond(known);
  if (!paths) others.unreadable["/"] = paths.error().what;
  for (const std::string& path : paths ? *paths : std::vector<std::string>()) {
    const auto of = DatasetOfAttribute(path);
    if (of && !of->empty() && read.count(*of) == 0) {
      if (others.unreadable.count(*of) == 0) others.unreadable[path] = "belongs to a field or group of the format";
      continue;
    }
    Expected<ExtraField> field = reader.ShapeOfExtra(path);
    const bool has_rows = field && !of && !field->shape.empty();
    const bool of_frames = has_rows && Below(path, "/frames/") && field->rows() == frames;
    const bool of_clips = has_rows && Below(path, "/clips/") && field->rows() == size();
    if (field && !of_frames) field = reader.ReadExtra(path);
    if (!field) {
      others.unreadable[path] = field.error().what;
      continue;
    }
    if (!of) read.insert(path);
    (of_frames ? others.of_frames : of_clips ? others.of_clips : others.of_set)[path] = *std::move(field);
  }
  return others;
}

Expected<ExtraField> DatasetClips::ReadOtherFrames(const std::string& field, std::size_t row, int begin,
                                                   int end) const {
  const std::int64_t offset = file_->content.Values<std::int64_t>("/clips/offset").at(row);
  return file_->reader.ReadExtraRows(field, static_cast<std::uint64_t>(offset + begin),
                                     static_cast<std::uint64_t>(end - begin));
}

bool DatasetClips::File::HasField(std::size_t row, const std::string& path) const {
  if (frame_fields.count(path) == 0) return false;
  const int bit = MaskBit(path);
  return bit < 0 || (content.Values<std::uint8_t>("/clips/field_mask")[row] & (1u << bit)) != 0;
}

Status DatasetClips::File::CheckIdsAndSplits() const {
  const std::vector<std::string>& ids = content.Values<std::string>("/clips/id");
  std::set<std::string> seen;
  for (std::size_t row = 0; row < ids.size(); ++row) {
    if (seen.insert(ids[row]).second) continue;
    return Fail(ErrorCode::kMalformed, "two clips have the id '" + ids[row] + "'", Where("/clips/id"));
  }
  for (const std::string& split : content.splits) {
    const std::string group = "/splits/" + split + "/";
    for (const char* field : {"rule", "leak_check", "train", "validation", "test"}) {
      if (content.Has(group + field)) continue;
      return Fail(ErrorCode::kMalformed, "is missing", Where(group + field),
                  "docs/store_format.md lists the required fields");
    }
    for (const char* part : {"train", "validation", "test"}) {
      for (const std::int32_t row : content.Values<std::int32_t>(group + part)) {
        if (row >= 0 && static_cast<std::size_t>(row) < ids.size()) continue;
        return Fail(ErrorCode::kMalformed,
                    "names clip " + std::to_string(row) + " of " + std::to_string(ids.size()) + " clips",
                    Where(group + part));
      }
    }
  }
  return {};
}

/// Rows of a field of /frames that are the clip's.
Expected<Array> DatasetClips::File::FramesOf(std::size_t row, const Field& field) const {
  const std::int64_t offset = content.Values<std::int64_t>("/clips/offset")[row];
  const std::int64_t count = content.Values<std::int64_t>("/clips/count")[row];
  const std::uint64_t rows = frame_fields.at(field.path).front();
  if (offset < 0 || count < 1 || static_cast<std::uint64_t>(offset) > rows ||
      static_cast<std::uint64_t>(count) > rows - static_cast<std::uint64_t>(offset)) {
    return Fail(ErrorCode::kMalformed,
                "row " + std::to_string(row) + " takes " + std::to_string(count) + " frames from " +
                    std::to_string(offset) + " of " + std::to_string(rows),
                Where("/clips/offset"));
  }
  return reader.ReadRows(field.path, field.type, static_cast<std::uint64_t>(offset), static_cast<std::uint64_t>(count));
}

void DatasetClips::File::SortByClip() {
  segments.resize(content.fields.at("/clips/id").rows());
  const Array* of_clips = content.Find("/segments/clip");
  for (std::size_t i = 0; of_clips != nullptr && i < of_clips->size(); ++i) {
    const auto row = static_cast<std::size_t>(of_clips->as<std::int32_t>()[i]);
    if (row < segments.size()) segments[row].push_back(i);
  }
  for (const auto& [path, array] : content.fields) {
    const bool of_one = Below(path, "/clips/") || Below(path, "/segments/");
    if (!of_one && !Below(path, "/splits/") && !Below(path, "/findings/")) one.fields[path] = array;
  }
}

/// By the rules of the table.
Status DatasetClips::File::CheckClip() const {
  const auto where = [this](const std::string& field) { return Where(field); };
  const store::Schema& schema = store::DatasetSchema();
  if (!shared_is_sound) {
    Status sound = store::CheckContent(schema, one, ErrorCode::kMalformed, where);
    shared_is_sound = sound.has_value();
    return sound;
  }
  Status sound = store::CheckFields(schema, one, ErrorCode::kMalformed, where);
  for (const char* group : {"/clips/", "/segments/", "/frames/"}) {
    if (sound) sound = store::CheckRulesBelow(group, schema, one, ErrorCode::kMalformed, where);
  }
  return sound;
}

/// Content with this clip alone, checked; until the next call.
Expected<const Content*> DatasetClips::File::OneClip(std::size_t row) const {
  if (held == row) return &one;
  held.reset();
  const std::uint64_t clips = content.fields.at("/clips/id").rows();
  const Array* of_clips = content.Find("/segments/clip");
  const std::uint64_t segment_count = of_clips == nullptr ? 0 : of_clips->rows();
  for (const auto& [path, array] : content.fields) {
    const bool of_clip = Below(path, "/clips/");
    if (!of_clip && !Below(path, "/segments/")) continue;
    const std::uint64_t rows = of_clip ? clips : segment_count;
    if (array.shape.empty() || array.rows() != rows || array.count() != array.size()) {
      return Fail(ErrorCode::kMalformed, "has shape " + array.ShapeText() + ", not a row each", Where(path));
    }
    one.fields[path] = RowsOf(array, of_clip ? std::vector<std::size_t>{row} : segments[row]);
  }
  if (of_clips != nullptr) {
    one.Put("/segments/clip", {segments[row].size()}, std::vector<std::int32_t>(segments[row].size(), 0));
  }
  one.Put("/clips/offset", {1}, std::vector<std::int64_t>{0});
  one.PutText("/@rate", content.Values<std::string>("/clips/rate")[row]);
  for (const Field& field : store::DatasetSchema().fields) {
    if (frame_fields.count(field.path) == 0) continue;
    one.fields.erase(field.path);
    if (!HasField(row, field.path)) continue;
    auto array = FramesOf(row, field);
    if (!array) return Forward(array);
    one.fields[field.path] = std::move(*array);
  }
  if (Status sound = CheckClip(); !sound) {
    Error error = sound.error();
    error.hint += (error.hint.empty() ? "" : "; ") + std::string("correct the clip or exclude it: the others are read");
    return tl::unexpected<Error>(error);
  }
  held = row;
  return &one;
}

Expected<Clip> DatasetClips::Read(std::size_t row) const {
  const Expected<const Content*> one = file_->OneClip(row);
  if (!one) return Forward(one);
  Clip clip = std::move(store::UnpackClips(**one)[0]);
  clip.motion = std::move(store::UnpackMotions(**one, "", file_->skeleton)[0]);
  return clip;
}

}  // namespace mocurate
