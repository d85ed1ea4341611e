#include <algorithm>

#include "core/base/text.h"
#include "ingest/sources/ntu_people.h"

namespace mocurate {

Expected<IngestedClip> ReadNtuSkeletonClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(file.bytes, file.name, source.damaged_rows);
  if (!skeleton) return Forward(skeleton);
  const std::size_t wanted = static_cast<std::size_t>(std::max(1, file.named.bodies));
  const Expected<People> people = NtuPeople(*skeleton, source, wanted);
  if (!people) return Forward(people);
  const std::size_t own = static_cast<std::size_t>(std::max(1, file.named.body)) - 1;
  if (own >= people->chosen.size()) {
    return tl::unexpected<Error>(PersonNotThere(own + 1, wanted, *people, skeleton->frames.size(), file.name));
  }
  const PersonTrack& body = people->chosen[own];

  IngestedClip ingested;
  ingested.findings = std::move(skeleton->findings);
  ingested.findings.insert(ingested.findings.end(), people->findings.begin(), people->findings.end());
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  const int frames = static_cast<int>(skeleton->frames.size());
  JointTracks tracks;
  tracks.names = NtuJointNames();
  tracks.positions = JointPositions(frames, kNtuJoints);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * kNtuJoints, 0.0);
  for (int f = 0; f < frames; ++f) tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
  bool seen = false;
  for (std::size_t row = 0; row < body.frames.size(); ++row) {
    for (int j = 0; j < kNtuJoints; ++j) {
      if (!body.sees(row, j)) continue;
      seen = true;
      const int f = body.frames[row];
      const double confidence = body.confidence[row * kNtuJoints + static_cast<std::size_t>(j)];
      tracks.confidence[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] = confidence;
      tracks.positions.at(f, j) = body.positions.at(static_cast<int>(row), j);
    }
  }
  if (!seen) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(frames, "frame"), file.name,
                "the tracker lost the person: leave the file out", Reason::kNobodySeen);
  }
  NoteInferredJoints(*skeleton, body, ingested.findings);
  NoteZeroJoints(*skeleton, body, ingested.findings);
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.provenance["body_id"] = body.Name();
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
