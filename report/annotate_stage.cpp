#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/formats/span_table.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/store/dataset_clips.h"
#include "report/annotate_page.h"
#include "report/html.h"
#include "report/stages.h"
#include "report/viewer_data.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostSpeeds = 6000;     ///< of one clip's curve
constexpr double kMostPosesPerSecond = 15.0;  ///< in players
constexpr const char* kProposed = "proposed";

/// By id or name of the recording, as in the session.
using SessionSpans = std::map<std::string, std::vector<ListedSpan>>;

Expected<SessionSpans> ReadSession(const StageInput& input) {
  const auto text = ReadFile(input.path);
  if (!text) return Forward(text);
  auto listed = ParseSpanTable(*text, input.name);
  if (!listed) return Forward(listed);
  SessionSpans spans;
  for (ListedSpan& span : *listed) spans[RecordingOf(span.clip)].push_back(std::move(span));
  return spans;
}

/// Rows of the clips to show: the chosen ones, else those without a label, or all. Error kUsage for an unknown name.
Expected<std::vector<std::size_t>> ChooseRows(const DatasetClips& clips, const AnnotateOptions& options,
                                              const std::string& dataset) {
  std::vector<std::size_t> rows;
  std::set<std::string> found;
  for (std::size_t row = 0; row < clips.size(); ++row) {
    const std::string &id = clips.Id(row), recording = RecordingOf(id);
    bool wanted = options.clips.empty() && (options.all || clips.Label(row).empty());
    for (const std::string& name : options.clips) {
      if (!EndsWith(id, name) && !EndsWith(recording, name)) continue;
      found.insert(name);
      wanted = true;
    }
    if (wanted) rows.push_back(row);
  }
  for (const std::string& name : options.clips) {
    if (found.count(name) != 0) continue;
    return Fail(ErrorCode::kUsage, "no clip is called '" + name + "'", dataset,
                clips.size() == 0 ? "the dataset has no clips" : "e.g. --clip '" + clips.Id(0) + "'");
  }
  if (rows.empty()) {
    return Fail(ErrorCode::kInconsistent,
                clips.size() == 0 ? "the dataset has no clips" : "every clip has a label already", dataset,
                clips.size() == 0 ? "curation_log.jsonl of its run lists why each is missing"
                                  : "show them with --all, or choose some with --clip");
  }
  return rows;
}

AnnotateCard CardOf(const Clip& clip) {
  const Motion& motion = *clip.motion;
  AnnotateCard card;
  card.clip = clip.id();
  card.recording = RecordingOf(card.clip);
  card.person = clip.identity.person;
  card.label = clip.label;
  card.frames = motion.frame_count();
  card.hz = motion.rate.hz();
  card.begin_s = BeginInRecording(clip);
  card.recorded_hz = RecordedRate(clip).hz();
  card.speeds = PackSpeeds(FastestJointSpeeds(motion), kMostSpeeds);
  card.speeds.fastest = std::round(1e3 * card.speeds.fastest) / 1e3;
  for (const Segment& segment : clip.segments) {
    AnnotatedSpan span{card.begin_s + segment.begin_s, card.begin_s + segment.end_s, segment.label, "",
                       segment.origin == kProposed};
    if (!segment.category.empty()) {
      span.label = segment.category;
      span.fine_label = segment.label;
    }
    card.spans.push_back(std::move(span));
  }
  return card;
}

/// Poses a second that are shown: fifteen, or fewer where all would take more than `most` bytes.
double ShownRate(const Dataset& outline, const std::vector<std::size_t>& rows, double most) {
  double bytes = 0.0;
  for (const std::size_t row : rows) {
    const Motion& motion = *outline.clips[row].motion;
    bytes += std::min(motion.rate.hz(), kMostPosesPerSecond) * motion.duration() * (12.0 + 6.0 * motion.joint_count());
  }
  return kMostPosesPerSecond * std::min(1.0, most / std::max(1.0, bytes));
}

double Overlap(const AnnotateCard& card, double begin_s, double end_s) {
  return std::min(end_s, card.begin_s + card.frames / card.hz) - std::max(begin_s, card.begin_s);
}

/// The card that shows most of a span; null when none shows any.
AnnotateCard* CardOfSpan(const std::vector<AnnotateCard*>& cards, double begin_s, double end_s) {
  AnnotateCard* best = nullptr;
  for (AnnotateCard* card : cards) {
    const double overlap = Overlap(*card, begin_s, end_s);
    if (overlap > 0.0 && (best == nullptr || overlap > Overlap(*best, begin_s, end_s))) best = card;
  }
  return best;
}

/// Result of assigning the spans of an earlier session.
struct PlacedSession {
  std::size_t known = 0;     ///< recordings that the dataset has
  std::size_t excluded = 0;  ///< spans in frames of recordings that no card shows, whose rate is unknown
};

/// Assigns each span of the session to the card of its recording that shows most of it; the others are stored
/// separately.
PlacedSession PlaceSession(const SessionSpans& session, const std::set<std::string>& recordings,
                           AnnotatePageInput& input) {
  PlacedSession placed;
  for (const auto& [name, spans] : session) {
    const auto is_named = [&name = name](const std::string& recording) {
      return recording == name || EndsWith(recording, "/" + name);
    };
    if (std::any_of(recordings.begin(), recordings.end(), is_named)) ++placed.known;
    std::vector<AnnotateCard*> cards;
    for (AnnotateCard& card : input.cards) {
      if (is_named(card.recording)) cards.push_back(&card);
    }
    for (AnnotateCard* card : cards) {
      card->spans.clear();
      card->done = true;
    }
    for (const ListedSpan& span : spans) {
      if (span.in_frames && cards.empty()) {
        ++placed.excluded;
        continue;
      }
      const double unit_s = span.in_frames ? 1.0 / cards.front()->recorded_hz : 1.0;
      const double begin_s = unit_s * span.begin, end_s = unit_s * span.end;
      if (AnnotateCard* card = CardOfSpan(cards, begin_s, end_s)) {
        card->spans.push_back({begin_s, end_s, span.label, span.fine_label, false});
        continue;
      }
      input.rest.push_back({{"clip", span.clip}, {"begin_s", begin_s}, {"end_s", end_s}, {"label", span.label}});
      if (!span.fine_label.empty()) input.rest.back()["fine_label"] = span.fine_label;
    }
  }
  return placed;
}

