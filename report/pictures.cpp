#include "report/painters.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "core/base/file.h"
#include "core/formats/png.h"

namespace mocurate {

cv::Point Sixteenths(const Vector2d& at) {
  return {static_cast<int>(std::lround(16.0 * at.x())), static_cast<int>(std::lround(16.0 * at.y()))};
}

Expected<cv::Mat> ReadDepth(const DepthView& view, int frame) {
  if (frame < 0 || frame >= static_cast<int>(view.files.size())) {
    return Fail(ErrorCode::kInconsistent, "the view has no frame " + std::to_string(frame), view.camera.name);
  }
  if (view.files[frame].empty()) return cv::Mat::zeros(view.camera.height, view.camera.width, CV_16UC1);
  const auto bytes = ReadFile(view.files[frame]);
  if (!bytes) return Forward(bytes);
  Expected<DepthImage> depth = DecodeDepthPng(*bytes, DisplayPath(view.files[frame]));
  if (!depth) return Forward(depth);
  if (depth->width != view.camera.width || depth->height != view.camera.height) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(depth->width) + " x " + std::to_string(depth->height) + " pixels, the camera has " +
                    std::to_string(view.camera.width) + " x " + std::to_string(view.camera.height),
                DisplayPath(view.files[frame]));
  }
  return cv::Mat(depth->height, depth->width, CV_16UC1, depth->values.data()).clone();
}

Expected<std::string> EncodePng(const cv::Mat& image) {
  try {
    std::vector<uchar> bytes;
    if (cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9}))
      return std::string(bytes.begin(), bytes.end());
  } catch (const cv::Exception&) {
    // Reported below.
  }
  return Fail(ErrorCode::kInternal, "a picture cannot be encoded as PNG");
}

Status CheckFrame(const Clip& fitted, int frame) {
  if (!fitted.motion || !fitted.motion->skeleton) {
    return Fail(ErrorCode::kInconsistent, "the clip has no motion to draw", fitted.id(), "fit it first");
  }
  const int frames = fitted.motion->frame_count();
  if (frame < 0 || frame >= frames) {
    return Fail(ErrorCode::kInconsistent, "frame " + std::to_string(frame) + " of a clip of " + std::to_string(frames),
                fitted.id());
  }
  return {};
}

Expected<std::vector<NearPoint>> PointsNear(const PosedBody& body, const DepthView& view, int frame, int step,
                                            double reach) {
  const auto depth = ReadDepth(view, frame);
  if (!depth) return Forward(depth);
  std::vector<NearPoint> points;
  const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
  for (int y = 0; y < depth->rows; y += step) {
    for (int x = 0; x < depth->cols; x += step) {
      const double metres = depth->at<std::uint16_t>(y, x) * view.metres_per_unit;
      if (metres <= 0.0) continue;
      const Vector3d world = world_from_camera * view.camera.Unproject(Vector2d(x, y), metres);
      const auto near = ClosestOnBody(body.capsules, body.points.data(), world);
      if (near && near->on_capsule.distance < reach) points.push_back({world, near->on_capsule.distance});
    }
  }
  return points;
}

FrontPainter::FrontPainter(const Clip& fitted, const Evidence& evidence, int height)
    : rows_{{"", "", {fitted}}}, height_(height) {
  rows_.front().tracks = evidence.tracks ? &*evidence.tracks : nullptr;
}

cv::Mat FrontPainter::Draw(int frame) const {
  MotionPictureOptions options;
  options.figure = FigureChoice::kCapsules;
  const Drawing drawing = DrawMotionGrid(rows_, options, rows_.front().clips.front().motion->rate.FrameTime(frame));
  return ToImage(drawing, height_ / drawing.height);
}

}  // namespace mocurate
