#include "train/generators/generator_impl.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "core/base/file.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/heading.h"
#include "core/motion/kinematics.h"
#include "train/checkpoint/checkpoint.h"
#include "train/data/batches.h"
#include "train/items.h"
#include "train/trainer/values.h"

namespace mocurate {

namespace {

constexpr int kMostFrames = 5000;                                // rows of the released positional table
constexpr int kGeneratedAtOnce = 500;                            // motions whose states fit the caches
constexpr std::int64_t kNumbersAtOnce = std::int64_t{64} << 20;  // of attention and the layers between, 256 MB

/// Median rest offsets of the training set; empty where the network has no rotations.
Expected<std::vector<Vector3d>> RestOffsetOf(const Checkpoint& checkpoint, const NetworkOptions& options,
                                             const std::string& where) {
  std::vector<Vector3d> offsets;
  if (!options.NeedsRotations()) return offsets;
  bool whole = true;
  for (const nlohmann::json& row : checkpoint.facts.value("rest_offset", nlohmann::json::array())) {
    whole = whole && row.size() == 3;
    if (whole) offsets.emplace_back(row[0].get<double>(), row[1].get<double>(), row[2].get<double>());
  }
  whole =
      whole && std::all_of(offsets.begin(), offsets.end(), [](const Vector3d& offset) { return offset.allFinite(); });
  if (whole && offsets.size() == checkpoint.skeleton->joints.size()) return offsets;
  return Fail(ErrorCode::kMalformed, "facts.rest_offset does not have one offset per joint of the skeleton", where,
              "train again");
}

/// The skeleton with bones of these lengths along the rest offsets.
SkeletonPtr WithBones(const SkeletonPtr& skeleton, const std::vector<Vector3d>& rest_offset,
                      const std::vector<double>& lengths) {
  auto own = std::make_shared<Skeleton>(*skeleton);
  for (std::size_t j = 1; j < own->joints.size(); ++j) {
    const double length = rest_offset[j].norm();
    own->joints[j].rest_offset = length > 0.0 ? Vector3d(rest_offset[j] * (lengths[j] / length)) : rest_offset[j];
  }
  return own;
}

/// Latents of requests that interpolate towards another one.
void GiveLatents(const MotionRequest* requests, std::int64_t count, Network& network, Draws& draws) {
  const auto asked = [](const MotionRequest& request) { return request.fraction > 0.0; };
  if (std::none_of(requests, requests + count, asked)) return;
  std::vector<std::uint64_t> others;
  torch::Tensor fraction = torch::empty({1, count, 1});
  for (std::int64_t b = 0; b < count; ++b) {
    others.push_back(requests[b].to_seed);
    fraction.data_ptr<float>()[b] = static_cast<float>(requests[b].fraction);
  }
  const torch::Tensor from = draws.Normal(kMotionLatent, 1, count, network.latent_size());
  draws.Give(
      kMotionLatent,
      from + fraction * (Draws(std::move(others)).Normal(kMotionLatent, 1, count, network.latent_size()) - from));
}

}  // namespace

int MotionsAtOnce(const NetworkOptions& options, std::int64_t frames) {
  if (options.kind != NetworkKind::kActor && !options.NeedsParts()) return kGeneratedAtOnce;
  const auto numbers_of = [&](std::int64_t heads, std::int64_t feed_forward, std::int64_t width) {
    return heads * frames * frames + (feed_forward + 4 * width) * frames;
  };
  const std::int64_t numbers =
      options.kind == NetworkKind::kActor
          ? numbers_of(options.actor.heads, options.actor.feed_forward, options.actor.latent)
      : options.kind == NetworkKind::kSsmct
          ? numbers_of(options.ssmct.heads, options.ssmct.feed_forward, options.ssmct.width)
          : numbers_of(options.macvae.heads, options.macvae.feed_forward, options.macvae.width);
  return static_cast<int>(std::clamp<std::int64_t>(kNumbersAtOnce / numbers, 1, kGeneratedAtOnce));
}

Status MotionGenerator::Impl::Check(const MotionRequest& request, std::size_t index) const {
  const std::string where = "request " + std::to_string(index);
  const auto joints = static_cast<std::size_t>(skeleton->joint_count());
  if (request.label < 0 || static_cast<std::size_t>(request.label) >= labels.size()) {
    return Fail(
        ErrorCode::kInconsistent,
        "label " + std::to_string(request.label) + ", the generator has 0 to " + std::to_string(labels.size() - 1),
        where);
  }
  if (request.frames < 1) return Fail(ErrorCode::kInconsistent, "the request has no frames", where);
  if (options.NeedsParts()) {
    const bool fills = options.kind == NetworkKind::kSsmct;
    return Fail(ErrorCode::kInconsistent,
                fills ? "the network fills transitions and generates no actions"
                      : "the network continues motions and generates none from a label alone",
                where,
                fills ? "use it with --fill and an actor, with --script LABEL,LABEL,..."
                      : "add a script: --script LABEL,LABEL,... with --first ACTOR or --previous SET");
  }
  if (network->latent_size() > 0 && request.frames > kMostFrames) {
    return Fail(ErrorCode::kInconsistent,
                Counted(request.frames, "frame") + " are requested, the positional table ends at " +
                    std::to_string(kMostFrames),
                where, "request shorter motions");
  }
  if (options.kind == NetworkKind::kActor && options.actor.coders == ActorCoders::kFullyConnected &&
      request.frames != options.data.frames) {
    return Fail(ErrorCode::kInconsistent,
                "the network generates " + Counted(options.data.frames, "frame") + ", requested are " +
                    std::to_string(request.frames),
                where, "request that length: a fully connected coder has one length only");
  }
  if (request.fraction > 0.0 && network->latent_size() == 0) {
    return Fail(ErrorCode::kInconsistent, "the network has no latent of a whole motion to interpolate", where,
                "use a network of kind actor");
  }
  if (!request.bone_length.empty() && request.bone_length.size() != joints) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(request.bone_length.size()) + " bone lengths, the skeleton has " +
                    std::to_string(joints) + " joints",
                where);
  }
  if (!request.first_pose.empty() && request.first_pose.size() != 3 * joints) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(request.first_pose.size()) + " values of a first pose, the skeleton has " +
                    std::to_string(joints) + " joints",
                where);
  }
  return {};
}