/// In the order of time, in milliseconds; the key follows.
void FinishCard(const std::string& fingerprint, AnnotateCard& card) {
  std::sort(card.spans.begin(), card.spans.end(), [](const AnnotatedSpan& a, const AnnotatedSpan& b) {
    return std::tie(a.begin_s, a.end_s, a.label) < std::tie(b.begin_s, b.end_s, b.label);
  });
  Sha256 hash;
  hash.Add(card.clip + "\n" + fingerprint);
  for (AnnotatedSpan& span : card.spans) {
    span.begin_s = std::round(1e3 * span.begin_s) / 1e3;
    span.end_s = std::round(1e3 * span.end_s) / 1e3;
    hash.Add("\n" + FormatDouble(span.begin_s) + " " + FormatDouble(span.end_s) + (span.proposed ? " ? " : " ") +
             span.label + "\n" + span.fine_label);
  }
  card.key = hash.Hex().substr(0, 16);
}

/// The given labels and those of spans, in their order.
void AddLabelsOfSpans(AnnotatePageInput& input) {
  std::set<std::string> known(input.labels.begin(), input.labels.end());
  for (const AnnotateCard& card : input.cards) {
    for (const AnnotatedSpan& span : card.spans) {
      if (!span.label.empty() && known.insert(span.label).second) input.labels.push_back(span.label);
    }
  }
}

}  // namespace

Expected<StageOutcome> AnnotateStage(const StageRequest& request) {
  const auto options = OptionsFromJson<AnnotateOptions>(request.options, "annotate");
  if (!options) return Forward(options);
  AnnotatePageInput input;
  const StageInput *dataset = FindInput(request, "dataset"), *listed = FindInput(request, "spans");
  if (dataset == nullptr) return Fail(ErrorCode::kInternal, "the stage has no dataset", request.item);
  const auto clips = DatasetClips::Open(dataset->path, DatasetClips::Check::kHashes);
  if (!clips) return Forward(clips);
  input.dataset = dataset->name;
  const auto session = listed == nullptr ? Expected<SessionSpans>() : ReadSession(*listed);
  if (!session) return Forward(session);
  input.labels = options->labels.empty() ? clips->labels() : options->labels;
  const auto rows = ChooseRows(*clips, *options, input.dataset);
  if (!rows) return Forward(rows);
  const auto outline = clips->Outline();
  if (!outline) return Forward(outline);
  const double shown_rate = ShownRate(*outline, *rows, options->poses_bytes);
  std::vector<std::string> fingerprints;
  ViewerData data([&](int, const std::string& bytes) {
    input.parts.push_back(Base64(bytes));
    return Status();
  });
  for (const std::size_t row : *rows) {
    const auto clip = clips->Read(row);
    if (!clip) return Forward(clip);
    input.cards.push_back(CardOf(*clip));
    const int step = std::max(1, static_cast<int>(std::ceil(clip->rate.hz() / shown_rate - 1e-9)));
    input.cards.back().step = step;
    fingerprints.push_back(MotionFingerprint(*clip->motion));
    const FrameRate rate{clip->rate.numerator, clip->rate.denominator * step};
    Clip shown;
    shown.motion = MakeJointsOnly(clip->motion->skeleton, clip->rate, clip->motion->joints);
    shown.rate = clip->rate;
    if (step > 1) shown = Resample(shown, rate);
    if (Status added = data.Add(0, {shown}); !added) return Forward(added);
  }
  if (Status finished = data.Finish(); !finished) return Forward(finished);
  input.motions = data.Index();
  std::set<std::string> recordings;
  for (std::size_t row = 0; row < clips->size(); ++row) recordings.insert(RecordingOf(clips->Id(row)));
  const PlacedSession placed = PlaceSession(*session, recordings, input);
  if (!session->empty() && placed.known == 0) {
    return Fail(ErrorCode::kInconsistent,
                "none of its " + Counted(static_cast<long long>(session->size()), "recording") + " is in the dataset",
                request.item, "use the spans of this dataset; these are of another: '" + session->begin()->first + "'");
  }
  std::size_t spans = 0;
  double least = kMostPosesPerSecond;
  for (std::size_t i = 0; i < input.cards.size(); ++i) {
    FinishCard(fingerprints[i], input.cards[i]);
    spans += input.cards[i].spans.size();
    least = std::min(least, input.cards[i].hz / input.cards[i].step);
  }
  AddLabelsOfSpans(input);
  const std::string page = MakeAnnotatePage(input);
  if (Status written = WriteFile(request.output, page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"bytes", page.size()},
                     {"clips", input.cards.size()},
                     {"spans", spans},
                     {"not_shown", input.rest.size()},
                     {"poses_per_second", least},
                     {"labels", input.labels.size()},
                     {"unknown", session->size() - placed.known},
                     {"excluded", placed.excluded}};
  return outcome;
}

}  // namespace mocurate
