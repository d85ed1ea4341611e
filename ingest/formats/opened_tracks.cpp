#include <algorithm>
#include <limits>
#include <set>

#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {

std::string UnitIn(std::string_view word) {
  constexpr std::pair<const char*, const char*> kWords[] = {
      {"mm", "mm"},   {"millimeters", "mm"}, {"millimetres", "mm"}, {"millimeter", "mm"}, {"cm", "cm"},
      {"m", "m"},     {"meters", "m"},       {"metres", "m"},       {"meter", "m"},       {"centimeters", "cm"},
      {"in", "inch"}, {"inch", "inch"},      {"inches", "inch"},    {"metre", "m"},       {"centimetres", "cm"}};
  for (const auto& [known, unit] : kWords) {
    if (SameWord(Trim(word), known)) return unit;
  }
  return "";
}

void FollowNames(RawClip& clip) {
  std::string found;
  int least = std::numeric_limits<int>::max();
  for (const std::string& candidate : SkeletonNames()) {
    const auto skeleton = KnownSkeleton(candidate);
    if (!skeleton || (*skeleton)->joint_count() > least) continue;  // of equals smpl24, not humanact12
    std::set<int> joints;
    for (const std::string& name : clip.names) joints.insert((*skeleton)->FindJoint(name).value_or(-1));
    if (joints.count(-1) > 0 || joints.size() != clip.names.size()) continue;
    found = candidate;
    least = (*skeleton)->joint_count();
  }
  if (found.empty())
    clip.points = PointsOfBody(clip.names, nullptr);
  else
    FollowFormat(found, clip.names, "all points are joints of it", clip);
}

Status CheckMarkers(const SourceOptions& source) {
  for (std::size_t i = 0; i < source.markers.size(); ++i) {
    const MarkerPlace& marker = source.markers[i];
    const std::string where = "ingest.source.markers[" + std::to_string(i) + "]";
    if (marker.point.empty() || marker.joint.empty() || marker.offset.size() != 3)
      return Fail(ErrorCode::kConfig, "a marker has a point, a joint and an offset of three numbers", where,
                  "e.g. {point: LKNE, joint: left_knee, offset: [0.055, 0, 0], spread: 0.012}");
    for (std::size_t k = 0; k < i; ++k) {
      if (source.markers[k].point != marker.point) continue;
      return Fail(ErrorCode::kConfig, "the marker '" + marker.point + "' is listed twice", where, "remove one");
    }
  }
  return {};
}

Expected<IngestedClip> TracksAsOpened(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<RawFile> opened =
      DriverOf(source.format).open({file.bytes, file.name, file.container, source.damaged_rows});
  if (!opened) return Forward(opened);
  if (opened->clips.empty() || opened->clips.front().positions.empty())
    return Fail(ErrorCode::kInconsistent, "the file has no joints", file.name, "", Reason::kNoValidSamples);
  if (opened->clips.size() > 1) {
    return Fail(ErrorCode::kUnsupported,
                "the file has points of " + std::to_string(opened->clips.size()) + " subjects: " + opened->clips[0].id +
                    ", " + opened->clips[1].id + (opened->clips.size() > 2 ? ", ..." : ""),
                file.name, "export each subject as a file of its own");
  }
  const RawClip& raw = opened->clips.front();
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<double> metres = MetresPerUnit(source.units.empty() ? raw.units : source.units);
  if (!metres) return Forward(metres);
  IngestedClip ingested;
  ingested.findings = raw.remarks;
  if (const Expected<double> stated = MetresPerUnit(raw.units); !raw.units.empty() && stated && *stated != *metres) {
    ingested.findings.push_back(Contradiction(source, "units_contradiction", *stated / *metres,
                                              "the file states " + raw.units + ", the source " + source.units));
  }
  ingested.clip.rate =
      raw.rate_hz ? RateOfFile(source, *raw.rate_hz, ingested, raw.rate_finding) : FrameRate::FromHz(*source.rate_hz);
  JointTracks tracks;
  tracks.names = raw.names;
  tracks.positions = JointPositions(raw.frames, raw.joints);
  tracks.confidence = raw.confidence;
  if (tracks.confidence.empty()) tracks.confidence.assign(raw.positions.xyz.size() / 3, 1.0);
  for (int f = 0; f < raw.frames; ++f) {
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < raw.joints; ++j) {
      if (tracks.confidence[static_cast<std::size_t>(f) * raw.joints + j] > 0.0)
        tracks.positions.at(f, j) = *metres * (axes->canonical_from_source * Vector3d(raw.positions.at(f, j)));
    }
  }
  if (std::count(tracks.confidence.begin(), tracks.confidence.end(), 0.0) ==
      static_cast<std::ptrdiff_t>(tracks.confidence.size())) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(raw.frames, "frame"), file.name,
                "the tracker lost the person: remove the file", Reason::kNoValidSamples);
  }
  NoteEmptyFrames(tracks, ingested.findings);
  for (const auto& [key, text] : raw.facts) ingested.clip.provenance[key] = text;
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
