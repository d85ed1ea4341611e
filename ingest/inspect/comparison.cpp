#include "ingest/inspect/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/base/text.h"
#include "core/pipeline/runner.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr double kContradicts = 0.55;  // least confidence of a measured value that contradicts a declared one
constexpr double kBodySlack = 0.15;    // of the body's length, before a declared unit is doubted
constexpr double kLeastBody = kShortestBody * (1.0 - kBodySlack), kLongestBody = kTallestBody * (1.0 + kBodySlack);
constexpr double kPathSlack = 2.0;       // factor by which a path may differ from the steps of a standard body
constexpr double kRateTolerance = 0.01;  // relative
constexpr double kUnitSlack = 1.5;       // factor within which a length is a usual unit

/// "-z": where a canonical direction lies in the source's axes.
std::string SourceAxis(const AxisConvention& axes, int canonical) {
  for (int i = 0; i < 3; ++i) {
    const double component = axes.canonical_from_source(canonical, i);
    if (std::abs(component) > 0.5) return std::string(component < 0.0 ? "-" : "+") + "xyz"[i];
  }
  return "";
}

/// The usual unit of `metres`, or that length.
std::string UnitName(double metres) {
  for (const char* name : {"m", "cm", "mm", "inch"}) {
    const double ratio = metres / MetresPerUnit(name).value_or(1.0);
    if (ratio > 1.0 / kUnitSlack && ratio < kUnitSlack) return name;
  }
  return "";
}

/// A path of the root in another unit than the body that it carries.
void ComparePath(const DeclaredFrame& said, const RootScale& root, double declared,
                 std::vector<Comparison>& comparisons) {
  const std::string unit = UnitName(root.factor * declared);
  const bool contradicts = root.factor > kPathSlack || root.factor < 1.0 / kPathSlack;
  comparisons.push_back(
      {MakeFinding("units_contradiction", Severity::kError, FourDecimals(root.factor),
                   "the path of the root is declared in " + said.units + ", but does not fit the body's steps" +
                       (unit.empty() ? "" : ": in " + unit + " it would") + " (" + root.evidence + ")"),
       unit, root.sure, contradicts});
}

void CompareUnits(const DeclaredFrame& said, const ClipMeasures& m, std::vector<Comparison>& comparisons) {
  if (said.units.empty() || (!(m.body > 0.0) && !m.root)) return;
  const Expected<double> declared = MetresPerUnit(said.units);
  if (!declared) return;
  if (m.root) return ComparePath(said, *m.root, *declared, comparisons);
  const double metres = m.body * *declared;
  comparisons.push_back(
      {MakeFinding("units_contradiction", Severity::kError, FourDecimals(metres),
                   "in the declared unit '" + said.units + "' the person measures " +
                       FormatDouble(FourDecimals(metres)) + " m from head to foot" +
                       (m.units.value.empty() ? "" : "; in " + m.units.value + " it would be a person")),
       m.units.value, 1.0, metres < kLeastBody || metres > kLongestBody});
}

void Compare(const char* code, const char* what, const std::string& declared, const Measured& measured,
             std::vector<Comparison>& comparisons) {
  if (declared.empty() || measured.value.empty() || measured.confidence < kContradicts) return;
  comparisons.push_back(
      {MakeFinding(code, Severity::kError, FourDecimals(measured.confidence),
                   std::string(what) + " is declared " + declared + ", the motion says " + measured.value + ", " +
                       RoundedText(100.0 * measured.confidence, 3) + " % confidence (" + measured.evidence + ")"),
       measured.value, measured.confidence, measured.value != declared});
}

struct Votes {
  std::size_t decided = 0;
  std::size_t against = 0;
  double weight = 0.0;
  double weight_against = 0.0;
  std::string message;  ///< of the first clip that contradicts
};

std::map<std::string, Votes> CountVotes(const std::vector<ItemResult>& clips) {
  std::map<std::string, Votes> all;
  for (const ItemResult& clip : clips) {
    const nlohmann::json shown = clip.summary.value("shown", nlohmann::json::object());
    for (const auto& [code, said] : shown.items()) {
      Votes& votes = all[code];
      const double weight = said.value("weight", 0.0);
      ++votes.decided;
      votes.weight += weight;
      if (!said.value("contradicts", false)) continue;
      ++votes.against;
      votes.weight_against += weight;
      for (const Finding& finding : clip.outcome.findings) {
        if (votes.message.empty() && finding.code == code) votes.message = finding.message;
      }
    }
  }
  return all;
}

