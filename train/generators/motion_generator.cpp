#include "train/generators/motion_generator.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/base/version.h"
#include "train/trainer/generator_rules.h"

namespace mocurate {

struct MotionGenerator::Impl {
  Action2MotionConfig config;
  Checkpoint checkpoint;
  GeneratorOptions options;
  FrameRate rate;
};

namespace {

constexpr std::size_t kGeneratedAtOnce = 500;  // fits the caches; larger ones gain nothing

Status CheckRequest(const MotionRequest& request, const Action2MotionConfig& config, std::size_t index) {
  const std::string where = "request " + std::to_string(index);
  if (request.label < 0 || request.label >= config.classes) {
    return Fail(
        ErrorCode::kInconsistent,
        "label " + std::to_string(request.label) + ", the generator knows 0 to " + std::to_string(config.classes - 1),
        where);
  }
  if (request.frames < 1) return Fail(ErrorCode::kInconsistent, "no frames are asked for", where);
  if (!request.bone_length.empty() && static_cast<int>(request.bone_length.size()) != config.joints) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(request.bone_length.size()) + " bone lengths, the skeleton has " +
                    std::to_string(config.joints) + " joints",
                where);
  }
  return {};
}

struct Batch {
  std::vector<int> label;
  std::vector<float> noise;        // (T,B,latent)
  std::vector<float> bone_length;  // (B,J)
};

Batch GeneratorBatch(const MotionRequest* requests, std::size_t count, const Action2MotionConfig& config,
                     const std::vector<double>& rest_length) {
  Batch batch;
  const std::size_t frames = static_cast<std::size_t>(requests[0].frames),
                    latent = static_cast<std::size_t>(config.latent);
  batch.noise.resize(frames * count * latent);
  for (std::size_t b = 0; b < count; ++b) {
    batch.label.push_back(requests[b].label);
    const std::vector<double>& length = requests[b].bone_length.empty() ? rest_length : requests[b].bone_length;
    batch.bone_length.insert(batch.bone_length.end(), length.begin(), length.end());
    Random random(requests[b].seed, "generator.motion");
    for (std::size_t t = 0; t < frames; ++t) {
      float* row = batch.noise.data() + (t * count + b) * latent;
      for (std::size_t k = 0; k < latent; ++k) row[k] = static_cast<float>(random.Normal());
    }
  }
  return batch;
}

}  // namespace

MotionGenerator::MotionGenerator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MotionGenerator::~MotionGenerator() = default;

Expected<std::unique_ptr<MotionGenerator>> MotionGenerator::Load(const std::filesystem::path& path) {
  Expected<Checkpoint> checkpoint = ReadCheckpoint(path, kAction2MotionKind);
  if (!checkpoint) return Forward(checkpoint);
  const std::string where = DisplayPath(path);
  Expected<Action2MotionConfig> config = ConfigOf(*checkpoint, where);
  if (!config) return Forward(config);
  Expected<GeneratorOptions> options = OptionsFromJson<GeneratorOptions>(checkpoint->options, where);
  if (!options) return Forward(options);
  const nlohmann::json rate_text = checkpoint->facts.value("rate", nlohmann::json("30"));
  const Expected<FrameRate> rate = FrameRate::Parse(rate_text.is_string() ? rate_text.get<std::string>() : "");
  if (!rate) return Forward(rate);
  auto impl = std::make_unique<Impl>();
  impl->config = std::move(*config);
  impl->checkpoint = std::move(*checkpoint);
  impl->options = std::move(*options);
  impl->rate = *rate;
  return std::unique_ptr<MotionGenerator>(new MotionGenerator(std::move(impl)));
}

