#include "ingest/sources/ntu_exchanged_ids.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr int kLongestLost = 10;        // frames; two people change places in a second
constexpr double kNearestBodies = 0.3;  // metres between the joints of two people, at the least
constexpr double kFramePace = 0.1;      // metres: 3 m/s at the sensor's 30 Hz
constexpr double kGoesOn = 0.3;         // of the jump: that the other's pose goes on
constexpr int kFewestSharedJoints = 8;  // seen in both frames
constexpr std::size_t kMostExchanges = 100;

using IdPair = std::pair<std::uint64_t, std::uint64_t>;

/// Mean distance of the joints that are seen in both, metres; nothing where these are few.
std::optional<double> JointDistance(const NtuBody& a, const NtuBody& b) {
  double sum = 0.0;
  int shared = 0;
  const auto seen = [](const NtuJoint& joint) {
    return joint.tracking != 0 && (joint.x_m != 0.0 || joint.y_m != 0.0 || joint.z_m != 0.0);
  };
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    const NtuJoint &from = a.joints[j], &to = b.joints[j];
    if (!seen(from) || !seen(to)) continue;
    sum += Vector3d(to.x_m - from.x_m, to.y_m - from.y_m, to.z_m - from.z_m).stableNorm();
    ++shared;
  }
  return shared < kFewestSharedJoints ? std::nullopt : std::optional<double>(sum / shared);
}

/// Two bodies of one frame.
struct BodyPair {
  const NtuBody* a = nullptr;
  const NtuBody* b = nullptr;
};

BodyPair PairIn(const std::vector<NtuBody>& bodies, const IdPair& ids) {
  BodyPair pair;
  for (const NtuBody& body : bodies) {
    if (body.id == ids.first) pair.a = &body;
    if (body.id == ids.second) pair.b = &body;
  }
  return pair;
}

/// How two bodies go on from where they were last seen together.
struct IdExchange {
  double jump = 0.0;   ///< metres, the shorter of each to its own last pose
  double apart = 0.0;  ///< the longer of each to the other's
};

std::optional<IdExchange> IdExchangeBetween(const BodyPair& before, const BodyPair& now, int frames) {
  const auto own_a = JointDistance(*before.a, *now.a), own_b = JointDistance(*before.b, *now.b);
  const auto other_a = JointDistance(*before.b, *now.a), other_b = JointDistance(*before.a, *now.b);
  if (!own_a || !own_b || !other_a || !other_b) return std::nullopt;
  const IdExchange exchange{std::min(*own_a, *own_b), std::max(*other_a, *other_b)};
  const bool jumps = exchange.jump >= kNearestBodies + kFramePace * (frames - 1);
  return jumps && exchange.apart <= kGoesOn * exchange.jump ? std::optional<IdExchange>(exchange) : std::nullopt;
}

/// Goes through the frames and gives ids back as it finds them exchanged.
class IdKeeper {
 public:
  explicit IdKeeper(std::vector<std::vector<NtuBody>>& frames) : frames_(frames) {}

  std::vector<Finding> Run(bool mend) {
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      for (NtuBody& body : frames_[f]) {
        const auto held = given_.find(body.id);
        if (held != given_.end()) body.id = held->second;
      }
      for (std::size_t i = 0; i < frames_[f].size(); ++i) {
        for (std::size_t k = i + 1; k < frames_[f].size(); ++k)
          Judge(f, std::minmax(frames_[f][i].id, frames_[f][k].id));
      }
    }
    for (Finding& finding : findings_) {
      finding.action = mend ? FindingAction::kRepaired : FindingAction::kFlagged;
      finding.message += ", in frames " + std::to_string(finding.frame_begin) + " to " +
                         std::to_string(finding.frame_end - 1) +
                         (mend ? "; exchanged back there" : "; ingest.source.people.stitch exchanges them back");
    }
    return std::move(findings_);
  }

 private:
  void Judge(std::size_t f, const IdPair& ids) {
    const auto last = last_.find(ids);
    const auto now = static_cast<int>(f);
    if (last != last_.end() && now - last->second <= kLongestLost && findings_.size() < kMostExchanges) {
      const auto before = static_cast<std::size_t>(last->second);
      const auto exchange =
          IdExchangeBetween(PairIn(frames_[before], ids), PairIn(frames_[f], ids), now - last->second);
      if (exchange) GiveBack(f, ids, *exchange);
    }
    last_[ids] = now;
  }

  void GiveBack(std::size_t f, const IdPair& ids, const IdExchange& exchange) {
    for (NtuBody& body : frames_[f]) {
      if (body.id == ids.first || body.id == ids.second) body.id = body.id == ids.first ? ids.second : ids.first;
    }
    // What the file calls these two from here on.
    std::uint64_t of_first = ids.first, of_second = ids.second;
    for (const auto& [in_file, taken] : given_) {
      if (taken == ids.first) of_first = in_file;
      if (taken == ids.second) of_second = in_file;
    }
    given_[of_first] = ids.second;
    given_[of_second] = ids.first;
    const auto open = open_.find(ids);
    if (open != open_.end()) {
      findings_[open->second].frame_end = static_cast<int>(f);
      open_.erase(open);
      return;
    }
    open_[ids] = findings_.size();
    findings_.push_back(FrameFinding(
        "ids_exchanged", static_cast<int>(f), static_cast<int>(frames_.size()), "", exchange.jump,
        "body ids " + std::to_string(ids.first) + " and " + std::to_string(ids.second) +
            " are exchanged: each goes on within " + Digits(exchange.apart) + " m of where the other was, " +
            Digits(exchange.jump) + " m and more from where it was itself"));
  }

  std::vector<std::vector<NtuBody>>& frames_;
  std::map<std::uint64_t, std::uint64_t> given_;  ///< id that is taken for one of the file
  std::map<IdPair, int> last_;                    ///< frame in which both were last seen
  std::map<IdPair, std::size_t> open_;            ///< finding of those that are exchanged now
  std::vector<Finding> findings_;
};

}  // namespace

void NoteExchangedIds(bool mend, NtuSkeleton& skeleton) {
  std::vector<std::vector<NtuBody>> copy;
  if (!mend) copy = skeleton.frames;
  for (Finding& finding : IdKeeper(mend ? skeleton.frames : copy).Run(mend))
    skeleton.findings.push_back(std::move(finding));
}

}  // namespace mocurate
