#include "ingest/people/merge_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace mocurate {
namespace {

constexpr double kLateFrames = 0.5;     // a finding
constexpr double kVeryLate_s = 0.05;    // a warning
constexpr double kAgree = 0.1;          // metres
constexpr double kCauchySpread = 0.05;  // metres, of Cauchy weights
constexpr int kMergeTurns = 8;
constexpr double kFarBetter = 0.5;  // of the distance between joints, for an offset beyond the limit

/// All people of a camera side by side, frame by frame.
struct Scene {
  JointPositions positions;
  std::vector<double> confidence, time_s;

  TrackedPoints view() const { return {positions, confidence, time_s}; }
};

/// People `order[slot]` (-1: none) in the slots; frame `first` is at time 0.
Scene SceneOf(const CameraPeople& camera, const std::vector<int>& order, double rate_hz, int first = 0) {
  Scene scene;
  const int joints = camera.people.front().positions.joints;
  const auto slots = static_cast<int>(order.size());
  scene.positions = JointPositions(camera.frames, slots * joints);
  scene.confidence.assign(static_cast<std::size_t>(camera.frames) * slots * joints, 0.0);
  for (int f = 0; f < camera.frames; ++f) scene.time_s.push_back((f - first) / rate_hz);
  for (int slot = 0; slot < slots; ++slot) {
    const int own = order[static_cast<std::size_t>(slot)];
    if (own < 0) continue;
    const PersonTrack& person = camera.people[static_cast<std::size_t>(own)];
    for (std::size_t row = 0; row < person.frames.size(); ++row) {
      const int f = person.frames[row];
      for (int k = 0; k < joints; ++k) {
        const auto at = static_cast<std::size_t>(f) * slots * joints + static_cast<std::size_t>(slot * joints + k);
        scene.confidence[at] = person.confidence[row * static_cast<std::size_t>(joints) + static_cast<std::size_t>(k)];
        scene.positions.at(f, slot * joints + k) = person.positions.at(static_cast<int>(row), k);
      }
    }
  }
  return scene;
}

std::vector<int> InOrder(const CameraPeople& camera, std::size_t slots) {
  std::vector<int> order(slots, -1);
  std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(camera.people.size()), 0);
  return order;
}

/// How two cameras fit, with the people of b in the order that fits best.
struct Pair {
  std::optional<ViewAlignment> alignment;
  std::vector<int> order;
};

/// Offsets of clocks are looked for within `most_offset_s` of what is declared; the result's is between the frames 0.
Pair AlignPair(const CameraPeople& a, const CameraPeople& b, std::size_t slots, double rate_hz, double most_offset_s) {
  Pair best;
  const Scene of_a = SceneOf(a, InOrder(a, slots), rate_hz, a.first);
  std::vector<int> order = InOrder(b, slots);
  std::sort(order.begin(), order.end());
  do {
    const Scene of_b = SceneOf(b, order, rate_hz, b.first);
    std::optional<ViewAlignment> found = AlignViews(of_a.view(), of_b.view(), most_offset_s);
    if (!found || (best.alignment && best.alignment->median <= found->median)) continue;
    best.alignment = found;
    best.order = order;
  } while (std::next_permutation(order.begin(), order.end()));
  if (best.alignment) best.alignment->offset_s += (a.first - b.first) / rate_hz;
  return best;
}

bool Agrees(const Pair& pair, const ViewOptions& options) {
  return pair.alignment && !pair.alignment->Mirrored() && pair.alignment->median <= options.max_disagreement;
}

std::string DigitsOfMillimetres(double metres) { return Digits(1e3 * metres) + " mm"; }

std::string WhyNot(const Pair& pair, const ViewOptions& options) {
  if (!pair.alignment) return "they see too little in common";
  const ViewAlignment& view = *pair.alignment;
  if (view.Mirrored()) {
    return "one is mirrored: joints lie " + DigitsOfMillimetres(view.mirrored_median) + " apart with it flipped, " +
           DigitsOfMillimetres(view.median) + " without";
  }
  return "joints lie " + DigitsOfMillimetres(view.median) + " apart when aligned, more than " +
         DigitsOfMillimetres(options.max_disagreement);
}

