#include "report/motion_rows.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/posed_body.h"

namespace mocurate {
namespace {

// Pixels.
constexpr double kNames = 170.0;     // to the left of the figures
constexpr double kPath = 108.0;      // square of the root's path
constexpr double kFigure = 110.0;    // height that the tallest figure takes
constexpr double kSpace = 10.0;      // between rows
constexpr double kLeastCell = 34.0;  // width of a figure
constexpr double kMostCell = 200.0;
constexpr double kScene = 320.0;  // square panel of a scene
constexpr double kSmall = 10.5;   // of texts below figures

constexpr const char* kTransition = "transition";
constexpr const char* kRecorded = "recorded";  // origin of a segment that is not generated

const Colour& ColourOfSide(int side) { return side > 0 ? kLeftColour : side < 0 ? kRightColour : kGrey; }

Colour Shaded(const Colour& colour, double light) {
  const auto lit = [&](std::uint8_t value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(light * value, 0.0, 255.0)));
  };
  return {lit(colour.red), lit(colour.green), lit(colour.blue)};
}

/// A figure in a frame, metres: x to the right, y up, z towards the viewer.
struct SeenFigure {
  struct Part {
    double depth = 0.0;  ///< the farther from the eye, the less
    std::vector<Vector2d> outline, line;
    Colour colour{};
    double width = 2.0;  ///< of the line, pixels
  };
  std::vector<Part> parts;  ///< the farthest first
  Eigen::AlignedBox2d box;
};

/// A view in which places are seen from `origin`. `only`: one colour instead of those of the sides.
struct Eye {
  Viewpoint view;
  Vector3d origin = Vector3d::Zero();
  const Colour* only = nullptr;

  Vector3d See(const Vector3d& point) const { return view.Turn(point - origin); }
  Colour Of(int side) const { return only != nullptr ? *only : ColourOfSide(side); }
};

/// Where the options look from, turned with the person.
Viewpoint ViewOf(const Motion& motion, const MotionPictureOptions& options) {
  return {options.azimuth + FrontYaw(motion), options.elevation};
}

/// Places are seen from below the root of a frame; level with the horizon heights are preserved.
Eye EyeBelow(const Motion& motion, int frame, const Viewpoint& view) {
  const Vector3d root = motion.joints.at(frame, 0);
  return {view, {root.x(), 0.0, root.z()}};
}

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
  for (int j = 1; j < motion.joint_count(); ++j) {
    const Vector3d a = eye.See(motion.joints.at(frame, motion.skeleton->joints[j].parent));
    const Vector3d b = eye.See(motion.joints.at(frame, j));
    figure.parts.push_back({0.5 * (a.z() + b.z()), {}, {a.head<2>(), b.head<2>()}, eye.Of(sides[j])});
  }
}

void AddCapsules(const Clip& clip, int frame, const Eye& eye, SeenFigure& figure) {
  const PosedBody body = BodyOf(clip, frame);
  for (std::size_t c = 0; c < body.capsules.capsules.size(); ++c) {
    const Capsule& capsule = body.capsules.capsules[c];
    const Vector3d a = eye.See(body.points[static_cast<std::size_t>(capsule.parent)]);
    const Vector3d b = eye.See(body.points[static_cast<std::size_t>(capsule.joint)]);
    const double depth = 0.5 * (a.z() + b.z()), nearer = depth - eye.See(clip.motion->joints.at(frame, 0)).z();
    figure.parts.push_back({depth,
                            HullOfDiscs(a.head<2>(), b.head<2>(), capsule.radius),
                            {},
                            Shaded(eye.Of(body.sides[c]), 1.0 + 0.5 * std::clamp(nearer, -0.4, 0.4))});
  }
}

void AddSkin(const Skin& skin, const Motion& motion, int frame, const Eye& eye, SeenFigure& figure) {
  const std::vector<Vector3d> vertices =
      PosedVertices(skin, *motion.skeleton, &motion.rotation_at(frame, 0), motion.root_translation[frame]);
  const Vector3d light = Vector3d(0.3, 0.5, 0.8).normalized();
  for (const std::array<int, 3>& face : skin.faces) {
    Vector3d corners[3];
    for (std::size_t k = 0; k < 3; ++k) corners[k] = eye.See(vertices[static_cast<std::size_t>(face[k])]);
    const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!(normal.z() > 0.0)) continue;  // the back
    const double lit = 0.62 + 0.38 * std::max(0.0, normal.normalized().dot(light));
    figure.parts.push_back({(corners[0].z() + corners[1].z() + corners[2].z()) / 3.0,
                            {corners[0].head<2>(), corners[1].head<2>(), corners[2].head<2>()},
                            {},
                            Shaded(eye.only != nullptr ? *eye.only : Colour{176, 190, 210}, lit)});
  }
}

