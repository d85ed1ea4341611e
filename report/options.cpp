#include "report/options.h"

namespace mocurate {

void ReportOptions::Declare(OptionVisitor& v) {
  v.Integer("filmstrip_clips", filmstrip_clips, {1.0, 50.0}, "fits that are drawn: best, worst and those between");
  v.Integer("filmstrip_frames", filmstrip_frames, {2.0, 24.0}, "stills per filmstrip");
}

StageDeclaration ReportDeclaration() { return {"report", 2, "mocurate-annotate"}; }

}  // namespace mocurate
