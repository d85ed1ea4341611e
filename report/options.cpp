#include "report/options.h"

namespace mocurate {

void ReportOptions::Declare(OptionVisitor& v) {
  v.Integer("filmstrip_clips", filmstrip_clips, {1.0, 50.0}, "fits that are drawn: best, worst and those between");
  v.Integer("filmstrip_frames", filmstrip_frames, {2.0, 24.0}, "stills per filmstrip");
}

void PictureOptions::Declare(OptionVisitor& v) {
  v.Choice("kind", kind,
           {{"clip", PictureKind::kClip}, {"overlay", PictureKind::kOverlay}, {"cloud", PictureKind::kCloud}},
           "stills of a clip, the body over a depth view, or the bones inside the fused cloud");
  v.Integer("stills", stills, {1.0, 24.0}, "stills of a clip");
}

StageDeclaration ReportDeclaration() { return {"report", 9, "mocurate-annotate", WholeSetLimits()}; }

StageDeclaration PictureDeclaration() { return {"picture", 2, "mocurate-annotate", ClipLimits()}; }

}  // namespace mocurate
