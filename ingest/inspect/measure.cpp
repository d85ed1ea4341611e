#include "ingest/inspect/measure.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/geometry/axes.h"
#include "ingest/options.h"

namespace mocurate {
namespace {

/// How long something of a person is, metres.
struct LengthOfPeople {
  double typical = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// The last one is the CMU database's, `length 0.45` of its .asf files, in the words of configs/sources.
constexpr const char* kLengthUnits[] = {"m", "cm", "mm", "inch", "2.2222222222222 inch"};
constexpr int kLeastPower = -6, kMostPower = 3;
constexpr double kConfidenceInTens = 0.5;  // against a usual unit

/// "0.00001 m"
std::string InMetres(double metres) {
  const double rounded = ParseDouble(RoundedText(metres, 3)).value_or(metres);
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), rounded, std::chars_format::fixed).ptr;
  return std::string(buffer, end) + " m";
}

/// The unit is taken if the length is a person's in it, and nearer to a typical one than what was taken before.
class BestUnit {
 public:
  BestUnit(double length, const LengthOfPeople& people) : length_(length), people_(people) {}

  void Try(const std::string& name, double metres_per_unit, double trust) {
    const double metres = length_ * metres_per_unit;
    if (!(metres >= people_.low && metres <= people_.high)) return;
    const double off = std::abs(std::log(metres / people_.typical));
    if (!name_.empty() && off > off_) return;
    off_ = off;
    name_ = name;
    metres_ = metres;
    trust_ = trust;
  }
  bool found() const { return !name_.empty(); }
  const std::string& name() const { return name_; }
  double metres() const { return metres_; }
  double confidence() const { return trust_ * std::max(0.2, 1.0 - off_ / 0.6); }

 private:
  double length_;
  LengthOfPeople people_;
  double off_ = 0.0, metres_ = 0.0, trust_ = 0.0;
  std::string name_;
};

/// Three digits.
std::string ShownLength(double value) {
  if (!(value > 0.0)) return "0";
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return step >= 1.0 ? RoundedText(std::round(value / step) * step, 9)
                     : FormatDouble(std::round(value / step) / std::round(1.0 / step));
}

/// The unit in which `length` is one of a person: metres, centimetres, millimetres, inches, the CMU database's unit.
/// Where none of them is and `scaled`, a metre times a power of ten, less sure: "0.00001 m" where millimetres were
/// multiplied by 100. No value where nothing fits; the evidence then says so. `trust`: confidence at the typical
/// length.
Measured UnitsFromLength(double length, const LengthOfPeople& people, const std::string& what, double trust,
                         bool scaled) {
  Measured units;
  BestUnit best(length, people);
  for (const char* unit : kLengthUnits) best.Try(unit, *MetresPerUnit(unit), trust);
  const bool usual = best.found();
  for (int power = kLeastPower; !usual && scaled && power <= kMostPower; ++power) {
    const double metres = std::pow(10.0, power);
    best.Try(InMetres(metres), metres, kConfidenceInTens * trust);
  }
  if (!best.found()) {
    units.evidence = what + " is " + ShownLength(length) + " in the file's unit; no usual unit makes that a person" +
                     (scaled ? ", nor a metre times a power of ten" : "");
    return units;
  }
  units.value = best.name();
  units.confidence = best.confidence();
  units.evidence = what + " is " + ShownLength(length) + " = " + ShownLength(best.metres()) + " m in " + best.name();
  if (!usual) units.evidence += ", which is no usual unit: numbers that were multiplied by a power of ten look so";
  return units;
}

constexpr LengthOfPeople kHeadToFoot = {1.5, kShortestBody, kTallestBody};
constexpr LengthOfPeople kBox = {1.55, 0.7, 2.3};
constexpr int kFewestInBox = 10;        // points, for a box around them to be a person's
constexpr double kDecided = 0.5;        // least confidence of a direction that is reported
constexpr double kSureOrder = 0.1;      // least confidence of a guessed order whose left and right are believed
constexpr double kUpright = 0.7;        // mean of head above feet, below which people lie or bend most of the time
constexpr double kFirmFloor = 0.7;      // spread of the floor against that of the next axis
constexpr int kManyFeet = 30;           // frames and sides, of feet that are believed against hands
constexpr double kMostFeet = 0.7;       // share of them
constexpr double kNearlyAlways = 0.95;  // score of feet that point one way
constexpr int kFewKnees = 4;            // fewer say nothing, as of any part
constexpr double kUnsureHands = 0.5;    // most of hands that reach both ways
constexpr double kByFeet = 0.6;         // how sure feet make then

/// Sum of directions, one a frame.
struct Directions {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  void Add(const Vector3d& v) {
    if (!(v.norm() > 1e-12)) return;
    sum += v.normalized();
    ++count;
  }
  Vector3d mean() const { return count == 0 ? Vector3d::Zero() : Vector3d(sum / count); }
};

class Body {
 public:
  explicit Body(const RawClip& clip) : clip_(clip), p_(clip.points) {}

