#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/motion.h"
#include "core/motion/operations.h"
#include "core/skin/skin.h"
#include "core/store/dataset_clips.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/page_files.h"
#include "report/stages.h"
#include "report/survey.h"
#include "report/viewer_data.h"

namespace mocurate {
namespace {

constexpr FrameRate kHighestRate{30, 1};  ///< keeps pages small
constexpr double kShortQuestion = 1.0;    ///< seconds
constexpr double kShownPart = 0.85;       ///< of the shortest motion of a question
constexpr double kMostBytes = 64e6;       ///< of a page
/// Clips of each question, in the order of the page.
using ShownClips = std::vector<std::vector<Clip>>;

/// One self-contained page, which asks one question at a time and saves answers_PARTICIPANT.json. Of the key it has the
/// ids and labels of the questions alone: no name of a source or clip. `body`: a skin of all motions, or null.
Expected<std::string> MakeSurveyPage(const SurveyKey& key, const ShownClips& shown, const Skin* body) {
  const std::string survey = SurveyId(key);
  nlohmann::json page = {{"survey", survey}, {"kind", Name(key.kind)}, {"questions", nlohmann::json::array()}};
  std::vector<std::string> parts;
  ViewerData data([&](int, const std::string& bytes) {
    parts.push_back(Base64(bytes));
    return Status();
  });
  int skin = -1;
  if (body != nullptr) {
    const auto added = data.AddSkin(*body, *shown.front().front().motion->skeleton);
    if (!added) return Forward(added);
    skin = *added;
  }
  for (std::size_t q = 0; q < key.questions.size(); ++q) {
    nlohmann::json motions = nlohmann::json::array();
    for (const Clip& clip : shown[q]) {
      Clip unnamed;  // without what only some sources have
      unnamed.motion = clip.motion;
      unnamed.rate = clip.rate;
      unnamed.motion->state.clear();
      unnamed.motion->position_cov.clear();
      unnamed.motion->contact.clear();
      const Vector3d first = clip.motion->joints.at(0, 0);
      Transform({Quaterniond::Identity(), Vector3d(-first.x(), 0.0, -first.z())}, unnamed);
      motions.push_back(data.clips());
      ViewedClip viewed{unnamed};
      viewed.skin = skin;
      if (Status added = data.Add(0, viewed); !added) return Forward(added);
    }
    page["questions"].push_back(
        {{"id", key.questions[q].id}, {"label", key.questions[q].label}, {"motions", std::move(motions)}});
  }
  if (Status finished = data.Finish(); !finished) return Forward(finished);
  std::vector<std::string_view> scripts = {"data.js", "player.js", "drawn.js", "page_tools.js", "survey.js"};
  if (body != nullptr) scripts.insert(scripts.begin(), {"three.min.js", "figures.js", "stages.js"});
  return PageHead("Survey", PageStyles({"review.css", "survey.css"})) + "<body>\n" +
         std::string(PageFile("survey.html")) + "<template id=\"player\">" + PlayerHtml("this motion") +
         "</template>\n<footer>\n" +
         Paragraph("Survey " + EscapeHtml(survey) + ", made by " + EscapeHtml(CreatedBy()) + ".") +
         "</footer>\n<script type=\"application/json\" id=\"survey-data\">" + JsonForScript(page) + "</script>\n" +
         MotionsHtml(data.Index(), parts, scripts) + "</body>\n</html>\n";
}

/// A file of motions, and the index of each clip in it.
struct OpenSource {
  DatasetClips clips;
  std::map<std::string, std::size_t> row_of;  ///< by id
};

Expected<OpenSource> OpenSourceOf(const StageInput& input) {
  auto clips = DatasetClips::Open(input.path, DatasetClips::Check::kHashes);
  if (!clips) return Forward(clips);
  OpenSource open{std::move(*clips), {}};
  for (std::size_t row = 0; row < open.clips.size(); ++row) open.row_of[open.clips.Id(row)] = row;
  return open;
}

/// Reads every clip that the key shows. `posed`: each must have rotations, of one skeleton.
Expected<ShownClips> ReadShown(const SurveyKey& key, const std::map<std::string, OpenSource>& sources, bool posed) {
  ShownClips clips;
  for (const SurveyQuestion& question : key.questions) {
    clips.emplace_back();
    for (const ShownMotion& shown : question.shown) {
      const OpenSource& source = sources.at(shown.source);
      auto clip = source.clips.Read(source.row_of.at(shown.clip));
      if (!clip) return Forward(clip);
      const std::string where = shown.source + ": " + shown.clip;
      if (!clip->motion || clip->motion->frame_count() < 2) {
        return Fail(ErrorCode::kInconsistent, "the clip has no motion of two frames or more", where,
                    "remove it: `mocurate dataset subset --where 'frames >= 2'`");
      }
      if (posed && clip->motion->joints_only()) {
        return Fail(ErrorCode::kUnsupported, "the motion has no rotations to pose a body with", where,
                    "fit it first: mocurate fit FILE --skeleton smpl24; or draw bones: --figure bones");
      }
      clips.back().push_back(std::move(*clip));
      const Skeleton &own = *clips.back().back().motion->skeleton, &first = *clips.front().front().motion->skeleton;
      if (!posed || SameTree(own, first)) continue;
      return Fail(ErrorCode::kInconsistent,
                  "its skeleton '" + own.name + "' has other joints than '" + first.name +
                      "' of other motions: one body cannot show both",
                  where, "fit all with one: mocurate fit FILE --skeleton smpl24; or draw bones: --figure bones");
    }
  }
  return clips;
}

/// All at their lowest rate, and those of a question for the same time, a little less than the shortest lasts: neither
/// may reveal a source. Each is cut at a random place, because some sources begin at rest.
Status MakeAlike(const SurveyOptions& options, const SurveyKey& key, ShownClips& shown) {
  FrameRate lowest = kHighestRate;
  for (const std::vector<Clip>& clips : shown) {
    for (const Clip& clip : clips) {
      if (clip.motion->rate.hz() < lowest.hz()) lowest = clip.motion->rate;
    }
  }
  for (std::size_t q = 0; q < shown.size(); ++q) {
    int frames = std::max(2, static_cast<int>(std::floor(options.seconds * lowest.hz() + 1e-9)));
    int shortest = std::numeric_limits<int>::max();
    for (Clip& clip : shown[q]) {
      clip = Resample(clip, lowest);
      shortest = std::min(shortest, clip.motion->frame_count());
    }
    frames = std::min(frames, std::max(2, static_cast<int>(kShownPart * shortest)));
    for (std::size_t i = 0; i < shown[q].size(); ++i) {
      const ShownMotion& motion = key.questions[q].shown[i];
      Random random(static_cast<std::uint64_t>(options.seed), "survey window", motion.source + "\n" + motion.clip);
      const auto spare = static_cast<std::uint64_t>(shown[q][i].motion->frame_count() - frames);
      const int begin = static_cast<int>(random.Below(spare + 1));
      auto cut = Cut(shown[q][i], begin, begin + frames);
      if (!cut) return Forward(cut);
      shown[q][i] = std::move(*cut);
    }
  }
  return {};
}

/// Problems of a survey: cues that may reveal the sources although the page names none, and meaningless questions.
nlohmann::json NotesOf(const ShownClips& shown, const SurveyKey& key) {
  const Skeleton& skeleton = *shown.front().front().motion->skeleton;
  long long same = 0, brief = 0, unlike = 0;
  for (std::size_t q = 0; q < shown.size(); ++q) {
    std::set<std::string> motions;
    for (std::size_t i = 0; i < shown[q].size(); ++i) {
      if (!SameTree(*shown[q][i].motion->skeleton, skeleton)) ++unlike;
      motions.insert(key.questions[q].shown[i].fingerprint);
    }
    if (motions.size() < shown[q].size()) ++same;
    if (shown[q].front().motion->duration() < kShortQuestion) ++brief;
  }
  nlohmann::json notes = nlohmann::json::array();
  if (unlike > 0) {
    notes.push_back(
        "different skeletons are shown: their bones can reveal the sources; export or generate all "
        "with one skeleton");
  }
  if (same > 0) {
    notes.push_back(Counted(same, "question") +
                    " of the survey shows one motion twice: two sources share motions; use different files");
  }
  if (brief > 0) {
    notes.push_back(Counted(brief, "question") +
                    " of the survey shows less than a second: all motions of a question last as long as its shortest; "
                    "remove short motions: `mocurate dataset subset`");
  }
  return notes;
}

}  // namespace

Expected<StageOutcome> SurveyStage(const StageRequest& request) {
  const auto options = OptionsFromJson<SurveyOptions>(request.options, "survey");
  if (!options) return Forward(options);
  std::map<std::string, OpenSource> open;
  std::vector<SurveySource> sources;
  for (const StageInput& input : request.inputs) {
    if (input.role != "motions") continue;
    auto opened = OpenSourceOf(input);
    if (!opened) return Forward(opened);
    SurveySource source{input.name, {}};
    for (std::size_t row = 0; row < opened->clips.size(); ++row) {
      source.motions.push_back({opened->clips.Id(row), opened->clips.Label(row)});
    }
    open.emplace(input.name, std::move(*opened));
    sources.push_back(std::move(source));
  }
  auto key = DrawSurvey(*options, sources);
  if (!key) return Forward(key);
  auto shown = ReadShown(*key, open, FindInput(request, "body") != nullptr);
  if (!shown) return Forward(shown);
  if (Status alike = MakeAlike(*options, *key, *shown); !alike) return Forward(alike);
  std::size_t motions = 0;
  for (std::size_t q = 0; q < shown->size(); ++q) {
    for (std::size_t i = 0; i < (*shown)[q].size(); ++i, ++motions) {
      key->questions[q].shown[i].fingerprint = MotionFingerprint(*(*shown)[q][i].motion);
    }
  }
  std::optional<Skin> body;
  if (const StageInput* input = FindInput(request, "body")) {
    auto read = ReadSkin(input->path, *shown->front().front().motion->skeleton);
    if (!read) return Forward(read);
    body = std::move(*read);
  }
  const auto page = MakeSurveyPage(*key, *shown, body ? &*body : nullptr);
  if (!page) return Forward(page);
  if (static_cast<double>(page->size()) > kMostBytes) {
    return Fail(ErrorCode::kUsage,
                RoundedText(static_cast<double>(page->size()) / 1e6, 3) + " MB; a page has at most 64 MB",
                "--questions", "ask fewer questions, or set --seconds to less");
  }
  if (Status written = WriteFile(request.output, *page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {
      {"bytes", page->size()}, {"motions", motions}, {"notes", NotesOf(*shown, *key)}, {"key", KeyToJson(*key)}};
  return outcome;
}

}  // namespace mocurate