/// Observed points, and lines between them, behind the figure.
void AddTracks(const JointTracks& tracks, const Skeleton& skeleton, int frame, const Eye& eye, SeenFigure& figure) {
  const auto seen = [&](int point) { return eye.See(tracks.positions.at(frame, point)); };
  for (const auto& [a, b] : MatchTracks(tracks.names, skeleton).lines) {
    if (!Observes(tracks, frame, a) || !Observes(tracks, frame, b)) continue;
    figure.parts.push_back({-1e3, {}, {seen(a).head<2>(), seen(b).head<2>()}, kBeforeColour, 1.2});
  }
  for (int k = 0; k < tracks.positions.joints; ++k) {
    if (!Observes(tracks, frame, k)) continue;
    const Vector2d at = seen(k).head<2>();
    figure.parts.push_back({1e3, {}, {at, at}, kInkColour, 4.0});
  }
}

void Order(SeenFigure& figure) {
  std::stable_sort(figure.parts.begin(), figure.parts.end(),
                   [](const SeenFigure::Part& a, const SeenFigure::Part& b) { return a.depth < b.depth; });
}

void Measure(SeenFigure& figure) {
  for (const SeenFigure::Part& part : figure.parts) {
    for (const std::vector<Vector2d>* points : {&part.outline, &part.line}) {
      for (const Vector2d& point : *points) figure.box.extend(point);
    }
  }
}

/// Observed points, which may be far off, do not count for its extent.
SeenFigure FigureOf(const MotionRow& row, const Clip& clip, int frame, const Eye& eye, FigureChoice choice) {
  SeenFigure figure;
  if (choice == FigureChoice::kSkin && row.skin) {
    AddSkin(*row.skin, *clip.motion, frame, eye, figure);
  } else if (choice == FigureChoice::kBones) {
    AddBoneLines(*clip.motion, frame, eye, figure);
  } else {
    AddCapsules(clip, frame, eye, figure);
  }
  Measure(figure);
  if (!row.bones) figure.parts.clear();
  if (row.tracks != nullptr) AddTracks(*row.tracks, *clip.motion->skeleton, frame, eye, figure);
  Order(figure);
  return figure;
}

/// Draws a figure with its origin at `at`.
void Place(const SeenFigure& figure, const Vector2d& at, double scale, Drawing& drawing) {
  const auto placed = [&](const std::vector<Vector2d>& points) {
    std::vector<Vector2d> pixels;
    for (const Vector2d& point : points) pixels.emplace_back(at.x() + scale * point.x(), at.y() - scale * point.y());
    return pixels;
  };
  for (const SeenFigure::Part& part : figure.parts) {
    if (!part.outline.empty()) drawing.shapes.emplace_back(PolygonShape{placed(part.outline), part.colour});
    if (!part.line.empty()) drawing.Line(placed(part.line), part.width, part.colour);
  }
}

std::string WordOf(const std::string& label, const MotionPictureOptions& options) {
  const auto found = options.words.find(label);
  std::string word = found == options.words.end() ? label : found->second;
  std::replace(word.begin(), word.end(), '_', ' ');
  return word;
}

/// Frames of each motion of a row, in proportion to their lengths.
std::vector<std::vector<int>> FramesOf(const MotionRow& row, std::int64_t stills) {
  double all = 0.0;
  for (const Clip& clip : row.clips) all += clip.motion->frame_count();
  std::vector<std::vector<int>> frames;
  for (const Clip& clip : row.clips) {
    const double share = static_cast<double>(stills) * clip.motion->frame_count() / all;
    frames.push_back(StillFrames(clip.motion->frame_count(), std::max(1, static_cast<int>(std::lround(share)))));
  }
  return frames;
}

