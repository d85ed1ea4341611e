#include "canon/assemble/clip_files.h"

#include "canon/splits/leaks.h"
#include "core/store/dataset_writer.h"
#include "core/store/fields.h"

namespace mocurate {
namespace {

/// Files come sorted by item, so clips of a person are rarely further apart than this many persons.
constexpr std::size_t kSkeletons = 256;

/// Whether a clip of a set has its frames in memory.
bool HasFrames(const Clip& clip) { return !clip.motion->joints.empty(); }

}  // namespace

/// Clips of one person have equal skeletons, each from its own file: one of them is kept.
SkeletonPtr ClipFiles::Shared(SkeletonPtr skeleton) {
  if (!skeleton) return skeleton;
  for (const SkeletonPtr& known : skeletons_) {
    const bool may_be = known->joints.size() == skeleton->joints.size() && SameRestOffsets(*known, *skeleton);
    if (may_be && store::SameSkeleton(*known, *skeleton)) return known;
  }
  skeletons_.push_front(skeleton);
  if (skeletons_.size() > kSkeletons) skeletons_.pop_back();
  return skeleton;
}

Status ClipFiles::Add(const StageInput& input, Dataset& set) {
  const auto clips = DatasetClips::Open(input.path, DatasetClips::Check::kNone);
  if (!clips) return Forward(clips);
  auto part = clips->Outline();
  if (!part) return Forward(part);
  if (set.clips.empty()) set.joints_only = part->joints_only;
  if (part->joints_only != set.joints_only) {
    return Fail(
        ErrorCode::kInconsistent,
        part->joints_only ? "has joints only, the others have rotations" : "has rotations, the others have joints only",
        input.name, "put them into separate datasets");
  }
  for (std::size_t row = 0; row < part->clips.size(); ++row) {
    Clip& clip = part->clips[row];
    clip.motion->skeleton = Shared(std::move(clip.motion->skeleton));
    clip.motion->rotation_reference = Shared(std::move(clip.motion->rotation_reference));
    items_[clip.id()] = input.name;
    places_[clip.id()] = {files_.size(), row, clips->OptionalFields(row)};
    set.clips.push_back(std::move(clip));
  }
  files_.push_back(input.path);
  set.findings.insert(set.findings.end(), part->findings.begin(), part->findings.end());
  return {};
}

Expected<std::vector<std::string>> ClipFiles::Contents(const Dataset& set) const {
  std::vector<std::string> contents;
  const std::vector<bool> needed = DistinguishedByMotion(set.clips);
  for (const Clip& clip : set.clips) {
    contents.emplace_back();
    if (!needed[contents.size() - 1] || HasFrames(clip)) continue;
    const Place& place = places_.at(clip.id());
    const auto clips = DatasetClips::Open(files_[place.file], DatasetClips::Check::kNone);
    if (!clips) return Forward(clips);
    auto hash = clips->MotionSha256(place.row);
    if (!hash) return Forward(hash);
    contents.back() = *std::move(hash);
  }
  return contents;
}

Expected<const DatasetClips*> ClipFiles::Opened(std::size_t file) {
  if (!opened_ || opened_->first != file) {
    opened_.reset();
    auto clips = DatasetClips::Open(files_[file], DatasetClips::Check::kHashes);
    if (!clips) return Forward(clips);
    opened_.emplace(file, *std::move(clips));
  }
  return &opened_->second;
}

Expected<Clip> ClipFiles::WithFrames(const Clip& clip) {
  const Place& place = places_.at(clip.id());
  const auto clips = Opened(place.file);
  if (!clips) return Forward(clips);
  auto read = (*clips)->Read(place.row);
  if (!read) return Forward(read);
  Clip whole = clip;
  const SkeletonPtr skeleton = clip.motion->skeleton, rotation_reference = clip.motion->rotation_reference;
  whole.motion = std::move(read->motion);
  whole.motion->skeleton = skeleton;
  whole.motion->rotation_reference = rotation_reference;
  return whole;
}

Status ClipFiles::Write(const Dataset& set, const std::filesystem::path& path) {
  std::vector<std::uint8_t> optional_fields;
  for (const Clip& clip : set.clips) {
    optional_fields.push_back(HasFrames(clip) ? OptionalFieldsOf(*clip.motion) : places_.at(clip.id()).optional_fields);
  }
  auto writer = DatasetWriter::Create(set, optional_fields, path);
  if (!writer) return Forward(writer);
  for (const Clip& clip : set.clips) {
    if (HasFrames(clip)) {
      if (Status written = writer->Append(clip); !written) return written;
      continue;
    }
    const auto whole = WithFrames(clip);
    if (!whole) return Forward(whole);
    if (Status written = writer->Append(*whole); !written) return written;
  }
  return writer->Finish();
}

}  // namespace mocurate
