#include "train/generators/long_motion.h"

#include <algorithm>
#include <utility>

#include "core/base/random.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/heading.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr int kReleasedExtra = 2;  // extra frames that the released code requests and drops (multiact.md D.2)

bool Continues(const MotionGenerator& network) { return network.options().kind == NetworkKind::kMacvae; }

std::uint64_t SeedOfStep(const MotionRequest& request, std::size_t step) {
  Random random(request.seed, "step", std::to_string(step));
  const std::uint64_t high = random.Next();
  return (high << 32) | random.Next();
}

/// Frames [begin, begin + count) of a motion of rotations.
Motion Frames(const Motion& motion, int begin, int count) {
  const auto J = static_cast<std::ptrdiff_t>(motion.joint_count());
  Motion part;
  part.skeleton = motion.skeleton;
  part.rotation_reference = motion.rotation_reference;
  part.rate = motion.rate;
  part.bone_length = motion.bone_length;
  part.root_translation.assign(motion.root_translation.begin() + begin,
                               motion.root_translation.begin() + begin + count);
  part.rotation.assign(motion.rotation.begin() + begin * J, motion.rotation.begin() + (begin + count) * J);
  part.joints = JointPositions(count, motion.joint_count());
  std::copy_n(motion.joints.xyz.begin() + begin * J * 3, part.joints.xyz.size(), part.joints.xyz.begin());
  return part;
}

void Append(const Motion& more, Motion& motion) {
  if (motion.joints.frames == 0) {
    motion = more;
    return;
  }
  motion.root_translation.insert(motion.root_translation.end(), more.root_translation.begin(),
                                 more.root_translation.end());
  motion.rotation.insert(motion.rotation.end(), more.rotation.begin(), more.rotation.end());
  motion.joints.xyz.insert(motion.joints.xyz.end(), more.joints.xyz.begin(), more.joints.xyz.end());
  motion.joints.frames += more.joints.frames;
}

/// One motion of joined pieces: quaternions in one hemisphere, joints of one person's bones.
void Finish(Motion& motion) {
  const auto J = static_cast<std::size_t>(motion.joint_count());
  for (std::size_t j = 0; j < J; ++j) {
    MakeSignContinuous(motion.rotation.data() + j, static_cast<std::size_t>(motion.frame_count()), J);
  }
  ComputeJoints(motion);
}

/// A long motion in progress.
struct Chain {
  Motion motion;                  ///< generated so far
  Motion last;                    ///< motion that the next step continues
  RigidTransform from_source;     ///< of the previous motion's clip
  std::vector<Segment> segments;  ///< of `motion`

  void Add(const Motion& part, const std::string& label, const char* origin = "generated") {
    const double begin = part.rate.FrameTime(motion.frame_count());
    Append(part, motion);
    segments.push_back({begin, part.rate.FrameTime(motion.frame_count()), label, "", origin});
  }
};

/// The action that a previous motion ends with.
std::string LabelOf(const Clip& previous) {
  return previous.segments.empty() ? previous.label : previous.segments.back().label;
}

/// Rows of all requests, one step after the other.
class LongRun {
 public:
  LongRun(const LongMotionNetworks& networks, const std::vector<MotionRequest>& requests, int threads)
      : networks_(networks), requests_(requests), threads_(threads), chains_(requests.size()) {}

  Expected<std::vector<Chain>> Run(const std::function<bool(double)>& proceed) {
    std::size_t steps = 0;
    for (const MotionRequest& request : requests_) steps = std::max(steps, request.script.size());
    if (Status fits = Check(); !fits) return Forward(fits);
    if (Status begun = Begin(); !begun) return Forward(begun);
    for (std::size_t step = 0; step < steps; ++step) {
      if (!proceed((step + 1.0) / (steps + 1.0))) {
        return Fail(ErrorCode::kInterrupted, "stopped on request", "long motions", "run again");
      }
      std::vector<std::size_t> rows;
      for (std::size_t i = 0; i < requests_.size(); ++i) {
        if (step < requests_[i].script.size()) rows.push_back(i);
      }
      Status done = Continues(*networks_.main) ? ContinueAll(rows, step) : JoinAll(rows, step);
      if (!done) return Forward(done);
    }
    return std::move(chains_);
  }

 private:
  const std::vector<std::string>& labels() const { return networks_.main->labels(); }
  const MotionGenerator& single() const { return Continues(*networks_.main) ? *networks_.first : *networks_.main; }