/// Extent of the first `joints` joints in the frames [begin, end), metres; the root is the first.
Eigen::AlignedBox3d BoxOf(const Motion& motion, int joints, int begin, int end) {
  Eigen::AlignedBox3d box;
  for (int f = begin; f < end; ++f) {
    for (int j = 0; j < joints; ++j) box.extend(Vector3d(motion.joints.at(f, j)));
  }
  return box;
}
Eigen::AlignedBox3d PathOf(const Motion& motion) { return BoxOf(motion, 1, 0, motion.frame_count()); }

class RowsDrawing {
 public:
  /// `strip`: large figures without names.
  RowsDrawing(const std::vector<MotionRow>& rows, const MotionPictureOptions& options, bool strip = false)
      : rows_(rows), options_(options), names_(strip ? 0.0 : kNames) {
    double tallest = 0.5, widest = 0.3;
    Viewpoint world;  // of the first motion
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
      if (!row->clips.empty()) world = ViewOf(*row->clips.front().motion, options);
    }
    for (const MotionRow& row : rows) {
      const std::vector<std::vector<int>> frames = FramesOf(row, options.stills);
      SeenRow seen;
      for (std::size_t c = 0; c < row.clips.size(); ++c) {
        const Motion& motion = *row.clips[c].motion;
        const Viewpoint view = options.world ? world : ViewOf(motion, options);
        for (const int frame : frames[c]) {
          Eye eye = EyeBelow(motion, frame, view);
          eye.only = row.colour ? &*row.colour : nullptr;
          seen.stills.push_back({c, frame, FigureOf(row, row.clips[c], frame, eye, options.figure)});
          seen.box.extend(seen.stills.back().figure.box);
          widest = std::max(widest, seen.stills.back().figure.box.sizes().x());
        }
      }
      if (!row.clips.empty()) tallest = std::max(tallest, seen.box.sizes().y());
      if (options.path && row.clips.size() == 1)
        path_span_ = std::max(path_span_, PathOf(*row.clips.front().motion).sizes().maxCoeff());
      seen_.push_back(std::move(seen));
    }
    scale_ = (strip ? 1.5 : 1.0) * kFigure / tallest;
    cell_ = std::clamp(widest * scale_ * (strip ? 1.1 : 0.8), kLeastCell, kMostCell);
    column_width_ = names_ + cell_ * static_cast<double>(options.stills) + (options.path ? kPath : 0.0) + 2.0 * kSpace;
  }

  Drawing Draw() {
    std::vector<std::string> heads;
    for (const MotionRow& row : rows_) {
      if (std::find(heads.begin(), heads.end(), row.column) == heads.end()) heads.push_back(row.column);
    }
    drawing_ = {column_width_ * static_cast<double>(heads.size()), 0.0, options_.title};
    const double inner = drawing_.width - 2.0 * kSpace;
    const double top = drawing_.Head();
    double bottom = top;
    for (std::size_t column = 0; column < heads.size(); ++column) {
      left_ = column_width_ * static_cast<double>(column);
      double y = drawing_.Block(left_ + names_, top + kSpace, inner, heads[column], 13.0, TextAnchor::kStart,
                                kInkColour, true);
      for (std::size_t r = 0; r < rows_.size(); ++r) {
        if (rows_[r].column == heads[column]) y = DrawRow(r, y) + kSpace;
      }
      bottom = std::max(bottom, y);
    }
    drawing_.Finish(bottom, Legend(), options_.corner);
    return std::move(drawing_);
  }

 private:
  struct Still {
    std::size_t clip;
    int frame;
    SeenFigure figure;
  };
  struct SeenRow {
    std::vector<Still> stills;
    Eigen::AlignedBox2d box;
  };

  static const Colour& PartColour(const MotionRow& row, const Segment& segment) {
    const bool transition = segment.label == kTransition;
    if (row.colour) return kQuietColour;
    if (!row.theme.empty()) return transition ? kQuietColour : kOrange;
    return transition ? kBlue : segment.origin == kRecorded ? kGreen : kRed;
  }

  /// What the colours of brackets mean, and the path.
  std::string Legend() const {
    bool previous = false, parts = false, themes = false;
    for (const MotionRow& row : rows_) {
      themes = themes || !row.theme.empty();
      for (const Clip& clip : row.clips) {
        for (const Segment& segment : clip.segments) {
          const Colour* colour = &PartColour(row, segment);
          previous = previous || colour == &kGreen;
          parts = parts || colour == &kRed;
        }
      }
    }
    std::string legend = themes ? "Green: theme, blue: its labels, orange: the label of each frame, grey: transition. "
                         : previous ? "Green: previous motion, blue: transition, red: action. "
                         : parts    ? "Blue: transition, red: action. "
                                    : "";
    if (path_span_ > 0.0) {
      legend += "Right: the root's path, its shadow on the floor, in squares of " + RoundedText(path_span_, 2) + " m.";
    }
    return legend;
  }

  /// Name, theme and label; returns where they end.
  double DrawNames(std::size_t r, double top) {
    const MotionRow& row = rows_[r];
    const bool repeats = r > 0 && rows_[r - 1].method == row.method && rows_[r - 1].label == row.label;
    if (repeats && row.theme.empty()) return top;
    std::string labels = WordOf(row.label, options_);
    for (const Clip& clip : row.clips) {
      for (const Segment& segment : clip.segments) {
        if (row.theme.empty() || segment.label == kTransition) continue;
        labels += (labels.empty() ? "" : ", ") + WordOf(segment.label, options_);
      }
    }
    const auto write = [&](const std::string& text, double size, const Colour& colour, bool bold) {
      const double width = names_ - 2.0 * kSpace;
      top = drawing_.Block(left_ + kSpace, top, width, text, size, TextAnchor::kStart, colour, bold);
    };
    write(row.method, 12.0, row.colour.value_or(kInkColour), true);
    write(row.theme, 12.0, kGreen, false);
    write(labels, 11.0, row.theme.empty() ? kInkColour : kBlue, false);
    return top;
  }

  double DrawRow(std::size_t r, double top) {
    const MotionRow& row = rows_[r];
    const SeenRow& seen = seen_[r];
    const double names = DrawNames(r, top), left = left_ + names_;
    if (row.clips.empty()) {
      return std::max(names, drawing_.Block(left, top, column_width_ - names_ - 2.0 * kSpace, row.why, 12.0) + 6.0);
    }
    const double width = cell_ * static_cast<double>(options_.stills);
    const double ground = options_.world ? seen.stills.front().figure.box.min().y() : seen.box.min().y();
    const double zero = top + std::max(40.0, scale_ * seen.box.sizes().y()) + scale_ * seen.box.min().y();
    const double floor = zero - scale_ * ground, below = zero - scale_ * seen.box.min().y();
    drawing_.Line({{left, floor}, {left + width, floor}}, 0.8, kFaintColour);
    const double step = width / static_cast<double>(seen.stills.size());
    for (std::size_t i = 0; i < seen.stills.size(); ++i) {
      const Still& still = seen.stills[i];
      const double x = left + step * (static_cast<double>(i) + 0.5);
      Place(still.figure, {x, zero}, scale_, drawing_);
      drawing_.Text(x, below + 12.0, FixedText(row.clips[still.clip].motion->rate.FrameTime(still.frame), 2), kSmall,
                    TextAnchor::kMiddle, kQuietColour);
    }
    double bottom = below + 14.0;
    for (std::size_t c = 0, first = 0; c < row.clips.size(); ++c) {
      std::size_t count = 0;
      while (first + count < seen.stills.size() && seen.stills[first + count].clip == c) ++count;
      const double begin = left + step * static_cast<double>(first), end = begin + step * static_cast<double>(count);
      if (row.clips.size() > 1 && row.clips[c].segments.empty()) {
        bottom = std::max(
            bottom, Bracket(begin + 4.0, end - 4.0, below + 16.0, 0.0, WordOf(row.clips[c].label, options_), kRed));
      }
      bottom = std::max(bottom, DrawSegments(r, row.clips[c], begin, step, static_cast<double>(count), below + 16.0));
      first += count;
    }
    if (options_.path && row.clips.size() == 1)
      bottom = std::max(bottom, DrawPath(*row.clips.front().motion, left + width, top));
    return std::max(bottom, names);
  }

  /// A bracket with its text below, which may reach `more` pixels beyond it at either end; returns where it ends.
  double Bracket(double begin, double end, double top, double more, const std::string& label, const Colour& colour) {
    end = std::max(end, begin + 1.0);
    drawing_.Line({{begin, top}, {begin, top + 5.0}, {end, top + 5.0}, {end, top}}, 1.4, colour);
    return drawing_.Block(0.5 * (begin + end), top + 4.0, end - begin + 2.0 * more, label, kSmall, TextAnchor::kMiddle,
                          colour) +
           2.0;
  }

  double DrawSegments(std::size_t r, const Clip& clip, double left, double step, double count, double top) {
    const double last = std::max(1e-9, clip.motion->rate.FrameTime(clip.motion->frame_count() - 1));
    const auto x_of = [&](double seconds) {  // from the first figure to the last
      return left + step * (std::clamp(seconds / last, 0.0, 1.0) * (count - 1.0) + 0.5);
    };
    double bottom = top;
    for (std::size_t i = 0; i < clip.segments.size(); ++i) {
      const Segment& segment = clip.segments[i];
      const bool transition = segment.label == kTransition;
      const Colour& colour = PartColour(rows_[r], segment);
      double more = 2.0;  // transitions have no text
      if (i + 1 < clip.segments.size() && clip.segments[i + 1].label == kTransition) {
        more = 0.5 * (x_of(clip.segments[i + 1].end_s) - x_of(clip.segments[i + 1].begin_s));
      }
      const std::string text = transition ? "" : WordOf(segment.label, options_);
      bottom =
          std::max(bottom, Bracket(x_of(segment.begin_s) + 1.5, x_of(segment.end_s) - 1.5, top, more, text, colour));
    }
    return bottom;
  }

  /// The root's path in perspective with its shadow on the floor, and its extent in words.
  double DrawPath(const Motion& motion, double left, double top) {
    Eye eye{ViewOf(motion, options_)};
    eye.view.pitch = 0.55;
    const Eigen::AlignedBox3d box = PathOf(motion);
    const double half = 0.5 * std::max(path_span_, 1e-6), scale = 0.36 * kPath / half / std::sqrt(2.0);
    const double low = box.min().y();
    eye.origin = Vector3d(box.center().x(), low, box.center().z());
    const Vector2d middle(left + kSpace + 0.5 * kPath, top + 0.72 * kPath);
    const auto place = [&](const Vector3d& point) {
      const Vector3d seen = eye.See(point);
      return Vector2d(middle.x() + scale * seen.x(), middle.y() - scale * seen.y());
    };
    std::vector<Vector2d> square, path, shadow;
    for (const auto& [x, z] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}) {
      square.push_back(place(eye.origin + half * Vector3d(x, 0.0, z)));
    }
    for (int f = 0; f < motion.frame_count(); ++f) {
      const Vector3d root = motion.joints.at(f, 0);
      path.push_back(place(root));
      shadow.push_back(place({root.x(), low, root.z()}));
    }
    drawing_.Line(square, 0.7, kFaintColour);
    drawing_.Line(shadow, 1.2, kQuietColour, true);
    drawing_.Line(path, 1.8, kAfterColour);
    drawing_.Dot(path.back(), 5.0, kRightColour);
    double y = top + kPath + 6.0;
    const Vector3d span = box.sizes();
    for (int axis = 0; axis < 3; ++axis) {
      const std::string text = std::string(1, "xyz"[axis]) + " " + FixedText(span[axis], 2) + (axis == 2 ? " m" : "");
      drawing_.Text(left + kSpace + 35.0 * axis, y, text, 8.5, TextAnchor::kStart, kQuietColour);
    }
    return y + 4.0;
  }

  const std::vector<MotionRow>& rows_;
  const MotionPictureOptions& options_;
  const double names_;  ///< width of the names
  std::vector<SeenRow> seen_;
  double path_span_ = 0.0, scale_ = 1.0, cell_ = kLeastCell, column_width_ = 0.0, left_ = 0.0;
  Drawing drawing_;
};

