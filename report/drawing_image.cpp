#include "report/painters.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace mocurate {
namespace {

constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates

cv::Scalar ScalarOf(const Colour& colour) { return {double(colour.blue), double(colour.green), double(colour.red)}; }

class ImageWriter {
 public:
  ImageWriter(cv::Mat& image, double scale) : image_(image), scale_(scale) {}

  void operator()(const PolygonShape& shape) const {
    const std::vector<cv::Point> points = PointsOf(shape.points);
    if (points.size() < 3) return;
    cv::fillConvexPoly(image_, points, ScalarOf(shape.fill), cv::LINE_AA, kShift);
  }

  void operator()(const LineShape& shape) const {
    const std::vector<cv::Point> points = PointsOf(shape.points);
    const int width = std::max(1, static_cast<int>(std::lround(shape.width * scale_)));
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      if (!shape.dashed) {
        cv::line(image_, points[i], points[i + 1], ScalarOf(shape.colour), width, cv::LINE_AA, kShift);
        continue;
      }
      const double dash = 3.0 * scale_ * (1 << kShift), length = cv::norm(points[i + 1] - points[i]);
      for (double at = 0.0; at < length; at += 2.0 * dash) {
        const auto place = [&](double along) {
          return points[i] + cv::Point((points[i + 1] - points[i]) * (std::min(along, length) / length));
        };
        cv::line(image_, place(at), place(at + dash), ScalarOf(shape.colour), width, cv::LINE_AA, kShift);
      }
    }
  }

  void operator()(const TextShape& shape) const {
    constexpr double kHeight = 22.0;  // pixels of a Hershey capital at scale 1
    const double size = 0.72 * shape.size * scale_ / kHeight;
    const int thickness = std::max(1, static_cast<int>(std::lround(scale_ * (shape.bold ? 1.0 : 0.6))));
    int base = 0;
    const cv::Size extent = cv::getTextSize(shape.text, cv::FONT_HERSHEY_SIMPLEX, size, thickness, &base);
    double x = shape.at.x() * scale_;
    if (shape.anchor == TextAnchor::kMiddle) x -= 0.5 * extent.width;
    if (shape.anchor == TextAnchor::kEnd) x -= extent.width;
    cv::putText(image_, shape.text,
                {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(shape.at.y() * scale_))},
                cv::FONT_HERSHEY_SIMPLEX, size, ScalarOf(shape.colour), thickness, cv::LINE_AA);
  }

 private:
  std::vector<cv::Point> PointsOf(const std::vector<Vector2d>& points) const {
    std::vector<cv::Point> pixels;
    for (const Vector2d& point : points) {
      const auto fixed = [&](double value) {
        return static_cast<int>(std::lround(std::clamp(value * scale_, -1e5, 1e5) * (1 << kShift)));
      };
      pixels.emplace_back(fixed(point.x()), fixed(point.y()));
    }
    return pixels;
  }

  cv::Mat& image_;
  double scale_;
};

}  // namespace

cv::Mat ToImage(const Drawing& drawing, double scale) {
  cv::Mat image(std::max(1, static_cast<int>(std::ceil(drawing.height * scale))),
                std::max(1, static_cast<int>(std::ceil(drawing.width * scale))), CV_8UC3, cv::Scalar(255, 255, 255));
  const ImageWriter writer(image, scale);
  for (const Shape& shape : drawing.shapes) std::visit(writer, shape);
  return image;
}

std::string ToPng(const Drawing& drawing, double scale) { return EncodePng(ToImage(drawing, scale)).value_or(""); }

}  // namespace mocurate