RequestBatch MotionGenerator::Impl::BatchOf(const MotionRequest* requests, std::size_t count) const {
  const auto B = static_cast<std::int64_t>(count);
  const std::int64_t J = skeleton->joint_count();
  RequestBatch batch;
  batch.frames = requests[0].frames;
  batch.label = torch::empty({B}, torch::kInt64);
  batch.bone_length = torch::empty({B, J});
  const bool poses = !first_poses.empty();
  if (poses) batch.first_pose = torch::zeros({B, 3 * J});
  for (std::size_t b = 0; b < count; ++b) {
    batch.label.data_ptr<std::int64_t>()[b] = requests[b].label;
    const std::vector<double>& length = requests[b].bone_length.empty() ? bone_length : requests[b].bone_length;
    std::copy(length.begin(), length.end(), batch.bone_length.data_ptr<float>() + b * static_cast<std::size_t>(J));
    const auto label = static_cast<std::size_t>(requests[b].label);
    if (poses) {
      const std::vector<double>& pose = requests[b].first_pose.empty() ? first_poses[label] : requests[b].first_pose;
      std::copy(pose.begin(), pose.end(), batch.first_pose.data_ptr<float>() + b * 3 * static_cast<std::size_t>(J));
    }
  }
  return batch;
}

MotionGenerator::MotionGenerator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MotionGenerator::~MotionGenerator() = default;

