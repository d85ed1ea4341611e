#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>

#include "core/base/file.h"
#include "core/base/parallel.h"
#include "core/base/text.h"
#include "core/motion/action_parts.h"
#include "core/motion/gaps.h"
#include "core/motion/limbs.h"
#include "core/motion/operations.h"
#include "core/pipeline/worker.h"
#include "core/quality/activity.h"
#include "core/quality/contacts.h"
#include "core/quality/measures.h"
#include "core/quality/padding.h"
#include "core/store/feature_file.h"
#include "core/store/store.h"
#include "eval/features/feature_extractor.h"
#include "eval/features/yardsticks.h"
#include "eval/options.h"
#include "eval/protocols/draws.h"
#include "eval/stages.h"

namespace mocurate {
namespace {

constexpr int kMeasuredAtOnce = 64;     // motions of a thread
constexpr double kFarFromOrigin = 0.5;  // metres; published decoders start their roots within millimetres

/// Motions of one pass with their classes, by the extractor's indices.
struct PassMotions {
  std::vector<const Motion*> motions;
  std::vector<int> labels;
  std::vector<std::string> clips;
};

/// Label of a clip, else its fine label -> class of the extractor; -1 for clips without a label.
Expected<std::vector<int>> ClassesOf(const Dataset& dataset, const std::vector<std::string>& classes) {
  std::vector<int> result;
  for (const Clip& clip : dataset.clips) {
    std::optional<int> found = ClassOf(classes, clip.label);
    if (!found && !clip.fine_label.empty()) found = ClassOf(classes, clip.fine_label);
    result.push_back(found.value_or(-1));
    if (clip.label.empty() || found) continue;
    return Fail(ErrorCode::kInconsistent, "label '" + clip.label + "' is not a class of the extractor", clip.id(),
                NearestOfAll(clip.label, classes, "use its classes as labels; they are: "));
  }
  return result;
}

/// Measures of each motion that need no network; appends them to `quality`.
void AddQuality(const std::vector<const Motion*>& motions, const FeaturesOptions& options, int threads,
                std::map<std::string, std::vector<double>>& quality) {
  std::vector<std::map<std::string, double>> of_motion(motions.size());
  ParallelFor(static_cast<int>(motions.size()), kMeasuredAtOnce, threads, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const Motion& motion = *motions[i];
      const MotionMeasures measures = MeasureMotion(motion);
      const auto activity = ActivityOf(motion);
      of_motion[i] = {{"foot_skate", measures.foot_skate},
                      {"jerk", measures.jerk},
                      {"bone_spread", 1e-3 * measures.bone_spread_mm},
                      {"frozen_share", static_cast<double>(measures.frozen_frames) / std::max(1, measures.frames - 1)},
                      {"floor_penetration", FloorPenetration(motion).value_or(kNotMeasured)},
                      {"limit_violations", LimitViolations(motion).value_or(kNotMeasured)},
                      {"movement", activity ? activity->movement : kNotMeasured}};
      if (options.clip_part == ClipPart::kTransition) {
        of_motion[i]["peak_jerk"] = activity ? activity->peak_jerk : kNotMeasured;
        of_motion[i]["jerk_area"] = activity ? activity->jerk_area : kNotMeasured;
      }
      if (options.measures != MeasureSet::kMBench) continue;
      const auto mbench = MBenchOf(motion);
      const auto put = [&](const char* name, double MBenchMeasures::*value) {
        of_motion[i][name] = mbench ? (*mbench).*value : kNotMeasured;
      };
      put("mbench_slide", &MBenchMeasures::slide);
      put("mbench_float", &MBenchMeasures::floating);
      put("mbench_jitter", &MBenchMeasures::jitter);
      put("mbench_dynamic", &MBenchMeasures::dynamic);
      put("mbench_penetration", &MBenchMeasures::penetration);
    }
  });
  for (const auto& values : of_motion) {
    for (const auto& [name, value] : values) quality[name].push_back(value);
  }
}