  /// All scripts, before the first network runs.
  Status Check() const {
    const MotionGenerator* continuing = Continues(*networks_.main) ? networks_.main.get() : networks_.fill.get();
    for (std::size_t i = 0; i < requests_.size(); ++i) {
      const MotionRequest& request = requests_[i];
      const std::string of_request = "request " + std::to_string(i);
      int before = request.previous ? request.previous->motion->frame_count() : request.frames;
      if (Status fits = CheckPrevious(request, of_request); !fits) return fits;
      if (request.previous && request.script.empty()) {
        return Fail(ErrorCode::kInconsistent, "the request has a previous motion and no following action", of_request,
                    "add a script");
      }
      if (!request.bone_length.empty() && request.bone_length.size() != networks_.main->skeleton()->joints.size()) {
        return Fail(ErrorCode::kInconsistent,
                    std::to_string(request.bone_length.size()) + " bone lengths, the skeleton has " +
                        std::to_string(networks_.main->skeleton()->joint_count()) + " joints",
                    of_request);
      }
      if (!request.previous && Continues(*networks_.main) && networks_.first == nullptr) {
        return Fail(ErrorCode::kInconsistent, "no network generates the first action: this one only continues motions",
                    of_request, "add a network of single actions (--first ACTOR.h5), or a motion (--previous SET.h5)");
      }
      for (std::size_t k = 0; k < request.script.size(); ++k) {
        const ScriptStep& step = request.script[k];
        const std::string where = of_request + ", step " + std::to_string(k + 1);
        if (continuing == nullptr) {  // any length can be interpolated
          const bool sound = step.label >= 0 && static_cast<std::size_t>(step.label) < labels().size() &&
                             step.transition_frames > 0 && step.frames > 0;
          if (!sound) return Fail(ErrorCode::kInconsistent, "the class or length is not valid", where);
        } else if (Status fits =
                       continuing->CheckContinuation(step.label, before, step.transition_frames, step.frames, where);
                   !fits) {
          return fits;
        }
        before = step.frames;
      }
    }
    return {};
  }

  /// Checks that a previous motion has the network's skeleton, rest pose and rate, and rotations.
  Status CheckPrevious(const MotionRequest& request, const std::string& where) const {
    if (!request.previous) return {};
    const Motion& motion = *request.previous->motion;
    const Skeleton& skeleton = *networks_.main->skeleton();
    const auto refused = [&](const std::string& what) {
      return Fail(ErrorCode::kInconsistent, "the previous motion " + what, where,
                  "use motions of skeleton '" + skeleton.name + "', fitted, at " + networks_.main->rate().Text() +
                      " frames a second");
    };
    if (motion.joints_only()) return refused("has joints only");
    if (!SameTree(*motion.skeleton, skeleton)) return refused("is of skeleton '" + motion.skeleton->name + "'");
    if (const double apart = RestPosesApart(*motion.rest_pose(), skeleton); apart > kSameRestPose) {
      return refused("refers its rotations to a rest pose " + RoundedText(apart, 2) + " rad apart");
    }
    if (!(motion.rate == networks_.main->rate())) return refused("has " + motion.rate.Text() + " frames a second");
    return {};
  }

  /// Single actions of `label(i)` and `frames(i)` for rows.
  template <class Ask>
  Expected<std::vector<Motion>> Single(const std::vector<std::size_t>& rows, const Ask& ask) const {
    std::vector<MotionRequest> requests;
    for (const std::size_t row : rows) requests.push_back(ask(row));
    auto answered = single().Generate(requests, threads_);
    if (!answered) return Forward(answered);
    std::vector<Motion> motions;
    for (Clip& clip : answered->clips) motions.push_back(std::move(*clip.motion));
    return motions;
  }

