#include "report/state_map.h"

#include "report/html.h"
#include "report/svg.h"

namespace mocurate {
namespace {

const char* ClassOf(JointState state) {
  switch (state) {
    case JointState::kObserved:
      return "s-observed";
    case JointState::kRepaired:
      return "s-repaired";
    case JointState::kInterpolated:
      return "s-interpolated";
    case JointState::kInferred:
      return "s-inferred";
  }
  return "";
}

}  // namespace

std::string StateMapSvg(const Motion& motion) {
  constexpr double kLeft = 130.0;
  constexpr double kWidth = 900.0;
  constexpr double kRow = 13.0;
  if (motion.state.empty() || motion.frame_count() == 0) return "";
  const int frames = motion.frame_count();
  const int joints = motion.joint_count();
  const double cell = (kWidth - kLeft) / frames;
  const double bottom = kRow * joints;
  std::string svg = "<svg class=\"states\" viewBox=\"0 0 " + Coordinate(kWidth) + " " + Coordinate(bottom + 18.0) +
                    "\" role=\"img\" aria-label=\"State of every joint over the frames\">\n";
  for (int j = 0; j < joints; ++j) {
    svg += "<text x=\"" + Coordinate(kLeft - 6.0) + "\" y=\"" + Coordinate(kRow * j + 10.0) +
           "\" text-anchor=\"end\" class=\"label\">" + EscapeHtml(motion.skeleton->joints[j].name) + "</text>";
    for (int f = 0; f < frames;) {
      const JointState state = motion.state[static_cast<std::size_t>(f) * joints + j];
      int end = f + 1;
      while (end < frames && motion.state[static_cast<std::size_t>(end) * joints + j] == state) ++end;
      svg += "<rect x=\"" + Coordinate(kLeft + cell * f) + "\" y=\"" + Coordinate(kRow * j + 1.0) + "\" width=\"" +
             Coordinate(std::max(0.6, cell * (end - f))) + "\" height=\"" + Coordinate(kRow - 2.0) + "\" class=\"" +
             ClassOf(state) + "\"/>";
      f = end;
    }
    svg += "\n";
  }
  for (const double mark : AxisMarks(0.0, frames, 8)) {
    if (mark != static_cast<int>(mark)) continue;
    svg += "<text x=\"" + Coordinate(kLeft + cell * mark) + "\" y=\"" + Coordinate(bottom + 14.0) +
           "\" text-anchor=\"middle\" class=\"label\">" + std::to_string(static_cast<int>(mark)) + "</text>";
  }
  return svg + "</svg>\n";
}

}  // namespace mocurate