/// A motion in its world, in a square panel: earlier frames light, the last one dark, over the floor.
void DrawScene(const MotionRow& row, double floor, double left, double top, const MotionPictureOptions& options,
               Drawing& drawing) {
  const Clip& clip = row.clips.front();
  const Motion& motion = *clip.motion;
  const Colour own = row.colour.value_or(kGrey);
  Eye eye{{1.1, 0.25}};
  SeenFigure all;
  Eigen::AlignedBox3d ground(Vector3d::Zero());
  const std::vector<int> frames = StillFrames(motion.frame_count(), static_cast<int>(options.stills));
  for (const int frame : frames) {
    const Colour colour = frame == frames.back() ? own : Lightened(own, 0.7);
    eye.only = &colour;
    SeenFigure figure = FigureOf(row, clip, frame, eye, options.figure);
    const double nearer = frame == frames.back() ? 1e3 : 0.0;  // the last frame is over the others
    for (SeenFigure::Part& part : figure.parts) part.depth += nearer;
    all.parts.insert(all.parts.end(), figure.parts.begin(), figure.parts.end());
    ground.extend(BoxOf(motion, motion.joint_count(), frame, frame + 1));
  }
  const auto line = [&](double x, double z, double to_x, double to_z, const Colour& colour, double depth) {
    const Vector2d from = eye.See({x, floor, z}).head<2>(), to = eye.See({to_x, floor, to_z}).head<2>();
    all.parts.push_back({depth, {}, {from, to}, colour, depth < -1.5e3 ? 0.8 : 2.0});
  };
  const Vector3d low = (2.0 * ground.min()).array().floor() / 2.0, high = (2.0 * ground.max()).array().ceil() / 2.0;
  for (double x = low.x(); x <= high.x() + 1e-9; x += 0.5) line(x, low.z(), x, high.z(), kFaintColour, -2e3);
  for (double z = low.z(); z <= high.z() + 1e-9; z += 0.5) line(low.x(), z, high.x(), z, kFaintColour, -2e3);
  line(0.0, 0.0, 0.4, 0.0, kRed, -1e3);
  line(0.0, 0.0, 0.0, 0.4, kInkColour, -1e3);
  Order(all);
  Measure(all);
  const double scale = (kScene - 4.0 * kSpace) / std::max(all.box.sizes().maxCoeff(), 1e-6);
  const Vector2d centre = all.box.center();
  drawing.Text(left + kSpace, top, row.method, 12.0, TextAnchor::kStart, own, true);
  Place(all, {left + 0.5 * kScene - scale * centre.x(), top + 0.5 * kScene + scale * centre.y()}, scale, drawing);
}