/// A camera that recorded another time than the others, as an error; nothing where it did not. `pair`: how b fits a.
std::optional<Error> FindApartClocks(const CameraPeople& a, const CameraPeople& b, const Pair& pair, std::size_t slots,
                                     double rate_hz, const ViewOptions& options, const std::string& where) {
  if (a.declared || b.declared) return std::nullopt;
  const Pair far = AlignPair(a, b, slots, rate_hz, std::max(a.frames, b.frames) / rate_hz);
  const bool beyond = Agrees(far, options) && far.alignment->offset_known &&
                      std::abs(far.alignment->offset_s) > options.max_offset_s &&
                      (!Agrees(pair, options) || far.alignment->median < kFarBetter * pair.alignment->median);
  if (!beyond && !Agrees(pair, options)) return std::nullopt;
  const Pair& fits = beyond ? far : pair;
  const double offset = fits.alignment->offset_s * rate_hz;  // frames of a at which b begins
  const double shared = std::min<double>(a.frames, offset + b.frames) - std::max(0.0, offset);
  if (!beyond && 2.0 * shared >= std::min(a.frames, b.frames)) return std::nullopt;
  const bool later = offset > 0.0;
  const auto frames = std::llround(std::abs(offset));
  Error error{ErrorCode::kInconsistent,
              "camera '" + b.view + "' began " + Digits(std::abs(fits.alignment->offset_s)) + " s (" +
                  std::to_string(frames) + " frames) " + (later ? "after" : "before") + " '" + a.view +
                  "': they share " + std::to_string(std::llround(std::max(0.0, shared))) + " of " +
                  std::to_string(std::min(a.frames, b.frames)) + " frames",
              where,
              "write ingest.source.first_frame: {" + b.view + ": " + std::to_string(later ? 1 - frames : 1 + frames) +
                  "}, or raise ingest.source.views.max_offset, or take a camera out"};
  error.reason = Reason::kViewNumbering;
  error.number = static_cast<double>(later ? frames : -frames);
  return error;
}

/// `declared_s`: the offset that is declared.
void NoteUsed(const CameraPeople& camera, const std::string& reference, ViewAlignment view, double declared_s,
              double rate_hz, std::vector<Finding>& findings) {
  view.offset_s -= declared_s;
  const double ms = 1e3 * view.offset_s;
  if (view.offset_known && std::abs(view.offset_s) >= kLateFrames / rate_hz) {
    findings.push_back(
        MakeFinding("clock_offset", std::abs(view.offset_s) > kVeryLate_s ? Severity::kWarning : Severity::kInfo, ms,
                    camera.view + " began " + Digits(std::abs(ms)) + " ms " + (ms > 0.0 ? "after " : "before ") +
                        reference + ", give or take " + Digits(1e3 * view.offset_sigma_s) + " ms" + "; taken out",
                    FindingAction::kKept));
  }
}

}  // namespace

