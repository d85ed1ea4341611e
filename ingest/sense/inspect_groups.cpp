#include "ingest/sense/inspect_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/median_deviation.h"
#include "core/quality/tracked_points.h"
#include "ingest/options.h"
#include "ingest/sense/clip_report.h"
#include "ingest/sense/comparison.h"
#include "ingest/sense/file_names.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr double kNearTen = 0.05;             // of the logarithm of a factor
constexpr std::size_t kFewestSeenPoints = 5;  // that tell where a body is
constexpr double kLeastSpread = 0.1;          // of the size of a body, of places that count as different
constexpr double kElsewhere = 6.0;            // of the spread, from the middle of all: nobody else is there
constexpr double kThere = 3.0;                // of the spread, where the others are
constexpr double kSureHandedness = 0.6;       // of a handedness that is kept against that of all others

/// What most clips of a group say, weighted by confidence.
Json Pooled(const std::vector<const Json*>& clips, const char* key) {
  std::map<std::string, std::pair<double, Json>> votes;
  double all = 0.0;
  for (const Json* clip : clips) {
    const Json& field = clip->at(key);
    if (field.at("value").is_null()) continue;
    const double weight = std::max(1e-6, field.at("confidence").get<double>());
    auto& vote = votes[field.at("value").dump()];
    vote.first += weight;
    vote.second = field;
    all += weight;
  }
  Json best = {{"value", nullptr}, {"from", "unknown"}, {"share", 0.0}};
  double most = 0.0;
  for (const auto& [text, vote] : votes) {
    if (vote.first <= most) continue;
    most = vote.first;
    best = {{"value", vote.second.at("value")},
            {"from", vote.second.at("from")},
            {"share", std::round(1e4 * most / all) / 1e4}};
  }
  return best;
}

std::string ClipFolder(const Json& clip) { return FolderOf(clip.at("file")); }

/// Clips by folder, format and joints.
template <class Clip>
std::map<std::string, std::vector<Clip*>> Members(Clip& clips) {
  std::map<std::string, std::vector<Clip*>> members;
  for (auto& clip : clips) {
    members[ClipFolder(clip) + "\n" + clip.at("format").template get<std::string>() + "\n" +
            clip.at("joints").at("value").dump()]
        .push_back(&clip);
  }
  return members;
}

/// Whether all follow one known order or tree, so that their left and right are the same words.
bool OneSkeleton(const std::vector<Json*>& group) {
  const Json& first = group[0]->at("skeleton").at("value");
  if (!first.is_string() || first.get<std::string>().rfind("own tree", 0) == 0) return false;
  return std::all_of(group.begin(), group.end(),
                     [&](const Json* clip) { return clip->at("skeleton").at("value") == first; });
}

/// Rates that motions deny, of the clips of a folder together.
void TellRates(const std::string& folder, const std::vector<Json*>& group, Json& findings) {
  std::map<std::string, const Json*> by_id;
  for (const Json* clip : group) by_id[clip->at("id")] = clip;
  RateDenials denials;
  denials.clips = group.size();
  for (const Json& finding : findings) {
    if (finding.at("code") != "rate_doubtful") continue;
    const auto clip = by_id.find(finding.at("where"));
    if (clip != by_id.end()) denials.Add(clip->second->at("rate_hz").at("value"), finding.at("value"));
  }
  if (!denials.OfTheSet()) return;
  findings.push_back(InspectionFinding("rate_doubtful", Severity::kError, folder.empty() ? "." : folder,
                                       std::round(denials.Share() * 1e4) / 1e4,
                                       "the motions of the whole folder speak against its rate: " + denials.Words()));
}

/// The unit that a clip's own lengths show, of clips whose unit nobody says.
std::optional<double> MeasuredMetres(const Json& clip) {
  const Json& units = clip.at("units");
  if (units.at("from") != "measured") return std::nullopt;
  const Expected<double> metres = MetresPerUnit(units.at("value").get<std::string>());
  return metres ? std::optional<double>(*metres) : std::nullopt;
}

/// Clips whose numbers are a power of ten of those of most clips of their folder.
void TellUnits(const std::vector<Json*>& group, Json& findings) {
  std::map<std::string, std::size_t> votes;
  std::string usual;
  std::size_t told = 0;
  for (const Json* clip : group) {
    if (!MeasuredMetres(*clip)) continue;
    const std::string& unit = clip->at("units").at("value").get_ref<const std::string&>();
    ++told;
    const std::size_t count = ++votes[unit];
    if (count > votes[usual]) usual = unit;
  }
  for (const Json* clip : group) {
    const std::optional<double> metres = MeasuredMetres(*clip);
    if (!metres) continue;
    const double tens = std::log10(MetresPerUnit(usual).value_or(*metres) / *metres);
    if (std::round(tens) == 0.0 || std::abs(tens - std::round(tens)) > kNearTen) continue;
    const double factor = std::pow(10.0, std::round(tens));
    const std::string unit = clip->at("units").at("value");
    findings.push_back(InspectionFinding(
        "units_outlier", Severity::kError, clip->at("id"), factor,
        "the numbers of this clip are " + FormatDouble(factor) + " times those of the others: its unit is " + unit +
            " where that of " + std::to_string(votes[usual]) + " of the " + std::to_string(told) +
            " clips of the folder that tell is " + usual + " (" + clip->at("units").at("evidence").get<std::string>() +
            "); divide them, or give the clip a source with its own ingest.source.units"));
  }
}

/// Where a body is in its first frame, and how large: medians of the coordinates, longest side of its box.
struct FirstPlace {
  std::array<double, 3> place{};
  double size = 0.0;
};

