#include "report/drawing.h"

#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <utility>

#include "core/base/text.h"
#include "report/html.h"

namespace mocurate {
namespace {

constexpr double kMargin = 10.0;  // pixels

/// Writes shapes as elements. `inlined`: for the pages, whose style knows the classes of colours.
struct SvgWriter {
  bool inlined;

  /// Attributes that give the properties a colour.
  std::string Painted(std::initializer_list<const char*> properties, const Colour& colour) const {
    char value[8];
    std::snprintf(value, sizeof(value), "#%02x%02x%02x", colour.red, colour.green, colour.blue);
    if (inlined && colour.name != nullptr) return std::string(" class=\"c-") + colour.name + "\"";
    if (inlined) return std::string(" style=\"--c:") + value + "\"";
    std::string text;
    for (const char* property : properties) text += std::string(" ") + property + "=\"" + value + "\"";
    return text;
  }
  static std::string Ended(const char* element, const std::string& tip) {
    return tip.empty() ? "/>\n" : "><title>" + EscapeHtml(tip) + "</title></" + element + ">\n";
  }
  static std::string Points(const std::vector<Vector2d>& points) {
    std::string text;
    for (const Vector2d& point : points) {
      text += (text.empty() ? "" : " ") + Coordinate(point.x()) + "," + Coordinate(point.y());
    }
    return " points=\"" + text + "\"";
  }

  std::string operator()(const PolygonShape& shape) const {  // the outline closes gaps
    return "<polygon" + Points(shape.points) + Painted({"fill", "stroke"}, shape.fill) +
           (inlined ? "" : " stroke-width=\"0.4\"") + Ended("polygon", shape.tip);
  }
  std::string operator()(const LineShape& shape) const {
    return "<polyline" + Points(shape.points) + (inlined ? "" : " fill=\"none\"") + " stroke-width=\"" +
           Coordinate(shape.width) + "\"" + (shape.dashed ? " stroke-dasharray=\"3 4\"" : "") +
           Painted({"stroke"}, shape.colour) + Ended("polyline", shape.tip);
  }
  std::string operator()(const TextShape& shape) const {
    static constexpr const char* kAnchors[] = {"start", "middle", "end"};
    return "<text x=\"" + Coordinate(shape.at.x()) + "\" y=\"" + Coordinate(shape.at.y()) + "\" font-size=\"" +
           Coordinate(shape.size) + "\" text-anchor=\"" + kAnchors[static_cast<int>(shape.anchor)] + "\"" +
           (shape.bold ? " font-weight=\"bold\"" : "") + Painted({"fill"}, shape.colour) + ">" +
           EscapeHtml(shape.text) + "</text>\n";
  }
};

std::string ViewBox(const Drawing& drawing) {
  return " stroke-linecap=\"round\" stroke-linejoin=\"round\" viewBox=\"0 0 " + Coordinate(drawing.width) + " " +
         Coordinate(drawing.height) + "\" role=\"img\"";
}

}  // namespace

Colour Lightened(const Colour& colour, double part) {
  const auto mixed = [&](std::uint8_t value) {
    return static_cast<std::uint8_t>(std::lround(value + part * (255.0 - value)));
  };
  return {mixed(colour.red), mixed(colour.green), mixed(colour.blue)};
}

void Drawing::Line(std::vector<Vector2d> points, double stroke, const Colour& colour, bool dashed) {
  shapes.emplace_back(LineShape{std::move(points), stroke, colour, dashed});
}

void Drawing::Dot(const Vector2d& at, double diameter, const Colour& colour, const std::string& tip) {
  shapes.emplace_back(LineShape{{at, at}, diameter, colour, false, tip});
}

void Drawing::Box(double x, double y, double box_width, double box_height, const Colour& colour,
                  const std::string& tip) {
  shapes.emplace_back(
      PolygonShape{{{x, y}, {x + box_width, y}, {x + box_width, y + box_height}, {x, y + box_height}}, colour, tip});
}

void Drawing::Text(double x, double y, const std::string& text, double size, TextAnchor anchor, const Colour& colour,
                   bool bold) {
  shapes.emplace_back(TextShape{Vector2d(x, y), text, size, anchor, colour, bold});
}

double TextWidth(const std::string& text, double size) { return 0.62 * size * static_cast<double>(text.size()); }

double Drawing::Block(double x, double y, double block_width, const std::string& text, double size, TextAnchor anchor,
                      const Colour& colour, bool bold) {
  std::string line;
  const auto end_line = [&] {
    if (!line.empty()) Text(x, y += size + 2.0, line, size, anchor, colour, bold);
  };
  for (const std::string_view word : SplitText(text, ' ')) {
    const std::string longer = line.empty() ? std::string(word) : line + " " + std::string(word);
    if (!line.empty() && TextWidth(longer, size) > block_width) {
      end_line();
      line = word;
    } else {
      line = longer;
    }
  }
  end_line();
  return y;
}

double Drawing::Head() {
  return Block(kMargin, title.empty() ? 0.0 : 4.0, width - 2.0 * kMargin, title, 14.0, TextAnchor::kStart, kInkColour,
               true);
}

void Drawing::Finish(double y, const std::string& note, const std::string& corner) {
  const double inner = width - 2.0 * kMargin;
  height = Block(width - kMargin, Block(kMargin, y, inner, note, 11.0), inner, corner, 11.0, TextAnchor::kEnd) + 8.0;
}

std::string ToSvg(const Drawing& drawing) {
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + Coordinate(drawing.width) + "\" height=\"" +
                    Coordinate(drawing.height) + "\"" + ViewBox(drawing) + " font-family=\"sans-serif\">\n<title>" +
                    EscapeHtml(drawing.title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const Shape& shape : drawing.shapes) svg += std::visit(SvgWriter{false}, shape);
  return svg + "</svg>\n";
}

std::string ToInlineSvg(const Drawing& drawing) {
  std::string svg = "<svg" + ViewBox(drawing) + " aria-label=\"" + EscapeHtml(drawing.title) +
                    "\" style=\"max-width:" + Coordinate(drawing.width) + "px\">\n";
  for (const Shape& shape : drawing.shapes) svg += std::visit(SvgWriter{true}, shape);
  return svg + "</svg>\n";
}

std::string Coordinate(double value) {
  const long long tenths = std::llround(value * 10.0);
  std::string text = std::to_string(std::llabs(tenths) / 10);
  if (tenths % 10 != 0) text += "." + std::to_string(std::llabs(tenths) % 10);
  return (tenths < 0 ? "-" : "") + text;
}

}  // namespace mocurate
