#include "core/base/file.h"
#include "core/store/dataset_clips.h"
#include "ingest/formats/driver.h"
#include "ingest/sources/mapped_file.h"

namespace mocurate {
namespace {

Expected<std::shared_ptr<const DatasetClips>> MotionsOf(const std::filesystem::path& path, DatasetClips::Check check) {
  static KeptOpen<DatasetClips> last;
  return last.Get(path, [&](const std::filesystem::path& file) -> Expected<DatasetClips> {
    Expected<DatasetClips> clips = DatasetClips::Open(file, check);
    if (!clips || clips->axes() == AxisConvention()) return clips;
    return Fail(ErrorCode::kUnsupported, "its axes are not the canonical ones", DisplayPath(file.filename()),
                "write it with right-handed axes, y up, facing +z");
  });
}

/// Named by their ids.
Expected<std::vector<ContainerEntry>> MotionsEntries(const SourceOptions& source, const std::filesystem::path& folder) {
  const auto clips = MotionsOf(folder / source.container, DatasetClips::Check::kHashes);
  if (!clips) return Forward(clips);
  std::vector<ContainerEntry> entries;
  for (std::size_t row = 0; row < (*clips)->size(); ++row) {
    entries.push_back({(*clips)->Id(row), (*clips)->Label(row), 0, ""});
  }
  return entries;
}

/// The hashes were compared when the clips were listed.
Expected<Clip> ReadMotionsEntry(const SourceFile& file) {
  const auto clips = MotionsOf(file.container, DatasetClips::Check::kNone);
  if (!clips) return Forward(clips);
  if (Status there = CheckEntry(file.facts.entry, (*clips)->size(), file.name); !there) return Forward(there);
  return (*clips)->Read(static_cast<std::size_t>(file.facts.entry));
}

/// One clip of a dataset or MotionSet, unchanged: identity, segments and role; rotations where it has them, else joints
/// only. Only the licence and `labels` of the declaration apply.
Expected<IngestedClip> ReadMotionsClip(const SourceFile& file) {
  Expected<Clip> clip = ReadMotionsEntry(file);
  if (!clip) return Forward(clip);
  if (!clip->motion) return Fail(ErrorCode::kInconsistent, "the clip has no motion", file.name);
  IngestedClip ingested;
  ingested.content = clip->id() + '\n' + clip->label + '\n' + BytesOf(clip->motion->joints.xyz);
  for (const Segment& segment : clip->segments) {
    ingested.content += segment.label + '\n' + BytesOf({segment.begin_s, segment.end_s});
  }
  for (const Vector3d& place : clip->motion->root_translation) {
    ingested.content += BytesOf({place.x(), place.y(), place.z()});
  }
  for (const Quaterniond& rotation : clip->motion->rotation) {
    ingested.content += BytesOf({rotation.w(), rotation.x(), rotation.y(), rotation.z()});
  }
  ingested.clip = *std::move(clip);
  const FrameRate recorded = ingested.clip.rate;
  const FrameRate rate = RateOfFile(file.source, recorded.hz(), ingested);
  for (Segment& segment : ingested.clip.segments) {  // they keep the frames that they spanned
    segment.begin_s *= recorded.hz() / rate.hz();
    segment.end_s *= recorded.hz() / rate.hz();
  }
  ingested.clip.rate = ingested.clip.motion->rate = rate;
  return ingested;
}

}  // namespace

FormatDriver MotionsFormat() {
  FormatDriver d;
  d.name = "motions";
  d.gives = EvidenceKind::kMotion;
  d.unit = UnitOf::kMetres;
  d.states_rate = true;
  d.needs_container = true;
  d.stored = true;
  d.options = {"container"};
  d.to_clip = ReadMotionsClip;
  d.entries = MotionsEntries;
  return d;
}

}  // namespace mocurate
