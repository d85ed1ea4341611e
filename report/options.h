#pragma once

#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/pipeline/stage.h"

namespace mocurate {

struct ReportOptions {
  std::int64_t filmstrip_clips = 5;   ///< best, median and worst fits that are drawn
  std::int64_t filmstrip_frames = 8;  ///< stills per strip
  std::int64_t pages = 5;             ///< clips with a page of their own: best, worst and those between
  std::int64_t page_views = 6;        ///< views over which a page draws the body, at most
  bool videos = true;                 ///< one H.264 video per page
  /// Metres from the truth, mean over the joints and frames of a clip, beyond which its fit is suspect: there 3DPCK
  /// counts a joint as wrong (half a head; Mehta et al., 3DV 2017), and fitting/fit_outcome.cpp a residual as large.
  double suspect_joint_error = 0.15;

  void Declare(OptionVisitor& v);
};

/// Of the page that asks a person about findings.
struct ReviewOptions {
  std::int64_t most = 200;  ///< findings shown, the worst first
  std::int64_t stills = 8;  ///< per filmstrip

  void Declare(OptionVisitor& v);
};

/// Of the page on which a person marks spans of recordings.
struct AnnotateOptions {
  std::vector<std::string> labels;  ///< to choose from; empty: the dataset's classes
  std::vector<std::string> clips;   ///< ids or their ends; empty: all without a label
  bool all = false;                 ///< clips that have a label too
  double rate_hz = 15.0;            ///< poses that players show in a second, at most
  double poses_bytes = 36.0e6;      ///< of all clips together: more are thinned

  void Declare(OptionVisitor& v);
};

enum class SurveyKind { kPreference, kRealOrFake };

/// Of the page that asks people about motions of several sources.
struct SurveyOptions {
  SurveyKind kind = SurveyKind::kPreference;
  std::string real = "real";        ///< source whose motions are recordings
  std::int64_t questions = 0;       ///< 0: all that the motions are enough for, at most 40
  std::int64_t seed = 1;            ///< of every draw
  std::vector<std::string> labels;  ///< that are asked about; empty: all that every source has
  double seconds = 10.0;            ///< of each motion, at most

  void Declare(OptionVisitor& v);
};

enum class PictureKind { kClip, kOverlay, kCloud };

struct PictureOptions {
  PictureKind kind = PictureKind::kClip;
  std::int64_t stills = 8;  ///< of a clip

  void Declare(OptionVisitor& v);
};

struct ClipPageOptions {
  std::int64_t stills = 8;  ///< per filmstrip
  std::int64_t views = 6;   ///< over which the body is drawn, at most
  std::string video;        ///< file beside the page; empty: none
  std::string no_video;     ///< why there is none

  void Declare(OptionVisitor& v);
};

struct ClipVideoOptions {
  std::int64_t views = 3;     ///< beside the front, at most
  std::int64_t height = 480;  ///< pixels
  std::int64_t frames = 450;  ///< at most: longer clips are thinned, at their own speed

  void Declare(OptionVisitor& v);
};

/// What a person is drawn as: bones, a capsule around each, or the skin of a rigged body.
enum class FigureChoice { kBones, kCapsules, kSkin };
enum class PictureFormat { kSvg, kPng };

/// Of a picture of motions: rows of methods, labels and samples, each of equally spaced frames.
struct MotionPictureOptions {
  std::string title;
  std::vector<std::string> labels;  ///< classes that are shown; empty: all
  std::vector<std::string> clips;   ///< ids or their ends, in the place of labels
  std::int64_t samples = 1;         ///< of each label and method
  std::int64_t stills = 10;         ///< frames of a row
  std::int64_t most_rows = 60;
  FigureChoice figure = FigureChoice::kBones;
  PictureFormat format = PictureFormat::kSvg;
  double scale = 2.0;  ///< pixels of a PNG or video for each unit of the drawing

  void Declare(OptionVisitor& v);
};

StageDeclaration MotionPictureDeclaration();
StageDeclaration MotionVideoDeclaration();
StageDeclaration PlotDeclaration();
StageDeclaration ClipPageDeclaration();
StageDeclaration ClipVideoDeclaration();
StageDeclaration ReportDeclaration();
StageDeclaration ReviewDeclaration();
StageDeclaration AnnotateDeclaration();
StageDeclaration SurveyDeclaration();
StageDeclaration PictureDeclaration();

}  // namespace mocurate