  bool Has(int f, int point) const {
    if (point < 0) return false;
    return clip_.confidence.empty() ||
           clip_.confidence[static_cast<std::size_t>(f) * clip_.positions.joints + point] > 0.0;
  }
  bool Has(int f, const int (&pair)[2]) const { return Has(f, pair[0]) && Has(f, pair[1]); }
  Vector3d At(int f, int point) const { return clip_.positions.at(f, point); }
  Vector3d Middle(int f, const int (&pair)[2]) const { return 0.5 * (At(f, pair[0]) + At(f, pair[1])); }
  int frames() const { return clip_.positions.frames; }

  double Length(int a, int b) const {
    std::vector<double> lengths;
    for (int f = 0; f < frames(); ++f) {
      if (Has(f, a) && Has(f, b)) lengths.push_back((At(f, a) - At(f, b)).norm());
    }
    return Median(lengths);
  }

  /// Head to foot along the bones; 0 if a part is not there.
  double Chain() const {
    double leg = 0.0;
    int legs = 0;
    for (int side = 0; side < 2; ++side) {
      const double thigh = Length(p_.hip[side], p_.knee[side]);
      const double shank = Length(p_.knee[side], p_.ankle[side]);
      if (thigh > 0.0 && shank > 0.0) leg += thigh + shank, ++legs;
    }
    std::vector<double> trunk, head;
    for (int f = 0; f < frames(); ++f) {
      if (!Has(f, p_.hip) || !Has(f, p_.shoulder)) continue;
      trunk.push_back((Middle(f, p_.hip) - Middle(f, p_.shoulder)).norm());
      if (Has(f, p_.head)) head.push_back((At(f, p_.head) - Middle(f, p_.shoulder)).norm());
    }
    if (legs == 0 || trunk.empty() || head.empty()) return 0.0;
    return leg / legs + Median(trunk) + Median(head);
  }

  Directions Up() const {
    Directions up;
    for (int f = 0; f < frames(); ++f) {
      if (Has(f, p_.head) && Has(f, p_.ankle))
        up.Add(At(f, p_.head) - Middle(f, p_.ankle));
      else if (Has(f, p_.hip) && Has(f, p_.shoulder))
        up.Add(Middle(f, p_.shoulder) - Middle(f, p_.hip));
    }
    return up;
  }

  /// Left to right, at hips and shoulders.
  std::optional<Vector3d> Right(int f) const {
    Vector3d right = Vector3d::Zero();
    if (Has(f, p_.hip)) right += At(f, p_.hip[1]) - At(f, p_.hip[0]);
    if (Has(f, p_.shoulder)) right += At(f, p_.shoulder[1]) - At(f, p_.shoulder[0]);
    if (!(right.norm() > 1e-12)) return std::nullopt;
    return right.normalized();
  }

