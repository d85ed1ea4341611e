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

StageDeclaration ReportDeclaration() { return {"report", 19, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration ReviewDeclaration() { return {"review", 2, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration AnnotateDeclaration() { return {"annotate", 1, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration ClipPageDeclaration() { return {"clip_page", 7, "mocurate-annotate", ClipLimits()}; }

StageDeclaration ClipVideoDeclaration() { return {"clip_video", 3, "mocurate-video", ClipLimits()}; }

StageDeclaration PictureDeclaration() { return {"picture", 4, "mocurate-annotate", ClipLimits()}; }

}  // namespace mocurate
