#include <algorithm>
#include <cmath>

#include "core/motion/kinematics.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

/// A place between two frames: (1 - fraction) * frame + fraction * (frame + 1).
struct Place {
  int frame = 0;
  double fraction = 0.0;

  int nearer() const { return fraction > 0.5 ? frame + 1 : frame; }
};

/// Place of a frame number; within 1e-9 of a frame it is that frame exactly.
Place PlaceAt(double position, int frames) {
  const double snapped = std::round(position);
  if (std::abs(position - snapped) < 1e-9) position = snapped;
  position = std::clamp(position, 0.0, static_cast<double>(frames - 1));
  const int frame = static_cast<int>(std::floor(position));
  return {frame, position - frame};
}

/// Place of a time among increasing times.
Place PlaceInTime(const std::vector<double>& times, double time) {
  const auto above = std::upper_bound(times.begin(), times.end(), time + 1e-9);
  const int frame = std::max(0, static_cast<int>(above - times.begin()) - 1);
  if (above == times.end() || above == times.begin()) return {frame, 0.0};
  const double fraction = (time - times[frame]) / (times[frame + 1] - times[frame]);
  return {frame, std::clamp(fraction < 1e-6 ? 0.0 : fraction, 0.0, 1.0)};
}

template <class T>
std::vector<T> Nearer(const std::vector<T>& values, int frames, const std::vector<Place>& places) {
  std::vector<T> taken;
  if (values.empty() || frames == 0) return taken;
  const std::ptrdiff_t width = static_cast<std::ptrdiff_t>(values.size() / static_cast<std::size_t>(frames));
  for (const Place& place : places) {
    const auto row = values.begin() + place.nearer() * width;
    taken.insert(taken.end(), row, row + width);
  }
  return taken;
}

/// States of the nearer frames; a sample between two frames of which one is inferred is inferred.
std::vector<JointState> StatesAt(const Motion& motion, const std::vector<Place>& places) {
  std::vector<JointState> taken = Nearer(motion.state, motion.frame_count(), places);
  if (taken.empty()) return taken;
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  for (std::size_t f = 0; f < places.size(); ++f) {
    if (places[f].fraction == 0.0) continue;
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t before = static_cast<std::size_t>(places[f].frame) * joints + j;
      if (motion.state[before] == JointState::kInferred || motion.state[before + joints] == JointState::kInferred)
        taken[f * joints + j] = JointState::kInferred;
    }
  }
  return taken;
}

Vector3d Between(const Vector3d& a, const Vector3d& b, double fraction) { return a + fraction * (b - a); }

JointPositions PositionsAt(const JointPositions& positions, const std::vector<Place>& places) {
  JointPositions taken(static_cast<int>(places.size()), positions.joints);
  for (int f = 0; f < taken.frames; ++f) {
    const Place& place = places[f];
    for (int j = 0; j < taken.joints; ++j) {
      const Vector3d a = positions.at(place.frame, j);
      taken.at(f, j) = place.fraction == 0.0 ? a : Between(a, positions.at(place.frame + 1, j), place.fraction);
    }
  }
  return taken;
}

Motion MotionAt(const Motion& motion, const std::vector<Place>& places, FrameRate rate) {
  const int frames = motion.frame_count();
  Motion taken = motion;
  taken.rate = rate;
  taken.state = StatesAt(motion, places);
  taken.position_cov = Nearer(motion.position_cov, frames, places);
  taken.rotation_sigma = Nearer(motion.rotation_sigma, frames, places);
  taken.rotation_observed = Nearer(motion.rotation_observed, frames, places);
  taken.contact = Nearer(motion.contact, frames, places);
  taken.joints = PositionsAt(motion.joints, places);
  if (motion.joints_only()) return taken;
  taken.root_translation.clear();
  taken.rotation.clear();
  for (const Place& place : places) {
    const int next = std::min(place.frame + 1, frames - 1);
    taken.root_translation.push_back(
        Between(motion.root_translation[place.frame], motion.root_translation[next], place.fraction));
    for (int j = 0; j < motion.joint_count(); ++j) {
      const Quaterniond& a = motion.rotation_at(place.frame, j);
      taken.rotation.push_back(place.fraction == 0.0 ? a : Slerp(a, motion.rotation_at(next, j), place.fraction));
    }
  }
  for (int j = 0; j < motion.joint_count(); ++j) {
    MakeSignContinuous(taken.rotation.data() + j, places.size(), static_cast<std::size_t>(motion.joint_count()));
  }
  ComputeJoints(taken);
  return taken;
}

/// Replaces two times or more by the first, first + 1/rate, ... up to the last; the places of these among the old ones.
std::vector<Place> Retime(std::vector<double>& times, FrameRate rate) {
  std::vector<double> taken;
  std::vector<Place> places;
  const double span = (times.back() - times.front()) * rate.hz();
  const std::int64_t count = static_cast<std::int64_t>(std::floor(span + 1e-6)) + 1;
  for (std::int64_t k = 0; k < count; ++k) {
    taken.push_back(times.front() + rate.FrameTime(k));
    places.push_back(PlaceInTime(times, taken.back()));
  }
  times = std::move(taken);
  return places;
}

