#include "report/options.h"
#include "report/stages.h"

namespace mocurate {

void ReportOptions::Declare(OptionVisitor& v) {
  v.Integer("pages", pages, {0.0, 1000.0}, "clips with a page of their own: best, worst and evenly between");
  v.Bool("viewer", viewer, "pages of the viewer: all clips, and generated motions beside real ones");
  v.Bool("clouds", clouds, "measured points in the viewer, 300 of a frame; its page then has parts beside it");
  v.Bool("videos", videos, "one H.264 video for each of these pages; takes most of a report's time");
  v.Number("suspect_joint_error", suspect_joint_error, Unit::kMetre, {0.0, 10.0},
           "mean joint error of a clip above which the page reports its fit as suspect: where 3DPCK "
           "counts a joint as wrong (Mehta et al., 3DV 2017)");
}

void ReviewOptions::Declare(OptionVisitor& v) {
  v.Integer("most", most, {1.0, 2000.0}, "maximum findings shown, the worst first");
}

void AnnotateOptions::Declare(OptionVisitor& v) {
  v.Texts("labels", labels, "labels to choose from; empty: the dataset's classes");
  v.Texts("clips", clips, "ids of clips, in full or their last part; empty: all without a label");
  v.Bool("all", all, "include clips that have a label");
  v.Number("poses_size", poses_bytes, Unit::kByte, {1000.0, 1.0e9},
           "maximum size of the poses of all clips on the page; larger sets have fewer poses per second");
}

void SurveyOptions::Declare(OptionVisitor& v) {
  v.Choice("kind", kind, {{"ranking", SurveyKind::kRanking}, {"real_or_fake", SurveyKind::kRealOrFake}},
           "question: the rank of each source's motion of a label, or whether each motion was recorded");
  v.Text("real", real, "source whose motions are recordings");
  v.Integer("questions", questions, {0.0, 1000.0},
            "number of pages; 0: ranking: one for each label, at most 40; real_or_fake: 12");
  v.Integer("clips", clips, {1.0, 9.0}, "motions of a page of real_or_fake");
  v.Integer("seed", seed, {0.0, 9.0e15}, "random seed of all draws");
  v.Texts("labels", labels, "labels of the questions; empty: all that every source has");
  v.Number("seconds", seconds, Unit::kSecond, {0.1, 60.0},
           "maximum duration of each motion; longer ones are cut at a random place");
}

void ClipPageOptions::Declare(OptionVisitor& v) {
  v.Text("video", video, "file beside the page; empty: none");
  v.Text("no_video", no_video, "why there is no video");
}

void ViewerOptions::Declare(OptionVisitor& v) {
  v.Text("title", title, "title of the page");
  v.Texts("clips", clips, "ids of the clips to show, or their ends; empty: all");
  v.Text("beside", beside, "folder beside the page for motions that are not in it");
  v.Number("page_bytes", page_bytes, Unit::kNone, {0.0, 1e9},
           "maximum size of motions in the page, bytes; of larger sets all are beside it");
  v.Integer("per_label", per_label, {0.0, 1000.0},
            "clips of a label stand together, at most this many of a source; 0: clips of a recording do");
  v.Bool("clouds", clouds, "measured points near the body");
  v.Bool("skin_if_it_fits", skin_if_it_fits, "leave out a body that does not fit a skeleton");
}

void MotionPictureOptions::Declare(OptionVisitor& v) {
  v.Text("title", title, "title above the picture");
  v.Texts("labels", labels, "classes to show; empty: all");
  v.Texts("clips", clips, "ids of clips, in full or their last part, instead of labels");
  v.Integer("samples", samples, {1.0, 100.0}, "motions of each label and method");
  v.Integer("stills", stills, {1.0, 60.0}, "equally spaced frames of a row");
  v.Integer("most_rows", most_rows, {1.0, 500.0}, "maximum rows of a picture");
  v.Text("corner", corner, "text below the picture: origin of what it shows");
  v.Texts("joined", joined, "sources whose motions stand in one row");
  v.Texts("themes", themes, "theme of each row; then each segment's label is below its frames");
  v.TextMap("columns", columns, "source -> head of its column");
  v.TextMap("words", words, "class -> what the picture calls it");
  v.TextMap("colours", colours, "source -> red, green or blue");
  v.TextMap("absent", absent, "source -> why it has no motion");
  v.Bool("path", path, "draw the root's path beside each row");
  v.Bool("world", world, "all rows in one view, over the floor of their first frame");
  v.Bool("scene", scene, "a panel for each label, with all its motions in their world");
  v.Number("azimuth", azimuth, Unit::kRadian, {-6.3, 6.3}, "where the view is from: angle from the person's front");
  v.Number("elevation", elevation, Unit::kRadian, {-1.6, 1.6}, "where the view is from: angle above the horizon");
  v.Choice("figure", figure,
           {{"bones", FigureChoice::kBones}, {"capsules", FigureChoice::kCapsules}, {"skin", FigureChoice::kSkin}},
           "figure of a person");
  v.Choice("format", format, {{"svg", PictureFormat::kSvg}, {"png", PictureFormat::kPng}}, "format of the picture");
  v.Number("scale", scale, Unit::kNone, {0.25, 8.0}, "pixels of a PNG or video for each unit of the drawing");
}

StageDeclaration ReportDeclaration() { return {"report", 27, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration ReviewDeclaration() { return {"review", 7, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration AnnotateDeclaration() { return {"annotate", 8, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration SurveyDeclaration() { return {"survey", 6, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration ViewDeclaration() { return {"view", 4, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration ClipPageDeclaration() { return {"clip_page", 13, "mocurate-annotate", ClipLimits()}; }

StageDeclaration ClipVideoDeclaration() { return {"clip_video", 4, "mocurate-video", ClipLimits()}; }

StageDeclaration MotionPictureDeclaration() { return {"draw", 5, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration MotionVideoDeclaration() { return {"draw_video", 3, "mocurate-video", WholeSetLimits()}; }

}  // namespace mocurate
