#include "core/motion/operations.h"

#include <algorithm>
#include <cmath>

#include "core/motion/gaps.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

template <class T>
void KeepRows(std::vector<T>& values, int rows, int begin, int end) {
  if (values.empty() || rows == 0) return;
  const std::ptrdiff_t width = static_cast<std::ptrdiff_t>(values.size() / static_cast<std::size_t>(rows));
  values = std::vector<T>(values.begin() + begin * width, values.begin() + end * width);
}

void KeepFrames(JointPositions& positions, int begin, int end) {
  KeepRows(positions.xyz, positions.frames, begin, end);
  positions.frames = end - begin;
}

void KeepFrames(Motion& motion, int begin, int end) {
  const int frames = motion.frame_count();
  KeepFrames(motion.joints, begin, end);
  KeepRows(motion.root_translation, frames, begin, end);
  KeepRows(motion.rotation, frames, begin, end);
  KeepRows(motion.state, frames, begin, end);
  KeepRows(motion.position_cov, frames, begin, end);
  KeepRows(motion.rotation_sigma, frames, begin, end);
  KeepRows(motion.rotation_observed, frames, begin, end);
  KeepRows(motion.contact, frames, begin, end);
}

struct Span {
  int begin_frame = 0;  ///< frames of the clip
  int end_frame = 0;
  int frames = 0;        ///< of the whole clip
  double zero_s = 0.0;   ///< when the clip's first frame is, by the clock that its evidence shares
  double begin_s = 0.0;  ///< from there
  double end_s = 0.0;
};

/// Rows of a part of the evidence: the same frames if it has as many as the clip, else those whose time lies in the
/// span (half a microsecond of tolerance: frame times computed in another way fall on the same side).
FrameRun RowsOf(const Span& span, const std::vector<double>& times) {
  if (static_cast<int>(times.size()) == span.frames) return {span.begin_frame, span.end_frame};
  const double slack = 5e-7;
  const auto first = std::lower_bound(times.begin(), times.end(), span.zero_s + span.begin_s - slack);
  const auto last = std::lower_bound(first, times.end(), span.zero_s + span.end_s - slack);
  return {static_cast<int>(first - times.begin()), static_cast<int>(last - times.begin())};
}

/// Times from the start of the span, the same for every part: simultaneous samples stay simultaneous.
void CutTimes(std::vector<double>& times, FrameRun rows, const Span& span) {
  const double zero = span.zero_s + span.begin_s;
  KeepRows(times, static_cast<int>(times.size()), rows.begin, rows.end);
  for (double& time : times) time -= zero;
}

void CutTracks(JointTracks& tracks, const Span& span) {
  if (tracks.time_s.empty()) return;
  const FrameRun rows = RowsOf(span, tracks.time_s);
  KeepRows(tracks.confidence, tracks.positions.frames, rows.begin, rows.end);
  KeepRows(tracks.rotation, tracks.positions.frames, rows.begin, rows.end);
  KeepRows(tracks.rotation_confidence, tracks.positions.frames, rows.begin, rows.end);
  KeepFrames(tracks.positions, rows.begin, rows.end);
  CutTimes(tracks.time_s, rows, span);
}

void CutView(DepthView& view, const Span& span) {
  if (view.time_s.empty()) return;
  const FrameRun rows = RowsOf(span, view.time_s);
  KeepRows(view.sha256, static_cast<int>(view.files.size()), rows.begin, rows.end);
  KeepRows(view.masks, static_cast<int>(view.files.size()), rows.begin, rows.end);
  KeepRows(view.mask_sha256, static_cast<int>(view.files.size()), rows.begin, rows.end);
  KeepRows(view.files, static_cast<int>(view.files.size()), rows.begin, rows.end);
  CutTimes(view.time_s, rows, span);
}

void CutClouds(CloudFiles& clouds, const Span& span) {
  if (clouds.time_s.empty()) return;
  const FrameRun rows = RowsOf(span, clouds.time_s);
  KeepRows(clouds.sha256, static_cast<int>(clouds.files.size()), rows.begin, rows.end);
  KeepRows(clouds.files, static_cast<int>(clouds.files.size()), rows.begin, rows.end);
  CutTimes(clouds.time_s, rows, span);
}

void CutKeypoints(KeypointView& view, const Span& span) {
  if (view.time_s.empty()) return;
  const FrameRun rows = RowsOf(span, view.time_s);
  KeepRows(view.values, view.frames(), rows.begin, rows.end);
  CutTimes(view.time_s, rows, span);
}

std::vector<Segment> CutSegments(const std::vector<Segment>& segments, double begin_s, double end_s) {
  std::vector<Segment> kept;
  for (Segment segment : segments) {
    segment.begin_s = std::max(segment.begin_s, begin_s) - begin_s;
    segment.end_s = std::min(segment.end_s, end_s) - begin_s;
    if (segment.end_s - segment.begin_s > 1e-9) kept.push_back(segment);
  }
  return kept;
}

/// The identity counts frames of the recording, which may have another rate than the clip. Where that is not known, its
/// frames are those of the clip's length.
void CutIdentity(const Span& span, Clip& clip) {
  ClipIdentity& identity = clip.identity;
  const int recorded = identity.end_frame - identity.begin_frame;
  double scale = recorded > 0 ? static_cast<double>(recorded) / span.frames : 1.0;
  if (clip.motion && clip.provenance.count(kRecordedRate) > 0) scale = RecordedRate(clip).hz() / clip.motion->rate.hz();
  const int begin = identity.begin_frame;
  identity.begin_frame = begin + static_cast<int>(std::lround(scale * span.begin_frame));
  const int end = begin + static_cast<int>(std::lround(scale * span.end_frame));
  identity.end_frame = recorded > 0 ? std::min(end, identity.end_frame) : end;
}

