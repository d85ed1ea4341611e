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

std::uint64_t SeedOfClip(const RemakeOptions& options, const std::string& purpose, const std::string& clip) {
  Random random(static_cast<std::uint64_t>(options.seed), purpose, clip);
  const std::uint64_t high = random.Next();
  return (high << 32) | random.Next();
}

/// A random other clip of the same class for each clip; the clip itself where it is the only one.
std::vector<std::size_t> Partners(const Dataset& set, const RemakeOptions& options) {
  std::map<std::string, std::vector<std::size_t>> of_class;
  for (std::size_t i = 0; i < set.clips.size(); ++i) of_class[set.clips[i].label].push_back(i);
  std::vector<std::size_t> partners;
  std::map<std::string, std::size_t> seen;  // index of the clip in its class
  for (const Clip& clip : set.clips) {
    const std::vector<std::size_t>& same = of_class[clip.label];
    const std::size_t own = seen[clip.label]++, others = same.size() - 1;
    Random random(static_cast<std::uint64_t>(options.seed), "partner", clip.id());
    std::size_t drawn = others == 0 ? own : static_cast<std::size_t>(random.Below(others));
    if (others > 0 && drawn >= own) ++drawn;
    partners.push_back(same[drawn]);
  }
  return partners;
}

/// Clips of equal length that are processed at once.
std::vector<std::vector<int>> ChunksOf(const Dataset& set, const NetworkOptions& options) {
  std::map<int, std::vector<int>> of_length;
  for (std::size_t i = 0; i < set.clips.size(); ++i) {
    of_length[set.clips[i].motion->frame_count()].push_back(static_cast<int>(i));
  }
  std::vector<std::vector<int>> chunks;
  for (const auto& [frames, rows] : of_length) {
    const auto most = static_cast<std::size_t>(MotionsAtOnce(options, frames));
    for (std::size_t begin = 0; begin < rows.size(); begin += most) {
      const auto first = rows.begin() + static_cast<std::ptrdiff_t>(begin);
      chunks.emplace_back(first, first + static_cast<std::ptrdiff_t>(std::min(most, rows.size() - begin)));
    }
  }
  return chunks;
}

/// Latents (1,B,E) of clips of equal length.
torch::Tensor LatentsOf(Network& network, const TrainingSet& packed, const std::vector<int>& rows,
                        const std::vector<int>& labels, std::vector<std::uint64_t> seeds) {
  TrainingDataOptions whole;
  whole.frames = packed.clips[static_cast<std::size_t>(rows.front())].frames;
  MotionRows motions = MakeMotionRows(packed, whole, rows, 0, "remake", false);
  const auto T = whole.frames, B = static_cast<std::int64_t>(rows.size());
  const std::int64_t J = packed.skeleton->joint_count();
  Batch batch;
  batch.motion = torch::from_blob(motions.motion.data(), {T, B, 3 * J});
  if (!motions.rotation.empty()) batch.rotation = torch::from_blob(motions.rotation.data(), {T, B, J, 3, 3});
  batch.label = torch::empty({B}, torch::kInt64);
  for (std::int64_t b = 0; b < B; ++b) {
    batch.label.data_ptr<std::int64_t>()[b] = labels[static_cast<std::size_t>(rows[static_cast<std::size_t>(b)])];
  }
  batch.whole = B;
  Draws draws(std::move(seeds));
  return network.Encode(batch, draws);
}

}  // namespace

Expected<std::vector<int>> MotionGenerator::LabelsOf(const Dataset& set) const {
  const std::string way_out = "use a set of skeleton '" + impl_->skeleton->name + "' with the network's labels";
  if (impl_->network->latent_size() == 0) {
    return Fail(ErrorCode::kInconsistent, "the network has no encoder", impl_->options.name,
                "use a network of kind actor");
  }
  if (!SameTree(*set.skeleton, *impl_->skeleton)) {
    return Fail(ErrorCode::kInconsistent,
                "the set is of skeleton '" + set.skeleton->name + "', the network of '" + impl_->skeleton->name + "'",
                "motions", way_out);
  }
  if (const double apart = RestPosesApart(*set.skeleton, *impl_->skeleton); apart > kSameRestPose) {
    return Fail(ErrorCode::kInconsistent,
                "the set's rotations refer to a rest pose " + RoundedText(apart, 2) + " rad apart", "motions", way_out);
  }
  std::vector<int> labels;
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
      return Fail(ErrorCode::kInconsistent, "the clip has joints only, the network encodes rotations", clip.id(),
                  way_out);
    }
    labels.push_back(request.label);
  }
  return labels;
}