/// Whether the motion starts facing -z: in the first frame the left hip lies at smaller x than the right one, by more
/// than half of their distance.
bool FacesAway(const Motion& motion) {
  const Limbs limbs = LimbsOf(*motion.skeleton);
  if (motion.frame_count() == 0 || limbs.leg[0].root < 0 || limbs.leg[1].root < 0) return false;
  const Vector3d across = motion.joints.at(0, limbs.leg[0].root) - motion.joints.at(0, limbs.leg[1].root);
  return across.x() < -0.5 * across.norm();
}

/// Zeros at the end of a dataset's motions, cut or counted; the summary states how many. Motions that are nothing but
/// zeros are skipped, where these are cut.
Status TreatZeros(PaddingAction padding, Dataset& dataset, std::set<int>& skipped, nlohmann::json& summary) {
  if (padding == PaddingAction::kNone) return {};
  long long motions = 0, frames = 0, all_zero = 0;
  std::string first;
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    Clip& clip = dataset.clips[row];
    const int all = clip.motion->frame_count(), left = FramesWithoutPadding(*clip.motion, false);
    if (left == all || skipped.count(static_cast<int>(row)) > 0) continue;
    if (left == 0 && padding == PaddingAction::kCut) {
      skipped.insert(static_cast<int>(row));
      ++all_zero;
      continue;
    }
    if (motions++ == 0) first = clip.id();
    frames += all - left;
    if (padding == PaddingAction::kKeep) continue;
    Expected<Clip> cut = Cut(clip, 0, left);
    if (!cut) return Forward(cut);
    cut->identity = clip.identity;  // motions are known by it
    clip = std::move(*cut);
  }
  summary["padded"] = motions;
  summary["padding_frames"] = frames;
  summary["first_padded"] = first;
  summary["all_zero"] = all_zero;
  return {};
}

/// Reads motions, or requests them from a generator, and runs the extractor over each pass.
class FeaturesRun {
 public:
  FeaturesRun(const FeaturesOptions& options, const Extractor& extractor, int threads)
      : options_(options), extractor_(extractor), threads_(threads) {}

  /// `skipped`: rows that are no motions.
  Status OfDataset(const Dataset& dataset, const std::set<int>& skipped) {
    auto rows = RowsOfPart(dataset, options_.part, options_.split);
    if (!rows) return Forward(rows);
    const auto skips = [&](int row) { return skipped.count(row) > 0; };
    rows->erase(std::remove_if(rows->begin(), rows->end(), skips), rows->end());
    if (rows->empty()) {
      return Fail(ErrorCode::kInconsistent, "no motion is left: all frames are zero, or inferred", options_.purpose,
                  "give other motions, or score them as they are: --padding keep");
    }
    const auto classes = ClassesOf(dataset, set_.classes = extractor_.rules.options.classes);
    if (!classes) return Forward(classes);
    std::vector<Motion> parts;  // of clips, where a part is scored
    std::vector<const Motion*> all;
    if (options_.clip_part != ClipPart::kWhole) {
      for (const int row : *rows) {
        const Clip& clip = dataset.clips[static_cast<std::size_t>(row)];
        const bool alone = options_.generated && options_.clip_part == ClipPart::kAction && clip.segments.empty();
        auto part = TakePart(clip, alone ? ClipPart::kWhole : options_.clip_part);
        if (!part) return Forward(part);
        parts.push_back(std::move(*part));
      }
    }
    for (std::size_t i = 0; i < rows->size(); ++i) {
      const Clip& clip = dataset.clips[static_cast<std::size_t>((*rows)[i])];
      all.push_back(parts.empty() ? &*clip.motion : &parts[i]);
    }
    if (Status frame = options_.known_frame ? Status() : CheckFrameOfSet(all); !frame) return frame;
    std::vector<int> labels;
    for (const int row : *rows) labels.push_back((*classes)[static_cast<std::size_t>(row)]);
    std::map<std::string, std::vector<double>> quality;
    AddQuality(all, options_, threads_, quality);
    const int passes = static_cast<int>(std::max<std::int64_t>(1, options_.passes));
    for (int p = 0; p < passes; ++p) {
      const int count = options_.passes == 0 ? 0 : static_cast<int>(options_.motions);
      PassMotions pass;
      for (const int at : options_.per_label > 0
                              ? DrawPerLabel(labels, static_cast<int>(options_.per_label), seed(), p, options_.purpose)
                              : DrawPositions(static_cast<int>(rows->size()), count, options_.replacement, seed(), p,
                                              options_.purpose)) {
        const auto row = static_cast<std::size_t>((*rows)[static_cast<std::size_t>(at)]);
        pass.motions.push_back(all[static_cast<std::size_t>(at)]);
        pass.labels.push_back((*classes)[row]);
        pass.clips.push_back(dataset.clips[row].id());
        for (auto& [name, values] : quality) {
          set_.quality[name].push_back(values[static_cast<std::size_t>(at)]);
        }
      }
      if (Status added = Append(pass, p, passes); !added) return added;
    }
    return {};
  }