/// Scenes side by side, below the label that they share; motions of a label whose last roots are equally high share
/// the first one's floor: its lowest joint in the last frame.
Drawing DrawScenes(const std::vector<MotionRow>& rows, const MotionPictureOptions& options) {
  constexpr double kHeads = 34.0;
  Drawing drawing{kScene * static_cast<double>(rows.size()), 0.0, options.title};
  const double top = drawing.Head();
  const Motion* shared = nullptr;  // the first one of the label
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double left = kScene * static_cast<double>(r);
    if (rows[r].clips.empty()) {
      drawing.Block(left + kSpace, top + kHeads, kScene - 2.0 * kSpace, rows[r].method + ": " + rows[r].why, 12.0);
      continue;
    }
    const Motion& motion = *rows[r].clips.front().motion;
    if (shared == nullptr || rows[r].label != rows[r - 1].label) {
      shared = &motion;
      drawing.Text(left + kSpace, top + 20.0, rows[r].label, 12.0, TextAnchor::kStart, kInkColour, true);
    }
    const auto lowest = [](const Motion& of) {
      return BoxOf(of, of.joint_count(), of.frame_count() - 1, of.frame_count()).min().y();
    };
    const auto root = [](const Motion& of) { return of.joints.at(of.frame_count() - 1, 0).y(); };
    const bool alike = std::abs(root(motion) - root(*shared)) < 1e-3;
    DrawScene(rows[r], lowest(alike ? *shared : motion), left, top + kHeads, options, drawing);
  }
  drawing.Finish(top + kHeads + kScene, "Dark: the last frame. Squares of 0.5 m; from the origin x is red, z black.",
                 options.corner);
  return drawing;
}

}  // namespace

