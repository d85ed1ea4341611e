#include "core/formats/trc.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/row_counter.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {
namespace {

/// DataRate, unless the times of the rows tell another.
void TakeRate(const TrcFile& trc, const RowPlaces& by_time, const std::string& name, RawClip& clip) {
  const double clock = by_time.step > 0.0 ? 1.0 / by_time.step : 0.0;
  const double hz = trc.rate_hz > 0.0 ? trc.rate_hz : std::round(1000.0 * clock) / 1000.0;
  if (hz <= 0.0) return;
  clip.rate_hz = hz;
  clip.rate_evidence = trc.rate_hz > 0.0 ? "DataRate" : "column Time";
  clip.rate_finding = CheckStatedRate(hz, RateUnit::kFramesPerSecond, name + ": " + clip.rate_evidence);
  constexpr double kSame = 0.02;  // times of three digits
  if (trc.rate_hz > 0.0 && clock > 0.0 && std::abs(clock / hz - 1.0) > kSame) {
    clip.rate_finding = MakeFinding(
        "rate_contradiction", Severity::kError, clock,
        "DataRate is " + RoundedText(hz, 6) + " Hz, the steps of column Time are of " + RoundedText(clock, 6) + " Hz");
  }
}

Expected<RawFile> TrcIn(const FileBytes& file) {
  Expected<TrcFile> trc = ParseTrc(file.bytes, file.name, file.damaged_rows);
  if (!trc) return Forward(trc);
  const std::vector<double> numbers(trc->frame_number.begin(), trc->frame_number.end());
  Expected<RowPlaces> places = PlacesByNumber(numbers, 1.0, file.name);
  if (!places) return Forward(places);
  const bool timed = std::none_of(trc->time_s.begin(), trc->time_s.end(), [](double t) { return std::isnan(t); });
  const Expected<RowPlaces> by_time = timed ? PlacesByClock(trc->time_s, file.name) : RowPlaces();
  if (!by_time) return Forward(by_time);
  RawClip clip;
  clip.format = "trc";
  clip.frames = places->frames();
  clip.joints = static_cast<int>(trc->names.size());
  clip.layout_evidence = Counted(clip.joints, "marker") + " in " + Counted(trc->rows(), "row");
  clip.skeleton.evidence = "points with names; the file has no skeleton";
  clip.units = UnitIn(trc->units);
  TakeRate(*trc, *by_time, file.name, clip);
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(static_cast<std::size_t>(clip.frames) * trc->names.size(), 0.0);
  for (std::size_t row = 0; row < trc->frame_number.size(); ++row) {
    for (int m = 0; m < clip.joints; ++m) {
      const Eigen::Map<const Vector3d> point(&trc->values[3 * (row * trc->names.size() + static_cast<std::size_t>(m))]);
      if (!point.allFinite()) continue;
      clip.positions.at(places->place[row], m) = point;
      clip.confidence[static_cast<std::size_t>(places->place[row]) * trc->names.size() + static_cast<std::size_t>(m)] =
          1.0;
    }
  }
  clip.names = trc->names;
  FollowNames(clip);
  if (const int skipped = clip.frames - trc->rows(); skipped > 0) {
    clip.remarks.push_back(MakeFinding("time_gap", Severity::kWarning, skipped,
                                       Counted(skipped, "frame") + " of those that Frame# counts have no row"));
  }
  MoveFindings(*places, trc->findings);
  clip.AddRemarks(trc->findings);
  clip.facts.emplace_back("recorded_frames",
                          std::to_string(trc->frame_number.front()) + "-" + std::to_string(trc->frame_number.back()));
  return RawFile::Of(std::move(clip));
}

}  // namespace

FormatDriver TrcFormat() {
  FormatDriver d;
  d.name = "trc";
  d.kinds = {FileKind::kTrc};
  d.ending = ".trc";
  d.gives = EvidenceKind::kJointTracks;
  d.states_rate = true;
  d.options = {"markers"};
  d.check = CheckMarkers;
  d.open = TrcIn;
  d.to_clip = TracksAsOpened;
  return d;
}

}  // namespace mocurate
