#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry/rotation.h"

namespace mocurate {

/// A picture as a list of shapes, drawn alike to SVG, PNG and video. Pixels, x to the right, y down; later shapes cover
/// earlier ones.

using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

constexpr Colour kInkColour = {40, 44, 52}, kQuietColour = {130, 136, 146}, kFaintColour = {214, 218, 224};
constexpr Colour kBlue = {38, 110, 200}, kOrange = {224, 122, 32}, kGrey = {96, 102, 112};

struct LineShape {
  std::vector<Vector2d> points;
  double width = 1.0;
  Colour colour{};
  bool dashed = false;
};

struct PolygonShape {
  std::vector<Vector2d> points;
  Colour fill{};
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
  std::string title;  ///< text alternative
  std::vector<Shape> shapes;
};

/// An SVG file on white. Coordinates have one decimal.
std::string ToSvg(const Drawing& drawing);

/// A PNG file on white, `scale` pixels a unit.
std::string ToPng(const Drawing& drawing, double scale);

}  // namespace mocurate
