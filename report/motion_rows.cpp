#include "report/motion_rows.h"

#include <algorithm>
#include <cmath>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/posed_body.h"
#include "report/svg.h"

namespace mocurate {
namespace {

// Pixels.
constexpr double kNames = 150.0;     // to the left of the figures
constexpr double kPath = 84.0;       // square of the root's path
constexpr double kFigure = 110.0;    // height that the tallest figure takes
constexpr double kTimes = 14.0;      // below the figures
constexpr double kBracket = 20.0;    // below the times, of rows with segments
constexpr double kHead = 26.0;       // of a title
constexpr double kSpace = 8.0;       // between rows
constexpr double kLeastCell = 34.0;  // width of a figure
constexpr double kMostCell = 200.0;

constexpr const char* kTransition = "transition";

const Colour& ColourOfSide(int side) { return side > 0 ? kBlue : side < 0 ? kOrange : kGrey; }

Colour Shaded(const Colour& colour, double light) {
  Colour shaded{};
  for (std::size_t i = 0; i < 3; ++i) {
    shaded[i] = static_cast<std::uint8_t>(std::lround(std::clamp(light * colour[i], 0.0, 255.0)));
  }
  return shaded;
}

/// A figure in a frame, metres: x to the right of the root, y up in the world, z towards the viewer.
struct SeenFigure {
  struct Part {
    double depth = 0.0;  ///< the farther from the eye, the less
    std::vector<Vector2d> outline;
    std::vector<Vector2d> line;
    Colour colour{};
  };
  std::vector<Part> parts;  ///< the farthest first
  double left = 0.0, right = 0.0, low = 0.0, high = 0.0;
};

/// The view of a row: level with the horizon, so that heights are preserved.
class Eye {
 public:
  explicit Eye(const Motion& motion) : view_(FrontView(motion)) { view_.pitch = 0.0; }
  Vector3d See(const Vector3d& point, const Vector3d& root) const {
    const Vector3d level(root.x(), 0.0, root.z());
    return view_.Turn(point - level);
  }