 private:
  const RawClip& clip_;
  const BodyLandmarks& p_;
};

/// The axis a mean direction lies nearest to, as "+y".
Measured NearestAxis(const Vector3d& mean) {
  Measured measured;
  int axis = 0;
  mean.cwiseAbs().maxCoeff(&axis);
  measured.confidence = std::min(1.0, std::abs(mean[axis]));
  if (measured.confidence >= kDecided) measured.value = std::string(mean[axis] < 0.0 ? "-" : "+") + "xyz"[axis];
  return measured;
}

Vector3d AxisVector(const std::string& text) {
  Vector3d vector = Vector3d::Zero();
  vector[text[1] - 'x'] = text[0] == '-' ? -1.0 : 1.0;
  return vector;
}

/// How far the lowest of all points, along a direction, moves over the clip: what bears a person stays where it is,
/// whatever the person does. From the tenth to the ninetieth percentile; nothing for a few frames.
std::optional<double> FloorSpread(const Body& body, const RawClip& clip, const Vector3d& up) {
  std::vector<double> lowest;
  for (int f = 0; f < body.frames(); ++f) {
    double low = 1e300;
    for (int j = 0; j < clip.positions.joints; ++j) {
      if (body.Has(f, j)) low = std::min(low, up.dot(clip.positions.at(f, j)));
    }
    if (low < 1e300) lowest.push_back(low);
  }
  if (lowest.size() < 10) return std::nullopt;
  std::sort(lowest.begin(), lowest.end());
  return lowest[lowest.size() * 9 / 10] - lowest[lowest.size() / 10];
}

/// People who lie down or bend: head above feet says little, so the floor has to agree, or decides.
void AskTheFloor(const Body& body, const RawClip& clip, Measured& up) {
  if (up.confidence >= kUpright) return;
  double best = 1e300, next = 1e300;
  std::string axis;
  for (const char* text : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    const auto spread = FloorSpread(body, clip, AxisVector(text));
    if (!spread) return up.value.clear();
    if (*spread < best) {
      next = best;
      best = *spread;
      axis = text;
    } else {
      next = std::min(next, *spread);
    }
  }
  if (!(best < kFirmFloor * next)) {
    up.value.clear();
    up.evidence += "; the person lies or bends, and no floor shows";
    return;
  }
  up.value = axis;
  up.confidence = std::max(kDecided, 1.0 - best / next);
  up.evidence += "; the person lies or bends: the lowest point moves least along " + axis + ", by " +
                 ShownLength(best) + " units, along the next axis by " + ShownLength(next);
}

/// Without names: the longest side of the box around all points.
double LongestSide(const RawClip& clip) {
  std::vector<double> extents;
  for (int f = 0; f < clip.positions.frames; ++f) {
    Vector3d low = Vector3d::Constant(1e300), high = Vector3d::Constant(-1e300);
    for (int j = 0; j < clip.positions.joints; ++j) {
      if (!clip.confidence.empty() && clip.confidence[static_cast<std::size_t>(f) * clip.positions.joints + j] == 0.0)
        continue;
      low = low.cwiseMin(clip.positions.at(f, j));
      high = high.cwiseMax(clip.positions.at(f, j));
    }
    if (high.x() >= low.x()) extents.push_back((high - low).maxCoeff());
  }
  return Median(extents);
}

void MeasureFacing(const Body& body, ClipMeasures& m) {
  if (m.up.value.empty() || m.handedness.value.empty()) return;
  const Vector3d up = AxisVector(m.up.value);
  const double sign = m.handedness.value == "right" ? 1.0 : -1.0;
  Directions front;
  for (int f = 0; f < body.frames(); ++f) {
    if (const auto right = body.Right(f)) front.Add(sign * up.cross(*right));
  }
  Measured facing = NearestAxis(front.mean());
  facing.confidence *= m.handedness.confidence;
  facing.evidence = "mean over " + std::to_string(front.count) + " frames of the direction across hips and shoulders";
  if (facing.value.empty()) facing.evidence += "; the person turns or stands slantwise";
  m.facing = facing;
  if (facing.value.empty() || facing.value[1] == m.up.value[1]) return;
  const Vector3d forward = AxisVector(facing.value);
  const Vector3d left = sign * up.cross(forward);
  AxisConvention convention;
  for (int i = 0; i < 3; ++i) {
    convention.canonical_from_source.col(i) = Vector3d(left[i], up[i], forward[i]);
  }
  m.axes = {convention.Text(), std::min({m.up.confidence, m.handedness.confidence, m.facing.confidence}),
            "from up, handedness and facing; facing is a habit of the recording, not a rule"};
}

/// What feet that nearly always point one way say against hands that do not agree with themselves: feet hardly turn,
/// hands reach anywhere. Nothing where knees or feet leave a doubt.
std::optional<Handedness> NameFeet(const std::vector<HandednessCue>& cues) {
  const auto cue = [&](const char* name) {
    const auto found = std::find_if(cues.begin(), cues.end(), [&](const auto& one) { return one.name == name; });
    return found == cues.end() ? HandednessCue() : *found;
  };
  const HandednessCue feet = cue("feet"), knees = cue("knees"), hands = cue("hands");
  const bool firm = feet.frames >= kManyFeet && feet.share >= kMostFeet && std::abs(feet.score) >= kNearlyAlways;
  const bool knees_deny = knees.frames >= kFewKnees && feet.score * knees.score < 0.0;
  if (!firm || knees_deny || std::abs(hands.score) > kUnsureHands) return std::nullopt;
  return feet.score > 0.0 ? Handedness::kLeft : Handedness::kRight;
}

/// Of the points, by anatomy; else by the feet alone.
HandednessMeasure HandednessOf(const RawClip& clip) {
  HandednessMeasure measure =
      MeasureHandedness(clip.positions, clip.points, clip.confidence.empty() ? nullptr : &clip.confidence);
  if (measure.handedness) return measure;
  measure.handedness = NameFeet(measure.cues);
  if (!measure.handedness) return measure;
  measure.confidence = kByFeet;
  measure.evidence += ", but hands may reach anywhere";
  return measure;
}

}  // namespace

