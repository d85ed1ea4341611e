#include <algorithm>

#include "report/html.h"
#include "report/page.h"
#include "report/run_facts.h"

namespace mocurate {
namespace {

/// The first clip of a class; null where it has none.
const Clip* FirstOfLabel(const Dataset& set, const std::string& label) {
  const auto found = std::find_if(set.clips.begin(), set.clips.end(), [&](const Clip& clip) {
    return clip.label == label && clip.motion && clip.motion->frame_count() > 0;
  });
  return found == set.clips.end() ? nullptr : &*found;
}

std::string Strip(const std::string& title, const Clip* clip) {
  std::string html = "<figure><figcaption>" + EscapeHtml(title) + "</figcaption>";
  if (clip == nullptr) return html + "none</figure>\n";
  return html + FilmstripSvg(title, *clip->motion) + "</figure>\n";
}

}  // namespace

std::string GeneratedHtml(const ReportInput& input) {
  std::string failed;
  for (const auto& [network, reason] : Field(input.run, "ungenerated").items()) {
    failed +=
        Paragraph(EscapeHtml(network) + " generated no motions: " + EscapeHtml(reason.get<std::string>()), "soft");
  }
  if (input.generated.empty() || !input.dataset) {
    return failed.empty() ? Paragraph("No network of this run generated motions.") : failed;
  }
  std::string html = failed + Paragraph(
                                  "One motion of each class by each network, its first seed, beside the first real "
                                  "one. They are not selected.");
  bool open = true;
  for (const std::string& label : input.dataset->labels) {
    html += "<details" + std::string(open ? " open" : "") + "><summary>" + EscapeHtml(label) + "</summary>" +
            Strip("Real", FirstOfLabel(*input.dataset, label));
    for (const auto& [network, set] : input.generated) html += Strip(network, FirstOfLabel(set, label));
    html += "</details>\n";
    open = false;
  }
  return html;
}

}  // namespace mocurate
