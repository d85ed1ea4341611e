#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/median.h"
#include "core/formats/panoptic_bodies.h"
#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/frame_files.h"

namespace mocurate {
namespace {

constexpr double kLeastConfidence = 1e-6;  // of a joint that is there: files state a confidence of 0 for some

/// The ids in the files, the longest present first.
std::vector<int> RankedIds(const std::vector<PanopticBodies>& frames) {
  std::map<int, int> presence;
  for (const PanopticBodies& frame : frames) {
    std::set<int> ids;
    for (const PanopticBody& body : frame.bodies) {
      if (ids.insert(body.id).second) ++presence[body.id];
    }
  }
  std::vector<int> ids;
  for (const auto& [id, count] : presence) ids.push_back(id);
  std::stable_sort(ids.begin(), ids.end(), [&](int a, int b) { return presence.at(a) > presence.at(b); });
  return ids;
}

/// CMU Panoptic body3DScene files, one per frame -> evidence tracks of one of the people, the longest present first.
Expected<IngestedClip> ReadPanopticClip(const SourceFile& file) {
  const Expected<AxisConvention> axes = AxisConvention::Parse(file.source.axes);
  if (!axes) return Forward(axes);
  auto cameras = SortByCamera(file.source.files, "ingest.source.files", file.frame_files);
  if (!cameras) return Forward(cameras);
  const Expected<FrameSpan> span = MatchViews(file, *cameras);
  if (!span) return Forward(span);
  IngestedClip ingested;
  std::vector<PanopticBodies> frames(static_cast<std::size_t>(span->frames));
  const auto take = [&](int f, const std::string& bytes, const std::string& name) -> Status {
    Expected<PanopticBodies> frame = ParsePanopticBodies(bytes, name);
    if (!frame) return Forward(frame);
    frames[static_cast<std::size_t>(f)] = std::move(*frame);
    return {};
  };
  ReadFrameFiles("", cameras->begin()->second, *span, take, ingested);
  const std::vector<int> ids = RankedIds(frames);
  if (file.named.body > static_cast<int>(ids.size())) {
    return Fail(ErrorCode::kInconsistent,
                "person " + std::to_string(file.named.body) + " is asked for, the files hold " +
                    std::to_string(ids.size()) + " bodies",
                file.name, "correct ingest.source.subjects");
  }
  if (static_cast<int>(ids.size()) > file.named.bodies) {
    ingested.findings.push_back(CameraFinding("bodies_skipped", static_cast<double>(ids.size()),
                                              "the files hold " + std::to_string(ids.size()) + " bodies, " +
                                                  std::to_string(file.named.bodies) + " are asked for" +
                                                  "; the longest present are used",
                                              FindingAction::kKept));
  }
  const int id = ids[static_cast<std::size_t>(file.named.body - 1)];
  std::size_t joints = 0;
  for (const PanopticBodies& frame : frames) {
    for (const PanopticBody& body : frame.bodies) joints = std::max(joints, body.position_cm.size());
  }
  JointTracks tracks;
  const auto& names = PanopticJointNames();
  tracks.names.assign(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(joints));
  tracks.positions = JointPositions(span->frames, static_cast<int>(joints));
  tracks.confidence.assign(static_cast<std::size_t>(span->frames) * joints, 0.0);
  Clip& clip = ingested.clip;
  clip.rate = FrameRate::FromHz(*file.source.rate_hz);
  for (int f = 0; f < span->frames; ++f) {
    tracks.time_s.push_back(clip.rate.FrameTime(f));
    for (const PanopticBody& body : frames[static_cast<std::size_t>(f)].bodies) {
      for (std::size_t j = 0; body.id == id && j < body.position_cm.size(); ++j) {
        if (body.confidence[j] < 0.0) continue;
        tracks.positions.at(f, static_cast<int>(j)) = 0.01 * (axes->canonical_from_source * body.position_cm[j]);
        tracks.confidence[static_cast<std::size_t>(f) * joints + j] =
            std::clamp(body.confidence[j], kLeastConfidence, 1.0);
      }
    }
  }
  if (const double hz = RateByClock(frames); hz > 0.0) RateOfFile(file.source, hz, ingested);
  NoteEmptyFrames(tracks, ingested.findings);
  clip.evidence.tracks = std::move(tracks);
  clip.provenance["body_id"] = std::to_string(id);
  return ingested;
}

void ProposePanoptic(const Proposal& proposal, DeclarationWriter& writer) {
  WriteFrames(FirstFiles(proposal, ".json"), false, writer);
  WritePersonAndLabel(true, writer);
  const int most = proposal.source.Ask(&InspectedClip::people).value.value_or(1);
  writer.Value("subjects", std::to_string(std::max(1, most)), "measured: most bodies in a file");
  WriteUnits(proposal, writer);
  WriteAxes(proposal, writer);
  WriteRate(proposal, writer);
}

}  // namespace

double RateByClock(const std::vector<PanopticBodies>& scenes) {
  std::vector<double> steps_ms;
  double last_ms = 0.0;
  for (const PanopticBodies& scene : scenes) {
    if (scene.time_ms <= 0.0) continue;
    if (last_ms > 0.0 && scene.time_ms > last_ms) steps_ms.push_back(scene.time_ms - last_ms);
    last_ms = scene.time_ms;
  }
  if (steps_ms.empty()) return 0.0;
  const double usual_ms = Median(steps_ms);
  double moments = 0.0, span_ms = 0.0;
  for (const double step : steps_ms) {
    moments += std::round(step / usual_ms);
    span_ms += step;
  }
  return 1000.0 * moments / span_ms;
}

FormatDriver PanopticFormat() {
  FormatDriver d;
  d.name = "panoptic";
  d.kinds = {FileKind::kPanopticBodies};
  d.inspected = "panoptic_bodies";
  d.gives = EvidenceKind::kJointTracks;
  d.unit = UnitOf::kCentimetres;
  d.grouped_by = {"frame"};
  d.check = CheckGrouped;
  d.options = {"subjects"};
  d.propose = ProposePanoptic;
  d.to_clip = ReadPanopticClip;
  return d;
}

}  // namespace mocurate
