#include <algorithm>
#include <map>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/store/dataset_clips.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/motion_rows.h"
#include "report/options.h"
#include "report/page_scripts.h"
#include "report/review_script.h"
#include "report/run_facts.h"
#include "report/stages.h"

namespace mocurate {
namespace {

/// One finding with its clips: the first, and the other of a pair.
struct ReviewCard {
  nlohmann::json finding;  ///< of audit.json
  std::vector<Clip> clips;
};

/// Input of the review page.
struct ReviewPageInput {
  std::string dataset;  ///< its file
  std::vector<std::string> labels;
  std::vector<ReviewCard> cards;
  std::vector<std::string> about_set;  ///< messages of findings about the set as a whole
  std::size_t not_shown = 0;           ///< findings beyond those
  nlohmann::json decisions;            ///< earlier decisions: a list of objects as in the page's saved file
};

constexpr int kNumbersOfPage = 2000000;   ///< positions in all players together, about five bytes each
constexpr int kNumbersOfPlayer = 100000;  ///< and in one

std::string LabelChoice(const std::vector<std::string>& labels, const std::string& chosen) {
  std::string html = "<select aria-label=\"New class\">";
  for (const std::string& label : labels) {
    html += "<option" + std::string(label == chosen ? " selected" : "") + ">" + EscapeHtml(label) + "</option>";
  }
  return html + "</select>";
}

/// Strip, player and controls of one clip of a card.
std::string ClipHtml(const Clip& clip, const std::string& id, const ReviewCard& card, const ReviewPageInput& input) {
  const int frames = clip.motion->frame_count();
  const std::string suggested =
      TextOf(card.finding, "code") == "label_suspect" ? TextOf(card.finding, "suggested") : "";
  const auto number = [&](const char* name, int value) {
    return "<label>" + std::string(name) + " <input type=\"number\" class=\"" + name + "\" min=\"0\" max=\"" +
           std::to_string(frames) + "\" value=\"" + std::to_string(value) + "\"></label>";
  };
  const auto button = [](const char* verdict, const char* key) {
    return "<button type=\"button\" data-verdict=\"" + std::string(verdict) + "\">" + verdict + " <kbd>" + key +
           "</kbd></button>";
  };
  return "<div class=\"decided\" data-clip=\"" + EscapeHtml(clip.id()) + "\" data-content=\"" +
         MotionFingerprint(*clip.motion) + "\" data-frames=\"" + std::to_string(frames) + "\">\n<h3>" +
         EscapeHtml(clip.id()) + "</h3>\n" +
         Paragraph("labelled " + EscapeHtml(clip.label) + ", " + Counted(frames, "frame") + " at " +
                       ShortText(clip.rate.hz()) + " Hz" +
                       (clip.identity.person.empty() ? "" : ", person " + EscapeHtml(clip.identity.person)),
                   "soft") +
         "<div class=\"clip\"><div>" + ToInlineSvg(DrawFilmstrip(clip)) + "</div>\n" +
         PlayerHtml(clip.id(), id, false) + "</div>\n<div class=\"verdicts\">" + button("keep", "k") +
         button("drop", "d") + button("relabel", "r") +
         LabelChoice(input.labels, suggested.empty() ? clip.label : suggested) + button("cut", "c") +
         number("begin", 0) + number("end", frames) +
         "<span class=\"said\" aria-live=\"polite\"></span></div>\n</div>\n";
}

/// The two ids of a pair as a JSON list; of one clip an empty one.
std::string PairOf(const ReviewCard& card) {
  nlohmann::json ids = nlohmann::json::array();
  for (const Clip& clip : card.clips) ids.push_back(clip.id());
  return (card.clips.size() > 1 ? ids : nlohmann::json::array())
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string CardHtml(const ReviewCard& card, std::size_t index, const ReviewPageInput& input) {
  const std::string code = TextOf(card.finding, "code");
  std::string html = "<section class=\"card\" tabindex=\"-1\" data-finding=\"" + EscapeHtml(code) + "\" data-pair=\"" +
                     EscapeHtml(PairOf(card)) + "\">\n<h2><span class=\"code " +
                     EscapeHtml(TextOf(card.finding, "severity")) + "\">" + EscapeHtml(code) + "</span> " +
                     std::to_string(index + 1) + " of " + std::to_string(input.cards.size()) + "</h2>\n" +
                     Paragraph(EscapeHtml(TextOf(card.finding, "message")));
  for (std::size_t i = 0; i < card.clips.size(); ++i) {
    html += ClipHtml(card.clips[i], std::to_string(index) + "-" + std::to_string(i), card, input);
  }
  return html + "</section>\n";
}

/// One self-contained page: a card per finding with filmstrips and players, keys to keep, drop, relabel or cut a clip,
/// and the decisions as the YAML that canon.review reads (canon/review/review.h).
std::string MakeReviewPage(const ReviewPageInput& input) {
  std::size_t players = 0;
  for (const ReviewCard& card : input.cards) players += card.clips.size();
  const int numbers = std::min(kNumbersOfPlayer, kNumbersOfPage / std::max(1, static_cast<int>(players)));
  nlohmann::json player_data = nlohmann::json::array();
  std::string cards;
  for (std::size_t i = 0; i < input.cards.size(); ++i) {
    cards += CardHtml(input.cards[i], i, input);
    for (const Clip& clip : input.cards[i].clips) {
      nlohmann::json data = PlayerData(clip.id(), *clip.motion, nullptr, numbers);
      const auto begin = NumberOf(input.cards[i].finding, "frame_begin");
      const bool first = &clip == &input.cards[i].clips.front();
      if (begin && first) data["start"] = static_cast<int>(std::clamp(*begin, 0.0, 1e9)) / data.at("step").get<int>();
      player_data.push_back(std::move(data));
    }
  }
  std::string about_set;
  for (const std::string& message : input.about_set) about_set += "<li>" + EscapeHtml(message) + "</li>\n";
  if (!about_set.empty()) {
    cards = "<section><h2>About the set</h2>\n<ul>\n" + about_set + "</ul>\n</section>\n" + cards;
  }
  if (cards.empty()) cards = "<section>" + Paragraph("Nothing was found.") + "</section>\n";
  const nlohmann::json review = {{"dataset", input.dataset}, {"decisions", input.decisions}};
  return PageHead("Review of " + input.dataset, std::string(kPageStyle) + kReviewStyle) +
         "<body>\n<header>\n<h1>Review of " + EscapeHtml(input.dataset) + "</h1>\n" +
         Paragraph(Counted(static_cast<long long>(input.cards.size()), "finding") +
                       (input.not_shown > 0 ? ", " + std::to_string(input.not_shown) + " more are not shown" : ""),
                   "lead") +
         Paragraph(
             R"html(Keys: <kbd>j</kbd> and <kbd>p</kbd> next and previous clip; <kbd>k</kbd> keep, the finding is wrong;
<kbd>d</kbd> drop; <kbd>r</kbd> relabel to the chosen class; <kbd>[</kbd> and <kbd>]</kbd> begin and end at the
frame that the player shows, then <kbd>c</kbd> cut; <kbd>u</kbd> undo; <kbd>s</kbd> save.)html",
             "soft") +
         "</header>\n<main id=\"main\">\n" + cards +
         "<section id=\"decisions\"><h2>Decisions</h2>\n<p id=\"count\"></p>\n<p><button type=\"button\" "
         "id=\"save\">Save "
         "decisions.yaml <kbd>s</kbd></button></p>\n<textarea id=\"yaml\" readonly rows=\"16\" aria-label=\"Decisions "
         "as "
         "YAML\"></textarea>\n" +
         Paragraph(
             R"html(<code>mocurate dataset apply DATASET decisions.yaml -o NEW.h5</code> applies them to this file;
<code>canon.review: decisions.yaml</code> in a config applies them in every run. The browser keeps them until
they are saved.)html",
             "soft") +
         "</section>\n</main>\n<footer>\n" + Paragraph("Made by " + EscapeHtml(CreatedBy()) + ".") +
         "</footer>\n<script type=\"application/json\" id=\"player-data\">" + JsonForScript(player_data) +
         "</script>\n<script type=\"application/json\" id=\"review-data\">" + JsonForScript(review) +
         "</script>\n<script>" + kPlayerScript + "</script>\n<script>" + kPageToolsScript + "</script>\n<script>" +
         kReviewScript + "</script>\n</body>\n</html>\n";
}

}  // namespace

