#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "report/html.h"
#include "report/painters.h"

namespace mocurate {
namespace {

constexpr int kWantedHeight = 640;
constexpr int kRangeSample = 5;  ///< of the false colours: every fifth pixel
const cv::Scalar kOutline(255, 255, 255);
const cv::Scalar kNothing(34, 28, 24);
const cv::Scalar kBystander(120, 116, 112);
const cv::Scalar kDetection(90, 235, 250);

/// The part of a view that contains the body in `frames`, with a margin; the whole view when the body is outside.
cv::Rect CropOf(const Clip& fitted, const Camera& camera, const std::vector<int>& frames) {
  constexpr double kNear = 0.1;  // metres before the camera
  const cv::Rect whole(0, 0, camera.width, camera.height);
  Vector2d low(1e9, 1e9);
  Vector2d high(-1e9, -1e9);
  for (const int frame : frames) {
    const PosedBody body = BodyOf(fitted, frame);
    for (const Capsule& capsule : body.capsules.capsules) {
      for (const int end : {capsule.parent, capsule.joint}) {
        const double z = (camera.camera_from_world * body.points[end]).z();
        const auto at = camera.ProjectWorld(body.points[end]);
        if (z < kNear || !at || !at->allFinite() || at->norm() > 1e5) continue;
        const Vector2d reach = Vector2d(camera.fx, camera.fy) * capsule.radius / z;
        low = low.cwiseMin(*at - reach);
        high = high.cwiseMax(*at + reach);
      }
    }
  }
  if (low.x() > high.x()) return whole;
  const cv::Point first(static_cast<int>(std::floor(low.x())), static_cast<int>(std::floor(low.y())));
  const cv::Point last(static_cast<int>(std::ceil(high.x())), static_cast<int>(std::ceil(high.y())));
  const cv::Rect box = cv::Rect(first, last) & whole;
  if (box.area() < 16) return whole;
  const int margin = std::max(box.width, box.height) / 7 + 4;
  return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) & whole;
}

/// The camera of a part of a view, enlarged.
Camera CameraOf(const Camera& camera, const cv::Rect& crop, double factor) {
  Camera part = camera;
  part.width = std::max(1, static_cast<int>(std::lround(crop.width * factor)));
  part.height = std::max(1, static_cast<int>(std::lround(crop.height * factor)));
  part.fx *= factor;
  part.fy *= factor;
  part.cx = (camera.cx - crop.x + 0.5) * factor - 0.5;
  part.cy = (camera.cy - crop.y + 0.5) * factor - 0.5;
  return part;
}

void DrawOutlines(const DepthRendering& rendering, int bodies, cv::Mat& image) {
  cv::Mat whole(image.size(), CV_8UC1, cv::Scalar(0));
  std::vector<cv::Mat> parts(bodies, cv::Mat());
  for (cv::Mat& part : parts) part = cv::Mat(image.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const int capsule = rendering.capsule[static_cast<std::size_t>(y) * image.cols + x];
      if (capsule < 0) continue;
      whole.at<uchar>(y, x) = 255;
      parts[capsule].at<uchar>(y, x) = 255;
    }
  }
  cv::Mat thin = image.clone();
  std::vector<std::vector<cv::Point>> contours;
  for (const cv::Mat& part : parts) {
    cv::findContours(part, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(thin, contours, -1, kOutline, 1, cv::LINE_AA);
  }
  cv::addWeighted(thin, 0.55, image, 0.45, 0.0, image);
  cv::findContours(whole, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  cv::drawContours(image, contours, -1, kOutline, 1, cv::LINE_AA);
}

void DrawBones(const Motion& motion, int frame, const Camera& camera, cv::Mat& image) {
  const std::vector<int> sides = SidesOf(*motion.skeleton);
  for (int j = 1; j < motion.joint_count(); ++j) {
    const auto from = camera.ProjectWorld(motion.joints.at(frame, motion.skeleton->joints[j].parent));
    const auto to = camera.ProjectWorld(motion.joints.at(frame, j));
    if (!from || !to || from->norm() > 1e5 || to->norm() > 1e5) continue;
    const cv::Scalar colour = sides[j] > 0   ? cv::Scalar(255, 170, 90)
                              : sides[j] < 0 ? cv::Scalar(60, 140, 255)
                                             : kOutline;
    cv::line(image, Sixteenths(*from), Sixteenths(*to), colour, 2, cv::LINE_AA, 4);
    cv::circle(image, Sixteenths(*to), 3 * 16, colour, cv::FILLED, cv::LINE_AA, 4);
  }
}

}  // namespace

std::vector<int> JointsOfKeypoints(const Skeleton& skeleton, const std::vector<std::string>& names) {
  const bool face = std::find(names.begin(), names.end(), "nose") != names.end();
  std::vector<int> joints;
  for (const std::string& name : names) {
    const auto joint = skeleton.FindJoint(name);
    // Beside a face, a detector's neck is the middle between the shoulders.
    joints.push_back(joint && !(face && name == "neck") ? *joint : -1);
  }
  return joints;
}

int ViewCount(const Evidence& evidence) {
  return static_cast<int>(evidence.depth_views.size() + evidence.keypoint_views.size());
}

const Camera& ViewCamera(const Evidence& evidence, int view) {
  const auto depth = static_cast<int>(evidence.depth_views.size());
  return view < depth ? evidence.depth_views[view].camera : evidence.keypoint_views[view - depth].camera;
}

std::vector<int> ChosenViews(const Evidence& evidence, int most) {
  std::vector<int> chosen;
  const int views = ViewCount(evidence);
  const int count = std::min(views, most);
  chosen.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) chosen.push_back(i * views / count);
  return chosen;
}