  Status OfYardstick(const Dataset& dataset, const std::set<int>& skipped) {
    const auto yardsticks = Yardsticks::Make(options_.yardstick, dataset, skipped, options_);
    if (!yardsticks) return Forward(yardsticks);
    std::vector<std::string> clips;  // of the last answers
    const AnswerRequests answer = [&](const std::vector<MotionRequest>& requests) -> Expected<std::vector<Motion>> {
      clips.clear();
      std::vector<Motion> motions;
      for (const MotionRequest& request : requests) {
        auto answered = yardsticks->Of(request);
        if (!answered) return Forward(answered);
        clips.push_back(std::move(answered->clip));
        motions.push_back(std::move(answered->motion));
      }
      return motions;
    };
    return OfGenerator(dataset, answer, &clips);
  }

  /// `clips`: ids of the motions that were answered last; null: each motion is one of its own.
  Status OfGenerator(const Dataset& dataset, const AnswerRequests& answer,
                     const std::vector<std::string>* clips = nullptr) {
    const auto rows = RowsOfPart(dataset, options_.part, options_.split);
    if (!rows) return Forward(rows);
    std::vector<int> class_of;
    for (const std::string& label : dataset.labels) {
      class_of.push_back(ClassOf(extractor_.rules.options.classes, label).value_or(-1));
    }
    const int passes = static_cast<int>(std::max<std::int64_t>(1, options_.passes));
    for (int p = 0; p < passes; ++p) {
      const auto drawn = RequestsOf(dataset, *rows, p);
      if (!drawn) return Forward(drawn);
      const std::vector<MotionRequest>& requests = *drawn;
      auto motions = answer(requests);
      if (!motions) return Forward(motions);
      if (motions->size() != requests.size()) {
        return Fail(ErrorCode::kInconsistent,
                    std::to_string(motions->size()) + " motions were generated for " + std::to_string(requests.size()) +
                        " requests",
                    "generator");
      }
      PassMotions pass;
      for (std::size_t i = 0; i < motions->size(); ++i) {
        const MotionRequest& request = requests[i];
        const bool scripted = options_.script != ScriptDraw::kNone;
        const int step = static_cast<int>(options_.step) - (options_.script == ScriptDraw::kChain ? 1 : 0);
        if (scripted && (*motions)[i].frame_count() != request.answered_frames()) {
          return Fail(ErrorCode::kInconsistent,
                      Counted((*motions)[i].frame_count(), "frame") + " answer a request of " +
                          std::to_string(request.answered_frames()),
                      "generator, request " + std::to_string(i));
        }
        if (scripted) (*motions)[i] = StepOfAnswer((*motions)[i], request, step, options_.clip_part);
        if (options_.filter.on()) (*motions)[i] = OneEuroFiltered((*motions)[i], options_.filter);
        const int label =
            scripted && step > 0 ? request.script[static_cast<std::size_t>(step - 1)].label : request.label;
        pass.motions.push_back(&(*motions)[i]);
        pass.labels.push_back(class_of[static_cast<std::size_t>(label)]);
        pass.clips.push_back(clips != nullptr ? (*clips)[i]
                                              : "generated/" + std::to_string(p) + "/" + std::to_string(i));
      }
      if (p == 0) AddQuality(pass.motions, options_, threads_, set_.quality);
      if (Status added = Append(pass, p, passes); !added) return added;
    }
    return {};
  }