Finding Together(const std::string& code, const Votes& votes, std::size_t clips, const SourceOptions& source) {
  const double share = votes.weight_against / votes.weight;
  return Contradiction(source, code, FourDecimals(share),
                       "the whole source contradicts its declaration: " + std::to_string(votes.against) + " of the " +
                           Counted(static_cast<long long>(votes.decided), "clip") + " that decide it, of " +
                           std::to_string(clips) + " in all (" + RoundedText(100.0 * share) +
                           " % of what they say); the first: " + votes.message);
}

/// Rates that motions deny: `against` is then of all clips, however little each of the others tells.
std::optional<Finding> RateOfAll(const std::vector<ItemResult>& clips, const SourceOptions& source) {
  RateDenials denials;
  std::string first;
  for (const ItemResult& clip : clips) {
    if (!clip.summary.contains("rate_hz")) continue;
    ++denials.clips;
    for (const Finding& finding : clip.outcome.findings) {
      if (finding.code != "rate_suspect") continue;
      denials.Add(clip.summary.value("rate_hz", 0.0), finding.value);
      if (first.empty()) first = finding.message;
    }
  }
  if (!denials.OfTheSet()) return std::nullopt;
  return Contradiction(
      source, "rate_suspect", FourDecimals(denials.Share()),
      "the motions of the whole source contradict its rate: " + denials.Words() + "; the first: " + first);
}

/// What is wrong with the set is wrong with each of its clips.
void AddSetFinding(const Finding& of_the_set, bool refuse, std::vector<ItemResult>& clips) {
  for (ItemResult& clip : clips) {
    if (!HasArtifact(clip.outcome.kind)) continue;
    Finding own = of_the_set;
    own.clip = clip.item;
    if (!refuse) {
      std::vector<Finding>& findings = clip.outcome.findings;
      bool of_itself = false;
      for (Finding& finding : findings) {
        if (finding.code != own.code) continue;
        finding.severity = Severity::kError;
        of_itself = true;
      }
      clip.outcome.kind = OutcomeKind::kSuspect;
      if (!of_itself) findings.push_back(std::move(own));
      continue;
    }
    own.action = FindingAction::kRefused;
    clip.summary.Set("threshold", own.code == "rate_suspect" ? kShareOfWrongRate : kAgreement);
    clip.outcome.kind = OutcomeKind::kRefused;
    clip.outcome.error = Error{ErrorCode::kInconsistent, own.message, clip.item,
                               "set ingest.source.on_contradiction: flag to keep such clips"};
    clip.outcome.findings.push_back(std::move(own));
    clip.artifact.clear();
    clip.sha256.clear();
  }
}

constexpr double kLeastLikely = 5.0, kMostLikely = 500.0;  // Hz
constexpr double kSameRate = 0.005;                        // of a rate that was rounded

constexpr std::array<double, 22> kUsualRates = {10, 12, 12.5, 15,  20,  24,  25,  30,  48,  50,  60,
                                                75, 90, 100,  120, 144, 150, 200, 240, 250, 300, 500};

struct NamedRate {
  double hz;
  const char* word;
};

std::string RateText(double value) { return RoundedText(value, 6); }

}  // namespace

DeclaredFrame DeclaredFrameOf(const RawClip& clip, const std::optional<SourceOptions>& source) {
  DeclaredFrame said{clip.units, clip.up, clip.handedness, "", clip.axes, "declared by the format"};
  if (!source) return said;
  said.who = "declared by the source '" + source->name + "'";
  if (!source->units.empty()) said.units = source->units;
  const auto axes = AxisConvention::Parse(source->axes);
  if (!axes) return said;
  said.axes = source->axes;
  said.up = SourceAxis(*axes, 1);
  said.facing = SourceAxis(*axes, 2);
  said.handedness = axes->handedness() == Handedness::kLeft ? "left" : "right";
  return said;
}

double ContradictionThreshold(const std::string& code, double value, const SourceOptions& source) {
  if (code == "units_contradiction") {
    const bool path = DriverOf(source.format).lengths_assumed;
    if (path) return value > 1.0 ? kPathSlack : 1.0 / kPathSlack;
    return FourDecimals(value > kTallestBody ? kLongestBody : kLeastBody);
  }
  if (code == "up_contradiction" || code == "handedness_contradiction") return kContradicts;
  if (code == "joint_order_contradiction") return kPlausibleOrder;
  if (code == "rate_implausible") return value > kSlowestRecorded_hz ? kFastestRecorded_hz : kSlowestRecorded_hz;
  if (code == "rate_contradiction") return source.rate_hz.value_or(0.0);
  return 0.0;
}

