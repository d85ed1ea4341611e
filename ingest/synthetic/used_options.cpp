#include "ingest/synthetic/studio_options.h"

namespace mocurate {
namespace {

using LayoutList = std::vector<StudioLayout>;

/// Layouts that use an option, or all of a group; options that are not listed define people and actions.
struct Use {
  std::string option;
  LayoutList layouts;
};

const std::vector<Use>& Uses() {
  using L = StudioLayout;
  static const LayoutList rigs = {L::kOpenPose, L::kOpenPoseDepth, L::kDepthSequence};
  static const LayoutList clocks = {L::kPhspd, L::kNtu, L::kOpenPose, L::kOpenPoseDepth, L::kDepthSequence};
  static const LayoutList thinned = {L::kPhspd, L::kNtu, L::kOpenPoseDepth};
  // An option before its group.
  static const std::vector<Use> uses = {
      {"missing", {L::kHumanAct12, L::kPhspd}},
      {"vocabulary", {L::kAmass}},
      {"tilt", {L::kKard, L::kTracks}},
      {"false_track", {L::kNtu, L::kUestcVibe}},
      {"tracker", {L::kNtu, L::kKard, L::kUestc, L::kUestcVibe, L::kNtuVibe, L::kTracks}},
      {"rig.clock_offset", clocks},
      {"rig.moved", clocks},
      {"rig", rigs},
      {"depth.room", {L::kPhspd}},
      {"depth.enabled", thinned},
      {"depth.every", thinned},
      {"depth", {L::kPhspd, L::kNtu, L::kOpenPoseDepth, L::kDepthSequence}},
      {"keypoints", {L::kOpenPose, L::kOpenPoseDepth}}};
  return uses;
}

}  // namespace

std::vector<std::string> LayoutsUsing(const std::string& option) {
  for (const Use& use : Uses()) {
    if (option != use.option && option.rfind(use.option + ".", 0) != 0) continue;
    std::vector<std::string> names;
    for (const StudioLayout layout : use.layouts) names.push_back(StudioLayoutName(layout));
    return names;
  }
  return {};
}

}  // namespace mocurate