Drawing DrawMotionRows(const std::vector<MotionRow>& rows, const MotionPictureOptions& options) {
  return options.scene ? DrawScenes(rows, options) : RowsDrawing(rows, options).Draw();
}

nlohmann::json DescribeRows(const std::vector<MotionRow>& rows, const MotionPictureOptions& options) {
  nlohmann::json described = nlohmann::json::array();
  for (const MotionRow& row : rows) {
    nlohmann::json clips = nlohmann::json::array(), segments = nlohmann::json::array();
    for (const Clip& clip : row.clips) {
      const Vector3d span = PathOf(*clip.motion).sizes();
      double bones = 0.0;
      for (int j = 1; j < clip.motion->joint_count(); ++j) {
        const int parent = clip.motion->skeleton->joints[static_cast<std::size_t>(j)].parent;
        bones += (clip.motion->joints.at(0, j) - clip.motion->joints.at(0, parent)).norm();
      }
      clips.push_back({{"id", clip.id()},
                       {"label", WordOf(clip.label, options)},
                       {"bones_m", bones},
                       {"path_m", {span.x(), span.y(), span.z()}}});
      for (const Segment& segment : clip.segments) {
        segments.push_back({{"label", WordOf(segment.label, options)},
                            {"origin", segment.origin},
                            {"begin_s", segment.begin_s},
                            {"end_s", segment.end_s}});
      }
    }
    const auto colour = options.colours.find(row.method);
    described.push_back({{"source", row.method},
                         {"label", row.label},
                         {"theme", row.theme},
                         {"column", row.column},
                         {"colour", colour == options.colours.end() ? "" : colour->second},
                         {"absent", row.why},
                         {"frames", FramesOf(row, options.stills)},
                         {"clips", std::move(clips)},
                         {"segments", std::move(segments)}});
  }
  return described;
}

