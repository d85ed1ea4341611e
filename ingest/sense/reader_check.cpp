#include "ingest/sense/reader_check.h"

#include "core/base/file.h"
#include "ingest/clip_checks.h"
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

}  // namespace

Expected<std::vector<Finding>> SaidByRun(const std::optional<SourceOptions>& source, const std::string& declared_name,
                                         const FileBytes& file) {
  const ClipReader reader = source ? ReaderOf(*source) : nullptr;
  if (reader == nullptr || !source->container.empty() || !CheckSource(*source)) return std::vector<Finding>();
  const Expected<NamedFile> named = ReadName(*source, declared_name);
  if (!named) return std::vector<Finding>();  // told as that
  const std::string bytes(file.bytes);
  Expected<IngestedClip> clip = reader({*source, *named, file.name, bytes, {}});
  if (!clip) return Forward(clip);
  if (!SpoilsPoses(clip->findings)) CheckBody(*source, *clip);
  CheckClip(*source, *named, *clip);
  return std::move(clip->findings);
}

}  // namespace mocurate