Expected<StageOutcome> ReviewStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ReviewOptions>(request.options, "review");
  if (!options) return Forward(options);
  ReviewPageInput input;
  input.decisions = nlohmann::json::array();
  nlohmann::json audit;
  std::string audit_name;
  std::optional<DatasetClips> clips;
  for (const StageInput& given : request.inputs) {
    if (given.role == "dataset") {
      auto opened = DatasetClips::Open(given.path, DatasetClips::Check::kHashes);
      if (!opened) return Forward(opened);
      clips.emplace(std::move(*opened));
      input.dataset = given.name;
      input.labels = clips->labels();
      continue;
    }
    const auto text = ReadFile(given.path);
    if (!text) return Forward(text);
    auto json = ParseJson(*text, given.name);
    if (!json) return Forward(json);
    if (given.role == "audit") audit_name = given.name;
    (given.role == "audit" ? audit : input.decisions) = std::move(*json);
  }
  if (!clips) return Fail(ErrorCode::kInternal, "the stage review has no dataset", request.item);
  if (!audit.is_object() || !Field(audit, "findings").is_array()) {
    return Fail(ErrorCode::kMalformed, "not an audit: it has no list of findings", audit_name,
                "create one with mocurate audit DATASET -o FOLDER");
  }
  std::map<std::string, std::size_t> row_of;
  for (std::size_t row = 0; row < clips->size(); ++row) row_of[clips->Id(row)] = row;
  std::size_t unknown = 0, number = 0;
  for (const nlohmann::json& finding : Elements(Field(audit, "findings"))) {
    const Status texts = GuardJson(audit_name + ": /findings/" + std::to_string(number++), [&] {
      for (const char* key : {"clip", "code", "severity", "message"}) finding.at(key).get_ref<const std::string&>();
    });
    if (!texts) return Forward(texts);
    const std::string of_clip = TextOf(finding, "clip");
    if (of_clip.empty()) {
      input.about_set.push_back(TextOf(finding, "code") + ": " + TextOf(finding, "message"));
      continue;
    }
    if (row_of.count(of_clip) == 0) {
      ++unknown;
      continue;
    }
    if (input.cards.size() >= static_cast<std::size_t>(options->most)) {
      ++input.not_shown;
      continue;
    }
    ReviewCard card{finding, {}};
    for (const char* key : {"clip", "suggested"}) {
      const auto row = row_of.find(TextOf(finding, key));
      if (row == row_of.end()) continue;
      auto clip = clips->Read(row->second);
      if (!clip) return Forward(clip);
      card.clips.push_back(std::move(*clip));
    }
    input.cards.push_back(std::move(card));
  }
  if (input.cards.empty() && unknown > 0) {
    return Fail(
        ErrorCode::kInconsistent,
        "none of its " + Counted(static_cast<long long>(unknown), "finding") + " is about a clip of the dataset",
        request.item, "use the audit of this dataset");
  }
  const std::string page = MakeReviewPage(input);
  if (Status written = WriteFile(request.output, page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {
      {"bytes", page.size()}, {"shown", input.cards.size()}, {"not_shown", input.not_shown}, {"unknown", unknown}};
  return outcome;
}

}  // namespace mocurate