 private:
  Viewpoint view_;
};

/// The convex hull of two discs.
std::vector<Vector2d> HullOfDiscs(const Vector2d& a, const Vector2d& b, double radius) {
  constexpr int kSteps = 8;
  const Vector2d along = b - a;
  const double angle = along.norm() > 1e-9 ? std::atan2(along.y(), along.x()) : 0.0;
  std::vector<Vector2d> outline;
  for (int end = 0; end < 2; ++end) {
    for (int k = 0; k <= kSteps; ++k) {
      const double turn = angle - 0.5 * kPi + kPi * (end + static_cast<double>(k) / kSteps);
      outline.push_back((end == 0 ? b : a) + radius * Vector2d(std::cos(turn), std::sin(turn)));
    }
  }
  return outline;
}

void AddBoneLines(const Motion& motion, int frame, const Eye& eye, SeenFigure& figure) {
  const std::vector<int> sides = SidesOf(*motion.skeleton);
  const Vector3d root = motion.joints.at(frame, 0);
  for (int j = 1; j < motion.joint_count(); ++j) {
    const Vector3d a = eye.See(motion.joints.at(frame, motion.skeleton->joints[j].parent), root);
    const Vector3d b = eye.See(motion.joints.at(frame, j), root);
    figure.parts.push_back({0.5 * (a.z() + b.z()), {}, {a.head<2>(), b.head<2>()}, ColourOfSide(sides[j])});
  }
}

void AddCapsules(const Clip& clip, int frame, const Eye& eye, SeenFigure& figure) {
  const PosedBody body = BodyOf(clip, frame);
  const Vector3d root = clip.motion->joints.at(frame, 0);
  for (std::size_t c = 0; c < body.capsules.capsules.size(); ++c) {
    const Capsule& capsule = body.capsules.capsules[c];
    const Vector3d a = eye.See(body.points[static_cast<std::size_t>(capsule.parent)], root);
    const Vector3d b = eye.See(body.points[static_cast<std::size_t>(capsule.joint)], root);
    const double depth = 0.5 * (a.z() + b.z());
    figure.parts.push_back({depth,
                            HullOfDiscs(a.head<2>(), b.head<2>(), capsule.radius),
                            {},
                            Shaded(ColourOfSide(body.sides[c]), 1.0 + 0.5 * std::clamp(depth, -0.4, 0.4))});
  }
}

void AddSkin(const Skin& skin, const Motion& motion, int frame, const Eye& eye, SeenFigure& figure) {
  const std::vector<Vector3d> vertices =
      PosedVertices(skin, *motion.skeleton, &motion.rotation_at(frame, 0), motion.root_translation[frame]);
  const Vector3d root = motion.joints.at(frame, 0);
  const Vector3d light = Vector3d(0.3, 0.5, 0.8).normalized();
  for (const std::array<int, 3>& face : skin.faces) {
    Vector3d corners[3];
    for (std::size_t k = 0; k < 3; ++k) corners[k] = eye.See(vertices[static_cast<std::size_t>(face[k])], root);
    const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!(normal.z() > 0.0)) continue;  // the back
    const double lit = 0.62 + 0.38 * std::max(0.0, normal.normalized().dot(light));
    figure.parts.push_back({(corners[0].z() + corners[1].z() + corners[2].z()) / 3.0,
                            {corners[0].head<2>(), corners[1].head<2>(), corners[2].head<2>()},
                            {},
                            Shaded({176, 190, 210}, lit)});
  }
}

SeenFigure FigureOf(const MotionRow& row, int frame, const Eye& eye, FigureChoice choice) {
  SeenFigure figure;
  const Motion& motion = *row.clip.motion;
  if (choice == FigureChoice::kSkin && row.skin) {
    AddSkin(*row.skin, motion, frame, eye, figure);
  } else if (choice == FigureChoice::kBones) {
    AddBoneLines(motion, frame, eye, figure);
  } else {
    AddCapsules(row.clip, frame, eye, figure);
  }
  std::stable_sort(figure.parts.begin(), figure.parts.end(),
                   [](const SeenFigure::Part& a, const SeenFigure::Part& b) { return a.depth < b.depth; });
  figure.low = figure.left = 1e9;
  figure.high = figure.right = -1e9;
  for (const SeenFigure::Part& part : figure.parts) {
    for (const std::vector<Vector2d>* points : {&part.outline, &part.line}) {
      for (const Vector2d& point : *points) {
        figure.left = std::min(figure.left, point.x());
        figure.right = std::max(figure.right, point.x());
        figure.low = std::min(figure.low, point.y());
        figure.high = std::max(figure.high, point.y());
      }
    }
  }
  return figure;
}

/// The figure with its root at `x` and its row's lowest point at `floor`.
void Place(const SeenFigure& figure, double x, double floor, double low, double scale, std::vector<Shape>& shapes) {
  const auto placed = [&](const std::vector<Vector2d>& points) {
    std::vector<Vector2d> pixels;
    for (const Vector2d& point : points) pixels.emplace_back(x + scale * point.x(), floor - scale * (point.y() - low));
    return pixels;
  };
  for (const SeenFigure::Part& part : figure.parts) {
    if (!part.outline.empty()) shapes.emplace_back(PolygonShape{placed(part.outline), part.colour});
    if (!part.line.empty()) shapes.emplace_back(LineShape{placed(part.line), 2.0, part.colour});
  }
}

void Write(double x, double y, std::string text, double size, TextAnchor anchor, const Colour& colour, bool bold,
           std::vector<Shape>& shapes) {
  shapes.emplace_back(TextShape{Vector2d(x, y), std::move(text), size, anchor, colour, bold});
}

/// Approximate number of characters that fit a width.
std::string Shortened(const std::string& text, double width, double size) {
  auto most = static_cast<std::size_t>(std::max(1.0, width / (0.56 * size)));
  if (text.size() <= most) return text;
  --most;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0) == 0x80) --most;  // within a character of UTF-8
  return text.substr(0, most) + ".";
}

/// A row's figures and their extent.
struct SeenRow {
  std::vector<int> frames;
  std::vector<SeenFigure> figures;
  double low = 1e9, high = -1e9;
};

/// The root's path on the floor, metres: x to the right, y towards the viewer, in the row's view.
std::vector<Vector2d> PathOf(const Motion& motion, const Eye& eye) {
  std::vector<Vector2d> path;
  const Vector3d start = motion.joints.at(0, 0);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const Vector3d seen = eye.See(motion.joints.at(f, 0), start);
    path.emplace_back(seen.x(), seen.z());
  }
  return path;
}

Eigen::AlignedBox2d BoxOf(const std::vector<Vector2d>& path) {
  Eigen::AlignedBox2d box;
  for (const Vector2d& point : path) box.extend(point);
  return box;
}

