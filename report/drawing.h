#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry/rotation.h"

namespace mocurate {

/// A picture as a list of shapes, drawn alike to SVG, PNG, video and the pages. Pixels, x to the right, y down; later
/// shapes cover earlier ones.

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
  const char* name = nullptr;  ///< a variable of the pages' style, which has a light and a dark value; or none
};

constexpr Colour kInkColour = {40, 44, 52, "ink"}, kQuietColour = {110, 118, 128, "soft"},
                 kFaintColour = {214, 218, 224, "grid"}, kBeforeColour = {139, 149, 161, "before"},
                 kAfterColour = {37, 99, 201, "after"}, kGoodColour = {44, 125, 79, "good"},
                 kSuspectColour = {176, 125, 0, "suspect"}, kBadColour = {179, 57, 47, "bad"},
                 kLeftColour = {38, 110, 200, "left"}, kRightColour = {224, 122, 32, "right"};
constexpr Colour kGrey = {96, 102, 112}, kRed = {200, 48, 56}, kGreen = {36, 140, 78}, kBlue = {38, 110, 200},
                 kOrange = {214, 110, 20};

/// Towards white: 0 the colour itself, 1 white.
Colour Lightened(const Colour& colour, double part);

struct LineShape {
  std::vector<Vector2d> points;
  double width = 1.0;
  Colour colour{};
  bool dashed = false;
  std::string tip{};  ///< shown by browsers where the pointer rests
};

struct PolygonShape {
  std::vector<Vector2d> points;  ///< convex
  Colour fill{};
  std::string tip{};
};

enum class TextAnchor { kStart, kMiddle, kEnd };

struct TextShape {
  Vector2d at = Vector2d::Zero();  ///< on the base line
  std::string text;
  double size = 12.0;  ///< pixels
  TextAnchor anchor = TextAnchor::kStart;
  Colour colour{};
  bool bold = false;
};

using Shape = std::variant<PolygonShape, LineShape, TextShape>;

struct Drawing {
  double width = 0.0, height = 0.0;
  std::string title{};  ///< text alternative
  std::vector<Shape> shapes{};

  void Line(std::vector<Vector2d> points, double stroke, const Colour& colour, bool dashed = false);
  void Dot(const Vector2d& at, double diameter, const Colour& colour, const std::string& tip = "");
  void Box(double x, double y, double box_width, double box_height, const Colour& colour, const std::string& tip = "");
  void Text(double x, double y, const std::string& text, double size, TextAnchor anchor = TextAnchor::kStart,
            const Colour& colour = kInkColour, bool bold = false);
  /// Lines of whole words, the first one below `y`; returns the base line of the last.
  double Block(double x, double y, double block_width, const std::string& text, double size,
               TextAnchor anchor = TextAnchor::kStart, const Colour& colour = kQuietColour, bool bold = false);
  /// The title, which may be empty, at the top; returns where it ends.
  double Head();
  /// Ends the drawing with a note below `y` and `corner` at the right of it.
  void Finish(double y, const std::string& note, const std::string& corner);
};

/// Width of a text, an upper estimate for common sans serif fonts; pixels.
double TextWidth(const std::string& text, double size);

/// An SVG file on white. Coordinates have one decimal.
std::string ToSvg(const Drawing& drawing);
/// An <svg> element for the pages, in the colours of their style.
std::string ToInlineSvg(const Drawing& drawing);
/// Coordinates: at most one decimal.
std::string Coordinate(double value);

/// A PNG file on white, `scale` pixels a unit.
std::string ToPng(const Drawing& drawing, double scale);

}  // namespace mocurate
