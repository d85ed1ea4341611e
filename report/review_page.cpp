#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/operations.h"
#include "core/store/dataset_clips.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/motion_rows.h"
#include "report/options.h"
#include "report/page_files.h"
#include "report/run_facts.h"
#include "report/stages.h"
#include "report/viewer_data.h"

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

constexpr double kMotionBytes = 12e6;  ///< of all motions of a page; longer ones are shown at a lower rate

/// Name of a card's motions in the viewer.
std::string GroupOf(const ReviewCard& card, std::size_t index) {
  return std::to_string(index + 1) + " " + TextOf(card.finding, "code") + ": " + card.clips.front().id();
}

/// Seconds of the finding's first and last frames in its clip.
std::pair<double, double> SpanOf(const ReviewCard& card) {
  const double hz = card.clips.front().rate.hz();
  const auto seconds = [&](const char* key) {
    return std::clamp(NumberOf(card.finding, key).value_or(0.0), 0.0, 1e9) / hz;
  };
  return {seconds("frame_begin"), seconds("frame_end")};
}

/// A finding and its clips, with filmstrips, for review.js.
nlohmann::json CardJson(const ReviewCard& card, std::size_t index, int step) {
  nlohmann::json json = {
      {"group", GroupOf(card, index)}, {"at", SpanOf(card).first}, {"clips", nlohmann::json::array()}};
  for (const char* key : {"code", "severity", "message"}) json[key] = TextOf(card.finding, key);
  if (json["code"] == "label_suspect") json["suggested"] = TextOf(card.finding, "suggested");
  for (const Clip& clip : card.clips) {
    json["clips"].push_back({{"id", clip.id()},
                             {"content", MotionFingerprint(*clip.motion)},
                             {"frames", clip.motion->frame_count()},
                             {"hz", clip.rate.hz()},
                             {"label", clip.label},
                             {"person", clip.identity.person},
                             {"strip", ToInlineSvg(DrawFilmstrip(clip))}});
    if (step > 1) json["clips"].back()["shown_hz"] = clip.rate.hz() / step;
  }
  return json;
}

/// Frames from one that the viewer shows to the next.
int StepOf(const ReviewPageInput& input) {
  double bytes = 0.0;
  for (const ReviewCard& card : input.cards) {
    for (const Clip& clip : card.clips) bytes += 12.0 * clip.motion->frame_count() * clip.motion->joint_count();
  }
  return std::max(1, static_cast<int>(std::ceil(bytes / kMotionBytes)));
}

/// The motions of all cards for the viewer beside them; those of a pair stand together.
nlohmann::json MotionsOf(const ReviewPageInput& input, int step, std::vector<std::string>& parts) {
  ViewerData data([&](int, const std::string& bytes) {
    parts.push_back(Base64(bytes));
    return Status();
  });
  std::size_t clips = 0;
  for (const ReviewCard& card : input.cards) clips = std::max(clips, card.clips.size());
  for (std::size_t i = 0; i < clips; ++i) data.AddSource(i == 0 ? "the clip" : "the other");
  for (std::size_t i = 0; i < input.cards.size(); ++i) {
    const ReviewCard& card = input.cards[i];
    for (std::size_t k = 0; k < card.clips.size(); ++k) {
      const Clip& clip = card.clips[k];
      const FrameRate lower{clip.rate.numerator, clip.rate.denominator * step};
      const Clip shown = step > 1 ? Resample(clip, lower) : clip;
      ViewedClip viewed{shown, {}, "", GroupOf(card, i)};
      if (k == 0) {
        Finding finding;
        finding.code = TextOf(card.finding, "code");
        finding.message = TextOf(card.finding, "message");
        const std::string severity = TextOf(card.finding, "severity");
        for (const Severity known : {Severity::kInfo, Severity::kError}) {
          if (severity == Name(known)) finding.severity = known;
        }
        viewed.findings.push_back({SpanOf(card).first, SpanOf(card).second, finding});
      }
      (void)data.Add(static_cast<int>(k), viewed);  // the sink has no errors
    }
  }
  (void)data.Finish();
  nlohmann::json index = data.Index();
  index["embedded"] = "beside";  // the page has the list, and keys of its own
  return index;
}

/// One self-contained page: a card per finding with filmstrips beside a viewer, keys to keep, drop, relabel or cut a
/// clip, and the decisions as the YAML that canon.review reads (canon/review/review.h).
std::string MakeReviewPage(const ReviewPageInput& input) {
  std::vector<std::string> parts;
  const int step = StepOf(input);
  const nlohmann::json index = MotionsOf(input, step, parts);
  nlohmann::json review = {{"dataset", input.dataset},     {"labels", input.labels},
                           {"about_set", input.about_set}, {"not_shown", input.not_shown},
                           {"decisions", input.decisions}, {"cards", nlohmann::json::array()}};
  for (std::size_t i = 0; i < input.cards.size(); ++i) review["cards"].push_back(CardJson(input.cards[i], i, step));
  return PageHead("Review of " + input.dataset, PageStyles({"viewer.css", "review.css"})) +
         "<body class=\"reviewed\">\n" + std::string(PageFile("review.html")) + "<footer>\n" +
         Paragraph("Made by " + EscapeHtml(CreatedBy()) + ".") +
         "</footer>\n<script type=\"application/json\" id=\"review-data\">" + JsonForScript(review) + "</script>\n" +
         ViewerHtml(index, parts, {"page_tools.js", "review.js"}) + "</body>\n</html>\n";
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