  /// Measures of generated motions come from the first pass.
  FeatureSet& set() {
    for (auto& [name, values] : set_.quality) values.resize(static_cast<std::size_t>(set_.count()), kNotMeasured);
    return set_;
  }

 private:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(options_.seed); }

  Expected<std::vector<MotionRequest>> RequestsOf(const Dataset& dataset, const std::vector<int>& rows,
                                                  int pass) const {
    const auto training = TrainingRows(dataset, options_.split);
    if (!training) return Forward(training);
    if (options_.script != ScriptDraw::kNone) return DrawScripts(dataset, rows, *training, options_, pass);
    return DrawRequests(dataset, rows, *training, options_, extractor_.rules.frames(), pass);
  }

  Status Append(const PassMotions& motions, int pass, int passes) {
    if (StopRequested()) {
      return Fail(ErrorCode::kInterrupted, "features stopped on request", options_.purpose, "run again");
    }
    PassOptions how;
    if (options_.generated) how.yaw_rad = extractor_.rules.options.yaw_rad;
    how.root = options_.generated ? extractor_.rules.options.generated_root : extractor_.rules.options.real_root;
    how.start = options_.crop == CropDraw::kFirst      ? CropStart::kFirst
                : options_.crop == CropDraw::kReleased ? CropStart::kReleased
                                                       : CropStart::kAny;
    how.hidden = options_.hidden == HiddenDraw::kNormal ? InitialHidden::kNormal : InitialHidden::kZero;
    how.seed = Random(seed(), "pass of " + options_.purpose, std::to_string(pass)).Next();
    how.threads = threads_;
    Status added = AppendFeatures(extractor_, motions.motions, motions.labels, motions.clips, how, set_);
    if (added) ReportProgress((pass + 1.0) / passes, "pass " + std::to_string(pass + 1));
    return added;
  }

  const FeaturesOptions& options_;
  const Extractor& extractor_;
  int threads_;
  FeatureSet set_;
};

/// Clips that lost frames without an observation.
struct InferredCut {
  int clips = 0;
  int frames = 0;
  int all = 0;  ///< clips of nothing else
};

/// Of each motion with inferred frames the longest stretch without them is scored; one of nothing else is skipped.
Expected<InferredCut> CutInferred(Dataset& dataset, std::set<int>& skipped) {
  InferredCut lost;
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    Clip& clip = dataset.clips[row];
    if (IsAllInferred(*clip.motion)) {
      skipped.insert(static_cast<int>(row));
      ++lost.all;
      ++lost.clips;
      lost.frames += clip.motion->frame_count();
      continue;
    }
    Expected<std::optional<Clip>> shorter = WithoutInferred(clip);
    if (!shorter) return Forward(shorter);
    if (!*shorter) continue;
    ++lost.clips;
    lost.frames += clip.motion->frame_count() - (*shorter)->motion->frame_count();
    (*shorter)->identity = clip.identity;  // motions are known by it
    clip = **std::move(shorter);
  }
  return lost;
}

