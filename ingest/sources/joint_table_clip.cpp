#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/joint_layout.h"
#include "core/quality/tracked_points.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

bool IsMissing(const Vector3d& raw, MissingValue missing) {
  if (!raw.allFinite()) return true;
  return missing == MissingValue::kZero && raw.isZero(0.0);
}

constexpr double kNoRotation = 1e-2;  ///< departure of a written rotation's product with itself from the identity

/// The rotations that the file records, of points that it records one for. What is marked as sure and is no rotation is
/// taken for missing, with a finding.
void TakeRotations(const JointRows& rows, const SourceFrame& frame, JointTracks& tracks,
                   std::vector<Finding>& findings) {
  if (rows.rotation.empty()) return;
  tracks.rotation.assign(tracks.confidence.size(), Quaterniond::Identity());
  tracks.rotation_confidence.assign(tracks.confidence.size(), 0.0);
  const Matrix3d turn = frame.world_from_file;
  int malformed = 0;
  int first = 0;
  for (std::size_t at = 0; at < tracks.confidence.size(); ++at) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> written(rows.rotation.data() + 9 * at);
    const double confidence = rows.rotation_confidence.empty() ? 1.0 : rows.rotation_confidence[at];
    if (!(confidence > 0.0) || written.isZero(0.0)) continue;
    const bool rotation = written.allFinite() && written.determinant() > 0.0 &&
                          (written.transpose() * written - Matrix3d::Identity()).cwiseAbs().maxCoeff() < kNoRotation;
    if (!rotation) {
      if (malformed++ == 0) first = static_cast<int>(at) / rows.joints;
      continue;
    }
    // A mirrored file mirrors the points' own frames too: which way these lie is the source's convention.
    tracks.rotation[at] = Quaterniond(Matrix3d(turn * written * turn.transpose())).normalized();
    tracks.rotation_confidence[at] = std::min(confidence, 1.0);
  }
  if (malformed == 0) return;
  findings.push_back(FrameFinding(
      "not_a_rotation", first, first + 1, "", malformed,
      Counted(malformed, "recorded rotation") + " marked as sure: the matrix is not orthogonal; taken for missing"));
}

/// How far the distances between joints that follow each other in the file are from those of the first frames: median
/// over the pairs of the relative difference. 0 where too few are seen.
class RowOrder {
 public:
  explicit RowOrder(const JointTracks& tracks) : tracks_(tracks) {
    for (int k = 0; k + 1 < tracks.positions.joints; ++k) {
      std::vector<double> distances;
      for (int f = 0; f < tracks.positions.frames && distances.size() < kFirstFrames; ++f) {
        if (Seen(f, k)) distances.push_back(Distance(f, k));
      }
      usual_.push_back(distances.empty() ? 0.0 : Middle(distances));
    }
  }
  double Departure(int frame) const {
    std::vector<double> departures;
    for (int k = 0; k + 1 < tracks_.positions.joints; ++k) {
      if (usual_[static_cast<std::size_t>(k)] <= 0.0 || !Seen(frame, k)) continue;
      const double usual = usual_[static_cast<std::size_t>(k)];
      departures.push_back(std::abs(Distance(frame, k) - usual) / usual);
    }
    return departures.size() < 4 ? 0.0 : Middle(departures);
  }

 private:
  static constexpr std::size_t kFirstFrames = 15;
  static double Middle(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }
  bool Seen(int f, int k) const {
    const std::size_t at = static_cast<std::size_t>(f) * tracks_.positions.joints + k;
    return tracks_.confidence[at] > 0.0 && tracks_.confidence[at + 1] > 0.0;
  }
  double Distance(int f, int k) const { return (tracks_.positions.at(f, k + 1) - tracks_.positions.at(f, k)).norm(); }

  const JointTracks& tracks_;
  std::vector<double> usual_;
};

