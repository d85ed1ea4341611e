#include "report/annotate_page.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/base/version.h"
#include "report/annotate_scripts.h"
#include "report/html.h"
#include "report/page_scripts.h"
#include "report/review_script.h"

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
          {"recording", card.recording},
          {"frames", card.frames},
          {"hz", card.hz},
          {"begin_s", card.begin_s},
          {"yaw", card.view.yaw},
          {"pitch", card.view.pitch},
          {"step", card.poses.step},
          {"root_mm", card.poses.root_mm},
          {"joint_mm", card.poses.joint_mm},
          {"fastest", card.speeds.fastest},
          {"spans", SpansJson(card.spans)},
          {"done", card.done}};
}

std::string ButtonHtml(const char* css_class, const std::string& html) {
  return "<button type=\"button\" class=\"" + std::string(css_class) + "\">" + html + "</button>";
}

std::string TimeField(const char* name) {
  return "<label>" + std::string(name) + " <input type=\"number\" class=\"" + name +
         "\" step=\"0.001\" disabled> s</label>";
}

/// Bytes that the page's script decodes on demand.
std::string BytesHtml(const char* name, const std::string& bytes) {
  return "<script type=\"text/plain\" class=\"" + std::string(name) + "\">data:;base64," + Base64(bytes) +
         "</script>\n";
}

std::string ClipCardHtml(const AnnotateCard& card, std::size_t index, std::size_t count) {
  const std::string name = EscapeHtml(card.clip);
  const std::string from =
      card.begin_s > 0.0 ? ", from " + FixedText(card.begin_s, 2) + " s of its recording" : std::string();
  return "<section class=\"card decided annotated\" tabindex=\"-1\" aria-label=\"" + name + "\">\n<h2>" + name +
         " <span class=\"soft\">" + std::to_string(index + 1) + " of " + std::to_string(count) + "</span></h2>\n" +
         Paragraph(FixedText(card.frames / card.hz, 1) + " s" + from + ", " + Counted(card.frames, "frame") + " at " +
                       ShortText(card.hz) + " Hz" + (card.person.empty() ? "" : ", person " + EscapeHtml(card.person)) +
                       (card.label.empty() ? "" : ", labelled " + EscapeHtml(card.label)) +
                       "; <span class=\"marked\"></span>",
                   "soft") +
         "<div class=\"clip\"><div>\n<div class=\"track\" role=\"group\" aria-label=\"Spans of " + name +
         "\"><div class=\"lanes\"></div><canvas role=\"img\" aria-label=\"Speed of the fastest joint\"></canvas><div "
         "class=\"drawn\" hidden></div><div class=\"mark\" "
         "hidden></div><div class=\"playhead\"></div></div>\n<div class=\"verdicts\"><label>label <input type=\"text\" "
         "class=\"label\" list=\"label-names\" disabled></label>" +
         TimeField("begin") + TimeField("end") + ButtonHtml("remove", "remove <kbd>Del</kbd>") +
         ButtonHtml("done-button", "done <kbd>d</kbd>") +
         "</div>\n<div class=\"verdicts ask\" role=\"group\" hidden><span class=\"asked\" "
         "aria-live=\"polite\"></span>" +
         ButtonHtml("add", "Add it to the labels") + ButtonHtml("no", "Cancel") +
         "</div>\n<p class=\"said\" aria-live=\"polite\"></p>\n</div>\n" +
         PlayerHtml(card.clip, std::to_string(index), false) + "</div>\n" + BytesHtml("poses", card.poses.rows) +
         BytesHtml("speeds", card.speeds.values) + "</section>\n";
}