Drawing DrawMotionGrid(const std::vector<MotionRow>& rows, const MotionPictureOptions& options, double seconds) {
  constexpr double kCell = 170.0, kText = 34.0;
  const auto columns = static_cast<std::size_t>(std::min(6.0, std::ceil(std::sqrt(double(rows.size()) * 1.6))));
  Drawing drawing{kCell * static_cast<double>(columns),
                  (kCell + kText) * std::ceil(double(rows.size()) / static_cast<double>(columns)), options.title};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].clips.empty()) continue;
    const Clip& clip = rows[r].clips.front();
    const Motion& motion = *clip.motion;
    const int frame =
        std::clamp(static_cast<int>(std::lround(seconds * motion.rate.hz())), 0, motion.frame_count() - 1);
    const Eigen::AlignedBox3d box = BoxOf(motion, motion.joint_count(), 0, motion.frame_count());
    const double left = kCell * static_cast<double>(r % columns), middle = left + 0.5 * kCell;
    const double floor = (kCell + kText) * std::floor(double(r) / static_cast<double>(columns)) + kCell - 6.0;
    const double scale = (kCell - 24.0) / std::max(1.9, box.sizes().y() + 0.2);
    drawing.Line({{left + 12.0, floor}, {left + kCell - 12.0, floor}}, 0.8, kFaintColour);
    Place(FigureOf(rows[r], clip, frame, EyeBelow(motion, frame, ViewOf(motion, options)), options.figure),
          {middle, floor + scale * box.min().y()}, scale, drawing);
    std::string label = rows[r].label.empty() ? FixedText(seconds, 2) + " s" : rows[r].label;
    for (const Segment& segment : clip.segments) {
      if (seconds >= segment.begin_s && seconds < segment.end_s) label = segment.label;
    }
    drawing.Text(middle, floor + 16.0, rows[r].method, 11.0, TextAnchor::kMiddle, kInkColour, true);
    drawing.Text(middle, floor + 30.0, label, 11.0, TextAnchor::kMiddle,
                 label == kTransition ? kQuietColour : kInkColour);
  }
  return drawing;
}

Drawing DrawFilmstrip(const Clip& clip, const JointTracks* tracks, bool bones, FigureChoice figure) {
  MotionPictureOptions options;
  options.stills = 8;
  options.path = false;
  options.figure = figure;
  MotionRow row{"", "", {clip}};
  row.clips.front().segments.clear();
  row.tracks = tracks;
  row.bones = bones;
  const std::vector<MotionRow> rows = {row};
  Drawing drawing = RowsDrawing(rows, options, true).Draw();
  drawing.title = "Figures of " + clip.id() + ", stills from " + Counted(clip.motion->frame_count(), "frame");
  return drawing;
}

}  // namespace mocurate
