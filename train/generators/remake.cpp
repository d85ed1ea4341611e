#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "train/data/batches.h"
#include "train/generators/generator_impl.h"

namespace mocurate {
namespace {

constexpr const char* kLatent = "generator.latent";

std::uint64_t SeedOfClip(const RemakeOptions& options, const char* purpose, const std::string& clip) {
  Random random(static_cast<std::uint64_t>(options.seed), purpose, clip);
  const std::uint64_t high = random.Next();
  return (high << 32) | random.Next();
}

/// The clips of a set as a network encodes them.
class EncodedClips {
 public:
  EncodedClips(const Dataset& set, const TrainingSet& packed, Network& network)
      : set_(set), packed_(packed), network_(network) {}

  /// Latent (1,1,E) of a clip, its noise drawn by `seed`.
  torch::Tensor operator()(int clip, int label, std::uint64_t seed) const {
    const std::int64_t T = set_.clips[static_cast<std::size_t>(clip)].motion->frame_count();
    const std::int64_t J = set_.skeleton->joint_count();
    TrainingDataOptions whole;
    whole.frames = T;
    MotionRows rows = MakeMotionRows(packed_, whole, {clip}, 0, "remake", false);
    Batch batch;
    batch.motion = torch::from_blob(rows.motion.data(), {T, 1, 3 * J});
    if (!rows.rotation.empty()) batch.rotation = torch::from_blob(rows.rotation.data(), {T, 1, J, 3, 3});
    batch.label = torch::tensor({static_cast<std::int64_t>(label)});
    batch.whole = 1;
    Draws draws(std::vector<std::uint64_t>{seed});
    return network_.Encode(batch, draws);
  }

