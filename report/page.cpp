#include "report/page.h"

#include "report/html.h"
#include "report/page_scripts.h"
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

std::string MakePage(const ReportInput& input) {
  std::string html = PageHead(TextOf(input.run, "name") + " - mocurate report", kPageStyle) +
                     "<body>\n"
                     "<a class=\"skip\" href=\"#main\">Skip to the content</a>\n<header>\n" +
                     HeadHtml(input) + "<nav aria-label=\"Sections\"><ol>\n";
  for (const PageSection& section : kSections) {
    html += "<li><a href=\"#" + std::string(section.id) + "\">" + section.title + "</a></li>\n";
  }
  html += "</ol></nav>\n</header>\n<main id=\"main\">\n";
  for (const PageSection& section : kSections) {
    const std::string id = section.id;
    html += "<section id=\"" + id + "\" aria-labelledby=\"" + id + "-title\">\n<h2 id=\"" + id + "-title\">" +
            section.title + "</h2>\n" + section.html(input) + "</section>\n";
  }
  html += "</main>\n<footer>\n" +
          Paragraph("Made by " + EscapeHtml(TextOf(input.run, "created_by")) + " from stored results.");
  if (const std::string takes = TextOf(input.run, "takes"); !takes.empty())
    html += Paragraph("This run uses " + EscapeHtml(takes) + ".");
  return html + "</footer>\n<script type=\"application/json\" id=\"player-data\">" + JsonForScript(PlayersJson(input)) +
         "</script>\n<script>" + kPlayerScript + "</script>\n</body>\n</html>\n";
}

}  // namespace mocurate
