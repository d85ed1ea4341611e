#include "report/painters.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/file.h"
#include "core/formats/png.h"

namespace mocurate {
namespace {

constexpr double kDistance = 12.0;  ///< metres from the eye: nearly parallel rays
const cv::Scalar kBackground(250, 248, 247);
const cv::Scalar kShadow(232, 228, 225);

cv::Vec3d ColourOf(int side) {
  if (side > 0) return {214, 130, 72};
  return side < 0 ? cv::Vec3d(74, 136, 222) : cv::Vec3d(176, 164, 156);
}

void DrawShadow(const PosedBody& body, const Camera& camera, double floor_y, cv::Mat& image) {
  for (const Capsule& capsule : body.capsules.capsules) {
    Vector3d ends[] = {body.points[capsule.parent], body.points[capsule.joint]};
    for (Vector3d& end : ends) end.y() = floor_y;
    const auto from = camera.ProjectWorld(ends[0]);
    const auto to = camera.ProjectWorld(ends[1]);
    if (!from || !to) continue;
    const int thickness = std::max(2, static_cast<int>(1.2 * capsule.radius * camera.fx / kDistance));
    cv::line(image, Sixteenths(*from), Sixteenths(*to), kShadow, thickness, cv::LINE_AA, 4);
  }
}

}  // namespace

cv::Point Sixteenths(const Vector2d& at) {
  return {static_cast<int>(std::lround(16.0 * at.x())), static_cast<int>(std::lround(16.0 * at.y()))};
}

Camera LookAt(const Viewpoint& view, const Vector3d& centre, double pixels_per_metre, int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = kDistance * pixels_per_metre;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  Matrix3d turned;
  for (int axis = 0; axis < 3; ++axis) turned.col(axis) = view.Turn(Vector3d::Unit(axis));
  const Matrix3d camera_from_eye = Vector3d(1.0, -1.0, -1.0).asDiagonal();
  const Matrix3d rotation = camera_from_eye * turned;
  camera.camera_from_world.rotation = Quaterniond(rotation);
  camera.camera_from_world.translation = Vector3d(0.0, 0.0, kDistance) - rotation * centre;
  return camera;
}

ShadedBody ShadeBody(const PosedBody& body, const Camera& camera, double floor_y) {
  ShadedBody shaded;
  shaded.image = cv::Mat(camera.height, camera.width, CV_8UC3, kBackground);
  DrawShadow(body, camera, floor_y, shaded.image);
  const std::vector<Vector2d> rays = PixelRays(camera);
  const Vector3d* points = body.points.data();
  const DepthRendering rendering = RenderBody(body.capsules, points, camera, rays);
  const Vector3d to_light = Vector3d(-0.45, -0.65, -0.75).normalized();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rendering.capsule[i] < 0) continue;
    const Capsule& capsule = body.capsules.capsules[rendering.capsule[i]];
    const Vector3d point = static_cast<double>(rendering.depth[i]) * Vector3d(rays[i].x(), rays[i].y(), 1.0);
    const CapsulePoint on = ClosestOnCapsule(camera.camera_from_world * points[capsule.parent],
                                             camera.camera_from_world * points[capsule.joint], capsule.radius, point);
    const double light = 0.62 + 0.42 * std::max(0.0, on.normal.dot(to_light));
    const cv::Vec3d colour = light * ColourOf(body.sides[rendering.capsule[i]]);
    shaded.image.at<cv::Vec3b>(static_cast<int>(i) / camera.width, static_cast<int>(i) % camera.width) = cv::Vec3b(
        cv::saturate_cast<uchar>(colour[0]), cv::saturate_cast<uchar>(colour[1]), cv::saturate_cast<uchar>(colour[2]));
  }
  shaded.depth = rendering.depth;
  return shaded;
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

}  // namespace mocurate