Expected<std::unique_ptr<MotionGenerator>> MotionGenerator::Load(const std::filesystem::path& path) {
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(path);
  if (!checkpoint) return Forward(checkpoint);
  const std::string where = DisplayPath(path);
  Expected<NetworkOptions> options = OptionsFromJson<NetworkOptions>(checkpoint->options, where);
  if (!options) return Forward(options);
  if (!GeneratesMotions(options->kind)) {
    return Fail(ErrorCode::kInconsistent,
                "the checkpoint holds a network of kind '" + checkpoint->kind + "', which does not generate motions",
                where, "give the checkpoint of a generator");
  }
  const Expected<FrameRate> rate = FrameRate::Parse(checkpoint->facts.value("rate", std::string("30")));
  if (!rate) return Forward(rate);
  if (checkpoint->skeleton == nullptr || checkpoint->labels.empty()) {
    return Fail(ErrorCode::kMalformed, "the checkpoint lacks a skeleton or labels", where, "train again");
  }
  torch::set_num_threads(1);
  auto impl = std::make_unique<Impl>();
  if (Status sound = CheckSizes(*options, where); !sound) {
    return Fail(ErrorCode::kMalformed, sound.error().what, where, "use the unchanged file that mocurate wrote");
  }
  const auto rest = RestOffsetOf(*checkpoint, *options, where);
  if (!rest) return Forward(rest);
  impl->rest_offset = *rest;
  NetworkSizes sizes = SizesOf(*checkpoint->skeleton, checkpoint->labels.size(), *rest);
  sizes.words = static_cast<std::int64_t>(checkpoint->facts.value("words", std::vector<std::string>()).size());
  impl->network = MakeNetwork(*options, sizes);
  if (Status fits = SetValues(checkpoint->parameters, where, *impl->network); !fits) return Forward(fits);
  impl->network->eval();  // once: threads share the network
  impl->options = std::move(*options);
  impl->skeleton = checkpoint->skeleton;
  impl->labels = checkpoint->labels;
  impl->rate = *rate;
  impl->rest_axes = RestAxes(*impl->skeleton);
  const auto joints = static_cast<std::size_t>(impl->skeleton->joint_count());
  impl->bone_length = checkpoint->facts.value("bone_length", impl->skeleton->RestBoneLengths());
  impl->first_poses = checkpoint->facts.value("first_pose", std::vector<std::vector<double>>());
  const auto fits = [&](const std::vector<double>& pose) { return pose.empty() || pose.size() == 3 * joints; };
  if (impl->bone_length.size() != joints ||
      (!impl->first_poses.empty() && impl->first_poses.size() != impl->labels.size()) ||
      !std::all_of(impl->first_poses.begin(), impl->first_poses.end(), fits)) {
    return Fail(ErrorCode::kMalformed, "bone lengths or first poses do not match the skeleton", where, "train again");
  }
  return std::unique_ptr<MotionGenerator>(new MotionGenerator(std::move(impl)));
}

Expected<MotionGenerator::Rows> MotionGenerator::Answer(const std::vector<MotionRequest>& requests, int threads) const {
  Rows rows;
  if (requests.empty()) return rows;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    if (Status fits = impl_->Check(requests[i], i); !fits) return Forward(fits);
    if (requests[i].frames != requests[0].frames) {
      return Fail(ErrorCode::kInconsistent, "the requests have different numbers of frames",
                  "request " + std::to_string(i));
    }
  }
  const std::int64_t T = requests[0].frames, D = 3 * impl_->skeleton->joint_count();
  const std::size_t frames = requests.size() * static_cast<std::size_t>(T);
  rows.joints.resize(frames * static_cast<std::size_t>(D));
  if (!impl_->rest_offset.empty()) rows.rotation.resize(frames * static_cast<std::size_t>(3 * D));
  ParallelFor(static_cast<int>(requests.size()), MotionsAtOnce(impl_->options, T), threads, [&](int begin, int end) {
    const torch::NoGradGuard no_gradient;
    const MotionRequest* first = requests.data() + begin;
    const auto count = static_cast<std::int64_t>(end) - begin;
    std::vector<std::uint64_t> seeds;
    for (std::int64_t b = 0; b < count; ++b) seeds.push_back(first[b].seed);
    Draws draws(std::move(seeds));
    GiveLatents(first, count, *impl_->network, draws);
    const Motions motions = impl_->network->Answer(impl_->BatchOf(first, static_cast<std::size_t>(count)), draws);
    const std::int64_t at = static_cast<std::int64_t>(begin) * T * D;
    torch::from_blob(rows.joints.data() + at, {count, T, D}).copy_(motions.joints.transpose(0, 1));
    if (rows.rotation.empty()) return;
    torch::from_blob(rows.rotation.data() + 3 * at, {count, T, 3 * D})
        .copy_(motions.rotation.reshape({T, count, 3 * D}).transpose(0, 1));
  });
  return rows;
}