Expected<StageOutcome> Features(const OpenGenerator& open_generator, const StageRequest& request) {
  const auto options = OptionsFromJson<FeaturesOptions>(request.options, "features");
  if (!options) return Forward(options);
  const StageInput* weights = FindInput(request, "weights");
  const StageInput* motions = FindInput(request, "motions");
  if (weights == nullptr || motions == nullptr) {
    return Fail(ErrorCode::kInternal, "the stage features needs the roles 'weights' and 'motions'", request.item);
  }
  auto extractor = Extractor::Open(options->extractor, weights->path);
  if (!extractor) return Forward(extractor);
  if (options->frames > 0) extractor->rules.options.frames = options->frames;
  auto dataset = ReadDataset(motions->path);
  if (!dataset) return Forward(dataset);
  std::set<int> skipped;
  const Expected<InferredCut> inferred = CutInferred(*dataset, skipped);
  if (!inferred) return Forward(inferred);
  nlohmann::json padding = nlohmann::json::object();
  if (Status treated = TreatZeros(options->padding, *dataset, skipped, padding); !treated) return Forward(treated);
  FeaturesRun run(*options, *extractor, request.threads);
  Status done;
  if (const StageInput* generator = FindInput(request, "generator")) {
    GeneratorFiles files{generator->path, {}, {}, options->align};
    if (const StageInput* first = FindInput(request, "first")) files.first = first->path;
    if (const StageInput* fill = FindInput(request, "fill")) files.fill = fill->path;
    const auto answer = open_generator(files, request.threads);
    if (!answer) return Forward(answer);
    done = run.OfGenerator(*dataset, *answer);
  } else if (options->yardstick != Yardstick::kNone) {
    done = run.OfYardstick(*dataset, skipped);
  } else {
    done = run.OfDataset(*dataset, skipped);
  }
  if (!done) return Forward(done);
  run.set().about = nlohmann::json{{"extractor", extractor->rules.options.name},
                                   {"weights", weights->sha256},
                                   {"motions", motions->sha256},
                                   {"purpose", options->purpose}}
                        .dump();
  if (Status written = WriteFeatures(run.set(), request.output); !written) return Forward(written);
  StageOutcome outcome;
  const std::string& trained_on = extractor->recogniser->dataset_sha256();
  outcome.summary = {{"motions", run.set().count()},
                     {"clips", dataset->clips.size()},
                     {"passes", run.set().passes()},
                     {"classes", extractor->rules.options.classes},
                     {"unlabelled", std::count(run.set().label.begin(), run.set().label.end(), -1)},
                     {"labels_by_index", std::count_if(dataset->clips.begin(), dataset->clips.end(),
                                                       [&](const Clip& clip) {
                                                         const auto& known = extractor->rules.options.classes;
                                                         return !ClassOfName(known, clip.label) &&
                                                                ParseInteger(clip.label).has_value();
                                                       })},
                     {"frames", extractor->rules.frames()},
                     {"with_inferred", inferred->clips},
                     {"inferred_frames", inferred->frames},
                     {"all_inferred", inferred->all},
                     {"is_training_set", !trained_on.empty() && trained_on == motions->sha256}};
  outcome.summary.update(padding);
  const auto lengths = [&](auto counts) {
    return std::count_if(dataset->clips.begin(), dataset->clips.end(),
                         [&](const Clip& clip) { return counts(clip.motion->frame_count()); });
  };
  const bool window = extractor->rules.options.length == LengthRule::kCrop;
  outcome.summary["longer"] = window ? lengths([&](int n) { return n > extractor->rules.frames(); }) : 0;
  const bool pads = extractor->rules.options.padding == PaddingRule::kZerosMinusRoot;  // every motion is padded
  outcome.summary["shorter"] = window && !pads ? lengths([&](int n) { return n < extractor->rules.frames(); }) : 0;
  const double rate = extractor->rules.options.rate_hz;
  outcome.summary["rate_of_extractor"] = rate;
  outcome.summary["rotations"] = !dataset->joints_only;
  outcome.summary["no_parts"] = dataset->splits.empty();
  const bool as_given = options->generated && extractor->rules.options.generated_root == RootRule::kAsGiven;
  outcome.summary["far"] = 0;
  outcome.summary["facing_away"] = std::count_if(dataset->clips.begin(), dataset->clips.end(),
                                                 [](const Clip& clip) { return FacesAway(*clip.motion); });
  if (as_given && FindInput(request, "generator") == nullptr) {
    outcome.summary["far"] = std::count_if(dataset->clips.begin(), dataset->clips.end(), [](const Clip& clip) {
      return clip.motion->joints.at(0, 0).norm() > kFarFromOrigin;
    });
  }
  outcome.summary["other_rate"] = std::count_if(dataset->clips.begin(), dataset->clips.end(), [&](const Clip& clip) {
    return rate > 0.0 && std::abs(clip.rate.hz() - rate) > 0.01 * rate;
  });
  if (!dataset->clips.empty()) outcome.summary["rate_hz"] = dataset->clips.front().rate.hz();
  return outcome;
}

}  // namespace

StageFunction MakeFeaturesStage(OpenGenerator open_generator) {
  return [open_generator = std::move(open_generator)](const StageRequest& request) {
    return Features(open_generator, request);
  };
}

}  // namespace mocurate
