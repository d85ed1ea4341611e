#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/pipeline/stage.h"
#include "core/skin/skin.h"
#include "core/store/store.h"
#include "report/drawing.h"
#include "report/options.h"

namespace mocurate {

/// A row of a picture: its source and motions, which stand one after the other.
struct MotionRow {
  std::string method;
  std::string label;
  std::vector<Clip> clips{};            ///< none: the row says `why`
  std::optional<Skin> skin{};           ///< drawn instead of bones
  std::string why{};                    ///< why the source has no motion
  std::string theme{};                  ///< above the labels of a long motion
  std::string column{};                 ///< head of its column; or empty
  std::optional<Colour> colour{};       ///< instead of those of the sides
  const JointTracks* tracks = nullptr;  ///< observed points, drawn too
  bool bones = true;                    ///< false: these alone
};

/// A set of motions with the name of its source.
struct NamedMotions {
  std::string method;
  Dataset motions;
};

/// The motions to show: of each label of the options and each set the first `samples` clips, or the named clips;
/// without either one of each class, or for sets of long motions (clips with segments) the first ones. Sources of
/// `joined` have one row of all. Errors: kNotFound for a label that no set has and for an unknown clip, kInconsistent
/// for clips without a motion and a number of themes that is not that of rows,
/// kUsage for more than `most_rows`.
Expected<std::vector<MotionRow>> ChooseMotionRows(const std::vector<NamedMotions>& sets,
                                                  const MotionPictureOptions& options);

/// The rows of the stages `draw` and `draw_video` from their inputs. Errors of reading them, and of ChooseMotionRows.
Expected<std::vector<MotionRow>> ReadRows(const StageRequest& request, const MotionPictureOptions& options);

/// Rows of equally spaced frames at one scale, each figure below its own root: name, theme and label to the left,
/// seconds below, brackets over the segments of long motions; to the right the root's path in perspective, with its
/// shadow on the floor. With `world` all rows stand over their floor; with `scene` each label is one panel.
Drawing DrawMotionRows(const std::vector<MotionRow>& rows, const MotionPictureOptions& options);

/// What DrawMotionRows shows: [{"source", "label", "theme", "column", "colour", "absent", "frames": of each clip,
/// "clips":
/// [{"id", "label", "bones_m": sum of the bones, "path_m": extent of the root's path along x, y, z}], "segments":
/// [{"label", "origin", "begin_s", "end_s"}]}].
nlohmann::json DescribeRows(const std::vector<MotionRow>& rows, const MotionPictureOptions& options);

/// All rows at one moment, side by side; a motion that has ended stays at its last frame.
Drawing DrawMotionGrid(const std::vector<MotionRow>& rows, const MotionPictureOptions& options, double seconds);

/// Figures of a clip side by side: tracked points, where there are `tracks`; the motion in colour, where `bones`. Both
/// are at the same positions.
Drawing DrawFilmstrip(const Clip& clip, const JointTracks* tracks = nullptr, bool bones = true,
                      FigureChoice figure = FigureChoice::kBones);

}  // namespace mocurate