Expected<std::vector<float>> MotionGenerator::Joints(const std::vector<MotionRequest>& requests, int threads) const {
  Expected<Rows> rows = Answer(requests, threads);
  if (!rows) return Forward(rows);
  return std::move(rows->joints);
}

/// `rotation` (frames, J, 3, 3): the motion's, and its joints by forward kinematics in double.
void MotionGenerator::AddRotations(const float* rotation, const std::vector<double>& bone_length,
                                   Motion& motion) const {
  const int J = motion.joint_count();
  motion.rotation_reference = impl_->skeleton;
  motion.bone_length = bone_length.empty() ? impl_->bone_length : bone_length;
  motion.skeleton = WithBones(impl_->skeleton, impl_->rest_offset, motion.bone_length);
  for (int f = 0; f < motion.frame_count(); ++f) {
    motion.root_translation.emplace_back(motion.joints.at(f, 0));
    for (int j = 0; j < J; ++j, rotation += 9) {
      const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> matrix(rotation);
      motion.rotation.push_back(Quaterniond(Matrix3d(matrix.cast<double>())).normalized());
    }
  }
  for (int j = 0; j < J; ++j) {
    MakeSignContinuous(motion.rotation.data() + j, static_cast<std::size_t>(motion.frame_count()),
                       static_cast<std::size_t>(J));
  }
  ComputeJoints(motion);
}

Clip GeneratedClip(std::size_t index, const std::string& label, const MotionRequest& request, Motion motion) {
  Clip clip;
  char number[24];
  std::snprintf(number, sizeof(number), "%06zu", index);
  clip.identity.source = "generated";
  clip.identity.person = "network";
  clip.identity.recording = number;
  clip.identity.end_frame = motion.frame_count();
  clip.label = label;
  clip.rate = motion.rate;
  clip.provenance["seed"] = std::to_string(request.seed);
  if (request.fraction > 0.0) {
    clip.provenance["to_seed"] = std::to_string(request.to_seed);
    clip.provenance["fraction"] = FormatDouble(request.fraction);
  }
  if (!request.source_clip.empty()) clip.provenance["bone_lengths_of"] = request.source_clip;
  if (!request.previous_clip.empty()) clip.provenance["continues"] = request.previous_clip;
  clip.motion = std::move(motion);
  return clip;
}

Expected<Dataset> MotionGenerator::Generate(const std::vector<MotionRequest>& requests, int threads) const {
  Dataset set;
  set.skeleton = impl_->skeleton;
  set.joints_only = impl_->rest_offset.empty();
  set.labels = impl_->labels;
  set.recipe = "generated";
  set.created_by = std::string(CreatedBy());
  const int J = impl_->skeleton->joint_count();
  std::map<int, std::vector<std::size_t>> of_length;  // requests of equal length are generated together
  for (std::size_t i = 0; i < requests.size(); ++i) of_length[requests[i].frames].push_back(i);
  set.clips.resize(requests.size());
  for (const auto& [frames, rows] : of_length) {
    std::vector<MotionRequest> part;
    for (const std::size_t row : rows) part.push_back(requests[row]);
    const Expected<Rows> answered = Answer(part, threads);
    if (!answered) return Forward(answered);
    const std::size_t size = static_cast<std::size_t>(frames) * 3 * static_cast<std::size_t>(J);
    for (std::size_t i = 0; i < part.size(); ++i) {
      Motion motion;
      motion.skeleton = set.skeleton;
      motion.rate = impl_->rate;
      motion.joints = JointPositions(frames, J);
      std::copy_n(answered->joints.begin() + static_cast<std::ptrdiff_t>(i * size), size, motion.joints.xyz.begin());
      if (!set.joints_only) AddRotations(answered->rotation.data() + 3 * i * size, part[i].bone_length, motion);
      set.clips[rows[i]] =
          GeneratedClip(rows[i], labels()[static_cast<std::size_t>(part[i].label)], part[i], std::move(motion));
    }
  }
  return set;
}

const NetworkOptions& MotionGenerator::options() const { return impl_->options; }
SkeletonPtr MotionGenerator::skeleton() const { return impl_->skeleton; }
FrameRate MotionGenerator::rate() const { return impl_->rate; }
const std::vector<std::string>& MotionGenerator::labels() const { return impl_->labels; }

}  // namespace mocurate
