#include "train/trainer/trainer.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>

#include "core/base/file.h"
#include "core/base/parallel.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "train/data/batches.h"
#include "train/networks/network.h"
#include "train/trainer/optimisers.h"
#include "train/trainer/values.h"

namespace mocurate {
namespace {

using torch::Tensor;

constexpr std::int64_t kHistoryRows = 2000;      // of a training of any length
constexpr std::int64_t kValidatedAtOnce = 128;   // motions
constexpr double kSmallestDeviation = 0.02;      // metres, of a standardised number
constexpr std::int64_t kRoundSteps = 1LL << 40;  // keeps the draws of two rounds apart

double ResidentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  double size = 0.0, resident = 0.0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// A step frees and allocates the same tens of megabytes: keep them in the process, with their pages mapped.
void KeepFreedMemory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

Status CheckDevice(TrainDevice device) {
  if (device == TrainDevice::kCpu || torch::cuda::is_available()) return {};
  return Fail(ErrorCode::kMissingOnHost, "this machine has no CUDA device, or this libtorch has no CUDA",
              "device: cuda", "set device: cpu");
}

/// One training: a round on the training part, and for recognisers a second one on all of it.
class Training {
 public:
  Training(const TrainingSet& set, const NetworkOptions& options, const TrainingControl& control)
      : set_(set), options_(options), control_(control), recognises_(options.recognises()) {}

  Expected<Checkpoint> Run() {
    return Guarded([this] { return Trained(); });
  }

  /// Runs a few steps of a new training, at its beginning and in its middle: a GAN's stages have different costs.
  Expected<TrainingCost> Measure() {
    return Guarded([this] { return Measured(); });
  }

 private:
  /// A CUDA device that vanishes, or whose memory runs out, ends the run: the last saved state is kept. Other errors of
  /// libtorch end this item alone.
  template <typename Work>
  auto Guarded(const Work& work) -> decltype(work()) {
    try {
      return work();
    } catch (const c10::Error& error) {
      const std::string what = error.what_without_backtrace();
      if (what.rfind("CUDA", 0) != 0) throw;
      const bool memory = what.find("out of memory") != std::string::npos;
      return Fail(
          ErrorCode::kMissingOnHost,
          "the CUDA device failed after " + Counted(state_.step, "step") + ": " + what.substr(0, what.find('\n')),
          options_.name, memory ? "choose a smaller batch" : "run again to continue from the last saved state");
    }
  }

  Expected<Checkpoint> Trained() {
    if (Status ready = Prepare(); !ready) return Forward(ready);
    if (Status fit = CheckSamples(); !fit) return Forward(fit);
    if (!control_.weights.empty()) return TakeReleasedWeights();
    if (options_.NeedsBody() && control_.skin == nullptr) {
      return Fail(ErrorCode::kInconsistent, "the loss on vertices has no body", options_.name,
                  "set body: to SMPL's file or body_cc0.h5, or vertex_weight: 0");
    }
    if (Status begun = Begin(); !begun) return Forward(begun);
    while (!ended_) {
      if (control_.stop()) return Interrupted();
      if (Status stepped = Step(); !stepped) return Forward(stepped);
      if (round_step_ == until_) {
        if (Status ended = EndRound(); !ended) return Forward(ended);
      }
      if (!ended_ && state_.step % options_.learning.save_every == 0) {
        if (Status saved = Save(); !saved) return Forward(saved);
      }
    }
    network_->Finish();
    Store();
    state_.best.clear();
    state_.finished = true;
    return std::move(state_);
  }

