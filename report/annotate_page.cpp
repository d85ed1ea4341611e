#include "report/annotate_page.h"

#include "core/base/version.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/page_files.h"
#include "report/viewer_data.h"

namespace mocurate {
namespace {

nlohmann::json SpansJson(const std::vector<AnnotatedSpan>& spans) {
  nlohmann::json list = nlohmann::json::array();
  for (const AnnotatedSpan& span : spans) {
    nlohmann::json json = {{"begin_s", span.begin_s}, {"end_s", span.end_s}, {"label", span.label}};
    if (!span.fine_label.empty()) json["fine_label"] = span.fine_label;
    if (span.proposed) json["proposed"] = true;
    list.push_back(std::move(json));
  }
  return list;
}

nlohmann::json CardJson(const AnnotateCard& card) {
  return {{"key", card.key},
          {"clip", card.clip},
          {"recording", card.recording},
          {"person", card.person},
          {"label", card.label},
          {"frames", card.frames},
          {"hz", card.hz},
          {"begin_s", card.begin_s},
          {"step", card.step},
          {"fastest", card.speeds.fastest},
          {"speeds", Base64(card.speeds.values)},
          {"spans", SpansJson(card.spans)},
          {"done", card.done}};
}

}  // namespace

std::string MakeAnnotatePage(const AnnotatePageInput& input) {
  nlohmann::json page = {
      {"dataset", input.dataset}, {"labels", input.labels}, {"rest", input.rest}, {"clips", nlohmann::json::array()}};
  for (const AnnotateCard& card : input.cards) page["clips"].push_back(CardJson(card));
  return PageHead("Annotate " + input.dataset, PageStyles({"review.css", "annotate.css"})) + "<body>\n" +
         std::string(PageFile("annotate.html")) + "<template id=\"player\">" + PlayerHtml("this clip") +
         "</template>\n<footer>\n" + Paragraph("Made by " + EscapeHtml(CreatedBy()) + ".") +
         "</footer>\n<script type=\"application/json\" id=\"annotate-data\">" + JsonForScript(page) + "</script>\n" +
         MotionsHtml(input.motions, input.parts,
                     {"data.js", "player.js", "drawn.js", "page_tools.js", "annotate_track.js", "annotate_files.js",
                      "annotate.js"}) +
         "</body>\n</html>\n";
}

}  // namespace mocurate
