#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/formats/survey_files.h"

namespace mocurate {

struct ReportOptions {
  std::int64_t pages = 5;  ///< clips with a page of their own: best, worst and evenly between
  bool videos = true;      ///< one H.264 video per page
  bool clouds = false;     ///< measured points in the viewer
  bool viewer = true;      ///< a page of the viewer with all clips, and one with generated motions beside real ones
  /// Mean joint error of a clip, metres, above which its fit is suspect: 3DPCK counts such a joint as wrong (half a
  /// head; Mehta et al., 3DV 2017), and fitting/fit_outcome.cpp such a residual.
  double suspect_joint_error = 0.15;

  void Declare(OptionVisitor& v);
};

/// Options of the review page.
struct ReviewOptions {
  std::int64_t most = 200;  ///< maximum findings shown, the worst first

  void Declare(OptionVisitor& v);
};

/// Options of the annotation page.
struct AnnotateOptions {
  std::vector<std::string> labels;  ///< to choose from; empty: the dataset's classes
  std::vector<std::string> clips;   ///< ids or their ends; empty: all without a label
  bool all = false;                 ///< include clips that have a label
  double poses_bytes = 36.0e6;      ///< of all clips together: more are decimated

  void Declare(OptionVisitor& v);
};

/// Options of the survey page.
struct SurveyOptions {
  SurveyKind kind = SurveyKind::kRanking;
  std::string real = "real";        ///< source whose motions are recordings
  std::int64_t questions = 0;       ///< pages; 0: ranking: one for each label, at most 40; real_or_fake: 12
  std::int64_t clips = 6;           ///< motions of a page of real_or_fake
  std::int64_t seed = 1;            ///< of every draw
  std::vector<std::string> labels;  ///< of the questions; empty: all that every source has
  double seconds = 10.0;            ///< of each motion, maximum

  void Declare(OptionVisitor& v);
};

/// Options of a page of the viewer.
struct ViewerOptions {
  std::string title;
  std::vector<std::string> clips;  ///< ids or their ends; empty: all
  std::string beside = "parts";    ///< folder beside the page for parts that are not in it
  double page_bytes = 23.7e6;      ///< of motions in the page, in base64: above, all parts are beside it
  bool clouds = false;             ///< measured points near the body
  bool skin_if_it_fits = false;    ///< a body that does not fit a skeleton is left out
  std::int64_t per_label = 0;      ///< clips of a label stand together, at most this many of a source; 0: recordings do

  void Declare(OptionVisitor& v);
};

struct ClipPageOptions {
  std::string video;     ///< file beside the page; empty: none
  std::string no_video;  ///< why there is no video

  void Declare(OptionVisitor& v);
};

/// Figure of a person: bones, a capsule around each, or the skin of a rigged body.
enum class FigureChoice { kBones, kCapsules, kSkin };
enum class PictureFormat { kSvg, kPng };

/// Options of a picture of motions: rows of methods, labels and samples, each of equally spaced frames.
struct MotionPictureOptions {
  std::string title;
  std::vector<std::string> labels;  ///< classes to show; empty: all
  std::vector<std::string> clips;   ///< ids or their ends, instead of labels
  std::int64_t samples = 1;         ///< of each label and method
  std::int64_t stills = 10;         ///< frames of a row
  std::int64_t most_rows = 60;
  std::string corner;                          ///< below the picture: origin of what it shows
  std::vector<std::string> joined;             ///< sources whose motions stand in one row, one after the other
  std::vector<std::string> themes;             ///< of the rows, in order; then each segment's label is below its frames
  std::map<std::string, std::string> columns;  ///< source -> head of its column; empty: one column
  std::map<std::string, std::string> words;    ///< class -> what the picture calls it
  std::map<std::string, std::string> colours;  ///< source -> red, green or blue, instead of the sides' colours
  std::map<std::string, std::string> absent;   ///< source -> why it has no motion: a row that says so
  bool path = true;                            ///< the root's path beside each row
  bool world = false;                          ///< all rows in one view, over the floor of their first frame
  bool scene = false;                          ///< a panel for each label, with all its motions in their world
  double azimuth = 0.785398163397448;          ///< radians from the person's front, to its left
  double elevation = 0.0;                      ///< radians above the horizon
  FigureChoice figure = FigureChoice::kBones;
  PictureFormat format = PictureFormat::kSvg;
  double scale = 2.0;  ///< pixels of a PNG or video for each unit of the drawing

  void Declare(OptionVisitor& v);
};

}  // namespace mocurate