std::optional<Finding> CompareRate(const SourceOptions& source, double file_hz) {
  if (!source.rate_hz || std::abs(file_hz / *source.rate_hz - 1.0) <= kRateTolerance) return std::nullopt;
  return MakeFinding(
      "rate_contradiction", Severity::kError, file_hz,
      "the file declares " + RoundedText(file_hz, 6) + " Hz, the source " + RoundedText(*source.rate_hz, 6) + " Hz");
}

bool RateDenials::OfTheSet() const {
  const std::size_t most = std::max(too_fast, too_slow);
  return most >= kFewestWrongRates && Share() >= kShareOfWrongRate && std::min(too_fast, too_slow) == 0;
}

std::string RateDenials::Words() const {
  return std::to_string(std::max(too_fast, too_slow)) + " of " + Counted(static_cast<long long>(clips), "clip") + " (" +
         RoundedText(100.0 * Share()) + " %) deny their rate, all as too " + (too_fast > 0 ? "fast" : "slow");
}

std::vector<Comparison> CompareFrame(const DeclaredFrame& said, const ClipMeasures& measures) {
  std::vector<Comparison> comparisons;
  CompareUnits(said, measures, comparisons);
  Compare("up_contradiction", "up", said.up, measures.up, comparisons);
  Compare("handedness_contradiction", "the frame", said.handedness, measures.handedness, comparisons);
  return comparisons;
}

std::vector<Finding> FindSetContradictions(const SourceOptions& source, std::vector<ItemResult>& clips) {
  const bool refuse = source.on_contradiction == OnContradiction::kRefuse;
  std::vector<Finding> findings;
  for (const auto& [code, votes] : CountVotes(clips)) {
    if (votes.decided < kFewestDenials || votes.weight_against < kAgreement * votes.weight) continue;
    findings.push_back(Together(code, votes, clips.size(), source));
  }
  if (std::optional<Finding> rate = RateOfAll(clips, source)) findings.push_back(std::move(*rate));
  for (const Finding& finding : findings) AddSetFinding(finding, refuse, clips);
  return findings;
}

std::optional<double> NearestUsualRate(double hz) {
  const auto* usual = std::find_if(kUsualRates.begin(), kUsualRates.end(),
                                   [&](double rate) { return std::abs(hz / rate - 1.0) < kSameRate; });
  return usual == kUsualRates.end() ? std::nullopt : std::optional<double>(*usual);
}

std::optional<Finding> CheckStatedRate(double hz, RateUnit word, const std::string& place) {
  if (!(hz > 0.0) || (hz > kSlowestRecorded_hz && hz <= kFastestRecorded_hz)) return std::nullopt;
  const bool seconds = word == RateUnit::kSecondsPerFrame;
  const double written = seconds ? 1.0 / hz : hz;
  const std::array<NamedRate, 4> readings = {
      {{seconds ? written : 1.0 / written, seconds ? "frames per second" : "seconds per frame"},
       {1e3 / written, "milliseconds per frame"},
       {1e6 / written, "microseconds per frame"},
       {seconds ? 1e-3 / written : 1e3 * written, seconds ? "seconds per 1000 frames" : "frames per millisecond"}}};
  const auto likely = [](const NamedRate& reading) { return reading.hz >= kLeastLikely && reading.hz <= kMostLikely; };
  const auto* best = std::find_if(readings.begin(), readings.end(), [&](const NamedRate& reading) {
    return likely(reading) && NearestUsualRate(reading.hz);
  });
  if (best == readings.end()) best = std::find_if(readings.begin(), readings.end(), likely);
  Finding finding = MakeFinding("rate_implausible", Severity::kError, hz, "");
  finding.message = place + ": " + (seconds ? "Frame Time: " : "") + RateText(written) +
                    (seconds ? " is " + RateText(hz) + " frames per second: " : " frames per second: ") +
                    "motion is not recorded at " + (hz > kFastestRecorded_hz ? "more than 2000" : "1 or less") + "; ";
  if (best == readings.end()) {
    finding.message += "correct it, or declare ingest.source.rate";
  } else {
    finding.message += RateText(written) + " looks like " + best->word + ": write " +
                       (seconds ? "Frame Time: " + RateText(1.0 / best->hz) : RateText(best->hz)) +
                       ", or declare ingest.source.rate: " + RateText(best->hz);
  }
  return finding;
}

}  // namespace mocurate