Expected<std::vector<float>> MotionGenerator::Joints(const std::vector<MotionRequest>& requests) const {
  const Action2MotionConfig& config = impl_->config;
  if (requests.empty()) return std::vector<float>();
  for (std::size_t i = 0; i < requests.size(); ++i) {
    if (Status fits = CheckRequest(requests[i], config, i); !fits) return Forward(fits);
    if (requests[i].frames != requests[0].frames) {
      return Fail(ErrorCode::kInconsistent, "requests ask for different numbers of frames",
                  "request " + std::to_string(i));
    }
  }
  const std::size_t frames = static_cast<std::size_t>(requests[0].frames),
                    pose = static_cast<std::size_t>(config.pose());
  const std::vector<double> rest_length = impl_->checkpoint.skeleton->RestBoneLengths();
  const LieLayer layer = config.lie ? LieLayer(*config.lie, config.exp) : LieLayer();
  std::vector<float> result(requests.size() * frames * pose);
  for (std::size_t begin = 0; begin < requests.size(); begin += kGeneratedAtOnce) {
    const std::size_t count = std::min(kGeneratedAtOnce, requests.size() - begin);
    const Batch batch = GeneratorBatch(requests.data() + begin, count, config, rest_length);
    const std::vector<float> output = Action2MotionGenerate(config, impl_->checkpoint.parameters, batch.label,
                                                            static_cast<int>(frames), batch.noise, batch.bone_length);
    std::vector<float> joints(count * pose);
    for (std::size_t t = 0; t < frames; ++t) {
      const float* rows = output.data() + t * count * pose;
      if (config.lie) {
        layer.Forward(rows, batch.bone_length.data(), static_cast<int>(count), joints.data());
        rows = joints.data();
      }
      for (std::size_t b = 0; b < count; ++b) {
        std::copy(rows + b * pose, rows + (b + 1) * pose, result.data() + ((begin + b) * frames + t) * pose);
      }
    }
  }
  return result;
}

Expected<Dataset> MotionGenerator::Generate(const std::vector<MotionRequest>& requests) const {
  Dataset set;
  set.skeleton = impl_->checkpoint.skeleton;
  set.joints_only = true;
  for (const std::string& label : labels()) set.labels.push_back(label);
  set.recipe = "generated";
  set.created_by = std::string(CreatedBy());
  const int J = impl_->config.joints;
  for (std::size_t begin = 0; begin < requests.size();) {
    std::size_t end = begin + 1;
    while (end < requests.size() && requests[end].frames == requests[begin].frames && end - begin < kGeneratedAtOnce)
      ++end;
    const std::vector<MotionRequest> part(requests.begin() + static_cast<std::ptrdiff_t>(begin),
                                          requests.begin() + static_cast<std::ptrdiff_t>(end));
    const Expected<std::vector<float>> joints = Joints(part);
    if (!joints) return Forward(joints);
    const std::size_t size = static_cast<std::size_t>(part[0].frames) * 3 * J;
    for (std::size_t i = 0; i < part.size(); ++i) {
      Clip clip;
      char number[24];
      std::snprintf(number, sizeof(number), "%06zu", begin + i);
      clip.identity.source = "generated";
      clip.identity.recording = number;
      clip.identity.end_frame = part[i].frames;
      clip.label = labels()[static_cast<std::size_t>(part[i].label)];
      clip.rate = impl_->rate;
      clip.provenance["seed"] = std::to_string(part[i].seed);
      if (!part[i].source_clip.empty()) clip.provenance["bone_lengths_of"] = part[i].source_clip;
      Motion motion;
      motion.skeleton = set.skeleton;
      motion.rate = impl_->rate;
      motion.joints = JointPositions(part[i].frames, J);
      std::copy(joints->begin() + static_cast<std::ptrdiff_t>(i * size),
                joints->begin() + static_cast<std::ptrdiff_t>((i + 1) * size), motion.joints.xyz.begin());
      clip.motion = std::move(motion);
      set.clips.push_back(std::move(clip));
    }
    begin = end;
  }
  return set;
}

SkeletonPtr MotionGenerator::skeleton() const { return impl_->checkpoint.skeleton; }
const std::vector<std::string>& MotionGenerator::labels() const { return impl_->checkpoint.labels; }
int MotionGenerator::training_frames() const { return static_cast<int>(impl_->options.frames); }

Expected<Dataset> GenerateMotions(const std::filesystem::path& checkpoint, const std::vector<MotionRequest>& requests) {
  const Expected<std::unique_ptr<MotionGenerator>> generator = MotionGenerator::Load(checkpoint);
  if (!generator) return Forward(generator);
  return (*generator)->Generate(requests);
}

}  // namespace mocurate