Expected<Dataset> MotionGenerator::Remake(Dataset set, const RemakeOptions& options, int threads,
                                          const std::function<bool(double)>& proceed) const {
  const Expected<std::vector<int>> labels = LabelsOf(set);
  if (!labels) return Forward(labels);
  const bool encodes = options.rule != RemakeRule::kGenerate;
  const std::string purpose = Name(options.rule);
  std::vector<std::uint64_t> seeds;
  for (const Clip& clip : set.clips) seeds.push_back(SeedOfClip(options, purpose, clip.id()));
  const std::vector<std::vector<int>> chunks = ChunksOf(set, impl_->options);
  // Threads process one round of chunks between two calls of `proceed`; encoding is the first half of the progress.
  const auto rounds = [&](double begin, const std::function<void(const std::vector<int>&)>& work) {
    const int all = static_cast<int>(chunks.size());
    for (int first = 0; first < all; first += threads) {
      if (!proceed(begin + 0.5 * first / all)) return false;
      ParallelFor(std::min(threads, all - first), 1, threads, [&](int from, int to) {
        const torch::NoGradGuard no_gradient;
        for (int k = from; k < to; ++k) work(chunks[static_cast<std::size_t>(first + k)]);
      });
    }
    return true;
  };
  const Error stopped{ErrorCode::kInterrupted, "stopped on request", impl_->options.name, "run again"};
  std::vector<torch::Tensor> latents(set.clips.size());  // (E) each
  if (encodes) {
    TrainingSetNeeds needs{impl_->options.NeedsRotations() && !set.joints_only};
    needs.whole = true;
    const auto read = PackTrainingSet(set, needs);
    if (!read) return Forward(read);
    const TrainingSet& packed = *read;
    const bool whole = rounds(0.0, [&](const std::vector<int>& rows) {
      std::vector<std::uint64_t> own;
      for (const int row : rows) own.push_back(seeds[static_cast<std::size_t>(row)]);
      const torch::Tensor encoded = LatentsOf(*impl_->network, packed, rows, *labels, std::move(own));
      for (std::size_t b = 0; b < rows.size(); ++b) {
        latents[static_cast<std::size_t>(rows[b])] = encoded[0][static_cast<std::int64_t>(b)].clone();
      }
    });
    if (!whole) return tl::unexpected<Error>(stopped);
  }
  if (options.rule == RemakeRule::kInterpolate) {
    const std::vector<std::size_t> partners = Partners(set, options);
    const std::vector<torch::Tensor> own = latents;
    for (std::size_t i = 0; i < set.clips.size(); ++i) {
      const double fraction = Random(seeds[i], "fraction").Uniform();
      latents[i] = own[i] + fraction * (own[partners[i]] - own[i]);
      set.clips[i].provenance["interpolated_with"] = set.clips[partners[i]].id();
      set.clips[i].provenance["fraction"] = FormatDouble(fraction);
    }
  }
  const bool whole = rounds(0.5, [&](const std::vector<int>& rows) {
    std::vector<MotionRequest> requests;
    std::vector<std::uint64_t> own;
    std::vector<torch::Tensor> given;
    for (const int row : rows) {
      const auto at = static_cast<std::size_t>(row);
      MotionRequest request;
      request.label = (*labels)[at];
      request.frames = set.clips[at].motion->frame_count();
      request.seed = seeds[at];
      request.bone_length = set.clips[at].motion->bone_length;
      requests.push_back(std::move(request));
      own.push_back(seeds[at]);
      if (encodes) given.push_back(latents[at]);
    }
    Draws draws(std::move(own));
    if (encodes) draws.Give(kMotionLatent, torch::stack(given).unsqueeze(0));
    const Motions motions = impl_->network->Answer(impl_->BatchOf(requests.data(), requests.size()), draws);
    const int J = impl_->skeleton->joint_count();
    for (std::size_t b = 0; b < rows.size(); ++b) {
      Clip& clip = set.clips[static_cast<std::size_t>(rows[b])];
      Motion made;
      made.skeleton = impl_->skeleton;
      made.rate = clip.motion->rate;
      made.joints = JointPositions(requests[b].frames, J);
      const auto motion = static_cast<std::int64_t>(b);
      const torch::Tensor joints = motions.joints.select(1, motion).contiguous();
      const Vector3d root = clip.motion->joints.at(0, 0);  // positions are relative to the clip's first one
      for (std::size_t k = 0; k < made.joints.xyz.size(); ++k) {
        made.joints.xyz[k] = joints.data_ptr<float>()[k] + root[static_cast<Eigen::Index>(k % 3)];
      }
      if (motions.rotation.defined()) {
        const torch::Tensor rotation = motions.rotation.select(1, motion).contiguous();
        AddRotations(rotation.data_ptr<float>(), requests[b].bone_length, made);
      }
      // What it is made of was inferred in these frames; `generate` reads none.
      if (encodes && clip.motion->state.size() == made.joints.xyz.size() / 3) made.state = clip.motion->state;
      clip.motion = std::move(made);
      clip.provenance["seed"] = std::to_string(requests[b].seed);
    }
  });
  if (!whole) return tl::unexpected<Error>(stopped);
  set.created_by = std::string(CreatedBy());
  set.recipe = purpose + " from: " + set.recipe;
  set.joints_only = impl_->rest_offset.empty();
  return set;
}

}  // namespace mocurate