  Status Begin() {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < requests_.size(); ++i) {
      if (requests_[i].previous) {
        chains_[i].last = *requests_[i].previous->motion;
        chains_[i].from_source = requests_[i].previous->canonical_from_source;
        if (networks_.keep_previous) chains_[i].Add(chains_[i].last, LabelOf(*requests_[i].previous), "recorded");
      } else {
        rows.push_back(i);
      }
    }
    if (rows.empty()) return {};
    const auto motions = Single(rows, [&](std::size_t row) {
      MotionRequest first;
      first.label = requests_[row].label;
      first.frames = requests_[row].frames;
      first.seed = requests_[row].seed;
      first.bone_length = requests_[row].bone_length;
      return first;
    });
    if (!motions) return Forward(motions);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      Chain& chain = chains_[rows[k]];
      chain.last = (*motions)[k];
      chain.Add(chain.last, labels()[static_cast<std::size_t>(requests_[rows[k]].label)]);
    }
    return {};
  }

  Status ContinueAll(const std::vector<std::size_t>& rows, std::size_t step) {
    std::vector<Continuation> asked;
    for (const std::size_t row : rows) {
      const MotionRequest& request = requests_[row];
      const ScriptStep& action = request.script[step];
      Continuation one;
      one.previous = &chains_[row].last;
      one.canonical_from_source = chains_[row].from_source;
      one.label = action.label;
      one.transition_frames = action.transition_frames;
      one.frames = action.frames + ExtraOf(request, action);
      one.seed = SeedOfStep(request, step);
      one.bone_length = request.bone_length;
      asked.push_back(std::move(one));
    }
    auto made = networks_.main->Continue(asked, threads_);
    if (!made) return Forward(made);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (networks_.snap) {
        const Motion& before = chains_[rows[k]].last;
        Transform(Inverse(FacingFront(before, before.frame_count() - 1)) * FacingFront((*made)[k], 0), (*made)[k]);
      }
      const ScriptStep& action = requests_[rows[k]].script[step];
      Chain& chain = chains_[rows[k]];
      chain.Add(Frames((*made)[k], 0, action.transition_frames), "transition");
      chain.last = Frames((*made)[k], action.transition_frames, action.frames);
      chain.Add(chain.last, labels()[static_cast<std::size_t>(action.label)]);
    }
    return {};
  }

  int ExtraOf(const MotionRequest& request, const ScriptStep& action) const {
    const MacvaeOptions& macvae = networks_.main->options().macvae;
    if (macvae.fills_last() || (request.previous && request.script.size() < 2)) return 0;
    const auto room = static_cast<int>(networks_.main->options().data.frames - macvae.previous_frames) -
                      action.transition_frames - action.frames;
    return std::clamp(room, 0, kReleasedExtra);
  }

  Status JoinAll(const std::vector<std::size_t>& rows, std::size_t step) {
    auto motions = Single(rows, [&](std::size_t row) {
      MotionRequest next;
      next.label = requests_[row].script[step].label;
      next.frames = requests_[row].script[step].frames;
      next.seed = SeedOfStep(requests_[row], step);
      next.bone_length = requests_[row].bone_length;
      return next;
    });
    if (!motions) return Forward(motions);
    std::vector<Continuation> asked;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const ScriptStep& action = requests_[rows[k]].script[step];
      Motion& next = (*motions)[k];
      const Motion& before = chains_[rows[k]].last;
      if (networks_.align) Transform(AlignedTo(before, next, action.transition_frames), next);
      Continuation one;
      one.previous = &before;
      one.canonical_from_source = chains_[rows[k]].from_source;
      one.next = &next;
      one.label = action.label;
      one.transition_frames = action.transition_frames;
      one.frames = action.frames;
      one.bone_length = requests_[rows[k]].bone_length;
      asked.push_back(std::move(one));
    }
    std::vector<Motion> transitions;
    if (networks_.fill) {
      auto filled = networks_.fill->Continue(asked, threads_);
      if (!filled) return Forward(filled);
      transitions = std::move(*filled);
    } else {
      for (const Continuation& one : asked) {
        transitions.push_back(Between(*one.previous, *one.next, one.transition_frames));
      }
    }
    for (std::size_t k = 0; k < rows.size(); ++k) {
      Chain& chain = chains_[rows[k]];
      chain.Add(transitions[k], "transition");
      chain.last = std::move((*motions)[k]);
      chain.Add(chain.last, labels()[static_cast<std::size_t>(requests_[rows[k]].script[step].label)]);
    }
    return {};
  }

  const LongMotionNetworks& networks_;
  const std::vector<MotionRequest>& requests_;
  const int threads_;
  std::vector<Chain> chains_;
};

/// Provenance of the request and its networks: "walk:40,transition:12,kick:30".
void AddProvenance(const LongMotionNetworks& networks, const MotionRequest& request, Clip& clip) {
  const std::vector<std::string>& labels = networks.main->labels();
  std::string script = request.previous_clip.empty()
                           ? labels[static_cast<std::size_t>(request.label)] + ":" + std::to_string(request.frames)
                           : std::string();
  for (const ScriptStep& step : request.script) {
    script += (script.empty() ? "" : ",") + std::string("transition:") + std::to_string(step.transition_frames) + "," +
              labels[static_cast<std::size_t>(step.label)] + ":" + std::to_string(step.frames);
  }
  clip.provenance["script"] = script;
  clip.provenance["network"] = networks.main->options().name;
  if (networks.first != nullptr) clip.provenance["first"] = networks.first->options().name;
  if (networks.fill != nullptr) clip.provenance["fill"] = networks.fill->options().name;
  if (networks.snap) clip.provenance["snap"] = "true";
  if (networks.align) clip.provenance["align"] = "true";
}

}  // namespace

