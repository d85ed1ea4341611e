#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/motion/operations.h"
#include "core/store/dataset_clips.h"
#include "report/filmstrip.h"
#include "report/survey_page.h"

namespace mocurate {
namespace {

constexpr int kMostNumbers = 400000;       ///< of one motion: 60 s at 60 Hz of 37 joints
constexpr double kUnlikeDurations = 1.05;  ///< longest over shortest motion above which length may reveal sources

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

/// Clips of a key by source and id.
using ClipsOfKey = std::map<std::pair<std::string, std::string>, Clip>;

/// Reads every clip that the key shows.
Expected<ClipsOfKey> ReadShown(const SurveyKey& key, const std::map<std::string, OpenSource>& sources) {
  ClipsOfKey clips;
  for (const SurveyQuestion& question : key.questions) {
    for (const ShownMotion& shown : question.shown) {
      const OpenSource& source = sources.at(shown.source);
      auto [at, is_new] = clips.try_emplace({shown.source, shown.clip});
      if (!is_new) continue;
      auto clip = source.clips.Read(source.row_of.at(shown.clip));
      if (!clip) return Forward(clip);
      if (!clip->motion || clip->motion->frame_count() < 2) {
        return Fail(ErrorCode::kInconsistent, "the clip has no motion of two frames or more",
                    shown.source + ": " + shown.clip, "remove it: `mocurate dataset subset --where 'frames >= 2'`");
      }
      at->second = std::move(*clip);
    }
  }
  return clips;
}

/// All at their lowest rate, and for at most `seconds`: neither may reveal a source.
Status MakeAlike(double seconds, ClipsOfKey& clips) {
  FrameRate lowest = clips.begin()->second.motion->rate;
  for (const auto& [place, clip] : clips) {
    if (clip.motion->rate.hz() < lowest.hz()) lowest = clip.motion->rate;
  }
  for (auto& [place, clip] : clips) {
    clip = Resample(clip, lowest);
    const double frames = std::floor(seconds * lowest.hz() + 1e-9);
    if (clip.motion->frame_count() <= frames) continue;
    auto cut = Cut(clip, 0, std::max(2, static_cast<int>(frames)));
    if (!cut) return Forward(cut);
    clip = std::move(*cut);
  }
  return {};
}

/// Problems of a survey: cues that may reveal the sources although the page names none, and meaningless questions.
nlohmann::json NotesOf(const ClipsOfKey& clips, const SurveyKey& key) {
  std::set<std::vector<int>> trees;
  double shortest = 1e300, longest = 0.0;
  for (const auto& [place, clip] : clips) {
    std::vector<int> parents;
    for (const Joint& joint : clip.motion->skeleton->joints) parents.push_back(joint.parent);
    trees.insert(std::move(parents));
    shortest = std::min(shortest, clip.motion->duration());
    longest = std::max(longest, clip.motion->duration());
  }
  nlohmann::json notes = nlohmann::json::array();
  if (trees.size() > 1) {
    notes.push_back(std::to_string(trees.size()) +
                    " different skeletons are shown: their bones can reveal the sources; export or generate all "
                    "with one skeleton");
  }
  if (longest > kUnlikeDurations * shortest) {
    notes.push_back("the motions last " + RoundedText(shortest, 3) + " to " + RoundedText(longest, 3) +
                    " s: their length can reveal the sources; --seconds " + RoundedText(shortest, 3) +
                    " shows all for the same time");
  }
  const auto same = std::count_if(key.questions.begin(), key.questions.end(), [](const SurveyQuestion& question) {
    return question.shown.front().fingerprint == question.shown.back().fingerprint && question.shown.size() == 2;
  });
  if (same > 0) {
    notes.push_back(Counted(same, "question") +
                    " of the survey shows one motion twice: two sources share motions; use different files");
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
  auto clips = ReadShown(*key, open);
  if (!clips) return Forward(clips);
  if (Status alike = MakeAlike(options->seconds, *clips); !alike) return Forward(alike);
  SurveyPageInput input;
  input.kind = key->kind;
  for (SurveyQuestion& question : key->questions) {
    SurveyPageQuestion asked{question.id, question.label, {}};
    for (ShownMotion& shown : question.shown) {
      const Motion& motion = *clips->at({shown.source, shown.clip}).motion;
      shown.fingerprint = MotionFingerprint(motion);
      asked.motions.push_back(PlayerData("motion", motion, nullptr, kMostNumbers));
    }
    input.questions.push_back(std::move(asked));
  }
  input.survey = SurveyId(*key);
  const std::string page = MakeSurveyPage(input);
  if (Status written = WriteFile(request.output, page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {
      {"bytes", page.size()}, {"motions", clips->size()}, {"notes", NotesOf(*clips, *key)}, {"key", KeyToJson(*key)}};
  return outcome;
}

}  // namespace mocurate
