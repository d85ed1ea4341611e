#include "core/base/text.h"
#include "core/formats/phspd_text.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"
#include "ingest/sources/phspd_tracks.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

/// PHSPD's pose.txt -> evidence tracks on SMPL's joints. Frames that nobody annotated are missing, in their place.
Expected<IngestedClip> ReadPhspdClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<SkeletonPtr> skeleton = LoadSkeleton("smpl24");
  if (!skeleton) return Forward(skeleton);
  const Expected<std::vector<int>> columns = SmplColumns(**skeleton, kSmplJoints);
  if (!columns) return Forward(columns);
  Expected<PhspdTracks> read = ReadPhspdTracks(file.bytes, file.name, source.damaged_rows);
  if (!read) return Forward(read);

  const int frames = read->positions.frames;
  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  ingested.findings = std::move(read->findings);
  JointTracks tracks;
  tracks.positions = JointPositions(frames, kPhspdJoints);
  tracks.confidence.assign(read->confidence.size(), 0.0);
  for (const Joint& joint : (*skeleton)->joints) tracks.names.push_back(joint.name);
  for (int f = 0; f < frames; ++f) {
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < kPhspdJoints; ++j) {
      const int column = (*columns)[static_cast<std::size_t>(j)] / 3;
      const std::size_t row = static_cast<std::size_t>(f) * kPhspdJoints;
      const double confidence = read->confidence[row + static_cast<std::size_t>(column)];
      tracks.confidence[row + static_cast<std::size_t>(j)] = confidence;
      if (confidence > 0.0)
        tracks.positions.at(f, j) = axes->canonical_from_source * Vector3d(read->positions.at(f, column));
    }
  }
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.provenance["first_frame"] = std::to_string(read->first_frame);
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace

const FormatDriver& PhspdFormat() {
  static const FormatDriver driver = [] {
    FormatDriver d;
    d.format = SourceFormat::kPhspd;
    d.name = "phspd";
    d.inspected = "phspd_pose";
    d.kind = FileKind::kNumbers;
    d.ending = "pose.txt";
    d.gives = Gives::kJointTracks;
    d.unit = UnitOf::kMetres;
    d.to_clip = ReadPhspdClip;
    return d;
  }();
  return driver;
}

}  // namespace mocurate