 private:
  const Dataset& set_;
  const TrainingSet& packed_;
  Network& network_;
};

/// For each clip another one of its class, drawn; the clip itself where it is the only one.
std::vector<int> Partners(const Dataset& set, const RemakeOptions& options) {
  std::map<std::string, std::vector<int>> of_class;
  for (std::size_t i = 0; i < set.clips.size(); ++i) of_class[set.clips[i].label].push_back(static_cast<int>(i));
  std::vector<int> partners;
  std::map<std::string, int> seen;  // place of the clip in its class
  for (const Clip& clip : set.clips) {
    const std::vector<int>& same = of_class[clip.label];
    const int own = seen[clip.label]++;
    Random random(static_cast<std::uint64_t>(options.seed), "partner", clip.id());
    const auto others = static_cast<std::uint64_t>(same.size() - 1);
    const int drawn = others == 0 ? own : static_cast<int>(random.Below(others));
    partners.push_back(same[static_cast<std::size_t>(drawn + (others > 0 && drawn >= own ? 1 : 0))]);
  }
  return partners;
}

}  // namespace

Status MotionGenerator::CheckSet(const Dataset& set) const {
  const std::string way_out = "give a set of skeleton '" + impl_->skeleton->name + "' with the network's labels";
  if (impl_->network->latent_size() == 0) {
    return Fail(ErrorCode::kInconsistent, "the network encodes no motions", impl_->options.name,
                "give a network of kind actor");
  }
  if (!SameTree(*set.skeleton, *impl_->skeleton)) {
    return Fail(ErrorCode::kInconsistent,
                "the set is of skeleton '" + set.skeleton->name + "', the network of '" + impl_->skeleton->name + "'",
                "motions", way_out);
  }
  if (const double apart = RestPosesApart(*set.skeleton, *impl_->skeleton); apart > kSameRestPose) {
    return Fail(ErrorCode::kInconsistent,
                "the set's rotations are counted from a rest pose " + RoundedText(apart, 2) + " rad apart", "motions",
                way_out);
  }
  for (const Clip& clip : set.clips) {
    const auto found = std::find(impl_->labels.begin(), impl_->labels.end(), clip.label);
    if (found == impl_->labels.end()) {
      return Fail(ErrorCode::kInconsistent, "the network has no class '" + clip.label + "'", clip.id(), way_out);
    }
    if (!clip.motion) return Fail(ErrorCode::kInconsistent, "the clip has no motion", clip.id(), way_out);
    MotionRequest request;
    request.label = static_cast<int>(found - impl_->labels.begin());
    request.frames = clip.motion->frame_count();
    if (Status fits = impl_->Check(request, 0); !fits) {
      return Fail(fits.error().code, fits.error().what, clip.id(), fits.error().hint);
    }
    if (impl_->options.NeedsRotations() && clip.motion->joints_only()) {
      return Fail(ErrorCode::kInconsistent, "the clip has joints alone, the network encodes rotations", clip.id(),
                  way_out);
    }
  }
  return {};
}

Expected<Dataset> MotionGenerator::Remake(const Dataset& set, const RemakeOptions& options, int threads) const {
  if (Status fits = CheckSet(set); !fits) return Forward(fits);
  const TrainingSet packed = PackTrainingSet(set, impl_->options.NeedsRotations() && !set.joints_only);
  const EncodedClips encode(set, packed, *impl_->network);
  const std::vector<int> partners =
      options.rule == RemakeRule::kInterpolate ? Partners(set, options) : std::vector<int>();
  const auto label_of = [&](const std::string& label) {
    return static_cast<int>(std::find(impl_->labels.begin(), impl_->labels.end(), label) - impl_->labels.begin());
  };
  Dataset result = set;
  result.created_by = std::string(CreatedBy());
  result.recipe = (options.rule == RemakeRule::kDenoise       ? "denoised: "
                   : options.rule == RemakeRule::kInterpolate ? "interpolated: "
                                                              : "generated for: ") +
                  set.recipe;
  result.joints_only = impl_->rest_offset.empty();
  ParallelFor(static_cast<int>(set.clips.size()), 1, threads, [&](int begin, int end) {
    const torch::NoGradGuard no_gradient;
    for (int i = begin; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      Clip& clip = result.clips[at];
      MotionRequest request;
      request.label = label_of(clip.label);
      request.frames = clip.motion->frame_count();
      request.seed = SeedOfClip(options, "denoise", clip.id());
      request.bone_length = clip.motion->bone_length;
      Draws draws(std::vector<std::uint64_t>{request.seed});
      torch::Tensor latent;
      if (options.rule != RemakeRule::kGenerate) latent = encode(i, request.label, request.seed);
      if (options.rule == RemakeRule::kInterpolate) {
        const int partner = partners[at];
        const Clip& other = set.clips[static_cast<std::size_t>(partner)];
        Random random(request.seed, "fraction");
        const double fraction = random.Uniform();
        const torch::Tensor there = encode(partner, request.label, SeedOfClip(options, "partner's noise", clip.id()));
        latent = latent + fraction * (there - latent);
        clip.provenance["interpolated_with"] = other.id();
        clip.provenance["fraction"] = FormatDouble(fraction);
      }
      if (latent.defined()) draws.Give(kLatent, latent);
      const Motions motions = impl_->network->Answer(impl_->BatchOf(&request, 1), draws);
      Motion made;
      made.skeleton = impl_->skeleton;
      made.rate = clip.motion->rate;
      made.joints = JointPositions(request.frames, impl_->skeleton->joint_count());
      const torch::Tensor joints = motions.joints.contiguous();
      const Vector3d root = clip.motion->joints.at(0, 0);  // places are counted from the clip's first one
      for (std::size_t k = 0; k < made.joints.xyz.size(); ++k) {
        made.joints.xyz[k] = joints.data_ptr<float>()[k] + root[static_cast<Eigen::Index>(k % 3)];
      }
      if (motions.rotation.defined()) {
        const torch::Tensor rotation = motions.rotation.contiguous();
        AddRotations(rotation.data_ptr<float>(), request, made);
      }
      clip.motion = std::move(made);
      clip.provenance[options.rule == RemakeRule::kDenoise ? "denoised_with_seed" : "seed"] =
          std::to_string(request.seed);
    }
  });
  return result;
}

}  // namespace mocurate
