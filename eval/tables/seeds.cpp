#include "eval/tables/seeds.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/holm.h"
#include "eval/tables/result_table.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

double MeanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// NAME of the row of NAME/SEED; empty where the row is of no seed of its own.
std::string NameWithoutSeed(const Json& row) {
  if (!row.contains("network")) return {};
  const std::string network = row["network"].get<std::string>(), name = row.at("name").get<std::string>();
  const std::size_t slash = network.rfind('/');
  if (slash == std::string::npos || network.find('@', slash) != std::string::npos) return {};
  const std::string seed = network.substr(slash);
  const std::size_t at = name.rfind(seed);
  return at == std::string::npos ? std::string() : name.substr(0, at) + name.substr(at + seed.size());
}

Json MergedMetric(const std::vector<const Json*>& seeds, const std::string& metric) {
  std::vector<double> values;
  for (const Json* row : seeds) {
    const Json& one = row->at("metrics").value(metric, Json());
    if (one.is_object() && one.at("value").is_number()) values.push_back(one["value"].get<double>());
  }
  Json merged = {{"value", nullptr}, {"interval", nullptr}, {"interval_kind", nullptr}};
  const Json& first = seeds.front()->at("metrics").at(metric);
  for (const char* key : {"why", "motions", "real", "real_sd"}) {  // of the real motions: alike in all
    if (first.is_object() && first.contains(key)) merged[key] = first[key];
  }
  if (values.empty() || values.size() < seeds.size()) return merged;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  merged["value"] = MeanOf(values);
  merged["interval"] = {*least, *most};
  merged["interval_kind"] = kRangeOfSeeds;
  merged["repetitions"] = values;
  return merged;
}

Json Merged(const std::string& name, const std::vector<const Json*>& seeds) {
  Json row = *seeds.front();
  row["name"] = name;
  row.erase("confusion");
  row["network"] = row["network"].get<std::string>().substr(0, row["network"].get<std::string>().rfind('/'));
  row["seeds"] = Json::array();
  double seconds = 0.0, memory = 0.0;
  for (const Json* seed : seeds) {
    row["seeds"].push_back(*seed);
    if (seed->contains("unconverged")) row["unconverged"] = (*seed)["unconverged"];
    const Json ours = seed->value("ours", Json::object());
    const auto number = [&](const char* key) {
      const Json value = ours.value(key, Json());
      return value.is_number() ? value.get<double>() : 0.0;
    };
    seconds += number("seconds");
    memory = std::max(memory, number("peak_memory"));
  }
  for (const auto& [metric, value] : seeds.front()->at("metrics").items()) {
    row["metrics"][metric] = MergedMetric(seeds, metric);
  }
  if (row.contains("ours")) {
    row["ours"]["metrics"] = row["metrics"];
    row["ours"]["checkpoint"] = nullptr;  // those of "seeds"
    row["ours"]["unconverged"] = row.value("unconverged", Json());
    if (seconds > 0.0) row["ours"]["seconds"] = seconds;
    if (memory > 0.0) row["ours"]["peak_memory"] = memory;
  }
  return row;
}

/// 1 / C(n + m, n).
double LeastChance(std::size_t n, std::size_t m) {
  double chance = 1.0;
  for (std::size_t i = 1; i <= n; ++i) chance *= static_cast<double>(i) / static_cast<double>(m + i);
  return chance;
}

}  // namespace

void MergeSeeds(Json& rows) {
  std::map<std::string, std::vector<const Json*>> groups;
  for (const Json& row : rows) {
    if (const std::string name = NameWithoutSeed(row); !name.empty()) groups[name].push_back(&row);
  }
  Json merged = Json::array();
  for (const Json& row : rows) {
    const auto group = groups.find(NameWithoutSeed(row));
    if (group == groups.end() || group->second.size() < 2) {
      merged.push_back(row);
    } else if (group->second.front() == &row) {
      merged.push_back(Merged(group->first, group->second));
    }
  }
  rows = std::move(merged);
}

double ChanceOfLess(const std::vector<double>& less, const std::vector<double>& more) {
  std::vector<double> all = less;
  all.insert(all.end(), more.begin(), more.end());
  const double sum = std::accumulate(all.begin(), all.end(), 0.0);
  const double n = static_cast<double>(less.size()), m = static_cast<double>(more.size());
  const auto difference = [&](double first) { return first / n - (sum - first) / m; };
  const double observed = difference(std::accumulate(less.begin(), less.end(), 0.0));
  const double rounding = 1e-12 * (1.0 + std::abs(sum));
  std::vector<bool> chosen(all.size(), false);
  std::fill(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(less.size()), true);
  double as_far = 0.0, assignments = 0.0;
  do {
    double first = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) first += chosen[i] ? all[i] : 0.0;
    assignments += 1.0;
    as_far += difference(first) <= observed + rounding ? 1.0 : 0.0;
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return as_far / assignments;
}

Json OrdersOfSeeds(const Json& rows) {
  constexpr std::size_t kMostSeeds = 10;  // of a row: 184,756 assignments
  Json orders = Json::array();
  for (const char* metric : {"FID_train", "accuracy"}) {
    const bool less = metric == std::string("FID_train");
    std::vector<Json> of_metric;
    std::vector<double> p;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = i + 1; j < rows.size(); ++j) {
        if (!rows[i].contains("seeds") || !rows[j].contains("seeds")) continue;
        if (rows[i].value("frames", 0) != rows[j].value("frames", 0)) continue;
        if (rows[i]["network"] == rows[j]["network"]) continue;  // a filter or another step of the same networks
        const Table::Cell one = CellOf(rows[i].at("metrics").value(metric, Json()));
        const Table::Cell other = CellOf(rows[j].at("metrics").value(metric, Json()));
        if (!one.value || !other.value) continue;
        if (std::max(one.repetitions.size(), other.repetitions.size()) > kMostSeeds) continue;
        const bool first = less == (*one.value < *other.value);  // is the better
        const Table::Cell &small = *one.value < *other.value ? one : other, &large = &small == &one ? other : one;
        p.push_back(ChanceOfLess(small.repetitions, large.repetitions));
        const Json& better = rows[first ? i : j];
        const Json& worse = rows[first ? j : i];
        of_metric.push_back({{"metric", metric},
                             {"better", better.at("name")},
                             {"worse", worse.at("name")},
                             {"seeds", {better["seeds"].size(), worse["seeds"].size()}},
                             {"difference", std::abs(*one.value - *other.value)},
                             {"p", p.back()},
                             {"least_p", LeastChance(small.repetitions.size(), large.repetitions.size())}});
      }
    }
    const std::vector<double> corrected = HolmCorrected(p);
    for (std::size_t i = 0; i < of_metric.size(); ++i) {
      of_metric[i]["p_holm"] = corrected[i];
      orders.push_back(std::move(of_metric[i]));
    }
  }
  return orders;
}

}  // namespace mocurate