/// Between two recorded rotations the shortest rotation.
void ResampleRotations(JointTracks& tracks, const std::vector<Place>& places) {
  if (tracks.rotation.empty()) return;
  std::vector<Quaterniond> rotation;
  std::vector<double> confidence;
  const auto points = static_cast<std::size_t>(tracks.positions.joints);
  for (const Place& place : places) {
    const std::size_t first = static_cast<std::size_t>(place.frame) * points;
    const std::size_t next = place.fraction == 0.0 ? first : first + points;
    for (std::size_t k = 0; k < points; ++k) {
      const double a = tracks.rotation_confidence[first + k];
      const double b = tracks.rotation_confidence[next + k];
      const bool both = a > 0.0 && b > 0.0;
      confidence.push_back(both ? a + place.fraction * (b - a) : 0.0);
      rotation.push_back(both ? tracks.rotation[first + k].slerp(place.fraction, tracks.rotation[next + k])
                              : Quaterniond::Identity());
    }
  }
  tracks.rotation = std::move(rotation);
  tracks.rotation_confidence = std::move(confidence);
}

void ResampleTracks(JointTracks& tracks, FrameRate rate) {
  if (tracks.time_s.size() < 2) return;
  const std::vector<Place> places = Retime(tracks.time_s, rate);
  const int points = tracks.positions.joints;
  std::vector<double> confidence;
  for (const Place& place : places) {
    const int next = place.fraction == 0.0 ? place.frame : place.frame + 1;
    for (int k = 0; k < points; ++k) {
      const double a = tracks.confidence[static_cast<std::size_t>(place.frame) * points + k];
      const double b = tracks.confidence[static_cast<std::size_t>(next) * points + k];
      confidence.push_back(a > 0.0 && b > 0.0 ? a + place.fraction * (b - a) : 0.0);
    }
  }
  ResampleRotations(tracks, places);
  tracks.positions = PositionsAt(tracks.positions, places);
  for (int f = 0; f < tracks.positions.frames; ++f) {
    for (int k = 0; k < points; ++k) {
      if (confidence[static_cast<std::size_t>(f) * points + k] == 0.0) tracks.positions.at(f, k).setZero();
    }
  }
  tracks.confidence = std::move(confidence);
}

void ResampleView(DepthView& view, FrameRate rate) {
  if (view.time_s.size() < 2) return;
  const std::vector<Place> places = Retime(view.time_s, rate);
  const int frames = static_cast<int>(view.files.size());
  view.files = Nearer(view.files, frames, places);
  view.sha256 = Nearer(view.sha256, frames, places);
  view.masks = Nearer(view.masks, frames, places);
  view.mask_sha256 = Nearer(view.mask_sha256, frames, places);
}

void ResampleClouds(CloudFiles& clouds, FrameRate rate) {
  if (clouds.time_s.size() < 2) return;
  const std::vector<Place> places = Retime(clouds.time_s, rate);
  const int frames = static_cast<int>(clouds.files.size());
  clouds.files = Nearer(clouds.files, frames, places);
  clouds.sha256 = Nearer(clouds.sha256, frames, places);
}

/// People are not tracked from image to image: the nearest image is taken unchanged.
void ResampleKeypoints(KeypointView& view, FrameRate rate) {
  if (view.time_s.size() < 2) return;
  const int frames = view.frames();
  view.values = Nearer(view.values, frames, Retime(view.time_s, rate));
}

}  // namespace

Clip Resample(const Clip& clip, FrameRate rate) {
  Clip resampled = clip;
  resampled.rate = rate;
  const FrameRate recorded = RecordedRate(clip);
  if (!(recorded == rate)) resampled.provenance[kRecordedRate] = recorded.Text();
  const bool same_clip_rate = clip.rate == rate;
  if (clip.motion && !(clip.motion->rate == rate) && clip.motion->frame_count() > 0) {
    const Motion& motion = *clip.motion;
    const double step = motion.rate.hz() / rate.hz();  // old frames per new frame
    const double last = static_cast<double>(motion.frame_count() - 1);
    std::vector<Place> places;
    const std::int64_t count = static_cast<std::int64_t>(std::floor(last / step + 1e-9)) + 1;
    for (std::int64_t k = 0; k < count; ++k)
      places.push_back(PlaceAt(static_cast<double>(k) * step, motion.frame_count()));
    resampled.motion = MotionAt(motion, places, rate);
  }
  if (same_clip_rate) return resampled;
  if (resampled.evidence.tracks) ResampleTracks(*resampled.evidence.tracks, rate);
  for (DepthView& view : resampled.evidence.depth_views) ResampleView(view, rate);
  if (resampled.evidence.clouds) ResampleClouds(*resampled.evidence.clouds, rate);
  for (KeypointView& view : resampled.evidence.keypoint_views) ResampleKeypoints(view, rate);
  return resampled;
}

Motion ResampleToCount(const Motion& motion, int frame_count) {
  const int frames = motion.frame_count();
  if (frame_count == frames || frames == 0) return motion;
  std::vector<Place> places;
  for (int k = 0; k < frame_count; ++k) {
    places.push_back(PlaceAt(static_cast<double>(k) * (frames - 1) / std::max(1, frame_count - 1), frames));
  }
  const double seconds = motion.rate.FrameTime(frames - 1);
  const FrameRate rate = seconds > 0.0 ? FrameRate::FromHz((frame_count - 1) / seconds) : motion.rate;
  return MotionAt(motion, places, rate);
}

}  // namespace mocurate