Expected<ViewPainter> ViewPainter::Make(const Clip& fitted, const Evidence& evidence, int view,
                                        const std::vector<int>& frames, int height, bool exact) {
  for (const int frame : frames) {
    if (Status ok = CheckFrame(fitted, frame); !ok) return Forward(ok);
  }
  if (frames.empty() || view < 0 || view >= ViewCount(evidence)) {
    return Fail(ErrorCode::kInconsistent,
                "view " + std::to_string(view) + " of " + std::to_string(ViewCount(evidence)) + " views", fitted.id());
  }
  const Camera& camera = ViewCamera(evidence, view);
  if (camera.width <= 0 || camera.height <= 0) {
    return Fail(ErrorCode::kInconsistent, "the size of the images is unknown", camera.name,
                "use a calibration that states it");
  }
  ViewPainter painter;
  painter.fitted_ = &fitted;
  painter.evidence_ = &evidence;
  painter.view_ = view;
  painter.crop_ = CropOf(fitted, camera, frames);
  const int rows = std::max(1, painter.crop_.height);
  double factor = static_cast<double>(height) / rows;
  const bool depth = view < static_cast<int>(evidence.depth_views.size());
  if (depth && !exact) factor = std::clamp((height + rows / 2) / rows, 1, 4);
  painter.camera_ = CameraOf(camera, painter.crop_, factor);
  if (exact) painter.camera_.height = height;
  painter.rays_ = PixelRays(painter.camera_);
  if (depth) {
    if (Status ranged = painter.SetDepthRange(frames.front()); !ranged) return Forward(ranged);
  }
  return painter;
}

Status ViewPainter::SetDepthRange(int frame) {
  const auto depth = ReadDepth(evidence_->depth_views[view_], frame);
  if (!depth) return Forward(depth);
  std::vector<std::uint16_t> values;
  for (int y = crop_.y; y < crop_.y + crop_.height; ++y) {
    for (int x = crop_.x + y % kRangeSample; x < crop_.x + crop_.width; x += kRangeSample) {
      if (depth->at<std::uint16_t>(y, x) > 0) values.push_back(depth->at<std::uint16_t>(y, x));
    }
  }
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  low_ = values[values.size() / 50];
  high_ = std::max(low_ + 1.0, static_cast<double>(values[values.size() - 1 - values.size() / 50]));
  return {};
}

