#pragma once

#include <string>

#include "core/base/options.h"
#include "core/pipeline/stage.h"

namespace mocurate {

struct ReportOptions {
  std::int64_t filmstrip_clips = 5;   ///< best, median and worst fits that are drawn
  std::int64_t filmstrip_frames = 8;  ///< stills per strip

  void Declare(OptionVisitor& v);
};

enum class PictureKind { kClip, kOverlay, kCloud };

struct PictureOptions {
  PictureKind kind = PictureKind::kClip;
  std::int64_t stills = 8;  ///< of a clip

  void Declare(OptionVisitor& v);
};

StageDeclaration ReportDeclaration();
StageDeclaration PictureDeclaration();

}  // namespace mocurate
