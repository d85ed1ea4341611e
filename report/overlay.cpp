#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "report/pictures.h"
#include "report/scene.h"

namespace mocurate {
namespace {

constexpr int kWantedHeight = 640;
const cv::Scalar kOutline(255, 255, 255);
const cv::Scalar kNothing(34, 28, 24);

/// The part of a view that shows the body, with a margin; the whole view when the body is out of sight.
cv::Rect CropOf(const PosedBody& body, const Camera& camera) {
  const cv::Rect whole(0, 0, camera.width, camera.height);
  const DepthRendering rendering = RenderBody(body.capsules, body.points.data(), camera, PixelRays(camera));
  cv::Rect box;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      if (rendering.capsule[static_cast<std::size_t>(y) * camera.width + x] >= 0) box |= cv::Rect(x, y, 1, 1);
    }
  }
  if (box.area() < 16) return whole;
  const int margin = std::max(box.width, box.height) / 7 + 4;
  return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) & whole;
}

/// The camera of a part of a view, enlarged.
Camera CameraOf(const Camera& camera, const cv::Rect& crop, int factor) {
  Camera part = camera;
  part.width = crop.width * factor;
  part.height = crop.height * factor;
  part.fx *= factor;
  part.fy *= factor;
  part.cx = (camera.cx - crop.x + 0.5) * factor - 0.5;
  part.cy = (camera.cy - crop.y + 0.5) * factor - 0.5;
  return part;
}

/// False colours over the middle 96 % of the depths; nothing measured is dark.
cv::Mat FalseColours(const cv::Mat& depth, int factor) {
  std::vector<std::uint16_t> values;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      if (depth.at<std::uint16_t>(y, x) > 0) values.push_back(depth.at<std::uint16_t>(y, x));
    }
  }
  cv::Mat colours(depth.size(), CV_8UC3, kNothing);
  if (!values.empty()) {
    std::sort(values.begin(), values.end());
    const double low = values[values.size() / 50];
    const double high = std::max(low + 1.0, static_cast<double>(values[values.size() - 1 - values.size() / 50]));
    cv::Mat scaled;
    depth.convertTo(scaled, CV_8UC1, -255.0 / (high - low), 255.0 * high / (high - low));
    cv::Mat mapped;
    cv::applyColorMap(scaled, mapped, cv::COLORMAP_VIRIDIS);
    mapped.copyTo(colours, depth > 0);
  }
  cv::Mat enlarged;
  cv::resize(colours, enlarged, {}, factor, factor, cv::INTER_NEAREST);
  return enlarged;
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
    const auto pixel = [](const Vector2d& at) {
      return cv::Point(static_cast<int>(std::lround(16.0 * at.x())), static_cast<int>(std::lround(16.0 * at.y())));
    };
    cv::line(image, pixel(*from), pixel(*to), colour, 2, cv::LINE_AA, 4);
    cv::circle(image, pixel(*to), 3 * 16, colour, cv::FILLED, cv::LINE_AA, 4);
  }
}

Expected<cv::Mat> Overlay(const Clip& fitted, const Evidence& evidence, int view, int frame) {
  if (Status ok = CheckFrame(fitted, frame); !ok) return Forward(ok);
  if (view < 0 || view >= static_cast<int>(evidence.depth_views.size())) {
    return Fail(ErrorCode::kInconsistent,
                "view " + std::to_string(view) + " of " + std::to_string(evidence.depth_views.size()) + " depth views",
                fitted.id());
  }
  const DepthView& seen = evidence.depth_views[view];
  const auto depth = ReadDepth(seen, frame);
  if (!depth) return Forward(depth);
  const PosedBody body = BodyOf(fitted, frame);
  const cv::Rect crop = CropOf(body, seen.camera);
  const int factor = std::clamp((kWantedHeight + crop.height / 2) / std::max(1, crop.height), 1, 4);
  const Camera camera = CameraOf(seen.camera, crop, factor);
  cv::Mat image = FalseColours((*depth)(crop), factor);
  DrawOutlines(RenderBody(body.capsules, body.points.data(), camera, PixelRays(camera)),
               static_cast<int>(body.capsules.capsules.size()), image);
  DrawBones(*fitted.motion, frame, camera, image);
  return image;
}

}  // namespace

Expected<std::string> BodyOverlayPng(const Clip& fitted, const Evidence& evidence, int view, int frame) {
  const auto image = Overlay(fitted, evidence, view, frame);
  if (!image) return Forward(image);
  return EncodePng(*image);
}

Status WriteBodyOverlay(const Clip& fitted, const Evidence& evidence, int view, int frame,
                        const std::filesystem::path& png) {
  const auto image = Overlay(fitted, evidence, view, frame);
  return image ? WritePng(*image, png) : Forward(image);
}

}  // namespace mocurate
