#include "core/store/dataset_writer.h"

#include <utility>

#include "core/base/file.h"
#include "core/store/content_file.h"
#include "core/store/fields.h"
#include "core/store/motion_writer.h"

namespace mocurate {
namespace {

Expected<std::vector<store::MotionRow>> RowsOfClips(const std::vector<const Clip*>& clips,
                                                    const std::vector<std::uint8_t>& optional_fields,
                                                    const std::filesystem::path& path) {
  std::vector<store::MotionRow> rows;
  for (const Clip* clip : clips) {
    if (!clip->motion) {
      return Fail(ErrorCode::kInconsistent, "the clip has no motion", store::Where(path, clip->id()));
    }
    if (Status rates = store::CheckRates(*clip, path); !rates) return Forward(rates);
    rows.push_back({clip->id(), &*clip->motion, optional_fields[rows.size()]});
  }
  return rows;
}

/// All fields of a dataset's file except frames and spans.
Expected<store::Content> PackOutline(const Dataset& dataset, const std::vector<const Clip*>& clips,
                                     const std::filesystem::path& path) {
  store::Content content;
  content.PutText("/@kinematics", dataset.joints_only ? "joints" : "tree");
  content.PutText("/@axes", dataset.axes.Text());
  content.PutText("/@created_by", dataset.created_by);
  content.PutText("/recipe", dataset.recipe);
  store::PackSkeleton(*dataset.skeleton, "", content);
  store::PackClips(clips, content);
  content.PutText("/@rate", store::CommonRate(content.Values<std::string>("/clips/rate")));
  if (std::string about = store::AboutText(clips); !about.empty()) content.PutText("/about", std::move(about));
  store::PackLabels(dataset, content);
  store::PackFindings(dataset.findings, content);
  if (Status packed = store::InFile(store::PackSplits(dataset.splits, content), path); !packed) return Forward(packed);
  return content;
}

}  // namespace

DatasetWriter::DatasetWriter(std::unique_ptr<store::MotionWriter> writer) : writer_(std::move(writer)) {}
DatasetWriter::DatasetWriter(DatasetWriter&&) noexcept = default;
DatasetWriter& DatasetWriter::operator=(DatasetWriter&&) noexcept = default;
DatasetWriter::~DatasetWriter() = default;

Expected<DatasetWriter> DatasetWriter::Create(const Dataset& outline, const std::vector<std::uint8_t>& optional_fields,
                                              const std::filesystem::path& path, ExtraFields extra) {
  if (outline.skeleton == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the dataset has no skeleton", DisplayPath(path));
  }
  std::vector<const Clip*> clips;
  for (const Clip& clip : outline.clips) clips.push_back(&clip);
  auto content = PackOutline(outline, clips, path);
  if (!content) return Forward(content);
  content->extra = std::move(extra);
  const auto rows = RowsOfClips(clips, optional_fields, path);
  if (!rows) return Forward(rows);
  const Skeleton& skeleton = *outline.skeleton;
  if (Status checked = store::CheckSkeleton(skeleton, ErrorCode::kInconsistent, path, ""); !checked) {
    return Forward(checked);
  }
  auto writer = store::MotionWriter::Create(store::DatasetSchema(), std::move(*content), *rows, skeleton,
                                            outline.joints_only, path);
  if (!writer) return Forward(writer);
  return DatasetWriter(std::make_unique<store::MotionWriter>(std::move(*writer)));
}

Status DatasetWriter::Append(const Clip& clip, const ExtraFields& frames) {
  const std::string id = clip.id(), next = writer_->NextId();
  if (id != next || !clip.motion) {
    const std::string expected = next.empty() ? "none" : "'" + next + "'";
    return Fail(ErrorCode::kInconsistent, clip.motion ? "the next clip is " + expected : "the clip has no motion", id);
  }
  if (Status written = writer_->Append(*clip.motion); !written) return written;
  for (const auto& [field, rows] : frames) {
    if (Status written = writer_->AppendExtra(field, rows); !written) return written;
  }
  return {};
}

Status DatasetWriter::Finish() { return writer_->Finish(); }

Status WriteDataset(const Dataset& dataset, const std::filesystem::path& path) {
  std::vector<std::uint8_t> optional_fields;
  for (const Clip& clip : dataset.clips) {
    optional_fields.push_back(clip.motion ? OptionalFieldsOf(*clip.motion) : std::uint8_t{0});
  }
  auto writer = DatasetWriter::Create(dataset, optional_fields, path);
  if (!writer) return Forward(writer);
  for (const Clip& clip : dataset.clips) {
    if (Status written = writer->Append(clip); !written) return written;
  }
  return writer->Finish();
}

}  // namespace mocurate