/// Where rows are left over at the end of a table, one may lack anywhere: from there on every row is another joint's.
/// Such frames are taken for missing, with a finding, together with the one before them, in which the row lacks.
void DropShiftedFrames(JointTracks& tracks, std::vector<Finding>& findings) {
  constexpr double kOtherJoints = 0.25;  // people change these distances by less, in the median of the joints
  const int frames = tracks.positions.frames;
  const RowOrder order(tracks);
  int first = frames;
  while (first > 0 && order.Departure(first - 1) > kOtherJoints) --first;
  if (first == frames) return;
  first = std::max(0, first - 1);
  const auto begin = tracks.confidence.begin() + static_cast<std::ptrdiff_t>(first) * tracks.positions.joints;
  std::fill(begin, tracks.confidence.end(), 0.0);
  if (!tracks.rotation_confidence.empty()) {
    std::fill(tracks.rotation_confidence.begin() + (begin - tracks.confidence.begin()),
              tracks.rotation_confidence.end(), 0.0);
  }
  for (int f = first; f < frames; ++f) {
    for (int j = 0; j < tracks.positions.joints; ++j) tracks.positions.at(f, j).setZero();
  }
  findings.push_back(FrameFinding("rows_shifted", first, frames, "", frames - first,
                                  "a row is missing here: those that follow are other joints' (distances between "
                                  "joints say so); the frames are taken for missing"));
}

}  // namespace

Expected<IngestedClip> ReadJointTableClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  const Expected<JointLayout> layout = TableLayout(source);
  if (!layout) return Forward(layout);
  JointTableLayout table;
  table.rows_per_frame = RowsPerFrame(source);
  table.allow_nan = source.missing == MissingValue::kNan;
  table.damaged_rows = source.damaged_rows;
  table.end_word = source.end_word;
  Expected<JointRows> rows = ParseJointRows(file.bytes, *layout, table, file.name);
  if (!rows) return Forward(rows);

  IngestedClip ingested;
  ingested.findings = std::move(rows->findings);
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  JointTracks tracks;
  tracks.names = source.joints;
  tracks.positions = JointPositions(rows->frames, rows->joints);
  tracks.confidence.assign(static_cast<std::size_t>(rows->frames) * rows->joints, 0.0);
  std::size_t zeros = 0;
  for (int f = 0; f < rows->frames; ++f) {
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < rows->joints; ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * rows->joints + j;
      const Vector3d raw(rows->position[at * 3], rows->position[at * 3 + 1], rows->position[at * 3 + 2]);
      double confidence = rows->confidence.empty() ? 1.0 : rows->confidence[at];
      if (confidence < 0.0 || confidence > 1.0) {
        return Fail(ErrorCode::kInconsistent,
                    "confidence " + FormatDouble(confidence) + " of joint '" +
                        source.joints[static_cast<std::size_t>(j)] + "' in frame " + std::to_string(f) +
                        " is not in 0..1",
                    file.name, "write `skip` for that column, or bring it to 0..1 first");
      }
      confidence = std::max(confidence, source.least_confidence);
      if (std::isnan(confidence) || IsMissing(raw, source.missing)) confidence = 0.0;
      tracks.confidence[at] = confidence;
      zeros += confidence > 0.0 && raw.isZero(0.0) ? 1 : 0;
      if (confidence > 0.0) tracks.positions.at(f, j) = frame->metres_from_file * raw;
    }
  }
  TakeRotations(*rows, *frame, tracks, ingested.findings);
  if (zeros == tracks.confidence.size()) {
    return Fail(ErrorCode::kInconsistent, "every joint of every frame is 0 0 0", file.name,
                "the tracker never saw the person: leave the file out");
  }
  const bool any = std::any_of(tracks.confidence.begin(), tracks.confidence.end(), [](double c) { return c > 0.0; });
  if (!any) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(rows->frames, "frame"), file.name,
                "the tracker lost the person: leave the file out");
  }
  const bool left_over = std::any_of(ingested.findings.begin(), ingested.findings.end(),
                                     [](const Finding& finding) { return finding.code == "cut_off"; });
  if (left_over && table.rows_per_frame > 1) DropShiftedFrames(tracks, ingested.findings);
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