class RowsDrawing {
 public:
  RowsDrawing(const std::vector<MotionRow>& rows, const MotionPictureOptions& options)
      : rows_(rows), options_(options) {
    double tallest = 0.5, widest = 0.3;
    for (const MotionRow& row : rows) {
      const Motion& motion = *row.clip.motion;
      const Eye eye(motion);
      SeenRow seen;
      seen.frames = StillFrames(motion.frame_count(), static_cast<int>(options.stills));
      for (const int frame : seen.frames) {
        seen.figures.push_back(FigureOf(row, frame, eye, options.figure));
        seen.low = std::min(seen.low, seen.figures.back().low);
        seen.high = std::max(seen.high, seen.figures.back().high);
        widest = std::max(widest, seen.figures.back().right - seen.figures.back().left);
      }
      tallest = std::max(tallest, seen.high - seen.low);
      paths_.push_back(PathOf(motion, eye));
      path_span_ = std::max(path_span_, BoxOf(paths_.back()).sizes().maxCoeff());
      seen_.push_back(std::move(seen));
    }
    scale_ = kFigure / tallest;
    cell_ = std::clamp(widest * scale_ * 0.8, kLeastCell, kMostCell);
  }

  Drawing Draw() {
    drawing_.title = options_.title.empty() ? "Motions in rows of equally spaced frames" : options_.title;
    const double figures = cell_ * static_cast<double>(options_.stills);
    drawing_.width = kNames + figures + kPath + 2.0 * kSpace;
    double y = kSpace;
    if (!options_.title.empty()) {
      const double fits = (drawing_.width - 2.0 * kSpace) / (0.62 * static_cast<double>(options_.title.size()));
      Write(kSpace, y + 14.0, options_.title, std::min(14.0, fits), TextAnchor::kStart, kInkColour, true,
            drawing_.shapes);
      y += kHead;
    }
    for (std::size_t r = 0; r < rows_.size(); ++r) y = DrawRow(r, y) + kSpace;
    Write(drawing_.width - kSpace, y + 4.0, "paths from above, boxes " + RoundedText(path_span_, 2) + " m wide", 9.0,
          TextAnchor::kEnd, kQuietColour, false, drawing_.shapes);
    drawing_.height = y + 12.0;
    return std::move(drawing_);
  }

 private:
  double DrawRow(std::size_t r, double top) {
    const MotionRow& row = rows_[r];
    const SeenRow& seen = seen_[r];
    const double height = scale_ * (seen.high - seen.low), floor = top + std::max(height, 40.0);
    std::vector<Shape>& shapes = drawing_.shapes;
    if (r == 0 || rows_[r - 1].method != row.method || rows_[r - 1].label != row.label) {
      Write(kSpace, top + 14.0, Shortened(row.method, kNames - kSpace, 12.0), 12.0, TextAnchor::kStart, kInkColour,
            true, shapes);
      Write(kSpace, top + 29.0, Shortened(row.label, kNames - kSpace, 11.0), 11.0, TextAnchor::kStart, kInkColour,
            false, shapes);
    }
    shapes.emplace_back(
        LineShape{{{kNames, floor}, {kNames + cell_ * double(options_.stills), floor}}, 0.8, kFaintColour});
    const Motion& motion = *row.clip.motion;
    const double step = static_cast<double>(options_.stills) / static_cast<double>(seen.frames.size());
    for (std::size_t i = 0; i < seen.frames.size(); ++i) {
      const double x = kNames + cell_ * step * (static_cast<double>(i) + 0.5);
      Place(seen.figures[i], x, floor, seen.low, scale_, shapes);
      Write(x, floor + 11.0, FixedText(motion.rate.FrameTime(seen.frames[i]), 2), 8.5, TextAnchor::kMiddle,
            kQuietColour, false, shapes);
    }
    DrawPath(paths_[r], top, shapes);
    const double bottom = std::max(floor + kTimes, top + kPath + 4.0);
    return row.clip.segments.empty() ? bottom : std::max(bottom, DrawBrackets(row.clip, floor + kTimes) + 2.0);
  }

