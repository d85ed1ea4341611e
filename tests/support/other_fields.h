#pragma once

#include <hdf5.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "core/store/dataset_clips.h"
#include "core/store/dataset_writer.h"

/// Fields of datasets that the format does not name.
namespace mocurate::test {

inline ExtraField Texts(std::vector<std::uint64_t> shape, std::vector<std::string> texts) {
  ExtraField field;
  field.shape = std::move(shape);
  field.texts = std::move(texts);
  return field;
}

inline ExtraField Numbers(std::vector<std::uint64_t> shape, const std::vector<float>& values) {
  ExtraField field;
  field.shape = std::move(shape);
  std::size_t size = 0;
  H5Tencode(H5T_IEEE_F32LE, nullptr, &size);
  field.type.resize(size);
  H5Tencode(H5T_IEEE_F32LE, field.type.data(), &size);
  field.bytes.resize(values.size() * sizeof(float));
  if (!values.empty()) std::memcpy(field.bytes.data(), values.data(), field.bytes.size());
  return field;
}

inline std::vector<float> ValuesOf(const ExtraField& field) {
  std::vector<float> values(field.bytes.size() / sizeof(float));
  if (!values.empty()) std::memcpy(values.data(), field.bytes.data(), field.bytes.size());
  return values;
}

/// 1000 * row of the clip + frame, so that a row tells where it belongs.
inline float MarkOf(std::size_t row, int frame) {
  return static_cast<float>(1000 * row + static_cast<std::size_t>(frame));
}

/// Marked rows of a field of frames with `width` values a row (1: of shape (F,)).
inline ExtraField MarkedFrames(std::size_t row, int frames, int width) {
  std::vector<float> values;
  for (int f = 0; f < frames; ++f) {
    for (int k = 0; k < width; ++k) values.push_back(MarkOf(row, f) + 0.25f * static_cast<float>(k % 4));
  }
  std::vector<std::uint64_t> shape = {static_cast<std::uint64_t>(frames)};
  if (width > 1) shape.push_back(static_cast<std::uint64_t>(width));
  return Numbers(std::move(shape), values);
}

/// Writes a dataset with /clips/score (C), /clips/note (texts), /frames/mark (F), /frames/joint_mark (F,J), /about_it,
/// an attribute of the first and one of the root.
inline Status WriteWithOtherFields(const Dataset& dataset, const std::filesystem::path& path) {
  const int joints = dataset.skeleton->joint_count();
  const std::uint64_t clips = dataset.clips.size();
  std::vector<std::uint8_t> optional_fields;
  std::vector<float> scores;
  std::vector<std::string> notes;
  int frames = 0;
  for (std::size_t row = 0; row < clips; ++row) {
    optional_fields.push_back(OptionalFieldsOf(*dataset.clips[row].motion));
    scores.push_back(MarkOf(row, 0));
    notes.push_back("note of " + dataset.clips[row].id());
    frames += dataset.clips[row].motion->frame_count();
  }
  ExtraFields extra;
  extra["/clips/score"] = Numbers({clips}, scores);
  extra["/clips/score/@unit"] = Texts({}, {"points"});
  extra["/clips/note"] = Texts({clips}, notes);
  extra["/about_it"] = Texts({}, {"a paper"});
  extra["/@doi"] = Texts({}, {"10.1000/1"});
  for (const auto& [field, width] : {std::pair("/frames/mark", 1), std::pair("/frames/joint_mark", joints)}) {
    extra[field] = MarkedFrames(0, frames, width);
    extra[field].bytes.clear();
  }
  auto writer = DatasetWriter::Create(dataset, optional_fields, path, std::move(extra));
  if (!writer) return Forward(writer);
  for (std::size_t row = 0; row < clips; ++row) {
    const Clip& clip = dataset.clips[row];
    const int count = clip.motion->frame_count();
    const ExtraFields own = {{"/frames/mark", MarkedFrames(row, count, 1)},
                             {"/frames/joint_mark", MarkedFrames(row, count, joints)}};
    if (Status written = writer->Append(clip, own); !written) return written;
  }
  return writer->Finish();
}

}  // namespace mocurate::test