Status LongMotionNetworks::Check() const {
  const auto refused = [](const std::string& what, const std::string& where, const std::string& hint) {
    return Fail(ErrorCode::kInconsistent, what, where, hint);
  };
  const std::string name = main->options().name;
  if (main->options().kind == NetworkKind::kSsmct) {
    return refused("the network fills transitions and generates no actions", name, "use it with --fill");
  }
  if (first && (first->options().NeedsParts() || !first->options().NeedsRotations())) {
    return refused("the network generates no single actions with rotations", first->options().name,
                   "use one of kind actor with a pose of rotations");
  }
  if (!main->options().NeedsRotations()) {
    return refused("the network outputs no rotations, which joining motions needs", name,
                   "use one of kind macvae or actor");
  }
  if (fill && fill->options().kind != NetworkKind::kSsmct) {
    return refused("the network fills no transitions", fill->options().name, "use one of kind ssmct");
  }
  for (const MotionGenerator* other : {first.get(), fill.get()}) {
    if (other == nullptr) continue;
    if (other->labels() != main->labels()) {
      return refused("the network has other classes than '" + name + "'", other->options().name,
                     "use networks trained on one set");
    }
    if (!SameTree(*other->skeleton(), *main->skeleton()) ||
        RestPosesApart(*other->skeleton(), *main->skeleton()) > kSameRestPose) {
      return refused("the network has another skeleton than '" + name + "'", other->options().name,
                     "use networks trained on one set");
    }
    if (!(other->rate() == main->rate())) {
      return refused(
          "the network generates " + other->rate().Text() + " frames a second, '" + name + "' " + main->rate().Text(),
          other->options().name, "use networks trained on one set");
    }
  }
  return {};
}

Motion Between(const Motion& before, const Motion& after, int frames) {
  const int last = before.frame_count() - 1;
  Motion motion = Frames(before, last, 1);
  motion.root_translation.clear();
  motion.rotation.clear();
  for (int k = 0; k < frames; ++k) {
    const double part = (k + 1.0) / (frames + 1.0);
    const Vector3d from = before.root_translation[static_cast<std::size_t>(last)], to = after.root_translation.front();
    motion.root_translation.emplace_back(from + part * (to - from));
    for (int j = 0; j < before.joint_count(); ++j) {
      motion.rotation.push_back(before.rotation_at(last, j).slerp(part, after.rotation_at(0, j)).normalized());
    }
  }
  motion.joints = JointPositions(frames, before.joint_count());
  ComputeJoints(motion);
  return motion;
}

RigidTransform AlignedTo(const Motion& before, const Motion& after, int frames) {
  const int last = before.frame_count() - 1;
  const auto place = [&](int frame) { return before.root_translation[static_cast<std::size_t>(std::max(0, frame))]; };
  RigidTransform aligned;
  aligned.rotation = FacingFront(before, last).rotation.conjugate() * FacingFront(after, 0).rotation;
  Vector3d wanted = place(last) + frames * (place(last) - place(last - 1));
  const Vector3d own = aligned.rotation * after.root_translation.front();
  wanted.y() = own.y();
  aligned.translation = wanted - own;
  return aligned;
}

Expected<Dataset> GenerateLongMotions(const LongMotionNetworks& networks, const std::vector<MotionRequest>& requests,
                                      int threads, const std::function<bool(double)>& proceed) {
  const bool scripts = std::any_of(requests.begin(), requests.end(),
                                   [](const MotionRequest& request) { return !request.script.empty(); });
  if (!scripts && networks.first == nullptr) return networks.main->Generate(requests, threads);
  if (Status sound = networks.Check(); !sound) return Forward(sound);
  auto chains = LongRun(networks, requests, threads).Run(proceed);
  if (!chains) return Forward(chains);
  Dataset set;
  set.skeleton = networks.main->skeleton();
  set.labels = networks.main->labels();
  set.recipe = "generated";
  set.created_by = std::string(CreatedBy());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    Chain& chain = (*chains)[i];
    Finish(chain.motion);
    const int last = requests[i].script.empty() ? requests[i].label : requests[i].script.back().label;
    Clip clip = GeneratedClip(i, set.labels[static_cast<std::size_t>(last)], requests[i], std::move(chain.motion));
    clip.segments = std::move(chain.segments);
    AddProvenance(networks, requests[i], clip);
    set.clips.push_back(std::move(clip));
  }
  return set;
}

}  // namespace mocurate