/// Time of frame `frame` (may be one past the last) from the first frame, of the motion or of that evidence.
double TimeOf(const Clip& clip, int frame) {
  if (clip.motion) return clip.motion->rate.FrameTime(frame);
  const std::vector<double>& times = EvidenceTimes(clip.evidence);
  if (frame < static_cast<int>(times.size())) return times[static_cast<std::size_t>(frame)] - times.front();
  return times.back() - times.front() + clip.rate.FrameTime(1);
}

Vector3d Rotated(const Matrix3d& rotation, const Eigen::Map<Vector3d>& vector) { return rotation * Vector3d(vector); }

void TransformPositions(const RigidTransform& transform, JointPositions& positions) {
  const Matrix3d rotation = transform.rotation.toRotationMatrix();
  for (int f = 0; f < positions.frames; ++f) {
    for (int j = 0; j < positions.joints; ++j) {
      positions.at(f, j) = Rotated(rotation, positions.at(f, j)) + transform.translation;
    }
  }
}

}  // namespace

Expected<Clip> Cut(const Clip& clip, int begin_frame, int end_frame) {
  const int frames = FrameCount(clip);
  if (begin_frame < 0 || end_frame > frames || begin_frame >= end_frame) {
    return Fail(ErrorCode::kUsage,
                "frames [" + std::to_string(begin_frame) + ", " + std::to_string(end_frame) + ") of a clip with " +
                    std::to_string(frames) + " frames",
                clip.id(), "the span must not be empty and must lie inside the clip");
  }
  const std::vector<double>& times = EvidenceTimes(clip.evidence);
  const double zero_s = times.empty() ? 0.0 : times.front();
  const Span span{begin_frame, end_frame, frames, zero_s, TimeOf(clip, begin_frame), TimeOf(clip, end_frame)};
  Clip cut = clip;
  if (cut.motion) KeepFrames(*cut.motion, begin_frame, end_frame);
  if (cut.evidence.tracks) CutTracks(*cut.evidence.tracks, span);
  for (DepthView& view : cut.evidence.depth_views) CutView(view, span);
  if (cut.evidence.clouds) CutClouds(*cut.evidence.clouds, span);
  for (KeypointView& view : cut.evidence.keypoint_views) CutKeypoints(view, span);
  cut.segments = CutSegments(clip.segments, span.begin_s, span.end_s);
  CutIdentity(span, cut);
  return cut;
}

Expected<std::optional<Clip>> WithoutInferred(const Clip& clip) {
  if (!clip.motion || clip.motion->state.empty()) return std::optional<Clip>();
  const FrameRun run = LongestRunWithoutInferred(*clip.motion);
  if (run.frames() == clip.motion->frame_count()) return std::optional<Clip>();
  if (run.frames() == 0) {
    return Fail(ErrorCode::kInconsistent, "every frame of the clip is inferred", clip.id(),
                "leave the clip out: mocurate dataset subset");
  }
  Expected<Clip> cut = Cut(clip, run.begin, run.end);
  if (!cut) return Forward(cut);
  return std::optional<Clip>(*std::move(cut));
}

void RotateCovariances(const Matrix3d& map, std::vector<float>& covariances) {
  for (std::size_t i = 0; i + 5 < covariances.size(); i += 6) {
    float* c = covariances.data() + i;
    ToSixNumbers(map * FromSixNumbers(c) * map.transpose(), c);
  }
}

void Transform(const RigidTransform& transform, Motion& motion) {
  TransformPositions(transform, motion.joints);
  RotateCovariances(transform.rotation.toRotationMatrix(), motion.position_cov);
  if (motion.joints_only()) return;
  const int joints = motion.joint_count();
  for (int f = 0; f < motion.frame_count(); ++f) {
    motion.root_translation[f] = transform * motion.root_translation[f];
    motion.rotation_at(f, 0) = (transform.rotation * motion.rotation_at(f, 0)).normalized();
  }
  MakeSignContinuous(motion.rotation.data(), static_cast<std::size_t>(motion.frame_count()),
                     static_cast<std::size_t>(joints));
  ComputeJoints(motion);
}

void Transform(const RigidTransform& world_from_clip, Clip& clip) {
  if (clip.motion) Transform(world_from_clip, *clip.motion);
  if (clip.evidence.tracks) {
    TransformPositions(world_from_clip, clip.evidence.tracks->positions);
    for (Quaterniond& rotation : clip.evidence.tracks->rotation) rotation = world_from_clip.rotation * rotation;
  }
  const RigidTransform clip_from_world = Inverse(world_from_clip);
  for (DepthView& view : clip.evidence.depth_views) {
    view.camera.camera_from_world = view.camera.camera_from_world * clip_from_world;
  }
  for (KeypointView& view : clip.evidence.keypoint_views) {
    view.camera.camera_from_world = view.camera.camera_from_world * clip_from_world;
  }
  if (clip.evidence.clouds)
    clip.evidence.clouds->world_from_file = world_from_clip * clip.evidence.clouds->world_from_file;
  clip.canonical_from_source = world_from_clip * clip.canonical_from_source;
}

}  // namespace mocurate