std::string AnnotateHeaderHtml(const AnnotatePageInput& input) {
  const std::string name = EscapeHtml(input.dataset);
  double least = 0.0;
  for (const AnnotateCard& card : input.cards) {
    const double rate = card.hz / card.poses.step;
    least = least > 0.0 ? std::min(least, rate) : rate;
  }
  return "<header>\n<h1>Annotate " + name + "</h1>\n" +
         Paragraph(Counted(static_cast<long long>(input.cards.size()), "clip") + "; players show " + ShortText(least) +
                       " poses a second or more, times and the speed curve have every frame",
                   "lead") +
         Paragraph(
             R"html(Drag on a timeline to mark a span, drag an edge to move it. Keys: <kbd>space</kbd> play and pause; <kbd>←</kbd>
<kbd>→</kbd> a frame, with shift ten, <kbd>Home</kbd> <kbd>End</kbd>; <kbd>[</kbd> and <kbd>]</kbd> (or
<kbd>b</kbd> and <kbd>e</kbd>) begin and end of a new span at the frame that the player shows, <kbd>{</kbd> and
<kbd>}</kbd> (or <kbd>B</kbd> and <kbd>E</kbd>) of the selected span; a digit or <kbd>l</kbd> and its name
choose the label; <kbd>a</kbd> accepts a proposed span; <kbd>,</kbd> and <kbd>.</kbd> previous and next span;
<kbd>Delete</kbd> removes it, <kbd>Esc</kbd> deselects it; <kbd>ctrl-z</kbd> or <kbd>u</kbd> undo,
<kbd>ctrl-y</kbd> redo; <kbd>+</kbd> and <kbd>-</kbd> zoom; <kbd>x</kbd> speed; <kbd>j</kbd> and <kbd>p</kbd>
next and previous clip; <kbd>d</kbd> done, <kbd>f</kbd> hide clips that are done; <kbd>s</kbd> save.)html",
             "soft") +
         "</header>\n<div class=\"bar\"><div><progress id=\"progress\" max=\"" +
         std::to_string(std::max<std::size_t>(1, input.cards.size())) +
         "\" value=\"0\" aria-label=\"Clips done\"></progress><span id=\"count\"></span><label><input "
         "type=\"checkbox\" id=\"undone\"> hide clips that are done <kbd>f</kbd></label><button type=\"button\" "
         "id=\"save\">Save spans.csv <kbd>s</kbd></button><span id=\"message\" aria-live=\"polite\"></span></div>"
         "<div id=\"labels\" role=\"group\" aria-label=\"Labels\"></div></div>\n<datalist "
         "id=\"label-names\"></datalist>\n";
}

}  // namespace

std::string MakeAnnotatePage(const AnnotatePageInput& input) {
  nlohmann::json page = {
      {"dataset", input.dataset},         {"labels", input.labels},          {"rest", input.rest}, {"joints", 0},
      {"bones", nlohmann::json::array()}, {"clips", nlohmann::json::array()}};
  if (input.skeleton) {
    const std::vector<int> sides = SidesOf(*input.skeleton);
    page["joints"] = input.skeleton->joint_count();
    for (int j = 1; j < input.skeleton->joint_count(); ++j) {
      page["bones"].push_back({input.skeleton->joints[j].parent, j, sides[j]});
    }
  }
  std::string cards;
  for (std::size_t i = 0; i < input.cards.size(); ++i) {
    page["clips"].push_back(CardJson(input.cards[i]));
    cards += ClipCardHtml(input.cards[i], i, input.cards.size());
  }
  return PageHead("Annotate " + input.dataset, std::string(kPageStyle) + kReviewStyle + kAnnotateStyle) + "<body>\n" +
         AnnotateHeaderHtml(input) + "<main id=\"main\">\n" + cards +
         "<section><h2>Spans</h2>\n<details id=\"text\"><summary>spans.csv as text</summary>\n<textarea id=\"csv\" "
         "readonly rows=\"16\" aria-label=\"Spans as CSV\"></textarea></details>\n" +
         Paragraph(
             R"html(Seconds count from the first frame of the recording. <code>canon.trim: {rule: annotated, spans:
spans.csv}</code> in a config cuts recordings by this file; <code>mocurate review DATASET --annotate --spans
spans.csv</code> continues from it. The browser keeps the marked spans, also after saving.)html",
             "soft") +
         "<p><button type=\"button\" id=\"forget\">Delete the spans marked here</button> <button type=\"button\" "
         "id=\"sure\" hidden>Yes, start again</button></p>\n</section>\n</main>\n<footer>\n" +
         Paragraph("Made by " + EscapeHtml(CreatedBy()) + ".") +
         "</footer>\n<script type=\"application/json\" id=\"annotate-data\">" + JsonForScript(page) +
         "</script>\n<script>" + kPlayerScript + "</script>\n<script>" + kPageToolsScript + "</script>\n<script>" +
         kTimelineScript + "</script>\n<script>" + kAnnotateFilesScript + "</script>\n<script>" + kAnnotateScript +
         "</script>\n</body>\n</html>\n";
}

}  // namespace mocurate