Expected<PlacedViews> PlaceViews(const std::vector<CameraPeople>& cameras, const ViewOptions& options, double rate_hz,
                                 const std::string& where) {
  PlacedViews placed;
  placed.views.resize(cameras.size());
  std::size_t slots = 0;
  std::vector<std::size_t> seeing;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    slots = std::max(slots, cameras[i].people.size());
    if (!cameras[i].people.empty()) {
      seeing.push_back(i);
      continue;
    }
    placed.findings.push_back(
        MakeFinding("no_person_in_view", Severity::kWarning, cameras[i].frames,
                    cameras[i].view + " observed no person in its " + std::to_string(cameras[i].frames) + " frames",
                    FindingAction::kExcluded));
  }
  if (seeing.empty()) {
    return Fail(ErrorCode::kInconsistent, "no camera observed a person", where,
                "the trackers lost the person: leave it out");
  }
  std::vector<int> friends(cameras.size(), 0);
  std::vector<std::vector<std::size_t>> apart(cameras.size());
  std::string contradictions;
  bool any = false;
  for (std::size_t x = 0; x < seeing.size(); ++x) {
    for (std::size_t y = x + 1; y < seeing.size(); ++y) {
      const std::size_t i = seeing[x], k = seeing[y];
      const Pair pair = AlignPair(cameras[i], cameras[k], slots, rate_hz, options.max_offset_s);
      if (FindApartClocks(cameras[i], cameras[k], pair, slots, rate_hz, options, where)) {
        apart[i].push_back(k);
        apart[k].push_back(i);
      }
      if (Agrees(pair, options)) {
        any = true;
        ++friends[i], ++friends[k];
      } else if (pair.alignment) {
        contradictions += (contradictions.empty() ? "" : "; ") + cameras[i].view + " and " + cameras[k].view + ": " +
                          WhyNot(pair, options);
      }
    }
  }
  // The camera that is apart from most others; of two the second.
  const auto odd =
      std::max_element(apart.rbegin(), apart.rend(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (!odd->empty()) {
    const CameraPeople &other = cameras[odd->front()], &own = cameras[static_cast<std::size_t>(apart.rend() - odd) - 1];
    const Pair pair = AlignPair(other, own, slots, rate_hz, options.max_offset_s);
    if (auto error = FindApartClocks(other, own, pair, slots, rate_hz, options, where))
      return tl::unexpected<Error>(*std::move(error));
  }
  if (!any && !contradictions.empty()) {
    return Fail(ErrorCode::kInconsistent, "the cameras do not show the same (" + contradictions + ")", where,
                "which one is right is unknown: leave one out with ingest.source.exclude, or ingest the files apart");
  }
  placed.reference = seeing.front();
  for (const std::size_t i : seeing) {
    const bool more_seen =
        !any && cameras[i].people.front().frames.size() > cameras[placed.reference].people.front().frames.size();
    if (friends[i] > friends[placed.reference] || more_seen) placed.reference = i;
  }
  const CameraPeople& reference = cameras[placed.reference];
  for (const std::size_t i : seeing) {
    PlacedView& view = placed.views[i];
    if (i == placed.reference) {
      view.used = true;
      view.alignment.offset_known = true;
      view.slots = InOrder(reference, slots);
      continue;
    }
    const Pair pair = AlignPair(reference, cameras[i], slots, rate_hz, options.max_offset_s);
    if (!Agrees(pair, options)) {
      placed.findings.push_back(
          MakeFinding("view_excluded", Severity::kWarning, pair.alignment ? 1e3 * pair.alignment->median : 0.0,
                      cameras[i].view + " is not taken, beside " + reference.view + ": " + WhyNot(pair, options),
                      FindingAction::kExcluded));
      continue;
    }
    view.used = true;
    view.alignment = *pair.alignment;
    view.slots = pair.order;
    NoteUsed(cameras[i], reference.view, view.alignment, (reference.first - cameras[i].first) / rate_hz, rate_hz,
             placed.findings);
  }
  return placed;
}

JointTracks MergePerson(const std::vector<CameraPeople>& cameras, const PlacedViews& placed, std::size_t slot,
                        int begin, int end, double rate_hz) {
  std::vector<Scene> scenes;
  std::vector<const ViewAlignment*> alignments;
  int joints = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const PlacedView& view = placed.views[i];
    if (!view.used || view.slots[slot] < 0) continue;
    joints = cameras[i].people.front().positions.joints;
    scenes.push_back(SceneOf(cameras[i], {view.slots[slot]}, rate_hz));
    alignments.push_back(&view.alignment);
  }
  JointTracks merged;
  merged.positions = JointPositions(end - begin, joints);
  merged.confidence.assign(static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(joints), 0.0);
  std::vector<PointAt> said;
  for (int f = begin; f < end; ++f) {
    merged.time_s.push_back((f - begin) / rate_hz);
    for (int k = 0; k < joints; ++k) {
      said.clear();
      for (std::size_t i = 0; i < scenes.size(); ++i) {
        PointAt point = PointWhen(scenes[i].view(), f / rate_hz - alignments[i]->offset_s, k);
        if (!point.seen) continue;
        point.place = alignments[i]->a_from_b * point.place;
        said.push_back(point);
      }
      if (said.empty()) continue;
      Vector3d place = Vector3d::Zero();
      for (int turn = 0; turn < kMergeTurns; ++turn) {
        Vector3d sum = Vector3d::Zero();
        double total = 0.0;
        for (const PointAt& point : said) {
          const double off = turn == 0 ? 0.0 : (point.place - place).norm() / kCauchySpread;
          const double weight = point.confidence * point.confidence / (1.0 + off * off);
          sum += weight * point.place;
          total += weight;
        }
        place = sum / total;
      }
      double agreeing = 0.0, surest = 0.0;
      for (const PointAt& point : said) {
        surest = std::max(surest, point.confidence);
        if ((point.place - place).norm() <= kAgree) agreeing = std::max(agreeing, point.confidence);
      }
      merged.positions.at(f - begin, k) = place;
      merged.confidence[static_cast<std::size_t>(f - begin) * static_cast<std::size_t>(joints) +
                        static_cast<std::size_t>(k)] = agreeing > 0.0 ? agreeing : 0.5 * surest;
    }
  }
  return merged;
}

}  // namespace mocurate