/// False colours over the middle 96 % of the depths; nothing measured is dark.
Expected<cv::Mat> ViewPainter::Ground(int frame) const {
  const cv::Size size(camera_.width, camera_.height);
  if (view_ >= static_cast<int>(evidence_->depth_views.size())) return cv::Mat(size, CV_8UC3, kNothing);
  const auto whole = ReadDepth(evidence_->depth_views[view_], frame);
  if (!whole) return Forward(whole);
  const cv::Mat depth = (*whole)(crop_);
  cv::Mat scaled;
  depth.convertTo(scaled, CV_8UC1, -255.0 / (high_ - low_), 255.0 * high_ / (high_ - low_));
  cv::Mat mapped;
  cv::applyColorMap(scaled, mapped, cv::COLORMAP_VIRIDIS);
  cv::Mat colours(depth.size(), CV_8UC3, kNothing);
  mapped.copyTo(colours, depth > 0);
  cv::Mat enlarged;
  cv::resize(colours, enlarged, size, 0.0, 0.0, cv::INTER_NEAREST);
  return enlarged;
}

void ViewPainter::DrawKeypoints(int frame, cv::Mat& image) const {
  const auto first = static_cast<int>(evidence_->depth_views.size());
  if (view_ < first) return;
  const KeypointView& view = evidence_->keypoint_views[view_ - first];
  const Motion& motion = *fitted_->motion;
  const int shown = ImageAt(view, motion.rate.FrameTime(frame), motion.rate.FrameTime(1));
  if (shown < 0) return;
  const int person =
      FindPerson(view, shown, JointsOfKeypoints(*motion.skeleton, evidence_->keypoint_names), motion, frame).index;
  const auto lines = MatchTracks(evidence_->keypoint_names, *fitted_->motion->skeleton).lines;
  const double factor = camera_.fx / view.camera.fx;
  const auto place = [&](const double* point) {
    return Sixteenths((Vector2d(point[0] - crop_.x, point[1] - crop_.y) + Vector2d(0.5, 0.5)) * factor -
                      Vector2d(0.5, 0.5));
  };
  for (int p = 0; p < view.people; ++p) {
    const cv::Scalar colour = p == person ? kDetection : kBystander;
    for (const auto& [a, b] : lines) {
      const double* from = view.at(shown, p, a);
      const double* to = view.at(shown, p, b);
      if (!(from[2] > 0.0) || !(to[2] > 0.0)) continue;
      cv::line(image, place(from), place(to), 0.5 * colour, 1, cv::LINE_AA, 4);
    }
    for (int k = 0; k < view.points(); ++k) {
      const double* point = view.at(shown, p, k);
      if (point[2] > 0.0) cv::circle(image, place(point), 3 * 16, colour, cv::FILLED, cv::LINE_AA, 4);
    }
  }
}

Expected<cv::Mat> ViewPainter::Draw(int frame) const {
  if (Status ok = CheckFrame(*fitted_, frame); !ok) return Forward(ok);
  Expected<cv::Mat> ground = Ground(frame);
  if (!ground) return ground;
  cv::Mat image = *ground;
  const PosedBody body = BodyOf(*fitted_, frame);
  DrawOutlines(RenderBody(body.capsules, body.points.data(), camera_, rays_),
               static_cast<int>(body.capsules.capsules.size()), image);
  DrawBones(*fitted_->motion, frame, camera_, image);
  DrawKeypoints(frame, image);
  return image;
}

Expected<std::string> BodyOverlayPng(const Clip& fitted, const Evidence& evidence, int view, int frame) {
  const auto painter = ViewPainter::Make(fitted, evidence, view, {frame}, kWantedHeight, false);
  const auto image = painter ? painter->Draw(frame) : Forward(painter);
  if (!image) return Forward(image);
  return EncodePng(*image);
}

std::string OverlayHtml(const Clip& fitted, const Evidence& evidence, int view, int frame) {
  const std::string name = "view " + EscapeHtml(ViewCamera(evidence, view).name) + ", frame " + std::to_string(frame);
  const auto png = BodyOverlayPng(fitted, evidence, view, frame);
  if (!png) return Paragraph("Not drawn over " + name + ": " + EscapeHtml(png.error().Message()), "soft");
  return "<figure><img alt=\"Fitted body over " + name + "\" src=\"data:image/png;base64," + Base64(*png) +
         "\"><figcaption>Fit over " + name + "</figcaption></figure>\n";
}

}  // namespace mocurate
