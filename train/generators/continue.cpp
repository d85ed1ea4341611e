#include <algorithm>

#include "core/base/parallel.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "train/data/batches.h"
#include "train/generators/generator_impl.h"

namespace mocurate {
namespace {

using RowMatrix = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

constexpr int kSmoothedFrames = 8;  // of a sufficiently long previous motion: the convolution reads two of them

/// Frames [begin, begin + count) of a motion in the frame of a network, as motion b of (P,B,J,3,3) and (P,B,3).
void WritePlaced(const Motion& motion, int begin, int count, const RigidTransform& network_from_world, std::int64_t b,
                 torch::Tensor& rotation, torch::Tensor& place) {
  const std::int64_t B = rotation.size(1), J = rotation.size(2);
  for (int f = 0; f < count; ++f) {
    const std::int64_t at = f * B + b;
    const Vector3d root = network_from_world * motion.root_translation[static_cast<std::size_t>(begin + f)];
    std::copy_n(root.cast<float>().eval().data(), 3, place.data_ptr<float>() + 3 * at);
    for (int j = 0; j < J; ++j) {
      Quaterniond q = motion.rotation_at(begin + f, j);
      if (j == 0) q = network_from_world.rotation * q;
      Eigen::Map<RowMatrix>(rotation.data_ptr<float>() + 9 * (at * J + j)) = q.toRotationMatrix().cast<float>();
    }
  }
}

/// Identities (T,B,J,3,3).
torch::Tensor Identities(std::int64_t T, std::int64_t B, std::int64_t J) {
  return torch::eye(3).expand({T, B, J, 3, 3}).contiguous();
}

}  // namespace

Status MotionGenerator::CheckContinuation(int label, int previous_frames, int transition_frames, int frames,
                                          const std::string& where) const {
  const int L = static_cast<int>(impl_->options.data.frames);
  const MacvaeOptions& macvae = impl_->options.macvae;
  const bool continues = impl_->options.kind == NetworkKind::kMacvae;
  const int needed = continues && !macvae.whole_previous ? static_cast<int>(macvae.previous_frames) : 1;
  const auto refused = [&](const std::string& what, const std::string& hint) {
    return Fail(ErrorCode::kInconsistent, what, where, hint);
  };
  if (label < 0 || static_cast<std::size_t>(label) >= impl_->labels.size()) {
    return refused(
        "label " + std::to_string(label) + ", the network has 0 to " + std::to_string(impl_->labels.size() - 1),
        "use one of its classes");
  }
  if (transition_frames < 1 || transition_frames > L - 2) {
    return refused("a transition of " + Counted(transition_frames, "frame") + "; the positional table has 1 to " +
                       std::to_string(L - 2),
                   "request another length");
  }
  if (frames < 1) return refused("an action of " + Counted(frames, "frame"), "request at least one frame");
  if (previous_frames < needed) {
    return refused("the previous motion has " + Counted(previous_frames, "frame") + ", the network reads the last " +
                       std::to_string(needed),
                   "lengthen the step before");
  }
  if (needed + transition_frames + frames > L) {
    return refused(Counted(transition_frames + frames, "frame") + " of transition and action after " +
                       std::to_string(needed) + " of the previous motion; the network has " + std::to_string(L),
                   "request shorter ones");
  }
  return {};
}

RequestBatch MotionGenerator::Impl::BatchOf(const Continuation* asked, std::size_t count,
                                            std::vector<RigidTransform>& network_from_world) const {
  const auto B = static_cast<std::int64_t>(count), J = static_cast<std::int64_t>(skeleton->joint_count());
  const auto L = static_cast<int>(options.data.frames);
  const bool fills = asked[0].next != nullptr;
  const bool all_frames = fills || !options.macvae.fills_last() || options.macvae.whole_previous;
  std::vector<int> previous(count);
  int longest_previous = 0, longest_next = 0;
  for (std::size_t b = 0; b < count; ++b) {
    const int room = L - asked[b].transition_frames - asked[b].frames;
    const int wanted = all_frames ? room : std::max(kSmoothedFrames, static_cast<int>(options.macvae.previous_frames));
    previous[b] = std::min({room, wanted, asked[b].previous->frame_count()});
    longest_previous = std::max(longest_previous, previous[b]);
    longest_next = std::max(longest_next, asked[b].frames);
  }
  RequestBatch batch;
  batch.label = torch::empty({B}, torch::kInt64);
  batch.parts = torch::empty({B, 3}, torch::kInt64);
  batch.word = torch::zeros({B, 3}, torch::kInt64);
  batch.bone_length = torch::empty({B, J});
  batch.previous_rotation = Identities(longest_previous, B, J);
  batch.previous_place = torch::zeros({longest_previous, B, 3});
  if (fills) {
    batch.next_rotation = Identities(longest_next, B, J);
    batch.next_place = torch::zeros({longest_next, B, 3});
  }
  for (std::size_t b = 0; b < count; ++b) {
    const Continuation& one = asked[b];
    const auto row = static_cast<std::int64_t>(b);
    const int last = one.previous->frame_count() - 1;
    network_from_world.push_back(
        NetworkFromWorld(options.macvae.canonical, rest_axes, one.previous->rotation_at(last, 0),
                         one.previous->root_translation[static_cast<std::size_t>(last)], one.canonical_from_source));
    batch.label.data_ptr<std::int64_t>()[row] = one.label;
    const std::int64_t parts[] = {previous[b], one.transition_frames, one.frames};
    // the previous label is used in training only
    const std::int64_t words[] = {one.label, static_cast<std::int64_t>(labels.size()), one.label};
    std::copy_n(parts, 3, batch.parts.data_ptr<std::int64_t>() + 3 * row);
    std::copy_n(words, 3, batch.word.data_ptr<std::int64_t>() + 3 * row);
    const std::vector<double>& length = one.bone_length.empty() ? bone_length : one.bone_length;
    std::copy(length.begin(), length.end(), batch.bone_length.data_ptr<float>() + row * J);
    WritePlaced(*one.previous, last + 1 - previous[b], previous[b], network_from_world.back(), row,
                batch.previous_rotation, batch.previous_place);
    if (fills) {
      WritePlaced(*one.next, 0, one.frames, network_from_world.back(), row, batch.next_rotation, batch.next_place);
    }
  }
  return batch;
}

Expected<std::vector<Motion>> MotionGenerator::Continue(const std::vector<Continuation>& asked, int threads) const {
  const bool fills = impl_->options.kind == NetworkKind::kSsmct;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const std::string where = "motion " + std::to_string(i);
    if (Status fits = CheckContinuation(asked[i].label, asked[i].previous->frame_count(), asked[i].transition_frames,
                                        asked[i].frames, where);
        !fits) {
      return Forward(fits);
    }
    const std::size_t bones = asked[i].bone_length.size();
    if (bones > 0 && bones != impl_->skeleton->joints.size()) {
      return Fail(ErrorCode::kInconsistent, "the bone lengths do not match the skeleton", where);
    }
    if (asked[i].previous->joints_only() || (asked[i].next != nullptr) != fills) {
      return Fail(ErrorCode::kInconsistent, "the motion has no rotations, or the network cannot fill transitions",
                  where);
    }
  }
  const int J = impl_->skeleton->joint_count();
  std::vector<Motion> motions(asked.size());
  ParallelFor(static_cast<int>(asked.size()), MotionsAtOnce(impl_->options, impl_->options.data.frames), threads,
              [&](int begin, int end) {
                const torch::NoGradGuard no_gradient;
                const auto count = static_cast<std::size_t>(end - begin);
                std::vector<std::uint64_t> seeds;
                for (int i = begin; i < end; ++i) seeds.push_back(asked[static_cast<std::size_t>(i)].seed);
                std::vector<RigidTransform> network_from_world;
                const RequestBatch batch = impl_->BatchOf(asked.data() + begin, count, network_from_world);
                Draws draws(std::move(seeds));
                const Motions made = impl_->network->Answer(batch, draws);
                for (std::size_t b = 0; b < count; ++b) {
                  const Continuation& one = asked[static_cast<std::size_t>(begin) + b];
                  const int frames = one.transition_frames + (fills ? 0 : one.frames);
                  const auto row = static_cast<std::int64_t>(b);
                  const torch::Tensor joints = made.joints.slice(0, 0, frames).select(1, row).contiguous();
                  const torch::Tensor rotation = made.rotation.slice(0, 0, frames).select(1, row).contiguous();
                  Motion& motion = motions[static_cast<std::size_t>(begin) + b];
                  motion.skeleton = impl_->skeleton;
                  motion.rate = impl_->rate;
                  motion.joints = JointPositions(frames, J);
                  std::copy_n(joints.data_ptr<float>(), motion.joints.xyz.size(), motion.joints.xyz.begin());
                  AddRotations(rotation.data_ptr<float>(), one.bone_length, motion);
                  const RigidTransform world_from_network = Inverse(network_from_world[b]);
                  Transform(world_from_network, motion);
                }
              });
  return motions;
}

}  // namespace mocurate