  double DrawBrackets(const Clip& clip, double top) {
    const Motion& motion = *clip.motion;
    const double last = std::max(1e-9, motion.rate.FrameTime(motion.frame_count() - 1));
    const auto count = static_cast<double>(std::min<std::int64_t>(options_.stills, motion.frame_count()));
    const auto x_of = [&](double seconds) {  // from the first figure to the last
      const double place = std::clamp(seconds / last, 0.0, 1.0) * (count - 1.0) + 0.5;
      return kNames + cell_ * place * static_cast<double>(options_.stills) / count;
    };
    std::vector<Shape>& shapes = drawing_.shapes;
    for (const Segment& segment : clip.segments) {
      const bool transition = segment.label == kTransition;
      const Colour& colour = transition ? kQuietColour : kInkColour;
      const double begin = x_of(segment.begin_s) + 1.5, end = std::max(begin + 1.0, x_of(segment.end_s) - 1.5);
      shapes.emplace_back(
          LineShape{{{begin, top}, {begin, top + 5.0}, {end, top + 5.0}, {end, top}}, 1.2, colour, transition});
      Write(0.5 * (begin + end), top + 16.0, Shortened(segment.label, end - begin + 10.0, 9.0), 9.0,
            TextAnchor::kMiddle, colour, false, shapes);
    }
    return top + kBracket;
  }

  void DrawPath(const std::vector<Vector2d>& path, double top, std::vector<Shape>& shapes) const {
    const double left = drawing_.width - kSpace - kPath, scale = (kPath - 8.0) / std::max(path_span_, 1e-6);
    shapes.emplace_back(
        LineShape{{{left, top}, {left + kPath, top}, {left + kPath, top + kPath}, {left, top + kPath}, {left, top}},
                  0.6,
                  kFaintColour});
    const Vector2d middle = BoxOf(path).center();
    std::vector<Vector2d> pixels;
    for (const Vector2d& point : path) {
      pixels.emplace_back(left + 0.5 * kPath + scale * (point.x() - middle.x()),
                          top + 0.5 * kPath + scale * (point.y() - middle.y()));
    }
    shapes.emplace_back(PolygonShape{HullOfDiscs(pixels.front(), pixels.front(), 2.5), kBlue});
    shapes.emplace_back(LineShape{std::move(pixels), 1.3, kInkColour});
  }

  const std::vector<MotionRow>& rows_;
  const MotionPictureOptions& options_;
  std::vector<SeenRow> seen_;
  std::vector<std::vector<Vector2d>> paths_;
  double path_span_ = 0.5;
  double scale_ = 1.0;
  double cell_ = 60.0;
  Drawing drawing_;
};

}  // namespace

Drawing DrawMotionRows(const std::vector<MotionRow>& rows, const MotionPictureOptions& options) {
  return RowsDrawing(rows, options).Draw();
}

Drawing DrawMotionGrid(const std::vector<MotionRow>& rows, const MotionPictureOptions& options, double seconds) {
  constexpr double kCell = 170.0, kText = 34.0;
  const auto columns = static_cast<std::size_t>(std::min(6.0, std::ceil(std::sqrt(double(rows.size()) * 1.6))));
  Drawing drawing;
  drawing.title = options.title;
  drawing.width = kCell * static_cast<double>(columns);
  drawing.height = (kCell + kText) * std::ceil(double(rows.size()) / static_cast<double>(columns));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const MotionRow& row = rows[r];
    const Motion& motion = *row.clip.motion;
    const Eye eye(motion);
    const int frame =
        std::clamp(static_cast<int>(std::lround(seconds * motion.rate.hz())), 0, motion.frame_count() - 1);
    double low = 1e9, high = -1e9;
    for (int f = 0; f < motion.frame_count(); ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) {
        low = std::min(low, motion.joints.at(f, j).y());
        high = std::max(high, motion.joints.at(f, j).y());
      }
    }
    const double left = kCell * static_cast<double>(r % columns);
    const double top = (kCell + kText) * std::floor(double(r) / static_cast<double>(columns));
    const double scale = (kCell - 24.0) / std::max(1.9, high - low + 0.2);
    const SeenFigure figure = FigureOf(row, frame, eye, options.figure);
    drawing.shapes.emplace_back(
        LineShape{{{left + 12.0, top + kCell - 6.0}, {left + kCell - 12.0, top + kCell - 6.0}}, 0.8, kFaintColour});
    Place(figure, left + 0.5 * kCell, top + kCell - 6.0, low, scale, drawing.shapes);
    std::string label = row.label;
    for (const Segment& segment : row.clip.segments) {
      if (seconds >= segment.begin_s && seconds < segment.end_s) label = segment.label;
    }
    Write(left + 0.5 * kCell, top + kCell + 10.0, Shortened(row.method, kCell, 11.0), 11.0, TextAnchor::kMiddle,
          kInkColour, true, drawing.shapes);
    Write(left + 0.5 * kCell, top + kCell + 24.0, Shortened(label, kCell, 11.0), 11.0, TextAnchor::kMiddle,
          label == kTransition ? kQuietColour : kInkColour, false, drawing.shapes);
  }
  return drawing;
}

}  // namespace mocurate
