#include "ingest/sense/reader_check.h"

#include "core/base/file.h"
#include "core/formats/phspd_text.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

using ClipReader = Expected<IngestedClip> (*)(const SourceFile& file);

/// Of formats whose files need no other beside them.
ClipReader ReaderOf(const SourceOptions& source) {
  switch (source.format) {
    case SourceFormat::kJointTable:
      return ReadJointTableClip;
    case SourceFormat::kBvh:
      return ReadBvhClip;
    case SourceFormat::kAmass:
      return ReadAmassClip;
    case SourceFormat::kExpmap:
      return ReadExpmapClip;
    case SourceFormat::kPhspd:
      return ReadPhspdClip;
    case SourceFormat::kVibeTracks:
      return ReadVibeTrackClip;
    case SourceFormat::kUestc:
      return ReadUestcClip;
    case SourceFormat::kNtuSkeleton:
      return source.views.together ? nullptr : ReadNtuSkeletonClip;
    default:
      return nullptr;
  }
}

/// ".../subject03_group2_time4/pose.txt".
bool IsOfPhspd(const std::filesystem::path& path) {
  return path.filename() == "pose.txt" && ParsePhspdRecording(DisplayPath(path.parent_path().filename())).has_value();
}

}  // namespace

std::optional<Error> RefusedByReader(const std::optional<SourceOptions>& source, const std::string& declared_name,
                                     const FileBytes& file) {
  if (!source) {
    if (!IsOfPhspd(file.path)) return std::nullopt;
    const Expected<PhspdPose> pose = ParsePhspdPose(file.bytes, file.name, DamagedRows::kReport);
    return pose ? std::nullopt : std::optional<Error>(pose.error());
  }
  const ClipReader reader = ReaderOf(*source);
  if (reader == nullptr || !source->container.empty() || !CheckSource(*source)) return std::nullopt;
  const Expected<NamedFile> named = ReadName(*source, declared_name);
  if (!named) return std::nullopt;  // told as that
  const std::string bytes(file.bytes);
  const Expected<IngestedClip> clip = reader({*source, *named, file.name, bytes, {}});
  return clip ? std::nullopt : std::optional<Error>(clip.error());
}

}  // namespace mocurate
