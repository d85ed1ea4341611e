#include "ingest/checks/frozen_views.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/png.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr int kFewestFrozen = 3;

bool RepeatsIn(const ViewTrace& view, int f) {
  const auto at = static_cast<std::size_t>(f);
  return at < view.frames.size() && !view.frames[at].empty() && view.frames[at] == view.frames[at - 1];
}

bool ChangesIn(const ViewTrace& view, int f) {
  const auto at = static_cast<std::size_t>(f);
  return at < view.frames.size() && !view.frames[at].empty() && !view.frames[at - 1].empty() &&
         view.frames[at] != view.frames[at - 1];
}

/// The numbers of a frame as bytes; empty where no person is observed.
std::string KeypointText(const KeypointView& view, int f) {
  std::string text;
  bool seen = false;
  for (int p = 0; p < view.people; ++p) {
    for (int k = 0; k < view.points(); ++k) {
      const double* point = view.at(f, p, k);
      seen = seen || point[2] > 0.0;
      text.append(reinterpret_cast<const char*>(point), 3 * sizeof(double));
    }
  }
  return seen ? text : "";
}

bool IsBlankFile(const std::map<std::string, std::filesystem::path>& files, const std::string& name) {
  const auto file = files.find(name);
  const Expected<std::string> bytes = file == files.end() ? Expected<std::string>() : ReadFile(file->second);
  return bytes && IsBlankPng(*bytes);
}

}  // namespace

Finding FrozenView::Report() const {
  return FrameFinding("frozen_view", begin, end, "", end - begin,
                      "camera '" + camera + "' shows the same to the last digit in " + Counted(end - begin, "frame") +
                          " from frame " + std::to_string(begin) +
                          " on, while other cameras show motion: it hung, or its files were written "
                          "twice; copy them again, or leave the camera out there");
}

std::vector<FrozenView> FindFrozenViews(const std::vector<ViewTrace>& views) {
  std::vector<FrozenView> frozen;
  for (const ViewTrace& view : views) {
    const int frames = static_cast<int>(view.frames.size());
    for (int begin = 0, end = 1; begin < frames; begin = end++) {
      int changes = 0;
      for (; end < frames && RepeatsIn(view, end); ++end) {
        const auto changed = [&](const ViewTrace& other) { return ChangesIn(other, end); };
        changes += std::any_of(views.begin(), views.end(), changed) ? 1 : 0;
      }
      if (end - begin < kFewestFrozen || 2 * changes < end - begin - 1) continue;
      frozen.push_back({view.camera, begin, end});
    }
  }
  return frozen;
}

std::vector<Finding> FindFrozenViews(const Evidence& evidence,
                                     const std::map<std::string, std::filesystem::path>& files) {
  std::vector<ViewTrace> keypoints, depth;
  for (const KeypointView& view : evidence.keypoint_views) {
    keypoints.push_back({view.camera.name, {}});
    for (int f = 0; f < view.frames(); ++f) keypoints.back().frames.push_back(KeypointText(view, f));
  }
  for (const DepthView& view : evidence.depth_views) depth.push_back({view.camera.name, view.sha256});
  std::vector<Finding> findings;
  for (const FrozenView& view : FindFrozenViews(keypoints)) findings.push_back(view.Report());
  for (const FrozenView& frozen : FindFrozenViews(depth)) {
    const auto blank = [&](const DepthView& view) {
      return view.camera.name == frozen.camera &&
             IsBlankFile(files, view.files[static_cast<std::size_t>(frozen.begin)].generic_string());
    };
    if (std::none_of(evidence.depth_views.begin(), evidence.depth_views.end(), blank))
      findings.push_back(frozen.Report());
  }
  return findings;
}

}  // namespace mocurate
