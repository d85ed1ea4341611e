#include "report/painters.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/base/file.h"
#include "report/html.h"
#include "report/options.h"
#include "report/stages.h"

namespace mocurate {
namespace {

constexpr int kOversampling = 2;

cv::Point Rounded(const Vector2d& at) {
  return {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))};
}

cv::Mat Smaller(const cv::Mat& image) {
  cv::Mat smaller;
  cv::resize(image, smaller, {image.cols / kOversampling, image.rows / kOversampling}, 0, 0, cv::INTER_AREA);
  return smaller;
}

/// Extent of the frames: heights in the world, and the reach to either side of the root in the view.
struct Extent {
  Vector3d low = Vector3d::Constant(1e9);
  Vector3d high = Vector3d::Constant(-1e9);
  double reach = 0.3;

  Extent(const Motion& motion, const std::vector<int>& frames) {
    const Viewpoint view = FrontView(motion);
    for (const int f : frames) {
      const double middle = view.Turn(motion.joints.at(f, 0)).x();
      for (int j = 0; j < motion.joint_count(); ++j) {
        low = low.cwiseMin(motion.joints.at(f, j));
        high = high.cwiseMax(motion.joints.at(f, j));
        reach = std::max(reach, std::abs(view.Turn(motion.joints.at(f, j)).x() - middle) + 0.1);
      }
    }
  }
  double Height() const { return std::max(0.5, high.y() - low.y() + 0.35); }
};

/// Measured points of all views that lie near the body, world.
Expected<std::vector<Vector3d>> CloudNear(const PosedBody& body, const Evidence& evidence, int frame) {
  constexpr double kReach = 0.3;
  std::vector<Vector3d> points;
  for (const DepthView& view : evidence.depth_views) {
    const auto depth = ReadDepth(view, frame);
    if (!depth) return Forward(depth);
    const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
    for (int y = 0; y < depth->rows; ++y) {
      for (int x = 0; x < depth->cols; ++x) {
        const double metres = depth->at<std::uint16_t>(y, x) * view.metres_per_unit;
        if (metres <= 0.0) continue;
        const Vector3d world = world_from_camera * view.camera.Unproject(Vector2d(x, y), metres);
        const auto near = ClosestOnBody(body.capsules, body.points.data(), world);
        if (near && near->on_capsule.distance < kReach) points.push_back(world);
      }
    }
  }
  return points;
}

/// Points in front of the body or just below its surface are drawn over it; those farther behind are occluded.
void DrawCloud(const std::vector<Vector3d>& points, const Camera& camera, const std::vector<float>& body_depth,
               cv::Mat& image) {
  constexpr double kVeil = 0.5;
  constexpr double kSkin = 0.02;  // metres
  const cv::Vec3d colour(150, 128, 58);
  std::vector<bool> drawn(body_depth.size(), false);
  for (const Vector3d& point : points) {
    const Vector3d seen = camera.camera_from_world * point;
    const auto at = camera.Project(seen);
    if (!at) continue;
    const cv::Point pixel = Rounded(*at);
    if (pixel.x < 0 || pixel.y < 0 || pixel.x + 1 >= image.cols || pixel.y + 1 >= image.rows) continue;
    for (const cv::Point& part : {pixel, pixel + cv::Point(1, 0), pixel + cv::Point(0, 1), pixel + cv::Point(1, 1)}) {
      const std::size_t index = static_cast<std::size_t>(part.y) * image.cols + part.x;
      if (drawn[index] || (body_depth[index] > 0.0F && seen.z() > body_depth[index] + kSkin)) continue;
      drawn[index] = true;
      cv::Vec3b& under = image.at<cv::Vec3b>(part);
      for (int c = 0; c < 3; ++c) under[c] = cv::saturate_cast<uchar>(kVeil * colour[c] + (1.0 - kVeil) * under[c]);
    }
  }
}

}  // namespace

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

Expected<std::string> ClipPicturePng(const Clip& fitted, const Evidence& evidence) {
  if (Status ok = CheckFrame(fitted, 0); !ok) return Forward(ok);
  return ToPng(DrawFilmstrip(fitted, evidence.tracks ? &*evidence.tracks : nullptr, true, FigureChoice::kCapsules),
               2.0);
}

Expected<std::string> CloudPicturePng(const Clip& fitted, const Evidence& evidence, int frame) {
  if (Status ok = CheckFrame(fitted, frame); !ok) return Forward(ok);
  if (evidence.depth_views.empty())
    return Fail(ErrorCode::kInconsistent, "the evidence has no depth views", fitted.id());
  const Motion& motion = *fitted.motion;
  const PosedBody body = BodyOf(fitted, frame);
  const auto points = CloudNear(body, evidence, frame);
  if (!points) return Forward(points);
  const Extent extent(motion, {frame});
  const int height = 560 * kOversampling;
  const double pixels_per_metre = 0.9 * height / extent.Height();
  std::vector<cv::Mat> panels;
  for (const double turn : {0.0, 1.35}) {
    Viewpoint view = FrontView(motion);
    view.yaw += turn;
    const Camera camera = LookAt(view, 0.5 * (extent.low + extent.high), pixels_per_metre, 400 * kOversampling, height);
    ShadedBody shaded = ShadeBody(body, camera, extent.low.y() - 0.05);
    DrawCloud(*points, camera, shaded.depth, shaded.image);
    panels.push_back(Smaller(shaded.image));
  }
  cv::Mat both;
  cv::hconcat(panels, both);
  return EncodePng(both);
}

Expected<StageOutcome> PictureStage(const StageRequest& request) {
  const auto options = OptionsFromJson<PictureOptions>(request.options, "picture");
  if (!options) return Forward(options);
  const auto drawn = ReadDrawnClip(request);
  if (!drawn) return Forward(drawn);
  const Clip& clip = drawn->fitted;
  const Evidence& evidence = drawn->evidence.evidence;
  const int middle = clip.motion->frame_count() / 2;
  const auto png = options->kind == PictureKind::kClip      ? ClipPicturePng(clip, evidence)
                   : options->kind == PictureKind::kOverlay ? BodyOverlayPng(clip, evidence, 0, middle)
                                                            : CloudPicturePng(clip, evidence, middle);
  if (!png) return Forward(png);
  if (Status written = WriteFile(request.output, *png); !written) return Forward(written);
  return StageOutcome();
}

}  // namespace mocurate
