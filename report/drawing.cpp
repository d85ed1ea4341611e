#include "report/drawing.h"

#include <cstdio>

#include "report/html.h"
#include "report/svg.h"

namespace mocurate {
namespace {

std::string HexOf(const Colour& colour) {
  char text[8];
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

std::string PointsOf(const std::vector<Vector2d>& points) {
  std::string text;
  for (const Vector2d& point : points) {
    text += (text.empty() ? "" : " ") + Coordinate(point.x()) + "," + Coordinate(point.y());
  }
  return text;
}

struct SvgWriter {
  std::string operator()(const PolygonShape& shape) const {
    const std::string colour = HexOf(shape.fill);  // the outline closes gaps between neighbours
    return "<polygon points=\"" + PointsOf(shape.points) + "\" fill=\"" + colour + "\" stroke=\"" + colour +
           "\" stroke-width=\"0.4\"/>\n";
  }
  std::string operator()(const LineShape& shape) const {
    return "<polyline points=\"" + PointsOf(shape.points) + "\" fill=\"none\" stroke=\"" + HexOf(shape.colour) +
           "\" stroke-width=\"" + Coordinate(shape.width) + "\" stroke-linecap=\"round\" stroke-linejoin=\"round\"" +
           (shape.dashed ? " stroke-dasharray=\"3 3\"" : "") + "/>\n";
  }
  std::string operator()(const TextShape& shape) const {
    const char* anchor = shape.anchor == TextAnchor::kStart ? "start"
                         : shape.anchor == TextAnchor::kEnd ? "end"
                                                            : "middle";
    return "<text x=\"" + Coordinate(shape.at.x()) + "\" y=\"" + Coordinate(shape.at.y()) + "\" font-size=\"" +
           Coordinate(shape.size) + "\" text-anchor=\"" + anchor + "\" fill=\"" + HexOf(shape.colour) + "\"" +
           (shape.bold ? " font-weight=\"bold\"" : "") + ">" + EscapeHtml(shape.text) + "</text>\n";
  }
};

}  // namespace

std::string ToSvg(const Drawing& drawing) {
  const std::string width = Coordinate(drawing.width), height = Coordinate(drawing.height);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "\" height=\"" + height +
                    "\" viewBox=\"0 0 " + width + " " + height +
                    "\" font-family=\"sans-serif\" role=\"img\">\n<title>" + EscapeHtml(drawing.title) +
                    "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const Shape& shape : drawing.shapes) svg += std::visit(SvgWriter(), shape);
  return svg + "</svg>\n";
}

}  // namespace mocurate
