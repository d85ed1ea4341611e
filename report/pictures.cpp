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
const cv::Scalar kInk(64, 56, 52);

cv::Point Rounded(const Vector2d& at) {
  return {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))};
}

double FloorOf(const Motion& motion) {
  double floor = motion.joints.at(0, 0).y();
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) floor = std::min(floor, motion.joints.at(f, j).y());
  }
  return floor - 0.03;
}

void DrawTracks(const JointTracks& tracks, const Skeleton& skeleton, int frame, const Camera& camera, cv::Mat& image) {
  const auto place = [&](int point) -> std::optional<cv::Point> {
    if (frame >= tracks.positions.frames) return std::nullopt;
    if (!(tracks.confidence[static_cast<std::size_t>(frame) * tracks.positions.joints + point] > 0.0))
      return std::nullopt;
    const auto pixel = camera.ProjectWorld(tracks.positions.at(frame, point));
    if (!pixel || !pixel->allFinite() || pixel->norm() > 1e5) return std::nullopt;
    return Rounded(*pixel);
  };
  for (const auto& [a, b] : MatchTracks(tracks.names, skeleton).lines) {
    const auto from = place(a);
    const auto to = place(b);
    if (from && to) cv::line(image, *from, *to, kInk, 2, cv::LINE_AA);
  }
  for (int k = 0; k < tracks.positions.joints; ++k) {
    const auto at = place(k);
    if (!at) continue;
    cv::circle(image, *at, 8, cv::Scalar(255, 255, 255), cv::FILLED, cv::LINE_AA);
    cv::circle(image, *at, 6, kInk, cv::FILLED, cv::LINE_AA);
  }
}

void WriteBelow(const std::string& text, cv::Mat& image) {
  const double size = 0.45 * kOversampling;
  int base = 0;
  const cv::Size extent = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, kOversampling, &base);
  cv::putText(image, text, {(image.cols - extent.width) / 2, image.rows - 8 * kOversampling}, cv::FONT_HERSHEY_SIMPLEX,
              size, kInk, kOversampling, cv::LINE_AA);
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

FrontPainter::FrontPainter(const Clip& fitted, const Evidence& evidence, const std::vector<int>& frames, int height)
    : fitted_(&fitted), evidence_(&evidence), view_(FrontView(*fitted.motion)), floor_(FloorOf(*fitted.motion)) {
  const Extent extent(*fitted.motion, frames);
  low_ = extent.low.y();
  high_ = extent.high.y();
  height_ = height * kOversampling;
  pixels_per_metre_ = 0.88 * height_ / extent.Height();
  const double wanted = std::clamp(2.0 * extent.reach * pixels_per_metre_, 0.4 * height_, 1.2 * height_);
  width_ = static_cast<int>(wanted) / kOversampling * kOversampling;
}

cv::Mat FrontPainter::Draw(int frame) const {
  const Motion& motion = *fitted_->motion;
  Vector3d centre = motion.joints.at(frame, 0);
  centre.y() = 0.5 * (low_ + high_) - 0.04;
  const Camera camera = LookAt(view_, centre, pixels_per_metre_, width_, height_);
  cv::Mat image = ShadeBody(BodyOf(*fitted_, frame), camera, floor_).image;
  if (evidence_->tracks) DrawTracks(*evidence_->tracks, *motion.skeleton, frame, camera, image);
  WriteBelow(FixedText(motion.rate.FrameTime(frame), 2) + " s", image);
  return Smaller(image);
}

Expected<std::string> ClipPicturePng(const Clip& fitted, const Evidence& evidence) {
  if (Status ok = CheckFrame(fitted, 0); !ok) return Forward(ok);
  const std::vector<int> chosen = StillFrames(fitted.motion->frame_count());
  const FrontPainter painter(fitted, evidence, chosen, 400);
  std::vector<cv::Mat> stills;
  for (const int frame : chosen) stills.push_back(painter.Draw(frame));
  cv::Mat strip;
  cv::hconcat(stills, strip);
  return EncodePng(strip);
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
