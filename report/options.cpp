#include "report/options.h"

namespace mocurate {

void ReportOptions::Declare(OptionVisitor& v) {
  v.Integer("filmstrip_clips", filmstrip_clips, {1.0, 50.0}, "fits that are drawn: best, worst and those between");
  v.Integer("filmstrip_frames", filmstrip_frames, {2.0, 24.0}, "stills per filmstrip");
  v.Integer("pages", pages, {0.0, 1000.0}, "clips that get a page of their own: best, worst and those between");
  v.Integer("page_views", page_views, {0.0, 100.0}, "views over which a page draws the fitted body, at most");
  v.Bool("videos", videos, "one H.264 video for each of these pages: most of a report's time");
  v.Number("suspect_joint_error", suspect_joint_error, Unit::kMetre, {0.0, 10.0},
           "mean distance of a clip's joints from the truth beyond which the page calls its fit suspect: where 3DPCK "
           "counts a joint as wrong (Mehta et al., 3DV 2017)");
}

void ReviewOptions::Declare(OptionVisitor& v) {
  v.Integer("most", most, {1.0, 2000.0}, "findings shown, the worst first");
  v.Integer("stills", stills, {1.0, 24.0}, "stills per filmstrip");
}

void AnnotateOptions::Declare(OptionVisitor& v) {
  v.Texts("labels", labels, "to choose from; none: the dataset's classes");
  v.Texts("clips", clips, "ids of clips or their ends; none: all without a label");
  v.Bool("all", all, "clips that have a label too");
  v.Number("rate", rate_hz, Unit::kHertz, {0.1, 1000.0}, "poses that players show in a second, at most");
  v.Number("poses_size", poses_bytes, Unit::kByte, {1000.0, 1.0e9}, "poses of all clips together; more are thinned");
}

void SurveyOptions::Declare(OptionVisitor& v) {
  v.Choice("kind", kind, {{"preference", SurveyKind::kPreference}, {"real_or_fake", SurveyKind::kRealOrFake}},
           "which of two motions looks more like the action, or whether one was recorded");
  v.Text("real", real, "source whose motions are recordings");
  v.Integer("questions", questions, {0.0, 1000.0}, "0: all that the motions are enough for, at most 40");
  v.Integer("seed", seed, {0.0, 9.0e15}, "of every draw");
  v.Texts("labels", labels, "that are asked about; none: all that every source has");
  v.Number("seconds", seconds, Unit::kSecond, {0.1, 60.0}, "of each motion, from its begin, at most");
}

void ClipPageOptions::Declare(OptionVisitor& v) {
  v.Integer("stills", stills, {1.0, 24.0}, "stills per filmstrip");
  v.Integer("views", views, {0.0, 100.0}, "views over which the body is drawn, at most");
  v.Text("video", video, "file beside the page; empty: none");
  v.Text("no_video", no_video, "why there is none");
}

void ClipVideoOptions::Declare(OptionVisitor& v) {
  v.Integer("views", views, {0.0, 12.0}, "views beside the front, at most");
  v.Integer("height", height, {64.0, 1080.0}, "pixels");
  v.Integer("frames", frames, {2.0, 100000.0}, "at most; longer clips are thinned");
}

void PictureOptions::Declare(OptionVisitor& v) {
  v.Choice("kind", kind,
           {{"clip", PictureKind::kClip}, {"overlay", PictureKind::kOverlay}, {"cloud", PictureKind::kCloud}},
           "stills of a clip, the body over a depth view, or the bones inside the fused cloud");
  v.Integer("stills", stills, {1.0, 24.0}, "stills of a clip");
}

void MotionPictureOptions::Declare(OptionVisitor& v) {
  v.Text("title", title, "above the picture");
  v.Texts("labels", labels, "classes that are shown; empty: all");
  v.Texts("clips", clips, "ids of clips, or their ends, in the place of labels");
  v.Integer("samples", samples, {1.0, 100.0}, "motions of each label and method");
  v.Integer("stills", stills, {1.0, 60.0}, "equally spaced frames of a row");
  v.Integer("most_rows", most_rows, {1.0, 500.0}, "rows of a picture, at most");
  v.Choice("figure", figure,
           {{"bones", FigureChoice::kBones}, {"capsules", FigureChoice::kCapsules}, {"skin", FigureChoice::kSkin}},
           "what a person is drawn as");
  v.Choice("format", format, {{"svg", PictureFormat::kSvg}, {"png", PictureFormat::kPng}}, "of the picture");
  v.Number("scale", scale, Unit::kNone, {0.25, 8.0}, "pixels of a PNG or video for each unit of the drawing");
}

StageDeclaration ReportDeclaration() { return {"report", 19, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration ReviewDeclaration() { return {"review", 2, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration AnnotateDeclaration() { return {"annotate", 1, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration SurveyDeclaration() { return {"survey", 1, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration ClipPageDeclaration() { return {"clip_page", 7, "mocurate-annotate", ClipLimits()}; }

StageDeclaration ClipVideoDeclaration() { return {"clip_video", 3, "mocurate-video", ClipLimits()}; }

StageDeclaration MotionPictureDeclaration() { return {"draw", 1, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration MotionVideoDeclaration() { return {"draw_video", 1, "mocurate-video", WholeSetLimits()}; }

StageDeclaration PlotDeclaration() { return {"plot", 1, "mocurate-annotate", ClipLimits()}; }

StageDeclaration PictureDeclaration() { return {"picture", 4, "mocurate-annotate", ClipLimits()}; }

}  // namespace mocurate
