#include "ingest/formats/driver.h"
#include "ingest/sources/container.h"

namespace mocurate {
namespace {

/// One clip of a dataset or MotionSet, as it is, with its identity, segments and role: rotations where it has them,
/// else joints only. Of the declaration only the licence and `labels` have a say.
Expected<IngestedClip> ReadMotionsClip(const SourceFile& file) {
  Expected<Clip> clip = ReadMotionsEntry(file.container, file.entry, file.name);
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
  for (Segment& segment : ingested.clip.segments) {  // they span the frames that they spanned
    segment.begin_s *= recorded.hz() / rate.hz();
    segment.end_s *= recorded.hz() / rate.hz();
  }
  ingested.clip.rate = ingested.clip.motion->rate = rate;
  return ingested;
}

}  // namespace

const FormatDriver& MotionsFormat() {
  static const FormatDriver driver = [] {
    FormatDriver d;
    d.format = SourceFormat::kMotions;
    d.name = "motions";
    d.inspected = "motions";
    d.gives = Gives::kMotion;
    d.unit = UnitOf::kMetres;
    d.says_rate = true;
    d.container = Container::kMust;
    d.options = {"container"};
    d.to_clip = ReadMotionsClip;
    return d;
  }();
  return driver;
}

}  // namespace mocurate
