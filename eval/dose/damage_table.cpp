#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "core/base/text.h"
#include "eval/dose/damages.h"

namespace mocurate {
namespace {

Expected<double> ReadDose(const DamageInfo& info, std::string_view text, const std::string& where) {
  const std::string number(Trim(text));
  char* end = nullptr;
  const double dose = std::strtod(number.c_str(), &end);
  if (number.empty() || *end != '\0' || !std::isfinite(dose)) {
    return Fail(ErrorCode::kUsage, "dose '" + number + "' is not a number", where,
                std::string("write ") + info.name + "=" + FormatDouble(info.doses.front()));
  }
  if (dose < info.low || dose > info.high) {
    return Fail(ErrorCode::kUsage,
                "dose " + number + " of " + info.name + " is not in [" + FormatDouble(info.low) + ", " +
                    FormatDouble(info.high) + "] " + info.unit,
                where, "choose doses in that range; " + std::string(info.name) + ": " + info.help);
  }
  return dose;
}

}  // namespace

const std::array<DamageInfo, kDamageCount>& Damages() {
  static const std::array<DamageInfo, kDamageCount> kTable = {{
      {Damage::kJitter, "jitter_mm", "mm", 0, 0, 1000, {1, 2, 5, 10, 20}, "white noise per axis, joint and frame"},
      {Damage::kSliding,
       "sliding_mm_s",
       "mm/s",
       0,
       0,
       10000,
       {20, 50, 100, 200, 500},
       "the whole body drifts at constant horizontal velocity"},
      {Damage::kFrozen,
       "frozen_share",
       "of motions",
       0,
       0,
       1,
       {0.05, 0.1, 0.25, 0.5},
       "share of motions frozen at their first frame"},
      {Damage::kMirrored,
       "mirrored_share",
       "of motions",
       0,
       0,
       1,
       {0.05, 0.1, 0.25, 0.5},
       "share of motions mirrored left to right, with unchanged label"},
      {Damage::kTruncated,
       "truncated_share",
       "of frames",
       0,
       0,
       0.95,
       {0.1, 0.25, 0.5, 0.75},
       "share of frames cut from the end of every motion"},
      {Damage::kSwappedLabels,
       "swapped_label_share",
       "of motions",
       0,
       0,
       1,
       {0.02, 0.05, 0.1, 0.25},
       "share of motions with the label of another class"},
      {Damage::kBoneDrift,
       "bone_drift_percent_s",
       "%/s",
       0,
       0,
       100,
       {0.5, 1, 2, 5, 10},
       "growth of every bone per second, relative to its length"},
      {Damage::kYaw, "yaw_deg", "degrees", 0, 0, 180, {5, 15, 45, 90}, "rotation of every motion about the vertical"},
      {Damage::kRate, "rate_factor", "times", 1, 0.1, 10, {0.5, 0.8, 1.25, 2}, "playback speed of every motion"},
      {Damage::kScale, "scale_factor", "times", 1, 0.1, 10, {0.8, 0.9, 1.1, 1.25}, "scale of every body"},
  }};
  return kTable;
}

const DamageInfo& InfoOf(Damage damage) { return Damages()[static_cast<std::size_t>(damage)]; }

Expected<std::vector<DoseSeries>> ParseDoses(const std::vector<std::string>& texts) {
  std::vector<DoseSeries> series;
  if (texts.empty()) {
    for (const DamageInfo& info : Damages()) series.push_back({info.damage, info.doses});
    return series;
  }
  std::vector<std::string> names;
  for (const DamageInfo& info : Damages()) names.emplace_back(info.name);
  std::set<std::string> taken;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name(Trim(text.substr(0, equals)));
    const std::string where = "--doses " + text;
    const auto info =
        std::find_if(Damages().begin(), Damages().end(), [&](const DamageInfo& one) { return one.name == name; });
    if (info == Damages().end()) {
      auto near = Nearest(name, names);
      for (const std::string& one : names) {
        if (!near && !name.empty() && one.rfind(name, 0) == 0) near = one;  // without its unit
      }
      std::string list;
      for (const std::string& one : names) list += (list.empty() ? "" : ", ") + one;
      return Fail(ErrorCode::kUsage, "unknown damage '" + name + "'", where,
                  (near ? "did you mean '" + *near + "'? " : std::string()) + "damages are: " + list);
    }
    if (!taken.insert(name).second) {
      return Fail(ErrorCode::kUsage, "damage '" + name + "' is named twice", where,
                  "write its doses as one list, separated by commas");
    }
    DoseSeries one{info->damage, info->doses};
    if (equals != std::string::npos) {
      one.doses.clear();
      for (const std::string_view part : SplitText(text.substr(equals + 1), ',')) {
        const auto dose = ReadDose(*info, part, where);
        if (!dose) return Forward(dose);
        const bool known = std::find(one.doses.begin(), one.doses.end(), *dose) != one.doses.end();
        if (!known && *dose != info->none) one.doses.push_back(*dose);  // `none` is always scored
      }
      std::sort(one.doses.begin(), one.doses.end());
    }
    series.push_back(std::move(one));
  }
  return series;
}

}  // namespace mocurate