ClipMeasures Measure(const RawClip& clip) {
  ClipMeasures m;
  if (!clip.confidence.empty()) {
    const auto missing = std::count(clip.confidence.begin(), clip.confidence.end(), 0.0);
    m.missing_share = static_cast<double>(missing) / static_cast<double>(clip.confidence.size());
  }
  if (clip.positions.empty()) return m;
  const Body body(clip);
  m.body = clip.lengths_assumed ? 0.0 : body.Chain();
  m.root = clip.root_scale;
  if (clip.lengths_assumed) {
    m.units.evidence = "lengths are those of a standard body";
  } else if (m.body > 0.0) {
    m.units = UnitsFromLength(m.body, kHeadToFoot, "head to foot along the bones", 1.0, true);
  } else if (clip.joints >= kFewestInBox) {
    m.units = UnitsFromLength(LongestSide(clip), kBox, "the longest side of the box around all points", 0.5, false);
  } else {
    m.units.evidence = "no head, hips and legs are named, and " + Counted(clip.joints, "point") + " are no person";
  }
  const Directions up = body.Up();
  m.up = NearestAxis(up.mean());
  m.up.evidence = up.count > 0 ? "head above feet, mean over " + std::to_string(up.count) + " frames"
                               : "no named head, hips or feet";
  if (up.count > 0) AskTheFloor(body, clip, m.up);
  const HandednessMeasure handedness = HandednessOf(clip);
  m.handedness.confidence = handedness.confidence;
  m.handedness.evidence = handedness.evidence.empty() ? "neither knees, feet nor hands tell" : handedness.evidence;
  const bool guessed = clip.skeleton.from == Provenance::kMeasured && clip.skeleton.confidence < kSureOrder;
  if (guessed) {
    m.handedness = {"", 0.0, "the order of the joints is not sure, and with it their sides; " + m.handedness.evidence};
  } else if (handedness.handedness) {
    m.handedness.value = *handedness.handedness == Handedness::kRight ? "right" : "left";
  }
  MeasureFacing(body, m);
  return m;
}

}  // namespace mocurate
