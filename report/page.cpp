#include "report/page.h"

#include <algorithm>

#include "report/html.h"
#include "report/page_files.h"
#include "report/run_facts.h"

namespace mocurate {
namespace {

struct PageSection {
  const char* id;
  const char* title;
  std::string (*html)(const ReportInput& input);
};

constexpr PageSection kSections[] = {{"funnel", "Clips, from read to kept", FunnelHtml},
                                     {"quality", "Before and after", QualityHtml},
                                     {"truth", "Error against truth", TruthHtml},
                                     {"filmstrips", "Best, median and worst fits", FilmstripsHtml},
                                     {"clips", "Clip by clip", ClipsHtml},
                                     {"table", "Evaluation", TableHtml},
                                     {"generated", "Generated motions", GeneratedHtml},
                                     {"recognisers", "Recognition", RecognisersHtml},
                                     {"curves", "Training curves", CurvesHtml},
                                     {"stops", "Where training was stopped", StopsHtml},
                                     {"dataset", "Labels and splits", DatasetHtml},
                                     {"persons", "Bone lengths of the persons", PersonsHtml},
                                     {"findings", "Findings", FindingsHtml},
                                     {"reading", "How to read this page", ReadingHtml}};

}  // namespace

std::string ViewerLink(const ReportInput& input, const std::string& name, int frame, const std::string& text) {
  const std::string page = TextOf(Field(input.run, "viewers"), "clips");
  const Clip* found = nullptr;  // that id, else of the recording the clip with the frame, else its first
  const std::string recording = RecordingOf(name);
  const int recorded = frame + BeginFrameOf(name);
  bool own_frames = false;
  if (!page.empty() && input.dataset) {
    for (const Clip& clip : input.dataset->clips) {
      const std::string id = clip.id();
      own_frames = id == name;
      if (!own_frames && RecordingOf(id) != recording) continue;
      const bool has_frame = recorded >= clip.identity.begin_frame && recorded < clip.identity.end_frame;
      if (found == nullptr || own_frames || has_frame) found = &clip;
      if (own_frames || has_frame) break;
    }
  }
  if (found == nullptr) return EscapeHtml(text);
  const double time = own_frames ? frame / found->rate.hz()
                                 : std::max(0, recorded - found->identity.begin_frame) / RecordedRate(*found).hz();
  return "<a href=\"" + EscapeHtml(page + "#clip=" + PercentEncoded(found->id()) + "&t=" + FixedText(time, 3)) + "\">" +
         EscapeHtml(text) + "</a>";
}

std::string MakePage(const ReportInput& input) {
  std::string html = PageHead(TextOf(input.run, "name") + " - mocurate report", PageStyles()) +
                     "<body>\n"
                     "<a class=\"skip\" href=\"#main\">Skip to the content</a>\n<header>\n" +
                     HeadHtml(input) + "</header>\n<nav aria-label=\"Sections\"><ol>\n";
  for (const PageSection& section : kSections) {
    html += "<li><a href=\"#" + std::string(section.id) + "\">" + section.title + "</a></li>\n";
  }
  const std::string viewer = TextOf(Field(input.run, "viewers"), "clips");
  if (!viewer.empty())
    html += "<li><a href=\"" + EscapeHtml(viewer) + "\"><strong>All clips in 3-D</strong></a></li>\n";
  if (const std::string failed = TextCell(Field(Field(input.run, "viewers"), "failed"), "clips"); !failed.empty())
    html += "<li>No page of the viewer: " + failed + "</li>\n";
  html += "</ol></nav>\n<main id=\"main\">\n";
  for (const PageSection& section : kSections) {
    const std::string id = section.id;
    html += "<section id=\"" + id + "\" aria-labelledby=\"" + id + "-title\">\n<h2 id=\"" + id + "-title\">" +
            section.title + "</h2>\n" + section.html(input) + "</section>\n";
  }
  html += "</main>\n<footer>\n" + Paragraph("Made by " + TextCell(input.run, "created_by") + " from stored results.");
  if (const std::string takes = TextOf(input.run, "takes"); !takes.empty())
    html += Paragraph("This run uses " + EscapeHtml(takes) + ".");
  return html + "</footer>\n" + PageScripts({"tables.js"}) + "</body>\n</html>\n";
}

}  // namespace mocurate
