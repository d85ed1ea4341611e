#include "core/motion/clip.h"

namespace mocurate {

std::string ClipIdentity::id() const {
  return source + "/" + person + "/" + recording + "#" + std::to_string(begin_frame) + "-" + std::to_string(end_frame);
}

}  // namespace mocurate