  Expected<TrainingCost> Measured() {
    if (Status ready = Prepare(); !ready) return Forward(ready);
    constexpr int kParts = 2, kMeasured = 5;  // 5: the critic's steps to one of the generator (Gulrajani et al. 2017)
    StartRound(0);
    TrainingCost cost;
    cost.steps = until_ * (recognises_ && options_.recogniser.refits() ? 2 : 1);
    for (const Tensor& parameter : network_->parameters()) cost.parameters += parameter.numel();
    double seconds = 0.0;
    for (int part = 0; part < kParts; ++part) {
      round_step_ = std::max(round_step_, steps_ * part / kParts);
      if (Status warm = Step(); !warm) return Forward(warm);
      const auto begin = std::chrono::steady_clock::now();
      for (int i = 0; i < kMeasured; ++i) {
        if (Status done = Step(); !done) return Forward(done);
      }
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    cost.seconds_per_step = seconds / (kParts * kMeasured);
    return cost;
  }

  Status Prepare() {
    if (Status there = CheckDevice(options_.learning.device); !there) return there;
    KeepFreedMemory();
    torch::set_num_threads(1);  // one thread per shard; the result must not depend on a thread count
    auto rows =
        SelectTrainingRows(set_, options_.data, recognises_, options_.seed(), options_.recogniser.smallest_validation);
    if (!rows) return Forward(rows);
    rows_ = std::move(*rows);
    if (recognises_ && !options_.recogniser.selects()) {  // what would be held out is learned from
      rows_.train.insert(rows_.train.end(), rows_.validation.begin(), rows_.validation.end());
      std::sort(rows_.train.begin(), rows_.train.end());
      rows_.validation.clear();
      rows_.validation_rule.clear();
    }
    return {};
  }

  /// Samples of parts are padded, never cut.
  Status CheckSamples() const {
    if (!options_.NeedsParts()) return {};
    const MacvaeOptions& macvae = options_.macvae;
    const bool reads_last = options_.kind == NetworkKind::kMacvae && !macvae.whole_previous;
    for (const int row : rows_.train) {
      const TrainingSet::Clip& clip = set_.clips[static_cast<std::size_t>(row)];
      if (*std::min_element(clip.parts.begin(), clip.parts.end()) < 1) {
        return Fail(ErrorCode::kInconsistent, "the clip is not a sample of previous action, transition and action",
                    clip.id, "make samples with canon.trim.rule: triples");
      }
      if (clip.frames > options_.data.frames) {
        return Fail(
            ErrorCode::kInconsistent,
            "the sample has " + Counted(clip.frames, "frame") + ", the network " + std::to_string(options_.data.frames),
            clip.id, "increase `frames` of the network, or decrease canon.trim.triples.most_frames");
      }
      if (reads_last && clip.parts[0] < macvae.previous_frames) {
        return Fail(ErrorCode::kInconsistent,
                    "the previous action has " + Counted(clip.parts[0], "frame") + ", the network reads the last " +
                        std::to_string(macvae.previous_frames),
                    clip.id, "decrease `previous_frames`, or increase canon.trim.triples.context");
      }
    }
    return {};
  }

  torch::Device device() const {
    return options_.learning.device == TrainDevice::kCuda ? torch::Device(torch::kCUDA) : torch::Device(torch::kCPU);
  }

  std::filesystem::path StateFile() const { return control_.scratch / "training_state.h5"; }

  void FillHeader() {
    state_.kind = OptionsToJson(options_).at("kind").get<std::string>();
    state_.options = OptionsToJson(options_);
    state_.skeleton = set_.skeleton;
    state_.dataset_sha256 = control_.dataset_sha256;
    state_.labels = set_.labels;
  }

  /// The weights of a file instead of a training.
  Expected<Checkpoint> TakeReleasedWeights() {
    FillHeader();
    const Expected<ReleasedWeights> weights = ReadReleasedWeights(control_.weights, state_.kind);
    if (!weights) return Forward(weights);
    StartRound(0);
    if (Status set = SetValues(weights->parameters, DisplayPath(control_.weights), *network_); !set)
      return Forward(set);
    state_.step = weights->steps;
    Store();
    state_.optimisers.clear();
    state_.dataset_sha256.clear();  // of a set that is not available
    state_.facts["clips"] = 0;
    state_.finished = true;
    return std::move(state_);
  }

  /// Resumes from the state in scratch or from the checkpoint to continue, or starts anew.
  Status Begin() {
    FillHeader();
    std::error_code unknown;
    for (const std::filesystem::path& file :
         {control_.scratch.empty() ? std::filesystem::path() : StateFile(), control_.start}) {
      if (file.empty() || !std::filesystem::exists(file, unknown)) continue;
      Expected<Checkpoint> stored = ReadCheckpoint(file, state_.kind);
      if (!stored && file == control_.start) return Forward(stored);
      if (!stored) {
        control_.report(
            MakeFinding("training_restarted", Severity::kWarning, 0.0,
                        "training starts anew, as its saved state cannot be read: " + stored.error().Message(),
                        FindingAction::kDropped));
        continue;
      }
      if (!SameTraining(*stored) || (End() > 0 && stored->step > End())) continue;
      if (file != control_.start) TakeEffort();
      return Resume(std::move(*stored), DisplayPath(file));
    }
    StartRound(0);
    return TakeFirstWeights();
  }

  /// The initial weights of a round, in place of random ones.
  Status TakeFirstWeights() {
    if (control_.start_from.empty()) return {};
    const Expected<ReleasedWeights> weights = ReadReleasedWeights(control_.start_from, state_.kind);
    if (!weights) return Forward(weights);
    return SetValues(weights->parameters, DisplayPath(control_.start_from), *network_);
  }

  /// Duration of the saved training, stored beside it, because a checkpoint's bytes do not depend on the clock.
  std::filesystem::path EffortFile() const { return control_.scratch / "training_seconds.txt"; }

  void TakeEffort() {
    const auto text = ReadFile(EffortFile());
    seconds_before_ = text ? ParseDouble(*text).value_or(0.0) : 0.0;
    control_.resumed(seconds_before_);
  }

  double SecondsNow() const {
    return seconds_before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  }

  /// The last step of a generator; 0: a recogniser, which ends by its epochs.
  std::int64_t End() const {
    if (recognises_) return 0;
    const LearningOptions& learning = options_.learning;
    return learning.until > 0 ? std::min(learning.iterations, learning.until) : learning.iterations;
  }

  bool SameTraining(const Checkpoint& stored) const {
    nlohmann::json own = state_.options, other = stored.options;
    for (const char* key : {"until", "samples_at", "save_every"}) {
      own.erase(key);
      other.erase(key);
    }
    return own == other && stored.dataset_sha256 == control_.dataset_sha256;
  }

  Status Resume(Checkpoint stored, const std::string& where) {
    const nlohmann::json facts = stored.facts;
    best_epoch_ = facts.value("best_epoch", std::int64_t{0});
    best_.right = facts.value("best_accuracy", 0.0);
    best_.loss = facts.value("best_loss", 0.0);
    StartRound(facts.value("round", 0));
    round_step_ = facts.value("round_step", std::int64_t{0});
    state_.step = stored.step;
    state_.history = std::move(stored.history);
    state_.best = std::move(stored.best);
    if (Status set = SetValues(stored.parameters, where, *network_); !set) return set;
    if (Status restored = optimisers_->Restore(stored.optimisers, where); !restored) return restored;
    ended_ = round_step_ >= until_;
    return {};
  }

  void StartRound(int round) {
    round_ = round;
    round_step_ = 0;
    if (round == 1) {
      rows_.train.insert(rows_.train.end(), rows_.validation.begin(), rows_.validation.end());
      std::sort(rows_.train.begin(), rows_.train.end());
    }
    const std::vector<Vector3d> offsets =
        options_.NeedsRotations() ? MedianRestOffsets(set_, rows_.train) : std::vector<Vector3d>();
    NetworkSizes sizes = SizesOf(*set_.skeleton, set_.labels.size(), offsets);
    sizes.words = static_cast<std::int64_t>(set_.words.size());
    sizes.skin = control_.skin;
    network_ = MakeNetwork(options_, sizes);
    if (recognises_ && options_.recogniser.standardise) Standardise();
    network_->to(device());
    optimisers_ = std::make_unique<Optimisers>(*network_);
    order_ = std::make_unique<MixedOrder>(set_, options_.data, rows_.train,
                                          round == 0 ? MadeWithout(set_, rows_.validation) : set_.made,
                                          options_.learning.batch, recognises_ || options_.kind == NetworkKind::kActor,
                                          options_.made_share, options_.seed());
    steps_ = options_.learning.iterations;
    if (recognises_) steps_ = order_->batches_per_pass() * (round == 0 ? options_.recogniser.epochs : best_epoch_);
    until_ = recognises_ ? steps_ : End();
    first_step_ = -1;
  }

  /// Mean and deviation of every number over the unchanged training windows.
  void Standardise() {
    const std::int64_t D = 3 * set_.skeleton->joint_count();
    Tensor sum = torch::zeros({D}, torch::dtype(torch::kFloat64).device(device())), squares = sum.clone();
    double count = 0.0;
    for (const int row : rows_.train) {
      const Batch one = BatchOf({row}, "standardise", false);
      const Tensor values = one.motion.view({-1, D}).to(torch::kFloat64);
      sum += values.sum(0);
      squares += values.square().sum(0);
      count += static_cast<double>(values.size(0));
    }
    const Tensor mean = sum / count;
    const Tensor deviation = (squares / count - mean.square()).clamp_min(0.0).sqrt().clamp_min(kSmallestDeviation);
    network_->Standardise(mean.to(torch::kFloat32).to(device()), deviation.to(torch::kFloat32).to(device()));
  }

  Batch BatchOf(const std::vector<int>& rows, const std::string& key, bool augment) const {
    MotionRows made = options_.NeedsParts()
                          ? PlacedSamples(set_, options_.macvae.canonical, static_cast<int>(options_.data.frames), rows)
                          : MakeMotionRows(set_, options_.data, rows, options_.seed(), key, augment);
    const auto B = static_cast<std::int64_t>(rows.size());
    Batch batch;
    const std::int64_t J = set_.skeleton->joint_count();
    batch.motion = torch::from_blob(made.motion.data(), {made.frames, B, 3 * J}).clone().to(device());
    batch.label = torch::from_blob(made.label.data(), {B}, torch::kInt64).clone().to(device());
    batch.whole = B;
    if (!made.rotation.empty()) {
      batch.rotation = torch::from_blob(made.rotation.data(), {made.frames, B, J, 3, 3}).clone().to(device());
    }
    if (!made.parts.empty()) {
      batch.parts = torch::from_blob(made.parts.data(), {B, 3}, torch::kInt64).clone().to(device());
      batch.word = torch::from_blob(made.word.data(), {B, 3}, torch::kInt64).clone().to(device());
    }
    if (!made.length.empty()) {
      const Tensor length = torch::from_blob(made.length.data(), {1, B}, torch::kInt32).clone();
      batch.valid = (torch::arange(made.frames).unsqueeze(1) < length).to(device());  // (T,B)
      batch.whole_frames = std::accumulate(made.length.begin(), made.length.end(), std::int64_t{0});
    }
    return batch;
  }

  /// The batch in parts, of which each has a thread.
  std::vector<Batch> ShardsOf(const Batch& batch) const {
    // Their statistics or means are of the whole batch.
    const bool whole = options_.kind == NetworkKind::kStGcn || options_.NeedsParts();
    if (whole) return {batch};
    const std::int64_t shards = std::min(options_.learning.shards, batch.size());
    std::vector<Batch> parts;
    for (std::int64_t s = 0; s < shards; ++s) {
      const std::int64_t begin = batch.size() * s / shards, end = batch.size() * (s + 1) / shards;
      const auto part = [&](const Tensor& x) { return x.defined() ? x.slice(1, begin, end).contiguous() : x; };
      Batch shard;
      shard.motion = part(batch.motion);
      shard.label = batch.label.slice(0, begin, end);
      shard.whole = batch.whole;
      shard.first = begin;
      shard.rotation = part(batch.rotation);
      shard.valid = part(batch.valid);
      shard.whole_frames = batch.whole_frames;
      parts.push_back(std::move(shard));
    }
    return parts;
  }

  double RateFactor() const {
    if (!recognises_ || !options_.recogniser.anneal) return 1.0;
    return 0.5 * (1.0 + std::cos(kPi * static_cast<double>(round_step_) / static_cast<double>(steps_)));
  }

  Status Step() {
    const Batch batch =
        BatchOf(order_->RowsOf(round_step_), std::to_string(round_) + "/" + std::to_string(round_step_), true);
    const std::vector<Batch> shards = ShardsOf(batch);
    std::map<std::string, double> terms;
    for (const int phase : network_->Phases(round_step_, steps_)) {
      const std::vector<Tensor>& parameters = optimisers_->group(phase).parameters;
      std::vector<Losses> losses(shards.size());
      std::vector<std::vector<Tensor>> gradients(shards.size());
      ParallelFor(static_cast<int>(shards.size()), 1, control_.threads, [&](int begin, int end) {
        for (int s = begin; s < end; ++s) {
          Draws draws(options_.seed(), round_step_ + round_ * kRoundSteps, phase, s);
          const auto at = static_cast<std::size_t>(s);
          losses[at] = network_->Loss(shards[at], draws, phase);
          gradients[at] = torch::autograd::grad({losses[at].total}, parameters, {}, false, false, true);
        }
      });
      std::vector<Tensor> sum = std::move(gradients[0]);
      double total = losses[0].total.item<double>();
      for (const auto& [name, value] : losses[0].terms) terms[name] += value.item<double>();
      for (std::size_t s = 1; s < shards.size(); ++s) {
        total += losses[s].total.item<double>();
        for (const auto& [name, value] : losses[s].terms) terms[name] += value.item<double>();
        for (std::size_t i = 0; i < sum.size(); ++i) {
          const Tensor& more = gradients[s][i];
          if (more.defined()) sum[i] = sum[i].defined() ? sum[i] + more : more;
        }
      }
      if (!std::isfinite(total)) return Diverged(batch, "the loss is " + RoundedText(total, 4));
      for (const Tensor& gradient : sum) {
        if (gradient.defined() && !std::isfinite(gradient.norm().item<double>())) {
          return Diverged(batch, "the loss is " + RoundedText(total, 4) + ", but its gradient is not finite");
        }
      }
      optimisers_->Step(phase, sum, RateFactor(), options_.learning.gradient_clip);
      network_->AfterStep(phase);
    }
    ++round_step_;
    ++state_.step;
    Record(terms);
    if (recognises_ && round_ == 0 && options_.recogniser.selects()) Check();
    Progress(terms);
    return {};
  }

  /// Saves the batch and the weights before the phase that failed.
  Status Diverged(const Batch& batch, const std::string& what) {
    std::string kept = "without a scratch folder the batch is not saved";
    if (!control_.scratch.empty()) {
      Store();
      Checkpoint dump = state_;
      const Tensor motion = batch.motion.to(torch::kCPU).contiguous(), label = batch.label.to(torch::kCPU);
      Parameter values{"batch.motion", motion.sizes().vec(), {}};
      values.value.assign(motion.data_ptr<float>(), motion.data_ptr<float>() + motion.numel());
      Parameter classes{"batch.label", label.sizes().vec(), {}};
      for (std::int64_t b = 0; b < label.numel(); ++b) {
        classes.value.push_back(static_cast<float>(label.data_ptr<std::int64_t>()[b]));
      }
      for (const auto& [name, tensor] :
           {std::pair("batch.rotation", batch.rotation), std::pair("batch.valid", batch.valid)}) {
        if (tensor.defined()) dump.parameters.push_back(ParameterOf(name, tensor));
      }
      dump.parameters.push_back(std::move(values));
      dump.parameters.push_back(std::move(classes));
      const std::filesystem::path file = control_.scratch / "diverged.h5";
      if (Status made = MakeFolder(control_.scratch); !made) return made;
      if (Status written = WriteCheckpoint(dump, file); !written) return written;
      std::error_code ignored;
      std::filesystem::remove(StateFile(), ignored);
      kept = "batch and weights are saved in " + DisplayPath(file);
    }
    return Fail(ErrorCode::kInconsistent, what + " after " + Counted(state_.step, "step") + "; " + kept, options_.name,
                "lower learning_rate, or set gradient_clip");
  }

  void Record(const std::map<std::string, double>& terms) {
    const std::int64_t stride = std::max<std::int64_t>(1, steps_ / kHistoryRows);
    if (round_step_ % stride != 0 && round_step_ != until_) return;
    state_.history["step"].push_back(static_cast<double>(state_.step));
    for (const auto& [name, value] : terms) Column(name).push_back(value);
    for (auto& [name, column] : state_.history) {
      const bool of_checks = name.rfind("validation_", 0) == 0 || name == "check_step";
      if (!of_checks) column.resize(state_.history["step"].size(), std::nan(""));
    }
  }

  /// A column as long as those before it: a phase may start late.
  std::vector<double>& Column(const std::string& name) {
    std::vector<double>& column = state_.history[name];
    column.resize(state_.history["step"].size() - 1, std::nan(""));
    return column;
  }

  void Progress(const std::map<std::string, double>& terms) {
    using Clock = std::chrono::steady_clock;
    if (first_step_ < 0) {
      first_step_ = round_step_;
      began_ = Clock::now();
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
    const double rate = seconds > 0.0 ? static_cast<double>(round_step_ - first_step_) / seconds : 0.0;
    const double share = static_cast<double>(round_step_) / static_cast<double>(until_);
    std::string text = options_.name + ": step " + std::to_string(round_step_) + " of " + std::to_string(until_);
    if (rate > 0.0) {
      text += ", " + RoundedText(rate, 3) + " steps/s, " +
              RoundedText(static_cast<double>(until_ - round_step_) / rate / 60.0, 2) + " min left";
    }
    for (const auto& [name, value] : terms) text += ", " + name + " " + RoundedText(value, 3);
    text += ", " + RoundedText(ResidentMegabytes(), 3) + " MB";
    const bool rounds = recognises_ && options_.recogniser.refits();
    control_.progress(rounds ? 0.5 * (round_ + share) : share, text);
  }

  /// Check on the validation fold, every `check_every` epochs.
  void Check() {
    const std::int64_t per_pass = order_->batches_per_pass();
    if (round_step_ % per_pass != 0) return;
    const std::int64_t epoch = round_step_ / per_pass;
    const GruRecogniserOptions& rules = options_.recogniser;
    if (epoch % rules.check_every != 0 && epoch != rules.epochs) return;
    const torch::NoGradGuard no_gradient;
    ValidationScore score;
    const auto count = static_cast<std::int64_t>(rows_.validation.size());
    for (std::int64_t begin = 0; begin < count; begin += kValidatedAtOnce) {
      const auto first = rows_.validation.begin() + begin;
      const std::vector<int> rows(first, first + std::min(kValidatedAtOnce, count - begin));
      const ValidationScore part = network_->Validate(BatchOf(rows, "validation", false));
      score.right += part.right;
      score.loss += part.loss;
    }
    score.right /= static_cast<double>(count);
    score.loss /= static_cast<double>(count);
    state_.history["check_step"].push_back(static_cast<double>(state_.step));
    state_.history["validation_accuracy"].push_back(score.right);
    state_.history["validation_loss"].push_back(score.loss);
    // An annealed rate has to reach its end: intermediate weights have not converged.
    const bool better = rules.anneal || best_epoch_ == 0 || score.right > best_.right ||
                        (score.right == best_.right && score.loss < best_.loss);
    if (!better) return;
    best_ = score;
    best_epoch_ = epoch;
    state_.best = ValuesOf(*network_);
  }

  Status EndRound() {
    if (recognises_ && round_ == 0 && options_.recogniser.refits()) {
      StartRound(1);
      return TakeFirstWeights();
    }
    if (recognises_ && !options_.recogniser.selects()) {
      best_epoch_ = options_.recogniser.epochs;
    } else if (recognises_ && round_ == 0) {
      (void)SetValues(state_.best, options_.name, *network_);
    }
    ended_ = true;
    return {};
  }

  void Store() {
    state_.parameters = ValuesOf(*network_);
    state_.optimisers = optimisers_->State();
    state_.facts = {
        {"split", rows_.split},
        {"clips", rows_.train.size() + set_.made.size()},
        {"batch", std::min<std::int64_t>(options_.learning.batch, static_cast<std::int64_t>(rows_.train.size()))},
        {"rate", set_.rate.Text()},
        {"parameters", CountValues(state_.parameters)},
        {"round", round_},
        {"round_step", round_step_}};
    if (!recognises_) {
      state_.facts["bone_length"] = MedianBoneLengths(set_, rows_.train);
      if (options_.NeedsRotations()) StoreRestPose();
      if (options_.NeedsParts()) state_.facts["words"] = set_.words;
      if (options_.NeedsParts() || options_.data.part != ClipPart::kWhole) StoreUsualLengths();
      if (options_.kind == NetworkKind::kCondGru) state_.facts["first_pose"] = FirstPoses(set_, rows_.train);
      return;
    }
    state_.facts["validation_rule"] = rows_.validation_rule;
    state_.facts["epochs"] = state_.step / std::max<std::int64_t>(1, order_->batches_per_pass());
    state_.facts["best_epoch"] = best_epoch_;
    state_.facts["best_accuracy"] = best_.right;
    state_.facts["best_loss"] = best_.loss;
  }

  /// Mean frames of the transition to a class and of its action in the training set, truncated (multiact.md A.4); of a
  /// class without samples those of all.
  void StoreUsualLengths() {
    std::vector<std::array<double, 3>> sums(set_.labels.size() + 1, {0.0, 0.0, 0.0});
    for (const int row : rows_.train) {
      const TrainingSet::Clip& clip = set_.clips[static_cast<std::size_t>(row)];
      for (const std::size_t at : {static_cast<std::size_t>(clip.label), set_.labels.size()}) {
        sums[at][0] += clip.parts[1];
        sums[at][1] += clip.parts[2];
        sums[at][2] += 1.0;
      }
    }
    state_.facts["part_frames"] = nlohmann::json::array();
    for (std::size_t c = 0; c < set_.labels.size(); ++c) {
      const std::array<double, 3>& sum = sums[c][2] > 0.0 ? sums[c] : sums.back();
      state_.facts["part_frames"].push_back(
          {std::max(1, static_cast<int>(sum[0] / sum[2])), std::max(1, static_cast<int>(sum[1] / sum[2]))});
    }
  }

  /// Rest offsets for generated rotations.
  void StoreRestPose() {
    state_.facts["rest_offset"] = nlohmann::json::array();
    state_.facts["bone_length"] = nlohmann::json::array();
    for (const Vector3d& offset : MedianRestOffsets(set_, rows_.train)) {
      state_.facts["rest_offset"].push_back({offset.x(), offset.y(), offset.z()});
      state_.facts["bone_length"].push_back(offset.norm());
    }
    if (control_.skin) state_.facts["body"] = control_.skin->name;
  }

  Status Save() {
    if (control_.scratch.empty()) return {};
    Store();
    if (Status made = MakeFolder(control_.scratch); !made) return made;
    if (Status saved = WriteCheckpoint(state_, StateFile()); !saved) return saved;
    return WriteFile(EffortFile(), FormatDouble(SecondsNow()));
  }

  Expected<Checkpoint> Interrupted() {
    if (Status saved = Save(); !saved) return Forward(saved);
    return Fail(ErrorCode::kInterrupted, "training was stopped after " + Counted(state_.step, "step"), options_.name,
                "run again to continue");
  }

  const TrainingSet& set_;
  const NetworkOptions& options_;
  const TrainingControl& control_;
  const bool recognises_;
  TrainingRows rows_;
  std::shared_ptr<Network> network_;
  std::unique_ptr<Optimisers> optimisers_;
  std::unique_ptr<MixedOrder> order_;
  Checkpoint state_;
  int round_ = 0;
  bool ended_ = false;
  std::int64_t round_step_ = 0;  ///< completed in this round
  std::int64_t steps_ = 0;       ///< of this round
  std::int64_t until_ = 0;       ///< last step
  std::int64_t best_epoch_ = 0;
  ValidationScore best_;  ///< means
  std::int64_t first_step_ = -1;
  std::chrono::steady_clock::time_point began_, started_ = std::chrono::steady_clock::now();
  double seconds_before_ = 0.0;  ///< of the earlier runs of this training
};

}  // namespace

Expected<Checkpoint> TrainNetwork(const TrainingSet& set, const NetworkOptions& options,
                                  const TrainingControl& control) {
  return Training(set, options, control).Run();
}

Expected<TrainingCost> MeasureCost(const TrainingSet& set, const NetworkOptions& options,
                                   std::shared_ptr<const Skin> skin, int threads) {
  TrainingControl control;
  control.skin = std::move(skin);
  control.threads = threads;
  return Training(set, options, control).Measure();
}

}  // namespace mocurate