std::optional<FirstPlace> FirstPlaceOf(const Json& clip) {
  const Json& points = clip.at("first_frame").at("value");
  if (!points.is_array()) return std::nullopt;
  FirstPlace first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Json& point : points) {
      if (!point.at("position").is_null()) values.push_back(point.at("position").at(axis));
    }
    if (values.size() < kFewestSeenPoints) return std::nullopt;
    std::sort(values.begin(), values.end());
    first.place[axis] = values[values.size() / 2];
    first.size = std::max(first.size, values.back() - values.front());
  }
  return first;
}

/// Clips in which two axes are exchanged: the person is where nobody of the folder is, but for that.
void TellPlaces(const std::vector<Json*>& group, Json& findings) {
  std::vector<const Json*> clips;
  std::vector<FirstPlace> places;
  std::vector<double> sizes;
  for (const Json* clip : group) {
    const std::optional<FirstPlace> place = FirstPlaceOf(*clip);
    if (!place) continue;
    clips.push_back(clip);
    places.push_back(*place);
    sizes.push_back(place->size);
  }
  if (places.size() <= kFewestVotes) return;
  const double least = kLeastSpread * Median(sizes);
  std::array<double, 3> middle{}, spread{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values, off;
    for (const FirstPlace& place : places) values.push_back(place.place[axis]);
    middle[axis] = Median(values);
    for (const double value : values) off.push_back(std::abs(value - middle[axis]));
    spread[axis] = std::max(least, kMadToSigma * Median(off));
  }
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const auto off = [&](std::size_t axis, std::size_t read) {
      return std::abs(places[c].place[read] - middle[axis]) / spread[axis];
    };
    for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
      if (off(a, a) < kElsewhere || off(b, b) < kElsewhere || off(a, b) > kThere || off(b, a) > kThere) continue;
      findings.push_back(InspectionFinding(
          "axes_outlier", Severity::kWarning, clips[c]->at("id"),
          std::round(1e4 * std::min(off(a, a), off(b, b))) / 1e4,
          std::string("the person is where no other of the folder is, but would be among them with ") + "xyz"[a] +
              " and " + "xyz"[b] + " exchanged (" + Digits(std::min(off(a, a), off(b, b))) +
              " times as far from their middle as they usually are): compare the columns of the file"));
    }
  }
}

}  // namespace

void TellByGroup(Json& clips, Json& findings) {
  for (auto& [key, group] : Members(clips)) {
    TellRates(key.substr(0, key.find('\n')), group, findings);
    TellUnits(group, findings);
    TellPlaces(group, findings);
    if (!OneSkeleton(group)) continue;
    std::size_t told = 0;
    std::vector<const Json*> voters;
    for (const Json* clip : group) {
      if (clip->at("handedness").at("from") != "measured") continue;
      ++told;
      voters.push_back(clip);
    }
    if (told < kFewestVotes) continue;
    const Json pooled = Pooled(voters, "handedness");
    const auto agree = std::count_if(voters.begin(), voters.end(), [&](const Json* clip) {
      return clip->at("handedness").at("value") == pooled.at("value");
    });
    const bool all_but_one = static_cast<std::size_t>(agree) + 1 == told;
    if (pooled.at("share").get<double>() < kAgreement && !all_but_one) continue;
    const std::string evidence =
        "as " + std::to_string(agree) + " of the " + std::to_string(told) + " clips of the folder that tell say";
    for (Json* clip : group) {
      Json& handedness = (*clip)["handedness"];
      if (handedness.at("from") == "declared" || handedness.at("value") == pooled.at("value")) continue;
      const std::string own = handedness.at("evidence");
      if (!handedness.at("value").is_null()) {
        findings.push_back(
            InspectionFinding("handedness_outlier", Severity::kWarning, clip->at("id"), handedness.at("confidence"),
                              "this clip alone would be " + handedness.at("value").get<std::string>() + "-handed (" +
                                  own + ", " + RoundedText(100.0 * handedness.at("confidence").get<double>(), 3) +
                                  " % sure), the others of the folder are not"));
        for (const char* field : {"facing", "axes"}) {
          if ((*clip)[field].at("from") == "measured")
            (*clip)[field] = ReportValue(Json(), "unknown", 0.0, "the clip contradicts the others of its folder");
        }
        if (handedness.at("confidence").get<double>() >= kSureHandedness) {
          handedness = ReportValue(Json(), "unknown", 0.0, "the clip contradicts the others of its folder: " + own);
          continue;
        }
      }
      handedness = ReportValue(pooled.at("value"), "measured", pooled.at("share"), evidence + "; of itself: " + own);
    }
  }
}

Json GroupsOf(const Json& clips) {
  const std::map<std::string, std::vector<const Json*>> members = Members(clips);
  Json groups = Json::array();
  for (const auto& [key, group] : members) {
    Json json = {{"folder", key.substr(0, key.find('\n'))},
                 {"format", group[0]->at("format")},
                 {"joints", group[0]->at("joints").at("value")},
                 {"clips", group.size()}};
    std::int64_t frames = 0, fewest = group[0]->at("frames").at("value"), most = fewest;
    for (const Json* clip : group) {
      const std::int64_t count = clip->at("frames").at("value");
      frames += count;
      fewest = std::min(fewest, count);
      most = std::max(most, count);
    }
    json["frames"] = {{"sum", frames}, {"min", fewest}, {"max", most}};
    for (const char* field : {"skeleton", "units", "up", "handedness", "facing", "axes", "rate_hz"}) {
      json[field] = Pooled(group, field);
    }
    groups.push_back(std::move(json));
  }
  return groups;
}

}  // namespace mocurate
